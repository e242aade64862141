//! Results as a designer reads them: short tables with units.

use std::fmt::Write;
use std::path::Path;

use magsplice::decouple::Decoupling;
use magsplice::field::{Comparison, IdealFilm};
use magsplice::layout::{Layout, WorkingVolume};
use magsplice::prelude::DVec3;
use magsplice::{Film, FilmError};
use serde::Serialize;

use crate::failure::{Failure, PRINTED_FAULTS};
use crate::points::Faults;
use crate::verbs::field::cause_in_words;

const MT: f64 = 1e3;

/// A result as JSON, one line per value.
pub(crate) fn json(report: &impl Serialize) -> String {
    let mut text = serde_json::to_string_pretty(report).expect("reports hold numbers and strings only");
    text.push('\n');
    text
}

/// Name, hash, working volume, and how exact its field is.
pub(crate) fn header(film: &Film, volume: &WorkingVolume) -> String {
    let layout = film.layout();
    let (l, u, s) = (volume.lower_mm, volume.upper_mm, volume.step_mm);
    let step = if s.x == s.y && s.x == s.z { format!("{}", s.x) } else { format!("{}, {}, {}", s.x, s.y, s.z) };
    let tiles = tile_count(layout);
    format!(
        "{}: {tiles}, sha256 {}\nworking volume: x {} .. {}, y {} .. {}, z {} .. {} mm, step {step} mm, {} points\naccuracy: {}\n",
        layout.name,
        &layout.sha256[..12],
        l.x,
        u.x,
        l.y,
        u.y,
        l.z,
        u.z,
        volume.grid.len(),
        film.scene().accuracy()
    )
}

pub(crate) fn tile_count(layout: &Layout) -> String {
    match layout.tiles.len() {
        1 => "1 tile".to_owned(),
        n => format!("{n} tiles"),
    }
}

/// The field at the reference point, beside the ideal film's if there is one, and its range over the volume.
pub(crate) fn field(
    field_t: &[DVec3],
    volume: &WorkingVolume,
    at_reference: DVec3,
    ideal: Option<&IdealFilm>,
) -> String {
    let r = volume.reference_mm;
    let mut text = format!("{:<38}{:>13}{:>13}{:>13}\n", "field, mT", "B_x", "B_y", "B_z");
    row(&mut text, &format!("  at the reference ({}, {}, {}) mm", r.x, r.y, r.z), at_reference * MT);
    if let Some(b) = ideal.and_then(|film| film.flux_density_t(r)) {
        row(&mut text, "  ideal film (Eq. 2) there", b * MT);
    }
    let least = field_t.iter().copied().reduce(DVec3::min).unwrap_or_default();
    let most = field_t.iter().copied().reduce(DVec3::max).unwrap_or_default();
    row(&mut text, "  least in the volume", least * MT);
    row(&mut text, "  most in the volume", most * MT);
    text
}

/// How far the field is from Eq. 2.
pub(crate) fn comparison(c: &Comparison) -> String {
    let mut text = format!("{:<38}{:>13}{:>13}{:>13}\n", "against the ideal film (Eq. 2)", "B_x", "B_y", "B_z");
    row(&mut text, "  RMSE, mT", c.component_rmse_t * MT);
    let correlations = c.correlation.map(|r| r.map_or("constant".to_owned(), |r| format!("{r:.6}")));
    let [x, y, z] = correlations;
    let w = c.worst_at;
    let _ = writeln!(text, "{:<38}{x:>13}{y:>13}{z:>13}", "  correlation");
    let _ = writeln!(text, "{:<38}{:>13}", "  best-fit amplitude", number(c.amplitude));
    let _ = writeln!(text, "{:<38}{:>13}", "  relative RMSE as is", number(c.relative_rmse));
    let _ = writeln!(
        text,
        "{:<38}{:>13}",
        "  relative RMSE after scaling",
        c.scaled_relative_rmse.map_or("none".to_owned(), number)
    );
    let _ =
        writeln!(text, "{:<38}{:>13.6}  at ({}, {}, {}) mm", "  largest difference, mT", c.worst_t * MT, w.x, w.y, w.z);
    text
}

/// The decoupling errors, as parameters and as millimetres.
pub(crate) fn decoupling(d: &Decoupling, volume: &WorkingVolume, wavenumber: f64) -> String {
    let vector = |p: magsplice::decouple::PerParameter| DVec3::new(p.r_x, p.r_y, p.s_z);
    let r = volume.reference_mm;
    let mut text = format!("{:<38}{:>13}{:>13}{:>13}\n", "decoupling (Eq. 15)", "R_x", "R_y", "S_z");
    row(&mut text, "  uniformity RMSE", vector(d.uniformity_rmse));
    row(&mut text, "    as displacement x, y, z, mm", d.uniformity_rmse.as_lengths(wavenumber));
    row(&mut text, "  RMSE against the ideal film", vector(d.ideal_rmse));
    row(&mut text, "    as displacement x, y, z, mm", d.ideal_rmse.as_lengths(wavenumber));
    let _ = writeln!(text, "  changes are from the reference ({}, {}, {}) mm", r.x, r.y, r.z);
    let _ = match d.singular.len() {
        0 => writeln!(text, "  singular points (B_z = 0): none"),
        n => writeln!(text, "  singular points (B_z = 0), left out: {n}, at {}", some_points(&d.singular)),
    };
    text
}

fn some_points(points: &[DVec3]) -> String {
    let named: Vec<String> =
        points.iter().take(PRINTED_FAULTS).map(|p| format!("({}, {}, {})", p.x, p.y, p.z)).collect();
    let rest = if points.len() > PRINTED_FAULTS { " and more" } else { "" };
    format!("{}{rest} mm", named.join(" "))
}

fn row(text: &mut String, label: &str, v: DVec3) {
    // Beside the largest of the three, round-off is zero.
    let noise = 1e-12 * v.abs().max_element();
    let [x, y, z] = v.to_array().map(|c| number(if c.abs() <= noise { 0.0 } else { c }));
    let _ = writeln!(text, "{label:<38}{x:>13}{y:>13}{z:>13}");
}

/// Six decimals, or six digits where those would not show it or not fit.
pub(crate) fn number(value: f64) -> String {
    if value == 0.0 || (1e-3..1e5).contains(&value.abs()) {
        format!("{:.6}", value + 0.0)
    } else {
        format!("{value:.5e}")
    }
}

/// A film's error with its file, and with tiles by name.
pub(crate) fn film_failure(path: &Path, layout: &Layout, error: FilmError) -> Failure {
    let FilmError::Points(errors) = error else {
        return Failure::Film { layout: path.to_owned(), error };
    };
    let mut faults = Faults::default();
    for error in errors.0 {
        let p = error.point;
        faults.add(0, format!("point ({}, {}, {}) mm: {}", p.x, p.y, p.z, cause_in_words(error.cause, layout)));
    }
    faults.failure(path.display().to_string())
}
