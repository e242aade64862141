//! Boxes prepared for repeated look-ups: fields and gradients keep their error bounds.

use glam::{DMat3, DVec3};
use magsplice_field::{FittedField, Grid, Quantity, Scene};
use rayon::prelude::*;

use super::reference::{Reference, exact_error_t, rotation_error_t};
use super::scenes::Attack;
use super::{scene_numbers, timed};

/// Smallest share of scenes with a fitted box.
const LEAST_FITTED_SHARE: f64 = 0.3;

/// Number of boxes tried in a scene, each half as long as the box before.
const BOXES: usize = 4;

/// Number of look-ups along each axis.
const COUNT: usize = 13;

/// Number of look-ups per comparison of the gradient.
const GRADIENT_STEP: usize = 37;

/// Observations in scenes.
#[derive(Clone, Debug, Default)]
struct Findings {
    scenes: usize,
    fitted: usize,
    points: usize,
    refused: usize,
    /// Points compared with the oracle.
    checked: usize,
    /// Largest ratio of errors to error bounds, of the field by the oracle and of the gradient.
    worst: f64,
    worst_gradient: f64,
    violations: Vec<String>,
}

impl Findings {
    fn merged(mut self, other: Findings) -> Findings {
        self.scenes += other.scenes;
        self.fitted += other.fitted;
        self.points += other.points;
        self.refused += other.refused;
        self.checked += other.checked;
        self.worst = self.worst.max(other.worst);
        self.worst_gradient = self.worst_gradient.max(other.worst_gradient);
        self.violations.extend(other.violations);
        self
    }

    fn compare(&mut self, attack: &Attack, scene: &Scene, box_: &FittedField, points: &[DVec3]) {
        let exact = scene.field_at(Quantity::FluxDensity, points).expect("off all edges");
        let mut looked_up = vec![DVec3::ZERO; points.len()];
        let errors = box_.flux_density_into(points, &mut looked_up).err().map_or(vec![], |errors| errors.0);
        let mut is_named = vec![false; points.len()];
        for error in errors {
            is_named[error.index] = true;
        }
        self.points += points.len();
        self.refused += is_named.iter().filter(|named| **named).count();
        let mut to_check: Vec<usize> = (0..attack.aimed.len().min(2)).collect();
        let (mut worst, mut worst_t) = (None, 0.0);
        for (index, &point) in points.iter().enumerate() {
            let found = box_.flux_density(point).expect("inside");
            let error_t = (found - exact[index]).length();
            if is_above(error_t, box_.error_t())
                && is_above(error_t, box_.error_t() + exact_error_t(&attack.tiles, point))
            {
                self.violations.push(format!("{} times the error bound at {point}", error_t / box_.error_t()));
            }
            if error_t > worst_t {
                (worst, worst_t) = (Some(index), error_t);
            }
            if is_named[index] == looked_up[index].is_finite() {
                self.violations.push(format!("{} at {point}, reported: {}", looked_up[index], is_named[index]));
            }
            let (off_t, allowed_t) =
                ((looked_up[index] - exact[index]).length(), attack.allowed_t(exact[index].length()));
            if off_t > allowed_t && off_t > allowed_t + exact_error_t(&attack.tiles, point) {
                self.violations.push(format!("{} times the tolerance at {point}", off_t / allowed_t));
            }
        }
        to_check.extend(worst);
        let mut reference = Reference::new();
        for index in to_check {
            let exact = reference.flux_density_t(&attack.tiles, points[index]);
            let found = box_.flux_density(points[index]).expect("inside");
            let rounding_t = rotation_error_t(&attack.tiles, points[index]) + f64::EPSILON * exact.length();
            let error_t = (found - exact).length() - rounding_t;
            self.checked += 1;
            if is_above(error_t, box_.error_t()) {
                self.violations.push(format!("{} times the error bound by the oracle", error_t / box_.error_t()));
            }
            self.worst = self.worst.max(error_t / box_.error_t());
        }
        for &point in points.iter().step_by(GRADIENT_STEP) {
            let exact = scene.gradient(Quantity::FluxDensity, point).expect("off all edges");
            let found = box_.flux_density_gradient(point).expect("inside");
            let off_t = largest(found - exact);
            if is_above(off_t, box_.gradient_error_t()) {
                self.violations.push(format!("{} times the gradient's error", off_t / box_.gradient_error_t()));
            }
            self.worst_gradient = self.worst_gradient.max(off_t / box_.gradient_error_t());
        }
    }
}

/// Whether an error exceeds its bound or is NaN.
fn is_above(error: f64, stated: f64) -> bool {
    error > stated || error.is_nan()
}

/// The largest magnitude of an element, or NaN if any is NaN.
fn largest(gradient: DMat3) -> f64 {
    if gradient.is_nan() { f64::NAN } else { gradient.to_cols_array().into_iter().map(f64::abs).fold(0.0, f64::max) }
}

/// The targeted points in a box, and a grid in it.
fn points(attack: &Attack, lower: DVec3, upper: DVec3) -> Vec<DVec3> {
    let grid = Grid::new(lower, upper, [COUNT; 3]).expect("a grid");
    let is_inside = |point: &DVec3| lower.cmple(*point).all() && point.cmple(upper).all();
    attack.aimed.iter().copied().filter(is_inside).chain(grid.points()).collect()
}

fn findings(number: u64) -> Findings {
    let attack = Attack::new(number);
    let scene = Scene::new(&attack.tiles);
    let mut findings = Findings { scenes: 1, ..Findings::default() };
    let Some(&target) = attack.aimed.first() else { return findings };
    let (mut lower, mut upper) = (attack.grid.lower(), attack.grid.upper());
    for _ in 0..BOXES {
        if let Ok(found) = scene.fitted_field(lower, upper, attack.tolerance) {
            findings.fitted = 1;
            findings.compare(&attack, &scene, &found, &points(&attack, lower, upper));
            break;
        }
        // Half of the box around the same speck.
        (lower, upper) = (0.5 * (lower + target), 0.5 * (upper + target));
    }
    let named = findings.violations.iter().map(|violation| format!("scene {number}, {violation}")).collect();
    findings.violations = named;
    findings
}

#[test]
fn fitted_fields_of_adversarial_scenes_keep_their_bounds() {
    let all = scene_numbers(20).into_par_iter().map(timed(findings)).reduce(Findings::default, Findings::merged);
    println!("{:#?}", Findings { violations: vec![], ..all.clone() });
    assert!(
        all.violations.is_empty(),
        "{} violations: {:#?}",
        all.violations.len(),
        &all.violations[..all.violations.len().min(20)]
    );
    assert!(all.fitted as f64 > LEAST_FITTED_SHARE * all.scenes as f64, "{} of {} scenes", all.fitted, all.scenes);
}
