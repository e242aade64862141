//! A measured scan of the field against the field of the tiles: what cannot be known beforehand is
//! fitted by least squares.

use std::error::Error;
use std::fmt;

use glam::{DMat3, DQuat, DVec3};
use magsplice_field::Scene;
use magsplice_magnet::{PointErrors, Quantity};
use nalgebra::{SMatrix, SVector, SymmetricEigen};

/// Number of parameters: strength, offset, rotation, start.
const PARAMETERS: usize = 10;

type Vector = SVector<f64, PARAMETERS>;
type Matrix = SMatrix<f64, PARAMETERS, PARAMETERS>;

/// Most steps of one fit. Fits that converge take about six.
const MOST_STEPS: usize = 50;

/// Relative change of the sum of squares below which a fit ends.
const LEAST_GAIN: f64 = 1e-12;

/// Eigenvalue of the scaled normal matrix, over the largest, below which a combination of parameters is
/// not determined by the scan. Round-off of the matrix is 1e-16 of the largest.
const UNDETERMINED: f64 = 1e-12;

/// A reading is an outlier if a component is farther from the fit than this many standard deviations.
/// Of a million normal errors, one exceeds five of them by chance in half of all scans, and six in one
/// of 500.
const OUTLIER: f64 = 6.0;

/// The standard deviation of normal errors over the median of their magnitudes.
const DEVIATION_OVER_MEDIAN: f64 = 1.482_602_218_505_602;

/// Noise that is assumed at least, as a fraction of the root mean square of the readings, so that
/// round-off has no outliers.
const LEAST_NOISE: f64 = 1e-12;

/// Most rounds in which outliers are sought and left out.
const OUTLIER_ROUNDS: usize = 20;

/// Largest share of outliers: beyond it the film of the scan is another one.
const MOST_OUTLIERS: f64 = 0.2;

/// What is fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeParameters {
    /// The strength of all tiles.
    pub strength: bool,
    /// A constant reading: the offset of the sensor and a uniform stray field together.
    pub offset: bool,
    /// The rotation of the sensor.
    pub rotation: bool,
    /// The position of the sensor at the origin of the scan.
    pub start: bool,
}

/// How a scan was taken: a sensor at p reads R^-1 (strength B(p + start)) + offset.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ScanParameters {
    /// Strength of all tiles over that of the layout.
    pub strength: f64,
    /// Constant reading along the axes of the sensor, in tesla.
    pub offset_t: DVec3,
    /// Rotation vector of the sensor in the frame of the tiles, in radians.
    pub rotation_rad: DVec3,
    /// Position of the sensor, in the frame of the tiles, where the scan has its origin.
    pub start: DVec3,
}

/// A fitted scan.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ScanFit {
    /// The parameters.
    pub parameters: ScanParameters,
    /// Their standard deviations, from the residuals; 0 for those that were not fitted.
    pub deviations: ScanParameters,
    /// Standard deviation of the residuals of one component, without outliers, in tesla.
    pub noise_t: f64,
    /// Reading minus fit at each point, outliers too, in tesla and along the axes of the sensor.
    pub residuals_t: Vec<DVec3>,
    /// Indices of the readings that were left out, in ascending order.
    pub outliers: Vec<usize>,
}

/// Why a scan cannot be fitted.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum ScanError {
    /// There are too few readings for the parameters.
    TooFew {
        /// Number of readings.
        readings: usize,
        /// Fewest that are needed.
        needed: usize,
    },
    /// The scan does not tell these parameters apart, or has no information about them.
    Undetermined(Vec<&'static str>),
    /// More readings than can be outliers are far from every fit.
    AnotherFilm {
        /// Number of readings far from the fit.
        outliers: usize,
    },
    /// The steps did not converge.
    NoConvergence,
    /// Points without a field.
    Points(PointErrors),
}

impl ScanParameters {
    /// Those of a perfect scan.
    pub const PERFECT: ScanParameters =
        ScanParameters { strength: 1.0, offset_t: DVec3::ZERO, rotation_rad: DVec3::ZERO, start: DVec3::ZERO };

    /// The reading where the field of the tiles is `field_t`.
    pub fn reading_t(&self, field_t: DVec3) -> DVec3 {
        self.turn().inverse() * (self.strength * field_t) + self.offset_t
    }

    /// The field, in the frame of the tiles, that a sensor without offset and rotation would have read.
    pub fn corrected_t(&self, reading_t: DVec3) -> DVec3 {
        self.turn() * (reading_t - self.offset_t)
    }

    fn turn(&self) -> DQuat {
        DQuat::from_scaled_axis(self.rotation_rad)
    }
}

/// Fits the parameters of a scan: readings of a sensor, in tesla, at positions of the scan.
///
/// Gauss-Newton steps begin with the perfect scan and use the exact field and its gradient. Readings
/// farther from the fit than six standard deviations are left out and the rest is fitted anew, until no
/// reading is; the standard deviation is that of the median.
///
/// # Errors
/// See [`ScanError`].
///
/// # Panics
/// If there are not as many points as readings.
pub fn fit_scan(
    scene: &Scene,
    points: &[DVec3],
    readings_t: &[DVec3],
    free: FreeParameters,
) -> Result<ScanFit, ScanError> {
    assert_eq!(points.len(), readings_t.len(), "one reading per point");
    let free = free.indices();
    let needed = free.len().div_ceil(3) + 1;
    if readings_t.len() < needed {
        return Err(ScanError::TooFew { readings: readings_t.len(), needed });
    }
    let scan = Scan::new(scene, points, readings_t, free)?;
    let mut is_outlier = vec![false; points.len()];
    let mut parameters = ScanParameters::PERFECT;
    for _ in 0..OUTLIER_ROUNDS {
        let fit = scan.fit(parameters, &is_outlier)?;
        parameters = fit.parameters;
        let found = outliers(&fit.residuals_t, LEAST_NOISE * scan.field_scale_t);
        let outliers = found.iter().filter(|is_outlier| **is_outlier).count();
        if outliers as f64 > MOST_OUTLIERS * points.len() as f64 {
            return Err(ScanError::AnotherFilm { outliers });
        }
        if found == is_outlier {
            return Ok(ScanFit { outliers: (0..points.len()).filter(|index| found[*index]).collect(), ..fit });
        }
        is_outlier = found;
    }
    Err(ScanError::NoConvergence)
}

/// Which residuals are outliers.
fn outliers(residuals_t: &[DVec3], least_noise_t: f64) -> Vec<bool> {
    let mut magnitudes: Vec<f64> = residuals_t.iter().flat_map(|residual| residual.abs().to_array()).collect();
    let middle = magnitudes.len() / 2;
    let (_, median, _) = magnitudes.select_nth_unstable_by(middle, f64::total_cmp);
    let limit = OUTLIER * (DEVIATION_OVER_MEDIAN * *median).max(least_noise_t);
    residuals_t.iter().map(|residual| residual.abs().max_element() > limit).collect()
}

impl FreeParameters {
    /// Everything.
    pub const ALL: FreeParameters = FreeParameters { strength: true, offset: true, rotation: true, start: true };

    fn indices(self) -> Vec<usize> {
        let FreeParameters { strength, offset, rotation, start } = self;
        let is_free = |index: usize| match index {
            0 => strength,
            1..=3 => offset,
            4..=6 => rotation,
            _ => start,
        };
        (0..PARAMETERS).filter(|index| is_free(*index)).collect()
    }
}

/// The names of the parameters.
const NAMES: [&str; PARAMETERS] = [
    "strength",
    "offset along x",
    "offset along y",
    "offset along z",
    "rotation about x",
    "rotation about y",
    "rotation about z",
    "start along x",
    "start along y",
    "start along z",
];

/// A scan that is fitted.
struct Scan<'a> {
    scene: &'a Scene,
    points: &'a [DVec3],
    readings_t: &'a [DVec3],
    free: Vec<usize>,
    /// Root mean square of the field, in tesla.
    field_scale_t: f64,
    /// What each parameter is divided by, so that all change the readings alike.
    scales: Vector,
}

/// Residuals, and the normal equations of a step.
struct Linearized {
    residuals_t: Vec<DVec3>,
    sum_of_squares: f64,
    normal: Matrix,
    right: Vector,
}

impl<'a> Scan<'a> {
    fn new(
        scene: &'a Scene,
        points: &'a [DVec3],
        readings_t: &'a [DVec3],
        free: Vec<usize>,
    ) -> Result<Scan<'a>, ScanError> {
        let field_t = scene.field_at(Quantity::FluxDensity, points).map_err(ScanError::Points)?;
        let gradient = scene.gradient_at(Quantity::FluxDensity, points).map_err(ScanError::Points)?;
        let count = points.len() as f64;
        let field_scale_t = (field_t.iter().map(|field| field.length_squared()).sum::<f64>() / count).sqrt();
        let square = |gradient: &DMat3| gradient.to_cols_array().iter().map(|g| g * g).sum::<f64>();
        let gradient_scale = (gradient.iter().map(square).sum::<f64>() / count).sqrt();
        let length = field_scale_t / gradient_scale;
        if !(field_scale_t > 0.0 && length.is_finite()) {
            return Err(ScanError::Undetermined(vec!["every parameter: the film has no field there"]));
        }
        let scales = Vector::from_fn(|index, _| match index {
            0 | 4..=6 => 1.0,
            1..=3 => field_scale_t,
            _ => length,
        });
        Ok(Scan { scene, points, readings_t, free, field_scale_t, scales })
    }

    /// Fits the readings that are no outliers.
    fn fit(&self, start: ScanParameters, is_outlier: &[bool]) -> Result<ScanFit, ScanError> {
        let mut parameters = start;
        let mut at = self.linearized(&parameters, is_outlier)?;
        for _ in 0..MOST_STEPS {
            let step = self.step(&at)?;
            let mut shortened = step;
            let (next, there) = loop {
                let next = self.moved(&parameters, &shortened);
                // A step to points without a field is too long.
                match self.linearized(&next, is_outlier) {
                    Ok(there) if there.sum_of_squares <= at.sum_of_squares => break (next, there),
                    _ if shortened.norm() < 1e-12 * step.norm() || shortened.norm() < f64::EPSILON => {
                        break (parameters, self.linearized(&parameters, is_outlier)?);
                    }
                    _ => shortened *= 0.5,
                }
            };
            let gain = at.sum_of_squares - there.sum_of_squares;
            let is_over = gain <= LEAST_GAIN * at.sum_of_squares;
            (parameters, at) = (next, there);
            if is_over {
                return self.fitted(parameters, at, is_outlier);
            }
        }
        Err(ScanError::NoConvergence)
    }

    fn linearized(&self, parameters: &ScanParameters, is_outlier: &[bool]) -> Result<Linearized, ScanError> {
        let places: Vec<DVec3> = self.points.iter().map(|point| *point + parameters.start).collect();
        let field_t = self.scene.field_at(Quantity::FluxDensity, &places).map_err(ScanError::Points)?;
        let gradient = self.scene.gradient_at(Quantity::FluxDensity, &places).map_err(ScanError::Points)?;
        let (back, strength) = (parameters.turn().inverse(), parameters.strength);
        let mut residuals_t = Vec::with_capacity(places.len());
        let (mut normal, mut right, mut sum_of_squares) = (Matrix::zeros(), Vector::zeros(), 0.0);
        for (index, (field_t, gradient)) in field_t.into_iter().zip(gradient).enumerate() {
            let residual = self.readings_t[index] - parameters.reading_t(field_t);
            residuals_t.push(residual);
            if is_outlier[index] {
                continue;
            }
            sum_of_squares += residual.length_squared();
            let field = strength * field_t;
            // A turn by d of the sensor changes the reading R^-1 b by R^-1 (b x d).
            let columns: [DVec3; PARAMETERS] = std::array::from_fn(|parameter| match parameter {
                0 => back * field_t,
                1..=3 => DVec3::AXES[parameter - 1],
                4..=6 => back * field.cross(DVec3::AXES[parameter - 4]),
                _ => back * (strength * gradient.col(parameter - 7)),
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
        let is_free = |index: usize| self.free.contains(&index);
        // A fixed parameter has an equation of its own.
        let reduced = Matrix::from_fn(|i, j| match (is_free(i) && is_free(j), i == j) {
            (true, _) => normal[(i, j)],
            (false, true) => normal.trace() / PARAMETERS as f64,
            (false, false) => 0.0,
        });
        let SymmetricEigen { eigenvalues, eigenvectors } = SymmetricEigen::new(reduced);
        let largest = eigenvalues.amax();
        let mut undetermined: Vec<&'static str> = Vec::new();
        let mut inverse = Matrix::zeros();
        for (index, &eigenvalue) in eigenvalues.iter().enumerate() {
            let vector = eigenvectors.column(index);
            if !(eigenvalue > UNDETERMINED * largest) {
                let most = vector.amax();
                undetermined.extend((0..PARAMETERS).filter(|i| vector[*i].abs() > 0.3 * most).map(|i| NAMES[i]));
                continue;
            }
            inverse += vector * vector.transpose() / eigenvalue;
        }
        if !undetermined.is_empty() {
            undetermined.dedup();
            return Err(ScanError::Undetermined(undetermined));
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
        let step = step.component_mul(&self.scales);
        let vector = |first: usize| DVec3::new(step[first], step[first + 1], step[first + 2]);
        ScanParameters {
            strength: from.strength + step[0],
            offset_t: from.offset_t + vector(1),
            rotation_rad: (DQuat::from_scaled_axis(vector(4)) * from.turn()).to_scaled_axis(),
            start: from.start + vector(7),
        }
    }

    fn fitted(&self, parameters: ScanParameters, at: Linearized, is_outlier: &[bool]) -> Result<ScanFit, ScanError> {
        let kept = is_outlier.iter().filter(|is_outlier| !**is_outlier).count();
        let freedom = (3 * kept).saturating_sub(self.free.len()).max(1);
        let noise_t = (at.sum_of_squares / freedom as f64).sqrt();
        let covariance = self.inverse(&at.normal)?;
        let deviation = |index: usize| noise_t * covariance[(index, index)].max(0.0).sqrt() * self.scales[index];
        let vector = |first: usize| DVec3::new(deviation(first), deviation(first + 1), deviation(first + 2));
        let deviations =
            ScanParameters { strength: deviation(0), offset_t: vector(1), rotation_rad: vector(4), start: vector(7) };
        Ok(ScanFit { parameters, deviations, noise_t, residuals_t: at.residuals_t, outliers: Vec::new() })
    }
}

impl fmt::Display for ScanError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            ScanError::TooFew { readings, needed } => {
                write!(f, "too few readings for the parameters: {readings}, must be at least {needed}")
            }
            ScanError::Undetermined(names) => {
                write!(f, "the scan does not determine {}: fit fewer parameters", names.join(", "))
            }
            ScanError::AnotherFilm { outliers } => write!(
                f,
                "readings farther from the fit than noise allows: {outliers}; the scan is of another film, or its \
                 positions are off by more than a quarter of a wavelength"
            ),
            ScanError::NoConvergence => {
                write!(f, "the fit does not converge: the positions may be off by more than a quarter of a wavelength")
            }
            ScanError::Points(errors) => write!(f, "points of the scan have no field: {errors}"),
        }
    }
}

impl Error for ScanError {}
