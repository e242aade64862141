//! Measures the accuracy of magsplice, magba and magpylib on the same points and writes `docs/accuracy.md` with its pictures.
//!
//! `cargo run --release -p magsplice-benches --bin accuracy`
//!
//! magpylib is run by `benches/accuracy/magpylib_fields.py`, which needs a Python with magpylib (`--python`, by default `python3`).

mod curves;
mod page;
mod peers;
mod picture;
mod regions;
mod seams;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;

use peers::Peers;

#[derive(Parser)]
struct Args {
    /// A Python that can import magpylib
    #[arg(long, default_value = "python3")]
    python: PathBuf,
    /// Leave magpylib out
    #[arg(long)]
    without_magpylib: bool,
    /// Folder to write accuracy.md and pictures/ to [default: docs]
    #[arg(long)]
    output: Option<PathBuf>,
}

fn main() -> ExitCode {
    let args = Args::parse();
    let docs = args.output.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs"));
    let peers = Peers { python: (!args.without_magpylib).then_some(args.python) };
    match write(&docs, &peers) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("accuracy: {message}");
            ExitCode::from(2)
        }
    }
}

fn write(docs: &Path, peers: &Peers) -> Result<(), String> {
    let regions = regions::measure(peers)?;
    let distance = curves::by_distance(peers)?;
    let closeness = curves::by_closeness(peers)?;
    let seams = seams::measure(peers)?;
    let pictures = docs.join("pictures");
    let io = |e: std::io::Error| e.to_string();
    fs::create_dir_all(&pictures).map_err(io)?;
    picture::draw(&pictures.join("accuracy.svg"), &distance, &closeness)?;
    fs::write(docs.join("accuracy.md"), page::text(peers, &regions, &distance, &closeness, &seams)).map_err(io)
}
