//! Layout, program and accuracy of a result.

use magsplice_layout::Layout;
use magsplice_magnet::Accuracy;
use serde::Serialize;

use super::head_summary::HeadSummary;
use super::table::{Metadata, MetadataValue};
use crate::film::Film;
use crate::film_recoil::RecoilSummary;

/// The layout of a result, and the version of the library that computed it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LayoutSource {
    /// Name of the layout.
    pub layout: String,
    /// SHA-256 of the text of the layout file.
    pub sha256: String,
    /// Version of the library.
    pub version: &'static str,
    /// Largest error of the field one radius away from a disc, over the largest field there. `None`
    /// without discs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shape_error: Option<f64>,
    /// Largest error of the field of an endless wave in slices where the working volume is nearest
    /// to it, over the field there. `None` without waves.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slice_error: Option<f64>,
}

/// The source of a result that depends on the field of a film.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Source {
    /// The layout.
    #[serde(flatten)]
    pub layout: LayoutSource,
    /// Number of tiles.
    pub tiles: usize,
    /// Accuracy of the field.
    pub accuracy: Accuracy,
    /// The head that reads the film. `None` for one sensor.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub head: Option<HeadSummary>,
    /// What recoil changes. `None` if no tile has a recoil permeability.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recoil: Option<RecoilSummary>,
}

impl LayoutSource {
    /// The source of a result of this layout.
    pub fn of(layout: &Layout) -> LayoutSource {
        LayoutSource {
            layout: layout.name.clone(),
            sha256: layout.sha256.clone(),
            version: env!("CARGO_PKG_VERSION"),
            shape_error: layout.shape_error,
            slice_error: layout.slice_error,
        }
    }

    /// Metadata of a table: the layout, its hash, the version, and the number of tiles.
    pub fn metadata(&self, tiles: usize) -> Metadata {
        let mut metadata = vec![
            ("layout", MetadataValue::Text(self.layout.clone())),
            ("sha256", MetadataValue::Text(self.sha256.clone())),
            ("version", MetadataValue::Text(self.version.to_owned())),
            ("tiles", MetadataValue::Count(tiles)),
        ];
        let errors = [("shape_error", self.shape_error), ("slice_error", self.slice_error)].into_iter();
        metadata.extend(errors.filter_map(|(key, error)| Some((key, MetadataValue::Numbers(vec![error?])))));
        metadata
    }
}

impl Source {
    /// The source of a result of this film.
    pub fn of(film: &Film) -> Source {
        Source {
            layout: LayoutSource::of(film.layout()),
            tiles: film.layout().tiles.len(),
            accuracy: film.scene().accuracy(),
            head: HeadSummary::of(film.layout()),
            recoil: film.recoil().map(|recoil| recoil.summary.clone()),
        }
    }

    /// Metadata of a table, which has no nested values.
    pub fn metadata(&self) -> Metadata {
        let mut metadata = self.layout.metadata(self.tiles);
        metadata.push(("accuracy", MetadataValue::Text(self.accuracy.to_string())));
        if let Some(head) = &self.head {
            metadata.push(("head", MetadataValue::Text(head.to_string())));
        }
        if let Some(recoil) = &self.recoil {
            metadata.push(("recoil_cells", MetadataValue::Count(recoil.cells)));
            metadata.push(("recoil_error_t", MetadataValue::Numbers(vec![recoil.error_t])));
        }
        metadata
    }
}
