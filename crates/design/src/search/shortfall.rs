//! Demands of the layout that the film found misses.

use std::fmt;

use crate::error::DesignError;

/// A demand of the layout that the film found misses.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Shortfall {
    /// The best-fit amplitude is below its least value.
    Amplitude {
        /// The amplitude reached.
        reached: f64,
        /// The least one.
        least: f64,
    },
    /// The film has too many distinct parts.
    Parts {
        /// Number of its parts.
        reached: usize,
        /// The largest number.
        most: usize,
    },
    /// The films that are made have no errors.
    Samples {
        /// Whether they are of the film found, not of the film before the search.
        found: bool,
        /// Number of the first sample without errors. `None` if all of them have none.
        sample: Option<u64>,
        /// Why.
        error: DesignError,
    },
}

impl fmt::Display for Shortfall {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Shortfall::Amplitude { reached, least } => write!(f, "amplitude {reached:.4}, must be at least {least}"),
            Shortfall::Parts { reached, most } => write!(f, "{reached} distinct parts, must be at most {most}"),
            Shortfall::Samples { found, sample, error } => {
                write!(f, "samples of the film {}: ", if *found { "found" } else { "before the search" })?;
                if let Some(sample) = sample {
                    write!(f, "number {sample}: ")?;
                }
                error.fmt(f)
            }
        }
    }
}

/// A shortfall is serialized as its text.
#[cfg(feature = "serde")]
impl serde::Serialize for Shortfall {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
