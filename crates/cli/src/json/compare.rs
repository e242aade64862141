//! `compare`: the comparison with the ideal film.

use magsplice::Film;
use magsplice::ideal::Comparison;
use serde::Serialize;

use super::renamed::RenamedJson;
use super::source::SourceJson;
use crate::remarks::about_amplitude;

/// The result of `compare`.
#[derive(Serialize)]
pub(crate) struct CompareJson<'a> {
    #[serde(flatten)]
    source: SourceJson<'a>,
    comparison: RenamedJson,
    /// What an unusual result means, in words.
    #[serde(skip_serializing_if = "Option::is_none")]
    remark: Option<&'static str>,
}

impl<'a> CompareJson<'a> {
    pub(crate) fn new(film: &Film<'a>, compared: &Comparison) -> CompareJson<'a> {
        let remark = about_amplitude(compared.amplitude);
        CompareJson { source: SourceJson::new(film), comparison: comparison(compared), remark }
    }
}

/// A comparison with lengths in millimetres.
pub(crate) fn comparison(comparison: &Comparison) -> RenamedJson {
    RenamedJson::new(comparison, &[("worst_at", "worst_at_mm")])
}
