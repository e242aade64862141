//! `magsplice plan`: which models a tolerance is kept with, what they leave out, and what they cost.

use std::fmt::Write;
use std::io::{IsTerminal, stdin};
use std::path::Path;

use magsplice::field::{Model, Plan, PlannedPart};
use magsplice::layout::Layout;
use magsplice::prelude::DVec3;
use magsplice::{Film, FilmError, Stage};
use serde::Serialize;

use crate::args::{Format, PlanArgs};
use crate::failure::Failure;
use crate::output;
use crate::points::{Faults, PointFile};
use crate::progress::Progress;
use crate::text;
use crate::verbs::decouple::Source;

/// Points read at a time.
const BATCH: usize = 1 << 16;

pub(crate) fn run(args: &PlanArgs, quiet: bool) -> Result<(), Failure> {
    // Not among points that are typed.
    let typed = args.points.as_deref() == Some(Path::new("-")) && stdin().is_terminal();
    let progress = Progress::start(!quiet && !typed);
    let layout = Layout::read(&args.layout)?;
    let film = Film::new(&layout).with_accuracy(args.accuracy.get());
    let plan_stage = Stage::uncounted("plan");
    let (plan, where_to) = match &args.points {
        Some(path) => {
            let points = points(path)?;
            progress.show(plan_stage);
            (film.scene().plan_at_points(&points), format!("points of {}", path.display()))
        }
        None => {
            let volume = film.volume().map_err(|error| missing(args, error))?;
            progress.show(plan_stage);
            (film.scene().plan_on_grid(&volume.grid), "points of the working volume".to_owned())
        }
    };
    progress.end();
    output::print(&match args.format {
        Format::Text => in_words(&film, &plan, &where_to),
        Format::Json => text::json(&Report {
            source: Source::of(&film),
            parts: plan.parts.iter().map(PartReport::from).collect(),
            cost: plan.cost(),
            exact_cost: plan.exact_cost,
        }),
    })
}

fn missing(args: &PlanArgs, error: FilmError) -> Failure {
    match error {
        FilmError::Missing(_) => Failure::Points {
            path: args.layout.clone(),
            message: "the layout has no [volume] table to take points from: add one, or give --points".to_owned(),
        },
        error => Failure::Film { layout: args.layout.clone(), error },
    }
}

fn points(path: &Path) -> Result<Vec<DVec3>, Failure> {
    let mut file = PointFile::open(path)?;
    let mut faults = Faults::default();
    let (mut all, mut points, mut lines) = (Vec::new(), Vec::new(), Vec::new());
    loop {
        let more = file.read(BATCH, &mut points, &mut lines, &mut faults)?;
        all.extend_from_slice(&points);
        if !more {
            break;
        }
    }
    if faults.is_empty() { Ok(all) } else { Err(faults.failure(path.display().to_string())) }
}

fn in_words(film: &Film, plan: &Plan, where_to: &str) -> String {
    let layout = film.layout();
    let points: usize = plan.parts.iter().map(|part| part.points).sum();
    let mut text = format!(
        "{}: {}, sha256 {}\n{points} {where_to}\naccuracy: {}\n",
        layout.name,
        text::tile_count(layout),
        &layout.sha256[..12],
        film.scene().accuracy()
    );
    for part in &plan.parts {
        describe(&mut text, part, layout.tiles.len());
    }
    let (cost, exact) = (plan.cost(), plan.exact_cost);
    let _ = writeln!(text, "\nin all about as much as {} exact values of one tile", count(cost));
    let _ = writeln!(text, "all exact: {} ({} times as many)", count(exact), ratio(exact / cost));
    text
}

fn describe(text: &mut String, part: &PlannedPart, tiles: usize) {
    let (what, mut rows) = match &part.model {
        Model::Exact => (
            "the exact field of all tiles",
            vec![
                ("left out", "nothing".to_owned()),
                ("why", "no expansion keeps the accuracy there for less".to_owned()),
            ],
        ),
        Model::Chebyshev { lower: l, upper: u, terms: [x, y, z], error_t, distance } => (
            "a Chebyshev expansion of the box",
            vec![
                ("box", format!("x {} .. {}, y {} .. {}, z {} .. {} mm", l.x, u.x, l.y, u.y, l.z, u.z)),
                ("polynomials", format!("{x} x {y} x {z}, from as many exact values")),
                ("error", format!("at most {error_t:.1e} T")),
                ("why", format!("no tile is nearer than {} mm", text::number(*distance))),
            ],
        ),
        Model::Cells { lower: l, upper: u, cells: [x, y, z], error_t, distance } => (
            "harmonic potentials of the cells of the box",
            vec![
                ("box", format!("x {} .. {}, y {} .. {}, z {} .. {} mm", l.x, u.x, l.y, u.y, l.z, u.z)),
                ("cells", format!("{x} x {y} x {z}")),
                ("error", format!("at most {error_t:.1e} T")),
                ("why", format!("no tile is nearer than {} mm, and the points are many", text::number(*distance))),
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
            "groups of tiles by expansions in solid harmonics, on average",
            vec![
                (
                    "far tiles",
                    format!(
                        "{} of {tiles} by {} expansions of degree {}",
                        count(*expanded_tiles),
                        count(*expansions),
                        count(*degree)
                    ),
                ),
                ("near tiles", format!("{}, each exactly where it is too near", count(*exact_tiles))),
                ("ignored tiles", format!("{}, which add at most {ignored_t:.1e} T", count(*ignored_tiles))),
                ("left out", format!("at most {truncation_error_t:.1e} T at any point, ignored tiles with it")),
                ("why", "no box of a grid, free of tiles and with points enough".to_owned()),
            ],
        ),
    };
    rows.push(("cost", format!("{} exact values of one tile", count(part.cost))));
    let _ = writeln!(text, "\n{} points: {what}", part.points);
    for (label, value) in rows {
        let _ = writeln!(text, "  {label:<15}{value}");
    }
}

/// Three digits are enough to compare costs.
fn count(value: f64) -> String {
    match value {
        v if v < 10.0 => format!("{v:.1}"),
        v if v < 1e5 => format!("{v:.0}"),
        v => format!("{v:.2e}"),
    }
}

fn ratio(value: f64) -> String {
    if value.is_finite() { format!("{value:.1}") } else { "no".to_owned() }
}

#[derive(Serialize)]
struct Report<'a> {
    #[serde(flatten)]
    source: Source<'a>,
    parts: Vec<PartReport>,
    /// In exact values of one tile at one point.
    cost: f64,
    exact_cost: f64,
}

#[derive(Serialize)]
struct PartReport {
    points: usize,
    #[serde(flatten)]
    model: ModelReport,
    cost: f64,
}

/// [`Model`] with units in its keys.
#[derive(Serialize)]
#[serde(tag = "model", rename_all = "snake_case")]
enum ModelReport {
    Exact,
    Chebyshev {
        lower_mm: [f64; 3],
        upper_mm: [f64; 3],
        terms: [usize; 3],
        error_t: f64,
        distance_mm: f64,
    },
    Cells {
        lower_mm: [f64; 3],
        upper_mm: [f64; 3],
        cells: [usize; 3],
        error_t: f64,
        distance_mm: f64,
    },
    Tree {
        expansions: f64,
        degree: f64,
        expanded_tiles: f64,
        exact_tiles: f64,
        ignored_tiles: f64,
        left_out_t: f64,
        ignored_t: f64,
    },
}

impl From<&PlannedPart> for PartReport {
    fn from(part: &PlannedPart) -> PartReport {
        let model = match part.model {
            Model::Exact => ModelReport::Exact,
            Model::Chebyshev { lower, upper, terms, error_t, distance } => ModelReport::Chebyshev {
                lower_mm: lower.to_array(),
                upper_mm: upper.to_array(),
                terms,
                error_t,
                distance_mm: distance,
            },
            Model::Cells { lower, upper, cells, error_t, distance } => ModelReport::Cells {
                lower_mm: lower.to_array(),
                upper_mm: upper.to_array(),
                cells,
                error_t,
                distance_mm: distance,
            },
            Model::Tree {
                expansions,
                degree,
                expanded_tiles,
                exact_tiles,
                ignored_tiles,
                truncation_error_t,
                ignored_t,
            } => ModelReport::Tree {
                expansions,
                degree,
                expanded_tiles,
                exact_tiles,
                ignored_tiles,
                left_out_t: truncation_error_t,
                ignored_t,
            },
        };
        PartReport { points: part.points, model, cost: part.cost }
    }
}
