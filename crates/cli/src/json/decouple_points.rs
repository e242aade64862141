//! `decouple --points`: the comparison, the errors and every point.

use magsplice::decouple::PerParameter;
use magsplice::prelude::DVec3;
use magsplice_export::Table;
use serde::Serialize;

use super::compare::comparison;
use super::field::ColumnsJson;
use super::lengths::LengthsJson;
use super::renamed::RenamedJson;
use super::source::SourceJson;
use crate::point_evaluation::PointEvaluation;
use crate::text::decouple_points::NO_UNIFORMITY;

/// The result of `decouple --points`.
#[derive(Serialize)]
pub(crate) struct DecouplePointsJson<'a> {
    #[serde(flatten)]
    source: SourceJson<'a>,
    points: usize,
    reference_mm: [f64; 3],
    /// Error of each parameter's change from the reference point, against Eq. 2.
    ideal_rmse: PerParameter,
    /// The same as an error of the displacement found by Eq. 14.
    displacement_rmse_mm: LengthsJson,
    worst_displacement_error_mm: Option<LengthsJson>,
    worst_displacement_at_mm: Option<[f64; 3]>,
    singular_points_mm: Vec<[f64; 3]>,
    /// What `decouple` without points has besides, and why it is not here.
    left_out: LeftOutJson,
    comparison: RenamedJson,
    #[serde(flatten)]
    columns: ColumnsJson<'a>,
}

#[derive(Serialize)]
struct LeftOutJson {
    uniformity_rmse: &'static str,
}

impl<'a> DecouplePointsJson<'a> {
    /// `table` is [`PointEvaluation::table`].
    pub(crate) fn new(evaluation: &PointEvaluation<'a>, table: &'a Table) -> DecouplePointsJson<'a> {
        let PointEvaluation { film, volume, given, decoupling, .. } = evaluation;
        let worst = evaluation.worst_mm();
        DecouplePointsJson {
            source: SourceJson::new(film),
            points: given.points.len(),
            reference_mm: volume.reference_mm.to_array(),
            ideal_rmse: decoupling.ideal_rmse,
            displacement_rmse_mm: DVec3::from(decoupling.displacement_rmse_mm).into(),
            worst_displacement_error_mm: worst.map(|(_, error)| error.into()),
            worst_displacement_at_mm: worst.map(|(at, _)| at.to_array()),
            singular_points_mm: decoupling.singular.iter().map(DVec3::to_array).collect(),
            left_out: LeftOutJson { uniformity_rmse: NO_UNIFORMITY },
            comparison: comparison(&evaluation.comparison),
            columns: ColumnsJson::new(table),
        }
    }
}
