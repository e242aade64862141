//! `--points` and `--unit`: points from a file.

use std::path::{Path, PathBuf};

use clap::ValueEnum;

#[derive(clap::Args)]
pub(crate) struct PointsArgs {
    /// CSV file with columns x_mm, y_mm, z_mm, or x (m), ... ; - is standard input [default: the
    /// grid of the working volume]
    ///
    /// Columns are separated by commas, semicolons, tabs or spaces. With semicolons or tabs a
    /// number may have a decimal comma. Lines that begin with # are comments; the column names may
    /// be in a comment, as numpy.savetxt writes them. Other columns are ignored.
    #[arg(id = "points", long = "points", value_name = "CSV")]
    pub(crate) file: Option<PathBuf>,
    /// Unit of columns named x, y, z without a unit; the line of column names is still required
    #[arg(long, value_enum, value_name = "UNIT", requires = "points")]
    pub(crate) unit: Option<LengthUnitArg>,
}

impl PointsArgs {
    /// The file, if there is one.
    pub(crate) fn path(&self) -> Option<&Path> {
        self.file.as_deref()
    }
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(crate) enum LengthUnitArg {
    /// Millimetres
    Mm,
    /// Metres
    M,
}

impl LengthUnitArg {
    pub(crate) fn name(self) -> &'static str {
        match self {
            LengthUnitArg::Mm => "mm",
            LengthUnitArg::M => "m",
        }
    }
}
