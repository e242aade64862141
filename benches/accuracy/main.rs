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
use std::path::Path;
use std::process::ExitCode;

use clap::Parser;
use magsplice_benches::{PageArgs, exit_code, magpylib_version};

use peers::Peers;

#[derive(Parser)]
struct Args {
    #[command(flatten)]
    page: PageArgs,
}

fn main() -> ExitCode {
    let args = Args::parse();
    let peers = Peers { python: args.page.python().map(Path::to_path_buf) };
    exit_code("accuracy", write(&args.page.docs(), &peers))
}

fn write(docs: &Path, peers: &Peers) -> Result<(), String> {
    let magpylib = peers.python.as_deref().map(magpylib_version).transpose()?;
    let regions = regions::measure(peers)?;
    let distance = curves::by_distance(peers)?;
    let closeness = curves::by_closeness(peers)?;
    let seams = seams::measure(peers)?;
    let pictures = docs.join("pictures");
    let io = |e: std::io::Error| e.to_string();
    fs::create_dir_all(&pictures).map_err(io)?;
    picture::draw(&pictures.join("accuracy.svg"), &distance, &closeness)?;
    fs::write(docs.join("accuracy.md"), page::text(magpylib.as_deref(), &regions, &distance, &closeness, &seams))
        .map_err(io)
}
