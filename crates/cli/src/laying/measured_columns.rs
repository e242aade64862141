//! The columns of measured tiles, found by their names.

use crate::csv_input::finder::{ANGLES, Column, Finder, NO_UNIT};
use crate::units::{FLUX_DENSITIES, LENGTHS, MAGNETIZATIONS, MOMENTS};

/// The columns of all properties.
pub(super) struct MeasuredColumns {
    pub(super) tile: Column,
    pub(super) part: Option<Column>,
    pub(super) size: Option<[Column; 3]>,
    pub(super) magnet: MagnetColumns,
    /// Names of the columns that are not read.
    pub(super) ignored: Vec<String>,
}

/// The columns of the magnetization in one of its forms.
pub(super) enum MagnetColumns {
    /// In tesla.
    Polarization([Column; 3]),
    /// In A/m.
    Magnetization([Column; 3]),
    /// In A m2.
    Moment([Column; 3]),
    /// Magnitude in tesla, then the angles in degrees from the first side towards the second, and
    /// out of the plane of both. Without them the direction is that of the part.
    Strength(Column, Option<[Column; 2]>),
}

/// The line of names that messages show.
pub(super) const EXAMPLE: &str = "tile,part,jx_t,jy_t,jz_t";

/// Whether a line is the line of names: it has tiles.
pub(super) fn has_names(names: &[String]) -> bool {
    names.iter().any(|name| ["tile", "name", "label"].contains(&name.trim().to_lowercase().as_str()))
}

/// Finds the columns, or all that is wrong with the names.
pub(super) fn find(names: &[String]) -> Result<MeasuredColumns, Vec<String>> {
    let mut finder = Finder::new(names);
    let tile = finder.group("tile", [["tile", "name", "label"]], &NO_UNIT, None).map(|[column]| column);
    let part = finder.group("part", [["part", "kind"]], &NO_UNIT, None).map(|[column]| column);
    let size = finder.group("size", [["size_x", "dx"], ["size_y", "dy"], ["size_z", "dz"]], &LENGTHS, None);
    let polarization = finder.group("polarization", [["jx"], ["jy"], ["jz"]], &FLUX_DENSITIES, None);
    let magnetization = finder.group("magnetization", [["mx"], ["my"], ["mz"]], &MAGNETIZATIONS, None);
    let moment = finder.group("moment", [["moment_x"], ["moment_y"], ["moment_z"]], &MOMENTS, None);
    let strength = finder.group("strength", [["strength"]], &FLUX_DENSITIES, None).map(|[column]| column);
    let angles = finder.group("direction", [["direction"], ["tilt"]], &ANGLES, None);
    let forms = [
        polarization.map(MagnetColumns::Polarization),
        magnetization.map(MagnetColumns::Magnetization),
        moment.map(MagnetColumns::Moment),
        strength.map(|strength| MagnetColumns::Strength(strength, angles)),
    ];
    let mut found: Vec<MagnetColumns> = forms.into_iter().flatten().collect();
    if found.len() > 1 {
        finder.fault(
            "has more than one of polarization (jx_t, ...), magnetization (mx_a_per_m, ...), moment (moment_x_a_m2, \
             ...) and strength (strength_t), must have one of them",
        );
    } else if found.is_empty() {
        finder.missing(
            "polarization: jx_t, jy_t, jz_t, or magnetization: mx_a_per_m, my_a_per_m, mz_a_per_m, or moment: \
             moment_x_a_m2, moment_y_a_m2, moment_z_a_m2, or strength: strength_t, with or without direction_deg and \
             tilt_deg",
        );
    }
    if tile.is_none() {
        finder.missing("tile: tile");
    }
    let ignored = finder.unused();
    match (tile, found.pop()) {
        (Some(tile), Some(magnet)) if finder.faults.is_empty() => {
            Ok(MeasuredColumns { tile, part, size, magnet, ignored })
        }
        _ => Err(finder.faults),
    }
}
