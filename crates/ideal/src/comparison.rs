//! The difference of a field from a reference.

use std::fmt;

use glam::DVec3;

/// Smallest spread of values that differ, as a fraction of their mean. Rounding of the mean gives
/// equal values a spread below it.
const ROUNDED_SPREAD: f64 = 1e-14;

/// The difference of a field from a reference on the same points.
///
/// # Units
/// Fields are in tesla, points in any one unit of length. Serialized, the unit is the millimetre,
/// as in all files.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use magsplice_ideal::Comparison;
///
/// let points = [DVec3::ZERO, DVec3::X];
/// let reference = [DVec3::X, DVec3::Y];
/// let comparison = Comparison::new(&points, &[0.8 * DVec3::X, 0.8 * DVec3::Y], &reference)?;
/// assert!((comparison.amplitude - 0.8).abs() < 1e-15);
/// assert!((comparison.relative_rmse - 0.2).abs() < 1e-15);
/// # Ok::<(), magsplice_ideal::ComparisonError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Comparison {
    /// Number of points.
    pub points: usize,
    /// Root of the mean squared difference of each component.
    pub component_rmse_t: DVec3,
    /// Root of the mean squared length of the difference.
    pub rmse_t: f64,
    /// `rmse_t` over the root mean square of the reference.
    pub relative_rmse: f64,
    /// Largest length of the difference.
    pub worst_t: f64,
    /// The first point with the largest difference.
    #[cfg_attr(feature = "serde", serde(rename = "worst_at_mm"))]
    pub worst_at: DVec3,
    /// Factor of the reference that fits the field best (least squares over all components).
    pub amplitude: f64,
    /// Relative RMSE against the reference times `amplitude`; `None` if `amplitude` is zero.
    pub scaled_relative_rmse: Option<f64>,
    /// Pearson's correlation of each component; `None` where a component does not vary.
    pub correlation: [Option<f64>; 3],
}

/// The reason why two fields cannot be compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ComparisonError {
    /// There are no points.
    NoPoints,
    /// The reference is zero at every point, so a relative difference is undefined.
    NoReference,
    /// The fields differ so much in size that their squares overflow.
    OutOfScale,
}

impl Comparison {
    /// Compares `field` with `reference` at `points`.
    ///
    /// # Accuracy
    /// Sums over n points are rounded n times: their relative errors are below n times 1e-16.
    ///
    /// # Errors
    /// If there are no points, the reference is zero everywhere, or squares overflow.
    ///
    /// # Panics
    /// If the slices differ in length.
    pub fn new(points: &[DVec3], field: &[DVec3], reference: &[DVec3]) -> Result<Comparison, ComparisonError> {
        assert_eq!(points.len(), field.len(), "one field value per point");
        assert_eq!(points.len(), reference.len(), "one reference value per point");
        if points.is_empty() {
            return Err(ComparisonError::NoPoints);
        }
        let count = points.len() as f64;
        // Divided by the largest component of the reference, so that squares stay in range.
        let unit = reference.iter().map(|r| r.abs().max_element()).fold(0.0, f64::max);
        if unit == 0.0 {
            return Err(ComparisonError::NoReference);
        }
        let pairs = || field.iter().zip(reference).map(|(f, r)| (*f / unit, *r / unit));
        let square: f64 = pairs().map(|(_, r)| r.length_squared()).sum();
        let product: f64 = pairs().map(|(f, r)| f.dot(r)).sum();
        let amplitude = product / square;
        let squares = pairs().map(|(f, r)| (f - r) * (f - r)).sum::<DVec3>();
        let scaled: f64 = pairs().map(|(f, r)| f.distance_squared(amplitude * r)).sum();
        if !amplitude.is_finite() || !squares.is_finite() || !scaled.is_finite() {
            return Err(ComparisonError::OutOfScale);
        }
        let worst = pairs().map(|(f, r)| f.distance_squared(r)).enumerate();
        let worst = worst.fold((0, 0.0), |best, (i, d)| if d > best.1 { (i, d) } else { best }).0;
        let rmse_t = unit * (squares.element_sum() / count).sqrt();
        Ok(Comparison {
            points: points.len(),
            component_rmse_t: unit * (squares / count).map(f64::sqrt),
            rmse_t,
            relative_rmse: (squares.element_sum() / square).sqrt(),
            worst_t: unit * (field[worst] / unit).distance(reference[worst] / unit),
            worst_at: points[worst],
            amplitude,
            scaled_relative_rmse: (amplitude != 0.0).then(|| (scaled / square).sqrt() / amplitude.abs()),
            correlation: [0, 1, 2].map(|axis| correlation(field, reference, axis, unit)),
        })
    }
}

/// Pearson's correlation of one component; `None` where one of the two varies by no more than
/// round-off.
fn correlation(field: &[DVec3], reference: &[DVec3], axis: usize, unit: f64) -> Option<f64> {
    let count = field.len() as f64;
    let mean = |values: &[DVec3]| values.iter().map(|v| v[axis] / unit).sum::<f64>() / count;
    let (field_mean, reference_mean) = (mean(field), mean(reference));
    let (mut ff, mut fr, mut rr) = (0.0, 0.0, 0.0);
    for (f, r) in field.iter().zip(reference) {
        let (f, r) = (f[axis] / unit - field_mean, r[axis] / unit - reference_mean);
        ff += f * f;
        fr += f * r;
        rr += r * r;
    }
    let constant = |squares: f64, mean: f64| squares.sqrt() <= ROUNDED_SPREAD * mean.abs() * count.sqrt();
    if constant(ff, field_mean) || constant(rr, reference_mean) {
        return None;
    }
    let correlation = fr / (ff.sqrt() * rr.sqrt());
    correlation.is_finite().then_some(correlation)
}

impl fmt::Display for ComparisonError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            ComparisonError::NoPoints => "there are no points to compare",
            ComparisonError::NoReference => {
                "the reference is zero at every point, so relative differences are undefined"
            }
            ComparisonError::OutOfScale => "the fields differ so much in size that their squares overflow",
        })
    }
}

impl std::error::Error for ComparisonError {}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn scaled_field_and_one_outlier_have_the_expected_errors() {
        let points = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let reference = [DVec3::new(1.0, 2.0, 0.0), DVec3::new(-1.0, 0.0, 0.0), DVec3::new(0.0, 1.0, 0.0)];
        let mut field = reference.map(|r| 0.5 * r);
        let same = Comparison::new(&points, &field, &reference).unwrap();
        assert_relative_eq!(same.amplitude, 0.5);
        assert_relative_eq!(same.relative_rmse, 0.5);
        assert_eq!(same.scaled_relative_rmse, Some(0.0));
        assert_relative_eq!(same.correlation[0].unwrap(), 1.0, epsilon = 1e-15);
        assert_eq!((same.correlation[2], same.worst_at), (None, DVec3::ZERO));
        assert_relative_eq!(same.component_rmse_t.y, (1.25_f64 / 3.0).sqrt());
        assert_relative_eq!(same.rmse_t, (1.75_f64 / 3.0).sqrt());
        let constant = Comparison::new(&[DVec3::X; 10], &[0.1 * DVec3::X; 10], &[0.1 * DVec3::X; 10]).unwrap();
        assert_eq!(constant.correlation[0], None);
        field[2].z = 3.0;
        let other = Comparison::new(&points, &field, &reference).unwrap();
        assert_eq!(other.worst_at, DVec3::Y);
        assert_relative_eq!(other.worst_t, 9.25_f64.sqrt());
    }

    #[test]
    fn fields_without_points_reference_or_scale_are_refused() {
        assert_eq!(Comparison::new(&[], &[], &[]), Err(ComparisonError::NoPoints));
        let one = [DVec3::X];
        assert_eq!(Comparison::new(&one, &one, &[DVec3::ZERO]), Err(ComparisonError::NoReference));
        assert_eq!(Comparison::new(&one, &[1e200 * DVec3::X], &[1e-200 * DVec3::X]), Err(ComparisonError::OutOfScale));
        let tiny = Comparison::new(&one, &[1e-200 * DVec3::X], &[2e-200 * DVec3::X]).unwrap();
        assert_relative_eq!(tiny.amplitude, 0.5);
        let across = Comparison::new(&one, &one, &[DVec3::Y]).unwrap();
        assert_eq!((across.amplitude, across.scaled_relative_rmse), (0.0, None));
    }
}
