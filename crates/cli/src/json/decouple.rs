//! `decouple`: the comparison, the decoupling errors and every point.

use magsplice::decouple::{PerAxis, PerParameter};
use magsplice::prelude::DVec3;
use magsplice_export::Table;
use serde::Serialize;

use super::compare::comparison;
use super::field::ColumnsJson;
use super::lengths::LengthsJson;
use super::renamed::RenamedJson;
use super::source::SourceJson;
use crate::evaluation::Evaluation;
use crate::remarks::about_amplitude;

/// The result of `decouple`.
#[derive(Serialize)]
pub(crate) struct DecoupleJson<'a> {
    #[serde(flatten)]
    source: SourceJson<'a>,
    points: usize,
    reference_mm: [f64; 3],
    /// Deviation of each parameter over the planes normal to its axis.
    uniformity_rmse: PerParameter<Option<f64>>,
    uniformity_rmse_mm: PerAxis<Option<f64>>,
    /// Error of each parameter's change from the reference point, against Eq. 2.
    ideal_rmse: PerParameter,
    /// The same as an error of the displacement found by Eq. 14.
    displacement_rmse_mm: LengthsJson,
    singular_points_mm: Vec<[f64; 3]>,
    comparison: RenamedJson,
    /// What an unusual result means, in words.
    #[serde(skip_serializing_if = "Option::is_none")]
    remark: Option<&'static str>,
    #[serde(flatten)]
    columns: Option<ColumnsJson<'a>>,
}

impl<'a> DecoupleJson<'a> {
    /// `table` is [`Evaluation::table`], or nothing to leave the points out.
    pub(crate) fn new(evaluation: &Evaluation<'a>, table: Option<&'a Table>) -> DecoupleJson<'a> {
        let Evaluation { film, ideal, volume, decoupling, .. } = evaluation;
        let k = ideal.wavenumber();
        DecoupleJson {
            source: SourceJson::new(film),
            points: volume.grid.len(),
            reference_mm: volume.reference_mm.to_array(),
            uniformity_rmse: decoupling.uniformity_rmse,
            uniformity_rmse_mm: decoupling.uniformity_rmse.to_array().map(|rmse| rmse.map(|rmse| rmse / k)).into(),
            ideal_rmse: decoupling.ideal_rmse,
            displacement_rmse_mm: DVec3::from(decoupling.displacement_rmse_mm).into(),
            singular_points_mm: decoupling.singular.iter().map(DVec3::to_array).collect(),
            comparison: comparison(&evaluation.comparison),
            remark: about_amplitude(evaluation.comparison.amplitude),
            columns: table.map(ColumnsJson::new),
        }
    }
}
