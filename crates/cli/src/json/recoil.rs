//! What recoil changes in a film.

use magsplice::decouple::{Figures, PerAxis, PerParameter};
use magsplice::{FilmRecoil, RecoilEstimate};
use serde::Serialize;

/// The solution, with estimates of its errors.
#[derive(Serialize)]
pub(crate) struct RecoilJson {
    cells: usize,
    level: usize,
    /// Largest change of B.
    change_t: f64,
    /// Estimate of the largest error of B.
    error_t: f64,
    /// Figures over a few points of the working volume.
    #[serde(skip_serializing_if = "Option::is_none")]
    figures: Option<FiguresJson>,
    largest_weakening: f64,
    largest_turn_deg: f64,
}

#[derive(Serialize)]
struct FiguresJson {
    without: FilmFiguresJson,
    with: FilmFiguresJson,
    errors: FilmFiguresJson,
}

#[derive(Serialize)]
struct FilmFiguresJson {
    amplitude: f64,
    uniformity_rmse: PerParameter<Option<f64>>,
    displacement_rmse_mm: PerAxis,
}

impl From<Figures> for FilmFiguresJson {
    fn from(figures: Figures) -> FilmFiguresJson {
        let Figures { amplitude, uniformity_rmse, displacement_rmse_mm } = figures;
        FilmFiguresJson { amplitude, uniformity_rmse, displacement_rmse_mm }
    }
}

/// An estimate to first order.
#[derive(Serialize)]
pub(crate) struct RecoilEstimateJson {
    /// Null for the permeabilities that the layout states.
    recoil_permeability: Option<f64>,
    without: FilmFiguresJson,
    with: FilmFiguresJson,
}

impl RecoilJson {
    pub(crate) fn new(recoil: &FilmRecoil) -> RecoilJson {
        let figures = recoil.figures().zip(recoil.figure_errors());
        let changes = recoil.tile_changes();
        RecoilJson {
            cells: recoil.magnetization().cells().len(),
            level: recoil.level(),
            change_t: recoil.change_t(),
            error_t: recoil.error_t(),
            figures: figures.map(|([without, with], errors)| FiguresJson {
                without: without.into(),
                with: with.into(),
                errors: errors.into(),
            }),
            largest_weakening: changes.iter().map(|change| change.weakening).fold(f64::NEG_INFINITY, f64::max),
            largest_turn_deg: changes.iter().map(|change| change.angle.to_degrees()).fold(0.0, f64::max),
        }
    }
}

impl From<&RecoilEstimate> for RecoilEstimateJson {
    fn from(estimate: &RecoilEstimate) -> RecoilEstimateJson {
        let RecoilEstimate { permeability, rigid, recoil } = *estimate;
        RecoilEstimateJson { recoil_permeability: permeability, without: rigid.into(), with: recoil.into() }
    }
}
