//! Measures what every model of the field takes and how exact it is, with magba and magpylib beside them, and writes `docs/accuracy-and-speed.md` with its
//! pictures.
//!
//! `cargo run --release -p magsplice-benches --bin dial-page`
//!
//! magpylib is run by `benches/magpylib_scene.py`, which needs a Python with magpylib (`--python`, by default `python3`).

mod front;
mod growth_picture;
mod marks;
mod measure;
mod page;
mod picture;
mod scenes;
mod single_precision;

use std::fs;
use std::path::Path;
use std::process::ExitCode;

use clap::Parser;
use magsplice::field::Tolerance;
use magsplice_benches::{Growth, PageArgs, exit_code, growth, magpylib_version};

use measure::{Measurements, measure};

#[derive(Parser)]
struct Args {
    #[command(flatten)]
    page: PageArgs,
    /// Everything once on few points, to see that it works
    #[arg(long)]
    once: bool,
}

/// Relative tolerances that are measured.
const NOTCHES: [f64; 7] = [1e-2, 1e-4, 1e-6, 1e-8, 1e-9, 1e-10, 1e-12];
/// The tolerance of the growing films.
const GROWING: f64 = 1e-6;

/// How much is measured.
#[derive(Clone, Copy)]
struct Effort {
    grid: [usize; 3],
    points: usize,
    /// Among the random tiles.
    heap_points: usize,
    /// Cells along each side of the cube of random tiles.
    heap_side: usize,
    /// Tile-point pairs of the exact field at a list.
    exact_pairs: usize,
    /// The same of the peers, and at least so many points.
    peer_pairs: usize,
    peer_points: usize,
    /// The same with 130 digits.
    oracle_pairs: usize,
    /// Timed runs after one that is not, and how many of them the peers take part in.
    rounds: usize,
    peer_rounds: usize,
    /// Random tiles for each distance.
    single_cases: usize,
    /// Tiles along a side of the growing films, and runs of each.
    films: &'static [(usize, usize)],
}

const FULL: Effort = Effort {
    grid: [81, 81, 41],
    points: 100_000,
    heap_points: 20_000,
    heap_side: 22,
    exact_pairs: 100_000_000,
    peer_pairs: 6_000_000,
    peer_points: 2_000,
    oracle_pairs: 10_000,
    rounds: 5,
    peer_rounds: 3,
    single_cases: 1_000,
    films: &[(32, 15), (100, 7), (316, 3), (1000, 1)],
};

const ONCE: Effort = Effort {
    grid: [11, 11, 6],
    points: 300,
    heap_points: 300,
    heap_side: 6,
    exact_pairs: 100_000,
    peer_pairs: 20_000,
    peer_points: 20,
    oracle_pairs: 60,
    rounds: 1,
    peer_rounds: 1,
    single_cases: 20,
    films: &[(10, 1), (20, 1), (32, 1)],
};

/// A scene at its places.
struct Panel {
    scene: scenes::Scene,
    measurements: Vec<Measurements>,
}

fn main() -> ExitCode {
    let args = Args::parse();
    let effort = if args.once { ONCE } else { FULL };
    exit_code("dial-page", write(&args.page.docs(), args.page.python(), effort))
}

fn write(docs: &Path, python: Option<&Path>, effort: Effort) -> Result<(), String> {
    let magpylib = python.map(magpylib_version).transpose()?;
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(|e| e.to_string())?;
    let panel = |scene: scenes::Scene| {
        let at = |place| measure(&scene.tiles, place, python, effort);
        let measurements = scene.places.iter().map(at).collect::<Result<_, _>>()?;
        Ok(Panel { scene, measurements })
    };
    let panels: Vec<Panel> =
        one_thread.install(|| scenes::scenes(effort).into_iter().map(panel).collect::<Result<_, String>>())?;
    let tolerance = Tolerance::relative(GROWING).expect("above zero");
    let films: Vec<Growth> =
        one_thread.install(|| effort.films.iter().map(|&(side, runs)| growth(side, tolerance, runs)).collect());
    let precision = single_precision::measure(effort)?;
    let pictures = docs.join("pictures");
    let io = |e: std::io::Error| e.to_string();
    fs::create_dir_all(&pictures).map_err(io)?;
    picture::draw(&pictures.join("accuracy-and-speed.svg"), &panels)?;
    growth_picture::draw(&pictures.join("accuracy-and-speed-growth.svg"), &films)?;
    let text = page::text(&panels, &films, &precision, magpylib.as_deref(), effort);
    fs::write(docs.join("accuracy-and-speed.md"), text).map_err(io)
}
