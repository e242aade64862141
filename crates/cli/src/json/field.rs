//! `field`: every point.

use magsplice::Film;
use magsplice_export::Table;
use serde::Serialize;

use super::source::SourceJson;

/// The result of `field`.
#[derive(Serialize)]
pub(crate) struct FieldJson<'a> {
    #[serde(flatten)]
    source: SourceJson<'a>,
    points: usize,
    #[serde(flatten)]
    columns: ColumnsJson<'a>,
}

impl<'a> FieldJson<'a> {
    pub(crate) fn new(film: &Film<'a>, table: &'a Table) -> FieldJson<'a> {
        FieldJson { source: SourceJson::new(film), points: table.rows().len(), columns: ColumnsJson::new(table) }
    }
}

/// The columns of a table as lists.
#[derive(Serialize)]
pub(crate) struct ColumnsJson<'a> {
    /// Shape of each column as an array: counts along x, y, z on a grid, else the number of points.
    shape: Vec<usize>,
    columns: &'a Table,
}

impl<'a> ColumnsJson<'a> {
    pub(crate) fn new(table: &'a Table) -> ColumnsJson<'a> {
        ColumnsJson { shape: table.rows().shape(), columns: table }
    }
}
