//! Tolerances on grids and at points: every value keeps its tolerance or is reported.

use glam::DVec3;
use magsplice_field::{Accuracy, Grid, Model, PointErrors, Quantity, Scene, Tile, Tolerance};
use rayon::prelude::*;

use super::reference::{Reference, exact_error_t, rotation_error_t};
use super::scenes::Attack;
use super::{scene_numbers, timed};

/// Smallest share of scenes with an interpolation. With fewer the tests would cover only exact
/// fields.
const LEAST_FITTED_SHARE: f64 = 0.3;

/// Observations in scenes.
#[derive(Clone, Debug, Default)]
struct Findings {
    scenes: usize,
    /// Scenes that use interpolation on the grid, interpolation for a list, and a tree.
    fitted: usize,
    cells: usize,
    tree: usize,
    points: usize,
    refused: usize,
    /// Points compared with the oracle.
    checked: usize,
    /// Largest ratio of an error by the oracle to the allowed error.
    worst: f64,
    /// Largest ratio of an error to the bound of the plan.
    worst_planned: f64,
    violations: Vec<String>,
}

impl Findings {
    fn merged(mut self, other: Findings) -> Findings {
        self.scenes += other.scenes;
        self.fitted += other.fitted;
        self.cells += other.cells;
        self.tree += other.tree;
        self.points += other.points;
        self.refused += other.refused;
        self.checked += other.checked;
        self.worst = self.worst.max(other.worst);
        self.worst_planned = self.worst_planned.max(other.worst_planned);
        self.violations.extend(other.violations);
        self
    }

    /// Adds the values of one evaluation.
    fn compare(
        &mut self,
        attack: &Attack,
        reference: &mut Reference,
        model: &str,
        exact: &[DVec3],
        (found, result): (Vec<DVec3>, Result<(), PointErrors>),
    ) {
        let points: Vec<DVec3> = attack.grid.points().collect();
        let mut is_named = vec![false; points.len()];
        for error in result.err().map_or(vec![], |errors| errors.0) {
            is_named[error.index] = true;
        }
        self.points += points.len();
        self.refused += is_named.iter().filter(|named| **named).count();
        let (mut worst, mut worst_ratio) = (None, 0.0);
        for (index, (&found, &exact)) in found.iter().zip(exact).enumerate() {
            let point = points[index];
            if is_named[index] == found.is_finite() {
                self.violations.push(format!("{model}: {found} at {point}, reported: {}", is_named[index]));
            }
            if is_named[index] {
                continue;
            }
            let (error_t, allowed_t) = ((found - exact).length(), attack.allowed_t(exact.length()));
            if error_t > allowed_t && error_t > allowed_t + 2.0 * exact_error_t(&attack.tiles, point) {
                self.violations.push(format!("{model}: {} times the tolerance at {point}", error_t / allowed_t));
            }
            if error_t / allowed_t > worst_ratio {
                (worst, worst_ratio) = (Some(index), error_t / allowed_t);
            }
        }
        let aimed = attack.aimed.iter().filter_map(|aimed| points.iter().position(|point| point == aimed));
        for index in aimed.take(2).chain(worst).filter(|index| !is_named[*index]) {
            let (point, found) = (points[index], found[index]);
            let exact = reference.flux_density_t(&attack.tiles, point);
            // The sum over tiles rounds each component of the reference.
            let rounding_t = rotation_error_t(&attack.tiles, point) + f64::EPSILON * exact.length();
            let (error_t, allowed_t) = ((found - exact).length(), attack.allowed_t(exact.length()));
            self.checked += 1;
            if error_t > allowed_t + rounding_t {
                self.violations.push(format!("{model}: {} times the tolerance at {point}", error_t / allowed_t));
            }
            self.worst = self.worst.max((error_t - rounding_t) / allowed_t);
        }
    }

    /// Compares the values on a grid with the error bounds of the plan.
    fn compare_with_plan(&mut self, attack: &Attack, models: &[Model], found: &[DVec3], exact: &[DVec3]) {
        for model in models {
            let Model::Chebyshev { lower, upper, error_t: stated_t, .. } = model else { continue };
            for ((point, found), exact) in attack.grid.points().zip(found).zip(exact) {
                let is_inside = lower.cmple(point).all() && point.cmple(*upper).all();
                let error_t = (*found - *exact).length();
                // A refused point is NaN, which exceeds no bound.
                if is_inside && error_t > *stated_t && error_t > stated_t + exact_error_t(&attack.tiles, point) {
                    self.violations.push(format!("plan: {} times the error bound at {point}", error_t / stated_t));
                }
                if is_inside {
                    self.worst_planned = self.worst_planned.max(error_t / stated_t);
                }
            }
        }
    }
}

fn findings(number: u64) -> Findings {
    let attack = Attack::new(number);
    let mut reference = Reference::new();
    let scene = Scene::new(&attack.tiles);
    let within = scene.clone().with_accuracy(Accuracy::Within(attack.tolerance));
    let points: Vec<DVec3> = attack.grid.points().collect();
    let mut findings = Findings { scenes: 1, ..Findings::default() };
    let Ok(exact) = scene.field_at(Quantity::FluxDensity, &points) else {
        findings.violations.push("no exact field at some points".to_owned());
        return findings;
    };
    let models = |plan: magsplice_field::Plan| plan.parts.into_iter().map(|part| part.model).collect::<Vec<_>>();
    let on_grid = models(within.plan_on_grid(&attack.grid));
    let at_points = models(within.plan_at_points(&points));
    findings.fitted = usize::from(on_grid.iter().any(|model| matches!(model, Model::Chebyshev { .. })));
    findings.cells = usize::from(at_points.iter().any(|model| matches!(model, Model::Cells { .. })));
    findings.tree = usize::from(at_points.iter().any(|model| matches!(model, Model::Tree { .. })));
    let mut found = vec![DVec3::ZERO; points.len()];
    let result = within.field_on_grid_into(Quantity::FluxDensity, &attack.grid, &mut found);
    findings.compare_with_plan(&attack, &on_grid, &found, &exact);
    findings.compare(&attack, &mut reference, "grid", &exact, (found.clone(), result));
    let result = within.field_into(Quantity::FluxDensity, &points, &mut found);
    findings.compare(&attack, &mut reference, "points", &exact, (found, result));
    let named = findings.violations.iter().map(|violation| format!("scene {number}, {violation}")).collect();
    findings.violations = named;
    findings
}

#[test]
fn adversarial_scenes_keep_their_tolerance_on_grids_and_at_points() {
    let all = scene_numbers(40).into_par_iter().map(timed(findings)).reduce(Findings::default, Findings::merged);
    println!("{:#?}", Findings { violations: vec![], ..all.clone() });
    assert!(
        all.violations.is_empty(),
        "{} violations: {:#?}",
        all.violations.len(),
        &all.violations[..all.violations.len().min(20)]
    );
    assert!(all.fitted as f64 > LEAST_FITTED_SHARE * all.scenes as f64, "{} of {} scenes", all.fitted, all.scenes);
}

/// The published film: 56 tiles with a pattern along x and y.
fn published_film() -> Vec<Tile> {
    let widths = [0.85, 3.3, 1.7, 3.3, 1.7, 3.3, 1.7, 3.3, 0.85];
    let pattern = [0.0, 1.0, 0.0, -1.0, 0.0, 1.0, 0.0, -1.0, 0.0];
    let middle = |n: usize| widths[..n].iter().sum::<f64>() + 0.5 * widths[n] - 10.0;
    let cells = (0..81).map(|n| (n / 9, n % 9)).filter(|&(i, j)| pattern[i] != 0.0 || pattern[j] != 0.0);
    let tile = |(i, j): (usize, usize)| {
        let j_t = 0.12 * DVec3::new(pattern[i], pattern[j], 0.0).normalize();
        Tile::new(DVec3::new(middle(i), middle(j), 0.5), DVec3::new(widths[i], widths[j], 1.0), j_t)
    };
    cells.map(|cell| tile(cell).expect("a valid tile")).collect()
}

#[test]
fn speck_beside_the_working_volume_keeps_the_tolerance() {
    let mut tiles = published_film();
    let speck = Tile::new(DVec3::new(-1.11, -0.204, -5.29), DVec3::splat(0.1), DVec3::new(0.002, -0.005, 0.01));
    tiles.push(speck.expect("a valid tile"));
    let grid = Grid::new(DVec3::new(-2.0, -2.0, -5.0), DVec3::new(2.0, 2.0, -3.0), [41, 41, 21]).expect("a grid");
    let exact = Scene::new(&tiles).field_on_grid(Quantity::FluxDensity, &grid).expect("off all edges");
    for fraction in [1e-2, 1e-4, 1e-6] {
        let tolerance = Tolerance::relative(fraction).expect("a tolerance");
        let within = Scene::new(&tiles).with_accuracy(Accuracy::Within(tolerance));
        let found = within.field_on_grid(Quantity::FluxDensity, &grid).expect("the tolerance can be kept");
        let worst = found.iter().zip(&exact).map(|(a, b)| (*a - *b).length() / b.length()).fold(0.0, f64::max);
        assert!(worst <= fraction, "{worst:e} instead of {fraction:e}");
    }
}
