//! The film that a search returns.

use magsplice_decouple::PerParameter;
use magsplice_magnet::Tile;

use crate::progress::SearchStage;
use crate::search::made_films::MadeFilms;
use crate::search::metrics::Metrics;
use crate::search::shortfall::Shortfall;

/// A film that a search found, with its errors before and after. Lengths in millimetres,
/// polarization in tesla.
#[derive(Clone, Debug, serde::Serialize)]
pub struct SearchResult {
    /// The tiles, in the order of the layout. They are not serialized, because
    /// [`DesignProblem::designed_layout`](crate::DesignProblem::designed_layout) writes them.
    #[serde(skip)]
    pub tiles: Vec<Tile>,
    /// The spacing of the head in millimetres, if the brief lets it vary.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spacing_mm: Option<f64>,
    /// Errors of the layout's film over its working volume, below the head of the film found.
    pub before: Metrics,
    /// Errors of the designed film over the working volume.
    pub after: Metrics,
    /// Errors of the designed film over the design grid refined five times.
    #[serde(rename = "five_times_finer")]
    pub finer: Metrics,
    /// Errors of films as made, if the brief counts them or they were sampled after the search, and
    /// every sample has errors.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub made: Option<MadeFilms>,
    /// The error that the search minimizes: the root of the weighted sum of squares of the three
    /// uniformity or displacement RMSE, the latter in millimetres, by the goal of the brief; 95th
    /// percentiles where the brief counts films as made; the scaled relative RMSE of B for the goal
    /// `field`.
    pub error: f64,
    /// Metrics after each stage, in the order of the stages.
    pub stages: Vec<StageMetrics>,
    /// Number of distinct parts: sizes with a direction of polarization.
    pub parts: usize,
    /// Number of starts whose error is within a tenth of the best.
    #[serde(rename = "starts_that_agree")]
    pub agreeing_starts: usize,
    /// Demands of the layout that the film misses. Empty if it meets all.
    pub short_of: Vec<Shortfall>,
    /// Whether the progress callback stopped the search.
    pub interrupted: bool,
}

/// Metrics of the film at the end of a stage.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct StageMetrics {
    /// The stage that ended.
    pub stage: SearchStage,
    /// Uniformity RMSE over the working volume.
    pub uniformity_rmse: PerParameter<Option<f64>>,
}

#[cfg(test)]
mod tests {
    use magsplice_decouple::Figures;

    use super::*;

    #[test]
    fn metrics_and_stages_are_serialized_with_names_and_units() {
        let uniformity_rmse = PerParameter { r_x: Some(1.0), r_y: Some(2.0), s_z: None };
        let metrics = Metrics {
            points: 9,
            figures: Figures { uniformity_rmse, displacement_rmse_mm: [5.0, 6.0, 7.0].into(), amplitude: 0.5 },
            ideal_rmse: PerParameter { r_x: 4.0, r_y: 2.0, s_z: 3.0 },
            scaled_relative_rmse: None,
        };
        assert_eq!(
            serde_json::to_string(&metrics).unwrap(),
            r#"{"points":9,"uniformity_rmse":{"r_x":1.0,"r_y":2.0,"s_z":null},"#.to_owned()
                + r#""displacement_rmse_mm":{"x":5.0,"y":6.0,"z":7.0},"amplitude":0.5,"#
                + r#""ideal_rmse":{"r_x":4.0,"r_y":2.0,"s_z":3.0},"scaled_relative_rmse":null}"#
        );
        let stage = StageMetrics { stage: SearchStage::Parts(4), uniformity_rmse };
        let written = r#"{"stage":"fewer parts","uniformity_rmse":{"r_x":1.0,"r_y":2.0,"s_z":null}}"#;
        assert_eq!(serde_json::to_string(&stage).unwrap(), written);
    }
}
