//! The model against exact samples.
//!
//! Both use the same random numbers. Their difference varies far less than either, so a few hundred
//! samples show a bias much smaller than the standard error of their mean.

use std::ops::Range;

use rayon::prelude::*;

use super::displacement::displacement_errors_mm;
use super::model::FirstOrder;
use crate::evaluation_grid::SampleError;
use crate::low_rank::{add, dot};
use crate::sampler::Sampler;
use crate::statistics::{Estimate, NORMAL_95};

/// Largest relative error of a valid model.
const ALLOWED: f64 = 0.05;

/// Samples that are evaluated in parallel before they are added up. It bounds the memory.
const SAMPLES_AT_ONCE: u64 = 64;

/// Agreement of exact samples with the model.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct FirstOrderCheck {
    /// Number of samples.
    pub samples: u64,
    /// The displacement errors along x, y, z.
    pub axes: [AxisCheck; 3],
}

/// Agreement of the displacement errors along one axis with the model.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct AxisCheck {
    /// Mean square of the displacement error of the exact samples over the volume, in mm^2.
    pub sampled_mm2: f64,
    /// The expected mean square of exact samples divided by the one of the model. `None` if the
    /// model has no error at all.
    pub mean_square_ratio: Option<Estimate>,
    /// The variance of the displacement error of exact samples, averaged over the points, divided
    /// by the one of the model. `None` if nothing varies in the model.
    pub variance_ratio: Option<Estimate>,
}

impl AxisCheck {
    /// Whether the mean square agrees with the model within 5 %, with all of its interval.
    pub fn mean_square_is_valid(&self) -> bool {
        agrees(self.mean_square_ratio)
    }

    /// Whether the variance agrees with the model within 5 %, with all of its interval.
    pub fn variance_is_valid(&self) -> bool {
        agrees(self.variance_ratio)
    }

    /// Whether both agree.
    pub fn is_valid(&self) -> bool {
        self.mean_square_is_valid() && self.variance_is_valid()
    }
}

fn agrees(ratio: Option<Estimate>) -> bool {
    ratio.is_none_or(|ratio| ratio.interval.iter().all(|end| (end - 1.0).abs() <= ALLOWED))
}

impl FirstOrderCheck {
    /// Whether the model is valid along all axes.
    pub fn is_valid(&self) -> bool {
        self.axes.iter().all(AxisCheck::is_valid)
    }
}

/// Sums over samples along one axis, each already averaged over the points.
#[derive(Clone, Copy, Default)]
struct Sums {
    /// Squares of exact errors.
    exact: Moments,
    /// Differences of the squares of exact and of linear errors.
    squares: Moments,
    /// Differences of the squares of their deviations from the mean of the model.
    about_mean: Moments,
    /// Squares of the differences of exact and linear errors.
    differences: f64,
}

/// Sums of numbers and of their squares.
#[derive(Clone, Copy, Default)]
struct Moments {
    sum: f64,
    squares: f64,
}

impl Moments {
    fn add(&mut self, value: f64) {
        self.sum += value;
        self.squares += value * value;
    }

    /// Mean, and standard deviation of one value.
    fn mean_and_deviation(&self, count: f64) -> (f64, f64) {
        let mean = self.sum / count;
        (mean, ((self.squares / count - mean * mean).max(0.0) * count / (count - 1.0)).sqrt())
    }
}

impl FirstOrder {
    /// Compares the model with exact samples of the same film and volume. 200 samples suffice for
    /// errors of a usual workshop. The result does not depend on the number of threads.
    /// `progress` is called, from any thread, when a sample begins.
    ///
    /// # Errors
    /// The first sample whose errors cannot be computed, by its number, and the reason.
    ///
    /// # Panics
    /// If there are fewer than two samples, or the sampler has other points.
    pub fn check(
        &self,
        sampler: &Sampler,
        samples: Range<u64>,
        progress: impl Fn() + Sync,
    ) -> Result<FirstOrderCheck, (u64, SampleError)> {
        let count = samples.end.saturating_sub(samples.start);
        assert!(count >= 2, "at least two samples");
        assert_eq!(sampler.points().len(), self.points + 1, "a sampler of the same volume");
        let mut sums = [Sums::default(); 3];
        // Sums of the differences of exact and linear errors at each point.
        let mut bias_mm = vec![0.0; 3 * self.points];
        for first in samples.clone().step_by(SAMPLES_AT_ONCE as usize) {
            let next = samples.end.min(first.saturating_add(SAMPLES_AT_ONCE));
            let exact = |sample| {
                progress();
                let read_t = sampler.readings_of_t(sample)?;
                displacement_errors_mm(sampler.points(), &read_t, &self.ideal)
            };
            let pair = |sample| match exact(sample) {
                Ok(exact_mm) => Ok((exact_mm, self.linear_sample_mm(sampler.seed(), sample))),
                Err(error) => Err((sample, error)),
            };
            let pairs: Vec<_> = (first..next).into_par_iter().map(pair).collect();
            for pair in pairs {
                let (exact_mm, linear_mm) = pair?;
                self.add_pair(&exact_mm, &linear_mm, &mut sums, &mut bias_mm);
            }
        }
        let axis_check = |axis: usize| self.axis_check(axis, &sums[axis], self.along(&bias_mm, axis), count as f64);
        Ok(FirstOrderCheck { samples: count, axes: [0, 1, 2].map(axis_check) })
    }

    fn add_pair(&self, exact_mm: &[f64], linear_mm: &[f64], sums: &mut [Sums; 3], bias_mm: &mut [f64]) {
        let count = self.points as f64;
        add(bias_mm, 1.0, exact_mm);
        add(bias_mm, -1.0, linear_mm);
        for (axis, sums) in sums.iter_mut().enumerate() {
            let (exact, linear) = (self.along(exact_mm, axis), self.along(linear_mm, axis));
            let mean = self.along(&self.mean_mm, axis);
            let (mut squares, mut about_mean) = (0.0, 0.0);
            sums.exact.add(dot(exact, exact) / count);
            for ((exact, linear), mean) in exact.iter().zip(linear).zip(mean) {
                let difference = exact - linear;
                // Products of sum and difference, which do not cancel.
                squares += difference * (exact + linear);
                about_mean += difference * (exact + linear - 2.0 * mean);
                sums.differences += difference * difference / count;
            }
            sums.squares.add(squares / count);
            sums.about_mean.add(about_mean / count);
        }
    }

    fn axis_check(&self, axis: usize, sums: &Sums, bias_mm: &[f64], count: f64) -> AxisCheck {
        let errors = self.axis_errors(axis);
        let ratio = |difference: f64, half: f64, of: f64| {
            let [value, half] = [1.0 + difference / of, half / of];
            // No ratio of squares is below 0, but an estimate by differences may be.
            let interval = [value - half, value + half].map(|end| end.max(0.0));
            (of > 0.0).then_some(Estimate { value: value.max(0.0), interval })
        };
        let per_root = NORMAL_95 / count.sqrt();
        let (exact_mm2, deviation_of_exact) = sums.exact.mean_and_deviation(count);
        let (mean, deviation) = sums.squares.mean_and_deviation(count);
        // Where the model is far off, its samples say nothing about exact ones, which are then
        // the better estimate alone.
        let mean_square_ratio = if deviation <= deviation_of_exact {
            ratio(mean, per_root * deviation, errors.expected_mm2)
        } else {
            ratio(exact_mm2 - errors.expected_mm2, per_root * deviation_of_exact, errors.expected_mm2)
        };
        // The variance is the mean square about the mean of the model, less the square of the bias
        // of this mean. The square of an estimated bias is too large by its own variance.
        let (mean, deviation) = sums.about_mean.mean_and_deviation(count);
        let found_bias = dot(bias_mm, bias_mm) / (count * count * self.points as f64);
        let scatter = (sums.differences / count - found_bias).max(0.0) / (count - 1.0);
        let bias = (found_bias - scatter).max(0.0);
        // At most, as if each sample had its difference along the bias.
        let bias_deviation = 2.0 * (bias * scatter * count).sqrt();
        let variance_ratio = ratio(mean - bias, per_root * (deviation + bias_deviation), errors.variance_mm2);
        AxisCheck { sampled_mm2: exact_mm2, mean_square_ratio, variance_ratio }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1, 2, 3, 4 have the mean 5 / 2 and the variance 5 / 3, estimated from four numbers.
    #[test]
    fn moments_are_mean_and_deviation_of_a_sample() {
        let mut moments = Moments::default();
        (1..=4).for_each(|n| moments.add(f64::from(n)));
        let (mean, deviation) = moments.mean_and_deviation(4.0);
        assert!(mean == 2.5 && (deviation - (5.0_f64 / 3.0).sqrt()).abs() < 1e-15, "{mean} {deviation}");
    }

    /// The ends of the interval count, each alone, and so do both ratios of all axes.
    #[test]
    fn ratios_agree_within_five_percent() {
        let estimate = |low: f64, high: f64| Some(Estimate { value: 1.0, interval: [low, high] });
        let axis =
            |mean_square_ratio, variance_ratio| AxisCheck { sampled_mm2: 1.0, mean_square_ratio, variance_ratio };
        let good = estimate(0.96, 1.04);
        assert!(axis(good, good).is_valid() && axis(None, None).is_valid());
        for bad in [estimate(0.94, 1.0), estimate(1.0, 1.06), estimate(0.5, 0.6)] {
            assert!(!axis(bad, good).mean_square_is_valid() && axis(bad, good).variance_is_valid());
            assert!(!axis(good, bad).variance_is_valid() && axis(good, bad).mean_square_is_valid());
            assert!(!axis(bad, good).is_valid() && !axis(good, bad).is_valid());
            let check = |last| FirstOrderCheck { samples: 2, axes: [axis(good, good), axis(good, good), last] };
            assert!(check(axis(good, good)).is_valid() && !check(axis(good, bad)).is_valid());
        }
    }
}
