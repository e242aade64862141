//! What benchmarks and pages share: the scenes they measure, and the peers.

mod growth;
mod magba_scene;
mod magpylib_scene;
mod page_args;
mod threads;
mod workloads;

use std::path::Path;

use glam::DVec3;
use magsplice::field::Grid;
use magsplice::layout::Layout;

pub use growth::{Growth, growth};
pub use magba_scene::Magba;
pub use magpylib_scene::{Magpylib, magpylib_version};
pub use page_args::{PageArgs, exit_code};
pub use threads::{Speedup, speedups};
pub use workloads::{Workload, evenly_thinned, points_below, square_film, workloads};

/// A layout shipped with the project.
///
/// # Panics
/// If there is no such layout.
pub fn shipped_layout(name: &str) -> Layout {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../layouts").join(name).with_extension("toml");
    Layout::read(&path).unwrap_or_else(|e| panic!("{e}"))
}

/// The published working volume on `counts` points.
pub fn working_volume(counts: [usize; 3]) -> Grid {
    Grid { lower: DVec3::new(-2.0, -2.0, -5.0), upper: DVec3::new(2.0, 2.0, -3.0), counts }
}

/// The middle one of times or ratios.
///
/// # Panics
/// If there is none.
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
