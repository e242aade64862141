//! The quantities of columns: what their names begin with, and the units that they may carry.

use super::names::unit_in;
use crate::units::{self, COLUMN_ANGLES, FLUX_DENSITIES, FORCES, LENGTHS, MAGNETIZATIONS, MOMENTS, Unit};

/// The columns of one quantity, one for each component.
pub(crate) struct Group<const N: usize> {
    /// The quantity, as messages call it.
    pub(crate) name: &'static str,
    /// For each component: what the name of its column may be, without the unit.
    pub(crate) columns: [&'static [&'static str]; N],
    /// Units of the columns; empty for columns of text and plain numbers.
    pub(crate) units: &'static [Unit],
}

/// In millimetres.
pub(crate) const POSITION: Group<3> = Group { name: "position", columns: [&["x"], &["y"], &["z"]], units: &LENGTHS };
/// In millimetres.
pub(crate) const SIZE: Group<3> =
    Group { name: "size", columns: [&["size_x", "dx"], &["size_y", "dy"], &["size_z", "dz"]], units: &LENGTHS };
/// In tesla.
pub(crate) const POLARIZATION: Group<3> =
    Group { name: "polarization", columns: [&["jx"], &["jy"], &["jz"]], units: &FLUX_DENSITIES };
/// As a polarization in tesla.
pub(crate) const MAGNETIZATION: Group<3> =
    Group { name: "magnetization", columns: [&["mx"], &["my"], &["mz"]], units: &MAGNETIZATIONS };
/// In A m2.
pub(crate) const MOMENT: Group<3> =
    Group { name: "moment", columns: [&["moment_x"], &["moment_y"], &["moment_z"]], units: &MOMENTS };
/// Magnitude of a polarization in tesla.
pub(crate) const STRENGTH: Group<1> = Group { name: "strength", columns: [&["strength"]], units: &FLUX_DENSITIES };
/// Angles of a polarization in degrees: from the first side towards the second, and out of the
/// plane of both.
pub(crate) const DIRECTION: Group<2> =
    Group { name: "direction", columns: [&["direction"], &["tilt"]], units: &COLUMN_ANGLES };
/// Readings of a sensor in tesla.
pub(crate) const READING: Group<3> =
    Group { name: "flux density", columns: [&["bx"], &["by"], &["bz"]], units: &FLUX_DENSITIES };
/// In newton.
pub(crate) const FORCE: Group<3> = Group { name: "force", columns: [&["fx"], &["fy"], &["fz"]], units: &FORCES };

/// A column of text.
pub(crate) const fn text(name: &'static str, column: &'static [&'static str]) -> Group<1> {
    Group { name, columns: [column], units: &[] }
}

impl<const N: usize> Group<N> {
    /// Whether a line has a name for each column, with a known unit or none.
    pub(crate) fn is_among(&self, names: &[String]) -> bool {
        self.columns.iter().all(|bases| names.iter().any(|name| self.known_unit(name, bases).is_some()))
    }

    /// The unit in the name of a column with one of these names. Empty without a unit, `None` for
    /// an unknown unit or another column.
    pub(crate) fn known_unit(&self, name: &str, bases: &[&str]) -> Option<String> {
        let unit = bases.iter().find_map(|base| unit_in(name, base))?;
        (unit.is_empty() || units::find(self.units, &unit).is_some()).then_some(unit)
    }

    /// The unit in the name of a column of this group, if it is an unknown one.
    pub(crate) fn unknown_unit(&self, name: &str) -> Option<String> {
        let unit = self.columns.iter().copied().flatten().find_map(|base| unit_in(name, base))?;
        (!self.units.is_empty() && !unit.is_empty() && units::find(self.units, &unit).is_none()).then_some(unit)
    }
}
