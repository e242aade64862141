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
    /// Number of forces that the line was fitted to.
    pub forces: usize,
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
    /// More than a fifth of the forces contradict every line.
    #[error("{outliers} of {forces} forces contradict every line")]
    NoLine {
        /// Number of forces far from the line.
        outliers: usize,
        /// Number of forces.
        forces: usize,
    },
}

impl Stiffness {
    /// Fits the line to displacements and their forces, without outliers, and returns the indices
    /// of the outliers in ascending order. The model has normal errors of the forces; the intervals
    /// are Student's. Pairs with a value that is not finite are ignored.
    ///
    /// The first line has the median slope of all pairs of forces, weighted by the difference of
    /// their displacements (L. A. Jaeckel, Ann. Math. Statist. 43, 1449 (1972)), so that many
    /// readings at rest do not count. Forces farther from the line than six standard deviations
    /// are excluded and the rest is fitted by least squares, until no further force is excluded.
    /// The deviation is from the median of their distances: the larger one of the median of all,
    /// and the median weighted by the displacement from the middle. Of fewer than eight forces,
    /// none is excluded.
    ///
    /// Errors of the displacements flatten the line by the ratio of their variance to the variance
    /// of the displacements.
    ///
    /// # Errors
    /// See [`StiffnessError`].
    ///
    /// # Panics
    /// If the numbers of forces and displacements differ.
    pub fn fit(displacements: &[f64], forces: &[f64]) -> Result<(Stiffness, Vec<usize>), StiffnessError> {
        assert_eq!(displacements.len(), forces.len(), "a force for each displacement");
        let pairs = displacements.iter().copied().zip(forces.iter().copied()).enumerate();
        let usable: Vec<(usize, (f64, f64))> =
            pairs.filter(|(_, (displacement, force))| displacement.is_finite() && force.is_finite()).collect();
        let points =
            |kept: &[(usize, (f64, f64))]| -> Vec<(f64, f64)> { kept.iter().map(|(_, point)| *point).collect() };
        if usable.len() < LEAST_FORCES {
            return least_squares(&points(&usable)).map(|fitted| (fitted, Vec::new()));
        }
        let mut kept = usable.clone();
        let Some(mut line) = median_line(&points(&usable)) else {
            return Err(least_squares(&points(&usable)).err().unwrap_or(StiffnessError::NoExtent));
        };
        for _ in 0..OUTLIER_ROUNDS {
            let limit = outlier_limit(&points(&usable), line);
            let found: Vec<(usize, (f64, f64))> =
                usable.iter().copied().filter(|(_, point)| distance(*point, line) <= limit).collect();
            let outliers = usable.len() - found.len();
            if outliers as f64 > MOST_OUTLIERS * usable.len() as f64 {
                return Err(StiffnessError::NoLine { outliers, forces: usable.len() });
            }
            let fitted = least_squares(&points(&found))?;
            let is_same = found.len() == kept.len() && line == (fitted.stiffness, fitted.force_at_rest);
            (line, kept) = ((fitted.stiffness, fitted.force_at_rest), found);
            if is_same {
                break;
            }
        }
        let fitted = least_squares(&points(&kept))?;
        // Without the outliers, the film must still move.
        if extent(&points(&kept)) < LEAST_SHARE * extent(&points(&usable)) {
            return Err(StiffnessError::NoLine { outliers: usable.len() - kept.len(), forces: usable.len() });
        }
        let outliers =
            usable.iter().map(|(index, _)| *index).filter(|index| kept.iter().all(|(other, _)| other != index));
        Ok((fitted, outliers.collect()))
    }
}

/// Number of standard deviations from the line beyond which a force is an outlier.
const OUTLIER: f64 = 6.0;

/// Least number of forces of which some can be outliers: five residuals have no reliable median.
const LEAST_FORCES: usize = 8;

/// The standard deviation of normal errors over the median of their magnitudes.
const DEVIATION_OVER_MEDIAN: f64 = 1.482_602_218_505_602;

/// Smallest limit of outliers, as a fraction of the largest force: load cells are hardly better, so
/// the round-off of exact forces has none.
const LEAST_LIMIT: f64 = 1e-3;

/// Least extent of the displacements without outliers, over the extent of all.
const LEAST_SHARE: f64 = 0.5;

/// Largest number of rounds that search and exclude outliers.
const OUTLIER_ROUNDS: usize = 20;

/// Largest share of outliers. Beyond it the forces do not belong to the displacements.
const MOST_OUTLIERS: f64 = 0.2;

/// Largest number of points of the first line.
const MOST_POINTS: usize = 1000;

fn distance((displacement, force): (f64, f64), (slope, intercept): (f64, f64)) -> f64 {
    (force - intercept - slope * displacement).abs()
}

/// The distance from a line beyond which a force is an outlier. Many readings at rest, where any
/// slope has the same force, do not narrow it, nor do a few readings that determine the slope.
fn outlier_limit(points: &[(f64, f64)], line: (f64, f64)) -> f64 {
    let middle = median(points.iter().map(|(displacement, _)| *displacement).collect());
    let distances = points.iter().map(|point| (distance(*point, line), (point.0 - middle).abs()));
    let largest = points.iter().fold(0.0_f64, |most, (_, force)| most.max(force.abs()));
    let distances: Vec<(f64, f64)> = distances.collect();
    let of_all = median(distances.iter().map(|(distance, _)| *distance).collect());
    let typical = weighted_median(distances).unwrap_or(0.0).max(of_all);
    (OUTLIER * DEVIATION_OVER_MEDIAN * typical).max(LEAST_LIMIT * largest)
}

fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The value below which half of the weight is. `None` without weight.
fn weighted_median(mut values: Vec<(f64, f64)>) -> Option<f64> {
    values.retain(|(_, weight)| *weight > 0.0);
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = 0.5 * values.iter().map(|(_, weight)| weight).sum::<f64>();
    let mut below = 0.0;
    let at_half = values.into_iter().find(|(_, weight)| {
        below += weight;
        below >= half
    });
    at_half.map(|(value, _)| value)
}

/// The difference of the largest and the smallest displacement.
fn extent(points: &[(f64, f64)]) -> f64 {
    let (least, most) =
        points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), (d, _)| (least.min(*d), most.max(*d)));
    most - least
}

/// Slope and intercept of the weighted median line. `None` for fewer than three points, or points
/// without extent.
fn median_line(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    if points.len() < 3 {
        return None;
    }
    let thinned: Vec<(f64, f64)> = points.iter().copied().step_by(points.len().div_ceil(MOST_POINTS)).collect();
    let pairs =
        thinned.iter().enumerate().flat_map(|(n, first)| thinned[n + 1..].iter().map(move |other| (first, other)));
    let slopes = pairs.map(|((d, f), (other, force))| ((force - f) / (other - d), (other - d).abs()));
    let slope = weighted_median(slopes.collect())?;
    Some((slope, median(thinned.iter().map(|(d, f)| f - slope * d).collect())))
}

/// The line of least squares.
fn least_squares(points: &[(f64, f64)]) -> Result<Stiffness, StiffnessError> {
    if points.len() < 3 {
        return Err(StiffnessError::TooFew);
    }
    let n = points.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / n;
    let (middle, mean_force) = (mean(|point| point.0), mean(|point| point.1));
    let spread: f64 = points.iter().map(|(d, _)| (d - middle).powi(2)).sum();
    let largest = points.iter().fold(0.0_f64, |most, (d, _)| most.max(d.abs()));
    if !((spread / n).sqrt() > LEAST_EXTENT * largest) {
        return Err(StiffnessError::NoExtent);
    }
    let products: f64 = points.iter().map(|(d, f)| (d - middle) * (f - mean_force)).sum();
    let stiffness = products / spread;
    let force_at_rest = mean_force - stiffness * middle;
    let squares: f64 = points.iter().map(|(d, f)| (f - force_at_rest - stiffness * d).powi(2)).sum();
    let residual = (squares / (n - 2.0)).sqrt();
    let student = StudentsT::new(0.0, 1.0, n - 2.0).expect("a positive number of degrees of freedom");
    let quantile = student.inverse_cdf(0.5 + 0.5 * CONFIDENCE);
    Ok(Stiffness {
        stiffness,
        force_at_rest,
        stiffness_95: quantile * residual / spread.sqrt(),
        force_at_rest_95: quantile * residual * (1.0 / n + middle * middle / spread).sqrt(),
        residual,
        forces: points.len(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The slope of these is 1.99 and the intercept 1.04, by hand; the quantile of Student at 0.975
    /// with three degrees of freedom is 3.182446 in every table.
    #[test]
    fn line_and_intervals_are_those_of_a_linear_model() {
        let line = Stiffness::fit(&[0.0, 1.0, 2.0, 3.0, 4.0], &[1.1, 2.9, 5.2, 6.8, 9.1]).unwrap().0;
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

    /// Three of twenty forces are wild, and two are missing: the line is the line of the others.
    #[test]
    fn wild_forces_are_excluded() {
        let displacements: Vec<f64> = (0..20).map(|n| 0.05 * f64::from(n)).collect();
        let noise = |n: usize| 0.01 * [0.3, -1.1, 0.8, 0.1, -0.4][n % 5];
        let clean: Vec<f64> = displacements.iter().enumerate().map(|(n, d)| 1.5 * d + 0.2 + noise(n)).collect();
        let mut forces = clean.clone();
        (forces[3], forces[11], forces[19]) = (40.0, -3.0, 0.0);
        (forces[5], forces[6]) = (f64::NAN, f64::NAN);
        let (line, outliers) = Stiffness::fit(&displacements, &forces).unwrap();
        assert_eq!((outliers, line.forces), (vec![3, 11, 19], 15));
        assert!(
            (line.stiffness - 1.5).abs() < line.stiffness_95
                && (line.force_at_rest - 0.2).abs() < line.force_at_rest_95
        );
        for n in [0, 4, 8, 15] {
            forces[n] = 30.0 + n as f64;
        }
        let refused = Stiffness::fit(&displacements, &forces);
        assert!(matches!(refused, Err(StiffnessError::NoLine { forces: 18, .. })), "{refused:?}");
    }

    /// An experiment moves the film along one axis after the other: along each, two thirds of the
    /// readings are at rest. The displacements have errors of a tenth, such as those of a closed
    /// form.
    #[test]
    fn readings_at_rest_do_not_count_as_the_line() {
        let at_rest = (0..40).map(|n| (0.02 * f64::from(n % 5 - 2), 0.0));
        let moved = (0..20).map(|n| {
            let d = 0.1 * f64::from(n - 10);
            (d - 0.1 * d * d.abs(), 2.0 * d)
        });
        let (displacements, forces): (Vec<f64>, Vec<f64>) = at_rest.chain(moved).unzip();
        let (line, outliers) = Stiffness::fit(&displacements, &forces).unwrap();
        assert!((line.stiffness - 2.0).abs() < 0.3 && outliers.is_empty(), "{line:?} {outliers:?}");
        // Exact readings have no outliers either.
        let exact: Vec<f64> = displacements.iter().map(|d| 1.5 * d).collect();
        let (line, outliers) = Stiffness::fit(&displacements, &exact).unwrap();
        assert!((line.stiffness - 1.5).abs() < 1e-12 && outliers.is_empty(), "{line:?}");
    }

    /// A film that moves along x and y, then three steps along this axis: the forces of the first
    /// readings are exact, and their displacements have the noise of the sensor.
    #[test]
    fn few_readings_that_move_do_not_exclude_the_others() {
        let noise = |n: usize| 0.003 * [0.5, 1.2, 0.9, -0.5, -0.8, 0.1, -0.6, 0.3, 0.25][n % 9];
        let mut displacements: Vec<f64> = (0..18).map(noise).collect();
        displacements.extend([-1.9987, -0.9997, -0.0002]);
        let forces = [[0.0; 18].as_slice(), &[-2.0 * 5.7, -5.7, 0.0]].concat();
        let (line, outliers) = Stiffness::fit(&displacements, &forces).unwrap();
        assert!(outliers.is_empty() && (line.stiffness / 5.7 - 1.0).abs() < 2e-3, "{line:?} {outliers:?}");
    }

    /// Two forces contradict the line of the others, and only their displacements are large: the
    /// others cover 0.425 of 1 mm, less than half.
    #[test]
    fn line_without_its_largest_displacements_is_refused() {
        let mut displacements: Vec<f64> = (0..18).map(|n| 0.025 * f64::from(n)).collect();
        let mut forces: Vec<f64> = displacements.iter().map(|d| 2.0 * d).collect();
        displacements.extend([1.0, 1.0]);
        forces.extend([-5.0, 9.0]);
        assert_eq!(Stiffness::fit(&displacements, &forces), Err(StiffnessError::NoLine { outliers: 2, forces: 20 }));
        // Over 0.51 of it, the forces are outliers.
        (displacements[17], forces[17]) = (0.51, 1.02);
        let (line, outliers) = Stiffness::fit(&displacements, &forces).unwrap();
        assert_eq!(outliers, [18, 19]);
        assert!((line.stiffness - 2.0).abs() < 1e-12, "{line:?}");
    }
}
