//! `magsplice compare`: compares the field with the ideal film.

use magsplice::{Film, Stage};

use crate::args::evaluate::CompareArgs;
use crate::args::formats::TextOrJson;
use crate::failure::Failure;
use crate::output::destination::print;
use crate::progress::ProgressLine;
use crate::words::{film_failure, no_film};
use crate::{json, remarks, text};

pub(crate) fn run(args: &CompareArgs, quiet: bool) -> Result<(), Failure> {
    let progress = ProgressLine::start(!quiet);
    let show = |stage: Stage| progress.show(stage);
    let layout = remarks::read_layout(&args.layout, remarks::OF_COMPARISONS, quiet, &progress)?;
    let film = Film::new(&layout).with_accuracy(args.accuracy.accuracy()).with_progress(&show);
    let failed = |error| film_failure(&args.layout, &layout, error);
    // A layout without an ideal film is refused before the field is computed.
    let purpose = "compares the field with that of the ideal, sinusoidal film";
    let no_film = |error| no_film(&args.layout, error, "compare", purpose);
    film.ideal().and(film.volume().map(|_| ())).map_err(no_film)?;
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
