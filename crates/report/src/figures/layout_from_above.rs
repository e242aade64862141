//! The tiles seen from above, with their polarization and their names (Dai 2024, Fig. 5).

use glam::{DVec2, DVec3};
use magsplice::layout::{NamedTile, WorkingVolume};
use plotters::prelude::RGBColor;

use crate::colours::{DirectionColours, light};
use crate::error::DrawError;
use crate::marks::{VANISHING, arrow, corner_brackets, out_of_plane_mark};
use crate::panel::{AxisLabel, BELOW_PX, LEFT_PX, Panel};
use crate::shared_ranges::SharedRanges;
use crate::sheet::{DrawResult, INK, LETTERS, Lettering, Sheet, sheet};
use crate::tile_shapes::{bounds, from_above};
use crate::typeset::plain;

use super::field_maps::csv_row;
use super::layout_legend::LayoutLegend;

/// Length of the longer side of the drawing, in pixels.
const ROOM_PX: f64 = 740.0;
/// Width of the legend at its right, in pixels.
const LEGEND_PX: f64 = 190.0;
const TOP_PX: f64 = 14.0;
/// Empty space around the tiles, as a fraction of the longer side.
const MARGIN: f64 = 0.03;
/// Minimum of half the shorter side, as a fraction of the longer side.
const MIN_HALF_SIDE: f64 = 0.06;

/// Minimum and maximum font size of names, in pixels. A name that needs a smaller one is omitted.
const NAME_PX: [f64; 2] = [7.5, 12.0];
/// Width of a letter as a fraction of the font size, chosen large.
const LETTER_WIDTH: f64 = 0.56;
/// How far an arrow may extend towards the name of its tile, as a fraction of the distance.
const TO_NAME: f64 = 0.75;
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
        let arrow_mm = painter.arrow_mm(tiles);
        let fits = |named: &NamedTile| painter.letters_px(named, prefix) >= NAME_PX[0];
        let mut nameless = tiles.iter().filter(|named| !fits(named)).count();
        // Names on a minority of the tiles would confuse, so then no tile has one.
        if 2 * nameless > tiles.len() {
            nameless = tiles.len();
        }
        for named in order {
            painter.body(sheet, named)?;
            painter.polarization(sheet, named, arrow_mm)?;
            if nameless < tiles.len() && fits(named) {
                painter.name(sheet, named, prefix)?;
            }
        }
        if let Some(v) = volume {
            let (l, u) = (v.lower_mm, v.upper_mm);
            corner_brackets(sheet, panel.at(l.x, u.y), panel.at(u.x, l.y), 12.0)?;
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
            arrow_px: arrow_mm * panel.px_per_x(),
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

/// Where the arrow and the name of a tile go. All lengths are in millimetres, seen from above.
struct Annotation {
    /// Centre of the arrow.
    arrow: DVec2,
    /// Centre of the name.
    name: DVec2,
    /// Whether the name runs upwards.
    upright: bool,
    /// The shorter side of the tile's bounding rectangle.
    narrow: f64,
    /// The side of the bounding rectangle along the name.
    long: f64,
    /// The fraction of the bounding rectangle that the tile fills.
    filled: f64,
}

impl Annotation {
    fn from_outline(outline: &[DVec2]) -> Annotation {
        let low = outline.iter().copied().fold(DVec2::MAX, DVec2::min);
        let high = outline.iter().copied().fold(DVec2::MIN, DVec2::max);
        let (middle, sides) = (0.5 * (low + high), high - low);
        let upright = sides.y > 1.3 * sides.x;
        let filled = area(outline) / (sides.x * sides.y);
        let aside = if upright { DVec2::new(sides.x, 0.0) } else { DVec2::new(0.0, -sides.y) };
        Annotation {
            arrow: middle - 0.15 * filled * aside,
            name: middle + 0.29 * filled * aside,
            upright,
            narrow: sides.min_element(),
            long: if upright { sides.y } else { sides.x },
            filled,
        }
    }
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

    /// The length of the arrow of the tile with the largest |J|, such that 95 % of the tiles have
    /// room for an arrow of this length.
    fn arrow_mm(&self, tiles: &[&NamedTile]) -> f64 {
        let mut rooms: Vec<f64> = tiles.iter().filter_map(|named| self.room_mm(named)).collect();
        rooms.sort_by(f64::total_cmp);
        rooms.get(rooms.len() / 20).map_or(1.0, |room| 0.8 * room)
    }

    /// Maximum length of the arrow of a tile; `None` for a tile whose J has no component in the
    /// plane.
    fn room_mm(&self, named: &NamedTile) -> Option<f64> {
        let direction = self.in_plane(named)?.normalize();
        let outline = from_above(&named.tile);
        let Annotation { arrow: centre, name, .. } = Annotation::from_outline(&outline);
        // The distance from the centre to each side, along the arrow in either direction.
        let to_sides = outline.iter().zip(outline.iter().cycle().skip(1)).filter_map(|(a, b)| {
            let normal = (*b - *a).perp();
            let approach = normal.dot(direction).abs();
            (approach > 1e-9 * normal.length()).then(|| normal.dot(centre - *a).abs() / approach)
        });
        // The distance to the name.
        let aside = name - centre;
        let approach = direction.dot(aside).abs();
        let to_name = if approach > 0.0 { TO_NAME * aside.length_squared() / approach } else { f64::INFINITY };
        Some(2.0 * to_sides.fold(to_name, f64::min))
    }

    /// J in the plane over the largest |J|; `None` if it vanishes.
    fn in_plane(&self, named: &NamedTile) -> Option<DVec2> {
        let j = named.tile.scene_polarization_t().truncate() / self.most_t;
        (j.length() > VANISHING).then_some(j)
    }

    /// Draws the arrow, and the mark for the component out of the plane at its tail.
    fn polarization(&self, sheet: &Sheet, named: &NamedTile, arrow_mm: f64) -> DrawResult {
        let Annotation { arrow: centre, narrow, .. } = Annotation::from_outline(&from_above(&named.tile));
        let narrow_px = self.panel.px_per_x() * narrow;
        if let Some(j) = self.in_plane(named) {
            let room = 0.9 * self.room_mm(named).unwrap_or(arrow_mm);
            let half = 0.5 * j.normalize() * (arrow_mm * j.length()).min(room);
            let width = (0.055 * narrow_px).clamp(0.5, 2.6);
            arrow(sheet, self.px(centre - half), self.px(centre + half), width, INK)?;
        }
        let out = named.tile.scene_polarization_t().z / self.most_t;
        if out.abs() > VANISHING {
            let tail = match self.in_plane(named) {
                Some(j) => {
                    let room = 0.9 * self.room_mm(named).unwrap_or(arrow_mm);
                    centre - 0.5 * j.normalize() * (arrow_mm * j.length()).min(room)
                }
                None => centre,
            };
            let radius = (0.12 * narrow_px).clamp(1.0, 12.0) * out.abs().sqrt();
            out_of_plane_mark(sheet, self.px(tail), radius, out > 0.0)?;
        }
        Ok(())
    }

    /// Maximum font size of the name of a tile, in pixels.
    fn letters_px(&self, named: &NamedTile, prefix: &str) -> f64 {
        let outline = from_above(&named.tile);
        let Annotation { narrow, long, filled, .. } = Annotation::from_outline(&outline);
        let letters = named.name.strip_prefix(prefix).unwrap_or(&named.name).chars().count().max(1) as f64;
        let room = [0.92 * long * filled / (LETTER_WIDTH * letters), 0.36 * narrow * filled];
        (self.panel.px_per_x() * room[0].min(room[1])).min(NAME_PX[1])
    }

    /// Draws the name without the common prefix.
    fn name(&self, sheet: &Sheet, named: &NamedTile, prefix: &str) -> DrawResult {
        let name = plain(named.name.strip_prefix(prefix).unwrap_or(&named.name));
        let Annotation { name: at, upright, .. } = Annotation::from_outline(&from_above(&named.tile));
        let letters = LETTERS.sized(self.letters_px(named, prefix)).centred();
        sheet.text(self.px(at), &name, Lettering { upright, colour: RGBColor(50, 50, 50), ..letters })
    }
}

fn area(polygon: &[DVec2]) -> f64 {
    0.5 * polygon.iter().zip(polygon.iter().cycle().skip(1)).map(|(a, b)| a.perp_dot(*b)).sum::<f64>()
}

/// The longest prefix of all names that ends with a hyphen. The tiles are labelled without it.
fn common_prefix<'a>(tiles: &[&'a NamedTile]) -> &'a str {
    let Some((first, rest)) = tiles.split_first() else { return "" };
    let hyphens = first.name.match_indices('-').map(|(at, _)| &first.name[..=at]);
    let shared = |prefix: &&str| rest.iter().all(|named| named.name.starts_with(prefix));
    if rest.is_empty() { "" } else { hyphens.take_while(shared).last().unwrap_or("") }
}
