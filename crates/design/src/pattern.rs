//! The tiles of a film as functions of the variables of its design.

use std::f64::consts::TAU;

use glam::DVec3;
use magsplice_field::Tile;
use magsplice_layout::{Brief, Symmetry, Vary};

use crate::affine::Affine;
use crate::symmetry::{Operation, Orbit};
use crate::tolerances::SAME_TILE;

/// What a variable measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Millimetres.
    Length,
    /// Radians.
    Angle,
    /// Tesla.
    Strength,
}

/// Lower and upper faces by axis, angles and magnitude of the polarization of one tile; of its images by symmetry.
#[derive(Clone, Debug)]
pub(crate) struct Shape {
    pub(crate) orbit: Orbit,
    pub(crate) faces: [[Affine; 2]; 3],
    /// From x towards y, in radians.
    pub(crate) direction: Affine,
    /// Out of the plane towards z, in radians.
    pub(crate) tilt: Affine,
    pub(crate) strength: Affine,
    /// Unit vector of the polarization, which holds to the last digit while no angle is free.
    pub(crate) unit: DVec3,
    /// The tile it was made from.
    pub(crate) as_it_was: Tile,
}

/// A film with some of its numbers free.
#[derive(Clone, Debug)]
pub(crate) struct Pattern {
    pub(crate) shapes: Vec<Shape>,
    /// What each variable measures.
    pub(crate) kinds: Vec<Kind>,
    /// Their values in the film it was made from.
    pub(crate) start: Vec<f64>,
    /// How many tiles there are, images counted.
    pub(crate) tiles: usize,
}

impl Shape {
    pub(crate) fn polarization_t(&self, at: &[f64]) -> DVec3 {
        if self.direction.terms.is_empty() && self.tilt.terms.is_empty() {
            return self.strength.at(at) * self.unit;
        }
        let (direction, tilt) = (self.direction.at(at), self.tilt.at(at));
        self.strength.at(at) * DVec3::new(tilt.cos() * direction.cos(), tilt.cos() * direction.sin(), tilt.sin())
    }

    /// The derivatives of the polarization by direction, tilt and strength.
    pub(crate) fn polarization_slopes(&self, at: &[f64]) -> [DVec3; 3] {
        let (direction, tilt, strength) = (self.direction.at(at), self.tilt.at(at), self.strength.at(at));
        [
            strength * tilt.cos() * DVec3::new(-direction.sin(), direction.cos(), 0.0),
            strength * DVec3::new(-tilt.sin() * direction.cos(), -tilt.sin() * direction.sin(), tilt.cos()),
            DVec3::new(tilt.cos() * direction.cos(), tilt.cos() * direction.sin(), tilt.sin()),
        ]
    }

    /// Lower and upper corner.
    pub(crate) fn corners(&self, at: &[f64]) -> [DVec3; 2] {
        [0, 1].map(|end| DVec3::from([0, 1, 2].map(|axis| self.faces[axis][end].at(at))))
    }

    /// Whether the faces normal to an axis, which are constants, are not those of the tile it was made from.
    pub(crate) fn faces_moved(&self, axis: usize) -> bool {
        let half = 0.5 * self.as_it_was.size()[axis];
        let centre = self.as_it_was.position()[axis];
        let [lower, upper] = &self.faces[axis];
        lower.constant != centre - half || upper.constant != centre + half
    }

    /// `None` where a side is not positive.
    pub(crate) fn tile(&self, at: &[f64]) -> Option<Tile> {
        let [lower, upper] = self.corners(at);
        let tile = Tile::new(0.5 * (lower + upper), upper - lower, self.polarization_t(at)).ok()?;
        tile.rotated(self.as_it_was.rotation()).ok()
    }

    /// Lower and upper faces along x and y of an image.
    pub(crate) fn image_faces(&self, operation: Operation) -> [[Affine; 2]; 2] {
        [0, 1].map(|axis| {
            let [lower, upper] = &self.faces[if operation.exchange { 1 - axis } else { axis }];
            if operation.signs[axis] < 0.0 {
                [upper.times(-1.0), lower.times(-1.0)]
            } else {
                [lower.clone(), upper.clone()]
            }
        })
    }
}

impl Pattern {
    /// Every number of these tiles that the brief lets vary is a variable, as far as the symmetry leaves it free.
    pub(crate) fn of(tiles: &[Tile], orbits: &[Orbit], brief: &Brief) -> Pattern {
        let mut making = Making { kinds: Vec::new(), start: Vec::new(), lines: Vec::new(), tops: Vec::new() };
        let shapes = orbits.iter().map(|orbit| making.shape(&tiles[orbit.tile], orbit, brief)).collect();
        Pattern { shapes, kinds: making.kinds, start: making.start, tiles: tiles.len() }
    }

    /// All tiles, in the order of the film it was made from.
    pub(crate) fn all_tiles(&self, at: &[f64]) -> Option<Vec<Tile>> {
        let mut tiles = vec![None; self.tiles];
        for shape in &self.shapes {
            let tile = shape.tile(at)?;
            for &(operation, index) in &shape.orbit.images {
                tiles[index] = Some(image(&tile, operation)?);
            }
        }
        tiles.into_iter().collect()
    }
}

/// The image of a tile; only the identity keeps a rotation.
pub(crate) fn image(tile: &Tile, operation: Operation) -> Option<Tile> {
    if operation == Operation::IDENTITY {
        return Some(*tile);
    }
    let (position, size) = (operation.of(tile.position()), operation.of_size(tile.size()));
    Tile::new(position, size, operation.of(tile.polarization_t())).ok()
}

/// Angles in the plane and out of it.
pub(crate) fn angles(polarization_t: DVec3) -> [f64; 2] {
    let plane = polarization_t.truncate().length();
    [polarization_t.y.atan2(polarization_t.x), polarization_t.z.atan2(plane)]
}

struct Making {
    kinds: Vec<Kind>,
    start: Vec<f64>,
    /// Cut lines: axis, coordinate, variable.
    lines: Vec<(usize, f64, usize)>,
    /// Heights of upper faces and their variables.
    tops: Vec<(f64, usize)>,
}

impl Making {
    fn variable(&mut self, kind: Kind, start: f64) -> Affine {
        self.kinds.push(kind);
        self.start.push(start);
        Affine::variable(self.start.len() - 1)
    }

    fn shape(&mut self, tile: &Tile, orbit: &Orbit, brief: &Brief) -> Shape {
        let x = self.faces_along(0, tile, orbit, brief);
        let y = if orbit.on_diagonal && !brief.vary.cut { x.clone() } else { self.faces_along(1, tile, orbit, brief) };
        let j = tile.polarization_t();
        let [direction, tilt] = angles(j);
        let Vary { direction: turns, tilt: tilts, strength: scales, .. } = brief.vary;
        let in_plane = j.truncate() != glam::DVec2::ZERO;
        let turns = turns && in_plane && !orbit.is_fixed_direction();
        // On both mirrors nothing but z is left.
        let tilts = tilts && j != DVec3::ZERO && !(orbit.on_mirror[0] && orbit.on_mirror[1]);
        let scales = scales && j != DVec3::ZERO;
        Shape {
            orbit: orbit.clone(),
            faces: [x, y, self.faces_in_height(tile, brief)],
            direction: if turns { self.variable(Kind::Angle, direction) } else { Affine::constant(direction) },
            tilt: if tilts { self.variable(Kind::Angle, tilt) } else { Affine::constant(tilt) },
            strength: if scales { self.variable(Kind::Strength, j.length()) } else { Affine::constant(j.length()) },
            unit: j.normalize_or_zero(),
            as_it_was: *tile,
        }
    }

    fn faces_along(&mut self, axis: usize, tile: &Tile, orbit: &Orbit, brief: &Brief) -> [Affine; 2] {
        let (centre, half) = (tile.position()[axis], 0.5 * tile.size()[axis]);
        let Vary { size, position, cut, .. } = brief.vary;
        if cut {
            let slack = SAME_TILE * tile.size().max_element();
            return [centre - half, centre + half].map(|at| self.line(axis, at, slack, brief.symmetry));
        }
        let on_mirror = orbit.on_mirror[axis];
        match (size, position && !on_mirror) {
            (true, true) => [centre - half, centre + half].map(|at| self.variable(Kind::Length, at)),
            (true, false) => {
                let centre = if on_mirror { 0.0 } else { centre };
                let half = self.variable(Kind::Length, 2.0 * half).times(0.5);
                [-1.0, 1.0].map(|side| Affine::constant(centre).plus(&half.times(side)))
            }
            (false, true) => {
                let moving = self.variable(Kind::Length, centre);
                [-half, half].map(|side| moving.plus(&Affine::constant(side)))
            }
            (false, false) => [centre - half, centre + half].map(Affine::constant),
        }
    }

    /// The cut line at a coordinate, and its images: lines at -x, and the same ones along y, move with it.
    fn line(&mut self, axis: usize, at: f64, slack: f64, symmetry: Symmetry) -> Affine {
        if symmetry != Symmetry::None && at.abs() <= slack {
            return Affine::constant(0.0);
        }
        let (key, sign) = if symmetry == Symmetry::None { (at, 1.0) } else { (at.abs(), at.signum()) };
        let axis = if symmetry == Symmetry::FourFold { 0 } else { axis };
        let known = self.lines.iter().find(|(of, line, _)| *of == axis && (line - key).abs() <= slack);
        let variable = match known {
            Some(&(_, _, variable)) => Affine::variable(variable),
            None => {
                let made = self.variable(Kind::Length, key);
                self.lines.push((axis, key, self.start.len() - 1));
                made
            }
        };
        variable.times(sign)
    }

    fn faces_in_height(&mut self, tile: &Tile, brief: &Brief) -> [Affine; 2] {
        let (centre, half) = (tile.position().z, 0.5 * tile.size().z);
        let [lower, upper] = [centre - half, centre + half];
        if !brief.vary.thickness {
            return [lower, upper].map(Affine::constant);
        }
        let known = self.tops.iter().find(|(top, _)| (top - upper).abs() <= SAME_TILE * half);
        let top = match known {
            Some(&(_, variable)) => Affine::variable(variable),
            None => {
                let made = self.variable(Kind::Length, upper);
                self.tops.push((upper, self.start.len() - 1));
                made
            }
        };
        [Affine::constant(lower), top]
    }
}

/// The unit vector at these angles, exactly along an axis where they say so.
pub(crate) fn unit_vector([direction_deg, tilt_deg]: [f64; 2]) -> DVec3 {
    let [(along, across), (plane, height)] = [direction_deg, tilt_deg].map(|angle| {
        let quarters = angle / 90.0;
        if quarters == quarters.round() {
            [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)][quarters.rem_euclid(4.0) as usize]
        } else {
            (angle.to_radians().cos(), angle.to_radians().sin())
        }
    });
    DVec3::new(plane * along, plane * across, height)
}

/// The angle within half a turn of zero.
pub(crate) fn half_turn(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}
