//! `decouple --points`: parameters and errors at points.

use std::fmt::Write;

use magsplice::decouple::PerParameter;
use magsplice::prelude::DVec3;

use super::decouple::{comparison, field_rows, first_points};
use super::{header, rows};
use crate::failure::PRINTED_FAULTS;
use crate::point_evaluation::PointEvaluation;

/// Why there is no uniformity RMSE.
pub(crate) const NO_UNIFORMITY: &str = "needs the planes of a grid, as without --points";

/// The report of `decouple --points`.
pub(crate) fn evaluation(evaluation: &PointEvaluation) -> String {
    let PointEvaluation { film, ideal, volume, given, field_t, reference_field_t, comparison: compared, .. } =
        evaluation;
    let sections = [
        header::film_at_points(film, given.path, given.points.len()),
        field_rows(field_t, "points", volume.reference_mm, *reference_field_t, Some(ideal)),
        comparison(compared),
        decoupling(evaluation),
        each_point(evaluation),
    ];
    sections.into_iter().filter(|section| !section.is_empty()).collect::<Vec<_>>().join("\n")
}

fn decoupling(evaluation: &PointEvaluation) -> String {
    let d = &evaluation.decoupling;
    let vector = |p: PerParameter| DVec3::new(p.r_x, p.r_y, p.s_z);
    let r = evaluation.volume.reference_mm;
    let mut text = String::new();
    rows::heading(&mut text, "decoupling (Eq. 15)", ["R_x", "R_y", "S_z"]);
    rows::vector(&mut text, "  RMSE against the ideal film", vector(d.ideal_rmse));
    let lengths = d.ideal_rmse.as_lengths(evaluation.ideal.wavenumber());
    rows::vector(&mut text, "    as displacement x, y, z, mm", lengths);
    if let Some((at, worst)) = evaluation.worst_mm() {
        rows::vector(&mut text, "  largest displacement error, mm", worst);
        let _ = writeln!(text, "    at ({}, {}, {}) mm", at.x, at.y, at.z);
    }
    let _ = writeln!(text, "  changes are from the reference ({}, {}, {}) mm", r.x, r.y, r.z);
    let _ = match d.singular.len() {
        0 => writeln!(text, "  singular points (B_z = 0): none"),
        n => writeln!(text, "  singular points (B_z = 0), left out: {n}, at {}", first_points(&d.singular)),
    };
    let _ = writeln!(text, "  uniformity RMSE: left out, {NO_UNIFORMITY}");
    text
}

/// Parameters and displacement errors at each of a few points; nothing for many.
fn each_point(evaluation: &PointEvaluation) -> String {
    let points = &evaluation.given.points;
    if points.len() > PRINTED_FAULTS {
        return format!("{} points: -o FILE.csv writes the parameters and errors at each\n", points.len());
    }
    let mut text = String::new();
    rows::heading(&mut text, "at each point", ["R_x, rad", "R_y, rad", "S_z"]);
    for (index, p) in points.iter().enumerate() {
        let label = format!("  ({}, {}, {}) mm", p.x, p.y, p.z);
        match (&evaluation.decoupling.parameters[index], evaluation.displacement_error_mm(index)) {
            (Some(at), Some(error)) => {
                rows::vector(&mut text, &label, DVec3::new(at.r_x, at.r_y, at.s_z));
                rows::vector(&mut text, "    displacement error, mm", error);
            }
            _ => rows::cell(&mut text, &label, "singular"),
        }
    }
    text
}
