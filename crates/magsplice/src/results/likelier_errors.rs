//! Typical errors of every tile, which are likelier than many errors of single tiles.

use magsplice_layout::{FilmTolerance, Preset, TileErrors};
use magsplice_scan::Diagnosis;
use magsplice_tolerance::mean_square;

use crate::film_error::FilmError;

/// Most errors of single tiles that are reported without a doubt where no errors are expected. A
/// film with more faulty tiles is rarer than one whose tiles all have small errors.
pub(super) const MOST_SINGLE_ERRORS: usize = 3;

/// Typical errors of every tile that are tried instead.
const PRESETS: [Preset; 3] = [Preset::Workshop, Preset::Jig, Preset::ByHand];

/// The first preset that explains a scan with less than half as many errors of single tiles, among
/// those with a larger error than `expected`. `diagnosed` is the diagnosis with these errors
/// expected and at most so many errors of single tiles.
pub(super) fn likelier_preset(
    tiles: usize,
    expected: &FilmTolerance,
    errors: usize,
    diagnosed: impl Fn(FilmTolerance, usize) -> Result<Diagnosis, FilmError>,
) -> Result<Option<Preset>, FilmError> {
    let most_errors = errors.saturating_sub(1) / 2;
    for preset in PRESETS.into_iter().filter(|preset| is_larger(&preset.errors(), expected)) {
        let found = diagnosed(FilmTolerance::of_tiles(&preset.errors(), tiles), most_errors)?;
        if found.is_complete && !found.is_residual_too_large() {
            return Ok(Some(preset));
        }
    }
    Ok(None)
}

/// Whether an error is larger than that of every tile.
fn is_larger(errors: &TileErrors, expected: &FilmTolerance) -> bool {
    errors.iter().any(|(error, of)| expected.tiles.iter().all(|tile| mean_square(of) > mean_square(&tile[error])))
}
