//! The scenes on which speed is compared.

use glam::{DQuat, DVec3};
use magsplice::field::{Grid, Tile};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::{shipped_layout, working_volume};

/// Tiles, and the points at which their field is wanted.
#[derive(Clone)]
pub struct Workload {
    /// As it is printed.
    pub name: &'static str,
    /// Their fields add up.
    pub tiles: Vec<Tile>,
    /// In any order.
    pub points: Vec<DVec3>,
    /// The grid that the points are, if they are one.
    pub grid: Option<Grid>,
}

impl Workload {
    /// The same with evenly thinned points, so that they keep their distribution, and at most so many tile-point pairs.
    pub fn thinned(mut self, most_pairs: usize) -> Workload {
        let keep = (most_pairs / self.tiles.len()).clamp(1, self.points.len());
        if let Some(grid) = &mut self.grid {
            // As many along each axis, as nearly as may be.
            while grid.len() > keep {
                let axis = (0..3).max_by_key(|&axis| grid.counts[axis]).expect("three axes");
                grid.counts[axis] -= 1;
            }
            self.points = grid.points().collect();
            return self;
        }
        self.points = evenly_thinned(&self.points, keep).into_iter().map(|index| self.points[index]).collect();
        self
    }

    /// Tiles times points.
    pub fn pairs(&self) -> usize {
        self.tiles.len() * self.points.len()
    }
}

/// All of them.
pub fn workloads() -> Vec<Workload> {
    let film = shipped_layout("published-film").bare_tiles();
    let volume = working_volume([81, 81, 41]);
    let grid: Vec<DVec3> = volume.points().collect();
    let mut random = ChaCha8Rng::seed_from_u64(4);
    let mut within = |reach: f64| DVec3::from([0, 1, 2].map(|_| random.random_range(-reach..reach)));
    // Different in every tile, so that no two are one block.
    let general = |(i, t): (usize, &Tile)| {
        let j = t.polarization_t() + DVec3::new(0.02, -0.03, 0.04 + 1e-4 * i as f64);
        Tile::new(t.position(), t.size(), j).expect("a valid tile")
    };
    let turned =
        |(i, t): (usize, &Tile)| t.rotated(DQuat::from_rotation_z(1e-3 * (i as f64 + 1.0))).expect("a rotation");
    let one = Tile::new(DVec3::ZERO, DVec3::new(3.3, 1.7, 1.0), DVec3::new(0.3, -0.5, 0.7)).expect("a valid tile");
    let near_and_far: Vec<DVec3> = (0..1_000_000).map(|i| within(if i % 2 == 0 { 4.0 } else { 40.0 })).collect();
    let below: Vec<DVec3> =
        (0..10_000).map(|_| within(40.0) * DVec3::new(1.0, 1.0, 0.02) - DVec3::new(0.0, 0.0, 4.0)).collect();
    vec![
        Workload { name: "film-exact", tiles: film.clone(), points: grid.clone(), grid: Some(volume) },
        Workload {
            name: "film-general-polarization",
            tiles: film.iter().enumerate().map(general).collect(),
            points: grid.clone(),
            grid: Some(volume),
        },
        Workload {
            name: "film-rotated",
            tiles: film.iter().enumerate().map(turned).collect(),
            points: grid,
            grid: Some(volume),
        },
        Workload { name: "one-tile", tiles: vec![one], points: near_and_far, grid: None },
        Workload { name: "many-tiles", tiles: square_film(100), points: below, grid: None },
    ]
}

/// Indices of at most so many points, at least one, that keep their distribution.
pub fn evenly_thinned(points: &[DVec3], most: usize) -> Vec<usize> {
    let keep = most.clamp(1, points.len());
    (0..keep).map(|i| i * points.len() / keep).collect()
}

/// `side` x `side` unit cubes of different polarization in the plane, their lower faces at z = 0.
pub fn square_film(side: usize) -> Vec<Tile> {
    let middle = 0.5 * (side as f64 - 1.0);
    let tile = |n: usize| {
        let (x, y) = ((n % side) as f64 - middle, (n / side) as f64 - middle);
        let j = DVec3::new((0.6 * x).sin(), (0.6 * y).sin(), 0.0).normalize() * 0.12;
        Tile::new(DVec3::new(x, y, 0.5), DVec3::ONE, j).expect("a valid tile")
    };
    (0..side * side).map(tile).collect()
}

/// Random points 3 to 5 below a [`square_film`], not beyond nine tenths of its half side.
pub fn points_below(side: usize, count: usize) -> Vec<DVec3> {
    let mut random = ChaCha8Rng::seed_from_u64(6);
    let reach = 0.45 * side as f64;
    let point = |_| {
        let [x, y] = [0, 1].map(|_| random.random_range(-reach..reach));
        DVec3::new(x, y, random.random_range(-5.0..-3.0))
    };
    (0..count).map(point).collect()
}
