//! Plans: the models that a tolerance uses for points, with their errors and costs.

use glam::DVec3;
use magsplice_cuboid::tolerances::CLOSED_FORM_COST;
use magsplice_magnet::{Accuracy, BoundingBox, Grid, Tolerance, is_in_range};

use crate::interpolation::fit::ChebyshevFit;
use crate::interpolation::harmonic_potential::LOOK_UP_COST;
use crate::interpolation::on_grid::{GridFits, GridPart};
use crate::tolerances::MAX_SORTED_POINTS;
use crate::tree::interaction_list::InteractionList;
use crate::tree::lazy_tree::LazyTree;
use crate::tree::rounds::{TilesAndTree, interaction_lists};
use crate::within::{fitted, tree_pays};
use magsplice_direct::direct_sum::DirectSum;

/// The models that a [`Scene`](crate::Scene) uses for points, at its [`Accuracy`].
///
/// An evaluation of B begins with this plan. Points with a field too weak for the truncation error
/// are then evaluated again with a smaller truncation error.
/// [`Scene::plan_on_grid`](crate::Scene::plan_on_grid) and
/// [`Scene::plan_at_points`](crate::Scene::plan_at_points) return plans.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use magsplice_field::{Model, Scene, Tile};
///
/// let cube = Tile::new(DVec3::ZERO, DVec3::ONE, DVec3::X)?;
/// let plan = Scene::new(&[cube]).plan_at_points(&[DVec3::new(0.0, 0.0, 2.0)]);
/// assert_eq!(plan.parts[0].model, Model::Exact);
/// assert_eq!(plan.cost(), plan.exact_cost);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Plan {
    /// The parts, each with a model for some of the points.
    pub parts: Vec<PlannedPart>,
    /// Cost of direct summation of all tiles at all points, in the unit of [`PlannedPart::cost`].
    pub exact_cost: f64,
}

/// Points evaluated by one model.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct PlannedPart {
    /// Number of points.
    pub points: usize,
    /// The model.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub model: Model,
    /// Cost in exact fields of one tile at one point, from counted multiply-adds instead of
    /// measured times.
    pub cost: f64,
}

/// The method of computing a field. Serialized, lengths are in millimetres, as in all files.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(tag = "model", rename_all = "snake_case"))]
pub enum Model {
    /// Direct summation of all tiles.
    Exact,
    /// Chebyshev interpolation of the field in a box (docs/physics.md, section 5.1).
    Chebyshev {
        /// Lower corner of the box.
        #[cfg_attr(feature = "serde", serde(rename = "lower_mm"))]
        lower: DVec3,
        /// Upper corner of the box.
        #[cfg_attr(feature = "serde", serde(rename = "upper_mm"))]
        upper: DVec3,
        /// Numbers of polynomials along x, y, z.
        terms: [usize; 3],
        /// Upper bound of the error of B, in tesla.
        error_t: f64,
        /// Distance from the box to the nearest tile.
        #[cfg_attr(feature = "serde", serde(rename = "distance_mm"))]
        distance: f64,
    },
    /// Harmonic potentials of the cells of a box, for points in a list (docs/physics.md, section
    /// 5.1).
    Cells {
        /// Lower corner of the box.
        #[cfg_attr(feature = "serde", serde(rename = "lower_mm"))]
        lower: DVec3,
        /// Upper corner of the box.
        #[cfg_attr(feature = "serde", serde(rename = "upper_mm"))]
        upper: DVec3,
        /// Numbers of cells along x, y, z.
        cells: [usize; 3],
        /// Upper bound of the error of B, in tesla.
        error_t: f64,
        /// Distance from the box to the nearest tile.
        #[cfg_attr(feature = "serde", serde(rename = "distance_mm"))]
        distance: f64,
    },
    /// A tree of expansions in solid harmonics, with direct summation of near tiles
    /// (docs/physics.md, section 5.2). Means are over points.
    Tree {
        /// Mean number of expansions at a point.
        expansions: f64,
        /// Mean degree of the expansions.
        degree: f64,
        /// Mean number of tiles in expansions.
        expanded_tiles: f64,
        /// Upper bound of the mean number of tiles summed directly, because they are too near for
        /// an expansion.
        exact_tiles: f64,
        /// Mean number of ignored tiles.
        ignored_tiles: f64,
        /// Upper bound of the truncation error at any of the points, in tesla.
        truncation_error_t: f64,
        /// The contribution of ignored tiles to it, in tesla.
        ignored_t: f64,
    },
}

impl Plan {
    /// Cost of all parts, in the unit of [`PlannedPart::cost`].
    pub fn cost(&self) -> f64 {
        self.parts.iter().map(|part| part.cost).sum()
    }
}

/// The plan for B at the points of a grid.
pub(crate) fn plan_on_grid(direct: &DirectSum, tree: &LazyTree, accuracy: Accuracy, grid: &Grid) -> Plan {
    let exact_cost = exact_cost(direct, grid.len());
    let Accuracy::Within(tolerance) = accuracy else {
        return Plan { parts: vec![exact(direct, grid.len())], exact_cost };
    };
    let fits = GridFits::new(direct, tolerance, grid, &|_| {});
    let mut parts: Vec<PlannedPart> = fits.fitted.iter().map(|(part, fit)| chebyshev(direct, *part, fit)).collect();
    let rest = fits.rest.iter().flat_map(|part| part.indices(grid));
    let points: Vec<DVec3> = rest.map(|index| grid.point(index)).collect();
    parts.extend(parts_of_points(direct, tree, tolerance, &points));
    Plan { parts, exact_cost }
}

/// The plan for B at points.
pub(crate) fn plan_at_points(direct: &DirectSum, tree: &LazyTree, accuracy: Accuracy, points: &[DVec3]) -> Plan {
    let parts = match accuracy {
        Accuracy::Exact => vec![exact(direct, points.len())],
        Accuracy::Within(tolerance) => parts_of_points(direct, tree, tolerance, points),
    };
    Plan { parts, exact_cost: exact_cost(direct, points.len()) }
}

fn exact_cost(direct: &DirectSum, points: usize) -> f64 {
    (direct.tiles().len() * points) as f64
}

fn exact(direct: &DirectSum, points: usize) -> PlannedPart {
    PlannedPart { model: Model::Exact, points, cost: exact_cost(direct, points) }
}

fn chebyshev(direct: &DirectSum, part: GridPart, fit: &ChebyshevFit) -> PlannedPart {
    let model = Model::Chebyshev {
        lower: fit.region.lower,
        upper: fit.region.upper,
        terms: fit.counts,
        error_t: fit.error_t,
        distance: distance(direct, &fit.region),
    };
    let sums = part.cost_of_sums(fit.counts.map(|count| count as f64));
    let cost = exact_cost(direct, fit.exact_values) + sums;
    PlannedPart { model, points: part.len(), cost }
}

/// Distance from a box to the nearest tile.
fn distance(direct: &DirectSum, region: &BoundingBox) -> f64 {
    direct.boxes().iter().map(|tile| tile.gap(region).length()).fold(f64::INFINITY, f64::min)
}

fn parts_of_points(direct: &DirectSum, tree: &LazyTree, tolerance: Tolerance, points: &[DVec3]) -> Vec<PlannedPart> {
    points.chunks(MAX_SORTED_POINTS).flat_map(|points| parts_of_chunk(direct, tree, tolerance, points)).collect()
}

fn parts_of_chunk(direct: &DirectSum, tree: &LazyTree, tolerance: Tolerance, points: &[DVec3]) -> Vec<PlannedPart> {
    let time = direct.cost(points.len(), |number| points[number]);
    if let Some(fitted) = fitted(direct, time, tolerance, points) {
        let region = BoundingBox::from_points(points);
        let model = Model::Cells {
            lower: region.lower,
            upper: region.upper,
            cells: fitted.cells(),
            error_t: fitted.error_t(),
            distance: distance(direct, &region),
        };
        let per_point = LOOK_UP_COST as f64 / CLOSED_FORM_COST;
        let cost = exact_cost(direct, fitted.exact_values()) + per_point * points.len() as f64;
        return vec![PlannedPart { model, points: points.len(), cost }];
    }
    let usable: Vec<u32> = (0..points.len() as u32).filter(|&index| is_in_range(points[index as usize])).collect();
    if !tree_pays(direct, tree, time, tolerance, points, &usable) {
        return if points.is_empty() { Vec::new() } else { vec![exact(direct, points.len())] };
    }
    let (by_tree, by_direct_sum): (Vec<_>, Vec<_>) =
        interaction_lists(TilesAndTree { direct, tree: tree.get(direct), exact_cost: time }, tolerance, points, usable)
            .into_iter()
            .partition(|(_, list)| list.pays(time));
    let mut parts = Vec::new();
    if !by_tree.is_empty() {
        parts.push(tree_part(&by_tree));
    }
    let points = by_direct_sum.iter().map(|(points, _)| points).sum();
    if points > 0 {
        parts.push(exact(direct, points));
    }
    parts
}

fn tree_part(batches: &[(usize, InteractionList)]) -> PlannedPart {
    let points: usize = batches.iter().map(|(points, _)| points).sum();
    let total = |number: &dyn Fn(&InteractionList) -> f64| -> f64 {
        batches.iter().map(|(points, list)| *points as f64 * number(list)).sum()
    };
    let mean = |number: &dyn Fn(&InteractionList) -> f64| total(number) / points as f64;
    let max = |number: fn(&InteractionList) -> f64| batches.iter().map(|(_, list)| number(list)).fold(0.0, f64::max);
    let expansions = mean(&|list| list.degrees().count() as f64);
    let model = Model::Tree {
        expansions,
        degree: mean(&|list| list.degrees().sum::<usize>() as f64) / expansions.max(f64::MIN_POSITIVE),
        expanded_tiles: mean(&|list| list.tiles.expanded as f64),
        exact_tiles: mean(&|list| list.tiles.direct as f64),
        ignored_tiles: mean(&|list| list.tiles.ignored as f64),
        truncation_error_t: max(|list| list.truncation_error_t),
        ignored_t: max(|list| list.ignored_t),
    };
    PlannedPart { model, points, cost: total(&InteractionList::cost) }
}
