//! `magsplice import`: makes a layout from a table of blocks.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use magsplice::layout::{EulerOrder, InvalidEulerOrder, Layout, LayoutError, LayoutFault, meant_length};

use crate::args::given_units::{GivenUnits, given_units};
use crate::args::numbers::length_mm;
use crate::csv_input::table::is_stdin;
use crate::failure::{self, Failure};
use crate::faults::FaultList;
use crate::inputs::blocks::{self, Blocks, SMALLEST_MAGNET_MM};
use crate::output::destination::{self, Output};
use crate::text::number::counted;

/// Make a layout from a table of blocks, one row per block
///
/// The names of columns carry units, in any of the forms x_mm, x (mm), x[mm]:
///
///   position       x_mm, y_mm, z_mm: the centre (mm, cm, um, m, in, mil)
///   size           size_x_mm, size_y_mm, size_z_mm: along the block's own axes
///   polarization   jx_t, jy_t, jz_t: in the block's own frame (T, mT, uT, nT, kG, G)
///   magnetization  mx_a_per_m, my_a_per_m, mz_a_per_m: instead of the polarization (A/m, kA/m)
///   strength       strength_t, direction_deg, tilt_deg: instead of the polarization, its magnitude
///                  (Br), its angle from x towards y, and its angle out of this plane (default 0)
///   rotation       none, or one of:
///                  qx, qy, qz, qw (or quat_x, ...): a quaternion of any norm, qw is the scalar
///                  axis_x, axis_y, axis_z, angle_deg
///                  rx_deg, ry_deg, rz_deg with --euler: by axis; missing columns are 0
///                  euler_1_deg, euler_2_deg, euler_3_deg with --euler: first to third turn
///                  r11, r12, ... r33: a matrix row by row
///                  Angles may be in deg or rad.
///   name           none, or name
///
/// Separators, decimal commas and comments are read as in files of points. Blocks whose cells of
/// the rotation are empty are not rotated. The tiles have the numbers of the table to the last
/// digit; a magnetization is multiplied by mu0 = 1.25663706127e-6 T m/A.
#[derive(clap::Args)]
#[command(verbatim_doc_comment, after_help = "Example:\n  magsplice import blocks.csv -o film.toml")]
pub(crate) struct ImportArgs {
    /// Table of blocks (CSV); - is standard input
    #[arg(value_name = "TABLE")]
    blocks: PathBuf,
    /// Layout file to write, complete or not at all [default: -, standard output]
    #[arg(short, long, value_name = "LAYOUT")]
    output: Option<PathBuf>,
    /// Order of Euler angles: xyz about the fixed axes (extrinsic), XYZ about the axes of the
    /// turned block (intrinsic), as in scipy
    ///
    /// The columns rx_deg, ry_deg, rz_deg give an angle per axis, and the option gives their order.
    /// The columns euler_1_deg, euler_2_deg, euler_3_deg are the first, second and third turn;
    /// orders with a letter twice, such as zxz, need these columns. With --euler zyx, rx_deg = 10,
    /// ry_deg = 20, rz_deg = 30 is the same as euler_1_deg = 30, euler_2_deg = 20, euler_3_deg =
    /// 10.
    #[arg(long, value_name = "ORDER", value_parser = order)]
    euler: Option<EulerOrder>,
    /// Units of columns named without a unit, such as mm, or mm,kG; the line of column names is
    /// still required
    #[arg(long, value_name = "UNITS", value_parser = given_units)]
    unit: Option<GivenUnits>,
    /// Depth by which blocks may overlap, in mm [default: 0]
    ///
    /// Positions and sizes with few decimals overlap by their rounding where the blocks touch. The
    /// message about such blocks gives the depth. The layout keeps it as overlap_mm.
    #[arg(long, value_name = "LENGTH", value_parser = length_mm, allow_hyphen_values = true)]
    overlap: Option<f64>,
    /// Name of the layout [default: the name of the file]
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
}

pub(crate) fn run(args: &ImportArgs, quiet: bool) -> Result<(), Failure> {
    let output = Output::open(args.output.as_deref(), &[&args.blocks])?;
    let Blocks { tiles, lines, ignored, suspicious_size_mm } =
        blocks::read(&args.blocks, args.unit.as_ref(), args.euler)?;
    let place = args.blocks.display().to_string();
    let source = if is_stdin(&args.blocks) { "standard input".to_owned() } else { file_name(&args.blocks) };
    let history = vec![format!("imported from {source} by magsplice {}", env!("CARGO_PKG_VERSION"))];
    let name = args.name.clone().unwrap_or_else(|| stem(&args.blocks));
    let overlap_mm = args.overlap.unwrap_or(0.0);
    let layout = Layout { name, history, overlap_mm, tiles, ..Layout::default() };
    let layout = layout.checked(&place).map_err(|error| in_lines(error, &place, &lines))?;
    let to_file = !output.is_standard();
    output.complete(&layout.to_toml())?;
    if quiet {
        return Ok(());
    }
    if !ignored.is_empty() {
        failure::tell(&format_args!("{place}: columns that were not read: {}", ignored.join(", ")));
    }
    if let Some(largest_mm) = suspicious_size_mm {
        failure::tell(&format_args!(
            "warning: {place}: the largest block measures {largest_mm} mm, less than {SMALLEST_MAGNET_MM} mm; {}",
            meant_length(largest_mm)
        ));
    }
    for finding in &layout.findings {
        failure::tell(&format_args!("{place}: {finding}"));
    }
    if let Some(file) = args.output.as_ref().filter(|file| to_file && !destination::is_standard(file)) {
        let (file, tiles) = (file.display(), counted(layout.tiles.len(), "tile", "tiles"));
        failure::tell(&format_args!(
            "wrote {file}: {tiles}; give points (`magsplice field {file} --points P.csv`), or add [volume], and [ideal] \
             for `decouple`"
        ));
    }
    Ok(())
}

fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}

/// The name of a layout from this file.
fn stem(path: &Path) -> String {
    let stem = path.file_stem().filter(|_| !is_stdin(path));
    stem.map_or("blocks".to_owned(), |stem| stem.to_string_lossy().into_owned())
}

/// Broken rules of a layout with the lines of the blocks, which the places name.
fn in_lines(error: LayoutError, place: &str, lines: &HashMap<String, u64>) -> Failure {
    let LayoutError::Invalid { faults, .. } = error else { return error.into() };
    let mut listed = FaultList::default();
    for LayoutFault { place, message, .. } in faults {
        let named = place.split('"').skip(1).step_by(2).filter_map(|name| lines.get(name));
        let named: Vec<String> = named.map(u64::to_string).collect();
        let at = match &named[..] {
            [] => String::new(),
            [line] => format!("line {line}: "),
            all => format!("lines {}: ", all.join(" and ")),
        };
        listed.add(0, format!("{at}{place}: {message}"));
    }
    listed.failure(place)
}

fn order(text: &str) -> Result<EulerOrder, String> {
    text.parse().map_err(|rule: InvalidEulerOrder| rule.to_string())
}
