//! Results of films: one serializable value for each step, with its source and its columns.
//!
//! Names of fields carry their units; they are the keys of JSON files and of Python dictionaries.

/// How fast the field is computed.
mod bench;
/// The outcome of an expectation.
mod check;
/// Layout files with the outcomes of their expectations.
mod checked_layout;
/// The comparison with the ideal film.
mod comparison;
/// Decoupling parameters over the working volume.
mod decoupling;
/// The field at points.
mod field;
/// Loads on tiles, and an order of laying.
mod forces;
/// The parts of a layout.
mod parts;
/// The methods that a tolerance allows.
mod plan;
/// Decoupling parameters at points.
mod point_decoupling;
/// The displacement of a sensor as a polynomial.
mod polynomial;
/// What recoil changes in a film.
mod recoil;
/// Numbers with as many digits as a person would write.
mod significant;
/// Layout, program and accuracy of a result.
mod source;
/// [`Table`]: rows, quantities and metadata, from which every format is written.
mod table;

pub use bench::{BenchCase, BenchPoints, FilmBench};
pub use check::{CheckStatus, CheckedExpectation, CheckedPercentile};
pub use checked_layout::{Check, CheckedLayout, SkippedFile};
pub use comparison::{FilmComparison, remark_about_amplitude};
pub use decoupling::{FilmDecoupling, FilmEvaluation};
pub use field::{FieldAtPoints, PointQuantity};
pub use forces::{FilmLoads, LoadN, OrderChoice, OrderedLoads, TileLoad};
pub use parts::{BillOfMaterials, PartItem};
pub use plan::FilmPlan;
pub use point_decoupling::{FilmPointDecoupling, FilmPointEvaluation, LeftOut};
pub use polynomial::SensorPolynomial;
pub use recoil::RecoilSummary;
pub use significant::{rounded_beside, twelve_digits};
pub use source::{LayoutSource, Source};
pub use table::{ColumnQuantity, Metadata, MetadataValue, Points, Rows, Table, TableColumn, TableError, Tabled};
