//! `magsplice plan`: shows which methods a tolerance allows.

use magsplice::layout::Layout;
use magsplice::{Film, Stage};

use crate::args::evaluate::PlanArgs;
use crate::args::formats::TextOrJson;
use crate::failure::Failure;
use crate::output::destination::print;
use crate::progress::ProgressLine;
use crate::words::no_points;
use crate::{json, point_file, text};

pub(crate) fn run(args: &PlanArgs, quiet: bool) -> Result<(), Failure> {
    // No progress line between points that a person types.
    let progress = ProgressLine::start(!quiet && !point_file::are_typed(args.points.as_deref()));
    let layout = Layout::read(&args.layout)?;
    let film = Film::new(&layout).with_accuracy(args.accuracy.accuracy());
    let planning = Stage::uncounted("planning");
    let (plan, points_of) = match &args.points {
        Some(path) => {
            let points = point_file::read_all(path)?;
            progress.show(planning);
            (film.scene().plan_at_points(&points), format!("points of {}", path.display()))
        }
        None => {
            let volume = film.volume().map_err(|error| no_points(&args.layout, error))?;
            progress.show(planning);
            (film.scene().plan_on_grid(&volume.grid), "points of the working volume".to_owned())
        }
    };
    progress.end();
    print(&match args.format {
        TextOrJson::Text => text::plan::plan(&film, &plan, &points_of),
        TextOrJson::Json => json::pretty(&json::plan::PlanJson::new(&film, &plan)),
    })
}
