//! The plan: which tile goes where, and which way round.

use magsplice::making::Orientation;
use magsplice::prelude::{DVec3, Tile};
use magsplice_export::twelve_digits;

/// Names of the columns of a plan.
const COLUMNS: [&str; 9] = ["place", "tile", "x_mm", "y_mm", "z_mm", "up", "mark", "mark_deg", "laid"];

/// The name of a shim tile in the plan: it is not in the box.
pub(crate) const SHIM: &str = "shim";

/// Decimals of angles of marks, in degrees.
const ANGLE_DECIMALS: f64 = 1e6;

/// A line of the plan.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PlanRow {
    /// Name of the place: of the tile of the layout.
    pub(crate) place: String,
    /// Name of the measured tile.
    pub(crate) tile: String,
    pub(crate) centre_mm: DVec3,
    /// The side of the measured tile that is up.
    pub(crate) up: &'static str,
    /// The axis of the measured tile that a mark on it shows.
    pub(crate) mark: &'static str,
    /// Where this axis points, from the x axis of the film towards its y axis, from 0 to below 360.
    pub(crate) mark_deg: f64,
    /// Whether the tile lies already.
    pub(crate) is_laid: bool,
}

impl PlanRow {
    /// The line of a tile that is, or will be, where `lies` is.
    pub(crate) fn new(place: &str, tile: &str, orientation: Orientation, lies: &Tile, is_laid: bool) -> PlanRow {
        PlanRow {
            place: place.to_owned(),
            tile: tile.to_owned(),
            centre_mm: lies.position(),
            up: upper_side(orientation),
            mark: ["+x", "+y", "+z"][orientation.mark_axis()],
            mark_deg: rounded(mark_deg(orientation, lies)),
            is_laid,
        }
    }

    /// Whether the side that is up when the tile is measured is up.
    #[cfg(feature = "report")]
    pub(crate) fn is_upright(&self) -> bool {
        self.up == "+z"
    }
}

/// The name of the side of the measured tile that is up.
pub(crate) fn upper_side(orientation: Orientation) -> &'static str {
    let (axis, is_down) = orientation.upper_side();
    [["+x", "-x"], ["+y", "-y"], ["+z", "-z"]][axis][usize::from(is_down)]
}

/// Where the mark of a tile points at a place, from the x axis of the film towards its y axis, from 0 to
/// below 360 degrees.
pub(crate) fn mark_deg(orientation: Orientation, place: &Tile) -> f64 {
    let along = place.rotation() * orientation.mark_direction();
    along.y.atan2(along.x).to_degrees().rem_euclid(360.0)
}

/// Without round-off.
fn rounded(angle_deg: f64) -> f64 {
    ((angle_deg * ANGLE_DECIMALS).round() / ANGLE_DECIMALS).rem_euclid(360.0)
}

/// The plan as CSV, which `--placed` reads.
pub(crate) fn csv(rows: &[PlanRow]) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut write = |row: &[String]| writer.write_record(row).expect("memory takes every row");
    write(&COLUMNS.map(str::to_owned));
    for row in rows {
        let mut cells = vec![row.place.clone(), row.tile.clone()];
        cells.extend(row.centre_mm.to_array().map(|value| twelve_digits(value).to_string()));
        cells.extend([row.up.to_owned(), row.mark.to_owned(), row.mark_deg.to_string()]);
        cells.push(if row.is_laid { "yes" } else { "no" }.to_owned());
        write(&cells);
    }
    let bytes = writer.into_inner().expect("memory takes every row");
    String::from_utf8(bytes).expect("text is written as text")
}
