//! The tiles from above: how far recoil weakens and turns each of them.

use glam::DVec3;
use magsplice::layout::NamedTile;
use magsplice::recoil::TileChange;
use plotters::prelude::RGBColor;

use crate::colours::{ColourScale, Palette, plotters_colour};
use crate::error::DrawError;
use crate::panel::{AxisLabel, BELOW_PX, LEFT_PX, Panel, equal_scale};
use crate::sheet::sheet;
use crate::tile_shapes::{bounds, from_above};

use super::field_maps::csv_row;

/// Name of the figure in files and errors.
pub(crate) const NAME: &str = "recoil";

/// What the figure shows.
pub(crate) const CAPTION: &str = "The tiles from above. Left: by how much their own field and that of the others weakens \
    the mean polarization of each. Right: by what angle it turns it.";

/// Largest width and height of one of the two panels, in pixels.
const ROOM_PX: [f64; 2] = [400.0, 400.0];
/// Distance from one panel to the next, with the colour bar between.
const GAP_PX: f64 = 120.0;
/// Width of the colour bar of the right panel, with its numbers.
const BAR_PX: f64 = 90.0;
const TOP_PX: f64 = 34.0;
/// Empty space around the tiles, as a fraction of the longer side.
const MARGIN: f64 = 0.03;

const OUTLINE: RGBColor = RGBColor(70, 70, 70);

/// The figure as SVG. Each tile has its change.
pub(crate) fn draw(tiles: &[&NamedTile], changes: &[TileChange]) -> Result<String, DrawError> {
    let [low, high] = bounds(tiles.iter().map(|named| &named.tile)).unwrap_or([DVec3::ZERO, DVec3::ONE]);
    let margin = MARGIN * (high - low).truncate().max_element();
    let (x, y) = ([low.x - margin, high.x + margin], [low.y - margin, high.y + margin]);
    let [width, height] = equal_scale(ROOM_PX, [x, y].map(|[low, high]| high - low));
    let left = Panel { left: LEFT_PX + 6.0, top: TOP_PX, width, height, x, y };
    let right = Panel { left: left.right() + GAP_PX, ..left };
    let size = [right.right() + 12.0 + BAR_PX, left.bottom() + BELOW_PX + 6.0];
    sheet(size, |sheet| {
        left.title(sheet, 0, "weakening")?;
        right.title(sheet, 1, "turn")?;
        let weakening: Vec<f64> = changes.iter().map(|change| 100.0 * change.weakening).collect();
        let turn_deg: Vec<f64> = changes.iter().map(|change| change.angle.to_degrees()).collect();
        let bars = [("weakening (%)", weakening), ("turn (\u{b0})", turn_deg)];
        for ((panel, label), (name, values)) in
            [(left, AxisLabel::Coordinate("y")), (right, AxisLabel::TicksOnly)].into_iter().zip(bars)
        {
            let [least, most] =
                [values.iter().copied().fold(0.0, f64::min), values.iter().copied().fold(0.0, f64::max)];
            let scale = ColourScale { low: least, high: most.max(f64::MIN_POSITIVE), palette: Palette::Sequential };
            let map = scale.mapper();
            for (named, value) in tiles.iter().zip(values) {
                let outline: Vec<[f64; 2]> =
                    from_above(&named.tile).into_iter().map(|corner| panel.at(corner.x, corner.y)).collect();
                sheet.fill(&outline, plotters_colour(map.colour(value)))?;
                sheet.outline(&outline, OUTLINE, 0.7)?;
            }
            panel.axes(sheet, AxisLabel::Coordinate("x"), label)?;
            panel.colour_bar(sheet, 12.0, scale, name)?;
        }
        Ok(())
    })
}

/// The changes as CSV, with the mean J in the frame of the film.
pub(crate) fn csv(tiles: &[&NamedTile], changes: &[TileChange]) -> String {
    let mut csv = "name,x_mm,y_mm,z_mm,weakening_percent,turn_deg,mean_j_x_t,mean_j_y_t,mean_j_z_t\n".to_owned();
    for (named, change) in tiles.iter().zip(changes) {
        csv += &format!("\"{}\",", named.name.replace('"', "\"\""));
        let numbers = [100.0 * change.weakening, change.angle.to_degrees()];
        let of_tile = named.tile.position().to_array().into_iter().chain(numbers);
        csv_row(&mut csv, of_tile.chain(change.mean_polarization_t.to_array()));
    }
    csv
}
