//! `read`: every reading.

use magsplice::Film;
use magsplice_export::Table;
use serde::Serialize;

use super::field::ColumnsJson;
use super::source::SourceJson;

/// The result of `read`.
#[derive(Serialize)]
pub(crate) struct ReadJson<'a> {
    #[serde(flatten)]
    source: SourceJson<'a>,
    readings: usize,
    #[serde(flatten)]
    columns: ColumnsJson<'a>,
}

impl<'a> ReadJson<'a> {
    pub(crate) fn new(film: &Film<'a>, table: &'a Table) -> ReadJson<'a> {
        ReadJson { source: SourceJson::new(film), readings: table.rows().len(), columns: ColumnsJson::new(table) }
    }
}
