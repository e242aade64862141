//! Demands of the layout that the film found misses.

use magsplice_decouple::Figure;
use magsplice_magnet::Axis;
use thiserror::Error;

use crate::error::DesignError;
use crate::tolerances::LARGEST_SHARE_OF_TRAVEL;

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
    /// The error of the displacement is too large a part of the travel of the sensor.
    #[error(
        "{}: {error_mm:.3} mm, {:.0} % of the travel of {travel_mm} mm along {axis}, must be at most {:.0} %",
        in_words(*figure), 100.0 * error_mm / travel_mm, 100.0 * LARGEST_SHARE_OF_TRAVEL
    )]
    Travel {
        /// The figure that is too large.
        figure: Figure,
        /// The axis of the displacement.
        axis: Axis,
        /// The figure as a displacement, in millimetres.
        error_mm: f64,
        /// Extent of the working volume along the axis, in millimetres.
        travel_mm: f64,
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

fn in_words(figure: Figure) -> &'static str {
    match figure {
        Figure::Uniformity(_) => "uniformity RMSE as a displacement",
        _ => "RMSE of displacement",
    }
}

/// A shortfall is serialized as its text.
impl serde::Serialize for Shortfall {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
