//! The methods that a tolerance allows for the field of a film.

use glam::DVec3;
use magsplice_field::PlannedPart;
use magsplice_magnet::{PointErrorCause, PointErrors, Quantity};
use serde::Serialize;

use super::source::Source;
use super::table::Points;
use crate::film::Film;
use crate::film_error::FilmError;
use crate::film_recoil::RecoilEstimate;
use crate::stage::Stage;

/// Number of points at which the field is evaluated to find out whether the tolerance can be kept.
const TRIED_POINTS: usize = 64;

/// The methods that the accuracy of a film allows at points, and their costs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FilmPlan {
    /// The film.
    #[serde(flatten)]
    pub source: Source,
    /// The parts, each with a method for some of the points.
    pub parts: Vec<PlannedPart>,
    /// Cost of all parts, in exact fields of one tile at one point.
    pub cost: f64,
    /// Cost of direct summation of all tiles at all points.
    pub exact_cost: f64,
    /// What recoil changes, to first order.
    pub recoil_estimates: Vec<RecoilEstimate>,
}

impl Film {
    /// The plan for points.
    ///
    /// # Errors
    /// [`FilmError::Points`] if the field does not keep the tolerance at a few of the points;
    /// [`FilmError::Recoil`] if tiles overlap.
    pub fn plan(&self, points: &Points) -> Result<FilmPlan, FilmError> {
        self.tell(Stage::uncounted("planning"));
        let tried: Vec<DVec3> = points.iter().step_by(points.len().div_ceil(TRIED_POINTS).max(1)).collect();
        if let Err(PointErrors(mut errors)) = self.scene().field_at(Quantity::FluxDensity, &tried) {
            // Points without any field are no matter of the tolerance, and have a plan like others.
            errors.retain(|error| matches!(error.cause, PointErrorCause::TooExact { .. }));
            if !errors.is_empty() {
                return Err(FilmError::Points(PointErrors(errors)));
            }
        }
        let plan = match points {
            Points::Grid(grid) => self.scene().plan_on_grid(grid),
            Points::Scattered(points_mm) => self.scene().plan_at_points(points_mm),
        };
        Ok(FilmPlan {
            source: Source::of(self),
            cost: plan.cost(),
            parts: plan.parts,
            exact_cost: plan.exact_cost,
            recoil_estimates: RecoilEstimate::usual(self.layout())?,
        })
    }
}
