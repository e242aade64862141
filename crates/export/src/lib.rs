//! Fields, decoupling parameters and tiles in the files of other tools.
//!
//! A [`Table`] holds points, what is known at them, and what it was made from; [`csv`], [`json`], [`numpy`], [`vtk`] and, with the feature of that name,
//! `parquet` write it to any writer. [`vtk`] and [`magpylib`] write the tiles of a layout. docs/file-formats.md says what is in a file under which name.

pub mod csv;
pub mod json;
pub mod magpylib;
pub mod numpy;
#[cfg(feature = "parquet")]
pub mod parquet;
mod table;
pub mod vtk;

pub use table::{Column, Metadata, Points, Quantity, Table, Value};
