//! The tiles seen from above, with their polarization and their names (Dai 2024, Fig. 5).

use glam::{DVec2, DVec3};
use magsplice::layout::{Layout, NamedTile, WorkingVolume};
use plotters::prelude::RGBColor;

use crate::colours::{DirectionColours, light};
use crate::drawing::{Drawing, SvgText};
use crate::error::{DrawError, ReportError};
use crate::marks::{BRACKET_WIDTH_PX, VANISHING, arrow, bracket_arms, corner_brackets, out_of_plane_mark};
use crate::panel::{AxisLabel, BELOW_PX, LEFT_PX, Panel};
use crate::shared_ranges::SharedRanges;
use crate::sheet::{DrawResult, INK, LETTERS, Lettering, Sheet, sheet};
use crate::survey::tiles_to_draw;
use crate::tile_shapes::{bounds, from_above};
use crate::typeset::{self, plain};

use super::field_maps::csv_row;
use super::layout_legend::LayoutLegend;
use super::tile_annotations::{Annotation, Annotations, Rectangle, TileOnSheet, annotations, arrow_width};

/// Length of the longer side of the drawing, in pixels.
const ROOM_PX: f64 = 740.0;
/// Width of the legend at its right, in pixels.
const LEGEND_PX: f64 = 190.0;
const TOP_PX: f64 = 14.0;
/// Empty space around the tiles, as a fraction of the longer side.
const MARGIN: f64 = 0.03;
/// Minimum of half the shorter side, as a fraction of the longer side.
const MIN_HALF_SIDE: f64 = 0.06;

/// Maximum radius of the mark for a polarization out of the plane, in pixels: alone, and at the
/// tail of an arrow, which it must not hide.
const MARK_PX: f64 = 12.0;
const MARK_AT_TAIL_PX: f64 = 6.0;
/// Maximum length of the arms of the brackets at the corners of the working volume, in pixels.
const BRACKET_PX: f64 = 12.0;

/// Name of the figure in files and errors.
pub(crate) const NAME: &str = "layout";

/// What the figure shows.
pub(crate) const CAPTION: &str = "The tiles seen from above, with their polarization and their names.";

/// The tiles of a layout from above.
///
/// # Errors
/// [`ReportError::Drawing`] if the figure cannot be drawn.
pub fn layout_figure(layout: &Layout, text: SvgText) -> Result<Drawing, ReportError> {
    let centre_mm = layout.volume.as_ref().map_or(DVec3::ZERO, |volume| volume.reference_mm);
    let tiles = tiles_to_draw(&layout.tiles, centre_mm);
    let drawn = draw(&tiles, layout.tiles.len(), layout.volume.as_ref(), &SharedRanges::default())
        .and_then(|svg| Drawing::new(NAME, CAPTION.to_owned(), &svg, csv(&tiles), text, &typeset::options()));
    drawn.map_err(|source| ReportError::Drawing { figure: NAME, source })
}

/// The figure as SVG. `tiles` are the ones drawn, `all` is the number of tiles of the layout.
pub(crate) fn draw(
    tiles: &[&NamedTile],
    all: usize,
    volume: Option<&WorkingVolume>,
    ranges: &SharedRanges,
) -> Result<String, DrawError> {
    let most_t = tiles.iter().map(|named| named.tile.polarization_t().length()).fold(0.0, f64::max);
    let [low, high] = bounds(tiles.iter().map(|named| &named.tile)).unwrap_or([DVec3::ZERO, DVec3::ONE]);
    let (low, high) = match volume {
        Some(v) => (low.min(v.lower_mm), high.max(v.upper_mm)),
        None => (low, high),
    };
    let [x, y] = [("layout x", 0), ("layout y", 1)].map(|(key, axis)| ranges.widened(key, [low[axis], high[axis]]));
    let (low, high) = (DVec3::new(x[0], y[0], low.z), DVec3::new(x[1], y[1], high.z));
    let (longest, middle) = ((high - low).truncate().max_element(), 0.5 * (low + high));
    let half = (0.5 * (high - low)).max(DVec3::splat(MIN_HALF_SIDE * longest)) + MARGIN * longest;
    let (low, high) = (middle - half, middle + half);
    let extents = [high.x - low.x, high.y - low.y];
    let per_mm = ROOM_PX / extents[0].max(extents[1]);
    let panel = Panel {
        left: LEFT_PX + 6.0,
        top: TOP_PX,
        width: per_mm * extents[0],
        height: per_mm * extents[1],
        x: [low.x, high.x],
        y: [low.y, high.y],
    };
    let size = [panel.right() + LEGEND_PX, (panel.bottom() + BELOW_PX + 6.0).max(470.0)];
    sheet(size, |sheet| {
        let painter = TilePainter { panel, most_t, directions: DirectionColours::new() };
        // From the lowest to the highest, so that upper tiles cover lower ones.
        let mut order: Vec<&NamedTile> = tiles.to_vec();
        let top = |named: &&NamedTile| bounds(std::iter::once(&named.tile)).map_or(0.0, |[_, high]| high.z);
        order.sort_by(|a, b| top(a).total_cmp(&top(b)));
        let prefix = common_prefix(tiles);
        let corners = volume.map(|v| [panel.at(v.lower_mm.x, v.upper_mm.y), panel.at(v.upper_mm.x, v.lower_mm.y)]);
        let marks = corners.map_or(Vec::new(), |[upper_left, lower_right]| {
            bracket_arms(upper_left, lower_right, BRACKET_PX)
                .map(|[from, to]| Rectangle::of_line(from, to, BRACKET_WIDTH_PX))
                .to_vec()
        });
        let on_sheet: Vec<TileOnSheet> = order.iter().map(|named| painter.on_sheet(named, prefix)).collect();
        let Annotations { of_tiles: places, arrow_px } = annotations(&on_sheet, &marks);
        let mut nameless = places.iter().filter(|place| place.name.is_none()).count();
        // Names on a minority of the tiles would confuse, so then no tile has one.
        if 2 * nameless > tiles.len() {
            nameless = tiles.len();
        }
        for ((named, place), TileOnSheet { mark, .. }) in order.into_iter().zip(&places).zip(&on_sheet) {
            painter.body(sheet, named)?;
            painter.polarization(sheet, named, place, arrow_px, *mark)?;
            if let Some(name) = place.name.as_ref().filter(|_| nameless < tiles.len()) {
                let text = plain(without_prefix(named, prefix));
                let letters = LETTERS.sized(name.size).centred();
                let letters = Lettering { upright: name.upright, colour: RGBColor(50, 50, 50), ..letters };
                sheet.text(name.at.to_array(), &text, letters)?;
            }
        }
        if let Some([upper_left, lower_right]) = corners {
            corner_brackets(sheet, upper_left, lower_right, BRACKET_PX)?;
        }
        panel.axes(sheet, AxisLabel::Coordinate("x"), AxisLabel::Coordinate("y"))?;
        let names = match nameless {
            0 if prefix.is_empty() => Vec::new(),
            0 => vec![format!("Tiles: {}\u{2026}", plain(prefix))],
            n if n == tiles.len() => vec!["Tiles too small for".to_owned(), "their names".to_owned()],
            n => vec![format!("Tiles: {}\u{2026}", plain(prefix)), format!("({n} without room for it)")],
        };
        let legend = LayoutLegend {
            left: panel.right() + 24.0,
            top: TOP_PX,
            arrow_px,
            most_t,
            tiles,
            all,
            volume: volume.is_some(),
            names: &names,
        };
        legend.draw(sheet, &painter.directions)
    })
}

/// The tiles as CSV, with J in the frame of the film.
pub(crate) fn csv(tiles: &[&NamedTile]) -> String {
    let mut csv = "name,x_mm,y_mm,z_mm,size_x_mm,size_y_mm,size_z_mm,j_x_t,j_y_t,j_z_t\n".to_owned();
    for NamedTile { name, tile, .. } in tiles {
        // A name is quoted as CSV asks.
        csv += &format!("\"{}\",", name.replace('"', "\"\""));
        let numbers = [tile.position(), tile.size(), tile.scene_polarization_t()];
        csv_row(&mut csv, numbers.into_iter().flat_map(|vector| vector.to_array()));
    }
    csv
}

/// Draws tiles into a panel.
struct TilePainter {
    panel: Panel,
    most_t: f64,
    directions: DirectionColours,
}

impl TilePainter {
    /// The position of a point on the sheet, in pixels.
    fn px(&self, p: DVec2) -> [f64; 2] {
        self.panel.at(p.x, p.y)
    }

    /// Draws the outline, filled with the colour of the polarization's direction.
    fn body(&self, sheet: &Sheet, named: &NamedTile) -> DrawResult {
        let outline: Vec<[f64; 2]> = from_above(&named.tile).into_iter().map(|p| self.px(p)).collect();
        sheet.fill(&outline, light(self.directions.colour(named.tile.scene_polarization_t())))?;
        let width = if self.panel.px_per_x() * named.tile.size().min_element() < 3.0 { 0.3 } else { 0.9 };
        sheet.outline(&outline, RGBColor(70, 70, 70), width)
    }

    /// The shape of a tile on the sheet, and what its annotation consists of.
    fn on_sheet(&self, named: &NamedTile, prefix: &str) -> TileOnSheet {
        let outline: Vec<DVec2> = from_above(&named.tile).into_iter().map(|p| DVec2::from(self.px(p))).collect();
        let low = outline.iter().copied().fold(DVec2::MAX, DVec2::min);
        let high = outline.iter().copied().fold(DVec2::MIN, DVec2::max);
        let j = named.tile.scene_polarization_t() / self.most_t;
        // y grows upwards in the film and downwards on the sheet.
        let in_plane = DVec2::new(j.x, -j.y);
        let narrow = (high - low).min_element();
        let in_plane = (in_plane.length() > VANISHING).then_some(in_plane);
        let most = if in_plane.is_some() { MARK_AT_TAIL_PX } else { MARK_PX };
        let mark = if j.z.abs() > VANISHING { (0.12 * narrow).clamp(1.0, most) * j.z.abs().sqrt() } else { 0.0 };
        TileOnSheet { outline, in_plane, mark, letters: without_prefix(named, prefix).chars().count() }
    }

    /// Draws the arrow, and the mark for the component out of the plane at its tail.
    fn polarization(
        &self,
        sheet: &Sheet,
        named: &NamedTile,
        place: &Annotation,
        arrow_px: f64,
        mark: f64,
    ) -> DrawResult {
        let (tail, tip) = (place.arrow - place.half, place.arrow + place.half);
        arrow(sheet, tail.to_array(), tip.to_array(), arrow_width(arrow_px), INK)?;
        if mark > 0.0 {
            out_of_plane_mark(sheet, tail.to_array(), mark, named.tile.scene_polarization_t().z > 0.0)?;
        }
        Ok(())
    }
}

/// The name of a tile without the common prefix.
fn without_prefix<'a>(named: &'a NamedTile, prefix: &str) -> &'a str {
    named.name.strip_prefix(prefix).unwrap_or(&named.name)
}

/// The longest prefix of all names that ends with a hyphen. The tiles are labelled without it.
fn common_prefix<'a>(tiles: &[&'a NamedTile]) -> &'a str {
    let Some((first, rest)) = tiles.split_first() else { return "" };
    let hyphens = first.name.match_indices('-').map(|(at, _)| &first.name[..=at]);
    let shared = |prefix: &&str| rest.iter().all(|named| named.name.starts_with(prefix));
    if rest.is_empty() { "" } else { hyphens.take_while(shared).last().unwrap_or("") }
}
