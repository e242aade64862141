//! A measured scan of the field of a film, fitted and compared with the layout.

use glam::DVec3;
use magsplice_decouple::{Branch, NoPlanes, Parameters, PerParameter, uniformity_by_planes};
use magsplice_magnet::Grid;
use magsplice_scan::{
    ColumnFault, Exclusion, FLUX_DENSITIES, FilmTurn, FreeParameters, KNOWN_NOISE, Plateau, ROUND_OFF, ScanError,
    ScanField, ScanFit, ScanPositions, SensorFault, SignedAxes, film_turn, find_row_order, fit_determined, fit_scan,
    is_row_order_likely,
};
use serde::Serialize;

use super::placement::{FittedScan, is_across};
use super::significant::number;
use super::source::Source;
use super::table::{ColumnQuantity, Points, Table};
use crate::film::Film;
use crate::film_error::FilmError;
use crate::stage::Stage;

/// Offset, in tesla, that a sensor in the field of the earth hardly has: the field of the earth is
/// at most 65 uT, and offsets of magnetometers are about as large.
pub(super) const MOST_OFFSET_T: f64 = 2e-4;

/// Residual over the readings from which on the film is not as ordered, or turned. Sensors read
/// fields to a per cent.
pub(super) const MOST_SHARE: f64 = 0.02;

/// Residual over the readings that a turn of the film leaves at most.
const LARGE_SHARE: f64 = 0.1;

/// Turn of the film, in degrees, from which on a scan may not fit at all without it. Smaller ones
/// move tiles 10 mm from the middle by less than a millimetre, half of the length over which fields
/// change.
const LARGE_DEG: f64 = 5.0;

/// Residual with a turn of the film over that without one, below which the turn is named beside
/// errors of the tiles. Turns do not reduce those of films made by hand by a tenth.
const BETTER: f64 = 0.8;

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
    /// Axes of the sensor that are exchanged or reversed, so that no rotation explains them.
    pub sensor_axes: SignedAxes,
    /// Axes of the positions that are exchanged or reversed.
    pub stage_axes: SignedAxes,
    /// Standard deviation of the residuals of one component, without the excluded readings.
    pub residual_t: f64,
    /// Readings that the fit does not use.
    pub excluded: ExcludedReadings,
    /// With an ideal film.
    pub uniformity_rmse: Option<ScanUniformity>,
    /// The same as `excluded`, for each reading.
    #[serde(skip)]
    pub exclusions: Vec<Option<Exclusion>>,
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
    /// What was fitted.
    #[serde(skip)]
    pub fit: FreeParameters,
    /// Where the strength is held because the scan does not tell it from the height: the height
    /// that looks like a tenth of the strength.
    #[serde(skip)]
    pub height_of_strength_mm: Option<f64>,
    /// Whether the residual is no round-off and smooth along the scan, as that of errors of tiles.
    #[serde(skip)]
    pub has_smooth_residuals: bool,
    /// Whether the sensor was above the film and the working volume is below it, or the reverse.
    #[serde(skip)]
    pub is_across: bool,
    /// A turn of the film against the positions that explains a part of the residual.
    #[serde(skip)]
    pub turn: Option<FilmTurn>,
    /// A fault of the sensor that explains most of the residual.
    #[serde(skip)]
    pub sensor_fault: Option<SensorFault>,
    /// Root mean square of a component of the readings without offset.
    #[serde(skip)]
    pub reading_t: f64,
    /// Whether the layout states errors of its tiles, with which a diagnosis fits them.
    #[serde(skip)]
    pub states_errors: bool,
    /// Largest noise of the sensor of the layout; 0 without one.
    #[serde(skip)]
    pub sensor_noise_t: f64,
}

/// Numbers of the readings that a fit does not use, such as their lines in a file.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ExcludedReadings {
    /// Readings with a missing component.
    pub incomplete: Vec<u64>,
    /// Readings at the limit of the sensor's range.
    pub saturated: Vec<u64>,
    /// Readings that contradict the fit of the others.
    pub outliers: Vec<u64>,
    /// Outliers that share the extreme of a component.
    pub plateau: Option<Plateau>,
}

impl ExcludedReadings {
    /// The exclusions of readings with these numbers.
    pub(crate) fn new(exclusions: &[Option<Exclusion>], numbers: &[u64]) -> ExcludedReadings {
        let mut excluded = ExcludedReadings::default();
        for (exclusion, number) in exclusions.iter().zip(numbers) {
            match exclusion {
                None => continue,
                Some(Exclusion::Incomplete) => &mut excluded.incomplete,
                Some(Exclusion::Saturated) => &mut excluded.saturated,
                Some(Exclusion::Outlier) => &mut excluded.outliers,
            }
            .push(*number);
        }
        excluded
    }

    /// These exclusions of a scan with the outliers that share an extreme.
    pub(crate) fn of_scan(readings_t: &[DVec3], exclusions: &[Option<Exclusion>], numbers: &[u64]) -> ExcludedReadings {
        let plateau = Plateau::among(readings_t, exclusions);
        ExcludedReadings { plateau, ..ExcludedReadings::new(exclusions, numbers) }
    }

    /// Outliers that share an extreme, in words.
    pub(crate) fn remark(&self) -> Option<String> {
        self.plateau.map(|plateau| format!("{plateau} (it is {} mT)", number(1e3 * plateau.reading_t)))
    }

    /// Number of readings that the fit does not use.
    pub fn count(&self) -> usize {
        self.by_reason().iter().map(|(_, numbers)| numbers.len()).sum()
    }

    /// Each reason in words, with its readings.
    pub fn by_reason(&self) -> [(&'static str, &[u64]); 3] {
        [
            ("incomplete", &self.incomplete),
            ("at the limit of the sensor's range", &self.saturated),
            ("outliers", &self.outliers),
        ]
    }
}

/// Uniformity RMSE of R_x, R_y, S_z, without the excluded readings; see [`uniformity_by_planes`].
/// `None` where the positions form no planes normal to the axis of the parameter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ScanUniformity {
    /// Of the readings.
    pub readings: PerParameter<Option<f64>>,
    /// Of the readings without offset and rotation.
    pub corrected: PerParameter<Option<f64>>,
    /// Of the field of the layout at the same places.
    pub simulated: PerParameter<Option<f64>>,
    /// The reasons for undefined uniformities.
    pub omitted: PerParameter<Option<NoPlanes>>,
    /// Number of readings whose parameters do not exist, because B_z is 0.
    pub singular: usize,
}

impl Film {
    /// Fits a scan: `readings_t` of the sensor of the layout at points in millimetres, with their
    /// `numbers`. `free` is what is fitted; `None` for what the scan determines,
    /// [`fit_determined`].
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
        free: Option<FreeParameters>,
    ) -> Result<FilmScan, FilmError> {
        self.tell(Stage::uncounted("fitting the scan"));
        let sensed = self.sensed_field(&Grid::around(points_mm))?;
        let centre_mm = self.centre_mm();
        let is_chosen = free.is_none();
        // With recoil the field has many times the tiles; without it, it is right to some per cent.
        let rigid = self.recoil().map(|_| Film::rigid(self.layout().clone()));
        let rough = rigid.as_ref().map(|rigid| rigid.sensed_field(&Grid::around(points_mm))).transpose()?;
        let field = ScanField { exact: sensed.clone(), rough };
        let fit = match free {
            Some(free) => fit_scan(field.clone(), points_mm, readings_t, free, centre_mm).map(|fit| (fit, free)),
            None => fit_determined(field.clone(), points_mm, readings_t, centre_mm),
        };
        let (fit, free) = match fit {
            Err(ScanError::Points(errors)) => return Err(FilmError::Points(errors)),
            Err(error) => {
                let is_misfit = !matches!(error, ScanError::TooFew { .. } | ScanError::Undetermined(_));
                let fault = ColumnFault::among(points_mm, readings_t);
                if let Some(fault) = fault.filter(|fault| is_misfit || fault.is_certain()) {
                    return Err(FilmError::Scan(ScanError::Columns(fault)));
                }
                if let Some(error) = self.unfit_readings(readings_t) {
                    return Err(error);
                }
                if let Some(error) = reading_unit(&field, points_mm, readings_t, centre_mm, &error) {
                    return Err(FilmError::Scan(error));
                }
                let finite = || readings_t.iter().filter(|reading_t| reading_t.is_finite());
                let squares: f64 = finite().map(|reading_t| reading_t.length_squared()).sum();
                let reading_t = (squares / (3 * finite().count().max(1)) as f64).sqrt();
                let turn = film_turn(field, points_mm, readings_t);
                let is_small = |turn: &FilmTurn| turn.residual_t < LARGE_SHARE * reading_t;
                let is_large = |turn: &FilmTurn| turn.angle_deg.abs() >= LARGE_DEG;
                let turn = turn.filter(|turn| is_small(turn) || is_large(turn) && turn.explains(reading_t));
                let has_cause = matches!(error, ScanError::Unit { .. } | ScanError::ReadingUnit { .. });
                let order = || match has_cause {
                    true => None,
                    false => find_row_order(&sensed, points_mm, readings_t, None, centre_mm),
                };
                let cause = turn.map(ScanError::Turned).or_else(|| order().map(ScanError::RowOrder));
                return Err(FilmError::Scan(cause.unwrap_or(error)));
            }
            Ok(fit) => fit,
        };
        let ScanFit { parameters, deviations, sensor_axes, stage_axes, .. } = fit;
        // Clipped readings and magnitudes fit exchanged axes better.
        if (sensor_axes, stage_axes) != (SignedAxes::SAME, SignedAxes::SAME)
            && let Some(error) = self.unfit_readings(readings_t)
        {
            return Err(error);
        }
        let places_mm: Vec<DVec3> = points_mm.iter().map(|point| fit.place(*point)).collect();
        // Readings without the errors that the layout states, along the axes of its sensor.
        let sensor = sensed.sensor();
        let scaled_t = readings_t.iter().map(|reading| (*reading - sensor.offset_t) / sensor.gain);
        let corrected_t: Vec<DVec3> = scaled_t.map(|reading| sensor.rotation * fit.corrected_t(reading)).collect();
        let field_t = sensed.without_gain_and_offset().readings_t(&places_mm).map_err(FilmError::Points)?;
        let simulated_t: Vec<DVec3> =
            field_t.into_iter().map(|field| parameters.strength * (sensor.rotation * field)).collect();
        let kept: Vec<usize> = (0..points_mm.len()).filter(|index| fit.exclusions[*index].is_none()).collect();
        let squares: f64 = kept.iter().map(|index| corrected_t[*index].length_squared()).sum();
        let reading_t = (squares / (3 * kept.len().max(1)) as f64).sqrt();
        let sensor_noise_t = self.layout().sensor.as_ref().map_or(0.0, |of| of.as_one().deviation_t().max_element());
        let most_t = if sensor_noise_t > 0.0 { KNOWN_NOISE * sensor_noise_t } else { MOST_SHARE * reading_t };
        if fit.noise_t > most_t || is_row_order_likely(&fit.exclusions) {
            let fault = ColumnFault::among(points_mm, readings_t).filter(ColumnFault::is_certain);
            let order = || find_row_order(&sensed, points_mm, readings_t, Some((&fit, free)), centre_mm);
            let fault = fault.map(ScanError::Columns).or_else(|| order().map(ScanError::RowOrder));
            if let Some(fault) = fault {
                return Err(FilmError::Scan(fault));
            }
        }
        let turn = match fit.noise_t > most_t {
            true => film_turn(field, points_mm, readings_t)
                .filter(|turn| turn.is_below(BETTER, fit.noise_t) && turn.residual_t < LARGE_SHARE * reading_t),
            false => None,
        };
        if let Some(turn) = turn.filter(|turn| turn.explains(fit.noise_t)) {
            return Err(FilmError::Scan(ScanError::Turned(turn)));
        }
        let sensor_fault =
            (fit.noise_t > most_t).then(|| SensorFault::of_scan(&sensed, points_mm, readings_t, &fit, free)).flatten();
        let fields_t = [readings_t, &corrected_t, &simulated_t];
        let uniformity_rmse = self
            .ideal()
            .ok()
            .zip(self.branch())
            .map(|(ideal, branch)| ScanUniformity::new(points_mm, &kept, fields_t, (branch, ideal.wavelength())));
        let height_of_strength_mm = match is_chosen && !free.strength {
            true => {
                let slopes = sensed.without_gain_and_offset().gradients(&places_mm).map_err(FilmError::Points)?;
                let rms = |squares: f64| (squares / places_mm.len().max(1) as f64).sqrt();
                let field_t = rms(simulated_t.iter().map(|b| b.length_squared()).sum());
                Some(0.1 * field_t / rms(slopes.iter().map(|slope| slope.z_axis.length_squared()).sum()))
            }
            false => None,
        };
        let has_smooth_residuals = fit.noise_t > ROUND_OFF * reading_t && fit.has_smooth_residuals();
        let is_across = is_across(&self.layout().bare_tiles(), centre_mm, &places_mm);
        let positions = ScanPositions::new(points_mm);
        let numbered = |indices: &[usize]| indices.iter().map(|index| numbers[*index]).collect();
        Ok(FilmScan {
            source: Source::of(self),
            readings: points_mm.len(),
            grid: positions.grid,
            missing_mm: positions.missing,
            repeated: numbered(&positions.repeated),
            fitted: FittedScan::new(&parameters, fit.offset_t()),
            deviation: FittedScan::new(&deviations, fit.offset_deviation_t()),
            fit: free,
            sensor_axes,
            stage_axes,
            residual_t: fit.noise_t,
            excluded: ExcludedReadings::of_scan(readings_t, &fit.exclusions, numbers),
            uniformity_rmse,
            exclusions: fit.exclusions,
            residuals_t: fit.residuals_t,
            places_mm,
            corrected_t,
            simulated_t,
            reading_t,
            height_of_strength_mm,
            has_smooth_residuals,
            is_across,
            turn,
            sensor_fault,
            states_errors: self.layout().states_errors_of_tiles(),
            sensor_noise_t,
        })
    }

    /// The centre of the working volume, where the middle of a scan is likely.
    pub(crate) fn centre_mm(&self) -> Option<DVec3> {
        self.layout().volume.as_ref().map(|volume| 0.5 * (volume.lower_mm + volume.upper_mm))
    }

    /// The branch of the decoupling parameters below the film. `None` without an ideal film and a
    /// working volume, or where B_z is 0 at its reference point.
    pub fn branch(&self) -> Option<Branch> {
        self.ideal().ok()?;
        Branch::from_axis_field(self.reference_field_t().ok()?)
    }
}

impl FilmScan {
    /// The residual over the noise of the sensor of the layout, if it is so large that the film or
    /// the positions are not as stated.
    pub fn excessive_residual(&self) -> Option<f64> {
        let ratio = self.residual_t / self.sensor_noise_t;
        (self.sensor_noise_t > 0.0 && ratio > KNOWN_NOISE).then_some(ratio)
    }

    /// The readings with the field of the layout at the same places.
    pub fn table(&self) -> Table {
        let residual: Vec<DVec3> = self
            .corrected_t
            .iter()
            .zip(&self.simulated_t)
            .map(|(corrected, simulated)| *corrected - *simulated)
            .collect();
        let excluded = self.exclusions.iter().map(Option::is_some);
        let columns = vec![
            ColumnQuantity::flux_density(&self.corrected_t),
            ColumnQuantity::of_vectors(
                "simulated_b_t",
                &["simulated_bx_t", "simulated_by_t", "simulated_bz_t"],
                &self.simulated_t,
            ),
            ColumnQuantity::of_vectors("residual_b_t", &["residual_bx_t", "residual_by_t", "residual_bz_t"], &residual),
            ColumnQuantity::of_whole(&["excluded"], excluded),
        ];
        let points = Points::Scattered(self.places_mm.clone());
        Table::new(points, columns, self.source.metadata())
    }
}

/// The unit with which readings fit that are all beyond the range of the sensor.
fn reading_unit(
    field: &ScanField,
    points_mm: &[DVec3],
    readings_t: &[DVec3],
    centre_mm: Option<DVec3>,
    error: &ScanError,
) -> Option<ScanError> {
    if !matches!(error, ScanError::TooFew { excluded, .. } if *excluded > 0) {
        return None;
    }
    let fits = |unit: f64| {
        let scaled_t: Vec<DVec3> = readings_t.iter().map(|reading_t| unit * *reading_t).collect();
        let squares: f64 = scaled_t.iter().filter(|of| of.is_finite()).map(|of| of.length_squared()).sum();
        let rms_t = (squares / (3 * scaled_t.len().max(1)) as f64).sqrt();
        let is_this_film =
            |fit: &ScanFit| fit.noise_t < LARGE_SHARE * rms_t && POSSIBLE_STRENGTHS.contains(&fit.parameters.strength);
        fit_determined(field.clone(), points_mm, &scaled_t, centre_mm).is_ok_and(|(fit, _)| is_this_film(&fit))
    };
    let (unit, example) = FLUX_DENSITIES.into_iter().find(|(unit, _)| fits(*unit))?;
    Some(ScanError::ReadingUnit { unit, example })
}

/// Strengths of a film of the layout: units differ by ten or more.
const POSSIBLE_STRENGTHS: std::ops::Range<f64> = 0.4..2.5;

impl ScanUniformity {
    /// `fields_t` are the readings, the corrected ones and the field of the layout.
    fn new(
        points: &[DVec3],
        kept: &[usize],
        fields_t: [&[DVec3]; 3],
        (branch, wavelength_mm): (Branch, f64),
    ) -> ScanUniformity {
        let parameters = fields_t.map(|field_t| -> Vec<Option<Parameters>> {
            kept.iter().map(|index| Parameters::from_field(field_t[*index], branch)).collect()
        });
        let usable: Vec<usize> =
            (0..kept.len()).filter(|n| parameters.iter().all(|of_field| of_field[*n].is_some())).collect();
        let places: Vec<DVec3> = usable.iter().map(|n| points[kept[*n]]).collect();
        let [readings, corrected, simulated] = parameters.map(|of_field| {
            let usable: Vec<Parameters> = usable.iter().filter_map(|n| of_field[*n]).collect();
            uniformity_by_planes(&places, &usable, wavelength_mm)
        });
        // The planes depend on the positions alone.
        let omitted = readings.map(Result::err);
        let [readings, corrected, simulated] =
            [readings, corrected, simulated].map(|of_field| of_field.map(Result::ok));
        ScanUniformity { readings, corrected, simulated, omitted, singular: kept.len() - usable.len() }
    }
}
