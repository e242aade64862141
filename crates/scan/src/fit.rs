//! Least-squares fit of the unknown parameters of a measured scan to the field of the tiles.

use glam::DVec3;
use magsplice_sensor::SensedField;

use crate::fit_error::ScanError;
use crate::least_squares::{Scan, ScanFit};
use crate::parameters::{FreeParameters, ScanParameters};

/// Number of standard deviations from the fit beyond which a component is an outlier. Among a
/// million normal errors, one exceeds five standard deviations in half of all scans, and six in one
/// scan of 500.
const OUTLIER: f64 = 6.0;

/// The standard deviation of normal errors over the median of their magnitudes.
const DEVIATION_OVER_MEDIAN: f64 = 1.482_602_218_505_602;

/// Smallest assumed noise, as a fraction of the root mean square of the readings, so that round-off
/// has no outliers.
const LEAST_NOISE: f64 = 1e-12;

/// Largest number of rounds that search and exclude outliers.
const OUTLIER_ROUNDS: usize = 20;

/// Largest share of outliers. Beyond it the scan belongs to another film.
const MOST_OUTLIERS: f64 = 0.2;

/// Fits the parameters of a scan: readings of a sensor, in tesla, at positions of the scan.
///
/// Gauss-Newton steps begin with the perfect scan and use the exact field and its gradient.
/// Readings farther from the fit than six standard deviations are excluded and the rest is fitted
/// anew, until no further reading is excluded. The median of the residuals gives the standard
/// deviation.
///
/// # Errors
/// See [`ScanError`].
///
/// # Panics
/// If the numbers of points and readings differ.
pub fn fit_scan<'a>(
    field: impl Into<SensedField<'a>>,
    points: &[DVec3],
    readings_t: &[DVec3],
    free: FreeParameters,
) -> Result<ScanFit, ScanError> {
    assert_eq!(points.len(), readings_t.len(), "one reading per point");
    let needed = free.count().div_ceil(3) + 1;
    if readings_t.len() < needed {
        return Err(ScanError::TooFew { readings: readings_t.len(), needed });
    }
    let scan = Scan::new(&field.into(), points, readings_t, free)?;
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
            return Ok(fit);
        }
        is_outlier = found;
    }
    Err(ScanError::NoConvergence)
}

/// Whether each residual is an outlier.
fn outliers(residuals_t: &[DVec3], least_noise_t: f64) -> Vec<bool> {
    let mut magnitudes: Vec<f64> = residuals_t.iter().flat_map(|residual| residual.abs().to_array()).collect();
    let middle = magnitudes.len() / 2;
    let (_, median, _) = magnitudes.select_nth_unstable_by(middle, f64::total_cmp);
    let limit = OUTLIER * (DEVIATION_OVER_MEDIAN * *median).max(least_noise_t);
    residuals_t.iter().map(|residual| residual.abs().max_element() > limit).collect()
}
