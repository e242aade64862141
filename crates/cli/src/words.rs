//! Errors of the library in words with the names of tiles.

use std::path::Path;

use magsplice::FilmError;
use magsplice::layout::{Layout, PartSetting, StatedSensor};
use magsplice::magnet::PointErrorCause;
use magsplice::prelude::DVec3;

use crate::failure::Failure;
use crate::faults::FaultList;
use crate::text::number::{number, point};
use crate::text::units::in_mt;

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

/// The setting of a sensor's part that holds these readings, and its range, as the end of a
/// sentence. `None` if no setting holds them.
pub(crate) fn larger_range<'r>(
    sensor: &StatedSensor,
    readings_t: impl IntoIterator<Item = &'r DVec3>,
) -> Option<String> {
    sensor.setting_for(readings_t).map(range_of_setting)
}

/// A setting and its range, as the end of a sentence.
pub(crate) fn range_of_setting((setting, range_t): (PartSetting, DVec3)) -> String {
    format!("; {setting} in [sensor] has the range {}", flux_density_mt(range_t))
}

/// A flux density along x, y, z.
pub(crate) fn flux_density_mt(vector_t: DVec3) -> String {
    let [x, y, z] = in_mt(vector_t).to_array().map(number);
    format!("({x}, {y}, {z}) mT")
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
