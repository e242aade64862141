//! Forces from displacements: the straight line of an elastic layer, fitted by least squares.

use statrs::distribution::{ContinuousCDF, StudentsT};
use thiserror::Error;

/// Probability that an interval contains the true value.
const CONFIDENCE: f64 = 0.95;

/// Extent of the displacements, over the largest displacement, below which a line through them has
/// no slope: the round-off of a difference.
const LEAST_EXTENT: f64 = 1e-9;

/// The line F = stiffness d + force at rest along one axis (Dai 2024, Eqs. 16 and 17, with
/// calibrated coefficients).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Stiffness {
    /// Force per displacement.
    #[cfg_attr(feature = "serde", serde(rename = "stiffness_n_per_mm"))]
    pub stiffness: f64,
    /// Half the width of the interval of 95 % confidence of the stiffness.
    #[cfg_attr(feature = "serde", serde(rename = "stiffness_n_per_mm_95"))]
    pub stiffness_95: f64,
    /// Force without displacement.
    #[cfg_attr(feature = "serde", serde(rename = "force_at_rest_n"))]
    pub force_at_rest: f64,
    /// Half the width of the interval of 95 % confidence of the force at rest.
    #[cfg_attr(feature = "serde", serde(rename = "force_at_rest_n_95"))]
    pub force_at_rest_95: f64,
    /// Standard deviation of the residuals, as a force.
    #[cfg_attr(feature = "serde", serde(rename = "residual_n"))]
    pub residual: f64,
}

/// The reason why a line cannot be fitted.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum StiffnessError {
    /// Fewer than three readings.
    #[error("too few readings for a line, must be at least 3")]
    TooFew,
    /// All displacements are the same.
    #[error("all displacements are the same")]
    NoExtent,
}

impl Stiffness {
    /// Fits the line to displacements and their forces. The model has normal errors of the forces;
    /// the intervals are Student's.
    ///
    /// Errors of the displacements flatten the line by the ratio of their variance to the variance
    /// of the displacements.
    ///
    /// # Errors
    /// See [`StiffnessError`].
    ///
    /// # Panics
    /// If the numbers of forces and displacements differ.
    pub fn fit(displacements: &[f64], forces: &[f64]) -> Result<Stiffness, StiffnessError> {
        assert_eq!(displacements.len(), forces.len(), "a force for each displacement");
        let count = forces.len();
        if count < 3 {
            return Err(StiffnessError::TooFew);
        }
        let n = count as f64;
        let mean = |values: &[f64]| values.iter().sum::<f64>() / n;
        let (middle, mean_force) = (mean(displacements), mean(forces));
        let spread: f64 = displacements.iter().map(|d| (d - middle).powi(2)).sum();
        let largest = displacements.iter().fold(0.0_f64, |most, d| most.max(d.abs()));
        if !((spread / n).sqrt() > LEAST_EXTENT * largest) {
            return Err(StiffnessError::NoExtent);
        }
        let products: f64 = displacements.iter().zip(forces).map(|(d, f)| (d - middle) * (f - mean_force)).sum();
        let stiffness = products / spread;
        let force_at_rest = mean_force - stiffness * middle;
        let squares: f64 =
            displacements.iter().zip(forces).map(|(d, f)| (f - force_at_rest - stiffness * d).powi(2)).sum();
        let residual = (squares / (n - 2.0)).sqrt();
        let student = StudentsT::new(0.0, 1.0, n - 2.0).expect("a positive number of degrees of freedom");
        let quantile = student.inverse_cdf(0.5 + 0.5 * CONFIDENCE);
        Ok(Stiffness {
            stiffness,
            force_at_rest,
            stiffness_95: quantile * residual / spread.sqrt(),
            force_at_rest_95: quantile * residual * (1.0 / n + middle * middle / spread).sqrt(),
            residual,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The slope of these is 1.99 and the intercept 1.04, by hand; the quantile of Student at 0.975
    /// with three degrees of freedom is 3.182446 in every table.
    #[test]
    fn line_and_intervals_are_those_of_a_linear_model() {
        let line = Stiffness::fit(&[0.0, 1.0, 2.0, 3.0, 4.0], &[1.1, 2.9, 5.2, 6.8, 9.1]).unwrap();
        assert!((line.stiffness - 1.99).abs() < 1e-12 && (line.force_at_rest - 1.04).abs() < 1e-12, "{line:?}");
        // The residuals are 0.06, -0.13, 0.18, -0.21, 0.10: their squares sum up to 0.107.
        let residual = (0.107_f64 / 3.0).sqrt();
        assert!((line.residual - residual).abs() < 1e-12, "{line:?}");
        assert!((line.stiffness_95 - 3.182_446 * residual / 10.0_f64.sqrt()).abs() < 1e-6, "{line:?}");
        assert!((line.force_at_rest_95 - 3.182_446 * residual * (0.2_f64 + 0.4).sqrt()).abs() < 1e-6, "{line:?}");
    }

    #[test]
    fn displacements_without_extent_are_refused() {
        assert_eq!(Stiffness::fit(&[1.0, 2.0], &[1.0, 2.0]), Err(StiffnessError::TooFew));
        assert_eq!(Stiffness::fit(&[1.0; 5], &[1.0, 2.0, 3.0, 4.0, 5.0]), Err(StiffnessError::NoExtent));
        assert_eq!(Stiffness::fit(&[0.0; 5], &[0.0; 5]), Err(StiffnessError::NoExtent));
    }
}
