//! Numbers of a row in groups of columns.

use magsplice::prelude::DVec3;

use super::finder::Column;
use super::table::CsvTable;

/// The numbers of a row in these columns, or `None` after adding faults.
pub(crate) fn numbers<const N: usize>(
    columns: &[Column; N],
    table: &mut CsvTable,
    line: u64,
    faults: &mut Vec<String>,
) -> Option<[f64; N]> {
    let before = faults.len();
    let numbers = columns.map(|column| number(column, table, line, faults));
    (faults.len() == before).then_some(numbers)
}

/// The number of a row in a column, or 0 after adding a fault.
pub(crate) fn number(column: Column, table: &mut CsvTable, line: u64, faults: &mut Vec<String>) -> f64 {
    match table.number(column.index, column.exponent, line) {
        Ok(radians) if column.is_in_radians => radians.to_degrees(),
        Ok(value) => value,
        Err(fault) => {
            faults.push(fault);
            0.0
        }
    }
}

/// The vector of a row in these columns, or `None` after adding faults.
pub(crate) fn vector(
    columns: &[Column; 3],
    table: &mut CsvTable,
    line: u64,
    faults: &mut Vec<String>,
) -> Option<DVec3> {
    numbers(columns, table, line, faults).map(DVec3::from)
}
