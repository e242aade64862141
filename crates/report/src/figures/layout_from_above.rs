//! The tiles seen from above, with their polarization and their names (Dai 2024, Fig. 5).

use glam::{DVec2, DVec3};
use magsplice::layout::{Layout, NamedTile, WorkingVolume};
use magsplice::results::IronSummary;
use plotters::prelude::RGBColor;

use crate::colours::{DirectionColours, light};
use crate::csv::{csv, quoted};
use crate::drawing::{Drawing, FigureDraft, SvgText};
use crate::error::{DrawError, ReportError};
use crate::marks::{BRACKET_WIDTH_PX, VANISHING, arrow, bracket_arms, corner_brackets, out_of_plane_mark, sensor_mark};
use crate::panel::{BELOW_PX, NUMBERS_PX, Panel};
use crate::shared_ranges::SharedRanges;
use crate::sheet::{DrawResult, INK, Sheet, sheet};
use crate::survey::tiles_to_draw;
use crate::typeset::plain;

use super::film_panel::{
    AXIS_PX, MARGIN, OUTLINE, ROOM_PX, TOP_PX, film_axes, film_bounds, film_panel, outline, top_mm, upwards,
};
use super::layout_legend::LayoutLegend;
use super::tile_annotations::{Annotation, Annotations, Rectangle, TileOnSheet, annotations, arrow_width};

/// Width of the legend at the right of the drawing, in pixels.
const LEGEND_PX: f64 = 190.0;
/// Most letters of the words for a plane in the legend.
const LONGEST_LINE: usize = 22;
/// Space at the right of a drawing without a legend there, in pixels.
const RIGHT_PX: f64 = 12.0;
/// Minimum of half the shorter side, as a fraction of the longer side.
const MIN_HALF_SIDE: f64 = 0.06;

/// Maximum radius of the mark for a polarization out of the plane, in pixels: alone, and at the
/// tail of an arrow, which it must not hide.
const MARK_PX: f64 = 12.0;
const MARK_AT_TAIL_PX: f64 = 6.0;
/// Maximum length of the arms of the brackets at the corners of the working volume, in pixels.
const BRACKET_PX: f64 = 12.0;

/// The tiles of a layout from above.
///
/// # Errors
/// [`ReportError::Drawing`] if the figure cannot be drawn.
pub fn layout_figure(layout: &Layout, text: SvgText) -> Result<Drawing, ReportError> {
    draft(layout, &tiles_to_draw(layout), &SharedRanges::default())?.rendered(text)
}

/// Name of the figure.
pub(crate) const NAME: &str = "layout";

/// The figure of these tiles of a layout.
pub(crate) fn draft(layout: &Layout, tiles: &[&NamedTile], ranges: &SharedRanges) -> Result<FigureDraft, ReportError> {
    of_width(layout, tiles, ranges, None)
}

/// The figure for a column of a page: `width_px` wide, with its legend below.
pub(crate) fn in_column(layout: &Layout, width_px: f64) -> Result<FigureDraft, ReportError> {
    of_width(layout, &tiles_to_draw(layout), &SharedRanges::default(), Some(width_px))
}

fn of_width(
    layout: &Layout,
    tiles: &[&NamedTile],
    ranges: &SharedRanges,
    column_px: Option<f64>,
) -> Result<FigureDraft, ReportError> {
    let caption = "The tiles seen from above, with their polarization and their names.";
    // The columns of `import`: sides and J along the axes of the tile.
    let row = |named: &&NamedTile| {
        let vectors = [named.tile.position(), named.tile.size(), named.tile.polarization_t()];
        let numbers = vectors.into_iter().flat_map(|vector| vector.to_array());
        (quoted(&named.name) + ",", numbers.chain(named.tile.rotation().to_array()))
    };
    let header = "name,x_mm,y_mm,z_mm,size_x_mm,size_y_mm,size_z_mm,jx_t,jy_t,jz_t,qx,qy,qz,qw";
    let around = Around { volume: layout.volume.as_ref(), sensors: sensors_mm(layout), iron: iron(layout) };
    let drawn = draw(tiles, layout.tiles.len(), &around, ranges, column_px);
    FigureDraft::new(NAME, caption, drawn, csv(header, tiles.iter().map(row)))
}

/// What is drawn of the things around the film.
struct Around<'a> {
    volume: Option<&'a WorkingVolume>,
    /// The places of the sensors of a head.
    sensors: Vec<DVec3>,
    /// Its iron in words.
    iron: Vec<String>,
}

/// The planes of iron in words that fit the legend.
fn iron(layout: &Layout) -> Vec<String> {
    let planes = IronSummary::of(layout).into_iter().flat_map(|iron| iron.planes().collect::<Vec<_>>());
    let short = |plane: String| match plane.split_once(", mu_r") {
        _ if plane.len() <= LONGEST_LINE => plane,
        _ if plane.starts_with("behind") => "an oblique plane".to_owned(),
        Some((place, _)) => place.to_owned(),
        None => plane,
    };
    planes.map(short).collect()
}

/// The places of the sensors of a head whose board is at the reference point. None for one sensor.
fn sensors_mm(layout: &Layout) -> Vec<DVec3> {
    let head = layout.sensor.as_ref().and_then(|sensor| sensor.head.as_ref());
    let places = layout
        .volume
        .as_ref()
        .zip(head)
        .map(|(volume, head)| head.sensors.elements.iter().map(|of| volume.reference_mm + of.place).collect());
    places.unwrap_or_default()
}

/// The figure as SVG. `tiles` are the ones drawn, `all` is the number of tiles of the layout. The
/// legend is at the right or, in a column of a page, below.
fn draw(
    tiles: &[&NamedTile],
    all: usize,
    Around { volume, sensors, iron }: &Around,
    ranges: &SharedRanges,
    column_px: Option<f64>,
) -> Result<String, DrawError> {
    let most_t = tiles.iter().map(|named| named.tile.polarization_t().length()).fold(0.0, f64::max);
    let [low, high] = film_bounds(tiles.iter().map(|named| &named.tile));
    let (low, high) = match volume {
        Some(v) => (low.min(v.lower_mm), high.max(v.upper_mm)),
        None => (low, high),
    };
    let (low, high) = sensors.iter().fold((low, high), |(low, high), place| (low.min(*place), high.max(*place)));
    let [x, y] = [("layout x", 0), ("layout y", 1)].map(|(key, axis)| ranges.widened(key, [low[axis], high[axis]]));
    let (low, high) = (DVec3::new(x[0], y[0], low.z), DVec3::new(x[1], y[1], high.z));
    let (longest, middle) = ((high - low).truncate().max_element(), 0.5 * (low + high));
    let half = (0.5 * (high - low)).max(DVec3::splat(MIN_HALF_SIDE * longest)) + MARGIN * longest;
    let across = half.x / half.truncate().max_element();
    let room_px = column_px.map_or(ROOM_PX, |width_px| (width_px - AXIS_PX - RIGHT_PX) / across);
    let panel = film_panel([middle - half, middle + half], room_px);
    let bottom = panel.bottom() + BELOW_PX + 6.0;
    let (size, legend_at) = match column_px {
        None => ([panel.right() + LEGEND_PX, bottom.max(470.0)], [panel.right() + 24.0, TOP_PX]),
        Some(width_px) => ([width_px, bottom + LayoutLegend::HEIGHT_PX], [AXIS_PX, bottom]),
    };
    sheet(size, |sheet| {
        let painter = TilePainter { panel, most_t, directions: DirectionColours::new() };
        let order = upwards(tiles, |named| top_mm(&named.tile));
        let prefix = common_prefix(tiles);
        let corners = volume.map(|v| [panel.at(v.lower_mm.x, v.upper_mm.y), panel.at(v.upper_mm.x, v.lower_mm.y)]);
        let marks = corners.map_or(Vec::new(), |[upper_left, lower_right]| {
            bracket_arms(upper_left, lower_right, BRACKET_PX)
                .map(|[from, to]| Rectangle::of_line(from, to, BRACKET_WIDTH_PX))
                .to_vec()
        });
        let mut on_sheet: Vec<TileOnSheet> = order.iter().map(|named| painter.on_sheet(named, prefix)).collect();
        let mut placed = annotations(&on_sheet, &marks);
        // In a column, names have the size of numbers or are omitted.
        let is_small = |place: &Annotation| place.name.as_ref().is_none_or(|name| name.size < NUMBERS_PX);
        if column_px.is_some() && placed.of_tiles.iter().any(is_small) {
            on_sheet.iter_mut().for_each(|tile| tile.letters = 0);
            placed = annotations(&on_sheet, &marks);
        }
        let Annotations { of_tiles: places, arrow_px } = placed;
        let mut nameless = places.iter().filter(|place| place.name.is_none()).count();
        // Names on a minority of the tiles would confuse, so then no tile has one.
        if 2 * nameless > tiles.len() {
            nameless = tiles.len();
        }
        for ((named, place), TileOnSheet { mark, .. }) in order.into_iter().zip(&places).zip(&on_sheet) {
            painter.body(sheet, named)?;
            painter.polarization(sheet, named, place, arrow_px, *mark)?;
            if nameless < tiles.len() {
                place.write_name(sheet, without_prefix(named, prefix), RGBColor(50, 50, 50))?;
            }
        }
        if let Some([upper_left, lower_right]) = corners {
            corner_brackets(sheet, upper_left, lower_right, BRACKET_PX)?;
        }
        for place in sensors {
            sensor_mark(sheet, panel.at(place.x, place.y))?;
        }
        film_axes(sheet, &panel)?;
        let names = match nameless {
            0 if prefix.is_empty() => Vec::new(),
            0 => vec![format!("Tiles: {}\u{2026}", plain(prefix))],
            n if n == tiles.len() => vec!["Tiles too small for".to_owned(), "their names".to_owned()],
            n => vec![format!("Tiles: {}\u{2026}", plain(prefix)), format!("({n} without room for it)")],
        };
        let legend = LayoutLegend {
            at: legend_at,
            is_below: column_px.is_some(),
            arrow_px,
            most_t,
            tiles,
            all,
            volume: volume.is_some(),
            sensors: sensors.len(),
            iron,
            names: &names,
        };
        legend.draw(sheet, &painter.directions)
    })
}

/// Draws tiles into a panel.
struct TilePainter {
    panel: Panel,
    most_t: f64,
    directions: DirectionColours,
}

impl TilePainter {
    /// Draws the outline, filled with the colour of the polarization's direction.
    fn body(&self, sheet: &Sheet, named: &NamedTile) -> DrawResult {
        let colour = light(self.directions.colour(named.tile.scene_polarization_t()));
        let width = if self.panel.px_per_x() * named.tile.size().min_element() < 3.0 { 0.3 } else { 0.9 };
        sheet.shape(&outline(&self.panel, &named.tile), colour, OUTLINE, width)
    }

    /// The shape of a tile on the sheet, and what its annotation consists of.
    fn on_sheet(&self, named: &NamedTile, prefix: &str) -> TileOnSheet {
        let outline: Vec<DVec2> = outline(&self.panel, &named.tile).into_iter().map(DVec2::from).collect();
        let around = Rectangle::of_points(outline.iter().copied());
        let j = named.tile.scene_polarization_t() / self.most_t;
        // y grows upwards in the film and downwards on the sheet.
        let in_plane = DVec2::new(j.x, -j.y);
        let narrow = around.size().min_element();
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
