//! Rounding: films whose numbers are multiples of a resolution.

use std::cmp::Ordering;

use glam::DVec3;
use magsplice_layout::{direction_from_degrees, ten_decimals as decimal};
use magsplice_magnet::Tile;

use crate::descent::curvature;
use crate::problem::design_problem::DesignProblem;
use crate::problem::least_squares::LeastSquares;
use crate::problem::pattern::{Pattern, VariableKind, VariableTile, angles};
use crate::problem::rules::LinearRule;
use crate::tolerances::{KEPT_MM, ROUNDINGS};

/// The best variables found that are multiples of the resolution near `variables`. They are changed
/// by one multiple at a time, by a linear model of the residuals.
pub(crate) fn rounded(problem: &DesignProblem, pattern: &Pattern, variables: &[f64]) -> Vec<f64> {
    let steps: Vec<Option<f64>> = pattern.kinds.iter().map(|kind| step(problem, *kind)).collect();
    let mut best: Vec<f64> =
        variables.iter().zip(&steps).map(|(&value, step)| step.map_or(value, |s| to_multiple(value, s))).collect();
    if best.is_empty() {
        return best;
    }
    let rules = exact_rules(problem, pattern, &best);
    for _ in 0..ROUNDINGS {
        let Some(mut lattice) = RoundingLattice::new(&problem.least_squares, pattern, &best, &steps, &rules) else {
            return best;
        };
        if !lattice.improve() {
            break;
        }
        let next: Vec<f64> = (0..best.len())
            .map(|i| steps[i].map_or(best[i], |s| to_multiple(best[i] + s * lattice.moved[i], s)))
            .collect();
        // The film itself decides, because the model is only linear.
        let is_better = {
            let loss = |variables: &[f64]| {
                let candidate = problem.least_squares.candidate_at(pattern, variables.to_vec())?;
                Some((broken(&rules, variables), candidate.lack, candidate.loss))
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

/// The merit of the film that rounding makes of `variables`. `None` if it breaks a rule.
pub(crate) fn rounded_merit(problem: &DesignProblem, pattern: &Pattern, variables: &[f64]) -> Option<f64> {
    let rounded = rounded(problem, pattern, variables);
    let keeps_rules = broken_rules(problem, pattern, &rounded).is_empty();
    keeps_rules.then(|| problem.least_squares.candidate_at(pattern, rounded).map(|film| film.merit())).flatten()
}

/// The rules of the brief that a rounded film breaks.
pub(crate) fn broken_rules(problem: &DesignProblem, pattern: &Pattern, rounded: &[f64]) -> Vec<LinearRule> {
    let mut rules = exact_rules(problem, pattern, rounded);
    rules.retain(|rule| rule.value.eval(rounded) < -KEPT_MM);
    rules
}

fn step(problem: &DesignProblem, kind: VariableKind) -> Option<f64> {
    match kind {
        VariableKind::Length => Some(problem.brief.resolution_mm),
        VariableKind::Angle => Some(problem.brief.resolution_deg.to_radians()),
        VariableKind::Strength => {
            problem.least_squares.bounds.strength_t.map(|[_, most]| STRENGTH_STEP * most).filter(|step| *step > 0.0)
        }
    }
}

/// The rules of the brief, without the allowance for rounding.
fn exact_rules(problem: &DesignProblem, pattern: &Pattern, variables: &[f64]) -> Vec<LinearRule> {
    let mut least_squares = problem.least_squares.clone();
    least_squares.bounds.gap.least_mm = problem.brief.gap_mm;
    least_squares.bounds.rounds_centres = false;
    least_squares.rules(pattern, variables).into_iter().filter(|rule| !rule.value.terms.is_empty()).collect()
}

/// Sum of the amounts by which rules are broken.
fn broken(rules: &[LinearRule], variables: &[f64]) -> f64 {
    let sum: f64 = rules.iter().map(|rule| (-rule.value.eval(variables)).max(0.0)).sum();
    if sum <= KEPT_MM { 0.0 } else { sum }
}

/// A variable, and the step by which it is moved.
type Move = (usize, f64);

/// Changes of broken rules, of lacking amplitude and of the loss.
type Change = [f64; 3];

const NONE: Change = [0.0; 3];

/// A lattice of films whose variables differ by whole steps from those of one film, with a linear
/// model of residuals.
struct RoundingLattice<'a> {
    steps: &'a [Option<f64>],
    /// Number of steps by which each variable is moved.
    moved: Vec<f64>,
    /// Derivatives of the loss at the moved variables.
    gradient: Vec<f64>,
    /// Second derivatives of the loss, the upper triangle by rows.
    curvature: Vec<f64>,
    /// Values of the rules at the moved variables.
    rules: Vec<f64>,
    /// For each variable the rules that contain it, with its factor.
    rules_of: Vec<Vec<(usize, f64)>>,
    /// Amplitudes minus their lower bound, with derivatives.
    spare: Vec<(f64, Vec<f64>)>,
}

impl<'a> RoundingLattice<'a> {
    fn new(
        least_squares: &LeastSquares,
        pattern: &Pattern,
        variables: &[f64],
        steps: &'a [Option<f64>],
        rules: &[LinearRule],
    ) -> Option<RoundingLattice<'a>> {
        let residuals = least_squares.residuals(pattern, variables, true)?;
        let n = variables.len();
        let mut gradient = vec![0.0; n];
        residuals.add_gradient(n, &mut gradient);
        let curvature = curvature::dense(&residuals, n, n);
        let mut rules_of = vec![Vec::new(); n];
        for (index, rule) in rules.iter().enumerate() {
            for &(variable, factor) in &rule.value.terms {
                rules_of[variable].push((index, factor));
            }
        }
        let spare = least_squares.least_amplitude.map_or(Vec::new(), |least| {
            residuals.amplitudes.into_iter().map(|(amplitude, derivatives)| (amplitude - least, derivatives)).collect()
        });
        let rules = rules.iter().map(|rule| rule.value.eval(variables)).collect();
        Some(RoundingLattice { steps, moved: vec![0.0; n], gradient, curvature, rules, rules_of, spare })
    }

    /// Makes the best move, or the best pair of moves where no single one helps, until none helps.
    /// Returns whether there was a move.
    fn improve(&mut self) -> bool {
        let helps = |(change, _): &(Change, Vec<Move>)| order(change, &NONE) == Ordering::Less;
        let mut pairs = 0;
        for round in 0..MOST_MOVES_PER_VARIABLE * self.moved.len() {
            let mut best = self.best_move().map(|(change, one)| (change, vec![one])).filter(helps);
            if best.is_none() && pairs < MOST_PAIRS {
                pairs += 1;
                best = self.best_pair().filter(helps);
            }
            let Some((change, moves)) = best else { return round > 0 };
            debug_assert!(change.iter().all(|part| part.is_finite()));
            moves.into_iter().for_each(|one| self.make(one));
        }
        true
    }

    /// Every variable, moved by one step up and down.
    fn moves(&self) -> impl Iterator<Item = Move> + use<'a> {
        let steps = self.steps.iter().enumerate().filter_map(|(i, step)| Some((i, (*step)?)));
        steps.flat_map(|(i, step)| [(i, step), (i, -step)])
    }

    fn best_move(&self) -> Option<(Change, Move)> {
        self.moves().map(|one| (self.change(one), one)).min_by(|a, b| order(&a.0, &b.0))
    }

    /// The best two moves. Coarse steps need them: a tile that grows takes its neighbour's place.
    fn best_pair(&mut self) -> Option<(Change, Vec<Move>)> {
        let mut best: Option<(Change, Vec<Move>)> = None;
        for first @ (variable, by) in self.moves() {
            let of_first = self.change(first);
            self.make(first);
            if let Some((of_second, second)) = self.best_move() {
                let change = std::array::from_fn(|part| of_first[part] + of_second[part]);
                if best.as_ref().is_none_or(|(least, _)| order(&change, least) == Ordering::Less) {
                    best = Some((change, vec![first, second]));
                }
            }
            self.make((variable, -by));
        }
        best
    }

    /// The change that a move causes. The first of its numbers that is not 0 decides.
    fn change(&self, (variable, by): Move) -> Change {
        let lack = |value: f64| (-value).max(0.0);
        let rules = self.rules_of[variable].iter().map(|&(rule, factor)| {
            let broken = |value: f64| if value < -KEPT_MM { -value } else { 0.0 };
            broken(self.rules[rule] + factor * by) - broken(self.rules[rule])
        });
        let before = self.spare.iter().map(|(spare, _)| lack(*spare)).fold(0.0, f64::max);
        let after =
            self.spare.iter().map(|(spare, derivatives)| lack(spare + derivatives[variable] * by)).fold(0.0, f64::max);
        let n = self.moved.len();
        let loss = by * (self.gradient[variable] + 0.5 * by * self.curvature[variable * n + variable]);
        [rules.sum(), after - before, loss]
    }

    fn make(&mut self, (variable, by): Move) {
        let n = self.moved.len();
        self.moved[variable] += by.signum();
        for i in 0..n {
            self.gradient[i] += by * self.curvature[variable.min(i) * n + variable.max(i)];
        }
        for &(rule, factor) in &self.rules_of[variable] {
            self.rules[rule] += factor * by;
        }
        for (spare, derivatives) in &mut self.spare {
            *spare += derivatives[variable] * by;
        }
    }
}

/// Strengths are rounded to multiples of this fraction of the largest allowed strength. It is finer
/// than the spread of real magnets, and a tile that is not needed gets the strength 0.
const STRENGTH_STEP: f64 = 1e-5;

/// Maximum number of moves per variable. More moves would leave the range of the linear model.
const MOST_MOVES_PER_VARIABLE: usize = 20;

/// Largest number of searches for pairs, each of which tries every two moves.
const MOST_PAIRS: usize = 50;

/// Changes of rules and amplitude below this count as zero.
const NO_CHANGE: f64 = 1e-12;

/// Lexicographic order of two changes.
fn order(a: &Change, b: &Change) -> Ordering {
    for (a, b) in a.iter().zip(b).take(2) {
        if (a - b).abs() > NO_CHANGE {
            return a.total_cmp(b);
        }
    }
    a[2].total_cmp(&b[2])
}

pub(crate) fn tile(variable_tile: &VariableTile, variables: &[f64]) -> Option<Tile> {
    let (mut position, mut size) = (DVec3::ZERO, DVec3::ZERO);
    for axis in 0..3 {
        let [lower, upper] = &variable_tile.faces[axis];
        if lower.terms.is_empty() && upper.terms.is_empty() {
            // A constant keeps the digits of the layout.
            (position[axis], size[axis]) =
                (variable_tile.original.position()[axis], variable_tile.original.size()[axis]);
            if variable_tile.faces_moved(axis) {
                (position[axis], size[axis]) =
                    (decimal(0.5 * (lower.constant + upper.constant)), decimal(upper.constant - lower.constant));
            }
        } else {
            let [lower, upper] = [lower, upper].map(|face| face.eval(variables));
            (position[axis], size[axis]) = (decimal(0.5 * (lower + upper)), decimal(upper - lower));
        }
    }
    let free_angle = !variable_tile.direction.terms.is_empty() || !variable_tile.tilt.terms.is_empty();
    let j = if free_angle {
        let in_degrees =
            [&variable_tile.direction, &variable_tile.tilt].map(|angle| decimal(angle.eval(variables).to_degrees()));
        decimal(variable_tile.strength.eval(variables)) * direction_from_degrees(in_degrees)
    } else if variable_tile.strength.terms.is_empty() {
        short_form(variable_tile.polarization_t(variables))
    } else {
        decimal(variable_tile.strength.eval(variables)) * variable_tile.unit
    };
    Tile::new(position, size, j).ok()?.rotated(variable_tile.original.rotation()).ok()
}

/// The polarization that a strength and angles of ten decimals give, if it differs by round-off
/// only: this one is written in the layout. Else the polarization itself.
fn short_form(j: DVec3) -> DVec3 {
    let in_degrees = angles(j).map(|angle| decimal(angle.to_degrees()));
    let short = decimal(j.length()) * direction_from_degrees(in_degrees);
    if short.distance(j) <= ROUND_OFF * j.length() { short } else { j }
}

/// Round-off of a polarization: a few units in the last place.
const ROUND_OFF: f64 = 4.0 * f64::EPSILON;

/// The nearest multiple of `step`.
fn to_multiple(value: f64, step: f64) -> f64 {
    (value / step).round() * step
}

#[cfg(test)]
mod tests;
