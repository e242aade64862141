//! `budget`: where the displacement error comes from.

use magsplice::tolerance::Estimate;

use super::number::counted;
use super::rows::{Column, left, right};
use super::{header, rows};
use crate::sampling::film_budget::BudgetedFilm;

/// Number of causes and of tiles that are named as worth improving.
const NAMED: usize = 3;

const AXES: [&str; 3] = ["x", "y", "z"];

/// The report of `budget`.
pub(crate) fn budget(film: &BudgetedFilm) -> String {
    let mut text = header::with_recoil(&film.found.layout, film.recoil.as_ref());
    text += "displacement error of the films that are made: RMS in mm, and share of the mean square\n\n";
    let totals = film.found.totals_mm2();
    line(&mut text, "", AXES.map(str::to_owned));
    for part in film.found.parts() {
        line(&mut text, &part.name, cells(part.mean_squares_mm2, totals));
    }
    line(&mut text, "total", cells(totals, totals));
    let sampled = format!("{} of films", counted(film.samples as usize, "exact sample", "exact samples"));
    line(&mut text, &sampled, film.found.sampled_mm2().map(|square| format!("{:<13}", rms(square))));
    text.push('\n');
    if let Some(why) = &film.found.no_pattern {
        rows::prose(&mut text, &format!("the splicing pattern and the end of the film are not told apart: {why}"));
    }
    if let Some(squares_mm2) = film.found.compensated_pattern_mm2() {
        let [x, y, z] = squares_mm2.map(rms);
        let sentence = format!(
            "the same splicing pattern without end would be off by {x}, {y}, {z} mm, which the end of the film \
             compensates"
        );
        rows::prose(&mut text, &sentence);
    }
    validity(&mut text, film);
    improvements(&mut text, film);
    text
}

/// Name of a part and its errors along x, y, z.
const COLUMNS: [Column; 4] = [left(28), right(20), right(20), right(20)];

fn line(text: &mut String, label: &str, [x, y, z]: [String; 3]) {
    *text += &rows::table(&COLUMNS, &[[label.chars().take(28).collect(), x, y, z]]);
}

/// Root mean squares with shares of the totals.
fn cells(squares_mm2: [f64; 3], totals: [f64; 3]) -> [String; 3] {
    [0, 1, 2].map(|axis| {
        let share = if totals[axis] > 0.0 { 100.0 * squares_mm2[axis] / totals[axis] } else { 0.0 };
        format!("{} {share:>6.1} %", rms(squares_mm2[axis]))
    })
}

/// Length below which a part is round-off: a millionth of what any workshop can measure.
const ROUND_OFF_MM: f64 = 1e-9;

/// The root of a mean square, negative for one that compensates others.
fn rms(square_mm2: f64) -> String {
    let root = square_mm2.abs().sqrt().copysign(square_mm2);
    let root = if root.abs() < ROUND_OFF_MM { 0.0 } else { root };
    if root != 0.0 && root.abs() < 1e-4 { format!("{root:.1e}") } else { format!("{:.4}", root + 0.0) }
}

fn validity(text: &mut String, film: &BudgetedFilm) {
    let ratio = |estimate: Option<Estimate>| {
        estimate.map_or("-".to_owned(), |ratio| {
            format!("{:.3} ({:.3} .. {:.3})", ratio.value, ratio.interval[0], ratio.interval[1])
        })
    };
    let ratios: Vec<String> = film
        .found
        .check
        .axes
        .iter()
        .zip(AXES)
        .map(|(axis, name)| format!("{name} {}", ratio(axis.mean_square_ratio)))
        .collect();
    let ratios = ratios.join(", ");
    let sentence = if film.found.is_first_order {
        format!(
            "the first order holds within 5 %: mean squares of {} of the same films over it: {ratios}",
            counted(film.samples as usize, "exact sample", "exact samples")
        )
    } else {
        format!(
            "the first order does not hold within 5 % (mean squares of exact samples over it: {ratios}), so each cause \
             was sampled alone; halving a cause saves about three quarters of its part"
        )
    };
    rows::prose(text, &sentence);
}

fn improvements(text: &mut String, film: &BudgetedFilm) {
    let total: f64 = film.found.totals_mm2().iter().sum();
    let saves = |saved: [f64; 3]| format!("{:.0} %", 100.0 * saved.iter().sum::<f64>() / total);
    let causes = film.found.budget.causes.iter().take(NAMED);
    let causes: Vec<String> =
        causes.map(|item| format!("{} ({})", film.found.cause(item.cause), saves(item.saved_mm2))).collect();
    if !causes.is_empty() {
        let sentence =
            format!("most worth halving, with what is saved of the total mean square: {}", causes.join(", "));
        rows::prose(text, &sentence);
    }
    let tiles = film.found.budget.tiles.iter().take(NAMED);
    let tiles: Vec<String> =
        tiles.map(|item| format!("{} ({})", film.found.layout.tiles[item.tile].name, saves(item.saved_mm2))).collect();
    if !tiles.is_empty() {
        rows::prose(text, &format!("tiles whose errors are most worth halving: {}", tiles.join(", ")));
    }
}
