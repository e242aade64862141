//! Measures the speed of magsplice, magba and magpylib on the same scenes and writes `docs/speed.md` with its pictures.
//!
//! `cargo run --release -p magsplice-benches --bin speed`
//!
//! magpylib is run by `benches/magpylib_scene.py`, which needs a Python with magpylib (`--python`, by default `python3`).

mod growth;
mod limit;
mod page;
mod peers;
mod picture;

use std::fs;
use std::path::Path;
use std::process::ExitCode;

use clap::Parser;
use magsplice_benches::{PageArgs, exit_code, magpylib_version};

#[derive(Parser)]
struct Args {
    #[command(flatten)]
    page: PageArgs,
    /// Everything once on few points, to see that it works
    #[arg(long)]
    once: bool,
}

/// How much is measured.
#[derive(Clone, Copy)]
struct Effort {
    /// Tile-point pairs in a run.
    pairs: usize,
    /// The same beside the peers: enough that many tiles have thousands of points too.
    peer_pairs: usize,
    /// Interleaved runs.
    runs: usize,
}

fn main() -> ExitCode {
    let args = Args::parse();
    let effort = if args.once {
        Effort { pairs: 20_000, peer_pairs: 20_000, runs: 1 }
    } else {
        Effort { pairs: 3_000_000, peer_pairs: 8_000_000, runs: 7 }
    };
    exit_code("speed", write(&args.page.docs(), args.page.python(), effort))
}

fn write(docs: &Path, python: Option<&Path>, effort: Effort) -> Result<(), String> {
    let magpylib = python.map(magpylib_version).transpose()?;
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(|e| e.to_string())?;
    let rows = one_thread.install(|| peers::measure(python, effort))?;
    let tiles = one_thread.install(|| growth::by_tiles(effort));
    let points = one_thread.install(|| growth::by_points(effort));
    let threads = growth::by_threads(effort);
    let limit = one_thread.install(|| limit::measure(effort));
    let pictures = docs.join("pictures");
    let io = |e: std::io::Error| e.to_string();
    fs::create_dir_all(&pictures).map_err(io)?;
    picture::draw_peers(&pictures.join("speed.svg"), &rows)?;
    picture::draw_growth(&pictures.join("growth.svg"), &tiles, &points)?;
    fs::write(docs.join("speed.md"), page::text(magpylib.as_deref(), &rows, &tiles, &points, &threads, &limit))
        .map_err(io)
}
