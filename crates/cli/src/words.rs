//! Errors of the library in words with the names of tiles.

use std::path::Path;

use magsplice::FilmError;
use magsplice::layout::Layout;
use magsplice::magnet::PointErrorCause;

use crate::failure::Failure;
use crate::faults::FaultList;
use crate::text::number::point;

/// The failure of a film: points without a field one by one, with the names of tiles.
pub(crate) fn film_failure(path: &Path, layout: &Layout, error: FilmError) -> Failure {
    let FilmError::Points(errors) = error else {
        return Failure::at(path, error);
    };
    let mut faults = FaultList::default();
    for error in errors.0 {
        let p = error.point;
        faults.add(0, format!("point {} mm: {}", point(p), no_field(error.cause, layout)));
    }
    faults.failure(path.display())
}

/// Why there is no field at a point.
pub(crate) fn no_field(cause: PointErrorCause, layout: &Layout) -> String {
    match cause {
        PointErrorCause::Unbounded { tile } => {
            format!("the field is unbounded there, on an exposed edge of tile \"{}\"", layout.tiles[tile].name)
        }
        PointErrorCause::Unresolved { tile } => format!(
            "the gradient cannot be resolved on an edge that tile \"{}\" shares with others",
            layout.tiles[tile].name
        ),
        other => other.to_string(),
    }
}
