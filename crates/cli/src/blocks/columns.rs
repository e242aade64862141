//! The columns that hold the properties of a block, found by their names.

use super::rotation::{self, RotationColumns};
use crate::args::import::ImportArgs;
use crate::csv_input::finder::{Column, Finder, NO_UNIT};
use crate::csv_input::names::unit_in;
use crate::units::{self, FLUX_DENSITIES, LENGTHS, MAGNETIZATIONS};

const AXES: [&str; 3] = ["x", "y", "z"];

/// The columns of all properties.
pub(crate) struct BlockColumns {
    pub(crate) name: Option<Column>,
    pub(crate) position: [Column; 3],
    pub(crate) size: [Column; 3],
    pub(crate) magnet: MagnetColumns,
    pub(crate) rotation: Option<RotationColumns>,
    /// Names of the columns that are not read.
    pub(crate) ignored: Vec<String>,
}

/// The columns of the polarization or the magnetization.
pub(crate) enum MagnetColumns {
    /// In tesla.
    Polarization([Column; 3]),
    /// In A/m.
    Magnetization([Column; 3]),
}

/// Whether a line is the line of names: it has a position.
pub(crate) fn has_names(names: &[String]) -> bool {
    let is_length = |name: &String, axis: &str| {
        unit_in(name, axis).is_some_and(|unit| unit.is_empty() || units::exponent(&LENGTHS, &unit).is_some())
    };
    AXES.iter().all(|axis| names.iter().any(|name| is_length(name, axis)))
}

/// Finds the columns, or all that is wrong with the names.
pub(crate) fn find(names: &[String], args: &ImportArgs) -> Result<BlockColumns, Vec<String>> {
    let mut finder = Finder::new(names);
    let default = args.unit.map(|unit| unit.name());
    let name = finder.group("name", [["name", "label"]], &NO_UNIT, None).map(|[column]| column);
    let position = finder.group("position", AXES.map(|axis| [axis]), &LENGTHS, default);
    let size = finder.group("size", [["size_x", "dx"], ["size_y", "dy"], ["size_z", "dz"]], &LENGTHS, default);
    let polarization = finder.group("polarization", [["jx"], ["jy"], ["jz"]], &FLUX_DENSITIES, None);
    let magnetization = finder.group("magnetization", [["mx"], ["my"], ["mz"]], &MAGNETIZATIONS, None);
    let rotation = rotation::find(&mut finder, args.euler);
    if let Some(unit) = default {
        finder.check_unit(unit, position.iter().chain(&size).flatten());
    }
    let magnet = match (polarization, magnetization) {
        (Some(columns), None) => Some(MagnetColumns::Polarization(columns)),
        (None, Some(columns)) => Some(MagnetColumns::Magnetization(columns)),
        (Some(_), Some(_)) => {
            finder
                .fault("has both polarization (jx_t, ...) and magnetization (mx_a_per_m, ...), must have one of them");
            None
        }
        (None, None) => {
            finder.missing("polarization: jx_t, jy_t, jz_t, or magnetization: mx_a_per_m, my_a_per_m, mz_a_per_m");
            None
        }
    };
    if position.is_none() {
        finder.missing("position: x_mm, y_mm, z_mm");
    }
    if size.is_none() {
        finder.missing("size: size_x_mm, size_y_mm, size_z_mm");
    }
    let ignored = finder.unused();
    match (position, size, magnet) {
        (Some(position), Some(size), Some(magnet)) if finder.faults.is_empty() => {
            Ok(BlockColumns { name, position, size, magnet, rotation, ignored })
        }
        _ => Err(finder.faults),
    }
}
