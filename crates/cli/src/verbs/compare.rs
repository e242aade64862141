//! `magsplice compare`: compares the field with the ideal film.

use magsplice::{Film, Stage};

use crate::args::evaluate::CompareArgs;
use crate::args::formats::TextOrJson;
use crate::failure::Failure;
use crate::inputs::points;
use crate::inputs::points_below_film::GivenPoints;
use crate::output::destination::print;
use crate::prepared_film::prepare;
use crate::progress::ProgressLine;
use crate::words::{film_failure, no_film};
use crate::{json, remarks, text};

pub(crate) fn run(args: &CompareArgs, quiet: bool) -> Result<(), Failure> {
    // No progress line between points that a person types.
    let progress = ProgressLine::start(!quiet && !points::are_typed(args.points.path()));
    let show = |stage: Stage| progress.show(stage);
    let layout = remarks::read_layout(&args.layout, remarks::OF_COMPARISONS, quiet, &progress)?;
    let failed = |error| film_failure(&args.layout, &layout, error);
    // A layout without an ideal film is refused before the field is computed.
    let purpose = "compares the field with that of the ideal, sinusoidal film";
    let no_film = |error| no_film(&args.layout, error, "compare", purpose);
    let stated = Film::rigid(&layout);
    let ideal = stated.ideal().map_err(no_film)?;
    if args.points.path().is_none() {
        stated.volume().map_err(no_film)?;
    }
    let film = prepare(&args.layout, &layout, &show, &remarks::teller(quiet, &progress))?
        .with_accuracy(args.accuracy.accuracy());
    if let Some(path) = args.points.path() {
        let given = GivenPoints::read(path, args.points.unit, ideal, false, &remarks::teller(quiet, &progress))?;
        let field = film.field_at_t(&given.points).map_err(|error| given.failure(&args.layout, &layout, error))?;
        let comparison = film.compare_at(&given.points, &field).map_err(failed)?;
        progress.end();
        return print(&match args.format {
            TextOrJson::Json => json::pretty(&json::compare::CompareJson::new(&film, &comparison)),
            TextOrJson::Text => {
                let header = text::header::film_at_points(&film, path, given.points.len());
                format!("{header}\n{}", text::decouple::comparison(&comparison))
            }
        });
    }
    let field = film.volume_field_t().map_err(failed)?;
    let comparison = film.compare(&field).map_err(failed)?;
    progress.end();
    print(&match args.format {
        TextOrJson::Json => json::pretty(&json::compare::CompareJson::new(&film, &comparison)),
        TextOrJson::Text => {
            let header = text::header::film(&film, film.volume().map_err(failed)?);
            format!("{header}\n{}", text::decouple::comparison(&comparison))
        }
    })
}
