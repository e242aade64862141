//! Patterns: the tiles of a film as functions of the variables of its design.

use std::f64::consts::TAU;

use glam::DVec3;
use magsplice_layout::{Brief, Symmetry, Variable};
use magsplice_magnet::Tile;

use crate::problem::affine::Affine;
use crate::problem::symmetry::{Orbit, SymmetryOperation};
use crate::tolerances::SAME_TILE;

/// The quantity that a variable measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum VariableKind {
    /// In millimetres.
    Length,
    /// In radians.
    Angle,
    /// In tesla.
    Strength,
}

/// The representative tile of an orbit, each of its numbers an affine function of the variables.
#[derive(Clone, Debug)]
pub(crate) struct VariableTile {
    pub(crate) orbit: Orbit,
    /// Coordinates of the lower and the upper face, by axis.
    pub(crate) faces: [[Affine; 2]; 3],
    /// Angle of the polarization from x towards y, in radians.
    pub(crate) direction: Affine,
    /// Angle of the polarization out of the plane towards z, in radians.
    pub(crate) tilt: Affine,
    /// Magnitude of the polarization, in tesla.
    pub(crate) strength: Affine,
    /// Unit vector of the polarization. It is used while no angle is free, so that constant
    /// directions keep every digit.
    pub(crate) unit: DVec3,
    /// The tile of the layout.
    pub(crate) original: Tile,
}

/// A film with some of its numbers free.
#[derive(Clone, Debug)]
pub(crate) struct Pattern {
    /// One tile for each orbit.
    pub(crate) tiles: Vec<VariableTile>,
    /// The quantity of each variable.
    pub(crate) kinds: Vec<VariableKind>,
    /// Values of the variables in the film of the layout.
    pub(crate) start: Vec<f64>,
    /// Number of all tiles, images included.
    pub(crate) tile_count: usize,
}

impl VariableTile {
    pub(crate) fn polarization_t(&self, variables: &[f64]) -> DVec3 {
        if self.direction.terms.is_empty() && self.tilt.terms.is_empty() {
            return self.strength.eval(variables) * self.unit;
        }
        let [.., unit] = self.polarization_derivatives(variables);
        self.strength.eval(variables) * unit
    }

    /// Derivatives of the polarization with respect to direction, tilt and strength.
    pub(crate) fn polarization_derivatives(&self, variables: &[f64]) -> [DVec3; 3] {
        let (direction, tilt, strength) =
            (self.direction.eval(variables), self.tilt.eval(variables), self.strength.eval(variables));
        [
            strength * tilt.cos() * DVec3::new(-direction.sin(), direction.cos(), 0.0),
            strength * DVec3::new(-tilt.sin() * direction.cos(), -tilt.sin() * direction.sin(), tilt.cos()),
            DVec3::new(tilt.cos() * direction.cos(), tilt.cos() * direction.sin(), tilt.sin()),
        ]
    }

    /// Lower and upper corner.
    pub(crate) fn corners(&self, variables: &[f64]) -> [DVec3; 2] {
        [0, 1].map(|end| DVec3::from([0, 1, 2].map(|axis| self.faces[axis][end].eval(variables))))
    }

    /// Whether the faces normal to an axis, which must be constants, differ from the faces of the
    /// layout's tile.
    pub(crate) fn faces_moved(&self, axis: usize) -> bool {
        let half = 0.5 * self.original.size()[axis];
        let centre = self.original.position()[axis];
        let [lower, upper] = &self.faces[axis];
        lower.constant != centre - half || upper.constant != centre + half
    }

    /// The tile at these values. `None` where a side is not positive.
    pub(crate) fn tile(&self, variables: &[f64]) -> Option<Tile> {
        let [lower, upper] = self.corners(variables);
        let tile = Tile::new(0.5 * (lower + upper), upper - lower, self.polarization_t(variables)).ok()?;
        tile.rotated(self.original.rotation()).ok()
    }

    /// Lower and upper faces of an image along x and y.
    pub(crate) fn image_faces(&self, operation: SymmetryOperation) -> [[Affine; 2]; 2] {
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
    /// The pattern in which each number that the brief lets vary is a variable, unless symmetry
    /// determines it.
    pub(crate) fn new(tiles: &[Tile], orbits: &[Orbit], brief: &Brief) -> Pattern {
        let mut builder = PatternBuilder::default();
        let representatives =
            orbits.iter().map(|orbit| builder.variable_tile(&tiles[orbit.tile], orbit, brief)).collect();
        builder.pattern(representatives, tiles.len())
    }

    /// All tiles, in the order of the layout.
    pub(crate) fn all_tiles(&self, variables: &[f64]) -> Option<Vec<Tile>> {
        self.images_of(|variable_tile| variable_tile.tile(variables)).ok()
    }

    /// All tiles, as images of the tiles that a function returns. The error is the index of the
    /// first tile that cannot exist.
    pub(crate) fn images_of(&self, tile: impl Fn(&VariableTile) -> Option<Tile>) -> Result<Vec<Tile>, usize> {
        let mut tiles = vec![Err(0); self.tile_count];
        for variable_tile in &self.tiles {
            let tile = tile(variable_tile).ok_or(variable_tile.orbit.tile)?;
            for &(operation, index) in &variable_tile.orbit.images {
                tiles[index] = image(&tile, operation).ok_or(index);
            }
        }
        tiles.into_iter().collect()
    }
}

/// The image of a tile; only the identity keeps a rotation.
pub(crate) fn image(tile: &Tile, operation: SymmetryOperation) -> Option<Tile> {
    if operation == SymmetryOperation::IDENTITY {
        return Some(*tile);
    }
    let (position, size) = (operation.apply(tile.position()), operation.apply_to_size(tile.size()));
    Tile::new(position, size, operation.apply(tile.polarization_t())).ok()
}

/// Angles of a polarization in the plane and out of it, in radians.
pub(crate) fn angles(polarization_t: DVec3) -> [f64; 2] {
    let plane = polarization_t.truncate().length();
    [polarization_t.y.atan2(polarization_t.x), polarization_t.z.atan2(plane)]
}

/// A pattern under construction, with the variables that several tiles share.
#[derive(Default)]
pub(crate) struct PatternBuilder {
    kinds: Vec<VariableKind>,
    start: Vec<f64>,
    /// Coordinates that faces share, with axis and variable: cut lines along x and y, upper faces
    /// along z.
    shared: Vec<(usize, f64, Affine)>,
}

impl PatternBuilder {
    pub(crate) fn pattern(self, tiles: Vec<VariableTile>, tile_count: usize) -> Pattern {
        Pattern { tiles, kinds: self.kinds, start: self.start, tile_count }
    }

    fn variable(&mut self, kind: VariableKind, start: f64) -> Affine {
        self.kinds.push(kind);
        self.start.push(start);
        Affine::variable(self.start.len() - 1)
    }

    /// A variable, or a constant if it is not free.
    pub(crate) fn number(&mut self, kind: VariableKind, start: f64, is_free: bool) -> Affine {
        if is_free { self.variable(kind, start) } else { Affine::constant(start) }
    }

    fn variable_tile(&mut self, tile: &Tile, orbit: &Orbit, brief: &Brief) -> VariableTile {
        let x = self.faces_along(0, tile, orbit, brief);
        let y = if orbit.on_diagonal && !brief.varies(Variable::Cut) {
            x.clone()
        } else {
            self.faces_along(1, tile, orbit, brief)
        };
        let j = tile.polarization_t();
        let [direction, tilt] = angles(j);
        let in_plane = j.truncate() != glam::DVec2::ZERO;
        let turns = brief.varies(Variable::Direction) && in_plane && !orbit.is_fixed_direction();
        // A tile on both mirrors is polarized along z.
        let on_both = orbit.on_mirror[0] && orbit.on_mirror[1];
        let tilts = brief.varies(Variable::Tilt) && j != DVec3::ZERO && !on_both;
        let scales = brief.varies(Variable::Strength) && j != DVec3::ZERO;
        VariableTile {
            orbit: orbit.clone(),
            faces: [x, y, self.faces_in_height(tile, brief)],
            direction: self.number(VariableKind::Angle, direction, turns),
            tilt: self.number(VariableKind::Angle, tilt, tilts),
            strength: self.number(VariableKind::Strength, j.length(), scales),
            unit: j.normalize_or_zero(),
            original: *tile,
        }
    }

    fn faces_along(&mut self, axis: usize, tile: &Tile, orbit: &Orbit, brief: &Brief) -> [Affine; 2] {
        let (centre, half) = (tile.position()[axis], 0.5 * tile.size()[axis]);
        if brief.varies(Variable::Cut) {
            let slack = SAME_TILE * tile.size().max_element();
            return [centre - half, centre + half].map(|edge| self.line(axis, edge, slack, brief.symmetry));
        }
        let on_mirror = orbit.on_mirror[axis];
        match (brief.varies(Variable::Size), brief.varies(Variable::Position) && !on_mirror) {
            (true, true) => [centre - half, centre + half].map(|edge| self.variable(VariableKind::Length, edge)),
            (true, false) => {
                let centre = if on_mirror { 0.0 } else { centre };
                let half = self.variable(VariableKind::Length, 2.0 * half).times(0.5);
                [-1.0, 1.0].map(|side| Affine::constant(centre).plus(&half.times(side)))
            }
            (false, true) => {
                let moving = self.variable(VariableKind::Length, centre);
                [-half, half].map(|side| moving.plus(&Affine::constant(side)))
            }
            (false, false) => [centre - half, centre + half].map(Affine::constant),
        }
    }

    /// The cut line at a coordinate. Its images share its variable: the line at -x, and the same
    /// lines along y.
    fn line(&mut self, axis: usize, coordinate: f64, slack: f64, symmetry: Symmetry) -> Affine {
        if symmetry != Symmetry::None && coordinate.abs() <= slack {
            return Affine::constant(0.0);
        }
        let (key, sign) =
            if symmetry == Symmetry::None { (coordinate, 1.0) } else { (coordinate.abs(), coordinate.signum()) };
        let axis = if symmetry == Symmetry::FourFold { 0 } else { axis };
        self.shared(axis, key, slack).times(sign)
    }

    /// The variable of a coordinate along an axis, a new one unless it is known already.
    fn shared(&mut self, axis: usize, key: f64, slack: f64) -> Affine {
        let known = self.shared.iter().find(|(along, known, _)| *along == axis && (known - key).abs() <= slack);
        if let Some((.., variable)) = known {
            return variable.clone();
        }
        let variable = self.variable(VariableKind::Length, key);
        self.shared.push((axis, key, variable.clone()));
        variable
    }

    fn faces_in_height(&mut self, tile: &Tile, brief: &Brief) -> [Affine; 2] {
        let (centre, half) = (tile.position().z, 0.5 * tile.size().z);
        let [lower, upper] = [centre - half, centre + half];
        if !brief.varies(Variable::Thickness) {
            return [lower, upper].map(Affine::constant);
        }
        [Affine::constant(lower), self.shared(2, upper, SAME_TILE * half)]
    }
}

/// The same angle within half a turn of zero.
pub(crate) fn half_turn(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}

#[cfg(test)]
mod tests {
    use magsplice_layout::Layout;

    use super::*;
    use crate::problem::design_problem::DesignProblem;

    /// The kinds of the variables of tiles, given by position and polarization, under a brief.
    fn kinds(brief: &str, tiles: &[([f64; 3], [f64; 3])]) -> Vec<VariableKind> {
        let mut text = format!(
            "format = 1\nname = \"film\"\n[ideal]\nwavelength_mm = 10.0\nthickness_mm = 1.0\namplitude_t = 0.12\n\
             [volume]\nx_mm = [-2.0, 2.0]\ny_mm = [-2.0, 2.0]\nz_mm = [-5.0, -3.0]\nstep_mm = 0.5\n[design]\n{brief}\n"
        );
        for (position, polarization) in tiles {
            text += &format!(
                "[[tile]]\nposition_mm = {position:?}\nsize_mm = [1.5, 1.5, 1.0]\npolarization_t = {polarization:?}\n"
            );
        }
        let layout = Layout::parse(&text, "film").unwrap_or_else(|e| panic!("{e}"));
        DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}")).pattern.kinds
    }

    fn count(kinds: &[VariableKind], kind: VariableKind) -> usize {
        kinds.iter().filter(|of| **of == kind).count()
    }

    /// A tile tilts unless it has no J, or lies on both mirrors, which hold J upright.
    #[test]
    fn tiles_with_a_free_polarization_tilt() {
        let brief = "vary = [\"tilt\"]\nsymmetry = \"none\"";
        let upright = [0.0, 0.0, 0.12];
        let both = [([-3.0, 1.0, 0.5], [0.12, 0.0, 0.0]), ([3.0, 1.0, 0.5], upright)];
        assert_eq!(count(&kinds(brief, &both), VariableKind::Angle), 2);
        let one = [([-3.0, 1.0, 0.5], [0.12, 0.0, 0.0]), ([3.0, 1.0, 0.5], [0.0; 3])];
        assert_eq!(count(&kinds(brief, &one), VariableKind::Angle), 1);
        let brief = "vary = [\"tilt\"]\nsymmetry = \"mirror\"";
        let middle = [
            ([0.0, 0.0, 0.5], upright),
            // On one mirror: J is normal to it or in it.
            ([0.0, 3.0, 0.5], [0.0, 0.12, 0.0]),
            ([0.0, -3.0, 0.5], [0.0, -0.12, 0.0]),
        ];
        assert_eq!(count(&kinds(brief, &middle), VariableKind::Angle), 1);
    }

    /// Lines on a mirror stay. Without symmetry a line through the origin is one as any other.
    #[test]
    fn cut_lines_on_a_mirror_stay() {
        let tiles = [
            ([-0.75, 3.0, 0.5], [0.12, 0.0, 0.0]),
            ([0.75, 3.0, 0.5], [-0.12, 0.0, 0.0]),
            ([-0.75, -3.0, 0.5], [0.12, 0.0, 0.0]),
            ([0.75, -3.0, 0.5], [-0.12, 0.0, 0.0]),
        ];
        // x = 0 and 1.5, y = 2.25 and 3.75 with their images.
        let mirror = kinds("vary = [\"cut\"]\nsymmetry = \"mirror\"", &tiles);
        assert_eq!(count(&mirror, VariableKind::Length), 3);
        let free = kinds("vary = [\"cut\"]\nsymmetry = \"none\"", &tiles);
        assert_eq!(count(&free, VariableKind::Length), 3 + 4);
    }

    fn film(brief: &str) -> Layout {
        let text = format!(
            "format = 1\nname = \"film\"\n[ideal]\nwavelength_mm = 10.0\nthickness_mm = 1.0\namplitude_t = 0.12\n\
             [volume]\nx_mm = [-2.0, 2.0]\ny_mm = [-2.0, 2.0]\nz_mm = [-5.0, -3.0]\nstep_mm = 0.5\n\
             [design]\nthickness_mm = {{ min = 0.5, max = 2.0 }}\nstrength_t = {{ min = 0.0, max = 0.2 }}\n{brief}\n\
             [[tile]]\nposition_mm = [1.5, 0.25, 0.5]\nsize_mm = [3.0, 2.0, 1.0]\npolarization_t = [0.09, 0.0, 0.12]\n\
             [[tile]]\nposition_mm = [-1.5, 0.25, 0.5]\nsize_mm = [3.0, 2.0, 1.0]\npolarization_t = [-0.09, 0.0, 0.12]\n"
        );
        Layout::parse(&text, "film").unwrap_or_else(|e| panic!("{e}"))
    }

    /// The first tile where the variable of this number is larger by 0.2 than in the layout.
    fn changed(brief: &str, variable: usize) -> Tile {
        let layout = film(brief);
        let pattern = DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}")).pattern;
        let start = pattern.all_tiles(&pattern.start).expect("sides above 0");
        for (start, tile) in start.iter().zip(layout.bare_tiles()) {
            assert!(start.position().distance(tile.position()) < 1e-12 && start.size().distance(tile.size()) < 1e-12);
            assert!(start.polarization_t().distance(tile.polarization_t()) < 1e-15);
        }
        let mut variables = pattern.start.clone();
        variables[variable] += 0.2;
        pattern.all_tiles(&variables).expect("sides above 0")[0]
    }

    /// What each variable is, one after the other, of a tile of 3 x 2 x 1 mm at (1.5, 0.25, 0.5) mm
    /// with 0.15 T at 0 degrees, tilted by an angle of the sides 3, 4 and 5.
    #[test]
    fn variables_are_sides_centres_faces_and_angles() {
        let none = |vary: &str| format!("vary = [{vary}]\nsymmetry = \"none\"");
        let of = |vary: &str, variable: usize| {
            let tile = changed(&none(vary), variable);
            (tile.position(), tile.size())
        };
        let assert_near = |(position, size): (DVec3, DVec3), known: [[f64; 3]; 2]| {
            let [p, s] = known.map(DVec3::from);
            assert!(position.distance(p) < 1e-12 && size.distance(s) < 1e-12, "{position} {size}, not {known:?}");
        };
        assert_near(of("\"size\"", 0), [[1.5, 0.25, 0.5], [3.2, 2.0, 1.0]]);
        assert_near(of("\"size\"", 1), [[1.5, 0.25, 0.5], [3.0, 2.2, 1.0]]);
        assert_near(of("\"position\"", 0), [[1.7, 0.25, 0.5], [3.0, 2.0, 1.0]]);
        assert_near(of("\"position\"", 1), [[1.5, 0.45, 0.5], [3.0, 2.0, 1.0]]);
        let both = "\"size\", \"position\"";
        assert_near(of(both, 0), [[1.6, 0.25, 0.5], [2.8, 2.0, 1.0]]);
        assert_near(of(both, 1), [[1.6, 0.25, 0.5], [3.2, 2.0, 1.0]]);
        assert_near(of(both, 3), [[1.5, 0.35, 0.5], [3.0, 2.2, 1.0]]);
        // Both tiles share the line x = 0, y = -0.75 and y = 1.25, and their upper face.
        assert_near(of("\"cut\"", 0), [[1.6, 0.25, 0.5], [2.8, 2.0, 1.0]]);
        assert_near(of("\"cut\"", 2), [[1.5, 0.35, 0.5], [3.0, 1.8, 1.0]]);
        assert_near(of("\"thickness\"", 0), [[1.5, 0.25, 0.6], [3.0, 2.0, 1.2]]);
        let count =
            |brief: &str| DesignProblem::new(&film(brief)).unwrap_or_else(|e| panic!("{e}")).pattern.start.len();
        assert_eq!([none("\"cut\""), none("\"thickness\""), none(both)].map(|brief| count(&brief)), [5, 1, 8]);
        let j_t = |vary: &str| changed(&none(vary), 0).polarization_t();
        let (direction, tilt) = (0.2_f64, 0.8_f64.asin() + 0.2);
        assert!(
            j_t("\"direction\"").distance(DVec3::new(0.09 * direction.cos(), 0.09 * direction.sin(), 0.12)) < 1e-15
        );
        assert!(j_t("\"tilt\"").distance(0.15 * DVec3::new(tilt.cos(), 0.0, tilt.sin())) < 1e-15);
        assert!(j_t("\"strength\"").distance(0.35 * DVec3::new(0.6, 0.0, 0.8)) < 1e-15);
    }

    /// Images of a tile by each operation, and their faces as functions of the variables.
    #[test]
    fn images_have_the_faces_of_the_operation() {
        let layout = film("vary = [\"size\", \"position\"]\nsymmetry = \"none\"");
        let pattern = DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}")).pattern;
        let variables: Vec<f64> = pattern.start.iter().enumerate().map(|(i, value)| value + 0.01 * i as f64).collect();
        let variable_tile = &pattern.tiles[0];
        let tile = variable_tile.tile(&variables).expect("sides above 0");
        for operation in SymmetryOperation::all(Symmetry::FourFold) {
            let image = image(&tile, operation).expect("sides above 0");
            assert!(image.polarization_t().distance(operation.apply(tile.polarization_t())) < 1e-15);
            for (axis, ends) in variable_tile.image_faces(operation).iter().enumerate() {
                let [lower, upper] = ends.each_ref().map(|end| end.eval(&variables));
                assert!((0.5 * (lower + upper) - image.position()[axis]).abs() < 1e-12, "{operation:?}, {axis}");
                assert!((upper - lower - image.size()[axis]).abs() < 1e-12, "{operation:?}, {axis}");
            }
        }
        let sharp = pattern.images_of(|variable_tile| (variable_tile.orbit.tile != 1).then_some(tile));
        assert_eq!(sharp, Err(1));
    }

    #[test]
    fn angles_are_within_half_a_turn() {
        for (angle, known) in [(0.5, 0.5), (4.0, 4.0 - TAU), (-4.0, TAU - 4.0), (3.0 * TAU + 0.1, 0.1)] {
            assert!((half_turn(angle) - known).abs() < 1e-14, "{angle}");
        }
    }
}
