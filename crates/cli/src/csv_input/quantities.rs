//! The quantities of columns: what their names begin with, and the units that they may carry.

use super::names::unit_in;
use crate::units::{self, COLUMN_ANGLES, FIELD_STRENGTHS, FLUX_DENSITIES, FORCES, LENGTHS, MOMENTS, READINGS, Unit};

/// The columns of one quantity, one for each component.
pub(crate) struct Group<'n, const N: usize> {
    /// The quantity, as messages call it.
    pub(crate) name: &'static str,
    /// For each component: what the name of its column may be, without the unit.
    pub(crate) columns: [&'n [&'n str]; N],
    /// What follows the names that messages suggest, such as `_mm`.
    pub(crate) suffix: &'static str,
    /// Units of the columns; empty for columns of text and plain numbers.
    pub(crate) units: &'static [Unit],
}

/// How well a line fits as the line of names.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Fit {
    /// Names are missing.
    None,
    /// All names are there, without units. A line of words can be so by chance.
    Bare,
    /// All names are there, with a unit at least at one.
    Complete,
}

/// In millimetres.
pub(crate) const POSITION: Group<3> = Group {
    name: "position",
    columns: [
        &["x", "pos_x", "position_x", "x_pos", "x_position"],
        &["y", "pos_y", "position_y", "y_pos", "y_position"],
        &["z", "pos_z", "position_z", "z_pos", "z_position"],
    ],
    suffix: "_mm",
    units: &LENGTHS,
};
/// In millimetres.
pub(crate) const SIZE: Group<3> = Group {
    name: "size",
    columns: [&["size_x", "dx"], &["size_y", "dy"], &["size_z", "dz"]],
    suffix: "_mm",
    units: &LENGTHS,
};
/// In tesla.
pub(crate) const POLARIZATION: Group<3> = Group {
    name: "polarization",
    columns: [&["jx", "j_x"], &["jy", "j_y"], &["jz", "j_z"]],
    suffix: "_t",
    units: &FLUX_DENSITIES,
};
/// As a polarization in tesla.
pub(crate) const MAGNETIZATION: Group<3> = Group {
    name: "magnetization",
    columns: [&["mx", "m_x"], &["my", "m_y"], &["mz", "m_z"]],
    suffix: "_a_per_m",
    units: &FIELD_STRENGTHS,
};
/// In A m2.
pub(crate) const MOMENT: Group<3> =
    Group { name: "moment", columns: [&["moment_x"], &["moment_y"], &["moment_z"]], suffix: "_a_m2", units: &MOMENTS };
/// Magnitude of a polarization in tesla.
pub(crate) const STRENGTH: Group<1> =
    Group { name: "strength", columns: [&["strength", "br"]], suffix: "_t", units: &FLUX_DENSITIES };
/// Angle of a polarization in degrees, from the first side towards the second.
pub(crate) const DIRECTION: Group<1> =
    Group { name: "direction", columns: [&["direction"]], suffix: "_deg", units: &COLUMN_ANGLES };
/// Angle of a polarization in degrees, out of the plane of the first two sides.
pub(crate) const TILT: Group<1> = Group { name: "tilt", columns: [&["tilt"]], suffix: "_deg", units: &COLUMN_ANGLES };
/// Readings of a sensor in tesla, or in counts.
pub(crate) const READING: Group<3> = Group {
    name: "flux density",
    columns: [
        &["bx", "b_x", "field_x", "mag_x"],
        &["by", "b_y", "field_y", "mag_y"],
        &["bz", "b_z", "field_z", "mag_z"],
    ],
    suffix: "_mt",
    units: &READINGS,
};
/// Readings as field strengths, times mu0 in tesla.
pub(crate) const FIELD_STRENGTH: Group<3> = Group {
    name: "field strength",
    columns: [&["hx", "h_x"], &["hy", "h_y"], &["hz", "h_z"]],
    suffix: "_a_per_m",
    units: &FIELD_STRENGTHS,
};
/// In newton.
pub(crate) const FORCE: Group<3> = Group {
    name: "force",
    columns: [&["fx", "f_x", "force_x"], &["fy", "f_y", "force_y"], &["fz", "f_z", "force_z"]],
    suffix: "_n",
    units: &FORCES,
};

/// The name of a tile.
pub(crate) const TILE: Group<1> = text("tile", &["tile", "name", "label"]);

/// A column of text.
pub(crate) const fn text(name: &'static str, column: &'static [&'static str]) -> Group<'static, 1> {
    Group { name, columns: [column], suffix: "", units: &[] }
}

/// Names of the columns of one of several sensors, which count from 0 or 1.
pub(crate) struct NumberedReading([Vec<String>; 3]);

impl NumberedReading {
    /// The names of sensor `number`: `bx1`, `bx_1`, `b_x_1`, `b1x`, `b1_x`.
    pub(crate) fn new(number: usize) -> NumberedReading {
        NumberedReading(["x", "y", "z"].map(|axis| {
            vec![
                format!("b{axis}{number}"),
                format!("b{axis}_{number}"),
                format!("b_{axis}_{number}"),
                format!("b{number}{axis}"),
                format!("b{number}_{axis}"),
            ]
        }))
    }

    /// What `read` does with the names as a group, which borrows them.
    pub(crate) fn with<T>(&self, read: impl FnOnce(&Group<3>) -> T) -> T {
        let names = self.0.each_ref().map(|names| names.iter().map(String::as_str).collect::<Vec<&str>>());
        let columns = names.each_ref().map(Vec::as_slice);
        read(&Group { columns, ..READING })
    }
}

impl<const N: usize> Group<'_, N> {
    /// How well a line has a name for each column, with a known unit or none.
    pub(crate) fn fit(&self, names: &[String]) -> Fit {
        self.fit_of(names, N)
    }

    /// The same for a name of any column.
    pub(crate) fn partial_fit(&self, names: &[String]) -> Fit {
        self.fit_of(names, 1)
    }

    /// How well a line has names for `least` of the columns.
    fn fit_of(&self, names: &[String], least: usize) -> Fit {
        // The column with a unit comes before one without.
        let unit = |bases: &&[&str]| {
            let units = names.iter().filter_map(|name| self.known_unit(name, bases));
            units.max_by_key(|unit| !unit.is_empty())
        };
        let units: Vec<String> = self.columns.iter().filter_map(unit).collect();
        let has_unit = self.units.is_empty() || units.iter().any(|unit| !unit.is_empty());
        match (units.len() >= least, has_unit) {
            (false, _) => Fit::None,
            (true, false) => Fit::Bare,
            (true, true) => Fit::Complete,
        }
    }

    /// The unit in the name of a column with one of these names. Empty without a unit, `None` for
    /// an unknown unit or another column.
    pub(crate) fn known_unit(&self, name: &str, bases: &[&str]) -> Option<String> {
        let is_known = |unit: &String| unit.is_empty() || units::find(self.units, unit).is_some();
        bases.iter().filter_map(|base| unit_in(name, base)).find(is_known)
    }

    /// The unit in the name of a column of this group, if it is an unknown one.
    pub(crate) fn unknown_unit(&self, name: &str) -> Option<String> {
        if self.units.is_empty() || self.columns.iter().any(|bases| self.known_unit(name, bases).is_some()) {
            return None;
        }
        self.columns.iter().copied().flatten().find_map(|base| unit_in(name, base))
    }

    /// The name of the column of a component, as messages suggest it.
    pub(crate) fn suggested(&self, component: usize) -> String {
        format!("{}{}", self.columns[component][0], self.suffix)
    }

    /// The names of all columns, as messages suggest them.
    pub(crate) fn example(&self) -> String {
        (0..N).map(|component| self.suggested(component)).collect::<Vec<_>>().join(",")
    }
}
