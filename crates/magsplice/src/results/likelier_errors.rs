//! Typical errors of every tile, which are likelier than many errors of single tiles.

use magsplice_layout::{FilmTolerance, Preset};
use magsplice_scan::{Diagnosis, MOST_ERRORS};

use crate::film_error::FilmError;

/// Most errors of single tiles that are reported without a doubt where no errors are expected. A
/// film with more faulty tiles is rarer than one whose tiles all have small errors.
pub(super) const MOST_SINGLE_ERRORS: usize = 3;

/// Typical errors of every tile that are tried instead.
const PRESETS: [Preset; 2] = [Preset::Workshop, Preset::ByHand];

/// The presets that explain a scan, with the number of errors of single tiles beyond each.
pub(super) struct LikelierErrors(Vec<(Preset, usize)>);

impl LikelierErrors {
    /// The presets up to the first that leaves one error at most. `diagnosed` is the diagnosis with
    /// these errors expected and at most so many errors of single tiles.
    pub(super) fn new(
        tiles: usize,
        diagnosed: impl Fn(FilmTolerance, usize) -> Result<Diagnosis, FilmError>,
    ) -> Result<LikelierErrors, FilmError> {
        let mut explaining = Vec::new();
        for preset in PRESETS {
            let found = diagnosed(FilmTolerance::of_tiles(&preset.errors(), tiles), MOST_ERRORS / 2)?;
            if found.is_complete && !found.is_residual_too_large() {
                explaining.push((preset, found.detected.len()));
            }
            if explaining.last().is_some_and(|(_, errors)| *errors <= 1) {
                break;
            }
        }
        Ok(LikelierErrors(explaining))
    }

    /// The first preset with less than half as many errors of single tiles.
    pub(super) fn simpler_than(&self, errors: usize) -> Option<Preset> {
        self.0.iter().find(|(_, left)| 2 * left < errors).map(|(preset, _)| *preset)
    }
}
