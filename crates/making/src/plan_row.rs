//! The plan: which tile goes where, and which way round.

use glam::DVec3;
use magsplice_magnet::Tile;

use crate::orientation::Orientation;

/// Angles of marks are rounded to one part in this of a degree, which takes round-off away.
const ANGLE_DECIMALS: f64 = 1e6;

/// A line of a plan: the tile of a place, and how it lies there.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct PlanRow {
    /// Name of the place: of the tile of the layout.
    pub place: String,
    /// Name of the measured tile.
    pub tile: String,
    /// Centre in millimetres.
    pub centre_mm: DVec3,
    /// The side of the measured tile that is up, such as `+z`.
    pub up: &'static str,
    /// The axis of the measured tile that a mark on it shows, such as `+x`.
    pub mark: &'static str,
    /// Where this axis points, from the x axis of the film towards its y axis, from 0 to below 360
    /// degrees.
    pub mark_deg: f64,
    /// Whether the tile lies already.
    pub is_laid: bool,
}

impl PlanRow {
    /// The name of a shim tile in a plan: it is not in the box.
    pub const SHIM: &'static str = "shim";

    /// The line of a tile that is, or will be, where `lies` is.
    pub fn new(place: &str, tile: &str, orientation: Orientation, lies: &Tile, is_laid: bool) -> PlanRow {
        let mark_deg = (orientation.mark_deg(lies) * ANGLE_DECIMALS).round() / ANGLE_DECIMALS;
        PlanRow {
            place: place.to_owned(),
            tile: tile.to_owned(),
            centre_mm: lies.position(),
            up: orientation.upper_side_name(),
            mark: ["+x", "+y", "+z"][orientation.mark_axis()],
            mark_deg: mark_deg.rem_euclid(360.0),
            is_laid,
        }
    }

    /// Whether the side that is up when the tile is measured is up.
    pub fn is_upright(&self) -> bool {
        self.up == "+z"
    }
}
