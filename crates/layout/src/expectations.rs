//! What a layout states its film must meet.

use std::ops::Range;
use std::path::PathBuf;

use crate::resolve::Problems;
use crate::written::{DisplacementBounds, Expect, FieldBaseline, Least, UniformityBounds};

/// The table `[expect]`; nothing is expected of what is `None`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Expectations {
    /// Largest uniformity RMSE of R_x, R_y and S_z over the working volume.
    pub uniformity_rmse: [Option<f64>; 3],
    /// Largest RMSE of displacement along x, y, z over the working volume, in millimetres.
    pub displacement_rmse_mm: [Option<f64>; 3],
    /// Least best-fit amplitude against the ideal film.
    pub least_amplitude: Option<f64>,
    /// The field of the working volume as it was.
    pub field: Option<ExpectedField>,
    /// Least distance of the tiles from the working volume, in millimetres.
    pub least_clearance_mm: Option<f64>,
}

/// A baseline and how near to it the field must be.
#[derive(Clone, Debug, PartialEq)]
pub struct ExpectedField {
    /// The file as written: relative to the folder of the layout.
    pub file: PathBuf,
    /// Largest difference at any point, as a fraction of |B| there.
    pub within: f64,
}

impl Expectations {
    /// Whether nothing is expected.
    pub fn is_empty(&self) -> bool {
        *self == Expectations::default()
    }

    pub(crate) fn written(&self) -> Option<Expect> {
        let [r_x, r_y, s_z] = self.uniformity_rmse;
        let [x, y, z] = self.displacement_rmse_mm;
        let least = |min: Option<f64>| min.map(|min| Least { min });
        (!self.is_empty()).then(|| Expect {
            uniformity_rmse: (self.uniformity_rmse != [None; 3]).then_some(UniformityBounds { r_x, r_y, s_z }),
            displacement_rmse_mm: (self.displacement_rmse_mm != [None; 3]).then_some(DisplacementBounds { x, y, z }),
            amplitude: least(self.least_amplitude),
            field: self.field.as_ref().map(|field| FieldBaseline {
                file: field.file.to_str().expect("it was written as text").to_owned(),
                within: field.within,
            }),
            clearance_mm: least(self.least_clearance_mm),
        })
    }
}

/// Which tables a layout has, so that expectations which need one are not left hanging.
pub(crate) struct Present {
    pub(crate) ideal: bool,
    pub(crate) volume: bool,
}

pub(crate) fn resolve(
    written: Expect,
    span: &Range<usize>,
    present: &Present,
    problems: &mut Problems,
) -> Expectations {
    let mut report = |message: String| problems.add(Some(span), "expect", message);
    let Expect { uniformity_rmse, displacement_rmse_mm, amplitude, field, clearance_mm } = written;
    let uses = [
        ("uniformity_rmse", uniformity_rmse.is_some(), true),
        ("displacement_rmse_mm", displacement_rmse_mm.is_some(), true),
        ("amplitude", amplitude.is_some(), true),
        ("field", field.is_some(), false),
        ("clearance_mm", clearance_mm.is_some(), false),
    ];
    if uses.iter().all(|(_, used, _)| !used) {
        report(
            "is empty, must give at least one of uniformity_rmse, displacement_rmse_mm, amplitude, field, clearance_mm"
                .to_owned(),
        );
    }
    for (key, _, needs_ideal) in uses.into_iter().filter(|(_, used, _)| *used) {
        let missing = [("[ideal]", needs_ideal && !present.ideal), ("[volume]", !present.volume)];
        for (table, _) in missing.into_iter().filter(|(_, missing)| *missing) {
            report(format!("{key} needs the table {table}, which the layout does not have"));
        }
    }
    if let Some(UniformityBounds { r_x: None, r_y: None, s_z: None }) = uniformity_rmse {
        report("uniformity_rmse is empty, must give at least one of r_x, r_y, s_z".to_owned());
    }
    let bounds = uniformity_rmse.map_or([None; 3], |b| [b.r_x, b.r_y, b.s_z]);
    for (key, bound) in ["r_x", "r_y", "s_z"].into_iter().zip(bounds) {
        if let Some(bound) = bound.filter(|b| !(b.is_finite() && *b >= 0.0)) {
            report(format!("uniformity_rmse.{key} = {bound}, must be a finite number of at least 0"));
        }
    }
    if let Some(DisplacementBounds { x: None, y: None, z: None }) = displacement_rmse_mm {
        report("displacement_rmse_mm is empty, must give at least one of x, y, z".to_owned());
    }
    let displacement = displacement_rmse_mm.map_or([None; 3], |b| [b.x, b.y, b.z]);
    for (key, bound) in ["x", "y", "z"].into_iter().zip(displacement) {
        if let Some(bound) = bound.filter(|b| !(b.is_finite() && *b >= 0.0)) {
            report(format!("displacement_rmse_mm.{key} = {bound}, must be a finite number of at least 0"));
        }
    }
    for (key, least) in [("amplitude", &amplitude), ("clearance_mm", &clearance_mm)] {
        if let Some(Least { min }) = least.as_ref().filter(|least| !least.min.is_finite()) {
            report(format!("{key}.min = {min}, must be a finite number"));
        }
    }
    if let Some(FieldBaseline { file, within }) = &field {
        if file.is_empty() {
            report("field.file is empty, must name a CSV file".to_owned());
        }
        if !(within.is_finite() && *within > 0.0) {
            report(format!("field.within = {within}, must be a finite number greater than 0, a fraction of |B|"));
        }
    }
    Expectations {
        uniformity_rmse: bounds,
        displacement_rmse_mm: displacement,
        least_amplitude: amplitude.map(|least| least.min),
        field: field.map(|field| ExpectedField { file: PathBuf::from(field.file), within: field.within }),
        least_clearance_mm: clearance_mm.map(|least| least.min),
    }
}
