//! Layout, program and accuracy of a result.

use magsplice::Film;
use magsplice::magnet::Accuracy;
use serde::Serialize;

use super::recoil::RecoilJson;

/// Source of a result: layout, hash and accuracy.
#[derive(Serialize)]
pub(crate) struct SourceJson<'a> {
    layout: &'a str,
    sha256: &'a str,
    version: &'static str,
    tiles: usize,
    accuracy: Accuracy,
    #[serde(skip_serializing_if = "Option::is_none")]
    recoil: Option<RecoilJson>,
}

impl<'a> SourceJson<'a> {
    pub(crate) fn new(film: &Film<'a>) -> SourceJson<'a> {
        let layout = film.layout();
        SourceJson {
            layout: &layout.name,
            sha256: &layout.sha256,
            version: env!("CARGO_PKG_VERSION"),
            tiles: layout.tiles.len(),
            accuracy: film.scene().accuracy(),
            recoil: film.recoil().map(RecoilJson::new),
        }
    }
}
