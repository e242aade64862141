//! The plan: the place and the orientation of each tile.

use glam::DVec3;
use magsplice_magnet::Tile;

use crate::orientation::Orientation;

/// Inverse of the unit, in degrees, to which angles of marks are rounded. It removes round-off.
const ANGLE_DECIMALS: f64 = 1e6;

/// A line of a plan: a place, its tile, and the orientation.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct PlanRow {
    /// Name of the place, which is the name of the tile in the layout.
    pub place: String,
    /// Name of the measured tile.
    pub tile: String,
    /// Centre in millimetres.
    pub centre_mm: DVec3,
    /// The upward side of the measured tile, such as `+z`.
    pub up: &'static str,
    /// The axis of the measured tile along its mark, such as `+x`.
    pub mark: &'static str,
    /// Direction of this axis, in degrees from the x axis of the film towards its y axis, from 0 to
    /// below 360.
    pub mark_deg: f64,
    /// Whether the tile is already placed.
    pub is_placed: bool,
}

impl PlanRow {
    /// The name of a shim tile in a plan. It does not come from the box.
    pub const SHIM: &'static str = "shim";

    /// The line of a tile with the actual or planned position of `lies`.
    pub fn new(place: &str, tile: &str, orientation: Orientation, lies: &Tile, is_placed: bool) -> PlanRow {
        let mark_deg = (orientation.mark_deg(lies) * ANGLE_DECIMALS).round() / ANGLE_DECIMALS;
        PlanRow {
            place: place.to_owned(),
            tile: tile.to_owned(),
            centre_mm: lies.position(),
            up: orientation.upper_side_name(),
            mark: ["+x", "+y", "+z"][orientation.mark_axis()],
            mark_deg: mark_deg.rem_euclid(360.0),
            is_placed,
        }
    }

    /// Whether the upward side of the measurement is the upward side in the film.
    pub fn is_upright(&self) -> bool {
        self.up == "+z"
    }
}
