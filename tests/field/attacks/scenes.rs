//! Scenes designed to break a tolerance: a box between magnets, and specks beside the box, weak
//! enough to be overlooked and strong enough to matter.

use glam::{DQuat, DVec3};
use magsplice_field::{Grid, Quantity, Scene, Tile, Tolerance};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A scene, a box with a grid, and a tolerance.
pub(super) struct Attack {
    pub(super) tiles: Vec<Tile>,
    pub(super) grid: Grid,
    /// Points of the grid nearest to specks, and points at distances of a few sizes of a speck.
    pub(super) aimed: Vec<DVec3>,
    pub(super) tolerance: Tolerance,
}

impl Attack {
    /// The scene with this number.
    pub(super) fn new(number: u64) -> Attack {
        let mut dice = Dice { random: ChaCha8Rng::seed_from_u64(number), turns: false };
        dice.turns = dice.chance(0.4);
        let centre = if dice.chance(0.2) { dice.direction() * dice.decades(0.0, 3.0) } else { DVec3::ZERO };
        let half = DVec3::from([(); 3].map(|()| dice.decades(-0.5, 0.3)));
        let grid = dice.grid(centre, half);
        let half = 0.5 * (grid.upper() - grid.lower());
        let mut tiles = match dice.index(10) {
            0..2 => dice.lattice(centre, half),
            2 => dice.crowd(centre, half),
            _ => dice.magnets(centre, half),
        };
        let big = Scene::new(&tiles);
        let exponent = if dice.chance(0.7) { dice.between(-6.0, -2.0) } else { dice.between(-13.0, -6.0) };
        let fraction = 10_f64.powf(exponent);
        let field_t = |point| big.field(Quantity::FluxDensity, point).map_or(0.1, |b| b.length()).max(1e-12);
        let mut aimed = Vec::new();
        for _ in 0..1 + dice.index(3) {
            let (nearest, outwards) = dice.place_on_surface(&grid);
            let weak_t = field_t(nearest) * fraction * dice.decades(-0.5, 2.5);
            let any_t = 0.1 * dice.decades(-9.0, 0.5);
            let wanted_t = if dice.chance(0.6) { weak_t } else { any_t };
            let speck = dice.speck(nearest, outwards, half.max_element(), wanted_t);
            let reach = (speck.position() - nearest).length();
            tiles.push(speck);
            aimed.push(nearest);
            aimed.push(nearest - outwards * reach * dice.decades(-1.0, 0.5));
        }
        aimed.retain(|p| p.cmpge(grid.lower()).all() && p.cmple(grid.upper()).all());
        let tolerance = if dice.chance(0.6) {
            Tolerance::relative(fraction)
        } else {
            Tolerance::absolute_t(fraction * field_t(centre))
        };
        Attack { tiles, grid, aimed, tolerance: tolerance.expect("a tolerance") }
    }

    /// The largest accepted error where |B| has this value, in tesla.
    pub(super) fn allowed_t(&self, field_t: f64) -> f64 {
        match self.tolerance {
            Tolerance::Relative { fraction, .. } => fraction * field_t,
            Tolerance::AbsoluteT { error_t, .. } => error_t,
        }
    }
}

/// Random numbers, and whether tiles are rotated.
struct Dice {
    random: ChaCha8Rng,
    turns: bool,
}

impl Dice {
    fn between(&mut self, least: f64, most: f64) -> f64 {
        self.random.random_range(least..most)
    }

    /// A number whose decimal logarithm is in a range.
    fn decades(&mut self, least: f64, most: f64) -> f64 {
        10_f64.powf(self.between(least, most))
    }

    fn chance(&mut self, probability: f64) -> bool {
        self.random.random_bool(probability)
    }

    fn index(&mut self, count: usize) -> usize {
        self.random.random_range(0..count)
    }

    fn sign(&mut self) -> f64 {
        if self.chance(0.5) { 1.0 } else { -1.0 }
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::from([(); 3].map(|()| self.between(-1.0, 1.0)))
    }

    fn direction(&mut self) -> DVec3 {
        (self.vector() + DVec3::splat(1e-3)).normalize()
    }

    /// A box of many points, or in some scenes a plane of points.
    fn grid(&mut self, centre: DVec3, mut half: DVec3) -> Grid {
        let mut counts = [(); 3].map(|()| 24 + self.index(17));
        if self.chance(0.1) {
            let flat = self.index(3);
            (counts[flat], half[flat]) = (1, 0.0);
        }
        Grid::new(centre - half, centre + half, counts).expect("a grid")
    }

    /// The sides of a cube, a needle, a plate or any cuboid; the longest is 1.
    fn shape(&mut self) -> DVec3 {
        let mut sides = match self.index(5) {
            0 => [1.0; 3],
            1 => [1.0, self.decades(-5.0, -1.0), 1.0],
            2 => {
                let thin = self.decades(-5.0, -1.0);
                [thin, 1.0, thin * self.decades(-1.0, 0.0)]
            }
            _ => [1.0, self.decades(-1.5, 0.0), self.decades(-1.5, 0.0)],
        };
        sides.rotate_left(self.index(3));
        sides.into()
    }

    /// J of length 1 along an axis of its tile, or in any direction.
    fn polarization(&mut self) -> DVec3 {
        if self.chance(0.4) { self.sign() * DVec3::AXES[self.index(3)] } else { self.direction() }
    }

    fn rotation(&mut self) -> DQuat {
        let turned = self.turns && self.chance(0.7);
        if turned { DQuat::from_scaled_axis(2.0 * self.vector()) } else { DQuat::IDENTITY }
    }

    /// Up to three magnets of 0.1 to 1000 around a box. Some have a neighbour that nearly cancels
    /// their field.
    fn magnets(&mut self, centre: DVec3, half: DVec3) -> Vec<Tile> {
        let mut tiles = Vec::new();
        for _ in 0..1 + self.index(3) {
            let size = if self.chance(0.2) { self.decades(0.7, 3.0) } else { self.decades(-1.0, 0.7) };
            let (sides, j_t) = (size * self.shape(), self.decades(-3.0, 0.0) * self.polarization());
            let (direction, rotation) = (self.direction(), self.rotation());
            let reach = half.length() + self.decades(-1.0, 0.8) + 0.5 * sides.length();
            tiles.push(tile(centre + reach * direction, sides, j_t, rotation));
            if self.chance(0.2) {
                tiles.push(tile(centre + (reach + sides.length()) * direction, sides, -j_t, rotation));
            }
        }
        tiles
    }

    /// A film beyond one side of a box, whose cells alternate between J and -J. At a distance of a
    /// few cells its field nearly vanishes.
    fn lattice(&mut self, centre: DVec3, half: DVec3) -> Vec<Tile> {
        let axis = self.index(3);
        let [along, across] = [(axis + 1) % 3, (axis + 2) % 3];
        let (cell, thickness) = (self.decades(-0.7, 0.3), self.decades(-1.0, 0.0));
        let (columns, rows) = (2 + self.index(9), 2 + self.index(9));
        let (j_t, rotation) = (self.decades(-3.0, 0.0) * self.polarization(), self.rotation());
        let mut sides = DVec3::splat(cell);
        sides[axis] = thickness;
        let height = self.sign() * (half[axis] + self.decades(-0.7, 0.5) * half.max_element() + 0.5 * sides.length());
        let spread = if self.chance(0.3) { 1e-3 } else { 0.0 };
        let cells = (0..columns * rows).map(|n| (n / rows, n % rows));
        cells
            .map(|(i, k)| {
                let mut offset = DVec3::ZERO;
                offset[axis] = height;
                offset[along] = cell * (i as f64 - 0.5 * (columns - 1) as f64);
                offset[across] = cell * (k as f64 - 0.5 * (rows - 1) as f64);
                let sign = if (i + k) % 2 == 0 { 1.0 } else { -1.0 };
                tile(centre + offset, sides, sign * (1.0 + self.between(-1.0, 1.0) * spread) * j_t, rotation)
            })
            .collect()
    }

    /// Hundreds of tiles of very different sizes and strengths beyond one side of a box.
    fn crowd(&mut self, centre: DVec3, half: DVec3) -> Vec<Tile> {
        let (axis, sign, reach) = (self.index(3), self.sign(), half.max_element() * self.decades(-0.5, 0.7));
        let crowded = half.max_element() * self.decades(0.0, 0.7);
        let rotation = self.rotation();
        (0..100 + self.index(300))
            .map(|_| {
                let (sides, j_t) = (crowded * self.decades(-5.0, -1.0) * self.shape(), self.decades(-9.0, 0.0));
                let mut offset = crowded * self.vector();
                offset[axis] = sign * (half[axis] + reach + crowded + offset[axis] + 0.5 * sides.length());
                tile(centre + offset, sides, j_t * self.polarization(), rotation)
            })
            .collect()
    }

    /// A point of the grid on the surface of its box, and the outward direction.
    fn place_on_surface(&mut self, grid: &Grid) -> (DVec3, DVec3) {
        let mut nearest = grid.point(self.index(grid.len()));
        let (axis, sign) = (self.index(3), self.sign());
        nearest[axis] = if sign > 0.0 { grid.upper()[axis] } else { grid.lower()[axis] };
        (nearest, sign * DVec3::AXES[axis])
    }

    /// A tile of 1e-6 to 0.2, with about the requested field at a point. It is a few sizes away, so
    /// a fit cannot resolve it, or a few tenths of the box, where the box can still be fitted.
    fn speck(&mut self, point: DVec3, outwards: DVec3, half: f64, wanted_t: f64) -> Tile {
        let is_near = self.chance(0.3);
        let size = if is_near { self.decades(-6.0, -0.7) } else { self.decades(-4.0, -0.7) };
        let sides = size * self.shape();
        let gap = if is_near { size * self.decades(-1.0, 1.5) } else { half * self.decades(-1.2, 0.2) };
        let reach = gap + 0.5 * sides.length();
        // The field of a dipole, where the point is not close to the tile.
        let strength_t = wanted_t * (4.0 * std::f64::consts::PI * reach.powi(3) / sides.element_product()).max(1.0);
        tile(point + reach * outwards, sides, strength_t.min(STRONGEST_T) * self.polarization(), self.rotation())
    }
}

/// The largest J of a speck, in tesla. Magnets have at least 1e-3 T.
const STRONGEST_T: f64 = 1e6;

fn tile(position: DVec3, size: DVec3, j_t: DVec3, rotation: DQuat) -> Tile {
    Tile::new(position, size, j_t).and_then(|tile| tile.rotated(rotation)).expect("a valid tile")
}
