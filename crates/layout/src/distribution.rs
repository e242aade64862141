//! Distributions of errors.

use std::sync::Arc;

/// The distribution of an error: how far a quantity of a film that is made is from the one that was
/// ordered. The default is no error.
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
        match self {
            Distribution::Fixed(value) => Distribution::Fixed(factor * value),
            Distribution::Normal { deviation } => Distribution::Normal { deviation: factor * deviation },
            Distribution::Truncated { deviation, limit } => {
                Distribution::Truncated { deviation: factor * deviation, limit: factor * limit }
            }
            Distribution::Uniform { half_width } => Distribution::Uniform { half_width: factor * half_width },
            Distribution::Tabulated(values) => {
                Distribution::Tabulated(values.iter().map(|value| factor * value).collect())
            }
        }
    }
}
