//! Positions of a head, with a stray field and a rotation, from the readings of all its sensors.

use glam::{DMat3, DQuat, DVec3};
use magsplice_field::Scene;
use magsplice_magnet::{Grid, PointErrors, Quantity};
use rayon::prelude::*;
use thiserror::Error;

use crate::descent::{Region, SAME_FIELD};
use crate::head_fit::{HeadFit, HeadResolution, HeadUnknowns, probability};
use crate::locator::{APART, LocateError, Locator, ON_SURFACE};
use crate::normal_equations::{MOST, Normal, Step, covariance, deviations, part, step};
use crate::sensed_field::{Part, SensedField};

/// Largest number of steps of one search. Convergence takes five; a halved step takes one more.
const MOST_STEPS: usize = 60;

/// Length of a step over the diagonal of the volume, and in radians, below which a search ends.
/// Steps converge quadratically, so the remaining error is the square of this length, plus
/// round-off.
const SHORTEST_STEP: f64 = 1e-8;

/// Fall of chi squared over itself, or over the round-off of the readings, up to which a search
/// ends. A step of the stray field alone may explain all of it.
const LEAST_FALL: f64 = 1e-6;

/// Longest step over the diagonal of the volume. Farther away the field is not linear.
const LONGEST_STEP: f64 = 0.25;

/// Longest step of the rotation, in radians.
const LONGEST_TURN: f64 = 0.2;

/// Rise of chi squared up to which a second position explains the readings as well: less than one
/// in 10 000 right positions is so much worse than a wrong one.
const ALIKE: f64 = 16.0;

/// Starts along each axis of the volume of a search without one of the sensors, whose weighted sum
/// is not known. A quarter of a wavelength apart in volumes of half a wavelength.
const STARTS_ALONG: usize = 3;

/// Number of readings processed at a time, which bounds the memory.
const BATCH: usize = 1 << 12;

/// The reason why a head cannot be located.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum HeadLocatorError {
    /// The head has too few sensors for the unknowns.
    #[error("{sensors} sensors give {} numbers, fewer than the {unknowns} that are fitted: fit less", 3 * sensors)]
    TooFew {
        /// Number of sensors.
        sensors: usize,
        /// Number of fitted numbers.
        unknowns: usize,
    },
    /// Points of the volume have no field.
    #[error("{0}")]
    Points(PointErrors),
}

/// Finds the positions of a head in a volume from the readings of its sensors.
#[derive(Debug)]
pub struct HeadLocator<'a> {
    /// The search by the weighted sum, from which least squares begin.
    sum: Locator<'a>,
    scene: &'a Scene,
    sensors: Vec<Sensor>,
    /// Whether the deviations are those of noise; otherwise all are 1 T.
    has_noise: bool,
    unknowns: HeadUnknowns,
    region: Region,
}

/// A sensor of a head.
#[derive(Clone, Debug)]
struct Sensor {
    part: Part,
    weight: DVec3,
    /// Part of its readings that comes neither from the film nor from the fitted stray field.
    constant_t: DVec3,
    deviation_t: DVec3,
}

/// The numbers of a fit.
#[derive(Clone, Copy, Debug)]
struct Numbers {
    position: DVec3,
    stray_t: DVec3,
    rotation: DQuat,
}

/// The readings of a head at one set of numbers, compared with measured ones.
struct Compared {
    chi_squared: f64,
    /// Sum of the squares of the readings over the noise.
    reading_squares: f64,
    normal: Normal,
    right: Step,
    /// For each sensor: the derivatives of its whitened residual.
    slopes: Vec<[DVec3; MOST]>,
}

/// A search in progress.
struct Search<'r> {
    index: usize,
    readings_t: &'r [DVec3],
    best: Option<(Numbers, Compared)>,
    candidate: Numbers,
    step: Step,
}

impl<'a> HeadLocator<'a> {
    /// A locator for the volume of a grid, and the field of a head ([`SensedField::of_head`]).
    ///
    /// # Errors
    /// See [`HeadLocatorError`].
    ///
    /// # Panics
    /// If the field is that of one sensor.
    pub fn new(
        field: SensedField<'a>,
        grid: Grid,
        unknowns: HeadUnknowns,
    ) -> Result<HeadLocator<'a>, HeadLocatorError> {
        let (scene, parts) = (field.scene(), field.sensors());
        if 3 * parts.len() < unknowns.count() {
            return Err(HeadLocatorError::TooFew { sensors: parts.len(), unknowns: unknowns.count() });
        }
        let sensor = |(part, weight): (Part, DVec3)| {
            let deviation_t = part.sensor.deviation_t();
            Sensor { part, weight, constant_t: DVec3::ZERO, deviation_t }
        };
        let mut sensors: Vec<Sensor> = parts.into_iter().map(sensor).collect();
        let has_noise = sensors.iter().all(|of| of.deviation_t.min_element() > 0.0);
        if !has_noise {
            sensors.iter_mut().for_each(|of| of.deviation_t = DVec3::ONE);
        }
        let sum = Locator::new(field, grid).map_err(HeadLocatorError::Points)?;
        let region = sum.region();
        Ok(HeadLocator { sum, scene, sensors, has_noise, unknowns, region })
    }

    /// Sets a constant part of the readings of each sensor in addition to the field of the tiles.
    ///
    /// # Panics
    /// If there are not as many as sensors.
    pub fn with_constant_readings(mut self, constants_t: &[DVec3]) -> HeadLocator<'a> {
        assert_eq!(constants_t.len(), self.sensors.len(), "one constant reading of each sensor");
        self.sensors.iter_mut().zip(constants_t).for_each(|(of, constant_t)| of.constant_t = *constant_t);
        self
    }

    /// Sets the noise of the readings of every sensor.
    pub fn with_deviation(mut self, deviation_t: DVec3) -> HeadLocator<'a> {
        self.sensors.iter_mut().for_each(|of| of.deviation_t = deviation_t);
        self.has_noise = true;
        self
    }

    /// The resolution at positions; `None` where the numbers are not determined or a sensor has no
    /// field.
    pub fn resolution(&self, positions: &[DVec3]) -> Vec<Option<HeadResolution>> {
        let at = |position: &DVec3| {
            let numbers = Numbers { position: *position, stray_t: DVec3::ZERO, rotation: DQuat::IDENTITY };
            let points: Vec<DVec3> = self.points(&numbers).collect();
            let field_t = self.scene.field_at(Quantity::FluxDensity, &points).ok()?;
            let gradient = self.scene.gradient_at(Quantity::FluxDensity, &points).ok()?;
            let zeros = vec![DVec3::ZERO; self.sensors.len()];
            let compared = self.compared(&self.sensors, &numbers, &zeros, &mut field_t.into_iter().zip(gradient));
            let covariance = covariance(&compared.normal, self.unknowns)?;
            let [position, stray_t] = [0, 3].map(|from| deviations(&covariance, from));
            let of_position = covariance.fixed_view::<3, 3>(0, 0).into_owned();
            let largest = of_position.symmetric_eigenvalues().max();
            Some(HeadResolution {
                position_deviation: position,
                stray_deviation_t: stray_t,
                least_singular_value: largest.sqrt().recip(),
            })
        };
        positions.par_iter().map(at).collect()
    }

    /// Whether deviations and residuals count in the noise of the sensors: every sensor has noise
    /// along each axis, or [`HeadLocator::with_deviation`] set it.
    pub fn has_noise(&self) -> bool {
        self.has_noise
    }

    /// The volume.
    pub fn grid(&self) -> &Grid {
        self.sum.grid()
    }

    /// Enlarges the noise of all sensors, for example by sqrt(1 + 1/n) where the constant readings
    /// are the mean of n readings.
    pub fn with_noise_times(mut self, factor: f64) -> HeadLocator<'a> {
        self.sensors.iter_mut().for_each(|of| of.deviation_t *= factor);
        self
    }

    /// The fit of each reading of the head: one reading of each sensor, in their order, in tesla.
    ///
    /// Gauss-Newton steps minimize the sum of the squared residuals over the noise. They begin
    /// where the weighted sum has the field nearest to that of the readings among its neighbours
    /// on the grid, with no stray field and no rotation, and use the exact field and its gradient.
    /// Without noise and model errors, the error of positions is the error bound of the field over
    /// its gradient. Results do not depend on the other readings or on the number of threads.
    ///
    /// # Panics
    /// If the number of readings is no multiple of that of the sensors.
    pub fn locate(&self, readings_t: &[DVec3]) -> Vec<Result<HeadFit, LocateError>> {
        let count = self.sensors.len();
        assert_eq!(readings_t.len() % count, 0, "one reading of each sensor");
        let rows: Vec<&[DVec3]> = readings_t.chunks(count).collect();
        let batches = rows.par_chunks(BATCH / count + 1).map(|rows| self.locate_batch(rows));
        batches.collect::<Vec<_>>().into_iter().flatten().collect()
    }

    fn locate_batch(&self, rows: &[&[DVec3]]) -> Vec<Result<HeadFit, LocateError>> {
        let mut found: Vec<Result<HeadFit, LocateError>> = self.searched(rows, false);
        let lost: Vec<usize> = (0..rows.len()).filter(|index| found[*index] == Err(LocateError::NoPosition)).collect();
        let again: Vec<&[DVec3]> = lost.iter().map(|index| rows[*index]).collect();
        for (index, fit) in lost.into_iter().zip(self.searched(&again, true)) {
            found[index] = fit;
        }
        found
    }

    fn searched(&self, rows: &[&[DVec3]], thorough: bool) -> Vec<Result<HeadFit, LocateError>> {
        let starts: Vec<Result<Vec<DVec3>, LocateError>> = rows.iter().map(|row| self.starts(row, thorough)).collect();
        let mut searches: Vec<Search> = Vec::new();
        for (row, starts) in rows.iter().zip(&starts) {
            searches.extend(starts.iter().flatten().map(|start| Search {
                index: 0,
                readings_t: row,
                best: None,
                candidate: Numbers { position: *start, stray_t: DVec3::ZERO, rotation: DQuat::IDENTITY },
                step: Step::zeros(),
            }));
        }
        searches.iter_mut().enumerate().for_each(|(index, search)| search.index = index);
        let mut ends = self.ends(&self.sensors, searches).into_iter();
        let of_row = |starts: Result<Vec<DVec3>, LocateError>| {
            let ends: Vec<Option<(Numbers, Compared)>> = ends.by_ref().take(starts?.len()).collect();
            self.only(ends.into_iter().flatten().collect())
        };
        starts.into_iter().map(of_row).collect()
    }

    /// Where the search for a reading begins.
    fn starts(&self, readings_t: &[DVec3], thorough: bool) -> Result<Vec<DVec3>, LocateError> {
        if !readings_t.iter().all(|reading_t| reading_t.is_finite()) {
            return Err(LocateError::NotFinite);
        }
        let pairs = || self.sensors.iter().zip(readings_t);
        if pairs().any(|(of, reading_t)| of.part.sensor.is_saturated(*reading_t)) {
            return Err(LocateError::Saturated);
        }
        let sum_t = pairs().map(|(of, reading_t)| {
            let sensor = &of.part.sensor;
            of.weight * (sensor.rotation * ((*reading_t - of.constant_t - sensor.offset_t) / sensor.gain))
        });
        Ok(self.sum.starts(sum_t.sum(), thorough))
    }

    /// The sensor without which all others agree best, and in more than half of these readings: the
    /// residual of their fit is as large in more than this share of right readings. `None` if there
    /// is none, if there is another one that explains them nearly as well, and if the others have
    /// no more readings than unknowns.
    ///
    /// # Panics
    /// If the number of readings is no multiple of that of the sensors.
    pub fn contradicting_sensor(&self, readings_t: &[DVec3], false_alarm: f64) -> Option<usize> {
        let count = self.sensors.len();
        assert_eq!(readings_t.len() % count, 0, "one reading of each sensor");
        let freedom = (3 * (count - 1)).checked_sub(self.unknowns.count()).filter(|freedom| *freedom > 0)?;
        let (lower, upper) = (self.grid().lower(), self.grid().upper());
        let counts = (upper - lower).to_array().map(|extent| if extent > 0.0 { STARTS_ALONG } else { 1 });
        let steps = Grid::new(lower, upper, counts).ok()?;
        let without = |left_out: usize| -> Option<(f64, usize)> {
            let mut sensors = self.sensors.clone();
            // Its residuals and their derivatives are 0.
            sensors[left_out].deviation_t = DVec3::INFINITY;
            let least = |row: &[DVec3]| {
                let search = |(index, start): (usize, DVec3)| Search {
                    index,
                    readings_t: row,
                    best: None,
                    candidate: Numbers { position: start, stray_t: DVec3::ZERO, rotation: DQuat::IDENTITY },
                    step: Step::zeros(),
                };
                let ends = self.ends(&sensors, steps.points().enumerate().map(search).collect());
                ends.iter().flatten().map(|(_, of)| of.chi_squared).fold(f64::INFINITY, f64::min)
            };
            let all: Vec<f64> = readings_t.chunks(count).map(least).collect();
            let is_noise = |of: &&f64| probability(**of, freedom).is_some_and(|of| of >= false_alarm);
            (2 * all.iter().filter(is_noise).count() > all.len()).then(|| (all.iter().sum(), left_out))
        };
        let mut agreeing: Vec<(f64, usize)> = (0..count).into_par_iter().filter_map(without).collect();
        agreeing.sort_by(|a, b| a.0.total_cmp(&b.0));
        match agreeing[..] {
            [(best, _), (next, _), ..] if next < best + ALIKE => None,
            [(_, sensor), ..] => Some(sensor),
            [] => None,
        }
    }

    /// The ends of searches, in their order; `None` where steps left the field.
    fn ends(&self, sensors: &[Sensor], searches: Vec<Search>) -> Vec<Option<(Numbers, Compared)>> {
        let mut ends: Vec<Option<(Numbers, Compared)>> = searches.iter().map(|_| None).collect();
        let mut active = searches;
        for _ in 0..MOST_STEPS {
            if active.is_empty() {
                break;
            }
            let points: Vec<DVec3> = active.iter().flat_map(|search| self.points(&search.candidate)).collect();
            let mut field_t = vec![DVec3::ZERO; points.len()];
            let mut gradient = vec![DMat3::ZERO; points.len()];
            // Points without a field are NaN, and the step to them is halved.
            let _ = self.scene.field_into(Quantity::FluxDensity, &points, &mut field_t);
            let _ = self.scene.gradient_into(Quantity::FluxDensity, &points, &mut gradient);
            let mut at = field_t.into_iter().zip(gradient);
            let mut going = Vec::with_capacity(active.len());
            for mut search in active {
                let compared = self.compared(sensors, &search.candidate, search.readings_t, &mut at);
                if search.advance(compared, &self.unknowns, &self.region) {
                    let index = search.index;
                    ends[index] = search.best;
                } else {
                    going.push(search);
                }
            }
            active = going;
        }
        ends
    }

    /// The points whose field the sensors read.
    fn points(&self, at: &Numbers) -> impl Iterator<Item = DVec3> + '_ {
        let Numbers { position, rotation, .. } = *at;
        let nodes = self.sensors.iter().flat_map(|sensor| sensor.part.nodes.iter().flatten());
        nodes.map(move |node| position + rotation * node.offset)
    }

    /// Measured readings compared with those at numbers, from the field at their points.
    fn compared(
        &self,
        sensors: &[Sensor],
        at: &Numbers,
        readings_t: &[DVec3],
        field: &mut impl Iterator<Item = (DVec3, DMat3)>,
    ) -> Compared {
        let back = DMat3::from_quat(at.rotation.inverse());
        let (mut normal, mut right) = (Normal::zeros(), Step::zeros());
        let (mut chi_squared, mut reading_squares) = (0.0, 0.0);
        let mut slopes = Vec::new();
        for (sensor, reading_t) in sensors.iter().zip(readings_t) {
            let Part { sensor: hall, nodes } = &sensor.part;
            // Along the axes of the board: the mean over each plate, and its derivatives.
            let means: Vec<(DVec3, [DVec3; MOST])> = nodes
                .iter()
                .map(|nodes| {
                    let (mut mean_t, mut slope) = (at.stray_t, [DVec3::ZERO; MOST]);
                    for node in nodes {
                        let (b, gradient) = field.next().expect("a field at each point");
                        mean_t += node.weight * (back * b);
                        let arm = at.rotation * node.offset;
                        for (axis, of) in DMat3::IDENTITY.to_cols_array_2d().map(DVec3::from).into_iter().enumerate() {
                            slope[axis] += node.weight * (back * gradient.col(axis));
                            // A turn by d about an axis of the film moves the node and the axes.
                            let turned = gradient * of.cross(arm) + b.cross(of);
                            slope[6 + axis] += node.weight * (back * turned);
                        }
                    }
                    (0..3).for_each(|axis| slope[3 + axis][axis] = 1.0);
                    (mean_t, slope)
                })
                .collect();
            let plate = |axis: usize| &means[axis.min(means.len() - 1)];
            let axes = DMat3::from_quat(hall.rotation);
            let along = |of: &dyn Fn(usize) -> DVec3| DVec3::from([0, 1, 2].map(|axis| axes.col(axis).dot(of(axis))));
            let computed_t = hall.gain * along(&|axis| plate(axis).0) + hall.offset_t + sensor.constant_t;
            let residual = (*reading_t - computed_t) / sensor.deviation_t;
            let slope: [DVec3; MOST] = std::array::from_fn(|number| match number < self.unknowns.count() {
                true => hall.gain * along(&|axis| plate(axis).1[number]) / sensor.deviation_t,
                false => DVec3::ZERO,
            });
            for row in 0..MOST {
                right[row] += slope[row].dot(residual);
                (0..MOST).for_each(|column| normal[(row, column)] += slope[row].dot(slope[column]));
            }
            chi_squared += residual.length_squared();
            reading_squares += (*reading_t / sensor.deviation_t).length_squared();
            slopes.push(slope);
        }
        Compared { chi_squared, reading_squares, normal, right, slopes }
    }

    /// The only position in the volume among the ends of the searches.
    fn only(&self, mut ends: Vec<(Numbers, Compared)>) -> Result<HeadFit, LocateError> {
        ends.sort_by(|a, b| a.1.chi_squared.total_cmp(&b.1.chi_squared));
        let least = ends.first().ok_or(LocateError::NoPosition)?.1.chi_squared;
        let (margin, apart) = (ON_SURFACE * self.region.diagonal, APART * self.region.diagonal);
        let grid = self.sum.grid();
        let is_within = |at: &Numbers| {
            at.position.cmpge(grid.lower() - margin).all() && at.position.cmple(grid.upper() + margin).all()
        };
        let most = least + if self.has_noise { ALIKE } else { SAME_FIELD * SAME_FIELD * ends[0].1.reading_squares };
        let alike = || ends.iter().filter(|(_, of)| of.chi_squared <= most);
        let mut within: Vec<&(Numbers, Compared)> = Vec::new();
        for end in alike().filter(|(at, _)| is_within(at)) {
            if within.iter().all(|other| other.0.position.distance(end.0.position) > apart) {
                within.push(end);
            }
        }
        match within[..] {
            [only] => self.fit(only, true),
            [first, second, ..] => Err(LocateError::Ambiguous([first.0.position, second.0.position])),
            [] => self.fit(&ends[0], false),
        }
    }

    /// The gradient of the weighted sum.
    fn gradient(&self, of: &Compared) -> DMat3 {
        let term = |(sensor, slopes): (&Sensor, &[DVec3; MOST])| {
            let hall = &sensor.part.sensor;
            let column =
                |axis: usize| sensor.weight * (hall.rotation * (slopes[axis] * sensor.deviation_t / hall.gain));
            DMat3::from_cols(column(0), column(1), column(2))
        };
        self.sensors.iter().zip(&of.slopes).map(term).sum()
    }

    /// The fit at the end of a search.
    fn fit(&self, (at, of): &(Numbers, Compared), is_within: bool) -> Result<HeadFit, LocateError> {
        let covariance = covariance(&of.normal, self.unknowns).ok_or(LocateError::Undetermined)?;
        let (axis, angle) = at.rotation.to_axis_angle();
        Ok(HeadFit {
            position: at.position,
            is_within,
            gradient: self.gradient(of),
            stray_t: at.stray_t,
            rotation_rad: axis * angle,
            position_deviation: deviations(&covariance, 0),
            stray_deviation_t: deviations(&covariance, 3),
            rotation_deviation_rad: deviations(&covariance, 6),
            chi_squared: of.chi_squared,
            degrees_of_freedom: 3 * self.sensors.len() - self.unknowns.count(),
        })
    }
}

impl Search<'_> {
    /// Takes a step. Returns whether the search has ended, with its best numbers.
    fn advance(&mut self, compared: Compared, unknowns: &HeadUnknowns, region: &Region) -> bool {
        let is_better = match &self.best {
            None => compared.chi_squared.is_finite(),
            Some((_, best)) => compared.chi_squared < best.chi_squared,
        };
        if is_better {
            let Some(step) = step(&compared.normal, &compared.right, *unknowns) else {
                self.best = None;
                return true;
            };
            self.best = Some((self.candidate, compared));
            let shares =
                [LONGEST_STEP * region.diagonal / part(&step, 0).length(), LONGEST_TURN / part(&step, 6).length()];
            self.step = step * shares.into_iter().fold(1.0, f64::min);
        } else {
            self.step *= 0.5;
        }
        let Some((from, at)) = &self.best else { return true };
        let moved = (from.position + part(&self.step, 0)).clamp(region.lower, region.upper);
        let floor = SAME_FIELD * SAME_FIELD * at.reading_squares;
        let is_short = (moved - from.position).length() <= SHORTEST_STEP * region.diagonal
            && part(&self.step, 6).length() <= SHORTEST_STEP
            && at.right.dot(&self.step) <= LEAST_FALL * at.chi_squared.max(floor);
        self.candidate = Numbers {
            position: moved,
            stray_t: from.stray_t + part(&self.step, 3),
            rotation: (DQuat::from_scaled_axis(part(&self.step, 6)) * from.rotation).normalize(),
        };
        if let Some((best, _)) = self.best.as_mut().filter(|_| is_short) {
            // The last step needs no evaluation, because the field is linear over it.
            *best = self.candidate;
        }
        is_short
    }
}
