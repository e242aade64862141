//! The summary of `assign`, and the plan.

use std::fmt::Write;
use std::iter;
use std::path::Path;

use magsplice::Film;
use magsplice::making::PlanRow;
use magsplice::results::FilmAssignment;

use crate::inputs::placed_tiles::PLAN_COLUMNS;
use crate::text::number::{components, counted, number, point};
use crate::text::{header, rows};

/// The errors of the film, and the plan. `path` is that of the layout that was written.
pub(super) fn summary(film: &Film, found: &FilmAssignment, path: Option<&Path>) -> String {
    let mut text = header::with_recoil(film);
    let _ = write!(
        text,
        "{} measured, {}",
        counted(found.measured_tiles, "tile", "tiles"),
        counted(found.spares, "spare", "spares")
    );
    let placed = found.plan.iter().filter(|row| row.is_placed).count();
    if placed > 0 {
        let _ = write!(text, ", {placed} already placed");
    }
    text += "\n\n";

    text += "RMS displacement error over the working volume and its three axes, mm\n";
    rows::cell(&mut text, "  film as ordered", &number(found.ordered_rms_mm));
    rows::cell(&mut text, "  tiles in the order of the list", &number(found.in_order_rms_mm));
    rows::cell(&mut text, "  tiles as assigned", &number(found.rms_mm));
    if let Some(with_errors) = &found.measured_rms_mm {
        rows::cell(&mut text, "  with errors of measurement, mean", &number(with_errors.mean.value));
        rows::cell(&mut text, "    95 % of films are below", &number(with_errors.p95.value));
    }
    let (median, near) = found.agreement();
    let starts = counted(found.starts_rms_mm.len(), "start", "starts");
    let sentence = format!(
        "{near} of {starts} ended within 10 % of the best; the median of all starts is {median:.2} times the best"
    );
    rows::prose(&mut text, &sentence);
    for shim in &found.shims {
        rows::cell(&mut text, &format!("  strength of the shim {}, T", shim.place), &number(shim.strength_t));
    }

    text += "\nplan: the upper side of each tile, and the direction of its mark in the film\n";
    text += &rows::headed(
        ["place", "tile", "centre, mm", "up", "mark", "placed"],
        PlanRow::in_placing_order(&found.plan).into_iter().map(row),
    );
    if let Some(path) = path {
        let path = path.display();
        let _ = writeln!(text, "\nwrote {path}; evaluate it with `magsplice decouple {path}`");
    }
    text
}

fn row(row: &PlanRow) -> [String; 6] {
    [
        row.place.clone(),
        row.tile.clone(),
        point(row.centre_mm),
        row.up.to_owned(),
        format!("{} at {} deg", row.mark, (row.mark_deg * 10.0).round() / 10.0),
        if row.is_placed { "yes" } else { "" }.to_owned(),
    ]
}

/// The plan as CSV, which `--placed` reads.
pub(super) fn plan_csv(rows: &[PlanRow]) -> String {
    let cells = |row: &PlanRow| {
        let mut cells = vec![row.place.clone(), row.tile.clone()];
        cells.extend(components(row.centre_mm).map(|value| value.to_string()));
        cells.extend([row.up.to_owned(), row.mark.to_owned(), row.mark_deg.to_string()]);
        cells.push(if row.is_placed { "yes" } else { "no" }.to_owned());
        cells
    };
    rows::csv(
        iter::once(PLAN_COLUMNS.map(str::to_owned).to_vec())
            .chain(PlanRow::in_placing_order(rows).into_iter().map(cells)),
    )
}
