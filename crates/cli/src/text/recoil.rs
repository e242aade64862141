//! What recoil changes in a film: the solution with its errors, and estimates to first order.

use std::fmt::Write;

use magsplice::decouple::PerParameter;
use magsplice::layout::Layout;
use magsplice::{Film, FilmRecoil, RecoilEstimate, RecoilFigures};

use super::number::{counted, number};
use super::rows;

const MT_PER_T: f64 = 1e3;

/// The line of a header: cells, and the error of B.
pub(crate) fn line(recoil: &FilmRecoil) -> String {
    format!(
        "recoil: {} at level {}, B changes by up to {} mT, known to {} mT\n",
        counted(recoil.magnetization().cells().len(), "cell", "cells"),
        recoil.level(),
        short(recoil.change_t() * MT_PER_T),
        short(recoil.error_t() * MT_PER_T)
    )
}

/// The section of a film: figures without and with recoil, what becomes of the tiles, and cells
/// beyond the knee.
pub(crate) fn section(film: &Film, recoil: &FilmRecoil) -> String {
    let mut text = String::new();
    rows::heading(&mut text, "recoil", ["without", "with", "known to"]);
    if let (Some([rigid, with]), Some(errors)) = (recoil.figures(), recoil.figure_errors()) {
        for ((label, rigid), ((_, with), (_, error))) in
            named(&rigid).into_iter().zip(named(&with).into_iter().zip(named(&errors)))
        {
            rows::cells(&mut text, &format!("  {label}"), [number(rigid), number(with), short(error)]);
        }
    }
    let changes = recoil.tile_changes();
    let weakening = || changes.iter().map(|change| 100.0 * change.weakening);
    let turn_deg = changes.iter().map(|change| change.angle.to_degrees()).fold(0.0, f64::max);
    let (least, most) = (weakening().fold(f64::INFINITY, f64::min), weakening().fold(f64::NEG_INFINITY, f64::max));
    let _ = writeln!(
        text,
        "  tiles weaken by {} to {} %, and turn by up to {} degrees",
        short(least),
        short(most),
        short(turn_deg)
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
    let RecoilEstimate { permeability, rigid, recoil } = estimate;
    let of = permeability.map_or("as stated".to_owned(), |mu_r| format!("mu_r {mu_r}"));
    let amplitude = recoil.amplitude / rigid.amplitude - 1.0;
    let mut text = format!("{of}: amplitude {} %", signed(100.0 * amplitude));
    let of_axes = |figures: &RecoilFigures| {
        let PerParameter { r_x, r_y, s_z } = figures.uniformity_rmse;
        let d = figures.displacement_rmse_mm;
        [
            ("R_x", r_x, ""),
            ("R_y", r_y, ""),
            ("S_z", s_z, ""),
            ("dx", d.x, " mm"),
            ("dy", d.y, " mm"),
            ("dz", d.z, " mm"),
        ]
    };
    for ((label, rigid, unit), (_, recoil, _)) in of_axes(rigid).into_iter().zip(of_axes(recoil)) {
        let _ = write!(text, ", {label} {}{unit}", signed(recoil - rigid));
    }
    text
}

fn named(figures: &RecoilFigures) -> [(&'static str, f64); 7] {
    let PerParameter { r_x, r_y, s_z } = figures.uniformity_rmse;
    let d = figures.displacement_rmse_mm;
    [
        ("best-fit amplitude", figures.amplitude),
        ("uniformity RMSE R_x", r_x),
        ("uniformity RMSE R_y", r_y),
        ("uniformity RMSE S_z", s_z),
        ("displacement RMSE x, mm", d.x),
        ("displacement RMSE y, mm", d.y),
        ("displacement RMSE z, mm", d.z),
    ]
}

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
    format!("{} %", short(100.0 * share))
}
