//! The methods that a tolerance allows for the field of a film.

use glam::DVec3;
use magsplice_field::{Plan, PlannedPart};
use magsplice_magnet::{PointErrorCause, PointErrors, Quantity};
use serde::Serialize;

use super::source::Source;
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
    /// The plan for the grid of the working volume.
    ///
    /// # Errors
    /// [`FilmError::Missing`] without a working volume; [`FilmError::Points`] if the field does not
    /// keep the tolerance at a few of the points; [`FilmError::Recoil`] if tiles overlap.
    pub fn plan(&self) -> Result<FilmPlan, FilmError> {
        let grid = self.volume()?.grid;
        self.checked_plan(grid.len(), |index| grid.point(index), || self.scene().plan_on_grid(&grid))
    }

    /// The plan for points in millimetres.
    ///
    /// # Errors
    /// As [`Film::plan`].
    pub fn plan_at(&self, points_mm: &[DVec3]) -> Result<FilmPlan, FilmError> {
        self.checked_plan(points_mm.len(), |index| points_mm[index], || self.scene().plan_at_points(points_mm))
    }

    fn checked_plan(
        &self,
        points: usize,
        point: impl Fn(usize) -> DVec3,
        plan: impl Fn() -> Plan,
    ) -> Result<FilmPlan, FilmError> {
        self.tell(Stage::uncounted("planning"));
        let tried: Vec<DVec3> = (0..points).step_by(points.div_ceil(TRIED_POINTS).max(1)).map(point).collect();
        if let Err(PointErrors(mut errors)) = self.scene().field_at(Quantity::FluxDensity, &tried) {
            // Points without any field are no matter of the tolerance, and have a plan like others.
            errors.retain(|error| matches!(error.cause, PointErrorCause::TooExact { .. }));
            if !errors.is_empty() {
                return Err(FilmError::Points(PointErrors(errors)));
            }
        }
        let plan = plan();
        Ok(FilmPlan {
            source: Source::of(self),
            cost: plan.cost(),
            parts: plan.parts,
            exact_cost: plan.exact_cost,
            recoil_estimates: RecoilEstimate::usual(self.layout())?,
        })
    }
}
