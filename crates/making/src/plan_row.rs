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

    /// The rows of a plan in the order in which a person places the tiles: placed tiles first, then
    /// layer by layer from below, row by row from the largest y, and from left to right.
    pub fn in_placing_order(plan: &[PlanRow]) -> Vec<&PlanRow> {
        let mut rows: Vec<&PlanRow> = plan.iter().collect();
        // Micrometres, so that round-off does not divide a row of tiles.
        let step = |mm: f64| (1e3 * mm).round() as i64;
        rows.sort_by_key(|row| {
            let DVec3 { x, y, z } = row.centre_mm;
            (!row.is_placed, step(z), -step(y), step(x))
        });
        rows
    }

    /// Whether the upward side of the measurement is the upward side in the film.
    pub fn is_upright(&self) -> bool {
        self.up == "+z"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_are_placed_row_by_row() {
        let row = |place: &str, centre_mm: [f64; 3], is_placed| PlanRow {
            place: place.to_owned(),
            tile: String::new(),
            centre_mm: centre_mm.into(),
            up: "+z",
            mark: "+x",
            mark_deg: 0.0,
            is_placed,
        };
        let plan = [
            row("front", [0.0, -2.0, 0.5], false),
            row("right", [2.0, 1.0, 0.5], false),
            row("upper", [-2.0, 1.0, 1.5], false),
            row("left", [-2.0, 1.0 - 1e-9, 0.5], false),
            row("placed", [0.0, -5.0, 0.5], true),
        ];
        let order: Vec<&str> = PlanRow::in_placing_order(&plan).iter().map(|row| row.place.as_str()).collect();
        assert_eq!(order, ["placed", "left", "right", "front", "upper"]);
    }
}
