//! Time and memory of the polarization of a board of 40 x 40 touching cubes, 102 400 cells at level
//! 4:
//!
//!     cargo run --release -p magsplice-recoil --example many_cells

use std::error::Error;
use std::time::Instant;

use glam::DVec3;
use magsplice_magnet::{IronPlanes, Tile};
use magsplice_recoil::{Magnetization, Permeability, RecoilTile};

const CUBES: usize = 40;
const LEVEL: usize = 4;
const MU_R: f64 = 1.2;

fn main() -> Result<(), Box<dyn Error>> {
    let permeability = Permeability::isotropic(MU_R)?;
    // Upright cubes of both signs, as on a draughtboard.
    let cube = |index: usize| -> Result<RecoilTile, Box<dyn Error>> {
        let (x, y) = (index % CUBES, index / CUBES);
        let j_t = if (x + y).is_multiple_of(2) { DVec3::Z } else { -DVec3::Z };
        Ok(RecoilTile { tile: Tile::new(DVec3::new(x as f64, y as f64, 0.0), DVec3::ONE, j_t)?, permeability })
    };
    let tiles = (0..CUBES * CUBES).map(cube).collect::<Result<Vec<RecoilTile>, _>>()?;
    let start = Instant::now();
    let solved = Magnetization::solve(&tiles, &IronPlanes::default(), LEVEL, |_| {})?;
    println!("{} cells, {:.1} s on {} threads", solved.cells().len(), start.elapsed().as_secs_f64(), threads());
    // Only Linux has this file.
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    if let Some(peak) = status.lines().find(|line| line.starts_with("VmHWM")) {
        println!("{peak}");
    }
    Ok(())
}

fn threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}
