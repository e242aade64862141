//! `magsplice plan`: shows which methods a tolerance allows.

use std::path::Path;

use magsplice::magnet::{PointErrorCause, PointErrors, Quantity};
use magsplice::prelude::DVec3;
use magsplice::{Film, FilmError, Stage};

use crate::args::evaluate::PlanArgs;
use crate::args::formats::TextOrJson;
use crate::failure::Failure;
use crate::inputs::points;
use crate::output::destination::print;
use crate::prepared_film::{prepare, recoil_estimates};
use crate::progress::ProgressLine;
use crate::words::{film_failure, no_points};
use crate::{json, remarks, text};

pub(crate) fn run(args: &PlanArgs, quiet: bool) -> Result<(), Failure> {
    // No progress line between points that a person types.
    let progress = ProgressLine::start(!quiet && !points::are_typed(args.points.path()));
    let subjects = if args.points.path().is_some() { remarks::OF_TILES } else { remarks::OF_FIELDS };
    let layout = remarks::read_layout(&args.layout, subjects, quiet, &progress)?;
    let show = |stage: Stage| progress.show(stage);
    let film = prepare(&args.layout, &layout, &show, &remarks::teller(quiet, &progress))?
        .with_accuracy(args.accuracy.accuracy());
    let planning = Stage::uncounted("planning");
    let (plan, points_of) = match args.points.path() {
        Some(path) => {
            let (points, _) = points::read_all(path, args.points.unit, &remarks::teller(quiet, &progress))?;
            progress.show(planning);
            check_accuracy(&film, path, points.len(), |index| points[index])?;
            (film.scene().plan_at_points(&points), format!("points of {}", path.display()))
        }
        None => {
            let volume = film.volume().map_err(|error| no_points(&args.layout, error))?;
            progress.show(planning);
            check_accuracy(&film, &args.layout, volume.grid.len(), |index| volume.grid.point(index))?;
            (film.scene().plan_on_grid(&volume.grid), "points of the working volume".to_owned())
        }
    };
    let estimates = recoil_estimates(&args.layout, &layout)?;
    progress.end();
    print(&match args.format {
        TextOrJson::Text => text::plan::plan(&film, &plan, &estimates, &points_of),
        TextOrJson::Json => json::pretty(&json::plan::PlanJson::new(&film, &plan, &estimates)),
    })
}

/// Number of points at which the field is evaluated to find out whether the tolerance can be kept.
const TRIED_POINTS: usize = 64;

/// Refuses a tolerance that the field does not keep at a few of the points, as `field` does.
/// `path` is the file that the points are from.
fn check_accuracy(film: &Film, path: &Path, points: usize, point: impl Fn(usize) -> DVec3) -> Result<(), Failure> {
    let tried: Vec<DVec3> = (0..points).step_by(points.div_ceil(TRIED_POINTS).max(1)).map(point).collect();
    let mut field = vec![DVec3::ZERO; tried.len()];
    let Err(PointErrors(mut errors)) = film.scene().field_into(Quantity::FluxDensity, &tried, &mut field) else {
        return Ok(());
    };
    // Points without any field are no matter of the tolerance, and have a plan like others.
    errors.retain(|error| matches!(error.cause, PointErrorCause::TooExact { .. }));
    if errors.is_empty() {
        Ok(())
    } else {
        Err(film_failure(path, film.layout(), FilmError::Points(PointErrors(errors))))
    }
}
