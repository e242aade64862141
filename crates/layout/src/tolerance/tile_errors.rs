//! The keys of errors of tiles, in every table that has them, and the errors of each tile.

use std::slice;

use indexmap::IndexMap;
use magsplice_magnet::PerTileError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error_unit::ErrorUnit;
use crate::names::shown;
use crate::plausible::short;
use crate::tolerance::TileErrors;
use crate::tolerance::distribution::Distribution;
use crate::tolerance::tabulated::ErrorTable;
use crate::tolerance::written::{Components, DistributionKey, ErrorKey};

/// Errors of tiles, or of groups of tiles.
#[derive(Default, Deserialize, JsonSchema, Serialize)]
#[serde(default)]
pub(crate) struct ErrorKeys {
    /// Errors of the centre along x, y, z, in mm: one for all axes, or three. A group is shifted as
    /// a whole.
    position_mm: Components<3>,
    /// Angles about axes parallel to x, y, z, in degrees: one for all axes, or three. A tile turns
    /// about its centre, and a group about the mean of the centres of its tiles.
    rotation_deg: Components<3>,
    /// Errors of each side, along the tile's own axes, in mm: one for all sides, or three. They are
    /// the same for all tiles of a group.
    size_mm: Components<3>,
    /// Error of |J|, as a fraction of it: 0.01 is 1 %. It is the same for all tiles of a group.
    strength: Components<1>,
    /// Angles by which J is turned within the tile, in degrees: one for both directions, or two, in
    /// the plane of the film and out of it. They are the same for all tiles of a group.
    direction_deg: Components<2>,
}

/// Number of the keys.
const COUNT: usize = 5;

/// The errors of each key that a table gives.
pub(crate) type GivenErrors = [Option<Vec<Distribution>>; COUNT];

/// The errors of each key.
fn by_key(errors: &mut TileErrors) -> [&mut [Distribution]; COUNT] {
    let PerTileError { position, rotation, size, strength, direction } = errors;
    [position, rotation, size, slice::from_mut(strength), direction]
}

/// Replaces the errors that are given.
pub(crate) fn replace(given: &GivenErrors, errors: &mut TileErrors) {
    for (errors, given) in by_key(errors).into_iter().zip(given) {
        if let Some(given) = given {
            errors.clone_from_slice(given);
        }
    }
}

impl ErrorKeys {
    /// The keys, with errors in memory.
    fn each<'k>(&'k mut self, errors: &'k mut TileErrors) -> [ErrorKey<'k>; COUNT] {
        let [position, rotation, size, strength, direction] = by_key(errors);
        [
            ErrorKey::new("position_mm", ErrorUnit::Millimetre, &mut self.position_mm, position),
            ErrorKey::new("rotation_deg", ErrorUnit::Degree, &mut self.rotation_deg, rotation),
            ErrorKey::new("size_mm", ErrorUnit::Millimetre, &mut self.size_mm, size),
            ErrorKey::new("strength", ErrorUnit::Fraction, &mut self.strength, strength),
            ErrorKey::new("direction_deg", ErrorUnit::Degree, &mut self.direction_deg, direction),
        ]
    }

    /// The errors of the keys, after adding faults. `shortest` is the shortest side of the tiles,
    /// with its tile. Errors of length must be less.
    pub(crate) fn read(&mut self, shortest: Option<(f64, &str)>, at: &mut ErrorTable) -> GivenErrors {
        self.each(&mut TileErrors::default()).map(|mut key| {
            key.read(at);
            let side = shortest.filter(|_| key.is_given() && key.unit == ErrorUnit::Millimetre);
            for (place, largest) in side.iter().flat_map(|_| key.largest()) {
                let Some((side, tile)) = side else { continue };
                let rule = format_args!(
                    "must be less than the shortest side of tile \"{}\", {side} mm (mm, not um: {}?)",
                    shown(tile),
                    short(1e-3 * largest)
                );
                at.faults.require(largest < side, place, largest, rule);
            }
            key.is_given().then(|| key.errors.to_vec())
        })
    }

    /// The errors of a table that has no others, which must give one of the keys.
    pub(crate) fn read_some(&mut self, shortest: Option<(f64, &str)>, at: &mut ErrorTable) -> GivenErrors {
        let given = self.read(shortest, at);
        if given.iter().all(Option::is_none) {
            at.faults.add(
                "gives no errors, must give at least one of position_mm, rotation_deg, size_mm, strength, direction_deg",
            );
        }
        given
    }

    /// The keys of the errors of a group, at least one.
    pub(crate) fn of(errors: &TileErrors) -> ErrorKeys {
        let mut keys = ErrorKeys::default();
        let has_none = errors.values().all(Distribution::is_none);
        for key in keys.each(&mut errors.clone()) {
            if key.has_errors() || has_none && key.name == "strength" {
                key.write();
            }
        }
        keys
    }

    /// Key by key, the errors that most tiles have, and the errors of the other tiles with their
    /// indices. The text then has no distribution more often than the file from which it was read.
    pub(crate) fn of_tiles(tiles: &[TileErrors]) -> (ErrorKeys, Vec<(Vec<usize>, ErrorKeys)>) {
        let (mut usual, mut others) = (ErrorKeys::default(), Vec::new());
        for key in 0..COUNT {
            let mut different: IndexMap<Vec<DistributionKey>, Vec<usize>> = IndexMap::new();
            for (index, errors) in tiles.iter().enumerate() {
                let identity = by_key(&mut errors.clone())[key].iter().map(DistributionKey::from).collect();
                different.entry(identity).or_default().push(index);
            }
            let write = |keys: &mut ErrorKeys, tile: usize, must_have_errors: bool| {
                let mut errors = tiles[tile].clone();
                let written = keys.each(&mut errors).into_iter().nth(key);
                written.into_iter().filter(|key| key.has_errors() || !must_have_errors).for_each(ErrorKey::write);
            };
            // The first of those with as many tiles, so that the text does not depend on chance.
            let Some(most) = different.values().map(Vec::len).max() else { continue };
            let common = different.values().position(|tiles| tiles.len() == most);
            let common = common.and_then(|place| different.shift_remove_index(place));
            common.into_iter().for_each(|(_, tiles)| write(&mut usual, tiles[0], true));
            others.extend(different.into_values().map(|tiles| {
                let mut keys = ErrorKeys::default();
                write(&mut keys, tiles[0], false);
                (tiles, keys)
            }));
        }
        (usual, others)
    }
}
