//! Demands of the layout that the film found misses.

use thiserror::Error;

use crate::error::DesignError;

/// A demand of the layout that the film found misses.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum Shortfall {
    /// The best-fit amplitude is below its least value.
    #[error("amplitude {reached:.4}, must be at least {least}")]
    Amplitude {
        /// The amplitude reached.
        reached: f64,
        /// The least one.
        least: f64,
    },
    /// The film has too many distinct parts.
    #[error("{reached} distinct parts, must be at most {most}")]
    Parts {
        /// Number of its parts.
        reached: usize,
        /// The largest number.
        most: usize,
    },
    /// The errors of the films as made cannot be computed.
    #[error(
        "samples of the film {}: {}{error}",
        if *found { "found" } else { "before the search" },
        sample.map_or(String::new(), |sample| format!("number {sample}: "))
    )]
    Samples {
        /// Whether they are of the film found, not of the film before the search.
        found: bool,
        /// Number of the first sample without errors. `None` if all of them have none.
        sample: Option<u64>,
        /// Why.
        error: DesignError,
    },
}

/// A shortfall is serialized as its text.
impl serde::Serialize for Shortfall {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
