//! Arguments of `import`.

use std::path::PathBuf;

use magsplice::layout::{EulerOrder, InvalidEulerOrder};

use super::points::LengthUnitArg;

/// Make a layout from a table of blocks, one row per block
///
/// The names of columns carry units, in any of the forms x_mm, x (mm), x[mm]:
///
///   position       x_mm, y_mm, z_mm: the centre (mm, cm, um, m)
///   size           size_x_mm, size_y_mm, size_z_mm: along the block's own axes
///   polarization   jx_t, jy_t, jz_t: in the block's own frame (T, mT, uT, nT)
///   magnetization  mx_a_per_m, my_a_per_m, mz_a_per_m: instead of it (A/m, kA/m)
///   rotation       none, or one of:
///                  qx, qy, qz, qw (or quat_x, ...): a quaternion of any norm, qw is the scalar
///                  axis_x, axis_y, axis_z, angle_deg
///                  rx_deg, ry_deg, rz_deg with --euler: by axis; those without a column are 0
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
    /// CSV file of blocks; - is standard input
    pub(crate) blocks: PathBuf,
    /// Layout file to write, complete or not at all [default: -, standard output]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Order of Euler angles: xyz about the fixed axes (extrinsic), XYZ about the axes of the
    /// turned block (intrinsic), as in scipy
    ///
    /// The columns rx_deg, ry_deg, rz_deg name the axes, and the order says which of them comes
    /// first. The columns euler_1_deg, euler_2_deg, euler_3_deg are the first, second and third
    /// turn; orders with a letter twice, such as zxz, take these. With --euler zyx, rx_deg = 10,
    /// ry_deg = 20, rz_deg = 30 is the same as euler_1_deg = 30, euler_2_deg = 20,
    /// euler_3_deg = 10.
    #[arg(long, value_name = "ORDER", value_parser = order)]
    pub(crate) euler: Option<EulerOrder>,
    /// Unit of positions and sizes without a unit in their names; the names are still needed
    #[arg(long, value_enum, value_name = "UNIT")]
    pub(crate) unit: Option<LengthUnitArg>,
    /// Name of the layout [default: the name of the file]
    #[arg(long, value_name = "NAME")]
    pub(crate) name: Option<String>,
}

fn order(text: &str) -> Result<EulerOrder, String> {
    text.parse().map_err(|rule: InvalidEulerOrder| rule.to_string())
}
