//! A measured scan of the field of a film, fitted and compared with the layout.

use std::ops::RangeInclusive;

use glam::DVec3;
use magsplice_decouple::{Branch, Parameters, PerParameter, uniformity_by_planes};
use magsplice_magnet::Grid;
use magsplice_scan::{FreeParameters, ScanError, ScanParameters, ScanPositions, fit_scan};
use serde::Serialize;

use super::source::Source;
use super::table::{ColumnQuantity, Points, Table};
use crate::film::Film;
use crate::film_error::FilmError;
use crate::stage::Stage;

/// Strengths of a film that was made, over the strength of its layout: magnets of half or twice the
/// strength were not ordered.
const PLAUSIBLE_STRENGTHS: RangeInclusive<f64> = 0.5..=2.0;

/// Residual over the noise of the sensor from which on the film is not as ordered. The deviation of
/// the residuals is right to a per cent for a scan of thousands of readings, and the noise that a
/// datasheet states to a factor of two.
const MOST_RESIDUAL: f64 = 3.0;

/// A scan that was fitted. Its readings have numbers, such as their lines in a file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FilmScan {
    /// The film.
    #[serde(flatten)]
    pub source: Source,
    /// Number of readings.
    pub readings: usize,
    /// Counts of positions along x, y, z. `None` if they are no grid.
    pub grid: Option<[usize; 3]>,
    /// Positions of the grid without a reading.
    pub missing_mm: Vec<DVec3>,
    /// Numbers of the readings at a position that an earlier one has.
    pub repeated: Vec<u64>,
    /// The fitted parameters.
    pub fitted: FittedScan,
    /// Their standard deviations; 0 for those that were not fitted.
    pub deviation: FittedScan,
    /// Standard deviation of the residuals of one component, without the excluded readings.
    pub residual_t: f64,
    /// Numbers of the excluded readings.
    pub excluded: Vec<u64>,
    /// With an ideal film.
    pub uniformity_rmse: Option<ScanUniformity>,
    /// The same as `excluded`, by indices of readings in ascending order.
    #[serde(skip)]
    pub outliers: Vec<usize>,
    /// Reading minus fit, along the axes of the sensor.
    #[serde(skip)]
    pub residuals_t: Vec<DVec3>,
    /// Where the sensor was, in the frame of the film.
    #[serde(skip)]
    pub places_mm: Vec<DVec3>,
    /// Readings without offset and rotation of the sensor, in the frame of the film.
    #[serde(skip)]
    pub corrected_t: Vec<DVec3>,
    /// The field of the layout, times the fitted strength.
    #[serde(skip)]
    pub simulated_t: Vec<DVec3>,
    /// Largest noise of the sensor of the layout; 0 without one.
    #[serde(skip)]
    pub sensor_noise_t: f64,
}

/// What is not known of a scan beforehand.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FittedScan {
    /// Strength of all tiles over the strength of the layout.
    pub strength: f64,
    /// Offset of the sensor and uniform stray field together.
    pub offset_t: DVec3,
    /// Rotation vector of the sensor.
    pub rotation_deg: DVec3,
    /// Position of the sensor where the scan has its origin.
    pub start_mm: DVec3,
}

/// Uniformity RMSE of R_x, R_y, S_z, without the excluded readings. `None` where no plane has two
/// points.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ScanUniformity {
    /// Of the readings.
    pub readings: PerParameter<Option<f64>>,
    /// Of the readings without offset and rotation.
    pub corrected: PerParameter<Option<f64>>,
    /// Of the field of the layout at the same places.
    pub simulated: PerParameter<Option<f64>>,
    /// Number of readings whose parameters do not exist, because B_z is 0.
    pub singular: usize,
}

impl From<&ScanParameters> for FittedScan {
    fn from(of: &ScanParameters) -> FittedScan {
        FittedScan {
            strength: of.strength,
            offset_t: of.offset_t,
            rotation_deg: of.rotation_rad.map(f64::to_degrees),
            start_mm: of.start,
        }
    }
}

impl Film {
    /// Fits a scan: `readings_t` of the sensor of the layout at points in millimetres, with their
    /// `numbers`. `free` is what is fitted.
    ///
    /// # Errors
    /// [`FilmError::Points`] for points without a field; otherwise [`FilmError::Scan`], or
    /// [`FilmError::Sensor`] if the sensor cannot read the field.
    ///
    /// # Panics
    /// If there are not as many readings and numbers as points.
    pub fn scan(
        &self,
        points_mm: &[DVec3],
        readings_t: &[DVec3],
        numbers: &[u64],
        free: FreeParameters,
    ) -> Result<FilmScan, FilmError> {
        self.tell(Stage::uncounted("fitting the scan"));
        let sensed = self.sensed_field(&box_of(points_mm))?;
        let fit = fit_scan(sensed.clone(), points_mm, readings_t, free).map_err(|error| match error {
            ScanError::Points(errors) => FilmError::Points(errors),
            error => FilmError::Scan(error),
        })?;
        let parameters = &fit.parameters;
        let places_mm: Vec<DVec3> = points_mm.iter().map(|point| *point + parameters.start).collect();
        // Readings without the errors that the layout states, along the axes of its sensor.
        let sensor = sensed.sensor();
        let scaled_t = readings_t.iter().map(|reading| (*reading - sensor.offset_t) / sensor.gain);
        let corrected_t: Vec<DVec3> =
            scaled_t.map(|reading| sensor.rotation * parameters.corrected_t(reading)).collect();
        let field_t = sensed.without_gain_and_offset().readings_t(&places_mm).map_err(FilmError::Points)?;
        let simulated_t: Vec<DVec3> =
            field_t.into_iter().map(|field| parameters.strength * (sensor.rotation * field)).collect();
        let is_kept = |index: &usize| fit.outliers.binary_search(index).is_err();
        let kept: Vec<usize> = (0..points_mm.len()).filter(is_kept).collect();
        let fields_t = [readings_t, &corrected_t, &simulated_t];
        let uniformity_rmse = self.branch().map(|branch| ScanUniformity::new(points_mm, &kept, fields_t, branch));
        let positions = ScanPositions::new(points_mm);
        let numbered = |indices: &[usize]| indices.iter().map(|index| numbers[*index]).collect();
        Ok(FilmScan {
            source: Source::of(self),
            readings: points_mm.len(),
            grid: positions.grid,
            missing_mm: positions.missing,
            repeated: numbered(&positions.repeated),
            fitted: FittedScan::from(&fit.parameters),
            deviation: FittedScan::from(&fit.deviations),
            residual_t: fit.noise_t,
            excluded: numbered(&fit.outliers),
            uniformity_rmse,
            outliers: fit.outliers,
            residuals_t: fit.residuals_t,
            places_mm,
            corrected_t,
            simulated_t,
            sensor_noise_t: self.layout().sensor.as_ref().map_or(0.0, |of| of.element.deviation_t().max_element()),
        })
    }

    /// The branch of the decoupling parameters below the film. `None` without an ideal film and a
    /// working volume, or where B_z is 0 at its reference point.
    pub fn branch(&self) -> Option<Branch> {
        self.ideal().ok()?;
        Branch::from_axis_field(self.reference_field_t().ok()?)
    }
}

impl FilmScan {
    /// Whether the fitted strength is hardly the strength of this film: below half of that of the
    /// layout, or above twice.
    pub fn has_implausible_strength(&self) -> bool {
        !PLAUSIBLE_STRENGTHS.contains(&self.fitted.strength)
    }

    /// The residual over the noise of the sensor of the layout, if it is so large that the film or
    /// the positions are not as stated.
    pub fn excessive_residual(&self) -> Option<f64> {
        let ratio = self.residual_t / self.sensor_noise_t;
        (self.sensor_noise_t > 0.0 && ratio > MOST_RESIDUAL).then_some(ratio)
    }

    /// The readings with the field of the layout at the same places.
    pub fn table(&self) -> Table {
        let residual: Vec<DVec3> = self
            .corrected_t
            .iter()
            .zip(&self.simulated_t)
            .map(|(corrected, simulated)| *corrected - *simulated)
            .collect();
        let is_outlier = |index: usize| self.outliers.binary_search(&index).is_ok();
        let outliers = (0..self.readings).map(|index| f64::from(u8::from(is_outlier(index))));
        let columns = vec![
            ColumnQuantity::flux_density(&self.corrected_t),
            ColumnQuantity::of_vectors(
                "simulated_b_t",
                &["simulated_bx_t", "simulated_by_t", "simulated_bz_t"],
                &self.simulated_t,
            ),
            ColumnQuantity::of_vectors("residual_b_t", &["residual_bx_t", "residual_by_t", "residual_bz_t"], &residual),
            ColumnQuantity::of_numbers(&["outlier"], outliers),
        ];
        let points = Points::Scattered(self.places_mm.clone());
        Table::new(points, columns, self.source.metadata())
    }
}

impl ScanUniformity {
    /// `fields_t` are the readings, the corrected ones and the field of the layout.
    fn new(points: &[DVec3], kept: &[usize], fields_t: [&[DVec3]; 3], branch: Branch) -> ScanUniformity {
        let parameters = fields_t.map(|field_t| -> Vec<Option<Parameters>> {
            kept.iter().map(|index| Parameters::from_field(field_t[*index], branch)).collect()
        });
        let usable: Vec<usize> =
            (0..kept.len()).filter(|n| parameters.iter().all(|of_field| of_field[*n].is_some())).collect();
        let places: Vec<DVec3> = usable.iter().map(|n| points[kept[*n]]).collect();
        let [readings, corrected, simulated] = parameters.map(|of_field| {
            let usable: Vec<Parameters> = usable.iter().filter_map(|n| of_field[*n]).collect();
            uniformity_by_planes(&places, &usable)
        });
        ScanUniformity { readings, corrected, simulated, singular: kept.len() - usable.len() }
    }
}

/// The corners of the box around the points of a scan.
fn box_of(points: &[DVec3]) -> Grid {
    let lower = points.iter().copied().reduce(DVec3::min).unwrap_or_default();
    let upper = points.iter().copied().reduce(DVec3::max).unwrap_or_default();
    let counts = [0, 1, 2].map(|axis| if lower[axis] < upper[axis] { 2 } else { 1 });
    Grid::new(lower, upper, counts).expect("points of a scan are finite")
}
