//! Errors of tiles: a preset, the keys that replace its numbers, those of kinds and of single
//! tiles.

use std::collections::BTreeMap;
use std::ops::Range;

use toml::Spanned;

use crate::distribution::Distribution;
use crate::error_unit::{ErrorUnit, largest_magnitude};
use crate::plausible::short;
use crate::presets::Preset;
use crate::read::faults::{Faults, TableFaults};
use crate::read::names::shown;
use crate::read::tolerance::distribution::{components, distribution};
use crate::read::tolerance::selection::Selection;
use crate::read::tolerance::tabulated::Tabulated;
use crate::tables::distribution::{Components, WrittenDistribution};
use crate::tables::tolerance::{GroupTable, KindErrorsTable, TileErrorsTable, ToleranceTable};
use crate::tolerance::TileErrors;

/// The rule for a table without any of the keys of errors.
pub(crate) const NO_ERRORS: &str =
    "gives no errors, must give at least one of position_mm, rotation_deg, size_mm, strength, direction_deg";

/// The keys of the errors of tiles in any table that has them.
pub(crate) struct ErrorKeys<'t> {
    position_mm: Option<&'t Components<3>>,
    rotation_deg: Option<&'t Components<3>>,
    size_mm: Option<&'t Components<3>>,
    strength: Option<&'t WrittenDistribution>,
    direction_deg: Option<&'t Components<2>>,
}

impl ErrorKeys<'_> {
    pub(crate) fn is_empty(&self) -> bool {
        let ErrorKeys { position_mm, rotation_deg, size_mm, strength, direction_deg } = self;
        position_mm.is_none()
            && rotation_deg.is_none()
            && size_mm.is_none()
            && strength.is_none()
            && direction_deg.is_none()
    }

    /// The errors of the keys, after adding faults. `shortest` is the shortest side of the tiles,
    /// with its tile.
    pub(crate) fn resolve(
        &self,
        shortest: Option<(f64, &str)>,
        tabulated: &mut Tabulated,
        faults: &mut TableFaults,
    ) -> GivenErrors {
        let mut lengths = |key: &str, written: Option<&Components<3>>, faults: &mut TableFaults| {
            let found = components(key, written?, ErrorUnit::Millimetre, tabulated, faults);
            check_lengths(key, written?, &found, shortest, faults);
            Some(found)
        };
        let position_mm = lengths("position_mm", self.position_mm, faults);
        let size_mm = lengths("size_mm", self.size_mm, faults);
        let rotation_rad =
            self.rotation_deg.map(|written| components("rotation_deg", written, ErrorUnit::Degree, tabulated, faults));
        let strength =
            self.strength.map(|written| distribution("strength", written, ErrorUnit::Fraction, tabulated, faults));
        let direction_rad = self
            .direction_deg
            .map(|written| components("direction_deg", written, ErrorUnit::Degree, tabulated, faults));
        GivenErrors { position_mm, rotation_rad, size_mm, strength, direction_rad }
    }
}

impl<'t> From<&'t ToleranceTable> for ErrorKeys<'t> {
    fn from(table: &'t ToleranceTable) -> ErrorKeys<'t> {
        ErrorKeys {
            position_mm: table.position_mm.as_ref(),
            rotation_deg: table.rotation_deg.as_ref(),
            size_mm: table.size_mm.as_ref(),
            strength: table.strength.as_ref(),
            direction_deg: table.direction_deg.as_ref(),
        }
    }
}

impl<'t> From<&'t KindErrorsTable> for ErrorKeys<'t> {
    fn from(table: &'t KindErrorsTable) -> ErrorKeys<'t> {
        ErrorKeys {
            position_mm: table.position_mm.as_ref(),
            rotation_deg: table.rotation_deg.as_ref(),
            size_mm: table.size_mm.as_ref(),
            strength: table.strength.as_ref(),
            direction_deg: table.direction_deg.as_ref(),
        }
    }
}

impl<'t> From<&'t TileErrorsTable> for ErrorKeys<'t> {
    fn from(table: &'t TileErrorsTable) -> ErrorKeys<'t> {
        ErrorKeys {
            position_mm: table.position_mm.as_ref(),
            rotation_deg: table.rotation_deg.as_ref(),
            size_mm: table.size_mm.as_ref(),
            strength: table.strength.as_ref(),
            direction_deg: table.direction_deg.as_ref(),
        }
    }
}

impl<'t> From<&'t GroupTable> for ErrorKeys<'t> {
    fn from(table: &'t GroupTable) -> ErrorKeys<'t> {
        ErrorKeys {
            position_mm: table.position_mm.as_ref(),
            rotation_deg: table.rotation_deg.as_ref(),
            size_mm: table.size_mm.as_ref(),
            strength: table.strength.as_ref(),
            direction_deg: table.direction_deg.as_ref(),
        }
    }
}

/// Errors of the keys that a table gives.
pub(crate) struct GivenErrors {
    position_mm: Option<[Distribution; 3]>,
    rotation_rad: Option<[Distribution; 3]>,
    size_mm: Option<[Distribution; 3]>,
    strength: Option<Distribution>,
    direction_rad: Option<[Distribution; 2]>,
}

impl GivenErrors {
    /// Replaces the errors of the keys that were given.
    pub(crate) fn replace_in(&self, errors: &mut TileErrors) {
        let GivenErrors { position_mm, rotation_rad, size_mm, strength, direction_rad } = self;
        set_if_given(position_mm, &mut errors.position);
        set_if_given(rotation_rad, &mut errors.rotation);
        set_if_given(size_mm, &mut errors.size);
        set_if_given(strength, &mut errors.strength);
        set_if_given(direction_rad, &mut errors.direction);
    }
}

fn set_if_given<T: Clone>(given: &Option<T>, place: &mut T) {
    if let Some(given) = given {
        place.clone_from(given);
    }
}

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
        let largest = largest_magnitude(error);
        if largest >= side {
            let place = if checked == 1 { String::new() } else { format!("[{i}]") };
            faults.add(format!(
                "{key}{place} = {largest}, must be less than the shortest side of tile \"{}\", {side} mm (mm, not um: {}?)",
                shown(tile),
                short(1e-3 * largest)
            ));
        }
    }
}

/// The errors of each tile, or nothing if no tile has errors. Faults are added.
pub(crate) fn resolve(
    table: &ToleranceTable,
    span: &Range<usize>,
    selection: &mut Selection,
    tabulated: &mut Tabulated,
    faults: &mut Faults,
) -> Vec<TileErrors> {
    let mut base = table.preset.map(Preset::errors).unwrap_or_default();
    let count = selection.tiles.len();
    let shortest = selection.shortest_side(0..count);
    let mut at = faults.at(span, "tolerance");
    ErrorKeys::from(table).resolve(shortest, tabulated, &mut at).replace_in(&mut base);
    let mut tiles = vec![base; count];
    of_kinds(&table.kind, &mut tiles, selection, tabulated, faults);
    for entry in &table.tile {
        let mut at = faults.at(&entry.span(), "tolerance.tile");
        let entry = entry.get_ref();
        let chosen = selection.of_names("tiles", &entry.tiles, &mut at);
        if entry.tiles.is_empty() {
            at.add("tiles is empty, must name at least one tile");
        }
        let keys = ErrorKeys::from(entry);
        if keys.is_empty() {
            at.add(NO_ERRORS);
        }
        let given = keys.resolve(selection.shortest_side(chosen.iter().copied()), tabulated, &mut at);
        chosen.into_iter().for_each(|index| given.replace_in(&mut tiles[index]));
    }
    let has_errors = |errors: &TileErrors| errors.values().any(|error| !error.is_none());
    if tiles.iter().any(has_errors) { tiles } else { Vec::new() }
}

fn of_kinds(
    kinds: &BTreeMap<String, Spanned<KindErrorsTable>>,
    tiles: &mut [TileErrors],
    selection: &Selection,
    tabulated: &mut Tabulated,
    faults: &mut Faults,
) {
    for (kind, table) in kinds {
        let mut at = faults.at(&table.span(), format!("tolerance.kind \"{}\"", shown(kind)));
        selection.check_kind("[tolerance.kind]", kind, &mut at);
        let chosen = selection.by_kind().get(kind.as_str()).map_or(&[][..], Vec::as_slice);
        let keys = ErrorKeys::from(table.get_ref());
        if keys.is_empty() {
            at.add(NO_ERRORS);
        }
        let given = keys.resolve(selection.shortest_side(chosen.iter().copied()), tabulated, &mut at);
        chosen.iter().for_each(|&index| given.replace_in(&mut tiles[index]));
    }
}
