//! `scan`: what was fitted, and the uniformity of the readings.

use magsplice::Film;
use magsplice::scan::ScanParameters;
use serde::Serialize;

use crate::sensor::scanned_film::ScannedFilm;
use magsplice::results::Source;

/// The result of `scan`.
#[derive(Serialize)]
pub(crate) struct ScanJson {
    #[serde(flatten)]
    source: Source,
    readings: usize,
    /// Counts of positions along x, y, z; null if they are no grid.
    grid: Option<[usize; 3]>,
    missing_mm: Vec<[f64; 3]>,
    /// Lines.
    repeated: Vec<u64>,
    fitted: ParametersJson,
    deviation: ParametersJson,
    residual_t: f64,
    /// Lines of the readings that were left out.
    left_out: Vec<u64>,
    uniformity_rmse: Option<UniformityJson>,
}

#[derive(Serialize)]
struct ParametersJson {
    strength: f64,
    offset_t: [f64; 3],
    rotation_deg: [f64; 3],
    start_mm: [f64; 3],
}

/// R_x, R_y, S_z.
#[derive(Serialize)]
struct UniformityJson {
    readings: [Option<f64>; 3],
    corrected: [Option<f64>; 3],
    simulated: [Option<f64>; 3],
    singular: usize,
}

impl ScanJson {
    pub(crate) fn new(film: &Film, scanned: &ScannedFilm) -> ScanJson {
        let parameters = |of: &ScanParameters| ParametersJson {
            strength: of.strength,
            offset_t: of.offset_t.to_array(),
            rotation_deg: of.rotation_rad.map(f64::to_degrees).to_array(),
            start_mm: of.start.to_array(),
        };
        let uniformity = |of: &crate::sensor::scanned_film::Uniformity| UniformityJson {
            readings: of.readings,
            corrected: of.corrected,
            simulated: of.simulated,
            singular: of.singular,
        };
        ScanJson {
            source: Source::of(film),
            readings: scanned.places_mm.len(),
            grid: scanned.positions.grid,
            missing_mm: scanned.positions.missing.iter().map(|place| place.to_array()).collect(),
            repeated: scanned.positions.repeated.iter().map(|index| scanned.lines[*index]).collect(),
            fitted: parameters(&scanned.fit.parameters),
            deviation: parameters(&scanned.fit.deviations),
            residual_t: scanned.fit.noise_t,
            left_out: scanned.fit.outliers.iter().map(|index| scanned.lines[*index]).collect(),
            uniformity_rmse: scanned.uniformity.as_ref().map(uniformity),
        }
    }
}
