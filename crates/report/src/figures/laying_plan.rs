//! The plan by which a film is laid: each place from above, with the name of its tile and its mark.

use glam::{DVec2, DVec3};
use magsplice::prelude::Tile;
use magsplice::results::FilmAssignment;
use plotters::prelude::RGBColor;

use crate::drawing::{Drawing, SvgText};
use crate::error::{DrawError, ReportError};
use crate::marks::{arrow, hollow_arrow};
use crate::panel::{AxisLabel, BELOW_PX, LEFT_PX, Panel};
use crate::sheet::{DrawResult, INK, LETTERS, Lettering, Sheet, sheet};
use crate::tile_shapes::{bounds, from_above};
use crate::typeset::{self, plain};

use super::field_maps::csv_row;
use super::tile_annotations::{Annotation, Annotations, TileOnSheet, annotations, arrow_width};

/// Name of the figure in files and errors.
const NAME: &str = "laying-plan";

/// Length of the longer side of the drawing, in pixels.
const ROOM_PX: f64 = 740.0;
/// Width of the legend at its right, in pixels.
const LEGEND_PX: f64 = 200.0;
const TOP_PX: f64 = 14.0;
/// Empty space around the tiles, as a fraction of the longer side.
const MARGIN: f64 = 0.03;
/// Length of an arrow in the legend, in pixels.
const LEGEND_ARROW_PX: f64 = 36.0;

/// Tiles to lay, tiles to lay that are turned over or stand on another side, and tiles that lie.
const TO_LAY: RGBColor = RGBColor(247, 243, 232);
const TURNED_OVER: RGBColor = RGBColor(198, 219, 239);
const LAID: RGBColor = RGBColor(215, 215, 215);

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
    /// Whether the tile lies already.
    is_laid: bool,
}

/// The plan of a film from above.
///
/// # Errors
/// [`ReportError::Drawing`] if the figure cannot be drawn.
pub fn laying_plan_figure(assigned: &FilmAssignment, text: SvgText) -> Result<Drawing, ReportError> {
    let caption =
        "Where each measured tile goes, from above. The arrow is the mark on the tile. A hollow arrow is a mark \
                   that is not on the upper side."
            .to_owned();
    let rows = assigned.plan.iter().zip(&assigned.tiles);
    let drawn = rows.map(|(row, tile)| DrawnTile {
        name: &row.tile,
        tile,
        mark_rad: row.mark_deg.to_radians(),
        is_upright: row.is_upright(),
        is_laid: row.is_laid,
    });
    let tiles: Vec<DrawnTile> = drawn.collect();
    let drawn = draw(&tiles).and_then(|svg| Drawing::new(NAME, caption, &svg, csv(&tiles), text, &typeset::options()));
    drawn.map_err(|source| ReportError::Drawing { figure: NAME, source })
}

fn draw(tiles: &[DrawnTile]) -> Result<String, DrawError> {
    let [low, high] = bounds(tiles.iter().map(|laid| laid.tile)).unwrap_or([DVec3::ZERO, DVec3::ONE]);
    let longest = (high - low).truncate().max_element();
    let (low, high) = (low - MARGIN * longest, high + MARGIN * longest);
    let per_mm = ROOM_PX / (high - low).truncate().max_element();
    let panel = Panel {
        left: LEFT_PX + 6.0,
        top: TOP_PX,
        width: per_mm * (high.x - low.x),
        height: per_mm * (high.y - low.y),
        x: [low.x, high.x],
        y: [low.y, high.y],
    };
    let size = [panel.right() + LEGEND_PX, (panel.bottom() + BELOW_PX + 6.0).max(300.0)];
    sheet(size, |sheet| {
        // From the lowest to the highest, so that upper tiles cover lower ones.
        let mut order: Vec<&DrawnTile> = tiles.iter().collect();
        let top = |laid: &&DrawnTile| bounds(std::iter::once(laid.tile)).map_or(0.0, |[_, high]| high.z);
        order.sort_by(|a, b| top(a).total_cmp(&top(b)));
        let on_sheet: Vec<TileOnSheet> = order.iter().map(|laid| on_sheet(&panel, laid)).collect();
        let Annotations { of_tiles, arrow_px } = annotations(&on_sheet, &[]);
        let nameless = of_tiles.iter().filter(|place| place.name.is_none()).count();
        for ((laid, place), TileOnSheet { outline, .. }) in order.into_iter().zip(&of_tiles).zip(&on_sheet) {
            let outline: Vec<[f64; 2]> = outline.iter().map(DVec2::to_array).collect();
            sheet.fill(&outline, colour(laid))?;
            sheet.outline(&outline, RGBColor(70, 70, 70), 0.9)?;
            mark(sheet, place, arrow_width(arrow_px), laid.is_upright)?;
            if let Some(name) = &place.name {
                let letters = LETTERS.sized(name.size).centred();
                sheet.text(name.at.to_array(), &plain(laid.name), Lettering { upright: name.upright, ..letters })?;
            }
        }
        panel.axes(sheet, AxisLabel::Coordinate("x"), AxisLabel::Coordinate("y"))?;
        legend(sheet, tiles, panel.right() + 24.0, nameless)
    })
}

fn on_sheet(panel: &Panel, laid: &DrawnTile) -> TileOnSheet {
    let outline = from_above(laid.tile).into_iter().map(|p| DVec2::from(panel.at(p.x, p.y))).collect();
    let (sine, cosine) = laid.mark_rad.sin_cos();
    // y grows upwards in the film and downwards on the sheet.
    let in_plane = Some(DVec2::new(cosine, -sine));
    TileOnSheet { outline, in_plane, mark: 0.0, letters: laid.name.chars().count() }
}

fn colour(laid: &DrawnTile) -> RGBColor {
    match (laid.is_laid, laid.is_upright) {
        (true, _) => LAID,
        (_, true) => TO_LAY,
        (_, false) => TURNED_OVER,
    }
}

fn mark(sheet: &Sheet, place: &Annotation, width: f64, is_upright: bool) -> DrawResult {
    let [tail, tip] = [place.arrow - place.half, place.arrow + place.half].map(|p| p.to_array());
    if is_upright { arrow(sheet, tail, tip, width, INK) } else { hollow_arrow(sheet, tail, tip, width, INK) }
}

fn legend(sheet: &Sheet, tiles: &[DrawnTile], left: f64, nameless: usize) -> DrawResult {
    let mut y = TOP_PX + 12.0;
    let count = if tiles.len() == 1 { "1 tile".to_owned() } else { format!("{} tiles", tiles.len()) };
    sheet.text([left, y], &count, LETTERS)?;
    y += 28.0;
    for (is_upright, text) in [(true, "mark of the tile"), (false, "mark on a lower side")] {
        if tiles.iter().any(|laid| laid.is_upright == is_upright) {
            let [tail, tip] = [[left, y], [left + LEGEND_ARROW_PX, y]];
            let width = arrow_width(LEGEND_ARROW_PX);
            if is_upright {
                arrow(sheet, tail, tip, width, INK)?;
            } else {
                hollow_arrow(sheet, tail, tip, width, INK)?;
            }
            sheet.text([left + LEGEND_ARROW_PX + 10.0, y], text, LETTERS)?;
            y += 26.0;
        }
    }
    for (colour_of, text) in [(TO_LAY, "upright"), (TURNED_OVER, "turned over"), (LAID, "lies already")] {
        if tiles.iter().any(|laid| colour(laid) == colour_of) {
            let corners = [[left, y - 8.0], [left + 24.0, y - 8.0], [left + 24.0, y + 8.0], [left, y + 8.0]];
            sheet.fill(&corners, colour_of)?;
            sheet.outline(&corners, RGBColor(70, 70, 70), 0.9)?;
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

/// The plan as CSV.
fn csv(tiles: &[DrawnTile]) -> String {
    let mut csv = "tile,x_mm,y_mm,z_mm,mark_deg,upright\n".to_owned();
    for laid in tiles {
        csv += &format!("\"{}\",", laid.name.replace('"', "\"\""));
        let numbers = laid.tile.position().to_array();
        csv_row(
            &mut csv,
            numbers.into_iter().chain([laid.mark_rad.to_degrees(), f64::from(u8::from(laid.is_upright))]),
        );
    }
    csv
}
