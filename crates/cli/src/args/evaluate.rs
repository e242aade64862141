//! Arguments of the verbs that evaluate a film.

use std::path::PathBuf;

use clap::ValueEnum;

use super::accuracy::AccuracyArgs;
use super::formats::{DecoupleFormat, TableFormat, TextOrJson};
use super::points::PointsArgs;

/// Compute the field at points and write it as CSV or another table format.
///
/// The points are the grid of the layout's working volume, or those of a CSV file. Results keep the
/// order of the points. Numbers are written with enough digits to read back to the same number.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  magsplice field layouts/published-film.toml --points points.csv -o field.csv")]
pub(crate) struct FieldArgs {
    /// Layout file
    pub(crate) layout: PathBuf,
    #[command(flatten)]
    pub(crate) points: PointsArgs,
    /// File to write, complete or not at all [default: -, standard output]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Format of the result [default: by the file's ending, else csv]
    #[arg(long, value_enum)]
    pub(crate) format: Option<TableFormat>,
    /// Quantity to compute
    #[arg(long, value_enum, ignore_case = true, default_value = "b")]
    pub(crate) quantity: QuantityArg,
    /// What to do with points at which the field is unbounded, on exposed edges of tiles; for
    /// gradients also points on shared edges
    ///
    /// Edges parallel to J are bounded.
    #[arg(long, value_enum, ignore_case = true, default_value = "error")]
    pub(crate) unbounded: UnboundedArg,
    #[command(flatten)]
    pub(crate) accuracy: AccuracyArgs,
}

#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum QuantityArg {
    /// Flux density B, in T
    B,
    /// Field strength H, in A/m
    H,
    /// Polarization J, in T
    J,
    /// Gradient of B: nine components, in T/mm
    Gradient,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(crate) enum UnboundedArg {
    /// Name the points and write nothing
    Error,
    /// Write NaN there (null in JSON) and name the points on standard error
    Nan,
}

/// Compare the field with the ideal film (Eq. 2) over the working volume, or at given points.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  magsplice compare layouts/published-film.toml")]
pub(crate) struct CompareArgs {
    /// Layout file
    pub(crate) layout: PathBuf,
    #[command(flatten)]
    pub(crate) points: PointsArgs,
    /// Format of the result
    #[arg(long, value_enum, default_value = "text")]
    pub(crate) format: TextOrJson,
    #[command(flatten)]
    pub(crate) accuracy: AccuracyArgs,
}

/// Evaluate the film: its field, its difference from the ideal film, and its decoupling errors.
///
/// Text is a report. JSON is the report with every point of the working volume. The other formats
/// hold B, R_x, R_y and S_z at every point. With --points they also hold the errors of the
/// parameters and of the displacement at each point; there is no uniformity RMSE then, which needs
/// a grid.
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  magsplice decouple layouts/published-film.toml\n  magsplice decouple layouts/published-film.toml -o film.npz"
)]
pub(crate) struct DecoupleArgs {
    /// Layout file
    pub(crate) layout: PathBuf,
    #[command(flatten)]
    pub(crate) points: PointsArgs,
    /// File to write, complete or not at all [default: -, standard output]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Format of the result [default: by the file's ending, else text]
    #[arg(long, value_enum)]
    pub(crate) format: Option<DecoupleFormat>,
    #[command(flatten)]
    pub(crate) accuracy: AccuracyArgs,
}

/// Show which methods a tolerance allows, and the truncation error and cost of each.
///
/// The points are those that `field` would take. Costs count multiply-adds, in units of the exact
/// field of one tile at one point. The program computes an expansion to find out whether it keeps
/// the tolerance, so a plan takes a part of the time of the evaluation. The evaluation repeats
/// points where the field turns out too weak for the truncation error more accurately; the plan
/// does not know these points.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  magsplice plan layouts/film-80mm.toml --within 1e-6")]
pub(crate) struct PlanArgs {
    /// Layout file
    pub(crate) layout: PathBuf,
    #[command(flatten)]
    pub(crate) points: PointsArgs,
    /// Format of the result
    #[arg(long, value_enum, default_value = "text")]
    pub(crate) format: TextOrJson,
    #[command(flatten)]
    pub(crate) accuracy: AccuracyArgs,
}

/// Draw the film and its field: figures as SVG, PNG and CSV, and one page with all of them.
///
/// Draws the figures of Dai 2024 for any layout: the tiles from above, field vectors in three
/// views, B beside the ideal film on planes, and the decoupling parameters through the working
/// volume and along its axes. The page report.html needs no network and no other file; it has the
/// numbers, a view of the tiles that turns, and maps that show the value under the pointer. The
/// folder appears complete or not at all. An earlier report in it is replaced.
///
/// Two layouts give one page with the numbers of both films and their difference, and the figures
/// side by side on the same scales.
///
/// With --watch the program stays, draws anew when a layout is saved, and prints the faults of a
/// layout that is broken. The page does not reload by itself.
#[cfg(feature = "report")]
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  magsplice report layouts/published-film.toml -o report\n  magsplice report before.toml after.toml -o comparison"
)]
pub(crate) struct ReportArgs {
    /// Layout file, or two whose films are drawn side by side
    #[arg(required = true, num_args = 1..=2, value_name = "LAYOUT")]
    pub(crate) layouts: Vec<PathBuf>,
    /// Folder to write: new, empty, or with an earlier report, which is replaced
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: PathBuf,
    /// Draw anew whenever a layout is saved, until Ctrl-C
    #[arg(long)]
    pub(crate) watch: bool,
    /// Text in the SVG files
    #[arg(long, value_enum, default_value = "text")]
    pub(crate) text: SvgTextArg,
    #[command(flatten)]
    pub(crate) accuracy: AccuracyArgs,
}

#[cfg(feature = "report")]
#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum SvgTextArg {
    /// Text that can be searched and edited, in Roboto or a similar font
    Text,
    /// Outlines of Roboto, the same on every machine
    Outlines,
}

#[cfg(feature = "report")]
impl From<SvgTextArg> for magsplice_report::SvgText {
    fn from(text: SvgTextArg) -> magsplice_report::SvgText {
        match text {
            SvgTextArg::Text => magsplice_report::SvgText::Text,
            SvgTextArg::Outlines => magsplice_report::SvgText::Outlines,
        }
    }
}
