//! The keys of errors of tiles, in every table that has them, and the errors of each tile.

use std::collections::HashMap;

use magsplice_magnet::PerTileError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error_unit::ErrorUnit;
use crate::faults::TableFaults;
use crate::names::shown;
use crate::plausible::short;
use crate::tolerance::TileErrors;
use crate::tolerance::distribution::Distribution;
use crate::tolerance::tabulated::ErrorTable;
use crate::tolerance::written::{Components, DistributionKey, WrittenDistribution};

/// Errors of tiles, or of groups of tiles.
#[derive(Default, Deserialize, JsonSchema, Serialize)]
pub(crate) struct ErrorKeys {
    /// Errors of the centre along x, y, z, in mm: one for all axes, or three. A group is shifted as
    /// a whole.
    position_mm: Option<Components<3>>,
    /// Angles about axes parallel to x, y, z, in degrees: one for all axes, or three. A tile turns
    /// about its centre, and a group about the mean of the centres of its tiles.
    rotation_deg: Option<Components<3>>,
    /// Errors of each side, along the tile's own axes, in mm: one for all sides, or three. They are
    /// the same for all tiles of a group.
    size_mm: Option<Components<3>>,
    /// Error of |J|, as a fraction of it: 0.01 is 1 %. It is the same for all tiles of a group.
    strength: Option<WrittenDistribution>,
    /// Angles by which J is turned within the tile, in degrees: one for both directions, or two, in
    /// the plane of the film and out of it. They are the same for all tiles of a group.
    direction_deg: Option<Components<2>>,
}

/// The errors of the keys that a table gives.
pub(crate) type GivenErrors = PerTileError<Option<Distribution>>;

/// Replaces the errors that are given.
pub(crate) fn replace(given: &GivenErrors, errors: &mut TileErrors) {
    for (error, given) in given.iter() {
        if let Some(given) = given {
            errors[error] = given.clone();
        }
    }
}

impl ErrorKeys {
    /// The errors of the keys, after adding faults. `shortest` is the shortest side of the tiles,
    /// with its tile.
    pub(crate) fn resolve(&self, shortest: Option<(f64, &str)>, at: &mut ErrorTable) -> GivenErrors {
        let mut lengths = |key: &str, written: &Option<Components<3>>| {
            let Some(written) = written else { return Default::default() };
            let found = written.resolve(key, ErrorUnit::Millimetre, at);
            check_lengths(key, written, &found, shortest, &mut at.faults);
            found.map(Some)
        };
        let position = lengths("position_mm", &self.position_mm);
        let size = lengths("size_mm", &self.size_mm);
        let rotation = self
            .rotation_deg
            .as_ref()
            .map_or_else(Default::default, |written| written.resolve("rotation_deg", ErrorUnit::Degree, at).map(Some));
        let strength = self.strength.as_ref();
        let strength = strength.map(|written| written.resolve("strength", ErrorUnit::Fraction, at));
        let direction = self
            .direction_deg
            .as_ref()
            .map_or_else(Default::default, |written| written.resolve("direction_deg", ErrorUnit::Degree, at).map(Some));
        PerTileError { position, rotation, size, strength, direction }
    }

    /// The same of a table that has no other errors, which must give one of the keys.
    pub(crate) fn resolve_some(&self, shortest: Option<(f64, &str)>, at: &mut ErrorTable) -> GivenErrors {
        let ErrorKeys { position_mm, rotation_deg, size_mm, strength, direction_deg } = self;
        let lengths_and_angles = [position_mm, rotation_deg, size_mm];
        if lengths_and_angles.into_iter().all(Option::is_none) && strength.is_none() && direction_deg.is_none() {
            at.faults.add(
                "gives no errors, must give at least one of position_mm, rotation_deg, size_mm, strength, direction_deg",
            );
        }
        self.resolve(shortest, at)
    }

    /// The keys of the errors of a group, at least one.
    pub(crate) fn of(errors: &TileErrors) -> ErrorKeys {
        let mut keys = ErrorKeys::default();
        for (of_key, set) in KEYS {
            if !of_key(errors).iter().all(Distribution::is_none) {
                set(&mut keys, errors);
            }
        }
        if errors.values().all(Distribution::is_none) {
            keys.strength = Some(WrittenDistribution::Deviation(0.0));
        }
        keys
    }

    /// The keys of errors that most tiles have, and those of other tiles with their indices, key by
    /// key. The text then has no distribution more often than the file from which it was read.
    pub(crate) fn of_tiles(tiles: &[TileErrors]) -> (ErrorKeys, Vec<(Vec<usize>, ErrorKeys)>) {
        let (mut usual, mut others) = (ErrorKeys::default(), Vec::new());
        for (of_key, set) in KEYS {
            let mut places: HashMap<Vec<DistributionKey>, usize> = HashMap::new();
            let mut different: Vec<Vec<usize>> = Vec::new();
            for (index, errors) in tiles.iter().enumerate() {
                let key = of_key(errors).iter().map(DistributionKey::from).collect();
                let place = *places.entry(key).or_insert(different.len());
                match different.get_mut(place) {
                    Some(tiles) => tiles.push(index),
                    None => different.push(vec![index]),
                }
            }
            // The first of those with as many tiles, so that the text does not depend on chance.
            let Some(most) = different.iter().map(Vec::len).max() else { continue };
            let common = different.iter().position(|tiles| tiles.len() == most).unwrap_or_default();
            let common = different.remove(common);
            if !of_key(&tiles[common[0]]).iter().all(Distribution::is_none) {
                set(&mut usual, &tiles[common[0]]);
            }
            others.extend(different.into_iter().map(|indices| {
                let mut keys = ErrorKeys::default();
                set(&mut keys, &tiles[indices[0]]);
                (indices, keys)
            }));
        }
        (usual, others)
    }
}

/// The errors of a key.
type OfKey = fn(&TileErrors) -> &[Distribution];

/// Sets a key to its errors.
type SetKey = fn(&mut ErrorKeys, &TileErrors);

/// Each of the keys.
const KEYS: [(OfKey, SetKey); 5] = [
    (
        |errors| &errors.position,
        |keys, errors| {
            keys.position_mm = Some(Components::of(&errors.position, ErrorUnit::Millimetre));
        },
    ),
    (
        |errors| &errors.rotation,
        |keys, errors| {
            keys.rotation_deg = Some(Components::of(&errors.rotation, ErrorUnit::Degree));
        },
    ),
    (
        |errors| &errors.size,
        |keys, errors| {
            keys.size_mm = Some(Components::of(&errors.size, ErrorUnit::Millimetre));
        },
    ),
    (
        |errors| std::slice::from_ref(&errors.strength),
        |keys, errors| {
            keys.strength = Some(WrittenDistribution::of(&errors.strength, ErrorUnit::Fraction));
        },
    ),
    (
        |errors| &errors.direction,
        |keys, errors| {
            keys.direction_deg = Some(Components::of(&errors.direction, ErrorUnit::Degree));
        },
    ),
];

/// Requires errors of length that are less than the shortest side of the tiles.
fn check_lengths(
    key: &str,
    written: &Components<3>,
    errors: &[Distribution; 3],
    shortest: Option<(f64, &str)>,
    faults: &mut TableFaults,
) {
    let Some((side, tile)) = shortest else { return };
    let checked = if matches!(written, Components::Same(_)) { 1 } else { 3 };
    for (i, error) in errors.iter().enumerate().take(checked) {
        let largest = error.largest();
        let place = if checked == 1 { String::new() } else { format!("[{i}]") };
        let rule = format_args!(
            "must be less than the shortest side of tile \"{}\", {side} mm (mm, not um: {}?)",
            shown(tile),
            short(1e-3 * largest)
        );
        faults.require(largest < side, format_args!("{key}{place}"), largest, rule);
    }
}
