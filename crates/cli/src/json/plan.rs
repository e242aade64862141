//! `plan`: the methods, their truncation errors and costs.

use magsplice::field::Plan;
use magsplice::{Film, RecoilEstimate};
use serde::Serialize;

use super::recoil::RecoilEstimateJson;
use super::renamed::RenamedJson;
use super::source::SourceJson;

/// The result of `plan`.
#[derive(Serialize)]
pub(crate) struct PlanJson<'a> {
    #[serde(flatten)]
    source: SourceJson<'a>,
    parts: Vec<RenamedJson>,
    /// In exact values of one tile at one point.
    cost: f64,
    exact_cost: f64,
    /// What recoil changes, to first order.
    recoil_estimates: Vec<RecoilEstimateJson>,
}

/// Keys of the parts of a plan that differ from the library's.
const NAMES: [(&str, &str); 3] = [("lower", "lower_mm"), ("upper", "upper_mm"), ("distance", "distance_mm")];

impl<'a> PlanJson<'a> {
    pub(crate) fn new(film: &Film<'a>, plan: &Plan, estimates: &[RecoilEstimate]) -> PlanJson<'a> {
        PlanJson {
            source: SourceJson::new(film),
            parts: plan.parts.iter().map(|part| RenamedJson::new(part, &NAMES)).collect(),
            cost: plan.cost(),
            exact_cost: plan.exact_cost,
            recoil_estimates: estimates.iter().map(Into::into).collect(),
        }
    }
}
