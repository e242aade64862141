//! `read`: every reading.

use magsplice::Film;
use magsplice::results::{Source, Table};
use serde::Serialize;

/// The result of `read`.
#[derive(Serialize)]
pub(crate) struct ReadJson {
    #[serde(flatten)]
    source: Source,
    readings: usize,
}

impl ReadJson {
    pub(crate) fn new(film: &Film, table: &Table) -> ReadJson {
        ReadJson { source: Source::of(film), readings: table.rows().len() }
    }
}
