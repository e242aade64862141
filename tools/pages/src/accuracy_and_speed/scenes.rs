//! The scenes of the page, and the places where their fields are wanted.

use glam::DVec3;
use magsplice::field::{Grid, Tile};
use magsplice_benches::{shipped_layout, working_volume};
use rand::seq::SliceRandom;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::effort::DialEffort;

/// A scene with its places, one panel of the picture.
pub(crate) struct PageScene {
    pub(crate) title: &'static str,
    pub(crate) tiles: Vec<Tile>,
    pub(crate) places: Vec<ScenePlace>,
}

/// A place where the field of a scene is wanted.
pub(crate) struct ScenePlace {
    pub(crate) name: &'static str,
    /// A box without tiles, for a grid and for look-ups.
    pub(crate) volume: Option<Grid>,
    /// Points of a list.
    pub(crate) points: Vec<DVec3>,
}

/// All scenes, with as many points as `effort` says.
pub(crate) fn scenes(effort: DialEffort) -> Vec<PageScene> {
    let published = shipped_layout("published-film").bare_tiles();
    let large = shipped_layout("film-80mm").bare_tiles();
    let volume = working_volume(effort.grid);
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let mut in_box = |count: usize, lower: DVec3, upper: DVec3| -> Vec<DVec3> {
        let mut point = |_| DVec3::from([0, 1, 2].map(|axis: usize| random.random_range(lower[axis]..upper[axis])));
        (0..count).map(&mut point).collect()
    };
    let mut boxed = |name, grid: Grid| ScenePlace {
        name,
        volume: Some(grid),
        points: in_box(effort.points, grid.lower(), grid.upper()),
    };
    let film_places = vec![boxed("in its volume", volume)];
    let mut large_places = vec![boxed("in its volume", volume)];
    let far =
        Grid::new(DVec3::new(98.0, 98.0, 99.0), DVec3::new(102.0, 102.0, 101.0), volume.counts()).expect("a grid");
    let near = Grid::new(DVec3::new(-2.0, -2.0, -3.0), DVec3::new(2.0, 2.0, -1.0), volume.counts()).expect("a grid");
    let tile_places = vec![boxed("half a mm below it", near), boxed("170 mm away", far)];
    let (low, high) = (DVec3::new(-36.0, -36.0, -5.0), DVec3::new(36.0, 36.0, -3.0));
    large_places.push(ScenePlace { name: "under all of it", volume: None, points: in_box(effort.points, low, high) });
    let (heap, half) = heap(effort.heap_side);
    let among = ScenePlace {
        name: "among them",
        volume: None,
        points: in_box(effort.heap_points, DVec3::splat(-half), DVec3::splat(half)),
    };
    let one = Tile::new(DVec3::ZERO, DVec3::new(3.3, 1.7, 1.0), DVec3::new(0.3, -0.5, 0.7)).expect("a valid tile");
    vec![
        PageScene { title: "Published film", tiles: published, places: film_places },
        PageScene { title: "80 mm film", tiles: large, places: large_places },
        PageScene { title: "Random tiles in a cube", tiles: heap, places: vec![among] },
        PageScene { title: "One tile", tiles: vec![one], places: tile_places },
    ]
}

/// Random tiles in a cube that do not overlap, and half the side of the cube.
///
/// Sides are 0.3 to 1.2, polarizations any. Each tile lies in a cell of its own; 47 of 50 cells are
/// taken.
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
