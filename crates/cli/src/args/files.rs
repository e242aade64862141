//! Arguments of the verbs that list, convert or create files.

use std::path::PathBuf;

use super::formats::{ExportFormat, TilesFormat};
use super::numbers::length_mm;

/// List the tiles of a layout and its bill of materials.
///
/// The bill counts the pieces of each part. Tiles that differ only in position and orientation are
/// the same part. Angles are those of the polarization from the first side of a part towards the
/// second.
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  magsplice tiles layouts/published-film.toml --kerf-mm 0.2\n  magsplice tiles layouts/published-film.toml --format csv > cut-list.csv"
)]
pub(crate) struct TilesArgs {
    /// Layout file
    pub(crate) layout: PathBuf,
    /// Format of the result
    #[arg(long, value_enum, default_value = "text")]
    pub(crate) format: TilesFormat,
    /// Width of material that each cut removes, in mm; adds the area of sheet and the length of bar
    /// that the parts need
    #[arg(long, value_name = "MM", value_parser = kerf, allow_negative_numbers = true)]
    pub(crate) kerf_mm: Option<f64>,
    /// Write the film and its bill of materials as a page to print (HTML)
    #[cfg(feature = "report")]
    #[arg(long, value_name = "FILE")]
    pub(crate) page: Option<PathBuf>,
}

/// Write the film for another program.
///
/// For magpylib: a Python script that rebuilds the film and prints its field. For ParaView: the
/// faces of the tiles with their polarization. For CAD: a drawing (DXF) or bodies (STL). For
/// firmware: the displacement of a sensor from its reading, as a function in C.
///
/// The other way round, --to magpylib-import writes a Python script that turns a magpylib
/// collection into a table for `magsplice import`.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  magsplice export layouts/published-film.toml --to magpylib -o film.py\n  \
    magsplice export layouts/published-film.toml --to c-header --error 0.005mm -o film.h")]
pub(crate) struct ExportArgs {
    /// Layout file; none for --to magpylib-import
    pub(crate) layout: Option<PathBuf>,
    /// Program to write for [default: by the file's ending]
    #[arg(long, value_enum, required_unless_present = "output")]
    pub(crate) to: Option<ExportFormat>,
    /// For --to c-header: largest error of the displacement over the working volume [default:
    /// 0.005mm]
    #[arg(long, value_name = "LENGTH", value_parser = error_mm)]
    pub(crate) error: Option<f64>,
    /// File to write, complete or not at all [default: -, standard output]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
}

fn error_mm(text: &str) -> Result<f64, String> {
    let value = length_mm(text)?;
    if value > 0.0 { Ok(value) } else { Err("must be above 0".to_owned()) }
}

/// Largest kerf. No saw removes more, and areas stay within the range of numbers.
const MAX_KERF_MM: f64 = 100.0;

fn kerf(text: &str) -> Result<f64, String> {
    let number = text.trim().parse().ok().filter(|kerf: &f64| (0.0..=MAX_KERF_MM).contains(kerf));
    number.ok_or_else(|| format!("must be a number of mm from 0 to {MAX_KERF_MM}"))
}

/// Write a commented layout to start from; never overwrites a file.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  magsplice init my-film.toml")]
pub(crate) struct InitArgs {
    /// File to write; - is standard output
    #[arg(default_value = "film.toml")]
    pub(crate) file: PathBuf,
}

/// Print a script with which a shell completes arguments.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  magsplice completions bash > ~/.local/share/bash-completion/completions/magsplice")]
pub(crate) struct CompletionsArgs {
    /// Shell that reads the script
    pub(crate) shell: clap_complete::Shell,
}
