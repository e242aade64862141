//! The scenes of benchmarks and generated pages, and the peer magba.

/// Time of films that grow to a million tiles with as many points.
mod growth;
/// A scene in the types of magba.
mod magba_scene;
/// Scenes drawn from a seed.
mod random_scenes;
/// Scenes with the points of their fields.
mod scenes;
/// Speedup with threads, and the limit of the machine.
mod threads;
/// Tiles and points for comparisons of speed.
mod workloads;

pub use growth::{Growth, growth};
pub use magba_scene::Magba;
pub use random_scenes::{RandomScene, random_scenes};
pub use scenes::{PlacedScene, ScenePlace, SceneSizes, placed_scenes, random_cubes};
pub use threads::{Speedup, speedups};
pub use workloads::{
    Workload, evenly_thinned, median, points_below, rods, shipped_layout, square_film, working_volume, workloads,
};
