//! Layout, program and accuracy of a result.

use magsplice::Film;
use magsplice::field::{Accuracy, Tolerance};
use serde::Serialize;

/// What a result was computed from.
#[derive(Serialize)]
pub(crate) struct SourceJson<'a> {
    layout: &'a str,
    sha256: &'a str,
    version: &'static str,
    tiles: usize,
    accuracy: AccuracyJson,
}

/// Accuracy of the field of the working volume.
#[derive(Serialize)]
#[serde(rename_all = "snake_case")]
enum AccuracyJson {
    Exact,
    /// Largest error at every point, as a fraction of |B|.
    Relative(f64),
    /// Largest error at every point, in tesla.
    AbsoluteT(f64),
}

impl From<Accuracy> for AccuracyJson {
    fn from(accuracy: Accuracy) -> AccuracyJson {
        match accuracy {
            Accuracy::Exact => AccuracyJson::Exact,
            Accuracy::Within(Tolerance::Relative { fraction, .. }) => AccuracyJson::Relative(fraction),
            Accuracy::Within(Tolerance::AbsoluteT { error_t, .. }) => AccuracyJson::AbsoluteT(error_t),
        }
    }
}

impl<'a> SourceJson<'a> {
    pub(crate) fn new(film: &Film<'a>) -> SourceJson<'a> {
        let layout = film.layout();
        SourceJson {
            layout: &layout.name,
            sha256: &layout.sha256,
            version: env!("CARGO_PKG_VERSION"),
            tiles: layout.tiles.len(),
            accuracy: film.scene().accuracy().into(),
        }
    }
}
