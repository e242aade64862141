//! What a tolerance makes of a direct and points: which model serves which, what it leaves out, what it costs.

use glam::DVec3;
use magsplice_cuboid::tolerances::CLOSED_FORM_COST;
use magsplice_magnet::{Accuracy, BoundingBox, Grid, Tolerance};

use crate::direct::direct_sum::DirectSum;
use crate::interpolation::fit::Fit;
use crate::interpolation::harmonic_potential::LOOK_UP_COST;
use crate::interpolation::on_grid::{GridFits, GridPart};
use crate::tolerances::{NODE_COST, POINTS_TOGETHER, TREE_TILES};
use crate::tree::interaction_list::InteractionList;
use crate::tree::lazy_tree::LazyTree;
use crate::tree::rounds::interaction_lists;
use crate::within::fitted;

/// Which models serve points to the accuracy of a direct.
///
/// It is what an evaluation of B begins with. Points at which the field turns out too weak for what was left out are then evaluated again, leaving out less.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Which model serves how many points.
    pub parts: Vec<PlannedPart>,
    /// What the exact field of all tiles at all points costs; as [`PlannedPart::cost`].
    pub exact_cost: f64,
}

/// Points that one model serves.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedPart {
    /// What serves them.
    pub model: Model,
    /// How many there are.
    pub points: usize,
    /// About how many exact values of one tile at one point cost as much: multiply-adds counted, not times measured.
    pub cost: f64,
}

/// What a field is computed by.
#[derive(Clone, Debug, PartialEq)]
pub enum Model {
    /// The exact field of all tiles.
    Exact,
    /// A Chebyshev expansion of the field in a box (docs/physics.md, section 5).
    Chebyshev {
        /// The least coordinates of the box.
        lower: DVec3,
        /// The greatest.
        upper: DVec3,
        /// Polynomials along x, y, z.
        terms: [usize; 3],
        /// At most the error of B in tesla.
        error_t: f64,
        /// From the box to the nearest tile.
        distance: f64,
    },
    /// Harmonic potentials of the cells of a box, for points that are no grid.
    Cells {
        /// The least coordinates of the box.
        lower: DVec3,
        /// The greatest.
        upper: DVec3,
        /// Cells along x, y, z.
        cells: [usize; 3],
        /// At most the error of B in tesla.
        error_t: f64,
        /// From the box to the nearest tile.
        distance: f64,
    },
    /// Tiles together by expansions in solid harmonics, near ones exactly (docs/physics.md, section 5.2). Averages are over points.
    Tree {
        /// Expansions for a point, on average.
        expansions: f64,
        /// Their degree, on average.
        degree: f64,
        /// Tiles that expansions stand for, on average.
        expanded_tiles: f64,
        /// Tiles taken exactly where they are too near for an expansion, on average at most.
        exact_tiles: f64,
        /// Tiles not taken at all, on average.
        ignored_tiles: f64,
        /// At most what all that was left out amounts to at any of the points, in tesla.
        truncation_error_t: f64,
        /// Of that, at most what the tiles not taken at all would have added.
        ignored_t: f64,
    },
}

impl Plan {
    /// The sum over parts.
    pub fn cost(&self) -> f64 {
        self.parts.iter().map(|part| part.cost).sum()
    }
}

pub(crate) fn plan_on_grid(direct: &DirectSum, tree: &LazyTree, accuracy: Accuracy, grid: &Grid) -> Plan {
    let exact_cost = exact_cost(direct, grid.len());
    let Accuracy::Within(tolerance) = accuracy else {
        return Plan { parts: vec![exact(direct, grid.len())], exact_cost };
    };
    let fits = GridFits::new(direct, tolerance, grid);
    let mut parts: Vec<PlannedPart> = fits.fitted.iter().map(|(part, fit)| chebyshev(direct, *part, fit)).collect();
    let rest = fits.rest.iter().flat_map(|part| part.indices(grid));
    let points: Vec<DVec3> = rest.map(|index| grid.point(index)).collect();
    parts.extend(parts_of_points(direct, tree, tolerance, &points));
    Plan { parts, exact_cost }
}

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

fn chebyshev(direct: &DirectSum, part: GridPart, fit: &Fit) -> PlannedPart {
    let [x, y, z] = fit.counts.map(|count| count as f64);
    let [nx, ny, nz] = part.counts().map(|count| count as f64);
    // Sums over the terms along x for each plane, along y for each line, along z for each point, of three components.
    let sums = 3.0 * (nx * x * y * z + nx * ny * y * z + nx * ny * nz * z);
    let model = Model::Chebyshev {
        lower: fit.region.lower,
        upper: fit.region.upper,
        terms: fit.counts,
        error_t: fit.error_t,
        distance: distance(direct, &fit.region),
    };
    let samples = fit.counts.iter().product::<usize>();
    PlannedPart { model, points: part.len(), cost: exact_cost(direct, samples) + sums / CLOSED_FORM_COST }
}

fn distance(direct: &DirectSum, region: &BoundingBox) -> f64 {
    direct.boxes().iter().map(|tile| tile.gap(region).length()).fold(f64::INFINITY, f64::min)
}

fn parts_of_points(direct: &DirectSum, tree: &LazyTree, tolerance: Tolerance, points: &[DVec3]) -> Vec<PlannedPart> {
    points.chunks(POINTS_TOGETHER).flat_map(|points| parts_of_some_points(direct, tree, tolerance, points)).collect()
}

fn parts_of_some_points(
    direct: &DirectSum,
    tree: &LazyTree,
    tolerance: Tolerance,
    points: &[DVec3],
) -> Vec<PlannedPart> {
    if let Some(fitted) = fitted(direct, tolerance, points) {
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
    if direct.tiles().len() < TREE_TILES {
        return if points.is_empty() { Vec::new() } else { vec![exact(direct, points.len())] };
    }
    let (by_tree, alone): (Vec<_>, Vec<_>) = interaction_lists(direct, tree.get(direct), tolerance, points)
        .into_iter()
        .partition(|(_, list)| !list.is_exact());
    let mut parts = Vec::new();
    if !by_tree.is_empty() {
        parts.push(tree_part(&by_tree));
    }
    let points = alone.iter().map(|(points, _)| points).sum();
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
    let most = |number: fn(&InteractionList) -> f64| batches.iter().map(|(_, a)| number(a)).fold(0.0, f64::max);
    let expansions = mean(&|a| a.degrees().count() as f64);
    let terms = |a: &InteractionList| a.degrees().map(|p| NODE_COST * ((p + 2) * (p + 3)) as f64).sum::<f64>();
    let model = Model::Tree {
        expansions,
        degree: mean(&|a| a.degrees().sum::<usize>() as f64) / expansions.max(f64::MIN_POSITIVE),
        expanded_tiles: mean(&|a| a.tiles[0] as f64),
        exact_tiles: mean(&|a| a.tiles[1] as f64),
        ignored_tiles: mean(&|a| a.tiles[2] as f64),
        truncation_error_t: most(|a| a.truncation_error_t),
        ignored_t: most(|a| a.ignored_t),
    };
    PlannedPart { model, points, cost: total(&|a| a.tiles[1] as f64 + terms(a) / CLOSED_FORM_COST) }
}
