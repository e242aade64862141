//! The tiles from above: how far recoil weakens and turns each of them.

use magsplice::layout::NamedTile;
use magsplice::recoil::TileChange;

use crate::colours::{ColourScale, Palette, plotters_colour};
use crate::csv::{csv, quoted};
use crate::drawing::FigureDraft;
use crate::error::{DrawError, ReportError};
use crate::panel::{AxisLabel, BAR_PX, BELOW_PX};
use crate::sheet::sheet;

use super::film_panel::{MARGIN, OUTLINE, outline, two_panels};

const CAPTION: &str = "The tiles from above. Left: how much the fields of all tiles weaken the mean polarization \
    of each. Right: the angle by which they turn it.";

/// Largest width and height of one of the two panels, in pixels.
const ROOM_PX: [f64; 2] = [400.0, 400.0];
/// Distance of the panels from the upper side of the sheet, and from each other with the colour bar
/// between.
const TOP_AND_GAP_PX: [f64; 2] = [34.0, 120.0];

/// The figure. Each tile has its change.
pub(crate) fn draft(tiles: &[&NamedTile], changes: &[TileChange]) -> Result<FigureDraft, ReportError> {
    let row = |(named, change): (&&NamedTile, &TileChange)| {
        let numbers = [100.0 * change.weakening, change.angle.to_degrees()];
        let of_tile = named.tile.position().to_array().into_iter().chain(numbers);
        (quoted(&named.name) + ",", of_tile.chain(change.mean_polarization_t.to_array()))
    };
    let header = "name,x_mm,y_mm,z_mm,weakening_percent,turn_deg,mean_j_x_t,mean_j_y_t,mean_j_z_t";
    FigureDraft::new("recoil", CAPTION, draw(tiles, changes), csv(header, tiles.iter().zip(changes).map(row)))
}

fn draw(tiles: &[&NamedTile], changes: &[TileChange]) -> Result<String, DrawError> {
    let [left, right] = two_panels(tiles.iter().map(|named| &named.tile), ROOM_PX, TOP_AND_GAP_PX, MARGIN);
    let size = [right.right() + 12.0 + BAR_PX, left.bottom() + BELOW_PX + 6.0];
    sheet(size, |sheet| {
        left.title(sheet, 0, "weakening")?;
        right.title(sheet, 1, "turn")?;
        let weakening: Vec<f64> = changes.iter().map(|change| 100.0 * change.weakening).collect();
        let turn_deg: Vec<f64> = changes.iter().map(|change| change.angle.to_degrees()).collect();
        for (panel, y, name, values) in [
            (left, AxisLabel::Coordinate("y"), "weakening (%)", weakening),
            (right, AxisLabel::TicksOnly, "turn (\u{b0})", turn_deg),
        ] {
            let [low, high] = [f64::min, f64::max].map(|of| values.iter().copied().fold(0.0, of));
            let scale = ColourScale { low, high: high.max(f64::MIN_POSITIVE), palette: Palette::Sequential };
            let map = scale.mapper();
            for (named, value) in tiles.iter().zip(values) {
                sheet.shape(&outline(&panel, &named.tile), plotters_colour(map.colour(value)), OUTLINE, 0.7)?;
            }
            panel.axes(sheet, AxisLabel::Coordinate("x"), y)?;
            panel.colour_bar(sheet, 12.0, scale, name)?;
        }
        Ok(())
    })
}
