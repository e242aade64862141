//! Another order of the readings of a scan.

use magsplice_magnet::Axis;
use thiserror::Error;

/// Another order of the readings, in which the film explains them.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum RowOrder {
    /// Readings belong to positions of other rows, before or after their own.
    #[error(
        "the readings fit the positions {} {} than their own far better: positions and readings are not in step; move the \
         columns against each other", counted(*.0), if *.0 > 0 { "earlier" } else { "later" }
    )]
    Late(i64),
    /// Readings belong to a coordinate of other rows, before or after their own.
    #[error(
        "the readings fit {axis} of the positions {} {} than their own far better: {axis} is not in step with the others; move \
         its column", counted(*.rows), if *.rows > 0 { "earlier" } else { "later" }
    )]
    LateCoordinate {
        /// The coordinate.
        axis: Axis,
        /// Number of rows, negative for later ones.
        rows: i64,
    },
    /// A coordinate of every second part of the scan is reversed.
    #[error(
        "the readings of every second line of the scan fit {0} in reversed order far better: the stage moved to and fro, and \
         positions or readings count as one way; reverse {0} in these lines"
    )]
    ToAndFro(Axis),
}

fn counted(count: i64) -> String {
    format!("{} {}", count.abs(), if count.abs() == 1 { "row" } else { "rows" })
}
