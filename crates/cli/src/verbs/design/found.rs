//! A film found, as JSON.

use magsplice::decouple::PerParameter;
use magsplice::design::{Metrics, SearchResult, StageMetrics};
use serde::Serialize;

/// [`SearchResult`] with units in its keys.
#[derive(Serialize)]
pub(crate) struct Found {
    before: FiguresReport,
    after: FiguresReport,
    five_times_finer: FiguresReport,
    stages: Vec<StageReport>,
    parts: usize,
    starts_that_agree: usize,
    short_of: Vec<String>,
    interrupted: bool,
}

#[derive(Serialize)]
struct FiguresReport {
    points: usize,
    uniformity_rmse: [f64; 3],
    ideal_rmse: [f64; 3],
    displacement_rmse_mm: [f64; 3],
    amplitude: f64,
    scaled_relative_rmse: Option<f64>,
}

#[derive(Serialize)]
struct StageReport {
    stage: &'static str,
    uniformity_rmse: [f64; 3],
}

impl Found {
    pub(crate) fn of(outcome: &SearchResult) -> Found {
        let figures = |f: &Metrics| FiguresReport {
            points: f.points,
            uniformity_rmse: array(f.uniformity_rmse),
            ideal_rmse: array(f.ideal_rmse),
            displacement_rmse_mm: f.displacement_rmse_mm,
            amplitude: f.amplitude,
            scaled_relative_rmse: f.scaled_relative_rmse,
        };
        let stage = |stage: &StageMetrics| StageReport {
            stage: stage.stage.name(),
            uniformity_rmse: array(stage.uniformity_rmse),
        };
        Found {
            before: figures(&outcome.before),
            after: figures(&outcome.after),
            five_times_finer: figures(&outcome.finer),
            stages: outcome.stages.iter().map(stage).collect(),
            parts: outcome.parts,
            starts_that_agree: outcome.agreeing_starts,
            short_of: outcome.short_of.clone(),
            interrupted: outcome.interrupted,
        }
    }
}

pub(super) fn array(p: PerParameter) -> [f64; 3] {
    [p.r_x, p.r_y, p.s_z]
}
