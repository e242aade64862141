//! One file per verb. A verb reads its inputs, runs the library, and passes on the result.

/// Places measured tiles.
pub(crate) mod assign;
/// Measures how fast the field is computed.
pub(crate) mod bench;
/// Tells where the displacement error of the films that are made comes from.
pub(crate) mod budget;
/// Fits the stiffness of the elastic layer.
pub(crate) mod calibrate;
/// Validates layouts, and checks films against their expectations.
pub(crate) mod check;
/// Compares the field with the ideal film.
pub(crate) mod compare;
/// Prints the script with which a shell completes arguments.
pub(crate) mod completions;
/// Evaluates a film: field, comparison and decoupling errors.
pub(crate) mod decouple;
/// Searches for a better film.
pub(crate) mod design;
/// Tells which tiles of a film that was made are wrong.
pub(crate) mod diagnose;
/// Moves the film and tells what its sensor reads.
pub(crate) mod experiment;
/// Writes the film for another program.
pub(crate) mod export;
/// Computes the field at points.
pub(crate) mod field;
/// Computes the forces of the tiles on each other.
pub(crate) mod forces;
/// Makes a layout from a table of blocks.
pub(crate) mod import;
/// Writes a commented layout to start from.
pub(crate) mod init;
/// Shows which methods a tolerance allows.
pub(crate) mod plan;
/// Finds displacements of the sensor from what it read.
pub(crate) mod read;
/// Draws figures and a page.
#[cfg(feature = "report")]
pub(crate) mod report;
/// Tells how small displacements noise lets a sensor see.
pub(crate) mod resolution;
/// Compares a measured scan with the layout.
pub(crate) mod scan;
/// Prints the JSON Schema of layout files.
pub(crate) mod schema;
/// Designs a film from nothing.
pub(crate) mod splice;
/// Lists the tiles of a layout and its bill of materials.
pub(crate) mod tiles;
/// Samples the films that are made from a layout.
pub(crate) mod tolerance;

/// Name and version of the program in the history of layouts.
const PROGRAM: &str = concat!("magsplice ", env!("CARGO_PKG_VERSION"));
