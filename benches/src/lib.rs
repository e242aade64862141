//! The scenes that benchmarks and the generated pages measure, and the peer magba.

/// Time of films that grow to a million tiles with as many points.
mod growth;
/// A scene in the types of magba.
mod magba_scene;
/// Scenes with the places where their fields are wanted.
mod scenes;
/// Speedup with threads, beside the most that the machine gives.
mod threads;
/// Tiles and points on which speed is compared.
mod workloads;

pub use growth::{Growth, growth};
pub use magba_scene::Magba;
pub use scenes::{PlacedScene, ScenePlace, SceneSizes, placed_scenes, random_cubes};
pub use threads::{Speedup, speedups};
pub use workloads::{
    Workload, evenly_thinned, median, points_below, rods, shipped_layout, square_film, working_volume, workloads,
};
