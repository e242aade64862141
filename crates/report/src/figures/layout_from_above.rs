//! The tiles from above, with their polarization and their names (Dai 2024, Fig. 5).

use glam::{DVec2, DVec3};
use magsplice::layout::{NamedTile, WorkingVolume};
use plotters::prelude::RGBColor;

use crate::arrow::arrow;
use crate::colours::{Directions, light, plot};
use crate::panel::{BELOW_PX, Beside, LEFT_PX, Panel};
use crate::sheet::{Drawn, INK, LETTERS, Lettering, Sheet, sheet};
use crate::solid::{bounds, from_above};
use crate::typeset::plain;

use super::layout_key::Key;

/// Room for the drawing and for the key at its right, in pixels.
const ROOM_PX: f64 = 740.0;
const KEY_PX: f64 = 190.0;
const TOP_PX: f64 = 14.0;
/// Empty space around the tiles, as a fraction of the drawing.
const MARGIN: f64 = 0.03;
/// Half the narrower side of the drawing at least, as a fraction of the wider.
const NARROWEST: f64 = 0.06;

/// Letters of names, in pixels: smaller ones are left out.
const NAME_PX: [f64; 2] = [7.5, 12.0];
/// Width of a letter of a name over its height, rather too much than too little.
const LETTER_WIDTH: f64 = 0.56;
/// How far towards its name an arrow may reach, as a fraction of the distance.
const TO_NAME: f64 = 0.75;
/// Components below this fraction of the largest |J| are not drawn.
pub(super) const VANISHING: f64 = 1e-6;

pub(crate) fn draw(tiles: &[&NamedTile], all: usize, volume: Option<&WorkingVolume>) -> Result<String, String> {
    let most_t = tiles.iter().map(|named| named.tile.polarization_t().length()).fold(0.0, f64::max);
    let [low, high] = bounds(tiles.iter().map(|named| &named.tile)).unwrap_or([DVec3::ZERO, DVec3::ONE]);
    let (low, high) = match volume {
        Some(v) => (low.min(v.lower_mm), high.max(v.upper_mm)),
        None => (low, high),
    };
    let (longest, middle) = ((high - low).truncate().max_element(), 0.5 * (low + high));
    let half = (0.5 * (high - low)).max(DVec3::splat(NARROWEST * longest)) + MARGIN * longest;
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
    let size = [panel.right() + KEY_PX, (panel.bottom() + BELOW_PX + 6.0).max(470.0)];
    sheet(size, |sheet| {
        let picture = Picture { panel, most_t, directions: Directions::new() };
        // From the lowest to the highest, as they would cover each other.
        let mut order: Vec<&NamedTile> = tiles.to_vec();
        let top = |named: &&NamedTile| bounds(std::iter::once(&named.tile)).map_or(0.0, |[_, high]| high.z);
        order.sort_by(|a, b| top(a).total_cmp(&top(b)));
        let prefix = common_prefix(tiles);
        let arrow_mm = picture.arrow_mm(tiles);
        let fits = |named: &NamedTile| picture.letters_px(named, prefix) >= NAME_PX[0];
        let mut nameless = tiles.iter().filter(|named| !fits(named)).count();
        // A few names among many tiles would only be confusing.
        if 2 * nameless > tiles.len() {
            nameless = tiles.len();
        }
        for named in order {
            picture.body(sheet, named)?;
            picture.polarization(sheet, named, arrow_mm)?;
            if nameless < tiles.len() && fits(named) {
                picture.name(sheet, named, prefix)?;
            }
        }
        if let Some(v) = volume {
            let (l, u) = (v.lower_mm, v.upper_mm);
            corner_marks(sheet, panel.at(l.x, u.y), panel.at(u.x, l.y), 12.0)?;
        }
        panel.axes(sheet, Beside::Length("x"), Beside::Length("y"))?;
        let names = match nameless {
            0 if prefix.is_empty() => Vec::new(),
            0 => vec![format!("Tiles: {}\u{2026}", plain(prefix))],
            n if n == tiles.len() => vec!["Tiles too small for".to_owned(), "their names".to_owned()],
            n => vec![format!("Tiles: {}\u{2026}", plain(prefix)), format!("({n} without room for it)")],
        };
        let key = Key {
            left: panel.right() + 24.0,
            top: TOP_PX,
            arrow_px: arrow_mm * panel.px_per_x(),
            most_t,
            tiles,
            all,
            volume: volume.is_some(),
            names: &names,
        };
        key.draw(sheet, &picture.directions)
    })
}

/// How a tile is shared between its arrow and its name.
struct Part {
    arrow: DVec2,
    name: DVec2,
    /// Whether the name runs upwards.
    upright: bool,
    /// The sides of the rectangle around the tile.
    narrow: f64,
    long: f64,
    /// How much of that rectangle the tile fills.
    filled: f64,
}

impl Part {
    fn of(outline: &[DVec2]) -> Part {
        let low = outline.iter().copied().fold(DVec2::MAX, DVec2::min);
        let high = outline.iter().copied().fold(DVec2::MIN, DVec2::max);
        let (middle, sides) = (0.5 * (low + high), high - low);
        let upright = sides.y > 1.3 * sides.x;
        let filled = area(outline) / (sides.x * sides.y);
        let aside = if upright { DVec2::new(sides.x, 0.0) } else { DVec2::new(0.0, -sides.y) };
        Part {
            arrow: middle - 0.15 * filled * aside,
            name: middle + 0.29 * filled * aside,
            upright,
            narrow: sides.min_element(),
            long: if upright { sides.y } else { sides.x },
            filled,
        }
    }
}

struct Picture {
    panel: Panel,
    most_t: f64,
    directions: Directions,
}

impl Picture {
    fn px(&self, p: DVec2) -> [f64; 2] {
        self.panel.at(p.x, p.y)
    }

    fn body(&self, sheet: &Sheet, named: &NamedTile) -> Drawn {
        let outline: Vec<[f64; 2]> = from_above(&named.tile).into_iter().map(|p| self.px(p)).collect();
        sheet.fill(&outline, light(self.directions.colour(named.tile.scene_polarization_t())))?;
        let width = if self.panel.px_per_x() * named.tile.size().min_element() < 3.0 { 0.3 } else { 0.9 };
        sheet.outline(&outline, RGBColor(70, 70, 70), width)
    }

    /// The length of the arrow of the strongest tile: one that fits into nearly all tiles.
    fn arrow_mm(&self, tiles: &[&NamedTile]) -> f64 {
        let mut rooms: Vec<f64> = tiles.iter().filter_map(|named| self.room_mm(named)).collect();
        rooms.sort_by(f64::total_cmp);
        rooms.get(rooms.len() / 20).map_or(1.0, |room| 0.8 * room)
    }

    /// How long an arrow in the middle of its part of a tile can be; `None` for a tile that needs none.
    fn room_mm(&self, named: &NamedTile) -> Option<f64> {
        let direction = self.in_plane(named)?.normalize();
        let outline = from_above(&named.tile);
        let Part { arrow: centre, name, .. } = Part::of(&outline);
        // To the side that is met first, ahead or behind.
        let to_sides = outline.iter().zip(outline.iter().cycle().skip(1)).filter_map(|(a, b)| {
            let normal = (*b - *a).perp();
            let approach = normal.dot(direction).abs();
            (approach > 1e-9 * normal.length()).then(|| normal.dot(centre - *a).abs() / approach)
        });
        // Or to the name.
        let aside = name - centre;
        let approach = direction.dot(aside).abs();
        let to_name = if approach > 0.0 { TO_NAME * aside.length_squared() / approach } else { f64::INFINITY };
        Some(2.0 * to_sides.fold(to_name, f64::min))
    }

    fn in_plane(&self, named: &NamedTile) -> Option<DVec2> {
        let j = named.tile.scene_polarization_t().truncate() / self.most_t;
        (j.length() > VANISHING).then_some(j)
    }

    fn polarization(&self, sheet: &Sheet, named: &NamedTile, arrow_mm: f64) -> Drawn {
        let Part { arrow: centre, narrow, .. } = Part::of(&from_above(&named.tile));
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
            upright_mark(sheet, self.px(tail), radius, out > 0.0)?;
        }
        Ok(())
    }

    /// How large the letters of a name can be, in pixels.
    fn letters_px(&self, named: &NamedTile, prefix: &str) -> f64 {
        let outline = from_above(&named.tile);
        let Part { narrow, long, filled, .. } = Part::of(&outline);
        let letters = named.name.strip_prefix(prefix).unwrap_or(&named.name).chars().count().max(1) as f64;
        let room = [0.92 * long * filled / (LETTER_WIDTH * letters), 0.36 * narrow * filled];
        (self.panel.px_per_x() * room[0].min(room[1])).min(NAME_PX[1])
    }

    fn name(&self, sheet: &Sheet, named: &NamedTile, prefix: &str) -> Drawn {
        let name = plain(named.name.strip_prefix(prefix).unwrap_or(&named.name));
        let Part { name: at, upright, .. } = Part::of(&from_above(&named.tile));
        let letters = LETTERS.sized(self.letters_px(named, prefix)).centred();
        sheet.text(self.px(at), &name, Lettering { upright, colour: RGBColor(50, 50, 50), ..letters })
    }
}

/// The corners of a rectangle, which hide less than its sides.
pub(super) fn corner_marks(sheet: &Sheet, [left, top]: [f64; 2], [right, bottom]: [f64; 2], most_px: f64) -> Drawn {
    let length = most_px.min(0.4 * (right - left)).min(0.4 * (bottom - top));
    for (x, inwards) in [(left, length), (right, -length)] {
        for (y, down) in [(top, length), (bottom, -length)] {
            let mark = [[x + inwards, y], [x, y], [x, y + down]];
            sheet.line(&mark, RGBColor(255, 255, 255), 3.6)?;
            sheet.line(&mark, INK, 2.2)?;
        }
    }
    Ok(())
}

/// The tip of an arrow towards the viewer, or its feathers.
pub(super) fn upright_mark(sheet: &Sheet, at: [f64; 2], radius: f64, up: bool) -> Drawn {
    sheet.disc(at, radius, RGBColor(255, 255, 255))?;
    sheet.ring(at, radius, INK, (0.16 * radius).max(0.4))?;
    if up {
        return sheet.disc(at, 0.36 * radius, plot([30, 30, 30]));
    }
    let r = radius * std::f64::consts::FRAC_1_SQRT_2;
    for [dx, dy] in [[r, r], [r, -r]] {
        sheet.line(&[[at[0] - dx, at[1] - dy], [at[0] + dx, at[1] + dy]], INK, (0.16 * radius).max(0.4))?;
    }
    Ok(())
}

fn area(polygon: &[DVec2]) -> f64 {
    0.5 * polygon.iter().zip(polygon.iter().cycle().skip(1)).map(|(a, b)| a.perp_dot(*b)).sum::<f64>()
}

/// What all names begin with, up to a hyphen: it need not be repeated on every tile.
fn common_prefix<'a>(tiles: &[&'a NamedTile]) -> &'a str {
    let Some((first, rest)) = tiles.split_first() else { return "" };
    let hyphens = first.name.match_indices('-').map(|(at, _)| &first.name[..=at]);
    let shared = |prefix: &&str| rest.iter().all(|named| named.name.starts_with(prefix));
    if rest.is_empty() { "" } else { hyphens.take_while(shared).last().unwrap_or("") }
}
