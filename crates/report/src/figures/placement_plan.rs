//! The plan by which a film is placed: each place from above, with the name of its tile and its
//! mark.

use glam::DVec2;
use magsplice::making::PlanRow;
use magsplice::prelude::Tile;
use magsplice::results::FilmAssignment;
use plotters::prelude::RGBColor;

use crate::csv::{csv, quoted};
use crate::drawing::{Drawing, FigureDraft, SvgText};
use crate::error::{DrawError, ReportError};
use crate::marks::{arrow, hollow_arrow};
use crate::panel::{BELOW_PX, Panel};
use crate::sheet::{DrawResult, INK, LETTERS, Sheet, rectangle, sheet};

use super::film_panel::{
    MARGIN, OUTLINE, ROOM_PX, TOP_PX, film_axes, film_bounds, film_panel, outline, tile_count, top_mm, upwards,
};
use super::tile_annotations::{Annotations, TileOnSheet, annotations, arrow_width};

/// Width of the legend at the right of the drawing, in pixels.
const LEGEND_PX: f64 = 200.0;
/// Length of an arrow in the legend, in pixels.
const LEGEND_ARROW_PX: f64 = 36.0;

/// Tiles to place, tiles to place that are turned over or stand on another side, and placed tiles.
const TO_PLACE: RGBColor = RGBColor(247, 243, 232);
const TURNED_OVER: RGBColor = RGBColor(198, 219, 239);
const PLACED: RGBColor = RGBColor(215, 215, 215);

/// A tile of a plan.
struct DrawnTile<'a> {
    /// Name of the tile that lies or will lie there.
    name: &'a str,
    /// The tile in its place, in millimetres.
    tile: &'a Tile,
    /// Direction of the mark on the tile, from x towards y, in radians.
    mark_rad: f64,
    /// Whether the side with the mark is up.
    is_upright: bool,
    /// Whether the tile is already placed.
    is_placed: bool,
}

/// The plan of a film from above.
///
/// # Errors
/// [`ReportError::Drawing`] if the figure cannot be drawn.
pub fn placement_plan_figure(assigned: &FilmAssignment, text: SvgText) -> Result<Drawing, ReportError> {
    let caption = "The place of each measured tile, from above. The arrow is the mark on the tile. A hollow arrow is a \
                   mark on another side than the upper.";
    let rows = assigned.plan.iter().zip(&assigned.tiles);
    let drawn = rows.map(|(row, tile)| DrawnTile {
        name: &row.tile,
        tile,
        mark_rad: row.mark_deg.to_radians(),
        is_upright: row.is_upright(),
        is_placed: row.is_placed,
    });
    let tiles: Vec<DrawnTile> = drawn.collect();
    // The columns of a plan, which `assign --placed` reads.
    let row = |row: &PlanRow| {
        let placed = if row.is_placed { "yes" } else { "no" };
        let texts = [&quoted(&row.place), &quoted(&row.tile), row.up, row.mark, placed].map(|text| format!("{text},"));
        let [x, y, z] = row.centre_mm.to_array();
        (texts.concat(), [x, y, z, row.mark_deg])
    };
    let csv = csv("place,tile,up,mark,placed,x_mm,y_mm,z_mm,mark_deg", assigned.plan.iter().map(row));
    FigureDraft::new("placement-plan", caption, draw(&tiles), csv)?.rendered(text)
}

fn draw(tiles: &[DrawnTile]) -> Result<String, DrawError> {
    let [low, high] = film_bounds(tiles.iter().map(|drawn| drawn.tile));
    let margin = MARGIN * (high - low).truncate().max_element();
    let panel = film_panel([low - margin, high + margin], ROOM_PX);
    let size = [panel.right() + LEGEND_PX, (panel.bottom() + BELOW_PX + 6.0).max(300.0)];
    sheet(size, |sheet| {
        let order = upwards(tiles, |drawn| top_mm(drawn.tile));
        let on_sheet: Vec<TileOnSheet> = order.iter().map(|drawn| on_sheet(&panel, drawn)).collect();
        let Annotations { of_tiles, arrow_px } = annotations(&on_sheet, &[]);
        let nameless = of_tiles.iter().filter(|place| place.name.is_none()).count();
        for ((drawn, place), TileOnSheet { outline, .. }) in order.into_iter().zip(&of_tiles).zip(&on_sheet) {
            let outline: Vec<[f64; 2]> = outline.iter().map(DVec2::to_array).collect();
            sheet.shape(&outline, colour(drawn), OUTLINE, 0.9)?;
            mark(sheet, [place.arrow - place.half, place.arrow + place.half], arrow_px, drawn.is_upright)?;
            place.write_name(sheet, drawn.name, INK)?;
        }
        film_axes(sheet, &panel)?;
        legend(sheet, tiles, panel.right() + 24.0, nameless)
    })
}

fn on_sheet(panel: &Panel, drawn: &DrawnTile) -> TileOnSheet {
    let outline = outline(panel, drawn.tile).into_iter().map(DVec2::from).collect();
    let (sine, cosine) = drawn.mark_rad.sin_cos();
    // y grows upwards in the film and downwards on the sheet.
    let in_plane = Some(DVec2::new(cosine, -sine));
    TileOnSheet { outline, in_plane, mark: 0.0, letters: drawn.name.chars().count() }
}

fn colour(drawn: &DrawnTile) -> RGBColor {
    match (drawn.is_placed, drawn.is_upright) {
        (true, _) => PLACED,
        (_, true) => TO_PLACE,
        (_, false) => TURNED_OVER,
    }
}

/// Draws the mark of a tile from its tail to its tip. The longest mark has the length `arrow_px`.
fn mark(sheet: &Sheet, ends: [DVec2; 2], arrow_px: f64, is_upright: bool) -> DrawResult {
    let [tail, tip] = ends.map(|p| p.to_array());
    let draw = if is_upright { arrow } else { hollow_arrow };
    draw(sheet, tail, tip, arrow_width(arrow_px), INK)
}

fn legend(sheet: &Sheet, tiles: &[DrawnTile], left: f64, nameless: usize) -> DrawResult {
    let mut y = TOP_PX + 12.0;
    sheet.text([left, y], &tile_count(tiles.len()), LETTERS)?;
    y += 28.0;
    for (is_upright, text) in [(true, "mark of the tile"), (false, "mark on a lower side")] {
        if tiles.iter().any(|drawn| drawn.is_upright == is_upright) {
            let ends = [DVec2::new(left, y), DVec2::new(left + LEGEND_ARROW_PX, y)];
            mark(sheet, ends, LEGEND_ARROW_PX, is_upright)?;
            sheet.text([left + LEGEND_ARROW_PX + 10.0, y], text, LETTERS)?;
            y += 26.0;
        }
    }
    for (colour_of, text) in [(TO_PLACE, "upright"), (TURNED_OVER, "turned over"), (PLACED, "already placed")] {
        if tiles.iter().any(|drawn| colour(drawn) == colour_of) {
            sheet.shape(&rectangle([left, y - 8.0], [left + 24.0, y + 8.0]), colour_of, OUTLINE, 0.9)?;
            sheet.text([left + 34.0, y], text, LETTERS)?;
            y += 26.0;
        }
    }
    if nameless > 0 {
        for line in [format!("{nameless} without room"), "for the name".to_owned()] {
            sheet.text([left, y], &line, LETTERS)?;
            y += 20.0;
        }
    }
    Ok(())
}
