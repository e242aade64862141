//! Scenes with the places of their points, to compare exact fields with tolerances.

use glam::DVec3;
use magsplice::field::{Grid, Tile};
use rand::seq::SliceRandom;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::workloads::{shipped_layout, working_volume};

/// A scene with its places.
pub struct PlacedScene {
    /// Name of the scene.
    pub title: &'static str,
    /// Tiles of the scene; lengths in mm.
    pub tiles: Vec<Tile>,
    /// The places of its points.
    pub places: Vec<ScenePlace>,
}

/// A place of points in a scene.
pub struct ScenePlace {
    /// Name of the place, a suffix of the title of the scene.
    pub name: &'static str,
    /// A box without tiles, for a grid and for look-ups.
    pub volume: Option<Grid>,
    /// Points of a list.
    pub points: Vec<DVec3>,
}

/// Numbers of points and tiles of the [`placed_scenes`].
#[derive(Clone, Copy)]
pub struct SceneSizes {
    /// Points along each axis of a grid.
    pub grid: [usize; 3],
    /// Points of a list, and number of look-ups.
    pub points: usize,
    /// Points of the list among the random tiles.
    pub heap_points: usize,
    /// Cells along each side of the cube of random tiles.
    pub heap_side: usize,
}

/// The scenes of docs/accuracy-and-speed.md.
pub fn placed_scenes(sizes: SceneSizes) -> Vec<PlacedScene> {
    let published = shipped_layout("published-film").bare_tiles();
    let large = shipped_layout("film-80mm").bare_tiles();
    let volume = working_volume(sizes.grid);
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let mut in_box = |count: usize, lower: DVec3, upper: DVec3| -> Vec<DVec3> {
        let mut point = |_| DVec3::from([0, 1, 2].map(|axis: usize| random.random_range(lower[axis]..upper[axis])));
        (0..count).map(&mut point).collect()
    };
    let mut boxed = |name, grid: Grid| ScenePlace {
        name,
        volume: Some(grid),
        points: in_box(sizes.points, grid.lower(), grid.upper()),
    };
    let film_places = vec![boxed("in its volume", volume)];
    let mut large_places = vec![boxed("in its volume", volume)];
    let far =
        Grid::new(DVec3::new(98.0, 98.0, 99.0), DVec3::new(102.0, 102.0, 101.0), volume.counts()).expect("a grid");
    let near = Grid::new(DVec3::new(-2.0, -2.0, -3.0), DVec3::new(2.0, 2.0, -1.0), volume.counts()).expect("a grid");
    let tile_places = vec![boxed("half a mm below it", near), boxed("170 mm away", far)];
    let (low, high) = (DVec3::new(-36.0, -36.0, -5.0), DVec3::new(36.0, 36.0, -3.0));
    large_places.push(ScenePlace { name: "under all of it", volume: None, points: in_box(sizes.points, low, high) });
    let (heap, half) = heap(sizes.heap_side);
    let among = ScenePlace {
        name: "among them",
        volume: None,
        points: in_box(sizes.heap_points, DVec3::splat(-half), DVec3::splat(half)),
    };
    let one = Tile::new(DVec3::ZERO, DVec3::new(3.3, 1.7, 1.0), DVec3::new(0.3, -0.5, 0.7)).expect("a valid tile");
    vec![
        PlacedScene { title: "Published film", tiles: published, places: film_places },
        PlacedScene { title: "80 mm film", tiles: large, places: large_places },
        PlacedScene { title: "Random tiles in a cube", tiles: heap, places: vec![among] },
        PlacedScene { title: "One tile", tiles: vec![one], places: tile_places },
    ]
}

/// 100 cubes of side 1 with any polarization, evenly divided over a cube of side 16 without
/// overlap.
///
/// The places are a list of points in the same cube and a grid in a box beside it.
pub fn random_cubes(sizes: SceneSizes) -> PlacedScene {
    const SIDE: usize = 5;
    const CELL: f64 = 3.2;
    let mut random = ChaCha8Rng::seed_from_u64(9);
    let mut cells: Vec<usize> = (0..SIDE.pow(3)).collect();
    cells.shuffle(&mut random);
    cells.truncate(100);
    let half = 0.5 * CELL * SIDE as f64;
    let mut vector = |from: f64, to: f64| DVec3::from([0, 1, 2].map(|_| random.random_range(from..to)));
    let tile = |cell: usize| {
        let corner = DVec3::from([cell % SIDE, cell / SIDE % SIDE, cell / SIDE.pow(2)].map(|i| i as f64)) * CELL - half;
        let centre = corner + 0.5 + vector(0.0, 1.0) * (CELL - 1.0);
        Tile::new(centre, DVec3::ONE, vector(-1.0, 1.0)).expect("a valid tile")
    };
    let tiles = cells.into_iter().map(tile).collect();
    let points = (0..sizes.points).map(|_| vector(-half, half)).collect();
    let beside = Grid::new(DVec3::new(-2.0, -2.0, -12.0), DVec3::new(2.0, 2.0, -10.0), sizes.grid).expect("a grid");
    let among = ScenePlace { name: "among them", volume: None, points };
    let below = (0..sizes.points).map(|_| DVec3::new(0.0, 0.0, -11.0) + vector(-1.0, 1.0) * DVec3::new(2.0, 2.0, 1.0));
    let below = ScenePlace { name: "in a box below them", volume: Some(beside), points: below.collect() };
    PlacedScene { title: "100 random cubes", tiles, places: vec![among, below] }
}

/// Random disjoint tiles in a cube, and half the side of the cube.
///
/// Sides are 0.3 to 1.2, polarizations any. Each tile has its own cell; 47 of 50 cells are
/// occupied.
fn heap(side: usize) -> (Vec<Tile>, f64) {
    const CELL: f64 = 1.6;
    let mut random = ChaCha8Rng::seed_from_u64(8);
    let mut cells: Vec<usize> = (0..side.pow(3)).collect();
    cells.shuffle(&mut random);
    cells.truncate(side.pow(3) * 47 / 50);
    let half = 0.5 * CELL * side as f64;
    let tile = |cell: usize| {
        let mut vector = |from: f64, to: f64| DVec3::from([0, 1, 2].map(|_| random.random_range(from..to)));
        let (size, j, shift) = (vector(0.3, 1.2), vector(-1.0, 1.0), vector(0.0, 1.0));
        let corner = DVec3::from([cell % side, cell / side % side, cell / side.pow(2)].map(|i| i as f64)) * CELL - half;
        Tile::new(corner + 0.5 * size + shift * (CELL - size), size, j).expect("a valid tile")
    };
    (cells.into_iter().map(tile).collect(), half)
}
