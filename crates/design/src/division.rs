//! The tiles of a film as parts: which tile is of which part, and how it lies.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use glam::DVec3;
use magsplice_layout::StockPart;

use crate::affine::Affine;
use crate::descent::Found;
use crate::pattern::{Kind, Pattern, Shape, unit_vector};
use crate::setting::Setting;
use crate::symmetry::{Operation, Orbit};
use crate::tolerances::SAME_TILE;

/// What the symmetry of the tiles made of a part demands of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Class {
    /// Nothing.
    Free,
    /// Polarized along its first side.
    Axis,
    /// Square, polarized along its diagonal.
    Diagonal,
}

impl Class {
    fn with(self, other: Class) -> Option<Class> {
        match (self, other) {
            (a, b) if a == b => Some(a),
            (Class::Free, other) | (other, Class::Free) => Some(other),
            _ => None,
        }
    }
}

#[derive(Clone, Copy, Debug)]
struct Part {
    /// First and second side.
    size: [f64; 2],
    /// From the first side to the second, within a right angle, in radians.
    angle: f64,
    strength: f64,
    class: Class,
    /// Whether it is at hand, so that nothing of it may change.
    at_hand: bool,
}

/// Which tile is of which part, and how it lies: the operation takes the part's frame to the tile's.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    part: usize,
    lies: Operation,
    centre: [f64; 2],
    /// What its symmetry demands of its part.
    class: Class,
}

#[derive(Clone, Debug)]
pub(crate) struct Division {
    parts: Vec<Part>,
    pub(crate) placed: Vec<Placed>,
}

/// A division with two parts made one.
pub(crate) struct Merged {
    pub(crate) division: Division,
    /// How much longer and shorter sides differ.
    pub(crate) distance: f64,
}

impl Division {
    /// A part for every tile of a film, and those at hand.
    pub(crate) fn of(setting: &Setting, pattern: &Pattern, found: &Found) -> Division {
        let mut division = Division { parts: Vec::new(), placed: Vec::new() };
        for shape in &pattern.shapes {
            let [lower, upper] = shape.corners(&found.at);
            let centre = 0.5 * (lower + upper);
            let j = shape.polarization_t(&found.at);
            let (part, lies) = part_of(&shape.orbit, upper - lower, j);
            let (centre, class) = ([centre.x, centre.y], part.class);
            division.placed.push(Placed { part: division.parts.len(), lies, centre, class });
            division.parts.push(part);
        }
        let strength = division.parts.iter().map(|part| part.strength).fold(0.0, f64::max);
        division.parts.extend(setting.brief.stock.iter().map(|stock| at_hand(stock, strength)));
        division
    }

    /// Parts that tiles are made of.
    pub(crate) fn used(&self) -> Vec<usize> {
        (0..self.parts.len()).filter(|&part| self.placed.iter().any(|placed| placed.part == part)).collect()
    }

    /// How many of them are not at hand.
    pub(crate) fn free(&self) -> usize {
        self.used().into_iter().filter(|&part| !self.parts[part].at_hand).count()
    }

    /// Every way to make one part of two.
    pub(crate) fn merged(&self, turns: bool) -> Vec<Merged> {
        let used = self.used();
        let mut all = Vec::new();
        for &from in used.iter().filter(|&&part| !self.parts[part].at_hand) {
            for into in 0..self.parts.len() {
                let at_hand = self.parts[into].at_hand;
                if into == from || (!at_hand && (into < from || !used.contains(&into))) {
                    continue;
                }
                for flip in [false, true] {
                    all.extend(self.with_merged(from, into, flip, turns));
                }
            }
        }
        all
    }

    /// The tiles of one part made of another; `flip` lays them across. Where angles may not turn, the other part's holds.
    fn with_merged(&self, from: usize, into: usize, flip: bool, turns: bool) -> Option<Merged> {
        let tiles: Vec<usize> = (0..self.placed.len()).filter(|&i| self.placed[i].part == from).collect();
        let own = self.placed.iter().filter(|placed| placed.part == into).count() as f64;
        let (a, b) = (self.parts[from], self.parts[into]);
        let class = a.class.with(b.class)?;
        if b.at_hand && class != b.class {
            return None;
        }
        // Only a tile that nothing fixes can lie across; of two parts one is enough.
        let across = if a.class == Class::Free { from } else { into };
        if flip && (self.parts[across].class != Class::Free || b.at_hand && across == into) {
            return None;
        }
        let mut division = self.clone();
        let turned = |part: Part, turn: bool| match turn {
            true => Part { size: [part.size[1], part.size[0]], angle: FRAC_PI_2 - part.angle, ..part },
            false => part,
        };
        let (a, b) = (turned(a, flip && across == from), turned(b, flip && across == into));
        if flip {
            let lain = division.placed.iter_mut().filter(|placed| placed.part == across);
            lain.for_each(|placed| placed.lies = placed.lies.after_exchange());
        }
        let share = tiles.len() as f64 / (tiles.len() as f64 + own);
        let mean = |a: f64, b: f64| share * a + (1.0 - share) * b;
        let mut size = [mean(a.size[0], b.size[0]), mean(a.size[1], b.size[1])];
        let distance = (a.size[0] - b.size[0]).hypot(a.size[1] - b.size[1]);
        let angle = match class {
            Class::Free if turns => mean(a.angle, b.angle),
            Class::Free => b.angle,
            Class::Axis => 0.0,
            Class::Diagonal => {
                size = [0.5 * (size[0] + size[1]); 2];
                FRAC_PI_4
            }
        };
        if !b.at_hand {
            division.parts[into] = Part { size, angle, strength: mean(a.strength, b.strength), class, at_hand: false };
        }
        tiles.iter().for_each(|&tile| division.placed[tile].part = into);
        Some(Merged { division, distance })
    }

    /// Every way to give one tile another part that is in use or at hand.
    pub(crate) fn with_one_exchanged(&self, turns: bool) -> Vec<Division> {
        let used = self.used();
        let mut all = Vec::new();
        for tile in 0..self.placed.len() {
            let Placed { part: own, class, .. } = self.placed[tile];
            // Alone in a part of its own first, then that part is merged.
            let single = self.parts.len();
            let mut alone = self.clone();
            alone.placed[tile].part = single;
            alone.parts.push(Part { at_hand: false, class, ..self.parts[own] });
            if !self.parts[own].at_hand {
                let left = alone.placed.iter().filter(|placed| placed.part == own).map(|placed| placed.class);
                // They went together before, so they do.
                alone.parts[own].class = left.fold(Class::Free, |all, class| all.with(class).unwrap_or(all));
            }
            for into in (0..single).filter(|&p| p != own && (used.contains(&p) || self.parts[p].at_hand)) {
                for flip in [false, true] {
                    let merged = alone.with_merged(single, into, flip, turns);
                    all.extend(merged.map(|Merged { mut division, .. }| {
                        division.parts.truncate(single);
                        division
                    }));
                }
            }
        }
        all
    }

    /// The same division with sizes, angles and places as found.
    pub(crate) fn at(mut self, pattern: &Pattern, found: &Found) -> Division {
        for (placed, shape) in self.placed.iter_mut().zip(&pattern.shapes) {
            let [lower, upper] = shape.corners(&found.at);
            let centre = 0.5 * (lower + upper);
            placed.centre = [centre.x, centre.y];
            let part = &mut self.parts[placed.part];
            if !part.at_hand {
                let back = placed.lies.inverse();
                let size = back.of_size(upper - lower);
                part.size = [size.x, size.y];
                let j = shape.polarization_t(&found.at);
                part.strength = j.length();
                let unit = back.of(j);
                part.angle = unit.y.atan2(unit.x);
            }
        }
        self
    }

    pub(crate) fn pattern(&self, setting: &Setting, like: &Pattern) -> Pattern {
        let vary = setting.brief.vary;
        let mut pattern = Pattern { shapes: Vec::new(), kinds: Vec::new(), start: Vec::new(), tiles: like.tiles };
        let mut free = |kind: Kind, start: f64| {
            pattern.kinds.push(kind);
            pattern.start.push(start);
            Affine::variable(pattern.start.len() - 1)
        };
        // Strengths that were fixed before stay fixed.
        let scales = vary.strength && like.kinds.contains(&Kind::Strength);
        let used = self.used();
        let numbers: Vec<[Affine; 4]> = (self.parts.iter().enumerate())
            .map(|(index, part)| {
                let constant = part.at_hand || !used.contains(&index);
                let mut number = |kind: Kind, start: f64, varies: bool| {
                    if varies && !constant { free(kind, start) } else { Affine::constant(start) }
                };
                let first = number(Kind::Length, part.size[0], vary.size);
                let second = match part.class {
                    Class::Diagonal => first.clone(),
                    _ => number(Kind::Length, part.size[1], vary.size),
                };
                let turns = vary.direction && part.class == Class::Free;
                [first, second, number(Kind::Angle, part.angle, turns), number(Kind::Strength, part.strength, scales)]
            })
            .collect();
        for (placed, shape) in self.placed.iter().zip(&like.shapes) {
            let orbit = &shape.orbit;
            let [first, second, angle, strength] = &numbers[placed.part];
            let sizes = if placed.lies.exchange { [second, first] } else { [first, second] };
            let mut centre = |axis: usize| match (orbit.on_mirror[axis], vary.position) {
                (true, _) => Affine::constant(0.0),
                (false, true) => free(Kind::Length, placed.centre[axis]),
                (false, false) => Affine::constant(placed.centre[axis]),
            };
            let x = centre(0);
            let y = if orbit.on_diagonal { x.clone() } else { centre(1) };
            let along =
                |centre: &Affine, size: &Affine| [centre.minus(&size.times(0.5)), centre.plus(&size.times(0.5))];
            let in_degrees = angle.constant.to_degrees();
            pattern.shapes.push(Shape {
                orbit: orbit.clone(),
                faces: [along(&x, sizes[0]), along(&y, sizes[1]), shape.faces[2].clone()],
                direction: placed.lies.of_angle(angle),
                tilt: Affine::constant(0.0),
                strength: strength.clone(),
                unit: placed.lies.of(unit_vector([in_degrees, 0.0])),
                as_it_was: shape.as_it_was,
            });
        }
        pattern
    }
}

impl Operation {
    /// This after an exchange of the two axes.
    fn after_exchange(self) -> Operation {
        Operation { exchange: !self.exchange, ..self }
    }

    /// What becomes of the angle of an arrow.
    fn of_angle(self, angle: &Affine) -> Affine {
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

/// The part a tile is, and how it lies.
fn part_of(orbit: &Orbit, size: DVec3, j: DVec3) -> (Part, Operation) {
    let sign = |component: f64| if component < 0.0 { -1.0 } else { 1.0 };
    let signs = [sign(j.x), sign(j.y)];
    let (class, exchange) = match (orbit.on_diagonal, orbit.on_mirror) {
        (true, _) => (Class::Diagonal, false),
        (false, [false, false]) => (Class::Free, size.y > size.x),
        (false, [on_x, _]) => (Class::Axis, on_x),
    };
    let lies = Operation { exchange, signs };
    let (size, unit) = (lies.inverse().of_size(size), lies.inverse().of(j));
    let angle = unit.y.atan2(unit.x);
    (Part { size: [size.x, size.y], angle, strength: j.length(), class, at_hand: false }, lies)
}

/// A part of the stock, its polarization within the first right angle.
fn at_hand(stock: &StockPart, strength: f64) -> Part {
    let direction = unit_vector([stock.direction_deg, 0.0]).abs();
    let angle = direction.y.atan2(direction.x);
    let [first, second] = stock.size_mm;
    let near = |a: f64, b: f64| (a - b).abs() <= SAME_TILE;
    let part = Part { size: [first, second], angle, strength, class: Class::Free, at_hand: true };
    if near(angle, 0.0) {
        Part { class: Class::Axis, angle: 0.0, ..part }
    } else if near(angle, FRAC_PI_2) {
        Part { class: Class::Axis, angle: 0.0, size: [second, first], ..part }
    } else if near(angle, FRAC_PI_4) && near(first, second) {
        Part { class: Class::Diagonal, angle: FRAC_PI_4, ..part }
    } else {
        part
    }
}
