//! Places for the arrow and the name of each tile: inside its outline, apart from each other, from
//! the marks of the working volume and from tiles that lie above it.

use glam::DVec2;
use plotters::prelude::RGBColor;

use crate::marks::head_width;
use crate::sheet::{DrawResult, LETTERS, Lettering, Sheet};
use crate::typeset::plain;

/// Font sizes of names that are tried, in pixels. A name that needs a smaller one is omitted.
const NAME_SIZES_PX: [f64; 6] = [12.0, 11.0, 10.0, 9.0, 8.0, 7.5];
/// Width of a letter as a fraction of the font size, chosen large.
const LETTER_WIDTH: f64 = 0.58;
/// Height of a line of text as a fraction of the font size, from the descender to the ascender.
const LINE_HEIGHT: f64 = 0.95;
/// Distance of names and arrows from the outline of the tile and from each other, in pixels.
const CLEARANCE_PX: f64 = 3.0;
/// Their distance from marks, which are bolder, in pixels.
const MARK_CLEARANCE_PX: f64 = 6.0;
/// Lengths of the longest arrow that are tried, as fractions of the room for it.
const ARROW_FRACTIONS: [f64; 5] = [0.7, 0.6, 0.5, 0.4, 0.3];
/// Maximum length of an arrow, in pixels. A longer one says no more, and leaves less room for
/// names.
const MAX_ARROW_PX: f64 = 64.0;
/// Length that the longest arrow has at least, in pixels, or as a fraction of the room for it,
/// whichever is less. A shorter one does not show its direction, and is hidden by the mark at its
/// tail.
const MIN_ARROW_PX: f64 = 20.0;
const MIN_ARROW_FRACTION: f64 = 0.6;
/// The fraction of tiles that may have a smaller room for the arrow or the name than the others
/// get.
const EXCEPTIONS: f64 = 0.05;
/// Places that are tried along each side of a tile, beside its centre.
const PLACES: i32 = 4;
/// Of more tiles no overlap is looked for. They are too small for names.
const MAX_LAYERED_TILES: usize = 2000;

/// A tile on the sheet. All lengths are in pixels, with y downwards.
pub(super) struct TileOnSheet {
    /// The convex outline.
    pub(super) outline: Vec<DVec2>,
    /// J in the plane over the largest |J| of all tiles. `None` if it vanishes.
    pub(super) in_plane: Option<DVec2>,
    /// Radius of the mark for the component of J out of the plane; 0 without a mark.
    pub(super) mark: f64,
    /// Number of letters of the name; 0 for no name.
    pub(super) letters: usize,
}

/// Where the arrow and the name of a tile go.
pub(super) struct Annotation {
    /// Centre of the arrow, or of the mark if there is no arrow.
    pub(super) arrow: DVec2,
    /// From the centre of the arrow to its tip. Zero without an arrow.
    pub(super) half: DVec2,
    /// `None` if there is no room for the name.
    pub(super) name: Option<NamePlace>,
}

impl Annotation {
    /// Draws the name where there is room for it.
    pub(super) fn write_name(&self, sheet: &Sheet, name: &str, colour: RGBColor) -> DrawResult {
        let Some(NamePlace { at, size, upright }) = self.name else { return Ok(()) };
        sheet.text(at.to_array(), &plain(name), Lettering { upright, colour, ..LETTERS.sized(size).centred() })
    }
}

/// Where the name of a tile goes.
#[derive(Clone, Copy)]
pub(super) struct NamePlace {
    /// Centre of the name.
    pub(super) at: DVec2,
    /// Font size in pixels.
    pub(super) size: f64,
    /// Whether the name runs upwards.
    pub(super) upright: bool,
}

/// The annotations of all tiles.
pub(super) struct Annotations {
    /// One per tile, in their order.
    pub(super) of_tiles: Vec<Annotation>,
    /// Length of the arrow of the tile with the largest |J|, in pixels.
    pub(super) arrow_px: f64,
}

/// A rectangle along the axes, in pixels.
#[derive(Clone, Copy)]
pub(super) struct Rectangle {
    pub(super) low: DVec2,
    pub(super) high: DVec2,
}

impl Rectangle {
    /// The rectangle around a line along an axis that is `width` wide.
    pub(super) fn of_line(from: [f64; 2], to: [f64; 2], width: f64) -> Rectangle {
        let bare = Rectangle::of_points([DVec2::from(from), DVec2::from(to)].into_iter());
        Rectangle::around(bare.middle(), bare.size() + DVec2::splat(width))
    }

    fn around(centre: DVec2, size: DVec2) -> Rectangle {
        Rectangle { low: centre - 0.5 * size, high: centre + 0.5 * size }
    }

    fn grown(&self, by: f64) -> Rectangle {
        Rectangle { low: self.low - DVec2::splat(by), high: self.high + DVec2::splat(by) }
    }

    /// The rectangle around points.
    pub(super) fn of_points(points: impl Iterator<Item = DVec2> + Clone) -> Rectangle {
        Rectangle { low: points.clone().fold(DVec2::MAX, DVec2::min), high: points.fold(DVec2::MIN, DVec2::max) }
    }

    pub(super) fn size(&self) -> DVec2 {
        self.high - self.low
    }

    pub(super) fn middle(&self) -> DVec2 {
        0.5 * (self.low + self.high)
    }

    fn corners(&self) -> [DVec2; 4] {
        let (l, h) = (self.low, self.high);
        [l, DVec2::new(h.x, l.y), h, DVec2::new(l.x, h.y)]
    }

    fn meets(&self, other: &Rectangle) -> bool {
        self.low.cmplt(other.high).all() && other.low.cmplt(self.high).all()
    }
}

/// Places for the arrows and names of all tiles, which are drawn in this order. `marks` are kept
/// free.
pub(super) fn annotations(tiles: &[TileOnSheet], marks: &[Rectangle]) -> Annotations {
    let boxes: Vec<Rectangle> = tiles.iter().map(|tile| Rectangle::of_points(tile.outline.iter().copied())).collect();
    let covering = |index: usize| -> Vec<&[DVec2]> {
        if tiles.len() > MAX_LAYERED_TILES {
            return Vec::new();
        }
        let above = (index + 1..tiles.len()).filter(|&other| boxes[index].meets(&boxes[other]));
        above.map(|other| tiles[other].outline.as_slice()).collect()
    };
    let rooms: Vec<TileRoom> = tiles
        .iter()
        .enumerate()
        .map(|(index, tile)| TileRoom { tile, bounds: boxes[index], covering: covering(index), marks })
        .collect();
    let mut lengths: Vec<f64> = rooms.iter().filter_map(TileRoom::for_arrow).collect();
    lengths.sort_by(f64::total_cmp);
    let room = lengths.get((EXCEPTIONS * lengths.len() as f64) as usize).copied().unwrap_or(0.0);

    // As many names as possible, then the largest letters, then the longest arrows.
    let mut best: Option<((usize, f64), f64)> = None;
    let mut tried = 0.0;
    for fraction in ARROW_FRACTIONS {
        let arrow_px = (fraction * room).clamp(MIN_ARROW_PX.min(MIN_ARROW_FRACTION * room), MAX_ARROW_PX);
        if arrow_px == tried {
            continue;
        }
        tried = arrow_px;
        let mut sizes: Vec<f64> = rooms.iter().filter_map(|room| room.largest_name(arrow_px)).collect();
        sizes.sort_by(f64::total_cmp);
        let score = (sizes.len(), sizes.get((EXCEPTIONS * sizes.len() as f64) as usize).copied().unwrap_or(0.0));
        if best.is_none_or(|(reached, _)| score > reached) {
            best = Some((score, arrow_px));
        }
    }
    let ((_, size), arrow_px) = best.unwrap_or(((0, 0.0), 0.0));
    let of_tiles = rooms.iter().map(|room| room.annotated(arrow_px, size)).collect();
    Annotations { of_tiles, arrow_px }
}

/// A tile and what limits the places for its arrow and its name.
struct TileRoom<'a> {
    tile: &'a TileOnSheet,
    /// The bounding rectangle of the outline.
    bounds: Rectangle,
    /// Outlines of tiles that are drawn later and may cover this one.
    covering: Vec<&'a [DVec2]>,
    marks: &'a [Rectangle],
}

impl TileRoom<'_> {
    /// Maximum length of an arrow through the centre; `None` for a tile without an arrow.
    fn for_arrow(&self) -> Option<f64> {
        let direction = self.tile.in_plane?.normalize();
        let outline = &self.tile.outline;
        let centre = self.bounds.middle();
        let to_sides = outline.iter().zip(outline.iter().cycle().skip(1)).filter_map(|(a, b)| {
            let normal = (*b - *a).perp();
            let approach = normal.dot(direction).abs();
            (approach > 1e-9 * normal.length()).then(|| normal.dot(centre - *a).abs() / approach)
        });
        Some(2.0 * to_sides.fold(f64::INFINITY, f64::min))
    }

    /// From the centre of the arrow to its tip.
    fn half_arrow(&self, arrow_px: f64) -> DVec2 {
        let (Some(j), Some(room)) = (self.tile.in_plane, self.for_arrow()) else { return DVec2::ZERO };
        0.5 * j.normalize() * (arrow_px * j.length()).min(0.9 * room)
    }

    /// The rectangle around an arrow at the origin and the mark at its tail.
    fn arrow_bounds(&self, arrow_px: f64) -> Rectangle {
        let half = self.half_arrow(arrow_px);
        // The head is wider than the shaft, across the arrow only.
        let head = 0.5 * head_width(2.0 * half.length(), arrow_width(arrow_px)) * half.perp().normalize_or_zero();
        let mark = DVec2::splat(self.tile.mark);
        let ends = [half - head, half + head, -half - head, -half + head, -half - mark, -half + mark];
        Rectangle::of_points(ends.into_iter())
    }

    /// Whether nothing of a rectangle is outside the tile, covered, or on a mark.
    fn holds(&self, rectangle: &Rectangle) -> bool {
        let grown = rectangle.grown(CLEARANCE_PX);
        let beside = rectangle.grown(MARK_CLEARANCE_PX);
        inside(&self.tile.outline, &grown)
            && !self.marks.iter().any(|mark| mark.meets(&beside))
            && !self.covering.iter().any(|outline| overlap(outline, &grown))
    }

    /// The place nearest to the centre of the tile at which each of `parts`, given relative to it,
    /// has room.
    fn place(&self, parts: &[Rectangle]) -> Option<DVec2> {
        let whole = Rectangle::of_points(parts.iter().flat_map(|part| [part.low, part.high]));
        let free = self.bounds.size() - whole.size() - DVec2::splat(2.0 * CLEARANCE_PX);
        if free.min_element() < 0.0 {
            return None;
        }
        let middle = self.bounds.middle() - whole.middle();
        let fits = |at: &DVec2| parts.iter().all(|p| self.holds(&Rectangle { low: p.low + *at, high: p.high + *at }));
        if fits(&middle) {
            return Some(middle);
        }
        let steps = || (-PLACES..=PLACES).map(|step| 0.5 * f64::from(step) / f64::from(PLACES));
        let mut places: Vec<DVec2> = steps().flat_map(|x| steps().map(move |y| DVec2::new(x, y) * free)).collect();
        places.sort_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
        places.into_iter().map(|aside| middle + aside).find(fits)
    }

    /// The annotation with a name of this font size, if there is room for it: the name below the
    /// arrow, at its right, above or at its left, across or, if the tile is narrow, upright.
    fn with_name(&self, arrow_px: f64, size: f64) -> Option<Annotation> {
        if self.tile.letters == 0 {
            return None;
        }
        let text = DVec2::new(LETTER_WIDTH * self.tile.letters as f64, LINE_HEIGHT) * size;
        if (self.bounds.size().min_element() < text.y) || (self.bounds.size().max_element() < text.x) {
            return None;
        }
        let arrow = self.arrow_bounds(arrow_px);
        for upright in [false, true] {
            let text = if upright { DVec2::new(text.y, text.x) } else { text };
            for direction in [DVec2::Y, DVec2::X, -DVec2::Y, -DVec2::X] {
                let step = 0.5 * (arrow.size() + text) + DVec2::splat(CLEARANCE_PX);
                let at = arrow.middle() + direction * step;
                let name = Rectangle::around(at, text);
                if let Some(place) = self.place(&[arrow, name]) {
                    let name = Some(NamePlace { at: place + at, size, upright });
                    return Some(Annotation { arrow: place, half: self.half_arrow(arrow_px), name });
                }
            }
        }
        None
    }

    /// The largest font size for which there is room.
    fn largest_name(&self, arrow_px: f64) -> Option<f64> {
        NAME_SIZES_PX.into_iter().find(|size| self.with_name(arrow_px, *size).is_some())
    }

    /// The annotation with a name of at most this font size, or without a name if there is no room.
    fn annotated(&self, arrow_px: f64, most: f64) -> Annotation {
        let sizes = NAME_SIZES_PX.into_iter().filter(|size| *size <= most);
        if let Some(annotation) = sizes.into_iter().find_map(|size| self.with_name(arrow_px, size)) {
            return annotation;
        }
        let arrow = self.place(&[self.arrow_bounds(arrow_px)]).unwrap_or(self.bounds.middle());
        Annotation { arrow, half: self.half_arrow(arrow_px), name: None }
    }
}

/// Width of the shafts of arrows if the longest has this length, in pixels.
pub(super) fn arrow_width(arrow_px: f64) -> f64 {
    (0.055 * arrow_px).clamp(0.5, 2.4)
}

/// Whether a rectangle lies inside a convex outline.
fn inside(outline: &[DVec2], rectangle: &Rectangle) -> bool {
    let turn = |a: DVec2, b: DVec2, p: DVec2| (b - a).perp_dot(p - a);
    let corners = rectangle.corners();
    let sides = || outline.iter().zip(outline.iter().cycle().skip(1));
    let all = |sign: f64| sides().all(|(a, b)| corners.iter().all(|p| sign * turn(*a, *b, *p) >= 0.0));
    all(1.0) || all(-1.0)
}

/// Whether a convex outline and a rectangle have a common area: no line along one of their sides
/// separates them.
fn overlap(outline: &[DVec2], rectangle: &Rectangle) -> bool {
    let corners = rectangle.corners();
    let normals = outline.iter().zip(outline.iter().cycle().skip(1)).map(|(a, b)| (*b - *a).perp());
    let range = |points: &[DVec2], normal: DVec2| {
        points.iter().map(|p| p.dot(normal)).fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(v), h.max(v)))
    };
    normals.chain([DVec2::X, DVec2::Y]).all(|normal| {
        let ((a, b), (c, d)) = (range(outline, normal), range(&corners, normal));
        a < d && c < b
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::marks::bracket_arms;

    fn tile(width: f64, height: f64, turn: f64, j: DVec2) -> TileOnSheet {
        let corners = Rectangle::around(DVec2::ZERO, DVec2::new(width, height)).corners();
        let outline = corners.map(|p| DVec2::new(100.0, 100.0) + DVec2::from_angle(turn).rotate(p));
        TileOnSheet { outline: outline.to_vec(), in_plane: Some(j), mark: 0.0, letters: 5 }
    }

    /// The rectangles of the arrow and of the name.
    fn drawn(tile: &TileOnSheet, annotation: &Annotation, arrow_px: f64) -> [Rectangle; 2] {
        let bounds = Rectangle::of_points(tile.outline.iter().copied());
        let room = TileRoom { tile, bounds, covering: Vec::new(), marks: &[] };
        let arrow = room.arrow_bounds(arrow_px);
        let NamePlace { at, size, upright } = *annotation.name.as_ref().unwrap();
        let text = DVec2::new(5.0 * LETTER_WIDTH, LINE_HEIGHT) * size;
        let name = Rectangle::around(at, if upright { DVec2::new(text.y, text.x) } else { text });
        [Rectangle { low: arrow.low + annotation.arrow, high: arrow.high + annotation.arrow }, name]
    }

    #[test]
    fn arrow_and_name_stay_apart_inside_wide_narrow_and_rotated_tiles() {
        for (width, height, turn) in [(120.0, 120.0, 0.0), (24.0, 120.0, 0.0), (120.0, 24.0, 0.0), (90.0, 60.0, 0.7)] {
            for angle in [0.0, 0.8, 1.6, 2.7] {
                let tiles = [tile(width, height, turn, DVec2::from_angle(angle))];
                let Annotations { of_tiles, arrow_px } = annotations(&tiles, &[]);
                let [arrow, name] = drawn(&tiles[0], &of_tiles[0], arrow_px);
                assert!(arrow_px > 10.0 && !arrow.meets(&name), "{width} x {height}, {angle}");
                assert!(inside(&tiles[0].outline, &arrow) && inside(&tiles[0].outline, &name));
            }
        }
    }

    #[test]
    fn marks_and_tiles_above_stay_free_of_the_name() {
        let marks = bracket_arms([100.0; 2], [400.0; 2], 12.0).map(|[from, to]| Rectangle::of_line(from, to, 4.0));
        let lower = || tile(120.0, 120.0, 0.0, DVec2::X);
        let Annotations { of_tiles, arrow_px } = annotations(&[lower()], &marks);
        for part in drawn(&lower(), &of_tiles[0], arrow_px) {
            assert!(!marks.iter().any(|mark| mark.meets(&part)));
        }
        let above = tile(60.0, 60.0, 0.0, DVec2::X);
        let tiles = [lower(), above];
        let Annotations { of_tiles, arrow_px } = annotations(&tiles, &[]);
        for part in drawn(&tiles[0], &of_tiles[0], arrow_px) {
            assert!(!overlap(&tiles[1].outline, &part), "{:?}", part.middle());
        }
    }

    #[test]
    fn name_without_room_is_omitted_and_the_arrow_remains() {
        let tiles = [tile(14.0, 14.0, 0.0, DVec2::X)];
        let Annotations { of_tiles, arrow_px } = annotations(&tiles, &[]);
        assert!(of_tiles[0].name.is_none() && arrow_px > 3.0 && of_tiles[0].half.x > 0.0);
    }
}
