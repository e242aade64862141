//! Writing tables.

use magsplice::results::{Table, Tabled};
use magsplice_export::{csv, json, numpy, vtk};
use serde::Serialize;

use super::destination::Output;
use crate::args::formats::TableFormat;
use crate::failure::Failure;

/// Writes the table of a result; as JSON with the result.
pub(crate) fn write(
    table: &Table,
    result: &impl Serialize,
    format: TableFormat,
    output: &mut Output,
) -> Result<(), Failure> {
    output.write(|w| match format {
        TableFormat::Csv => csv::write(table, w),
        TableFormat::Json => json::write(&Tabled::new(result, table), w),
        TableFormat::Npy => numpy::npy(table, w),
        TableFormat::Npz => numpy::npz(table, w),
        TableFormat::Vtk => vtk::table(table, w),
        #[cfg(feature = "parquet")]
        TableFormat::Parquet => magsplice_export::parquet::write(table, w),
        #[cfg(not(feature = "parquet"))]
        TableFormat::Parquet => Err(std::io::Error::other(super::choice::WITHOUT_PARQUET)),
    })
}
