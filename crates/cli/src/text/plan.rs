//! `plan`: the methods, their truncation errors and costs.

use std::fmt::Write;

use magsplice::field::{Model, Plan, PlannedPart};
use magsplice::prelude::DVec3;
use magsplice::{Film, RecoilEstimate};

use super::{header, number, recoil, rows};

/// A plan for points, with estimates of what recoil changes; `points_of` says where the points are
/// from.
pub(crate) fn plan(film: &Film, plan: &Plan, estimates: &[RecoilEstimate], points_of: &str) -> String {
    let points: usize = plan.parts.iter().map(|part| part.points).sum();
    let mut text = format!("{}{points} {points_of}\n{}", header::layout(film.layout()), header::accuracy(film));
    for part in &plan.parts {
        describe(&mut text, part, film.scene().tile_count());
    }
    let (cost, exact) = (plan.cost(), plan.exact_cost);
    let _ = writeln!(text, "\ntotal cost: about {} exact values of one tile", digits(cost));
    let _ = writeln!(text, "all tiles directly: {} ({} times as many)", digits(exact), ratio(exact / cost));
    if !estimates.is_empty() {
        text += "\nwhat recoil changes, to first order\n";
    }
    for estimate in estimates {
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
                ("why", format!("no tile is nearer to the box than {} mm", number::number(*distance))),
            ],
        ),
        Model::Cells { lower, upper, cells: [x, y, z], error_t, distance } => (
            "harmonic potentials in the cells of a box",
            vec![
                ("box", volume(*lower, *upper)),
                ("cells", format!("{x} x {y} x {z}")),
                ("error", format!("at most {error_t:.1e} T")),
                (
                    "why",
                    format!(
                        "no tile is nearer to the box than {} mm, and it has many points",
                        number::number(*distance)
                    ),
                ),
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
                ("why", "the points are no grid in a box away from the tiles, or too few".to_owned()),
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
