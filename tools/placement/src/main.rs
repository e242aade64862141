//! Prints the mean decoupling errors of films whose tiles are displaced at random.
//!
//! `cargo run --release -p magsplice-placement -- layouts/published-film.toml
//! layouts/designed-*.toml`
//!
//! Each tile is displaced along x and y by normal deviates. Displaced tiles may overlap, which
//! layout files forbid, so the films are made in memory.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use magsplice::design::Metrics;
use magsplice::prelude::{DVec3, Layout, Tile};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Prints the mean decoupling errors of films whose tiles are displaced at random.
#[derive(Parser)]
struct PlacementArgs {
    /// Layouts of the films
    #[arg(required = true)]
    layouts: Vec<PathBuf>,
    /// Standard deviations of positions along x and along y, in mm
    #[arg(long, value_delimiter = ',', default_value = "0.0,0.001,0.005,0.01,0.02,0.05,0.1")]
    deviations: Vec<f64>,
    /// Number of random films for each standard deviation
    #[arg(long, default_value_t = 40)]
    films: usize,
}

/// Number of uniform deviates whose sum is taken as a normal deviate of standard deviation 1.
const SUMMED: usize = 12;

fn normal(random: &mut ChaCha8Rng) -> f64 {
    (0..SUMMED).map(|_| random.random::<f64>() - 0.5).sum()
}

fn main() -> ExitCode {
    let args = PlacementArgs::parse();
    println!(
        "means over {} films: uniformity RMSE of R_x and S_z, RMSE of displacement along x and z in mm",
        args.films
    );
    for path in &args.layouts {
        if let Err(message) = measure(path, &args) {
            eprintln!("{}: {message}", path.display());
            return ExitCode::FAILURE;
        }
    }
    ExitCode::SUCCESS
}

fn measure(path: &Path, args: &PlacementArgs) -> Result<(), String> {
    let layout = Layout::read(path).map_err(|error| error.to_string())?;
    let (Some(ideal), Some(volume)) = (layout.ideal, layout.volume) else {
        return Err("has no [ideal] or no [volume]".to_owned());
    };
    println!("{}", path.display());
    for &deviation in &args.deviations {
        // Every film and every standard deviation gets the same deviates.
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let mut sums = [0.0; 4];
        for _ in 0..args.films {
            let moved = |tile: Tile, random: &mut ChaCha8Rng| {
                let by = deviation * DVec3::new(normal(random), normal(random), 0.0);
                Tile::new(tile.position() + by, tile.size(), tile.polarization_t())
                    .and_then(|t| t.rotated(tile.rotation()))
            };
            let tiles =
                layout.bare_tiles().into_iter().map(|tile| moved(tile, &mut random)).collect::<Result<Vec<Tile>, _>>();
            let tiles = tiles.map_err(|faults| faults.to_string())?;
            let metrics = Metrics::from_tiles(&tiles, &volume.grid, volume.reference_mm, &ideal)
                .map_err(|error| error.to_string())?;
            let ([r_x, _, s_z], [x, _, z]) = (metrics.uniformity_rmse.to_array(), metrics.displacement_rmse_mm);
            let found = [r_x, s_z, x, z];
            for (sum, value) in sums.iter_mut().zip(found) {
                *sum += value / args.films as f64;
            }
        }
        let [r_x, s_z, x, z] = sums;
        println!("  {deviation:>6} mm   {r_x:.2e}  {s_z:.2e}   {x:.2e}  {z:.2e}");
    }
    Ok(())
}
