//! What the programs that write pages have in common.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Measures, and writes a page of docs/ with its pictures.
#[derive(clap::Args)]
pub struct PageArgs {
    /// A Python that can import magpylib
    #[arg(long, default_value = "python3")]
    python: PathBuf,
    /// Leave magpylib out
    #[arg(long)]
    without_magpylib: bool,
    /// Folder to write the page and pictures/ to [default: docs]
    #[arg(long)]
    output: Option<PathBuf>,
}

impl PageArgs {
    /// The Python to ask, if magpylib is not left out.
    pub fn python(&self) -> Option<&Path> {
        (!self.without_magpylib).then_some(&self.python)
    }

    /// Where pages are written to.
    pub fn docs(&self) -> PathBuf {
        self.output.clone().unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs"))
    }
}

/// What the program ends with; what went wrong is printed.
pub fn exit_code(program: &str, outcome: Result<(), String>) -> ExitCode {
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{program}: {message}");
            ExitCode::from(2)
        }
    }
}
