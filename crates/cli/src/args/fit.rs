//! Parameters of a scan that can be fitted.

use clap::ValueEnum;
use magsplice::scan::FreeParameters;

#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(crate) enum FitArg {
    /// All of them
    All,
    /// Strength of all tiles, relative to the layout
    Strength,
    /// Offset of the sensor and uniform stray field together
    Offset,
    /// Rotation of the sensor
    Rotation,
    /// Position of the sensor where the scan has its origin
    Start,
}

impl FitArg {
    /// The parameters of a list.
    pub(crate) fn free(fitted: &[FitArg]) -> FreeParameters {
        let is_free = |what: FitArg| fitted.contains(&what) || fitted.contains(&FitArg::All);
        FreeParameters {
            strength: is_free(FitArg::Strength),
            offset: is_free(FitArg::Offset),
            rotation: is_free(FitArg::Rotation),
            start: is_free(FitArg::Start),
        }
    }
}
