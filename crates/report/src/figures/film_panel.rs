//! Panels that show the tiles of a film from above.

use glam::DVec3;
use magsplice::prelude::Tile;
use plotters::prelude::RGBColor;

use crate::panel::{AxisLabel, LEFT_PX, Panel, equal_scale};
use crate::sheet::{DrawResult, Sheet};
use crate::tile_shapes::{bounds, from_above};

/// Length of the longer side of the panel of a whole film, in pixels.
pub(super) const ROOM_PX: f64 = 740.0;
/// Distance of such a panel from the left side of the sheet, in pixels.
pub(super) const AXIS_PX: f64 = LEFT_PX + 6.0;
/// Distance of such a panel from the upper side of the sheet, in pixels.
pub(super) const TOP_PX: f64 = 14.0;
/// Empty space around the tiles, as a fraction of the longer side.
pub(super) const MARGIN: f64 = 0.03;
/// Colour of the outlines of tiles.
pub(super) const OUTLINE: RGBColor = RGBColor(70, 70, 70);

/// Lower and upper corner of all tiles.
pub(super) fn film_bounds<'a>(tiles: impl Iterator<Item = &'a Tile>) -> [DVec3; 2] {
    bounds(tiles).unwrap_or([DVec3::ZERO, DVec3::ONE])
}

/// The panel of a figure with one large panel, for points between these corners. Its longer side
/// has `room_px`.
pub(super) fn film_panel([low, high]: [DVec3; 2], room_px: f64) -> Panel {
    let per_mm = room_px / (high - low).truncate().max_element();
    let [width, height] = [per_mm * (high.x - low.x), per_mm * (high.y - low.y)];
    Panel { left: AXIS_PX, top: TOP_PX, width, height, x: [low.x, high.x], y: [low.y, high.y] }
}

/// Two panels beside each other which both show the tiles. `margin` is the empty space around them,
/// as a fraction of the longer side.
pub(super) fn two_panels<'a>(
    tiles: impl Iterator<Item = &'a Tile>,
    room_px: [f64; 2],
    [top, gap]: [f64; 2],
    margin: f64,
) -> [Panel; 2] {
    let [low, high] = film_bounds(tiles);
    let margin = margin * (high - low).truncate().max_element();
    let (x, y) = ([low.x - margin, high.x + margin], [low.y - margin, high.y + margin]);
    let [width, height] = equal_scale(room_px, [x, y].map(|[low, high]| high - low));
    let left = Panel { left: AXIS_PX, top, width, height, x, y };
    [left, Panel { left: left.right() + gap, ..left }]
}

/// The outline of a tile on the sheet.
pub(super) fn outline(panel: &Panel, tile: &Tile) -> Vec<[f64; 2]> {
    from_above(tile).into_iter().map(|corner| panel.at(corner.x, corner.y)).collect()
}

/// Draws the axes x and y with their numbers.
pub(super) fn film_axes(sheet: &Sheet, panel: &Panel) -> DrawResult {
    panel.axes(sheet, AxisLabel::Coordinate("x"), AxisLabel::Coordinate("y"))
}

/// From the lowest to the highest, so that upper tiles cover lower ones.
pub(super) fn upwards<T>(tiles: &[T], height_mm: impl Fn(&T) -> f64) -> Vec<&T> {
    let mut order: Vec<&T> = tiles.iter().collect();
    order.sort_by(|a, b| height_mm(a).total_cmp(&height_mm(b)));
    order
}

/// Height of the highest point of a tile, in millimetres.
pub(super) fn top_mm(tile: &Tile) -> f64 {
    film_bounds([tile].into_iter())[1].z
}

/// A number of tiles in words.
pub(super) fn tile_count(count: usize) -> String {
    if count == 1 { "1 tile".to_owned() } else { format!("{count} tiles") }
}
