//! Results of films: one serializable value for each step, with its source and its columns.
//!
//! Names of fields carry their units; they are the keys of JSON files and of Python dictionaries.

/// Which measured tile goes to which place.
mod assignment;
/// Readings at the limit of the sensor's range.
mod at_limit;
/// How fast the field is computed.
mod bench;
/// The causes of the displacement error of films as made.
mod budget;
/// The stiffness of the elastic layer.
mod calibration;
/// The outcome of an expectation.
mod check;
/// Layout files with the outcomes of their expectations.
mod checked_layout;
/// The comparison with the ideal film.
mod comparison;
/// Decoupling parameters over the working volume.
mod decoupling;
/// Which tiles of a film that was made are faulty.
mod diagnosis;
/// What speaks against a diagnosis.
mod diagnosis_remarks;
/// Errors of tiles in words.
mod error_words;
/// Experiments in which the film is moved.
mod experiment;
/// The field at points.
mod field;
/// Faults of a log of forces and readings.
mod force_log;
/// Loads on tiles, and a placement order.
mod forces;
/// A film that a search found.
#[cfg(feature = "design")]
mod found_film;
/// The films of a trade-off.
#[cfg(feature = "design")]
mod front;
/// What the readings of all sensors of a head tell.
mod head_fits;
/// The head of a film in numbers.
mod head_summary;
/// The flat iron of a layout in words.
mod iron_summary;
/// Typical errors of every tile that explain a scan.
mod likelier_errors;
/// Readings beyond the range of the sensor.
mod out_of_range;
/// The parts of a layout.
mod parts;
/// Whether the sensor of a scan was where it is stated.
mod placed_scan;
/// Where the sensor of a scan was.
pub(crate) mod placement;
/// The methods that a tolerance allows.
mod plan;
/// Decoupling parameters at points.
mod point_decoupling;
/// The displacement of a sensor as a polynomial.
mod polynomial;
/// Positions and forces from readings of a sensor.
mod readings;
/// The displacements that noise lets a sensor see.
mod resolution;
/// Computed scans of films as made.
mod sampled_scan;
/// Samples of films as made, and their statistics.
mod samples;
/// A measured scan, fitted.
mod scan;
/// What speaks against a fitted scan.
mod scan_remarks;
/// Positions of a head from the readings of all its sensors.
mod sensors_readings;
/// Numbers with as many digits as a person would write.
mod significant;
/// Layout, program and accuracy of a result.
mod source;
/// [`Table`]: rows, quantities and metadata, from which every format is written.
mod table;
/// The search for errors of tiles in a scan.
mod tile_search;

pub use assignment::{FilmAssignment, Shim};
pub use at_limit::{larger_range, range_of_setting};
pub use bench::{BenchCase, FilmBench};
pub use budget::{BudgetPart, FilmBudget, Improvement};
pub use calibration::FilmCalibration;
pub use check::{CheckStatus, CheckedExpectation, CheckedPercentile};
pub use checked_layout::{Check, CheckedLayout, SkippedFile};
pub use comparison::{FilmComparison, remark_about_amplitude};
pub use decoupling::{FilmDecoupling, FilmEvaluation};
pub use diagnosis::{FaultyTile, FilmDiagnosis, SimilarPair, Suspect, UnresolvedError};
pub use experiment::{EXPERIMENT_STEP_MM, FilmExperiments};
pub use field::{FieldAtPoints, PointQuantity};
pub use force_log::LogFault;
pub use forces::{FilmLoads, ForceChange, LoadN, OrderChoice, OrderedLoads, TileLoad};
#[cfg(feature = "design")]
pub use found_film::FoundFilm;
#[cfg(feature = "design")]
pub use front::{FilmFront, FrontFilm};
pub use head_fits::{HeadFits, RESIDUAL_ALARM};
pub use head_summary::HeadSummary;
pub use iron_summary::IronSummary;
pub use out_of_range::OutOfRange;
pub use parts::{BillOfMaterials, MAX_KERF_MM, PartItem};
pub use placement::{FittedScan, SensorPlacement};
pub use plan::FilmPlan;
pub use point_decoupling::{FilmPointDecoupling, FilmPointEvaluation, Omitted};
pub use polynomial::SensorPolynomial;
pub use readings::{AtRest, FilmReadings};
pub use resolution::{FilmResolution, ResolutionSummary, SensorsResolution};
pub use sampled_scan::SampledScan;
pub use samples::{FilmSampling, SampleRun, SampledFigure, SampledFilm, in_stretches};
pub use scan::{ExcludedReadings, FilmScan, ScanUniformity};
pub use significant::{number, rounded_beside, twelve_digits};
pub use source::{LayoutSource, Source};
pub use table::{ColumnQuantity, Metadata, MetadataValue, Points, Rows, Table, TableColumn, Tabled};
