//! `calibrate`: the fitted coefficients.

use magsplice::Film;
use magsplice::sensor::Stiffness;
use serde::Serialize;

use crate::sensor::calibration::Calibration;
use magsplice::results::Source;

/// The result of `calibrate`.
#[derive(Serialize)]
pub(crate) struct CalibrationJson {
    #[serde(flatten)]
    source: Source,
    readings: usize,
    /// Stiffness of [elastomer] by Hooke's law along x, y, z.
    hooke_n_per_mm: Option<[f64; 3]>,
    by_field: AxesJson,
    by_closed_form: Option<AxesJson>,
}

#[derive(Serialize)]
struct AxesJson {
    x: StiffnessJson,
    y: StiffnessJson,
    z: StiffnessJson,
}

/// Half widths of intervals of 95 % confidence end in `_95`.
#[derive(Serialize)]
struct StiffnessJson {
    stiffness_n_per_mm: f64,
    stiffness_n_per_mm_95: f64,
    force_at_rest_n: f64,
    force_at_rest_n_95: f64,
    residual_n: f64,
}

impl CalibrationJson {
    pub(crate) fn new(film: &Film, calibration: &Calibration) -> CalibrationJson {
        CalibrationJson {
            source: Source::of(film),
            readings: calibration.readings,
            hooke_n_per_mm: calibration.hooke_n_per_mm.map(|stiffness| stiffness.to_array()),
            by_field: AxesJson::from(&calibration.by_field),
            by_closed_form: calibration.by_closed_form.as_ref().map(AxesJson::from),
        }
    }
}

impl From<&[Stiffness; 3]> for AxesJson {
    fn from(axes: &[Stiffness; 3]) -> AxesJson {
        let [x, y, z] = axes.each_ref().map(|axis| StiffnessJson {
            stiffness_n_per_mm: axis.stiffness,
            stiffness_n_per_mm_95: axis.stiffness_95,
            force_at_rest_n: axis.force_at_rest,
            force_at_rest_n_95: axis.force_at_rest_95,
            residual_n: axis.residual,
        });
        AxesJson { x, y, z }
    }
}
