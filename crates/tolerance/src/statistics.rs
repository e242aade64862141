//! Mean, percentiles and shares of samples, with confidence intervals.

use statrs::function::beta::beta_reg;

/// Half the width of the 95 % interval of a normal distribution, in standard deviations.
pub(crate) const NORMAL_95: f64 = 1.959_963_984_540_054;

/// A value estimated from samples.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Estimate {
    /// The estimate.
    pub value: f64,
    /// Ends of an interval that contains the true value with a probability of 95 %. An end is
    /// infinite where there are too few samples.
    pub interval: [f64; 2],
}

/// Mean and percentiles of samples.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Statistics {
    /// Number of samples.
    pub count: usize,
    /// Mean.
    pub mean: Estimate,
    /// 1st percentile.
    pub p1: Estimate,
    /// 5th percentile.
    pub p5: Estimate,
    /// Median.
    pub p50: Estimate,
    /// 95th percentile.
    pub p95: Estimate,
    /// 99th percentile.
    pub p99: Estimate,
}

impl Statistics {
    /// Number of samples from which on both ends of the intervals of the 5th and the 95th
    /// percentile are finite.
    pub const SAMPLES_OF_P95: usize = 110;

    /// Statistics of samples, which must be numbers. `None` without samples.
    ///
    /// The interval of the mean assumes normal errors. The interval of a percentile lies between
    /// two order statistics and assumes no distribution: of n independent samples, n q +- 1.96 (n q
    /// (1 - q))^1/2 are below the percentile q, by the normal approximation of the binomial
    /// distribution.
    pub fn new(samples: impl IntoIterator<Item = f64>) -> Option<Statistics> {
        let mut sorted: Vec<f64> = samples.into_iter().collect();
        let count = sorted.len();
        let n = count as f64;
        sorted.sort_by(f64::total_cmp);
        let mean = sorted.iter().sum::<f64>() / n;
        let variance = sorted.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
        let half = if count > 1 { NORMAL_95 * (variance / n).sqrt() } else { f64::INFINITY };
        let [p1, p5, p50, p95, p99] = [0.01, 0.05, 0.5, 0.95, 0.99].map(|share| percentile(&sorted, share));
        let mean = Estimate { value: mean, interval: [mean - half, mean + half] };
        Some(Statistics { count, mean, p1: p1?, p5: p5?, p50: p50?, p95: p95?, p99: p99? })
    }
}

/// The share of films with a property, estimated from samples.
///
/// The interval is Wilson's: all shares whose normal approximation does not exclude the number
/// found. `None` without samples.
pub fn share(found: usize, samples: usize) -> Option<Estimate> {
    if samples == 0 {
        return None;
    }
    let n = samples as f64;
    let (value, square) = (found as f64 / n, NORMAL_95 * NORMAL_95);
    let centre = (value + 0.5 * square / n) / (1.0 + square / n);
    let half = NORMAL_95 / (1.0 + square / n) * (value * (1.0 - value) / n + 0.25 * square / (n * n)).sqrt();
    Some(Estimate { value, interval: [(centre - half).max(0.0), (centre + half).min(1.0)] })
}

/// The probability that at least `found` of `samples` independent samples have a property that this
/// share of all films has: the tail of the binomial distribution. A share is excluded with a
/// confidence c if the probability is below 1 - c.
///
/// # Panics
/// If the share is not between 0 and 1.
pub fn probability_of_at_least(found: usize, samples: usize, share: f64) -> f64 {
    match found {
        0 => 1.0,
        _ if found > samples => 0.0,
        _ if share == 0.0 || share == 1.0 => share,
        // The tail is a regularized incomplete beta function.
        _ => beta_reg(found as f64, (samples - found + 1) as f64, share),
    }
}

/// The value below which a share of the sorted samples lies, by linear interpolation between them.
fn percentile(sorted: &[f64], share: f64) -> Option<Estimate> {
    let last = sorted.len().checked_sub(1)?;
    let place = share * last as f64;
    let below = place.floor() as usize;
    let value = sorted[below] + (place - place.floor()) * (sorted[(below + 1).min(last)] - sorted[below]);
    let n = sorted.len() as f64;
    let spread = NORMAL_95 * (n * share * (1.0 - share)).sqrt();
    // One-based ranks of the order statistics.
    let (low, high) = ((n * share - spread).floor(), (n * share + spread).ceil() + 1.0);
    let low = if low < 1.0 { f64::NEG_INFINITY } else { sorted[low as usize - 1] };
    let high = if high > n { f64::INFINITY } else { sorted[high as usize - 1] };
    Some(Estimate { value, interval: [low, high] })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantile::quantile;
    use magsplice_layout::Distribution;
    use rand::{Rng, SeedableRng};

    #[test]
    fn percentiles_are_interpolated_between_samples() {
        let found = Statistics::new((0..=100).rev().map(f64::from)).expect("samples");
        assert_eq!([found.mean.value, found.p50.value, found.p95.value, found.p99.value], [50.0, 50.0, 95.0, 99.0]);
        // Ranks 50.5 -+ 9.85, rounded outwards; 95.95 + 4.3 and one more is beyond the last.
        assert_eq!(found.p50.interval, [39.0, 61.0]);
        assert_eq!(found.p99.interval[1], f64::INFINITY);
        let finite = |count: usize| {
            let found = Statistics::new((0..count).map(|n| n as f64)).expect("samples");
            [found.p5, found.p95].iter().all(|shown| shown.interval.iter().all(|end| end.is_finite()))
        };
        assert!((Statistics::SAMPLES_OF_P95..2000).all(finite) && !finite(Statistics::SAMPLES_OF_P95 - 1));
        // The standard deviation of 0 and 2 is 2^1/2, and of their mean 1.
        let two = Statistics::new([2.0, 0.0]).expect("two");
        assert_eq!((two.count, two.mean), (2, Estimate { value: 1.0, interval: [1.0 - NORMAL_95, 1.0 + NORMAL_95] }));
        assert_eq!([two.p1.value, two.p5.value], [0.02, 0.1]);
        assert!(Statistics::new([]).is_none());
        assert_eq!(Statistics::new([2.0]).expect("one").mean.interval, [f64::NEG_INFINITY, f64::INFINITY]);
    }

    /// Known values: Wilson's interval of 8 of 10 is 0.4901 to 0.9433; of ten throws of a coin, at
    /// least eight are heads in 56 of 1024 cases.
    #[test]
    fn shares_have_the_known_intervals_and_tails() {
        let [low, high] = share(8, 10).expect("samples").interval;
        assert!((low - 0.4901).abs() < 1e-4 && (high - 0.9433).abs() < 1e-4, "{low} {high}");
        assert_eq!(share(0, 0), None);
        assert!(share(0, 5).expect("samples").interval[0] == 0.0 && share(5, 5).expect("samples").interval[1] == 1.0);
        assert!((probability_of_at_least(8, 10, 0.5) - 56.0 / 1024.0).abs() < 1e-12);
        assert_eq!(probability_of_at_least(0, 10, 0.05), 1.0);
        assert!((probability_of_at_least(10, 10, 0.9) - 0.9_f64.powi(10)).abs() < 1e-12);
        assert_eq!(
            [(11, 0.5), (3, 0.0), (3, 1.0)].map(|(found, share)| probability_of_at_least(found, 10, share)),
            [0.0, 0.0, 1.0]
        );
    }

    /// Of 1000 intervals of 95 %, 950 contain the true value, with a standard deviation of 7.
    /// Intervals of percentiles are rounded outwards and contain it more often.
    #[test]
    fn intervals_contain_the_true_value_as_often_as_stated() {
        let (mut mean, mut p50, mut p95) = (0, 0, 0);
        for trial in 0..1000 {
            let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(trial);
            let normal = Distribution::normal(1.0);
            let samples: Vec<f64> = (0..480).map(|_| quantile(&normal, random.random_range(1e-9..1.0))).collect();
            let found = Statistics::new(samples).expect("samples");
            let contains = |estimate: Estimate, value: f64| {
                usize::from(estimate.interval[0] <= value && value <= estimate.interval[1])
            };
            mean += contains(found.mean, 0.0);
            p50 += contains(found.p50, 0.0);
            p95 += contains(found.p95, 1.644_853_626_951_472);
        }
        for (count, most) in [(mean, 978), (p50, 990), (p95, 990)] {
            assert!((922..=most).contains(&count), "{count} of 1000");
        }
    }
}
