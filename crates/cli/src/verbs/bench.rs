//! `magsplice bench`: measures how fast the field is computed.

use std::time::Duration;

use magsplice::magnet::Accuracy;
use magsplice::{Film, FilmError, Stage};

use crate::args::bench::BenchArgs;
use crate::args::formats::TextOrJson;
use crate::benchmark::{self, BenchPoints};
use crate::failure::Failure;
use crate::inputs::points;
use crate::output::destination::print;
use crate::prepared_film::prepare;
use crate::progress::ProgressLine;
use crate::words::{film_failure, no_points};
use crate::{json, remarks, text};

pub(crate) fn run(args: &BenchArgs, quiet: bool) -> Result<(), Failure> {
    let progress = ProgressLine::start(!quiet && !points::are_typed(args.points.path()));
    let subjects = if args.points.path().is_some() { remarks::OF_TILES } else { remarks::OF_FIELDS };
    let layout = remarks::read_layout(&args.layout, subjects, quiet, &progress)?;
    let (points, points_of) = match args.points.path() {
        Some(path) => {
            let (points, _) = points::read_all(path, args.points.unit, &remarks::teller(quiet, &progress))?;
            (BenchPoints::Scattered(points), format!("points of {}", path.display()))
        }
        None => {
            let film = Film::rigid(&layout);
            let volume = film.volume().map_err(|error| no_points(&args.layout, error))?;
            (BenchPoints::Grid(volume.grid), "points of the working volume".to_owned())
        }
    };
    let show = |stage: Stage| progress.show(stage);
    let film = prepare(&args.layout, &layout, &show, &remarks::teller(quiet, &progress))?;
    let show = |done| progress.show(Stage { name: "measuring", done, of: None, unit: "rounds" });
    let budget = Duration::from_secs_f64(args.seconds);
    let measured = benchmark::measure(film.scene(), &points, budget, &show)
        .map_err(|error| Failure::Format(format!("cannot start threads: {error}")))?;
    progress.end();
    // Points without any field have none to a tolerance either.
    for case in measured.cases.iter().filter(|case| case.accuracy == Accuracy::Exact) {
        if let Err(errors) = &case.seconds {
            return Err(film_failure(&args.layout, &layout, FilmError::Points(errors.clone())));
        }
    }
    print(&match args.format {
        TextOrJson::Text => text::bench::benchmark(&layout, &measured, &points_of),
        TextOrJson::Json => json::pretty(&json::bench::BenchJson::new(&layout, &measured)),
    })
}
