//! Random scenes: tiles, sizes, distances, shapes of grids and tolerances drawn from a seed.

use glam::{DQuat, DVec3};
use magsplice::field::{Grid, Tile, Tolerance};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::workloads::square_film;

/// Most pairs of tiles and points of a random scene.
const MOST_PAIRS: f64 = 2e6;

/// A random scene with its points and a tolerance.
pub struct RandomScene {
    /// What was drawn, in words.
    pub name: String,
    /// Tiles of the scene.
    pub tiles: Vec<Tile>,
    /// Points of the field.
    pub points: Vec<DVec3>,
    /// The grid that `points` lists, if they form one.
    pub grid: Option<Grid>,
    /// The tolerance.
    pub tolerance: Tolerance,
}

/// The scenes of a seed.
pub fn random_scenes(seed: u64) -> impl Iterator<Item = RandomScene> {
    let mut draw = Draw(ChaCha8Rng::seed_from_u64(seed));
    std::iter::repeat_with(move || draw.scene())
}

struct Draw(ChaCha8Rng);

impl Draw {
    fn number(&mut self, from: f64, to: f64) -> f64 {
        self.0.random_range(from..to)
    }

    /// A number whose logarithm is evenly distributed.
    fn magnitude(&mut self, from: f64, to: f64) -> f64 {
        self.number(from.ln(), to.ln()).exp()
    }

    fn count(&mut self, from: usize, to: usize) -> usize {
        self.magnitude(from as f64, to as f64 + 1.0) as usize
    }

    fn vector(&mut self, from: f64, to: f64) -> DVec3 {
        DVec3::from([0, 1, 2].map(|_| self.number(from, to)))
    }

    fn direction(&mut self) -> DVec3 {
        std::iter::repeat_with(|| self.vector(-1.0, 1.0)).find(|v| v.length() < 1.0).expect("often").normalize()
    }

    fn chance(&mut self, share: f64) -> bool {
        self.number(0.0, 1.0) < share
    }

    fn scene(&mut self) -> RandomScene {
        let (tiles_name, tiles) = self.tiles();
        let lower = tiles.iter().map(|t| t.position() - 0.5 * t.size()).fold(DVec3::INFINITY, DVec3::min);
        let upper = tiles.iter().map(|t| t.position() + 0.5 * t.size()).fold(DVec3::NEG_INFINITY, DVec3::max);
        let count = self.magnitude(100.0, 100_000.0).min(MOST_PAIRS / tiles.len() as f64) as usize;
        let (points_name, points, grid) = self.points((lower, upper), count);
        let fraction = self.magnitude(1e-12, 1e-2);
        let (within, tolerance) = if self.chance(0.75) {
            (format!("{fraction:.1e} of |B|"), Tolerance::relative(fraction))
        } else {
            let error_t = fraction * 1e-2;
            (format!("{error_t:.1e} T"), Tolerance::absolute_t(error_t))
        };
        RandomScene {
            name: format!("{tiles_name}, {points_name}, within {within}"),
            tiles,
            points,
            grid,
            tolerance: tolerance.expect("a tolerance"),
        }
    }

    /// Tiles of one kind, and the name of the kind.
    fn tiles(&mut self) -> (String, Vec<Tile>) {
        let aspect = self.magnitude(1.0, 100.0);
        let (kind, size) = [
            ("cubes", DVec3::ONE),
            ("rods", DVec3::new(1.0 / aspect, 1.0 / aspect, 1.0)),
            ("plates", DVec3::new(1.0, 1.0, 1.0 / aspect)),
            ("bars", DVec3::new(1.0, aspect.powf(-0.3), 1.0 / aspect)),
        ][self.0.random_range(0..4)];
        let of_aspect = if kind == "cubes" { String::new() } else { format!(" of aspect {aspect:.1}") };
        match self.0.random_range(0..4) {
            0 => (
                format!("one of {kind}{of_aspect}"),
                vec![Tile::new(DVec3::ZERO, size, self.direction()).expect("valid")],
            ),
            1 => {
                let side = self.count(2, 32);
                (format!("film of {side} x {side}"), square_film(side))
            }
            which => {
                let count = self.count(2, 1000);
                let side = (count as f64).cbrt().ceil() as usize;
                let (pitch, largest_rotation) = (self.magnitude(1.8, 5.0), self.magnitude(1e-9, 1.0));
                let rotation = which == 3;
                let tiles = (0..count).map(|n| {
                    let place = DVec3::from([n % side, n / side % side, n / side.pow(2)].map(|i| i as f64));
                    let tile = Tile::new(place * pitch, size, self.direction()).expect("valid");
                    let turn = DQuat::from_axis_angle(self.direction(), self.number(0.0, largest_rotation));
                    if rotation { tile.rotated(turn).expect("a rotation") } else { tile }
                });
                let tiles = tiles.collect();
                let turned = if rotation { format!(" turned by up to {largest_rotation:.1e}") } else { String::new() };
                (format!("{count} {kind}{of_aspect} at pitch {pitch:.1}{turned}"), tiles)
            }
        }
    }

    /// About `count` points at a random distance from a box, or in it.
    fn points(&mut self, (lower, upper): (DVec3, DVec3), count: usize) -> (String, Vec<DVec3>, Option<Grid>) {
        let size = upper - lower;
        let distance = self.magnitude(0.02, 1000.0) * size.max_element();
        let centre = 0.5 * (lower + upper);
        let shape = self.0.random_range(0..6);
        let extent = self.magnitude(0.01, 1.0) * (distance + size.max_element());
        // The box of the points touches the distance along a random axis.
        let axis = self.0.random_range(0..3);
        let mut middle = centre + 0.3 * size * self.vector(-1.0, 1.0);
        middle[axis] = lower[axis] - distance - extent;
        let mut half = DVec3::splat(extent);
        let place = format!("{distance:.2e} from them");
        match shape {
            // A line, a plane and a volume, whose counts differ by up to three times.
            0..=2 => {
                let dimensions = shape + 1;
                let mean = (count as f64).powf(1.0 / dimensions as f64);
                let mut counts = [1_usize; 3];
                for number in 0..dimensions {
                    let along = (axis + number + 1) % 3;
                    counts[along] = (mean * self.magnitude(0.5, 1.5)).ceil() as usize;
                }
                if dimensions == 1 {
                    counts = counts.map(|n| if n > 1 { count } else { 1 });
                }
                (0..3).filter(|&a| counts[a] == 1).for_each(|a| half[a] = 0.0);
                let grid = Grid::new(middle - half, middle + half, counts).expect("a grid");
                (format!("grid {counts:?} of {:.2e}, {place}", 2.0 * extent), grid.points().collect(), Some(grid))
            }
            3 => {
                let points = (0..count).map(|_| middle + half * self.vector(-1.0, 1.0)).collect();
                (format!("{count} points in a box of {:.2e}, {place}", 2.0 * extent), points, None)
            }
            4 => {
                let far = self.magnitude(1.0, 30.0);
                let radius = 0.5 * size.length();
                let point = |_| centre + self.direction() * (radius + distance * self.magnitude(1.0, far));
                let points = (0..count).map(point).collect();
                (format!("{count} points all around, {place} to {far:.1} times that"), points, None)
            }
            _ => {
                let points = (0..count).map(|_| lower + size * self.vector(-0.1, 1.1)).collect();
                (format!("{count} points among them"), points, None)
            }
        }
    }
}
