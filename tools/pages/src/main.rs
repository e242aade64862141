//! Writes the generated pages of `docs/` with their pictures.
//!
//! `cargo run --release -p magsplice-pages -- PAGE` measures magsplice and its peers magba and
//! magpylib on the same points and writes the page `accuracy`, `speed` or `accuracy-and-speed`.
//! `--without-magpylib` omits magpylib; otherwise `--python` is a Python that can import it.

/// `docs/accuracy.md`: errors against exact values, by region, distance and closeness to an edge.
mod accuracy;
/// `docs/accuracy-and-speed.md`: time and error of every way to evaluate a field.
mod accuracy_and_speed;
/// Scenes evaluated by magpylib, in a Python process.
mod magpylib;
/// `docs/speed.md`: times of the peers, growth with tiles, points and threads.
mod speed;
/// The style of all pictures.
mod style;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Parser, ValueEnum};

/// Measures, and writes a page of docs/ with its pictures.
#[derive(Parser)]
struct PageArgs {
    page: Page,
    /// A Python that can import magpylib
    #[arg(long, default_value = "python3")]
    python: PathBuf,
    /// Leave magpylib out
    #[arg(long)]
    without_magpylib: bool,
    /// Measure everything once on few points, to test the program
    #[arg(long)]
    once: bool,
    /// Folder to write the page and pictures/ to [default: docs]
    #[arg(long)]
    output: Option<PathBuf>,
}

#[derive(Clone, Copy, ValueEnum)]
enum Page {
    Accuracy,
    Speed,
    AccuracyAndSpeed,
}

fn main() -> ExitCode {
    let args = PageArgs::parse();
    let docs = args.output.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs"));
    let python = (!args.without_magpylib).then_some(args.python.as_path());
    let written = match args.page {
        Page::Accuracy => accuracy::write(&docs, python, args.once),
        Page::Speed => speed::write(&docs, python, args.once),
        Page::AccuracyAndSpeed => accuracy_and_speed::write(&docs, python, args.once),
    };
    match written {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("magsplice-pages: {message}");
            ExitCode::from(2)
        }
    }
}
