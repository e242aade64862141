//! Rules that every film of a design keeps, as linear inequalities of the variables.

use std::collections::HashSet;

use magsplice_layout::{Brief, MinMax, Outline, Symmetry, Variable, ten_decimals};
use magsplice_magnet::Tile;

use crate::problem::affine::Affine;
use crate::problem::pattern::{Pattern, VariableTile};
use crate::rule::{Demand, Gap};

/// An affine expression that must be at least 0.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LinearRule {
    pub(crate) value: Affine,
    pub(crate) demand: Demand,
    /// Indices of the tiles that it binds: one, or two to be kept apart.
    pub(crate) tiles: (usize, Option<usize>),
}

/// Bounds of the tiles of a film, resolved from its brief. Lengths in millimetres, polarization in
/// tesla.
#[derive(Clone, Debug)]
pub(crate) struct DesignBounds {
    /// Lower and upper end along x and y.
    pub(crate) outline_mm: [[f64; 2]; 2],
    pub(crate) smallest_cut_mm: f64,
    pub(crate) gap: Gap,
    /// Whether the variables of positions are centres of tiles, which the rounding of the film
    /// moves to multiples of the resolution.
    pub(crate) rounds_centres: bool,
    pub(crate) thickness_mm: Option<[f64; 2]>,
    pub(crate) strength_t: Option<[f64; 2]>,
}

impl DesignBounds {
    pub(crate) fn new(brief: &Brief, tiles: &[Tile]) -> DesignBounds {
        let extent = |axis: usize| {
            let ends = tiles.iter().map(|tile| {
                let (centre, half) = (tile.position()[axis], 0.5 * tile.size()[axis]);
                [centre - half, centre + half]
            });
            ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], [lower, upper]| {
                [low.min(lower), high.max(upper)]
            })
        };
        let Outline { x, y } = brief.outline_mm;
        let mut outline_mm = [x.unwrap_or_else(|| extent(0)), y.unwrap_or_else(|| extent(1))];
        // The images of a tile must keep the outline too.
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
        let bounds = |varies: bool, range: Option<MinMax>| {
            varies.then(|| range.map_or([0.0; 2], |MinMax { min, max }| [min, max]))
        };
        DesignBounds {
            outline_mm,
            smallest_cut_mm: brief.smallest_cut_mm.unwrap_or(shortest),
            gap: Gap { least_mm: brief.gap_mm, gap_mm: brief.gap_mm, resolution_mm: brief.resolution_mm },
            rounds_centres: brief.varies(Variable::Position) && !brief.varies(Variable::Size),
            thickness_mm: bounds(brief.varies(Variable::Thickness), brief.thickness_mm),
            strength_t: bounds(brief.varies(Variable::Strength), brief.strength_t),
        }
    }

    /// The rules of single tiles.
    pub(crate) fn rules_of_tiles(&self, pattern: &Pattern) -> Vec<LinearRule> {
        let mut rules = Vec::new();
        for variable_tile in &pattern.tiles {
            let tile = variable_tile.orbit.tile;
            for [lower, upper] in &variable_tile.faces[..2] {
                let side = upper.minus(lower);
                rules.push(at_least(&side, self.smallest_cut_mm, Demand::Side(self.smallest_cut_mm), tile));
            }
            let outline = Demand::Outline(self.outline_mm);
            for ([lower, upper], [low, high]) in variable_tile.faces[..2].iter().zip(self.outline_mm) {
                rules.push(at_least(lower, low, outline, tile));
                rules.push(at_most(upper, high, outline, tile));
            }
            if let Some([least, most]) = self.thickness_mm {
                let within = Demand::Thickness([least, most]);
                let height = variable_tile.faces[2][1].minus(&variable_tile.faces[2][0]);
                rules.push(at_least(&height, least, within, tile));
                rules.push(at_most(&height, most, within, tile));
            }
            if let Some([least, most]) = self.strength_t {
                let within = Demand::Strength([least, most]);
                rules.push(at_least(&variable_tile.strength, least, within, tile));
                rules.push(at_most(&variable_tile.strength, most, within, tile));
            }
        }
        distinct(rules)
    }

    /// The rules of pairs of tiles. A pair stays apart along the axis along which its distance is
    /// larger now. Pairs further apart than `reach` need no rule.
    pub(crate) fn rules_of_pairs(&self, pattern: &Pattern, variables: &[f64], reach: f64) -> Vec<LinearRule> {
        let images: Vec<PlacedImage> = pattern
            .tiles
            .iter()
            .flat_map(|variable_tile| {
                variable_tile.orbit.images.iter().map(move |&(operation, index)| (variable_tile, operation, index))
            })
            .map(|(variable_tile, operation, index)| {
                let faces = variable_tile.image_faces(operation);
                let [x, y] = faces.each_ref().map(|ends| ends.each_ref().map(|end| end.eval(variables)));
                PlacedImage {
                    index,
                    faces,
                    ends: [x, y, variable_tile.faces[2].each_ref().map(|end| end.eval(variables))],
                }
            })
            .collect();
        let representative =
            |variable_tile: &VariableTile| images.iter().find(|image| image.index == variable_tile.orbit.tile);
        let mut rules = Vec::new();
        for first in pattern.tiles.iter().filter_map(representative) {
            for other in images.iter().filter(|other| other.index != first.index) {
                if distance(first.ends[2], other.ends[2]) >= 0.0 {
                    continue;
                }
                let apart = [0, 1].map(|axis| distance(first.ends[axis], other.ends[axis]));
                let axis = usize::from(apart[1] > apart[0]);
                if apart[axis] > reach {
                    continue;
                }
                let middle = |image: &PlacedImage| image.ends[axis][0] + image.ends[axis][1];
                let [before, after] = if middle(first) < middle(other) { [first, other] } else { [other, first] };
                let between = after.faces[axis][0].minus(&before.faces[axis][1]);
                let least_mm = self.least_distance_mm(&between);
                let demand = Demand::Apart(Gap { least_mm: ten_decimals(least_mm), ..self.gap });
                let mut rule = at_least(&between, least_mm, demand, first.index);
                rule.tiles.1 = Some(other.index);
                rules.push(rule);
            }
        }
        distinct(rules)
    }

    /// The least distance of two tiles, such that rounding keeps the gap. `between` is their
    /// distance.
    ///
    /// Where the distance of two centres is at least a multiple of the resolution, it still is
    /// after both are rounded: rounding is an odd function that never decreases.
    fn least_distance_mm(&self, between: &Affine) -> f64 {
        let Gap { least_mm, resolution_mm, .. } = self.gap;
        let Some(&(_, first)) = between.terms.first().filter(|_| self.rounds_centres) else { return least_mm };
        if between.terms.len() > 2 || between.terms.iter().any(|(_, factor)| factor.abs() != first.abs()) {
            // Rounding moves each of two centres by at most half of the resolution.
            return least_mm + resolution_mm;
        }
        let step = first.abs() * resolution_mm;
        let steps = (least_mm - between.constant) / step;
        (steps - ROUND_OFF_OF_STEPS).ceil() * step + between.constant
    }
}

/// Round-off of a number of steps: sums of decimal lengths, over the resolution.
const ROUND_OFF_OF_STEPS: f64 = 1e-6;

/// An image of a tile, with its faces along x and y and the present ends along all axes.
struct PlacedImage {
    index: usize,
    faces: [[Affine; 2]; 2],
    ends: [[f64; 2]; 3],
}

/// The distance of two intervals. Negative where they overlap.
fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (b[0] - a[1]).max(a[0] - b[1])
}

fn at_least(value: &Affine, least: f64, demand: Demand, tile: usize) -> LinearRule {
    LinearRule { value: value.minus(&Affine::constant(least)), demand, tiles: (tile, None) }
}

fn at_most(value: &Affine, most: f64, demand: Demand, tile: usize) -> LinearRule {
    LinearRule { value: Affine::constant(most).minus(value), demand, tiles: (tile, None) }
}

/// The rules without repetitions, which images cause.
fn distinct(rules: Vec<LinearRule>) -> Vec<LinearRule> {
    // Adding 0 turns -0 into 0.
    let bits = |value: f64| (value + 0.0).to_bits();
    let mut known: HashSet<(u64, Vec<(usize, u64)>)> = HashSet::new();
    let mut is_new = |rule: &LinearRule| {
        let terms = rule.value.terms.iter().map(|&(index, factor)| (index, bits(factor))).collect();
        known.insert((bits(rule.value.constant), terms))
    };
    rules.into_iter().filter(|rule| is_new(rule)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn outline_is_clipped_to_the_part_that_images_keep_too() {
        let tiles = [Tile::new(DVec3::ZERO, DVec3::new(2.0, 4.0, 1.0), DVec3::X).unwrap()];
        let outline = |symmetry: Symmetry, [x, y]: [Option<[f64; 2]>; 2]| {
            let outline_mm = Outline { x, y };
            DesignBounds::new(&Brief { symmetry, outline_mm, ..Brief::default() }, &tiles).outline_mm
        };
        let uneven = [Some([-8.0, 10.0]), Some([-7.0, 3.0])];
        assert_eq!(outline(Symmetry::None, uneven), [[-8.0, 10.0], [-7.0, 3.0]]);
        assert_eq!(outline(Symmetry::Mirror, uneven), [[-8.0, 8.0], [-3.0, 3.0]]);
        assert_eq!(outline(Symmetry::FourFold, uneven), [[-3.0, 3.0]; 2]);
        assert_eq!(outline(Symmetry::FourFold, [Some([-3.0, 10.0]), Some([-7.0, 7.0])]), [[-3.0, 3.0]; 2]);
        // Without an outline the extent of the film is one.
        assert_eq!(outline(Symmetry::Mirror, [None; 2]), [[-1.0, 1.0], [-2.0, 2.0]]);
    }

    fn problem(layout: &magsplice_layout::Layout) -> crate::problem::design_problem::DesignProblem<'_> {
        crate::problem::design_problem::DesignProblem::new(layout).unwrap_or_else(|e| panic!("{e}"))
    }

    fn layout(design: &str, tiles: &[([f64; 3], [f64; 3])]) -> magsplice_layout::Layout {
        let mut text = format!(
            "format = 1\nname = \"film\"\n[ideal]\nwavelength_mm = 10.0\nthickness_mm = 1.0\namplitude_t = 0.12\n\
             [volume]\nx_mm = [-2.0, 2.0]\ny_mm = [-2.0, 2.0]\nz_mm = [-5.0, -3.0]\nstep_mm = 2.0\n[design]\n{design}\n"
        );
        for (position, size) in tiles {
            let j_t = 0.1 * position[0].signum();
            text +=
                &format!("[[tile]]\nposition_mm = {position:?}\nsize_mm = {size:?}\npolarization_t = [{j_t}, 0, 0]\n");
        }
        magsplice_layout::Layout::parse(&text, "film").unwrap_or_else(|e| panic!("{e}"))
    }

    /// The values of the rules of one tile of 3 x 2 x 1 mm at (1.5, 0.25, 0.5) mm, by hand: what is
    /// left to each bound.
    #[test]
    fn rules_of_a_tile_are_its_distances_from_the_bounds() {
        let design = "vary = [\"size\", \"position\", \"thickness\", \"strength\"]\nsmallest_cut_mm = 0.5\n\
                      outline_mm = { x = [-5.0, 4.0], y = [-3.0, 6.0] }\nthickness_mm = { min = 0.75, max = 2.0 }\n\
                      strength_t = { min = 0.025, max = 0.2 }";
        let layout = layout(design, &[([1.5, 0.25, 0.5], [3.0, 2.0, 1.0])]);
        let problem = problem(&layout);
        let rules = problem.least_squares.bounds.rules_of_tiles(&problem.pattern);
        let found: Vec<f64> = rules.iter().map(|rule| rule.value.eval(&problem.pattern.start)).collect();
        let known = [2.5, 1.5, 5.0, 1.0, 2.25, 4.75, 0.25, 1.0, 0.075, 0.1];
        assert_eq!(found.len(), known.len(), "{found:?}");
        assert!(found.iter().zip(known).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
        assert!(rules.iter().all(|rule| rule.tiles == (0, None)));
        // Rules of equal values are one.
        assert_eq!(distinct([rules.clone(), rules.clone()].concat()), rules);
    }

    /// Pairs stay apart along the axis of their larger distance. Tiles above each other, and tiles
    /// beyond reach, have no rule.
    #[test]
    fn pairs_stay_apart_along_their_larger_distance() {
        let design = "vary = [\"size\", \"position\"]\nsmallest_cut_mm = 0.5\ngap_mm = 0.1";
        let cube = [2.0, 2.0, 1.0];
        let tiles = [
            ([1.0, 0.0, 0.5], cube),
            ([3.5, 0.25, 0.5], cube),
            ([1.25, -2.5, 0.5], cube),
            ([1.0, 0.0, 1.5], cube),
            ([9.0, 0.0, 0.5], cube),
        ];
        let layout = layout(design, &tiles);
        let problem = problem(&layout);
        let rules = problem.least_squares.bounds.rules_of_pairs(&problem.pattern, &problem.pattern.start, 2.0);
        let mut found: Vec<_> = rules
            .iter()
            .map(|rule| {
                let (one, other) = (rule.tiles.0, rule.tiles.1.expect("a pair"));
                (one.min(other), one.max(other), (rule.value.eval(&problem.pattern.start) * 1e9).round() * 1e-9)
            })
            .collect();
        found.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
        found.dedup();
        // Without the gap of 0.1 mm. The tile above the first touches none of the others.
        assert_eq!(found, [(0, 1, 0.4), (0, 2, 0.4), (1, 2, 0.65)]);
        let far = problem.least_squares.bounds.rules_of_pairs(&problem.pattern, &problem.pattern.start, 4.0);
        assert!(far.iter().any(|rule| rule.tiles == (1, Some(4)) || rule.tiles == (4, Some(1))));
    }

    /// The least distance that rounding keeps: of centres the next multiple of the resolution, of a
    /// centre and its image the next even one, and one resolution more for other sums.
    #[test]
    fn least_distances_are_kept_by_rounding() {
        let layout =
            layout("vary = [\"position\"]\ngap_mm = 0.1\nresolution_mm = 0.25", &[([3.0, 0.0, 0.5], [2.0; 3])]);
        let bounds = problem(&layout).least_squares.bounds;
        let least = |constant: f64, terms: &[(usize, f64)]| {
            let between = Affine { constant, terms: terms.to_vec() };
            // In units of the resolution, without the constant.
            ((bounds.least_distance_mm(&between) - constant) / 0.25 * 1e6).round() * 1e-6
        };
        let pair = [(0, -1.0), (1, 1.0)];
        // 2.1 mm of 0.25 mm are 8.4 steps, 2.15 mm are exactly 9, and 2.0 with the gap are 8.4.
        assert_eq!((least(-2.0, &pair), least(-2.15, &pair), least(-1.9, &pair)), (9.0, 9.0, 8.0));
        assert_eq!(least(-2.0, &[(0, 2.0)]), 10.0);
        assert_eq!(least(-2.0, &[(0, 1.0)]), 9.0);
        let more = |terms: &[(usize, f64)]| bounds.least_distance_mm(&Affine { constant: -2.0, terms: terms.to_vec() });
        assert_eq!([more(&[(0, 1.0), (1, 0.5)]), more(&[(0, 1.0), (1, 1.0), (2, 1.0)])], [0.35; 2]);
        let sizes =
            self::layout("vary = [\"size\"]\ngap_mm = 0.1\nresolution_mm = 0.25", &[([3.0, 0.0, 0.5], [2.0; 3])]);
        let sizes = problem(&sizes).least_squares.bounds;
        assert_eq!(sizes.least_distance_mm(&Affine { constant: -2.0, terms: pair.to_vec() }), 0.1);
    }
}
