//! The least squares of a scan: Gauss-Newton steps with the exact field and its gradient
//! (docs/physics.md, section 8).

use glam::{DMat3, DQuat, DVec3};
use magsplice_sensor::SensedField;
use nalgebra::{SMatrix, SVector, SymmetricEigen};

use crate::exclusion::Exclusion;
use crate::fit_error::ScanError;
use crate::parameters::{FreeParameters, ScanParameter, ScanParameters};
use crate::signed_axes::SignedAxes;
use crate::starts::Start;

const PARAMETERS: usize = ScanParameter::ALL.len();

type Vector = SVector<f64, PARAMETERS>;
type Matrix = SMatrix<f64, PARAMETERS, PARAMETERS>;

/// Largest number of steps of one fit. Fits that converge take about six.
const MOST_STEPS: usize = 50;

/// Relative change of the sum of squares below which a fit ends.
const LEAST_GAIN: f64 = 1e-12;

/// Eigenvalue of the scaled normal matrix, over the largest, below which a combination of
/// parameters is not determined by the scan. Round-off of the matrix is 1e-16 of the largest.
const UNDETERMINED: f64 = 1e-12;

/// Length of a step, in scaled parameters and as a fraction of a full step longer than one, below
/// which halving ends. The sum of squares then changes by round-off alone.
const SHORTEST_STEP: f64 = 1e-12;

/// Share of the largest component of an undetermined combination above which a parameter is
/// reported as part of it.
const LEAST_PART: f64 = 0.3;

/// Standard deviation of a scaled parameter above which the readings do not determine it: 0.3 rad,
/// or 30 % of the strength. Steps of this size leave the region where the model is linear.
const MOST_DEVIATION: f64 = 0.3;

/// Residual of a film as made, over the root mean square of the readings: a few per cent, at most.
pub(crate) const MADE_RESIDUAL: f64 = 0.1;

/// A scan with its parameters to fit.
pub(crate) struct Scan<'a> {
    field: &'a SensedField<'a>,
    /// Positions along the axes of the tiles.
    points: Vec<DVec3>,
    /// Readings along the axes of a sensor without exchanged axes.
    readings_t: Vec<DVec3>,
    sensor_axes: SignedAxes,
    stage_axes: SignedAxes,
    free: FreeParameters,
    /// Root mean square of the field, in tesla.
    pub(crate) field_scale_t: f64,
    /// Unit of each parameter. All units change the readings by similar amounts.
    scales: Vector,
}

/// Ratio of von Neumann below which residuals are smooth: noise has 1, and noise with as large
/// smooth residuals about a half.
const SMOOTH: f64 = 0.75;

/// Standard deviations of the ratio by which it is below that of noise.
const CERTAIN: f64 = 4.0;

/// A fitted scan. The sensor at p of the stage reads `sensor_axes` of the reading with these
/// parameters at `stage_axes` of p.
#[derive(Clone, Debug, PartialEq)]
pub struct ScanFit {
    /// The parameters. The offset is along axes that are not exchanged; see [`ScanFit::offset_t`].
    pub parameters: ScanParameters,
    /// Standard deviations of the parameters, from the residuals; 0 for fixed parameters.
    pub deviations: ScanParameters,
    /// Exchanged or reversed axes of the sensor that no rotation explains.
    pub sensor_axes: SignedAxes,
    /// Exchanged or reversed axes of the positions.
    pub stage_axes: SignedAxes,
    /// Standard deviation of the residuals of one component, without excluded readings, in tesla.
    pub noise_t: f64,
    /// Reading minus fit at each point, including excluded readings, in tesla and along the axes of
    /// the sensor.
    pub residuals_t: Vec<DVec3>,
    /// The reason why a reading is excluded, for each reading.
    pub exclusions: Vec<Option<Exclusion>>,
}

impl ScanFit {
    /// The constant reading along the axes of the sensor, in tesla.
    pub fn offset_t(&self) -> DVec3 {
        self.sensor_axes.apply(self.parameters.offset_t)
    }

    /// Whether residuals change less from one reading to the next than noise does. Errors of tiles
    /// leave residuals that are smooth along the path of a scan (the ratio of J. von Neumann,
    /// Annals of Mathematical Statistics 12, 1941, 367: half the mean square difference over the
    /// mean square).
    pub fn has_smooth_residuals(&self) -> bool {
        let used = self.residuals_t.iter().zip(&self.exclusions).filter(|(_, exclusion)| exclusion.is_none());
        let residuals_t: Vec<DVec3> = used.map(|(residual_t, _)| *residual_t).collect();
        let pairs = residuals_t.windows(2).map(|pair| (pair[1] - pair[0]).length_squared());
        let differences = pairs.sum::<f64>() / residuals_t.len().saturating_sub(1).max(1) as f64;
        let squares = residuals_t.iter().map(|residual_t| residual_t.length_squared()).sum::<f64>();
        let ratio = 0.5 * differences / (squares / residuals_t.len().max(1) as f64);
        let deviation = 1.0 / (3.0 * residuals_t.len() as f64).sqrt();
        ratio < SMOOTH.min(1.0 - CERTAIN * deviation)
    }

    /// Standard deviations of [`ScanFit::offset_t`].
    pub fn offset_deviation_t(&self) -> DVec3 {
        self.sensor_axes.apply(self.deviations.offset_t).abs()
    }

    /// Whether neither the sensor nor the positions have exchanged or reversed axes.
    pub fn has_stated_axes(&self) -> bool {
        [self.sensor_axes, self.stage_axes] == [SignedAxes::SAME; 2]
    }

    /// A start with the parameters of this fit.
    pub(crate) fn start(&self) -> Start {
        Start { sensor_axes: self.sensor_axes, stage_axes: self.stage_axes, parameters: self.parameters }
    }

    /// Where the sensor was, in the frame of the tiles, at a position of the stage.
    pub fn place(&self, point: DVec3) -> DVec3 {
        self.stage_axes.apply(point) + self.parameters.start
    }

    /// The field, in the frame of the tiles, read by a sensor without offset, rotation and
    /// exchanged axes.
    pub fn corrected_t(&self, reading_t: DVec3) -> DVec3 {
        self.parameters.corrected_t(self.sensor_axes.inverse().apply(reading_t))
    }
}

/// Residuals, and the normal equations of a step.
struct Linearized {
    residuals_t: Vec<DVec3>,
    sum_of_squares: f64,
    normal: Matrix,
    right: Vector,
}

impl<'a> Scan<'a> {
    /// A scan with these parameters to fit. `readings_t` have neither gain nor offset of the
    /// sensor.
    pub(crate) fn new(
        field: &'a SensedField<'a>,
        points: &[DVec3],
        readings_t: &[DVec3],
        unusable: &[Option<Exclusion>],
        free: FreeParameters,
        start: &Start,
    ) -> Result<Scan<'a>, ScanError> {
        let Start { sensor_axes, stage_axes, parameters } = *start;
        let readings_t = readings_t.iter().map(|reading| sensor_axes.inverse().apply(*reading)).collect();
        let points: Vec<DVec3> = points.iter().map(|point| stage_axes.apply(*point)).collect();
        let used = points.iter().zip(unusable).filter(|(_, exclusion)| exclusion.is_none());
        let places: Vec<DVec3> = used.map(|(point, _)| *point + parameters.start).collect();
        let field_t = field.readings_t(&places).map_err(ScanError::Points)?;
        let gradient = field.gradients(&places).map_err(ScanError::Points)?;
        let count = places.len() as f64;
        let field_scale_t = (field_t.iter().map(|field| field.length_squared()).sum::<f64>() / count).sqrt();
        let square = |gradient: &DMat3| gradient.to_cols_array().iter().map(|g| g * g).sum::<f64>();
        let gradient_scale = (gradient.iter().map(square).sum::<f64>() / count).sqrt();
        let length = field_scale_t / gradient_scale;
        if !(field_scale_t > 0.0 && length.is_finite()) {
            return Err(ScanError::NoField);
        }
        let scales = Vector::from_fn(|index, _| match ScanParameter::ALL[index] {
            ScanParameter::Strength | ScanParameter::Rotation(_) => 1.0,
            ScanParameter::Offset(_) => field_scale_t,
            ScanParameter::Start(_) => length,
        });
        Ok(Scan { field, points, readings_t, sensor_axes, stage_axes, free, field_scale_t, scales })
    }

    /// Reading minus model at each point.
    pub(crate) fn residuals_t(&self, parameters: &ScanParameters) -> Result<Vec<DVec3>, ScanError> {
        let places: Vec<DVec3> = self.points.iter().map(|point| *point + parameters.start).collect();
        let field_t = self.field.readings_t(&places).map_err(ScanError::Points)?;
        Ok(field_t.into_iter().zip(&self.readings_t).map(|(b, reading)| *reading - parameters.reading_t(b)).collect())
    }

    /// Fits the readings that are not excluded.
    pub(crate) fn fit(&self, start: ScanParameters, exclusions: &[Option<Exclusion>]) -> Result<ScanFit, ScanError> {
        let mut parameters = start;
        let mut at = self.linearized(&parameters, exclusions)?;
        for _ in 0..MOST_STEPS {
            let step = self.step(&at)?;
            let mut shortened = step;
            let (next, there) = loop {
                let next = self.moved(&parameters, &shortened);
                // A step to points without a field is too long.
                match self.linearized(&next, exclusions) {
                    Ok(there) if there.sum_of_squares <= at.sum_of_squares => break (next, there),
                    _ if shortened.norm() < SHORTEST_STEP * step.norm().max(1.0) => {
                        break (parameters, self.linearized(&parameters, exclusions)?);
                    }
                    _ => shortened *= 0.5,
                }
            };
            let gain = at.sum_of_squares - there.sum_of_squares;
            let is_over = gain <= LEAST_GAIN * at.sum_of_squares;
            (parameters, at) = (next, there);
            if is_over {
                return self.fitted(parameters, at, exclusions);
            }
        }
        self.determined(&at, exclusions)?;
        Err(ScanError::NoConvergence)
    }

    /// The covariance of the scaled parameters over the variance of the residuals, and the standard
    /// deviation of the residuals.
    ///
    /// # Errors
    /// Names the parameters that the readings do not determine: the model holds, and the residuals
    /// leave a parameter a deviation beyond the region where it is linear.
    fn determined(&self, at: &Linearized, exclusions: &[Option<Exclusion>]) -> Result<(Matrix, f64), ScanError> {
        let kept = exclusions.iter().filter(|exclusion| exclusion.is_none()).count();
        let freedom = (3 * kept).saturating_sub(self.free.count()).max(1);
        let noise_t = (at.sum_of_squares / freedom as f64).sqrt();
        let covariance = self.inverse(&at.normal)?;
        let deviation = |index: usize| noise_t * covariance[(index, index)].max(0.0).sqrt();
        let is_vague = |of: &ScanParameter| deviation(of.index()) > MOST_DEVIATION;
        let vague: Vec<ScanParameter> = ScanParameter::ALL.into_iter().filter(is_vague).collect();
        if noise_t <= MADE_RESIDUAL * self.field_scale_t && !vague.is_empty() {
            return Err(ScanError::Undetermined(vague));
        }
        Ok((covariance, noise_t))
    }

    fn linearized(
        &self,
        parameters: &ScanParameters,
        exclusions: &[Option<Exclusion>],
    ) -> Result<Linearized, ScanError> {
        let places: Vec<DVec3> = self.points.iter().map(|point| *point + parameters.start).collect();
        let field_t = self.field.readings_t(&places).map_err(ScanError::Points)?;
        let gradient = self.field.gradients(&places).map_err(ScanError::Points)?;
        let (back, strength) = (parameters.turn().inverse(), parameters.strength);
        let mut residuals_t = Vec::with_capacity(places.len());
        let (mut normal, mut right, mut sum_of_squares) = (Matrix::zeros(), Vector::zeros(), 0.0);
        for (index, (field_t, gradient)) in field_t.into_iter().zip(gradient).enumerate() {
            let residual = self.readings_t[index] - parameters.reading_t(field_t);
            residuals_t.push(residual);
            if exclusions[index].is_some() {
                continue;
            }
            sum_of_squares += residual.length_squared();
            let field = strength * field_t;
            // A turn by d of the sensor changes the reading R^-1 b by R^-1 (b x d).
            let columns = ScanParameter::ALL.map(|parameter| match parameter {
                ScanParameter::Strength => back * field_t,
                ScanParameter::Offset(axis) => axis.unit(),
                ScanParameter::Rotation(axis) => back * field.cross(axis.unit()),
                ScanParameter::Start(axis) => back * (strength * gradient.col(axis.index())),
            });
            for (i, a) in columns.iter().enumerate() {
                right[i] += a.dot(residual);
                for (j, b) in columns.iter().enumerate().skip(i) {
                    normal[(i, j)] += a.dot(*b);
                }
            }
        }
        for i in 0..PARAMETERS {
            right[i] *= self.scales[i];
            for j in i..PARAMETERS {
                normal[(i, j)] *= self.scales[i] * self.scales[j];
                normal[(j, i)] = normal[(i, j)];
            }
        }
        Ok(Linearized { residuals_t, sum_of_squares, normal, right })
    }

    /// The inverse of the normal matrix of the free parameters; zero for the others.
    fn inverse(&self, normal: &Matrix) -> Result<Matrix, ScanError> {
        let is_free = |index: usize| self.free.contains(ScanParameter::ALL[index]);
        // A fixed parameter gets a separate equation.
        let reduced = Matrix::from_fn(|i, j| match (is_free(i) && is_free(j), i == j) {
            (true, _) => normal[(i, j)],
            (false, true) => normal.trace() / PARAMETERS as f64,
            (false, false) => 0.0,
        });
        let SymmetricEigen { eigenvalues, eigenvectors } = SymmetricEigen::new(reduced);
        let largest = eigenvalues.amax();
        let mut undetermined = [false; PARAMETERS];
        let mut inverse = Matrix::zeros();
        for (index, &eigenvalue) in eigenvalues.iter().enumerate() {
            let vector = eigenvectors.column(index);
            if eigenvalue > UNDETERMINED * largest {
                inverse += vector * vector.transpose() / eigenvalue;
                continue;
            }
            let most = vector.amax();
            for (is_undetermined, part) in undetermined.iter_mut().zip(vector.iter()) {
                *is_undetermined |= part.abs() > LEAST_PART * most;
            }
        }
        if undetermined.contains(&true) {
            let all = ScanParameter::ALL.into_iter().zip(undetermined);
            let undetermined = all.filter(|(_, is_undetermined)| *is_undetermined).map(|(parameter, _)| parameter);
            return Err(ScanError::Undetermined(undetermined.collect()));
        }
        for i in (0..PARAMETERS).filter(|i| !is_free(*i)) {
            inverse.fill_row(i, 0.0);
            inverse.fill_column(i, 0.0);
        }
        Ok(inverse)
    }

    /// The scaled step to the least squares of the linear model.
    fn step(&self, at: &Linearized) -> Result<Vector, ScanError> {
        Ok(self.inverse(&at.normal)? * at.right)
    }

    fn moved(&self, from: &ScanParameters, step: &Vector) -> ScanParameters {
        let step = ScanParameters::from_fn(|parameter| step[parameter.index()] * self.scales[parameter.index()]);
        let turn = DQuat::from_scaled_axis(step.rotation_rad) * from.turn();
        ScanParameters {
            strength: from.strength + step.strength,
            offset_t: from.offset_t + step.offset_t,
            rotation_rad: shortest(turn).to_scaled_axis(),
            start: from.start + step.start,
        }
    }

    fn fitted(
        &self,
        parameters: ScanParameters,
        at: Linearized,
        exclusions: &[Option<Exclusion>],
    ) -> Result<ScanFit, ScanError> {
        let (covariance, noise_t) = self.determined(&at, exclusions)?;
        let deviations = ScanParameters::from_fn(|parameter| {
            let index = parameter.index();
            noise_t * covariance[(index, index)].max(0.0).sqrt() * self.scales[index]
        });
        Ok(ScanFit {
            parameters,
            deviations,
            sensor_axes: self.sensor_axes,
            stage_axes: self.stage_axes,
            noise_t,
            residuals_t: at.residuals_t.into_iter().map(|residual| self.sensor_axes.apply(residual)).collect(),
            exclusions: exclusions.to_vec(),
        })
    }
}

/// The same rotation by at most half a turn.
fn shortest(rotation: DQuat) -> DQuat {
    if rotation.w < 0.0 { -rotation } else { rotation }
}
