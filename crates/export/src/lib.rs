//! Fields, decoupling parameters and tiles as files of other tools.
//!
//! A [`Table`](magsplice::results::Table) holds points, the quantities at each point, and metadata.
//! [`csv`], [`json`], [`numpy`], [`vtk`] and, with the feature `parquet`, the module `parquet`
//! write a table. [`vtk`], [`magpylib`], [`dxf`] and [`stl`] write the tiles of a layout. Every
//! function writes to a [`std::io::Write`] and returns the errors of that writer.
//!
//! This crate computes nothing, opens no file and parses no arguments. The page
//! `docs/file-formats.md` lists the names and units in the files.
//!
//! # Adding a format
//!
//! 1. Add a file to this crate with a function `write(table: &Table, w: &mut dyn Write) ->
//!    io::Result<()>`. `Table::columns` gives every column with its name; `Table::metadata`
//!    describes the source of the table.
//! 2. Add a variant to `TableFormat` in `crates/cli/src/args/formats.rs`. The compiler then reports
//!    each `match` of the program that needs a line: the extension, and the call of the function in
//!    `crates/cli/src/output/table.rs`. `DecoupleFormat` beside it lists the formats of `decouple`.

/// The displacement of a sensor as a C header.
pub mod c_header;
/// Tables as CSV, and loads on tiles.
pub mod csv;
/// Faces of tiles.
mod cuboid_faces;
/// A film as a DXF drawing, seen from above.
pub mod dxf;
/// Any value as JSON with one entry per line.
pub mod json;
/// Results of checks as JUnit, for build systems.
pub mod junit;
/// A film as a Python script for magpylib.
pub mod magpylib;
/// A Python script that writes a magpylib collection as a table of blocks.
pub mod magpylib_import;
/// Tables as NPY and NPZ, for NumPy.
pub mod numpy;
/// Tables as Parquet.
#[cfg(feature = "parquet")]
pub mod parquet;
/// A film as STL bodies.
pub mod stl;
/// Tables and tiles as XML files for VTK and ParaView.
pub mod vtk;
