//! Quantiles, means and variances of distributions of errors.

use std::f64::consts::{PI, SQRT_2};

use magsplice_layout::Distribution;
use statrs::function::erf::{erfc, erfc_inv};

/// The value below which a share `u` of the errors lies, 0 < u < 1. It turns a uniform deviate into
/// an error of this distribution.
pub(crate) fn quantile(distribution: &Distribution, u: f64) -> f64 {
    match distribution {
        Distribution::Fixed(value) => *value,
        Distribution::Normal { deviation } => deviation * normal_quantile(u),
        Distribution::Truncated { deviation, limit } => {
            let below = normal_share_below(-limit / deviation);
            (deviation * normal_quantile(below + u * (1.0 - 2.0 * below))).clamp(-limit, *limit)
        }
        Distribution::Uniform { half_width } => half_width * (2.0 * u - 1.0),
        Distribution::Tabulated(values) => {
            let last = values.len() - 1;
            let place = u * last as f64;
            let below = (place as usize).min(last.saturating_sub(1));
            values[below] + (place - below as f64) * (values[last.min(below + 1)] - values[below])
        }
    }
}

/// The mean of an error.
pub(crate) fn mean(distribution: &Distribution) -> f64 {
    match distribution {
        Distribution::Fixed(value) => *value,
        Distribution::Normal { .. } | Distribution::Truncated { .. } | Distribution::Uniform { .. } => 0.0,
        Distribution::Tabulated(values) => of_pieces(values, |a, b| 0.5 * (a + b)),
    }
}

/// The mean of the square of an error.
pub fn mean_square(distribution: &Distribution) -> f64 {
    variance(distribution) + mean(distribution).powi(2)
}

/// The variance of an error.
pub(crate) fn variance(distribution: &Distribution) -> f64 {
    match distribution {
        Distribution::Fixed(_) => 0.0,
        Distribution::Normal { deviation } => deviation * deviation,
        Distribution::Truncated { deviation, limit } => {
            let a = limit / deviation;
            let density = (-0.5 * a * a).exp() / (2.0 * PI).sqrt();
            deviation * deviation * (1.0 - 2.0 * a * density / (1.0 - 2.0 * normal_share_below(-a)))
        }
        Distribution::Uniform { half_width } => half_width * half_width / 3.0,
        Distribution::Tabulated(values) => {
            let mean = mean(distribution);
            of_pieces(values, |a, b| ((a - mean).powi(2) + (a - mean) * (b - mean) + (b - mean).powi(2)) / 3.0)
        }
    }
}

/// Three errors with weights. Their mean and variance are those of the distribution, and all
/// moments up to the fifth if it is normal (Gauss and Hermite). An error that does not vary is one.
pub fn nodes(distribution: &Distribution) -> Vec<(f64, f64)> {
    let (mean, apart) = (mean(distribution), (3.0 * variance(distribution)).sqrt());
    match apart > 0.0 {
        true => vec![(mean - apart, 1.0 / 6.0), (mean, 2.0 / 3.0), (mean + apart, 1.0 / 6.0)],
        false => vec![(mean, 1.0)],
    }
}

/// The mean over the pieces between tabulated values, each as probable as the others.
fn of_pieces(values: &[f64], of_piece: impl Fn(f64, f64) -> f64) -> f64 {
    match values {
        [value] => of_piece(*value, *value),
        _ => values.windows(2).map(|ends| of_piece(ends[0], ends[1])).sum::<f64>() / (values.len() - 1) as f64,
    }
}

/// The quantile of the normal distribution of mean 0 and deviation 1.
fn normal_quantile(u: f64) -> f64 {
    -SQRT_2 * erfc_inv(2.0 * u)
}

/// The share of normal errors of deviation 1 below x.
fn normal_share_below(x: f64) -> f64 {
    0.5 * erfc(-x / SQRT_2)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn distributions() -> [Distribution; 6] {
        [
            Distribution::Fixed(0.3),
            Distribution::Normal { deviation: 0.2 },
            Distribution::Truncated { deviation: 0.2, limit: 0.25 },
            Distribution::Uniform { half_width: 0.4 },
            Distribution::Tabulated([-0.3, -0.1, 0.0, 0.5].into()),
            Distribution::Tabulated([0.1].into()),
        ]
    }

    /// Mean and variance are the integrals of the quantile and its square. The midpoint rule of n
    /// points is right to the range of the quantile over n: 4.2 deviations at most for these.
    #[test]
    fn moments_are_those_of_the_quantiles() {
        let n = 20_000;
        for distribution in distributions() {
            let values = (0..n).map(|i| quantile(&distribution, (f64::from(i) + 0.5) / f64::from(n)));
            let (sum, squares) = values.fold((0.0, 0.0), |(sum, squares), x| (sum + x, squares + x * x));
            let (found_mean, found_square) = (sum / f64::from(n), squares / f64::from(n));
            assert!((found_mean - mean(&distribution)).abs() < 1e-4, "{distribution:?}: mean {found_mean}");
            let square = mean_square(&distribution);
            assert!((found_square - square).abs() < 1e-4, "{distribution:?}: square {found_square}, not {square}");
        }
    }

    /// The library's functions erfc and its inverse undo each other to 1e-10.
    #[test]
    fn quantiles_are_known_and_within_their_limits() {
        let normal = Distribution::Normal { deviation: 2.0 };
        assert!((quantile(&normal, 0.975) - 2.0 * 1.959_963_984_540_054).abs() < 1e-13);
        assert!((quantile(&normal, 1e-10) + 2.0 * 6.361_340_902_404_056).abs() < 1e-12);
        let [_, _, truncated, uniform, tabulated, _] = distributions();
        let tiny = f64::EPSILON / 4.0;
        for (distribution, ends) in [(truncated, [-0.25_f64, 0.25]), (uniform, [-0.4, 0.4]), (tabulated, [-0.3, 0.5])] {
            let found = [quantile(&distribution, tiny), quantile(&distribution, 1.0 - 2.0 * tiny)];
            for (found, end) in found.into_iter().zip(ends) {
                assert!(
                    found.abs() <= end.abs() && (found - end).abs() < 1e-10,
                    "{distribution:?}: {found}, not {end}"
                );
            }
        }
    }
}
