//! Tiles and points for comparisons of speed.

use std::path::Path;

use glam::{DQuat, DVec3};
use magsplice::field::{Grid, Tile};
use magsplice::layout::Layout;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A layout shipped with the project, by its name in `layouts/`.
///
/// # Panics
/// If no such layout exists.
pub fn shipped_layout(name: &str) -> Layout {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../layouts").join(name).with_extension("toml");
    Layout::read(&path).unwrap_or_else(|e| panic!("{e}"))
}

/// The published working volume as a grid with `counts` points along each axis, in mm.
pub fn working_volume(counts: [usize; 3]) -> Grid {
    Grid::new(DVec3::new(-2.0, -2.0, -5.0), DVec3::new(2.0, 2.0, -3.0), counts).expect("a grid")
}

/// The median of times or ratios; the upper of two in the middle.
///
/// # Panics
/// If there are no values.
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// A scene of the benchmarks: tiles, and the points at which their field is computed.
#[derive(Clone)]
pub struct Workload {
    /// Name in the output of the benchmarks.
    pub name: &'static str,
    /// Tiles of the scene; lengths in mm.
    pub tiles: Vec<Tile>,
    /// Points of evaluation, in any order.
    pub points: Vec<DVec3>,
    /// The grid that `points` lists, if they form one.
    pub grid: Option<Grid>,
}

impl Workload {
    /// Thins the points evenly to at most `most_pairs` tile-point pairs, which keeps their
    /// distribution.
    pub fn thinned(mut self, most_pairs: usize) -> Workload {
        let keep = (most_pairs / self.tiles.len()).clamp(1, self.points.len());
        if let Some(grid) = self.grid {
            // The axis with most points loses one, until the counts are nearly equal.
            let mut counts = grid.counts();
            while counts.iter().product::<usize>() > keep {
                let axis = (0..3).max_by_key(|&axis| counts[axis]).expect("three axes");
                counts[axis] -= 1;
            }
            let grid = Grid::new(grid.lower(), grid.upper(), counts).expect("fewer points of a grid");
            self.points = grid.points().collect();
            self.grid = Some(grid);
            return self;
        }
        self.points = evenly_thinned(&self.points, keep).into_iter().map(|index| self.points[index]).collect();
        self
    }

    /// The number of tile-point pairs.
    pub fn pairs(&self) -> usize {
        self.tiles.len() * self.points.len()
    }
}

/// All workloads of the peers benchmark.
pub fn workloads() -> Vec<Workload> {
    let film = shipped_layout("published-film").bare_tiles();
    let volume = working_volume([81, 81, 41]);
    let grid: Vec<DVec3> = volume.points().collect();
    let mut random = ChaCha8Rng::seed_from_u64(4);
    let mut within = |reach: f64| DVec3::from([0, 1, 2].map(|_| random.random_range(-reach..reach)));
    // J differs in every tile, so no two merge into one block.
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

/// Indices of at most `most` points, and at least one, taken evenly to keep their distribution.
pub fn evenly_thinned(points: &[DVec3], most: usize) -> Vec<usize> {
    let keep = most.clamp(1, points.len());
    (0..keep).map(|i| i * points.len() / keep).collect()
}

/// `side` x `side` unit cubes of different polarization in the plane, with lower faces at z = 0.
pub fn square_film(side: usize) -> Vec<Tile> {
    let middle = 0.5 * (side as f64 - 1.0);
    let tile = |n: usize| {
        let (x, y) = ((n % side) as f64 - middle, (n / side) as f64 - middle);
        let j = DVec3::new((0.6 * x).sin(), (0.6 * y).sin(), 0.0).normalize_or(DVec3::X) * 0.12;
        Tile::new(DVec3::new(x, y, 0.5), DVec3::ONE, j).expect("a valid tile")
    };
    (0..side * side).map(tile).collect()
}

/// Random points 3 to 5 below a [`square_film`], within nine tenths of its half side.
pub fn points_below(side: usize, count: usize) -> Vec<DVec3> {
    let mut random = ChaCha8Rng::seed_from_u64(6);
    let reach = 0.45 * side as f64;
    let point = |_| {
        let [x, y] = [0, 1].map(|_| random.random_range(-reach..reach));
        DVec3::new(x, y, random.random_range(-5.0..-3.0))
    };
    (0..count).map(point).collect()
}

/// 100 upright rods of 1 x 1 x 30 with three different components of J each on a lattice of pitch
/// 2, and random points in a volume around and below them, at least 1 away from every rod.
pub fn rods(count: usize) -> Workload {
    const SIDE: usize = 10;
    let (pitch, size) = (2.0, DVec3::new(1.0, 1.0, 30.0));
    let mut random = ChaCha8Rng::seed_from_u64(10);
    let mut vector = |reach: DVec3| DVec3::from([0, 1, 2].map(|_| random.random_range(-1.0..1.0))) * reach;
    let place = |n: usize| (DVec3::new((n % SIDE) as f64, (n / SIDE) as f64, 0.0) - DVec3::new(4.5, 4.5, 0.0)) * pitch;
    let rod = |n: usize| Tile::new(place(n), size, vector(DVec3::ONE)).expect("a valid tile");
    let tiles: Vec<Tile> = (0..SIDE.pow(2)).map(rod).collect();
    let is_clear = |point: &DVec3| {
        let gap = |tile: &Tile| ((*point - tile.position()).abs() - 0.5 * size).max(DVec3::ZERO).length();
        tiles.iter().all(|tile| gap(tile) >= 1.0)
    };
    let around = std::iter::repeat_with(|| vector(DVec3::new(18.0, 18.0, 20.0)) - DVec3::new(0.0, 0.0, 5.0));
    let points = around.filter(is_clear).take(count).collect();
    Workload { name: "rods", tiles, points, grid: None }
}
