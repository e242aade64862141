//! `decouple` and `compare`: field, comparison with the ideal film, decoupling errors.

use std::fmt::Write;

use magsplice::decouple::{Decoupling, PerParameter};
use magsplice::ideal::{Comparison, IdealFilm};
use magsplice::layout::WorkingVolume;
use magsplice::prelude::DVec3;

use super::number::{number, uniformity_number};
use super::{header, rows};
use crate::evaluation::Evaluation;
use crate::failure::PRINTED_FAULTS;
use crate::remarks::about_amplitude;

const MT_PER_T: f64 = 1e3;

/// The report of `decouple`.
pub(crate) fn evaluation(evaluation: &Evaluation) -> String {
    let Evaluation { film, ideal, volume, field_t, reference_field_t, comparison: compared, decoupling: decoupled } =
        evaluation;
    let mut sections = vec![
        header::film(film, volume),
        field(field_t, volume, *reference_field_t, Some(ideal)),
        comparison(compared),
        decoupling(decoupled, volume, ideal.wavenumber()),
    ];
    sections.extend(film.recoil().map(|recoil| super::recoil::section(film, recoil)));
    sections.join("\n")
}

/// The field at the reference point, beside the ideal film's if there is one, and its range over
/// the volume.
pub(crate) fn field(
    field_t: &[DVec3],
    volume: &WorkingVolume,
    reference_field_t: DVec3,
    ideal: Option<&IdealFilm>,
) -> String {
    field_rows(field_t, "volume", volume.reference_mm, reference_field_t, ideal)
}

/// The field at the reference point, beside the ideal film's if there is one, and its range over
/// the volume or over points.
pub(crate) fn field_rows(
    field_t: &[DVec3],
    over: &str,
    r: DVec3,
    reference_field_t: DVec3,
    ideal: Option<&IdealFilm>,
) -> String {
    let mut text = String::new();
    rows::heading(&mut text, "field, mT", ["B_x", "B_y", "B_z"]);
    let at_reference = format!("  at the reference ({}, {}, {}) mm", r.x, r.y, r.z);
    rows::vector(&mut text, &at_reference, reference_field_t * MT_PER_T);
    if let Some(b) = ideal.and_then(|film| film.flux_density_t(r)) {
        rows::vector(&mut text, "  ideal film (Eq. 2) there", b * MT_PER_T);
    }
    let least = field_t.iter().copied().reduce(DVec3::min).unwrap_or_default();
    let most = field_t.iter().copied().reduce(DVec3::max).unwrap_or_default();
    rows::vector(&mut text, &format!("  least in the {over}"), least * MT_PER_T);
    rows::vector(&mut text, &format!("  most in the {over}"), most * MT_PER_T);
    text
}

/// The difference of the field from Eq. 2.
pub(crate) fn comparison(c: &Comparison) -> String {
    let mut text = String::new();
    rows::heading(&mut text, "against the ideal film (Eq. 2)", ["B_x", "B_y", "B_z"]);
    rows::vector(&mut text, "  RMSE, mT", c.component_rmse_t * MT_PER_T);
    let correlation = c.correlation.map(|r| r.map_or("constant".to_owned(), |r| format!("{r:.6}")));
    rows::cells(&mut text, "  correlation", correlation);
    rows::cell(&mut text, "  best-fit amplitude", &number(c.amplitude));
    if let Some(remark) = about_amplitude(c.amplitude) {
        rows::prose(&mut text, remark);
    }
    rows::cell(&mut text, "  relative RMSE as is", &number(c.relative_rmse));
    let scaled = c.scaled_relative_rmse.map_or("none".to_owned(), number);
    rows::cell(&mut text, "  relative RMSE after scaling", &scaled);
    let (worst_mt, w) = (c.worst_t * MT_PER_T, c.worst_at);
    let worst = format!("{worst_mt:>13.6}  at ({}, {}, {}) mm", w.x, w.y, w.z);
    rows::cell(&mut text, "  largest difference, mT", &worst);
    text
}

/// The decoupling errors, as parameters and as millimetres.
fn decoupling(d: &Decoupling, volume: &WorkingVolume, wavenumber: f64) -> String {
    let vector = |p: PerParameter| DVec3::new(p.r_x, p.r_y, p.s_z);
    let r = volume.reference_mm;
    let mut text = String::new();
    rows::heading(&mut text, "decoupling (Eq. 15)", ["R_x", "R_y", "S_z"]);
    let uniformity = d.uniformity_rmse.to_array();
    rows::cells(&mut text, "  uniformity RMSE", uniformity.map(uniformity_number));
    let lengths = uniformity.map(|rmse| uniformity_number(rmse.map(|rmse| rmse / wavenumber)));
    rows::cells(&mut text, "    as displacement x, y, z, mm", lengths);
    rows::vector(&mut text, "  RMSE against the ideal film", vector(d.ideal_rmse));
    rows::vector(&mut text, "    as displacement x, y, z, mm", d.displacement_rmse_mm.into());
    let _ = writeln!(text, "  changes are from the reference ({}, {}, {}) mm", r.x, r.y, r.z);
    let _ = match d.singular.len() {
        0 => writeln!(text, "  singular points (B_z = 0): none"),
        n => writeln!(text, "  singular points (B_z = 0), left out: {n}, at {}", first_points(&d.singular)),
    };
    text
}

pub(crate) fn first_points(points: &[DVec3]) -> String {
    let named: Vec<String> =
        points.iter().take(PRINTED_FAULTS).map(|p| format!("({}, {}, {})", p.x, p.y, p.z)).collect();
    let rest = if points.len() > PRINTED_FAULTS { " and more" } else { "" };
    format!("{}{rest} mm", named.join(" "))
}
