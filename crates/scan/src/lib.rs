//! From a measured field to the film: the parameters of a scan, and the faulty tiles of a film as
//! made.
//!
//! * [`fit_scan`]: strength, offset, rotation and start of a measured scan, a [`ScanFit`].
//! * [`ScanPositions`]: the grid of a scan, its gaps and repeated positions.
//! * [`SampleScan`]: the scan of a film as made, computed to try the others.
//! * [`ScanDiagnosis`]: the weak, turned or displaced tiles, a [`Diagnosis`].
//!
//! A fit has ten unknowns and reports the combinations that a scan does not determine. A diagnosis
//! has hundreds of unknowns, each with a prior deviation. Each has its own least-squares solver;
//! both share [`ScanParameters`].
//!
//! Flux densities in tesla. Lengths of a diagnosis are in millimetres; a fit takes any one unit,
//! the unit of the tiles. The equations are in docs/physics.md, section 8. This crate reads no
//! files and prints nothing.

// Rules are written as `!(x > limit)` so that NaN breaks them.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

/// Columns that no scan has.
mod column_fault;
/// Faulty tiles of a film as made, from a scan of its field.
mod diagnosis;
/// Readings that a fit does not use.
mod exclusion;
/// Fits of measured scans.
mod fit;
/// Errors of a fit.
mod fit_error;
/// A log that repeats one row.
mod frozen_log;
/// The least squares of a fit.
mod least_squares;
/// The parameters of a scan.
mod parameters;
/// The positions of a scan.
mod positions;
/// Another order of the readings of a scan.
mod row_order;
/// Positions and readings of a scan that are not in step.
mod row_order_search;
/// Computed scans of films as made.
mod sample_scan;
/// Changes of readings by the parameters of a scan.
mod scan_columns;
/// Faults of a sensor.
mod sensor_fault;
/// Exchanged and reversed axes.
mod signed_axes;
/// Where a fit starts.
mod starts;
/// Readings at one position that contradict each other.
mod still_positions;
/// An axis of a sensor that repeats its reading.
mod stuck_axis;
/// The tile that most likely has another strength.
mod suspect;
/// The search for a turn of a film.
mod turn;
/// A turn of a film against the positions.
mod turned_film;
/// Units that are given by mistake.
mod units;

pub use column_fault::ColumnFault;
pub use diagnosis::{
    Candidate, DetectedError, Diagnosis, DiagnosisError, DiagnosisSettings, ErrorKind, FALSE_ALARM, FieldScan,
    FittedError, MOST_ERRORS, NarrowedError, ScanDiagnosis, SimilarErrors,
};
pub use exclusion::{Exclusion, Plateau};
pub use fit::{KNOWN_NOISE, PLAUSIBLE_STRENGTHS, ROUND_OFF, ScanField, fit_determined, fit_scan};
pub use fit_error::ScanError;
pub use frozen_log::FrozenLog;
pub use least_squares::ScanFit;
pub use parameters::{FreeParameters, ScanParameter, ScanParameters};
pub use positions::ScanPositions;
pub use row_order::RowOrder;
pub use row_order_search::{find_row_order, is_row_order_likely};
pub use sample_scan::{SampleScan, SampleScanError};
pub use sensor_fault::SensorFault;
pub use signed_axes::SignedAxes;
pub use still_positions::StillPositions;
pub use stuck_axis::StuckAxis;
pub use suspect::suspect_strength;
pub use turn::film_turn;
pub use turned_film::FilmTurn;
pub use units::FLUX_DENSITIES;
