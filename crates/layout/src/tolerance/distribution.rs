//! Distributions of errors.

use std::sync::Arc;

/// The distribution of an error: the difference of a quantity of a film as made from the ordered
/// one. The default is no error.
///
/// Numbers have the unit of the quantity, as given by its name.
#[derive(Clone, Debug, PartialEq)]
pub enum Distribution {
    /// The same error in every sample.
    Fixed(f64),
    /// Normal errors of mean 0.
    Normal {
        /// Standard deviation.
        deviation: f64,
    },
    /// Normal errors of mean 0 that were sorted: none exceeds the limit.
    Truncated {
        /// Standard deviation before sorting.
        deviation: f64,
        /// The largest magnitude.
        limit: f64,
    },
    /// Errors of equal probability.
    Uniform {
        /// The largest magnitude.
        half_width: f64,
    },
    /// Errors that were measured, in ascending order. Quantiles between them are interpolated
    /// linearly, so that no error is beyond the least and the largest.
    Tabulated(Arc<[f64]>),
}

impl Default for Distribution {
    fn default() -> Distribution {
        Distribution::NONE
    }
}

impl Distribution {
    /// No error.
    pub const NONE: Distribution = Distribution::Fixed(0.0);

    /// Normal errors of mean 0; none if the deviation is 0.
    pub const fn normal(deviation: f64) -> Distribution {
        if deviation == 0.0 { Distribution::NONE } else { Distribution::Normal { deviation } }
    }

    /// Whether every error is 0.
    pub fn is_none(&self) -> bool {
        *self == Distribution::NONE
    }

    /// The distribution of the errors times a positive factor, such as of another unit.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Distribution {
        self.map(|value| factor * value)
    }

    /// The distribution with a function of each of its numbers.
    pub(crate) fn map(&self, f: impl Fn(f64) -> f64) -> Distribution {
        match self {
            Distribution::Fixed(value) => Distribution::Fixed(f(*value)),
            Distribution::Normal { deviation } => Distribution::Normal { deviation: f(*deviation) },
            Distribution::Truncated { deviation, limit } => {
                Distribution::Truncated { deviation: f(*deviation), limit: f(*limit) }
            }
            Distribution::Uniform { half_width } => Distribution::Uniform { half_width: f(*half_width) },
            Distribution::Tabulated(values) => Distribution::Tabulated(values.iter().map(|value| f(*value)).collect()),
        }
    }

    /// The largest magnitude of all errors, infinite for normal errors that were not sorted.
    pub(crate) fn bound(&self) -> f64 {
        match self {
            Distribution::Normal { .. } => f64::INFINITY,
            Distribution::Truncated { limit, .. } => *limit,
            _ => self.largest(),
        }
    }

    /// The largest magnitude that it states: of all errors, or their standard deviation.
    pub(crate) fn largest(&self) -> f64 {
        match self {
            Distribution::Fixed(value) => value.abs(),
            Distribution::Normal { deviation } | Distribution::Truncated { deviation, .. } => *deviation,
            Distribution::Uniform { half_width } => *half_width,
            Distribution::Tabulated(values) => values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs())),
        }
    }

    /// Without another form where no error is left.
    pub(crate) fn simplified(self) -> Distribution {
        let is_none = match self {
            Distribution::Truncated { deviation, limit } => deviation == 0.0 || limit == 0.0,
            _ => self.largest() == 0.0,
        };
        if is_none { Distribution::NONE } else { self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distributions_without_errors_are_none() {
        for none in [
            Distribution::Fixed(-0.0),
            Distribution::Uniform { half_width: 0.0 },
            Distribution::Truncated { deviation: 0.0, limit: 1.0 },
            Distribution::Truncated { deviation: 1.0, limit: 0.0 },
            Distribution::Tabulated([0.0, 0.0].into()),
        ] {
            assert!(none.clone().simplified().is_none(), "{none:?}");
        }
        let kept = Distribution::Tabulated([-1.0, 2.0].into());
        assert_eq!((kept.clone().simplified(), kept.largest()), (kept, 2.0));
    }
}
