//! Assignment of tiles to distinct parts: which tile is made of which part, and in which
//! orientation.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use glam::DVec3;
use magsplice_layout::{Brief, StockPart, Variables, direction_from_degrees};

use crate::affine::Affine;
use crate::descent::Candidate;
use crate::pattern::{Pattern, VariableKind, VariableTile};
use crate::symmetry::{Orbit, SymmetryOperation};
use crate::tolerances::SAME_TILE;

/// Symmetry that a part must have: that of all tiles made of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SymmetryClass {
    /// Nothing.
    Free,
    /// Polarized along its first side.
    Axis,
    /// Square, polarized along its diagonal.
    Diagonal,
}

impl SymmetryClass {
    /// Both demands together. `None` if they contradict each other.
    fn and(self, other: SymmetryClass) -> Option<SymmetryClass> {
        match (self, other) {
            (a, b) if a == b => Some(a),
            (SymmetryClass::Free, other) | (other, SymmetryClass::Free) => Some(other),
            _ => None,
        }
    }
}

/// A size with a direction of polarization. Lengths in millimetres, polarization in tesla.
#[derive(Clone, Copy, Debug)]
struct DistinctPart {
    /// First and second side.
    size: [f64; 2],
    /// Angle of the polarization from the first side towards the second, within a right angle, in
    /// radians.
    angle: f64,
    strength: f64,
    class: SymmetryClass,
    /// Whether the part is in stock, so that nothing of it may change.
    in_stock: bool,
}

/// A tile made of a part.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedPart {
    /// Index of the part.
    part: usize,
    /// The operation that maps the part's frame to the tile's.
    orientation: SymmetryOperation,
    centre: [f64; 2],
    /// Symmetry that the tile demands of its part.
    class: SymmetryClass,
}

/// Distinct parts, and the tiles that are made of them.
#[derive(Clone, Debug)]
pub(crate) struct PartAssignment {
    parts: Vec<DistinctPart>,
    /// One for each orbit of the pattern.
    pub(crate) placed: Vec<PlacedPart>,
}

/// An assignment in which two parts are merged.
pub(crate) struct MergedAssignment {
    pub(crate) assignment: PartAssignment,
    /// Distance of the two sizes in the plane of their sides.
    pub(crate) distance: f64,
}

impl PartAssignment {
    /// The assignment of one part to each tile of a film, with the parts in stock besides.
    pub(crate) fn new(brief: &Brief, pattern: &Pattern, candidate: &Candidate) -> PartAssignment {
        let mut assignment = PartAssignment { parts: Vec::new(), placed: Vec::new() };
        for variable_tile in &pattern.tiles {
            let [lower, upper] = variable_tile.corners(&candidate.variables);
            let centre = 0.5 * (lower + upper);
            let j = variable_tile.polarization_t(&candidate.variables);
            let (part, orientation) = part_of(&variable_tile.orbit, upper - lower, j);
            let (centre, class) = ([centre.x, centre.y], part.class);
            assignment.placed.push(PlacedPart { part: assignment.parts.len(), orientation, centre, class });
            assignment.parts.push(part);
        }
        let strength = assignment.parts.iter().map(|part| part.strength).fold(0.0, f64::max);
        assignment.parts.extend(brief.stock.iter().map(|stock| part_in_stock(stock, strength)));
        assignment
    }

    /// Indices of the parts that tiles are made of.
    pub(crate) fn used(&self) -> Vec<usize> {
        (0..self.parts.len()).filter(|&part| self.placed.iter().any(|placed| placed.part == part)).collect()
    }

    /// Number of used parts that are not in stock.
    pub(crate) fn free(&self) -> usize {
        self.used().into_iter().filter(|&part| !self.parts[part].in_stock).count()
    }

    /// Every way to merge two parts. `turns` says whether directions may change.
    pub(crate) fn merged(&self, turns: bool) -> Vec<MergedAssignment> {
        let used = self.used();
        let mut all = Vec::new();
        for &from in used.iter().filter(|&&part| !self.parts[part].in_stock) {
            for into in 0..self.parts.len() {
                let in_stock = self.parts[into].in_stock;
                if into == from || (!in_stock && (into < from || !used.contains(&into))) {
                    continue;
                }
                for flip in [false, true] {
                    all.extend(self.with_merged(from, into, flip, turns));
                }
            }
        }
        all
    }

    /// The assignment in which the two parts of the nearest sizes are merged.
    pub(crate) fn nearest_merged(&self, turns: bool) -> Option<PartAssignment> {
        let used = self.used();
        let mut pairs: Vec<(f64, usize, usize, bool)> = Vec::new();
        for &from in used.iter().filter(|&&part| !self.parts[part].in_stock) {
            for into in 0..self.parts.len() {
                let in_stock = self.parts[into].in_stock;
                if into == from || (!in_stock && (into < from || !used.contains(&into))) {
                    continue;
                }
                let ([a, b], [c, d]) = (self.parts[from].size, self.parts[into].size);
                pairs.push(((a - c).hypot(b - d), from, into, false));
                pairs.push(((a - d).hypot(b - c), from, into, true));
            }
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        pairs.into_iter().find_map(|(_, from, into, flip)| Some(self.with_merged(from, into, flip, turns)?.assignment))
    }

    /// The assignment whose tiles of part `from` are made of part `into`. `flip` exchanges their
    /// sides. Where directions may not change, the direction of `into` holds. `None` if symmetry or
    /// stock forbids it.
    fn with_merged(&self, from: usize, into: usize, flip: bool, turns: bool) -> Option<MergedAssignment> {
        let tiles: Vec<usize> = (0..self.placed.len()).filter(|&i| self.placed[i].part == from).collect();
        let own = self.placed.iter().filter(|placed| placed.part == into).count() as f64;
        let (a, b) = (self.parts[from], self.parts[into]);
        let class = a.class.and(b.class)?;
        if b.in_stock && class != b.class {
            return None;
        }
        // Only the sides of a part without demands can be exchanged. One of the two parts is
        // enough.
        let across = if a.class == SymmetryClass::Free { from } else { into };
        if flip && (self.parts[across].class != SymmetryClass::Free || b.in_stock && across == into) {
            return None;
        }
        let mut assignment = self.clone();
        let turned = |part: DistinctPart, turn: bool| match turn {
            true => DistinctPart { size: [part.size[1], part.size[0]], angle: FRAC_PI_2 - part.angle, ..part },
            false => part,
        };
        let (a, b) = (turned(a, flip && across == from), turned(b, flip && across == into));
        if flip {
            let exchanged = assignment.placed.iter_mut().filter(|placed| placed.part == across);
            exchanged.for_each(|placed| placed.orientation = placed.orientation.after_exchange());
        }
        let share = tiles.len() as f64 / (tiles.len() as f64 + own);
        let mean = |a: f64, b: f64| share * a + (1.0 - share) * b;
        let mut size = [mean(a.size[0], b.size[0]), mean(a.size[1], b.size[1])];
        let distance = (a.size[0] - b.size[0]).hypot(a.size[1] - b.size[1]);
        let angle = match class {
            SymmetryClass::Free if turns => mean(a.angle, b.angle),
            SymmetryClass::Free => b.angle,
            SymmetryClass::Axis => 0.0,
            SymmetryClass::Diagonal => {
                size = [0.5 * (size[0] + size[1]); 2];
                FRAC_PI_4
            }
        };
        if !b.in_stock {
            assignment.parts[into] =
                DistinctPart { size, angle, strength: mean(a.strength, b.strength), class, in_stock: false };
        }
        tiles.iter().for_each(|&tile| assignment.placed[tile].part = into);
        Some(MergedAssignment { assignment, distance })
    }

    /// Every way to make one tile of another part that is in use or in stock.
    pub(crate) fn with_one_exchanged(&self, turns: bool) -> Vec<PartAssignment> {
        let used = self.used();
        let mut all = Vec::new();
        for tile in 0..self.placed.len() {
            let PlacedPart { part: own, class, .. } = self.placed[tile];
            // The tile first gets a part of its own, then that part is merged.
            let single = self.parts.len();
            let mut alone = self.clone();
            alone.placed[tile].part = single;
            // The merger reads whether a part is in stock only of the part that stays.
            alone.parts.push(DistinctPart { class, ..self.parts[own] });
            if !self.parts[own].in_stock {
                let left = alone.placed.iter().filter(|placed| placed.part == own).map(|placed| placed.class);
                // The demands of the other tiles were compatible before, so they still are.
                alone.parts[own].class = left.fold(SymmetryClass::Free, |all, class| all.and(class).unwrap_or(all));
            }
            for into in (0..single).filter(|&p| p != own && (used.contains(&p) || self.parts[p].in_stock)) {
                for flip in [false, true] {
                    let merged = alone.with_merged(single, into, flip, turns);
                    all.extend(merged.map(|MergedAssignment { mut assignment, .. }| {
                        assignment.parts.truncate(single);
                        assignment
                    }));
                }
            }
        }
        all
    }

    /// The same assignment with the sizes, angles and positions of a film.
    pub(crate) fn updated(mut self, pattern: &Pattern, candidate: &Candidate) -> PartAssignment {
        for (placed, variable_tile) in self.placed.iter_mut().zip(&pattern.tiles) {
            let [lower, upper] = variable_tile.corners(&candidate.variables);
            let centre = 0.5 * (lower + upper);
            placed.centre = [centre.x, centre.y];
            let part = &mut self.parts[placed.part];
            if !part.in_stock {
                let back = placed.orientation.inverse();
                let size = back.apply_to_size(upper - lower);
                part.size = [size.x, size.y];
                let j = variable_tile.polarization_t(&candidate.variables);
                part.strength = j.length();
                let unit = back.apply(j);
                part.angle = unit.y.atan2(unit.x);
            }
        }
        self
    }

    /// The pattern whose variables are the free numbers of the parts and the positions of the
    /// tiles.
    pub(crate) fn pattern(&self, vary: Variables, like: &Pattern) -> Pattern {
        let mut pattern =
            Pattern { tiles: Vec::new(), kinds: Vec::new(), start: Vec::new(), tile_count: like.tile_count };
        let mut free = |kind: VariableKind, start: f64| {
            pattern.kinds.push(kind);
            pattern.start.push(start);
            Affine::variable(pattern.start.len() - 1)
        };
        // Strengths that were fixed before stay fixed.
        let scales = vary.strength && like.kinds.contains(&VariableKind::Strength);
        let used = self.used();
        let numbers: Vec<[Affine; 4]> = (self.parts.iter().enumerate())
            .map(|(index, part)| {
                let constant = part.in_stock || !used.contains(&index);
                let mut number = |kind: VariableKind, start: f64, varies: bool| {
                    if varies && !constant { free(kind, start) } else { Affine::constant(start) }
                };
                let first = number(VariableKind::Length, part.size[0], vary.size);
                let second = match part.class {
                    SymmetryClass::Diagonal => first.clone(),
                    _ => number(VariableKind::Length, part.size[1], vary.size),
                };
                let turns = vary.direction && part.class == SymmetryClass::Free;
                [
                    first,
                    second,
                    number(VariableKind::Angle, part.angle, turns),
                    number(VariableKind::Strength, part.strength, scales),
                ]
            })
            .collect();
        for (placed, variable_tile) in self.placed.iter().zip(&like.tiles) {
            let orbit = &variable_tile.orbit;
            let [first, second, angle, strength] = &numbers[placed.part];
            let sizes = if placed.orientation.exchange { [second, first] } else { [first, second] };
            let mut centre = |axis: usize| match (orbit.on_mirror[axis], vary.position) {
                (true, _) => Affine::constant(0.0),
                (false, true) => free(VariableKind::Length, placed.centre[axis]),
                (false, false) => Affine::constant(placed.centre[axis]),
            };
            let x = centre(0);
            let y = if orbit.on_diagonal { x.clone() } else { centre(1) };
            let along =
                |centre: &Affine, size: &Affine| [centre.minus(&size.times(0.5)), centre.plus(&size.times(0.5))];
            let in_degrees = angle.constant.to_degrees();
            pattern.tiles.push(VariableTile {
                orbit: orbit.clone(),
                faces: [along(&x, sizes[0]), along(&y, sizes[1]), variable_tile.faces[2].clone()],
                direction: placed.orientation.apply_to_angle(angle),
                tilt: Affine::constant(0.0),
                strength: strength.clone(),
                unit: placed.orientation.apply(direction_from_degrees([in_degrees, 0.0])),
                original: variable_tile.original,
            });
        }
        pattern
    }
}

impl SymmetryOperation {
    /// The operation that first exchanges the two axes, then does this one.
    fn after_exchange(self) -> SymmetryOperation {
        SymmetryOperation { exchange: !self.exchange, ..self }
    }

    /// The angle of an arrow after the operation.
    fn apply_to_angle(self, angle: &Affine) -> Affine {
        let mut angle = angle.clone();
        if self.exchange {
            angle = Affine::constant(FRAC_PI_2).minus(&angle);
        }
        if self.signs[0] < 0.0 {
            angle = Affine::constant(PI).minus(&angle);
        }
        if self.signs[1] < 0.0 { angle.times(-1.0) } else { angle }
    }
}

/// The part that a tile is, and its orientation.
fn part_of(orbit: &Orbit, size: DVec3, j: DVec3) -> (DistinctPart, SymmetryOperation) {
    let sign = |component: f64| if component < 0.0 { -1.0 } else { 1.0 };
    let signs = [sign(j.x), sign(j.y)];
    let (class, exchange) = match (orbit.on_diagonal, orbit.on_mirror) {
        (true, _) => (SymmetryClass::Diagonal, false),
        (false, [false, false]) => (SymmetryClass::Free, size.y > size.x),
        (false, [on_x, _]) => (SymmetryClass::Axis, on_x),
    };
    let orientation = SymmetryOperation { exchange, signs };
    let (size, unit) = (orientation.inverse().apply_to_size(size), orientation.inverse().apply(j));
    let angle = unit.y.atan2(unit.x);
    (DistinctPart { size: [size.x, size.y], angle, strength: j.length(), class, in_stock: false }, orientation)
}

/// A part in stock, with its polarization within the first right angle.
fn part_in_stock(stock: &StockPart, strength: f64) -> DistinctPart {
    let direction = direction_from_degrees([stock.direction_deg, 0.0]).abs();
    let angle = direction.y.atan2(direction.x);
    let [first, second] = stock.size_mm;
    let near = |a: f64, b: f64| (a - b).abs() <= SAME_TILE;
    let part = DistinctPart { size: [first, second], angle, strength, class: SymmetryClass::Free, in_stock: true };
    if near(angle, 0.0) {
        DistinctPart { class: SymmetryClass::Axis, angle: 0.0, ..part }
    } else if near(angle, FRAC_PI_2) {
        DistinctPart { class: SymmetryClass::Axis, angle: 0.0, size: [second, first], ..part }
    } else if near(angle, FRAC_PI_4) && near(first, second) {
        DistinctPart { class: SymmetryClass::Diagonal, angle: FRAC_PI_4, ..part }
    } else {
        part
    }
}

#[cfg(test)]
mod tests {
    use magsplice_layout::Layout;
    use magsplice_magnet::Tile;

    use super::*;
    use crate::design_problem::DesignProblem;

    /// A layout with `stock` in its brief and one tile for each centre, size and direction.
    fn layout(symmetry: &str, stock: &str, tiles: &[([f64; 2], [f64; 2], f64)]) -> Layout {
        let mut text = format!(
            "format = 1\nname = \"film\"\n[ideal]\nwavelength_mm = 10.0\nthickness_mm = 1.0\namplitude_t = 0.12\n\
             [volume]\nx_mm = [-2.0, 2.0]\ny_mm = [-2.0, 2.0]\nz_mm = [-5.0, -3.0]\nstep_mm = 0.5\n\
             [design]\nvary = [\"size\", \"position\", \"direction\"]\nsymmetry = \"{symmetry}\"\n\
             stock = [{stock}]\n"
        );
        for ([x, y], [width, depth], direction_deg) in tiles {
            text += &format!(
                "[[tile]]\nposition_mm = [{x:?}, {y:?}, 0.5]\nsize_mm = [{width:?}, {depth:?}, 1.0]\n\
                 strength_t = 0.12\ndirection_deg = {direction_deg:?}\n"
            );
        }
        Layout::parse(&text, "film").unwrap_or_else(|e| panic!("{e}"))
    }

    fn problem(layout: &Layout) -> DesignProblem<'_> {
        DesignProblem::new(layout).unwrap_or_else(|e| panic!("{e}"))
    }

    fn assignment(problem: &DesignProblem) -> PartAssignment {
        let start = problem.pattern.start.clone();
        let candidate = problem.least_squares.candidate_at(&problem.pattern, start).expect("a field");
        PartAssignment::new(&problem.brief, &problem.pattern, &candidate)
    }

    /// The tiles that the parts of an assignment make.
    fn made(assignment: &PartAssignment, problem: &DesignProblem) -> Vec<Tile> {
        let pattern = assignment.pattern(problem.brief.vary, &problem.pattern);
        pattern.all_tiles(&pattern.start).expect("sides above 0")
    }

    fn assert_same(made: &[Tile], wanted: &[Tile]) {
        assert_eq!(made.len(), wanted.len());
        for (made, wanted) in made.iter().zip(wanted) {
            // Sums and rotations of numbers of a few units.
            assert!((made.size() - wanted.size()).length() < 1e-12, "{made:?}, {wanted:?}");
            assert!((made.position() - wanted.position()).length() < 1e-12, "{made:?}, {wanted:?}");
            assert!((made.polarization_t() - wanted.polarization_t()).length() < 1e-12, "{made:?}, {wanted:?}");
        }
    }

    /// A square polarized at 30 degrees, turned over its diagonal, is one at 60 degrees.
    #[test]
    fn mirror_images_become_one_part_and_stay_as_they_are() {
        let layout = layout("none", "", &[([-3.0, 1.0], [3.0, 3.0], 60.0), ([3.0, 0.0], [3.0, 3.0], 30.0)]);
        let problem = problem(&layout);
        let exchanged = assignment(&problem).with_merged(0, 1, true, true).expect("no demand forbids it");
        assert_eq!((exchanged.assignment.free(), exchanged.distance), (1, 0.0));
        assert_same(&made(&exchanged.assignment, &problem), &layout.bare_tiles());
        // Without the exchange both get the mean direction.
        let plain = assignment(&problem).with_merged(0, 1, false, true).expect("no demand forbids it");
        let diagonal = DVec3::new(0.5_f64.sqrt(), 0.5_f64.sqrt(), 0.0);
        for tile in made(&plain.assignment, &problem) {
            assert!((tile.polarization_t().normalize() - diagonal).length() < 1e-12, "{tile:?}");
        }
    }

    /// A tile of 3 x 2 mm polarized at 60 degrees is a quarter turn and a turning over away from a part
    /// of 2 x 3 mm at 30 degrees.
    #[test]
    fn tile_is_made_of_a_part_in_stock_with_exchanged_sides() {
        let stock = "{ size_mm = [2.0, 3.0], direction_deg = 30.0 }";
        let layout = layout("none", stock, &[([-3.0, 1.0], [3.0, 2.0], 60.0)]);
        let problem = problem(&layout);
        let nearest = assignment(&problem).merged(true).into_iter().min_by(|a, b| a.distance.total_cmp(&b.distance));
        let nearest = nearest.expect("the part in stock");
        assert_eq!((nearest.assignment.free(), nearest.distance), (0, 0.0));
        assert_same(&made(&nearest.assignment, &problem), &layout.bare_tiles());
    }

    /// A tile on a mirror binds the part that it shares. A tile beside the mirrors is still free to
    /// become the diagonal part of another tile.
    #[test]
    fn exchanged_tile_takes_its_own_demands_along() {
        let tiles = [
            // On the mirror y = 0.
            ([4.0, 0.0], [2.0, 2.0], 0.0),
            ([-4.0, 0.0], [2.0, 2.0], 180.0),
            ([0.0, 4.0], [2.0, 2.0], 90.0),
            ([0.0, -4.0], [2.0, 2.0], 270.0),
            // On the diagonals.
            ([7.0, 7.0], [2.0, 2.0], 45.0),
            ([-7.0, 7.0], [2.0, 2.0], 135.0),
            ([7.0, -7.0], [2.0, 2.0], 315.0),
            ([-7.0, -7.0], [2.0, 2.0], 225.0),
            // On none.
            ([7.0, 3.0], [2.0, 2.0], 20.0),
            ([7.0, -3.0], [2.0, 2.0], 340.0),
            ([-7.0, 3.0], [2.0, 2.0], 160.0),
            ([-7.0, -3.0], [2.0, 2.0], 200.0),
            ([3.0, 7.0], [2.0, 2.0], 70.0),
            ([-3.0, 7.0], [2.0, 2.0], 110.0),
            ([3.0, -7.0], [2.0, 2.0], 290.0),
            ([-3.0, -7.0], [2.0, 2.0], 250.0),
        ];
        let layout = layout("four-fold", "", &tiles);
        let problem = problem(&layout);
        let apart = assignment(&problem);
        let of = |class: SymmetryClass| apart.placed.iter().position(|placed| placed.class == class).expect("one each");
        let [free, axis, diagonal] = [SymmetryClass::Free, SymmetryClass::Axis, SymmetryClass::Diagonal].map(of);
        let shared = apart.with_merged(free, axis, false, true).expect("a free part").assignment;
        assert_eq!(shared.parts[shared.placed[free].part].class, SymmetryClass::Axis);
        let moved = shared.with_one_exchanged(true);
        let all_ways: Vec<usize> = moved.iter().map(|assignment| assignment.placed[free].part).collect();
        assert!(all_ways.contains(&diagonal), "{all_ways:?}");
    }

    /// Parts in stock count as exactly along a side or a diagonal if they are so to six digits. Each is
    /// described with its polarization within the first right angle.
    #[test]
    fn parts_in_stock_are_recognized_by_their_symmetry() {
        let part = |size_mm: [f64; 2], direction_deg: f64| part_in_stock(&StockPart { size_mm, direction_deg }, 0.12);
        let cases = [
            // A direction of 1e-6 degrees is 2e-8 radians.
            ([2.0, 3.0], 1e-6, SymmetryClass::Axis, [2.0, 3.0], 0.0),
            ([2.0, 3.0], 180.0 - 1e-6, SymmetryClass::Axis, [2.0, 3.0], 0.0),
            // Along the second side, which becomes the first.
            ([2.0, 3.0], 90.0 - 1e-6, SymmetryClass::Axis, [3.0, 2.0], 0.0),
            ([2.0, 3.0], -90.0, SymmetryClass::Axis, [3.0, 2.0], 0.0),
            ([3.0, 3.0], 45.0 + 1e-6, SymmetryClass::Diagonal, [3.0, 3.0], FRAC_PI_4),
            ([3.0, 3.0], 225.0, SymmetryClass::Diagonal, [3.0, 3.0], FRAC_PI_4),
        ];
        for (size_mm, direction_deg, class, size, angle) in cases {
            let found = part(size_mm, direction_deg);
            assert_eq!((found.class, found.size, found.angle), (class, size, angle), "{direction_deg} degrees");
            assert!(found.in_stock && found.strength == 0.12);
        }
        // No square, so that its diagonal is no symmetry; and no special direction.
        for (size_mm, direction_deg, angle_deg) in [([2.0, 3.0], 45.0, 45.0_f64), ([3.0, 3.0], 150.0, 30.0)] {
            let found = part(size_mm, direction_deg);
            assert_eq!((found.class, found.size), (SymmetryClass::Free, size_mm), "{direction_deg} degrees");
            assert!((found.angle - angle_deg.to_radians()).abs() < 1e-15, "{}", found.angle);
        }
    }
}
