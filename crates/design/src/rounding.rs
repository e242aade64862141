//! Films in numbers a workshop can use.

use std::cmp::Ordering;

use glam::DVec3;
use magsplice_field::Tile;

use crate::descent::Problem;
use crate::pattern::{Kind, Pattern, Shape, image, unit_vector};
use crate::rules::Rule;
use crate::setting::Setting;
use crate::tolerances::{KEPT_MM, ROUNDINGS};

/// The variables at multiples of the resolution, near `at`, so that the film is as good as it can be made by changing one of them by one multiple at a time.
pub(crate) fn rounded(setting: &Setting, pattern: &Pattern, at: &[f64]) -> Vec<f64> {
    let steps: Vec<Option<f64>> = pattern.kinds.iter().map(|kind| step(setting, *kind)).collect();
    let mut best: Vec<f64> =
        at.iter().zip(&steps).map(|(&value, step)| step.map_or(value, |s| to_multiple(value, s))).collect();
    if best.is_empty() {
        return best;
    }
    let rules = kept_by(setting, pattern, &best);
    for _ in 0..ROUNDINGS {
        let Some(mut lattice) = Lattice::about(&setting.problem, pattern, &best, &steps, &rules) else { return best };
        if !lattice.improve() {
            break;
        }
        let next: Vec<f64> = (0..best.len())
            .map(|i| steps[i].map_or(best[i], |s| to_multiple(best[i] + s * lattice.moved[i], s)))
            .collect();
        // The model is linear, the film is not.
        let is_better = {
            let loss = |at: &[f64]| {
                setting.problem.found_at(pattern, at.to_vec()).map(|found| (broken(&rules, at), found.lack, found.loss))
            };
            match (loss(&next), loss(&best)) {
                (Some(next), Some(best)) => next.partial_cmp(&best) == Some(Ordering::Less),
                _ => false,
            }
        };
        if !is_better {
            break;
        }
        best = next;
    }
    best
}

fn step(setting: &Setting, kind: Kind) -> Option<f64> {
    match kind {
        Kind::Length => Some(setting.brief.resolution_mm),
        Kind::Angle => Some(setting.brief.resolution_deg.to_radians()),
        Kind::Strength => {
            setting.problem.bounds.strength_t.map(|[_, most]| STRENGTH_STEP * most).filter(|step| *step > 0.0)
        }
    }
}

/// The rules themselves, without the room that was left for rounding.
fn kept_by(setting: &Setting, pattern: &Pattern, at: &[f64]) -> Vec<Rule> {
    let mut problem = setting.problem.clone();
    problem.bounds.gap_mm = setting.brief.gap_mm;
    problem.rules(pattern, at).into_iter().filter(|rule| !rule.value.terms.is_empty()).collect()
}

fn broken(rules: &[Rule], at: &[f64]) -> f64 {
    let sum: f64 = rules.iter().map(|rule| (-rule.value.at(at)).max(0.0)).sum();
    if sum <= KEPT_MM { 0.0 } else { sum }
}

/// Films around one whose variables differ by whole steps, by a linear model of their errors.
struct Lattice<'a> {
    steps: &'a [Option<f64>],
    /// By how many steps each variable was moved.
    moved: Vec<f64>,
    /// Of the sum of squares over two: its derivatives where it was moved to, and its second derivatives.
    gradient: Vec<f64>,
    curvature: Vec<f64>,
    /// Values of the rules, and for each variable the rules it appears in with its factor.
    rules: Vec<f64>,
    rules_of: Vec<Vec<(usize, f64)>>,
    /// What amplitudes are above the least, and their derivatives.
    spare: Vec<(f64, Vec<f64>)>,
}

impl<'a> Lattice<'a> {
    fn about(
        problem: &Problem,
        pattern: &Pattern,
        at: &[f64],
        steps: &'a [Option<f64>],
        rules: &[Rule],
    ) -> Option<Lattice<'a>> {
        let errors = problem.errors(pattern, at, true)?;
        let n = at.len();
        let (mut gradient, mut curvature) = (vec![0.0; n], vec![0.0; n * n]);
        for (value, row) in errors.values.iter().zip(errors.slopes.chunks_exact(n)) {
            for i in 0..n {
                gradient[i] += value * row[i];
                for k in 0..n {
                    curvature[i * n + k] += row[i] * row[k];
                }
            }
        }
        let mut rules_of = vec![Vec::new(); n];
        for (index, rule) in rules.iter().enumerate() {
            for &(variable, factor) in &rule.value.terms {
                rules_of[variable].push((index, factor));
            }
        }
        let spare = problem.least_amplitude.map_or(Vec::new(), |least| {
            errors.amplitudes.into_iter().map(|(amplitude, slopes)| (amplitude - least, slopes)).collect()
        });
        let rules = rules.iter().map(|rule| rule.value.at(at)).collect();
        Some(Lattice { steps, moved: vec![0.0; n], gradient, curvature, rules, rules_of, spare })
    }

    /// Makes the best single move again and again; whether there was any.
    fn improve(&mut self) -> bool {
        let n = self.moved.len();
        for round in 0..MOST_MOVES_PER_VARIABLE * n {
            let moves = (0..n).filter_map(|i| Some((i, self.steps[i]?))).flat_map(|(i, step)| [(i, step), (i, -step)]);
            let best = moves.map(|(i, by)| (self.change(i, by), i, by)).min_by(|a, b| order(&a.0, &b.0));
            let Some((change, variable, by)) = best.filter(|(change, ..)| order(change, &[0.0; 3]) == Ordering::Less)
            else {
                return round > 0;
            };
            debug_assert!(change.iter().all(|part| part.is_finite()));
            self.make(variable, by);
        }
        true
    }

    /// What a move changes: of broken rules, of lacking amplitude, of the errors, the first of these that changes being what counts.
    fn change(&self, variable: usize, by: f64) -> [f64; 3] {
        let lack = |value: f64| (-value).max(0.0);
        let rules = self.rules_of[variable].iter().map(|&(rule, factor)| {
            let broken = |value: f64| if value < -KEPT_MM { -value } else { 0.0 };
            broken(self.rules[rule] + factor * by) - broken(self.rules[rule])
        });
        let before = self.spare.iter().map(|(spare, _)| lack(*spare)).fold(0.0, f64::max);
        let after = self.spare.iter().map(|(spare, slopes)| lack(spare + slopes[variable] * by)).fold(0.0, f64::max);
        let n = self.moved.len();
        let errors = by * (self.gradient[variable] + 0.5 * by * self.curvature[variable * n + variable]);
        [rules.sum(), after - before, errors]
    }

    fn make(&mut self, variable: usize, by: f64) {
        let n = self.moved.len();
        self.moved[variable] += by.signum();
        for i in 0..n {
            self.gradient[i] += by * self.curvature[variable * n + i];
        }
        for &(rule, factor) in &self.rules_of[variable] {
            self.rules[rule] += factor * by;
        }
        for (spare, slopes) in &mut self.spare {
            *spare += slopes[variable] * by;
        }
    }
}

/// Strengths are rounded to multiples of this fraction of the largest allowed: finer than magnets are alike, and a tile that is not needed has none.
const STRENGTH_STEP: f64 = 1e-5;

/// More would be a search of its own.
const MOST_MOVES_PER_VARIABLE: usize = 20;

/// What comes first counts first; changes of rules and amplitude below this are none.
const NO_CHANGE: f64 = 1e-12;

fn order(a: &[f64; 3], b: &[f64; 3]) -> Ordering {
    for (a, b) in a.iter().zip(b).take(2) {
        if (a - b).abs() > NO_CHANGE {
            return a.total_cmp(b);
        }
    }
    a[2].total_cmp(&b[2])
}

/// The tiles at variables that are rounded: numbers are as their decimals say.
pub(crate) fn tiles(pattern: &Pattern, at: &[f64]) -> Option<Vec<Tile>> {
    let mut tiles = vec![None; pattern.tiles];
    for shape in &pattern.shapes {
        let tile = tile(shape, at)?;
        for &(operation, index) in &shape.orbit.images {
            tiles[index] = Some(image(&tile, operation)?);
        }
    }
    tiles.into_iter().collect()
}

fn tile(shape: &Shape, at: &[f64]) -> Option<Tile> {
    let (mut position, mut size) = (DVec3::ZERO, DVec3::ZERO);
    for axis in 0..3 {
        let [lower, upper] = &shape.faces[axis];
        if lower.terms.is_empty() && upper.terms.is_empty() {
            // Not free, so left as it is written.
            (position[axis], size[axis]) = (shape.as_it_was.position()[axis], shape.as_it_was.size()[axis]);
            if shape.faces_moved(axis) {
                (position[axis], size[axis]) =
                    (decimal(0.5 * (lower.constant + upper.constant)), decimal(upper.constant - lower.constant));
            }
        } else {
            let [lower, upper] = [lower, upper].map(|face| face.at(at));
            (position[axis], size[axis]) = (decimal(0.5 * (lower + upper)), decimal(upper - lower));
        }
    }
    let free_angle = !shape.direction.terms.is_empty() || !shape.tilt.terms.is_empty();
    let j = if free_angle {
        let in_degrees = [&shape.direction, &shape.tilt].map(|angle| decimal(angle.at(at).to_degrees()));
        decimal(shape.strength.at(at)) * unit_vector(in_degrees)
    } else if shape.strength.terms.is_empty() {
        shape.polarization_t(at)
    } else {
        decimal(shape.strength.at(at)) * shape.unit
    };
    Tile::new(position, size, j).ok()?.rotated(shape.as_it_was.rotation()).ok()
}

/// The nearest multiple.
fn to_multiple(value: f64, step: f64) -> f64 {
    (value / step).round() * step
}

/// The same number without the noise of its last digits: 0.1 + 0.2 is 0.3.
fn decimal(value: f64) -> f64 {
    format!("{value:.10}").parse::<f64>().unwrap_or(value) + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn multiples_are_decimals() {
        assert_eq!(decimal(to_multiple(0.30000000000000004, 0.1)), 0.3);
        assert_eq!(decimal(to_multiple(-2.3456, 0.001)), -2.346);
        assert_eq!(decimal(to_multiple(-1e-9, 0.001)).to_bits(), 0.0_f64.to_bits());
    }
}
