//! `--points` and `--unit`: points from a file.

use std::path::{Path, PathBuf};

use super::given_units::{GivenUnits, given_units};

#[derive(clap::Args)]
pub(crate) struct PointsArgs {
    /// CSV file with columns x_mm, y_mm, z_mm, or x (m), ... ; - is standard input [default: the
    /// grid of the working volume]
    ///
    /// Columns are separated by commas, semicolons, tabs or spaces. With semicolons or tabs a
    /// number may have a decimal comma. Lines that begin with #, % or ; are comments; the column
    /// names may be in a comment, as numpy.savetxt writes them. Lines before the names are skipped,
    /// and other columns are ignored.
    #[arg(id = "points", long = "points", value_name = "TABLE")]
    pub(crate) file: Option<PathBuf>,
    /// Unit of columns named x, y, z without a unit, such as mm or in; the line of column names is
    /// still required
    #[arg(long, value_name = "UNIT", requires = "points", value_parser = given_units)]
    pub(crate) unit: Option<GivenUnits>,
}

impl PointsArgs {
    /// The file, if there is one.
    pub(crate) fn path(&self) -> Option<&Path> {
        self.file.as_deref()
    }
}
