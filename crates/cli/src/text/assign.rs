//! `assign`: the errors of the film, and the plan.

use std::fmt::Write;
use std::path::Path;

use magsplice::making::PlanRow;

use super::number::{counted, number};
use super::{header, rows};
use crate::laying::assigned_film::AssignedFilm;

/// The summary of `assign`. `path` is that of the layout that was written.
pub(crate) fn assigned(film: &AssignedFilm, path: Option<&Path>) -> String {
    let mut text = header::with_recoil(film.layout, film.recoil.as_ref());
    let laid = film.assignment.plan.iter().filter(|row| row.is_laid).count();
    let shims = film.assignment.shims.len();
    let spares = film.measured.saturating_sub(film.assignment.plan.len() - shims);
    let _ =
        write!(text, "{} measured, {}", counted(film.measured, "tile", "tiles"), counted(spares, "spare", "spares"));
    if laid > 0 {
        let _ = write!(text, ", {laid} laid already");
    }
    text += "\n\n";

    text += "RMS displacement error over the working volume and its three axes, mm\n";
    rows::cell(&mut text, "  film as ordered", &number(film.assignment.ordered_rms_mm));
    rows::cell(&mut text, "  tiles in the order of the list", &number(film.assignment.found.in_order_rms_mm));
    rows::cell(&mut text, "  tiles as assigned", &number(film.assignment.found.rms_mm));
    if let Some((_, with_errors)) = &film.assignment.measurement {
        rows::cell(&mut text, "  with errors of measurement, mean", &number(with_errors.mean.value));
        rows::cell(&mut text, "    95 % of films are below", &number(with_errors.p95.value));
    }
    let (median, near) = film.starts();
    let starts = film.assignment.found.starts_rms_mm.len();
    rows::prose(
        &mut text,
        &format!(
            "{near} of {} ended within 10 % of the best; their median is {median:.2} times the best",
            counted(starts, "start", "starts")
        ),
    );
    for (shim, strength_t) in &film.assignment.shims {
        let name = &film.layout.tiles[*shim].name;
        rows::cell(&mut text, &format!("  strength of the shim {name}, T"), &number(*strength_t));
    }

    text += "\nplan: the side of each tile that is up, and where its mark points in the film\n";
    let head = ["place", "tile", "centre, mm", "up", "mark", "laid"].map(str::to_owned);
    let lines: Vec<[String; 6]> = std::iter::once(head).chain(film.assignment.plan.iter().map(row)).collect();
    rows::columns(&lines).into_iter().for_each(|line| text += &(line + "\n"));
    if let Some(path) = path {
        let path = path.display();
        let _ = writeln!(text, "\nwrote {path}; evaluate it with `magsplice decouple {path}`");
    }
    text
}

fn row(row: &PlanRow) -> [String; 6] {
    let centre = row.centre_mm.to_array().map(|value| magsplice::results::twelve_digits(value).to_string());
    [
        row.place.clone(),
        row.tile.clone(),
        format!("({})", centre.join(", ")),
        row.up.to_owned(),
        format!("{} at {} deg", row.mark, (row.mark_deg * 10.0).round() / 10.0),
        if row.is_laid { "yes" } else { "" }.to_owned(),
    ]
}
