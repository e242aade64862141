//! `plan`: the methods, their truncation errors and costs.

use magsplice::Film;
use magsplice::field::{Model, Plan, PlannedPart};
use serde::Serialize;

use super::source::SourceJson;

/// The result of `plan`.
#[derive(Serialize)]
pub(crate) struct PlanJson<'a> {
    #[serde(flatten)]
    source: SourceJson<'a>,
    parts: Vec<PlannedPartJson>,
    /// In exact values of one tile at one point.
    cost: f64,
    exact_cost: f64,
}

impl<'a> PlanJson<'a> {
    pub(crate) fn new(film: &Film<'a>, plan: &Plan) -> PlanJson<'a> {
        PlanJson {
            source: SourceJson::new(film),
            parts: plan.parts.iter().map(PlannedPartJson::from).collect(),
            cost: plan.cost(),
            exact_cost: plan.exact_cost,
        }
    }
}

#[derive(Serialize)]
struct PlannedPartJson {
    points: usize,
    #[serde(flatten)]
    model: ModelJson,
    cost: f64,
}

/// [`Model`] with units in its keys.
#[derive(Serialize)]
#[serde(tag = "model", rename_all = "snake_case")]
enum ModelJson {
    Exact,
    Chebyshev {
        lower_mm: [f64; 3],
        upper_mm: [f64; 3],
        terms: [usize; 3],
        error_t: f64,
        distance_mm: f64,
    },
    Cells {
        lower_mm: [f64; 3],
        upper_mm: [f64; 3],
        cells: [usize; 3],
        error_t: f64,
        distance_mm: f64,
    },
    Tree {
        expansions: f64,
        degree: f64,
        expanded_tiles: f64,
        exact_tiles: f64,
        ignored_tiles: f64,
        left_out_t: f64,
        ignored_t: f64,
    },
}

impl From<&PlannedPart> for PlannedPartJson {
    fn from(part: &PlannedPart) -> PlannedPartJson {
        let model = match part.model {
            Model::Exact => ModelJson::Exact,
            Model::Chebyshev { lower, upper, terms, error_t, distance } => ModelJson::Chebyshev {
                lower_mm: lower.to_array(),
                upper_mm: upper.to_array(),
                terms,
                error_t,
                distance_mm: distance,
            },
            Model::Cells { lower, upper, cells, error_t, distance } => ModelJson::Cells {
                lower_mm: lower.to_array(),
                upper_mm: upper.to_array(),
                cells,
                error_t,
                distance_mm: distance,
            },
            Model::Tree {
                expansions,
                degree,
                expanded_tiles,
                exact_tiles,
                ignored_tiles,
                truncation_error_t,
                ignored_t,
            } => ModelJson::Tree {
                expansions,
                degree,
                expanded_tiles,
                exact_tiles,
                ignored_tiles,
                left_out_t: truncation_error_t,
                ignored_t,
            },
        };
        PlannedPartJson { points: part.points, model, cost: part.cost }
    }
}
