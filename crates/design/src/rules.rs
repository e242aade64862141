//! What every film of a design must keep, as linear inequalities of the variables.

use magsplice_layout::{Brief, Symmetry};

use crate::affine::Affine;
use crate::pattern::{Pattern, Shape};

/// An affine expression that must be at least 0.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Rule {
    pub(crate) value: Affine,
    pub(crate) meaning: Meaning,
}

/// What a rule is about; tiles by their index in the film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Meaning {
    ShortestSide(usize),
    Outline(usize),
    Thickness(usize),
    Strength(usize),
    Apart(usize, usize),
}

/// What bounds the tiles of a film, worked out from its brief.
#[derive(Clone, Debug)]
pub(crate) struct Bounds {
    pub(crate) outline_mm: [[f64; 2]; 2],
    pub(crate) smallest_cut_mm: f64,
    /// Least distance, with what rounding may take of it.
    pub(crate) gap_mm: f64,
    pub(crate) thickness_mm: Option<[f64; 2]>,
    pub(crate) strength_t: Option<[f64; 2]>,
}

impl Bounds {
    pub(crate) fn of(brief: &Brief, tiles: &[magsplice_field::Tile]) -> Bounds {
        let extent = |axis: usize| {
            let ends = tiles.iter().map(|tile| {
                let (centre, half) = (tile.position()[axis], 0.5 * tile.size()[axis]);
                [centre - half, centre + half]
            });
            ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], [lower, upper]| {
                [low.min(lower), high.max(upper)]
            })
        };
        let mut outline_mm = [0, 1].map(|axis| brief.outline_mm[axis].unwrap_or_else(|| extent(axis)));
        // What holds for a tile holds for its images.
        let within = |[low, high]: [f64; 2]| high.min(-low);
        match brief.symmetry {
            Symmetry::None => {}
            Symmetry::Mirror => outline_mm = outline_mm.map(|range| [-within(range), within(range)]),
            Symmetry::FourFold => {
                let half = within(outline_mm[0]).min(within(outline_mm[1]));
                outline_mm = [[-half, half]; 2];
            }
        }
        let shortest = tiles.iter().map(|tile| tile.size().x.min(tile.size().y)).fold(f64::INFINITY, f64::min);
        Bounds {
            outline_mm,
            smallest_cut_mm: brief.smallest_cut_mm.unwrap_or(shortest),
            gap_mm: brief.gap_mm,
            thickness_mm: brief.vary.thickness.then_some(brief.thickness_mm),
            strength_t: brief.vary.strength.then_some(brief.strength_t),
        }
    }

    /// The rules of every tile by itself.
    pub(crate) fn of_tiles(&self, pattern: &Pattern) -> Vec<Rule> {
        let mut rules = Vec::new();
        for shape in &pattern.shapes {
            let tile = shape.orbit.tile;
            for [lower, upper] in &shape.faces[..2] {
                let side = upper.minus(lower);
                rules.push(at_least(&side, self.smallest_cut_mm, Meaning::ShortestSide(tile)));
            }
            for ([lower, upper], [low, high]) in shape.faces[..2].iter().zip(self.outline_mm) {
                rules.push(at_least(lower, low, Meaning::Outline(tile)));
                rules.push(at_most(upper, high, Meaning::Outline(tile)));
            }
            if let Some([least, most]) = self.thickness_mm {
                let height = shape.faces[2][1].minus(&shape.faces[2][0]);
                rules.push(at_least(&height, least, Meaning::Thickness(tile)));
                rules.push(at_most(&height, most, Meaning::Thickness(tile)));
            }
            if let Some([least, most]) = self.strength_t {
                rules.push(at_least(&shape.strength, least, Meaning::Strength(tile)));
                rules.push(at_most(&shape.strength, most, Meaning::Strength(tile)));
            }
        }
        distinct(rules)
    }

    /// Tiles stay apart along the axis along which they are further apart now; pairs more than `reach` apart need no rule.
    pub(crate) fn of_pairs(&self, pattern: &Pattern, at: &[f64], reach: f64) -> Vec<Rule> {
        let images: Vec<Placed> = pattern
            .shapes
            .iter()
            .flat_map(|shape| shape.orbit.images.iter().map(move |&(operation, index)| (shape, operation, index)))
            .map(|(shape, operation, index)| {
                let faces = shape.image_faces(operation);
                let [x, y] = faces.each_ref().map(|ends| ends.each_ref().map(|end| end.at(at)));
                Placed { index, faces, ends: [x, y, shape.faces[2].each_ref().map(|end| end.at(at))] }
            })
            .collect();
        let representative = |shape: &Shape| images.iter().find(|image| image.index == shape.orbit.tile);
        let mut rules = Vec::new();
        for first in pattern.shapes.iter().filter_map(representative) {
            for other in images.iter().filter(|other| other.index != first.index) {
                if distance(first.ends[2], other.ends[2]) >= 0.0 {
                    continue;
                }
                let apart = [0, 1].map(|axis| distance(first.ends[axis], other.ends[axis]));
                let axis = usize::from(apart[1] > apart[0]);
                if apart[axis] > reach {
                    continue;
                }
                let middle = |image: &Placed| image.ends[axis][0] + image.ends[axis][1];
                let [before, after] = if middle(first) < middle(other) { [first, other] } else { [other, first] };
                let between = after.faces[axis][0].minus(&before.faces[axis][1]);
                rules.push(at_least(&between, self.gap_mm, Meaning::Apart(first.index, other.index)));
            }
        }
        distinct(rules)
    }
}

/// A tile with its faces along x and y, and where the ends along all axes are now.
struct Placed {
    index: usize,
    faces: [[Affine; 2]; 2],
    ends: [[f64; 2]; 3],
}

/// How far apart two intervals are; negative where they overlap.
fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (b[0] - a[1]).max(a[0] - b[1])
}

fn at_least(value: &Affine, least: f64, meaning: Meaning) -> Rule {
    Rule { value: value.minus(&Affine::constant(least)), meaning }
}

fn at_most(value: &Affine, most: f64, meaning: Meaning) -> Rule {
    Rule { value: Affine::constant(most).minus(value), meaning }
}

/// Images make the same rule again and again.
fn distinct(rules: Vec<Rule>) -> Vec<Rule> {
    let mut kept: Vec<Rule> = Vec::new();
    for rule in rules {
        if !kept.iter().any(|known| known.value == rule.value) {
            kept.push(rule);
        }
    }
    kept
}
