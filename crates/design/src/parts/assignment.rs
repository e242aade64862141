//! Assignment of tiles to distinct parts: which tile is made of which part, and in which
//! orientation.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use glam::DVec3;
use magsplice_layout::{Brief, StockPart, Variable, direction_from_degrees};

use crate::problem::affine::Affine;
use crate::problem::least_squares::Candidate;
use crate::problem::pattern::{Pattern, PatternBuilder, VariableKind, VariableTile};
use crate::problem::symmetry::{Orbit, SymmetryOperation};
use crate::tolerances::SAME_TILE;

/// Symmetry that a part must have: the symmetry of all its tiles.
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

    /// The pairs of parts of which the first can become the second.
    fn pairs(&self) -> Vec<(usize, usize)> {
        let used = self.used();
        let is_whole = |part: usize| self.parts[part].in_stock;
        let may_become = |from: usize, into: usize| is_whole(into) || (into > from && used.contains(&into));
        let froms = used.iter().copied().filter(|&from| !is_whole(from));
        let of_part = |from| (0..self.parts.len()).filter(move |&into| into != from).map(move |into| (from, into));
        froms.flat_map(of_part).filter(|&(from, into)| may_become(from, into)).collect()
    }

    /// Every way to merge two parts. `turns` is whether directions may change.
    pub(crate) fn merged(&self, turns: bool) -> Vec<MergedAssignment> {
        let both =
            |(from, into)| [false, true].into_iter().filter_map(move |flip| self.with_merged(from, into, flip, turns));
        self.pairs().into_iter().flat_map(both).collect()
    }

    /// The assignment in which the two parts of the nearest sizes are merged.
    pub(crate) fn nearest_merged(&self, turns: bool) -> Option<PartAssignment> {
        let distances = |(from, into): (usize, usize)| {
            let ([a, b], [c, d]) = (self.parts[from].size, self.parts[into].size);
            [((a - c).hypot(b - d), from, into, false), ((a - d).hypot(b - c), from, into, true)]
        };
        let mut pairs: Vec<(f64, usize, usize, bool)> = self.pairs().into_iter().flat_map(distances).collect();
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        pairs.into_iter().find_map(|(_, from, into, flip)| Some(self.with_merged(from, into, flip, turns)?.assignment))
    }

    /// The assignment in which the tiles of part `from` become part `into`. `flip` exchanges their
    /// sides. Where directions may not change, `into` keeps its direction. `None` if symmetry or
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

    /// All assignments with one tile moved to another part, in use or in stock.
    pub(crate) fn with_one_exchanged(&self, turns: bool) -> Vec<PartAssignment> {
        let used = self.used();
        let mut all = Vec::new();
        for tile in 0..self.placed.len() {
            let PlacedPart { part: own, class, .. } = self.placed[tile];
            // The tile first gets a part of its own, then that part is merged.
            let single = self.parts.len();
            let mut alone = self.clone();
            alone.placed[tile].part = single;
            // A merger reads `in_stock` only from the part that stays.
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

    /// The pattern whose variables are the free parameters of the parts and the positions of the
    /// tiles.
    pub(crate) fn pattern(&self, brief: &Brief, like: &Pattern) -> Pattern {
        let (mut builder, mut tiles) = (PatternBuilder::default(), Vec::new());
        // Strengths that were fixed before stay fixed.
        let scales = brief.varies(Variable::Strength) && like.kinds.contains(&VariableKind::Strength);
        let (used, sizes_vary) = (self.used(), brief.varies(Variable::Size));
        let numbers: Vec<[Affine; 4]> = (self.parts.iter().enumerate())
            .map(|(index, part)| {
                let constant = part.in_stock || !used.contains(&index);
                let mut number = |kind, start, varies| builder.number(kind, start, varies && !constant);
                let first = number(VariableKind::Length, part.size[0], sizes_vary);
                let second = match part.class {
                    SymmetryClass::Diagonal => first.clone(),
                    _ => number(VariableKind::Length, part.size[1], sizes_vary),
                };
                let turns = brief.varies(Variable::Direction) && part.class == SymmetryClass::Free;
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
            let mut centre = |axis: usize| match orbit.on_mirror[axis] {
                true => Affine::constant(0.0),
                false => builder.number(VariableKind::Length, placed.centre[axis], brief.varies(Variable::Position)),
            };
            let x = centre(0);
            let y = if orbit.on_diagonal { x.clone() } else { centre(1) };
            let along =
                |centre: &Affine, size: &Affine| [centre.minus(&size.times(0.5)), centre.plus(&size.times(0.5))];
            let in_degrees = angle.constant.to_degrees();
            tiles.push(VariableTile {
                orbit: orbit.clone(),
                faces: [along(&x, sizes[0]), along(&y, sizes[1]), variable_tile.faces[2].clone()],
                direction: placed.orientation.apply_to_angle(angle),
                tilt: Affine::constant(0.0),
                strength: strength.clone(),
                unit: placed.orientation.apply(direction_from_degrees([in_degrees, 0.0])),
                original: variable_tile.original,
            });
        }
        builder.pattern(tiles, like.tile_count)
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
mod tests;
