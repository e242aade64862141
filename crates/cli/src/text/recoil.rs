//! What recoil changes in a film: the solution with its errors, and estimates to first order.

use std::fmt::Write;

use magsplice::decouple::{Figure, Parameter};
use magsplice::layout::Layout;
use magsplice::magnet::Axis;
use magsplice::{FiguresWithRecoil, Film, FilmRecoil, RecoilEstimate, RecoilSummary};

use super::number::{counted, uniformity_number};
use super::rows;
use super::units::{in_mt, in_per_cent};

/// The line of a header: cells, and the error of B.
pub(crate) fn line(recoil: &FilmRecoil) -> String {
    let RecoilSummary { cells, level, change_t, error_t, .. } = recoil.summary;
    format!(
        "recoil: {} at level {level}, B changes by up to {} mT, known to {} mT\n",
        counted(cells, "cell", "cells"),
        short(in_mt(change_t)),
        short(in_mt(error_t))
    )
}

/// The section of a film: figures without and with recoil, what becomes of the tiles, and cells
/// beyond the knee.
pub(crate) fn section(film: &Film, recoil: &FilmRecoil) -> String {
    let mut text = String::new();
    rows::heading(&mut text, "recoil", ["without", "with", "known to"]);
    if let Some(FiguresWithRecoil { without, with_recoil, errors }) = recoil.summary.figures {
        for (label, figure) in LABELS {
            let [without, with] = [&without, &with_recoil].map(|of| uniformity_number(of.get(figure).copied()));
            let error = errors.get(figure).map_or(String::new(), |error| short(*error));
            rows::cells(&mut text, &format!("  {label}"), [without, with, error]);
        }
    }
    let changes = recoil.tile_changes();
    let least = changes.iter().map(|change| in_per_cent(change.weakening)).fold(f64::INFINITY, f64::min);
    let _ = writeln!(
        text,
        "  tiles weaken by {} to {} %, and turn by up to {} degrees",
        short(least),
        short(in_per_cent(recoil.summary.largest_weakening)),
        short(recoil.summary.largest_turn_deg.max(0.0))
    );
    if let Some(knee_t) = film.layout().material.knee_field_t {
        let none = || format!("no cell is beyond the knee at mu0 H = -{knee_t} T");
        let _ = writeln!(text, "  {}", beyond_knee(recoil, film.layout()).unwrap_or_else(none));
    }
    text
}

/// The part of a film that is beyond the knee of its material. `None` if there is none, or no knee
/// is stated.
pub(crate) fn beyond_knee(recoil: &FilmRecoil, layout: &Layout) -> Option<String> {
    let (cells, share) = recoil.beyond_knee(layout)?;
    let worst = cells.iter().min_by(|a, b| a.field_t.total_cmp(&b.field_t))?;
    Some(format!(
        "{} of the volume is beyond the knee at mu0 H = -{} T, and loses polarization for good: the worst cell, of tile \
         \"{}\", has {} T",
        percent(share),
        layout.material.knee_field_t.unwrap_or_default(),
        layout.tiles[worst.tile].name,
        short(worst.field_t)
    ))
}

/// An estimate in one line: the changes of the figures.
pub(crate) fn estimate(estimate: &RecoilEstimate) -> String {
    let RecoilEstimate { recoil_permeability, without, with_recoil } = estimate;
    let of = recoil_permeability.map_or("as stated".to_owned(), |mu_r| format!("mu_r {mu_r}"));
    let amplitude = with_recoil.amplitude / without.amplitude - 1.0;
    let mut text = format!("{of}: amplitude {} %", signed(in_per_cent(amplitude)));
    for (label, figure, unit) in CHANGES {
        let change = with_recoil.get(figure).zip(without.get(figure)).map(|(with, without)| with - without);
        let change = change.map_or("one point".to_owned(), |change| format!("{}{unit}", signed(change)));
        let _ = write!(text, ", {label} {change}");
    }
    text
}

/// Labels of figures in the section.
const LABELS: [(&str, Figure); 7] = [
    ("best-fit amplitude", Figure::Amplitude),
    ("uniformity RMSE R_x", Figure::Uniformity(Parameter::Rx)),
    ("uniformity RMSE R_y", Figure::Uniformity(Parameter::Ry)),
    ("uniformity RMSE S_z", Figure::Uniformity(Parameter::Sz)),
    ("displacement RMSE x, mm", Figure::Displacement(Axis::X)),
    ("displacement RMSE y, mm", Figure::Displacement(Axis::Y)),
    ("displacement RMSE z, mm", Figure::Displacement(Axis::Z)),
];

/// Labels of changes in the line of an estimate, with units.
const CHANGES: [(&str, Figure, &str); 6] = [
    ("R_x", Figure::Uniformity(Parameter::Rx), ""),
    ("R_y", Figure::Uniformity(Parameter::Ry), ""),
    ("S_z", Figure::Uniformity(Parameter::Sz), ""),
    ("dx", Figure::Displacement(Axis::X), " mm"),
    ("dy", Figure::Displacement(Axis::Y), " mm"),
    ("dz", Figure::Displacement(Axis::Z), " mm"),
];

/// Two significant digits.
fn short(value: f64) -> String {
    if value == 0.0 || (0.01..1e4).contains(&value.abs()) {
        let decimals = if value == 0.0 { 0 } else { (1.0 - value.abs().log10().floor()).max(0.0) as usize };
        format!("{value:.decimals$}")
    } else {
        format!("{value:.1e}")
    }
}

fn signed(value: f64) -> String {
    if value > 0.0 { format!("+{}", short(value)) } else { short(value) }
}

fn percent(share: f64) -> String {
    format!("{} %", short(in_per_cent(share)))
}
