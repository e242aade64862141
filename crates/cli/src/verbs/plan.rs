//! `magsplice plan`: shows which methods a tolerance allows.

use std::fmt::Write;
use std::path::PathBuf;

use magsplice::field::{Model, PlannedPart};
use magsplice::prelude::DVec3;
use magsplice::results::FilmPlan;
use magsplice::{Film, FilmError};

use crate::args::accuracy::AccuracyArgs;
use crate::args::formats::TextOrJson;
use crate::args::points::PointsArgs;
use crate::failure::Failure;
use crate::inputs::points;
use crate::remarks;
use crate::session::Session;
use crate::text::number::number;
use crate::text::{header, recoil, rows};
use crate::words::film_failure;

/// Show which methods a tolerance allows, and the truncation error and cost of each.
///
/// --points and --unit select the points as in `magsplice field`. Costs count multiply-adds, in
/// units of the exact field of one tile at one point. The program computes an expansion to check
/// whether it keeps the tolerance, so a plan takes a part of the time of the evaluation. The
/// evaluation repeats some points more accurately, where the field is too weak for the truncation
/// error; the plan does not count these points.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  magsplice plan layouts/film-80mm.toml --within 1e-6")]
pub(crate) struct PlanArgs {
    /// Layout file
    layout: PathBuf,
    #[command(flatten)]
    points: PointsArgs,
    /// Format of the result
    #[arg(long, value_enum, default_value = "text")]
    format: TextOrJson,
    #[command(flatten)]
    accuracy: AccuracyArgs,
}

pub(crate) fn run(args: &PlanArgs, quiet: bool) -> Result<(), Failure> {
    let subjects = if args.points.path().is_some() { remarks::OF_TILES } else { remarks::OF_FIELDS };
    let session = Session::open_with_points(&args.layout, args.points.path(), subjects, quiet)?;
    let film = session.film()?.with_accuracy(args.accuracy.accuracy());
    let (points, points_of) = points::given(&session, &args.points)?;
    let plan = film.plan(&points).map_err(|error| match (error, args.points.path()) {
        (error @ FilmError::Points(_), Some(path)) => film_failure(path, &session.layout, error),
        (error, _) => session.failed(error),
    })?;
    session.print(&args.format.shown(&plan, || text(&film, &plan, &points_of)))
}

/// The plan; `points_of` says where the points are from.
fn text(film: &Film, plan: &FilmPlan, points_of: &str) -> String {
    let points: usize = plan.parts.iter().map(|part| part.points).sum();
    let mut text = format!("{}{points} {points_of}\n{}", header::layout(film.layout()), header::accuracy(film));
    for part in &plan.parts {
        describe(&mut text, part, film.scene().tile_count());
    }
    let (cost, exact) = (plan.cost, plan.exact_cost);
    let _ = writeln!(text, "\ntotal cost: about {} exact values of one tile", digits(cost));
    let _ = writeln!(text, "all tiles directly: {} ({} times as many)", digits(exact), ratio(exact / cost));
    if !plan.recoil_estimates.is_empty() {
        text += "\neffect of recoil, to first order\n";
    }
    for estimate in &plan.recoil_estimates {
        rows::prose(&mut text, &recoil::estimate(estimate));
    }
    text
}

fn describe(text: &mut String, part: &PlannedPart, tiles: usize) {
    let (method, mut rows) = match &part.model {
        Model::Exact => (
            "direct summation over all tiles",
            vec![
                ("truncation", "none".to_owned()),
                ("why", "no expansion keeps the accuracy at these points for less".to_owned()),
            ],
        ),
        Model::Chebyshev { lower, upper, terms: [x, y, z], error_t, distance } => (
            "a Chebyshev expansion of the field in a box",
            vec![
                ("box", volume(*lower, *upper)),
                ("polynomials", format!("{x} x {y} x {z}")),
                ("error", format!("at most {error_t:.1e} T")),
                ("why", format!("no tile is nearer to the box than {} mm", number(*distance))),
            ],
        ),
        Model::Cells { lower, upper, cells: [x, y, z], error_t, distance } => (
            "harmonic potentials in the cells of a box",
            vec![
                ("box", volume(*lower, *upper)),
                ("cells", format!("{x} x {y} x {z}")),
                ("error", format!("at most {error_t:.1e} T")),
                ("why", format!("no tile is nearer to the box than {} mm, and it has many points", number(*distance))),
            ],
        ),
        Model::Tree {
            expansions,
            degree,
            expanded_tiles,
            exact_tiles,
            ignored_tiles,
            truncation_error_t,
            ignored_t,
        } => (
            "expansions of groups of tiles in solid harmonics (numbers are averages over the points)",
            vec![
                (
                    "far tiles",
                    format!(
                        "{} of {tiles} by {} expansions of degree {}",
                        digits(*expanded_tiles),
                        digits(*expansions),
                        digits(*degree)
                    ),
                ),
                ("near tiles", format!("{}, summed directly", digits(*exact_tiles))),
                ("ignored tiles", format!("{}, with a field of at most {ignored_t:.1e} T", digits(*ignored_tiles))),
                ("truncation", format!("at most {truncation_error_t:.1e} T at any point, ignored tiles included")),
                ("why", "the points do not form a grid in a box away from the tiles, or are too few".to_owned()),
            ],
        ),
    };
    rows.push(("cost", format!("{} exact values of one tile", digits(part.cost))));
    let _ = writeln!(text, "\n{} points: {method}", part.points);
    for (label, value) in rows {
        let _ = writeln!(text, "  {label:<15}{value}");
    }
}

fn volume(l: DVec3, u: DVec3) -> String {
    format!("x {} .. {}, y {} .. {}, z {} .. {} mm", l.x, u.x, l.y, u.y, l.z, u.z)
}

/// Three digits: enough to compare costs.
fn digits(value: f64) -> String {
    match value {
        v if v < 10.0 => format!("{v:.1}"),
        v if v < 1e5 => format!("{v:.0}"),
        v => format!("{v:.2e}"),
    }
}

fn ratio(value: f64) -> String {
    if value.is_finite() { format!("{value:.1}") } else { "no".to_owned() }
}
