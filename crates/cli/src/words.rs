//! Errors of the library in words with the names of tiles.

use std::path::Path;

use magsplice::FilmError;
use magsplice::layout::Layout;
use magsplice::magnet::PointErrorCause;

use crate::failure::Failure;
use crate::faults::FaultList;

/// The failure of a film: points without a field one by one, with the names of tiles.
pub(crate) fn film_failure(path: &Path, layout: &Layout, error: FilmError) -> Failure {
    let FilmError::Points(errors) = error else {
        return Failure::Film { layout: path.to_owned(), error: Box::new(error) };
    };
    let mut faults = FaultList::default();
    for error in errors.0 {
        let p = error.point;
        faults.add(0, format!("point ({}, {}, {}) mm: {}", p.x, p.y, p.z, no_field(error.cause, layout)));
    }
    faults.failure(path.display().to_string())
}

/// The failure of `verb`, which needs an ideal film and a working volume, on a layout without them.
/// `purpose` says in words what the verb is for.
pub(crate) fn no_film(path: &Path, error: FilmError, verb: &str, purpose: &str) -> Failure {
    let FilmError::Missing(table) = error else {
        return Failure::Film { layout: path.to_owned(), error: Box::new(error) };
    };
    let shown = path.display();
    let message = format!(
        "the layout has no [{table}] table, which this needs: `magsplice {verb}` {purpose}. For the field of any \
         arrangement of magnets use `magsplice field {shown}`. For a film, add [{table}]; docs/layout-format.md \
         describes it"
    );
    Failure::Points { path: path.to_owned(), message }
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

/// The failure of a verb about sensors on a layout without a working volume.
pub(crate) fn no_volume(path: &Path, error: FilmError) -> Failure {
    match error {
        FilmError::Missing(_) => Failure::Points {
            path: path.to_owned(),
            message: "the layout has no [volume] table, which says where the sensor may be: add one; \
                      docs/layout-format.md describes it"
                .to_owned(),
        },
        error => Failure::Film { layout: path.to_owned(), error: Box::new(error) },
    }
}

/// The failure of a verb that takes points from the working volume of a layout without one.
pub(crate) fn no_points(path: &Path, error: FilmError) -> Failure {
    match error {
        FilmError::Missing(_) => Failure::Points {
            path: path.to_owned(),
            message: "the layout has no [volume] table to take points from: add one, or give --points".to_owned(),
        },
        error => Failure::Film { layout: path.to_owned(), error: Box::new(error) },
    }
}
