//! A hash of everything that determines the samples of films as made.

use serde::Serialize;
use sha2::{Digest, Sha256};

use crate::layout::Layout;
use crate::plane::PlaneTable;
use crate::tolerance::table::ToleranceTable;
use crate::volume::VolumeTable;

/// The values that determine every sample together with its seed, in the units of the file. Tiles
/// stand for themselves: their names do not count.
#[derive(Serialize)]
struct SampleInputs<'a, S> {
    /// Position, size, polarization and rotation of each tile.
    tiles: Vec<TileNumbers>,
    /// Permeabilities along and across, and the error of what recoil changes.
    recoil: Option<(Vec<[f64; 2]>, f64)>,
    errors: Option<ToleranceTable>,
    /// The tiles of the neighbour, of which the table has the path only.
    neighbour: Vec<TileNumbers>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    planes: Vec<PlaneTable>,
    volume: Option<VolumeTable>,
    /// Wavelength, thickness and amplitude of the ideal film.
    ideal: Option<[f64; 3]>,
    settings: &'a S,
}

type TileNumbers = ([f64; 3], [f64; 3], [f64; 3], [f64; 4]);

impl Layout {
    /// SHA-256, in lower-case hexadecimal, of everything that determines the samples of films as
    /// made except their seed: the tiles without their names, their permeabilities and errors, the
    /// working volume, the ideal film, and `settings`, such as how tiles are sorted.
    ///
    /// The hash is of JSON with the keys and units of layout files, so that it does not depend on
    /// the version of the compiler.
    ///
    /// # Panics
    /// If `settings` cannot be serialized as JSON.
    ///
    /// # Example
    /// ```
    /// use magsplice_layout::{COMMENTED_LAYOUT, Layout};
    ///
    /// let layout = Layout::parse(COMMENTED_LAYOUT, "commented")?;
    /// let again = Layout::parse(&layout.to_toml(), "plain form")?;
    /// assert_eq!(layout.sample_fingerprint(&()), again.sample_fingerprint(&()));
    /// assert_ne!(layout.sample_fingerprint(&()), layout.sample_fingerprint(&"sorted"));
    /// # Ok::<(), magsplice_layout::LayoutError>(())
    /// ```
    pub fn sample_fingerprint(&self, settings: &impl Serialize) -> String {
        let numbers = |tile: &magsplice_magnet::Tile| {
            let [position, size, polarization] = [tile.position(), tile.size(), tile.polarization_t()];
            (position.to_array(), size.to_array(), polarization.to_array(), tile.rotation().to_array())
        };
        let names: Vec<String> = (0..self.tiles.len()).map(|index| index.to_string()).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let tolerance = self.tolerance.as_ref();
        let errors = tolerance.map(|tolerance| ToleranceTable::of(tolerance, &names).without_samples());
        let neighbour = tolerance.and_then(|tolerance| tolerance.common.neighbour.as_ref());
        let permeabilities = || self.permeabilities().iter().map(|mu| [mu.along(), mu.across()]).collect();
        let inputs = SampleInputs {
            tiles: self.tiles.iter().map(|named| numbers(&named.tile)).collect(),
            recoil: self.has_recoil().then(|| (permeabilities(), self.material.recoil_error)),
            errors,
            neighbour: neighbour.iter().flat_map(|neighbour| neighbour.tiles.iter().map(numbers)).collect(),
            planes: self.iron.planes().iter().map(Into::into).collect(),
            volume: self.volume.as_ref().map(Into::into),
            ideal: self.ideal.map(|film| [film.wavelength(), film.thickness(), film.amplitude_t()]),
            settings,
        };
        sha256(&serde_json::to_vec(&inputs).expect("numbers and texts can be written as JSON"))
    }
}

/// SHA-256 in lower-case hexadecimal.
pub(crate) fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}
