//! The film that a search returns.

use magsplice_decouple::PerParameter;
use magsplice_magnet::Tile;

use crate::progress::SearchStage;
use crate::search::made_films::MadeFilms;
use crate::search::metrics::Metrics;

/// A film that a search found, with its errors before and after. Lengths in millimetres,
/// polarization in tesla.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct SearchResult {
    /// The tiles, in the order of the layout. They are not serialized, because
    /// [`DesignProblem::designed_layout`](crate::DesignProblem::designed_layout) writes them.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub tiles: Vec<Tile>,
    /// Errors of the layout's film over its working volume.
    pub before: Metrics,
    /// Errors of the designed film over the working volume.
    pub after: Metrics,
    /// Errors of the designed film over the design grid refined five times.
    #[cfg_attr(feature = "serde", serde(rename = "five_times_finer"))]
    pub finer: Metrics,
    /// Errors of the films that are made, if the brief counts them and every sample has errors.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub made: Option<MadeFilms>,
    /// Metrics after each stage, in the order of the stages.
    pub stages: Vec<StageMetrics>,
    /// Number of distinct parts: sizes with a direction of polarization.
    pub parts: usize,
    /// Number of starts whose error is within a tenth of the best.
    #[cfg_attr(feature = "serde", serde(rename = "starts_that_agree"))]
    pub agreeing_starts: usize,
    /// Demands of the layout that the film misses, each as value and rule. Empty if it meets all.
    pub short_of: Vec<String>,
    /// Whether the progress callback stopped the search.
    pub interrupted: bool,
}

/// Metrics of the film at the end of a stage.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct StageMetrics {
    /// The stage that ended.
    pub stage: SearchStage,
    /// Uniformity RMSE over the working volume.
    #[cfg_attr(feature = "serde", serde(serialize_with = "crate::search::metrics::as_array"))]
    pub uniformity_rmse: PerParameter,
}

#[cfg(all(test, feature = "serde"))]
mod tests {
    use super::*;

    #[test]
    fn metrics_and_stages_are_serialized_with_arrays_and_units() {
        let errors = |r_x: f64| PerParameter { r_x, r_y: 2.0, s_z: 3.0 };
        let metrics = Metrics {
            points: 9,
            uniformity_rmse: errors(1.0),
            ideal_rmse: errors(4.0),
            displacement_rmse_mm: [5.0, 6.0, 7.0],
            amplitude: 0.5,
            scaled_relative_rmse: None,
        };
        assert_eq!(
            serde_json::to_string(&metrics).unwrap(),
            r#"{"points":9,"uniformity_rmse":[1.0,2.0,3.0],"ideal_rmse":[4.0,2.0,3.0],"#.to_owned()
                + r#""displacement_rmse_mm":[5.0,6.0,7.0],"amplitude":0.5,"scaled_relative_rmse":null}"#
        );
        let stage = StageMetrics { stage: SearchStage::Parts(4), uniformity_rmse: errors(1.0) };
        let written = r#"{"stage":"fewer parts","uniformity_rmse":[1.0,2.0,3.0]}"#;
        assert_eq!(serde_json::to_string(&stage).unwrap(), written);
    }
}
