//! Strengths in stock: the strengths of a film are replaced by strengths in stock, one after the
//! other.

use crate::problem::affine::Affine;
use crate::problem::design_problem::DesignProblem;
use crate::problem::least_squares::Candidate;
use crate::problem::pattern::{Pattern, VariableKind};
use crate::progress::{ProgressUpdate, SearchStage, Watch};
use crate::tolerances::MOST_STEPS;

/// Fixes the strength that is nearest to one in stock, descends in the variables that are left, and
/// repeats that until all strengths are fixed.
pub(crate) fn fix_to_stock(
    problem: &DesignProblem,
    mut pattern: Pattern,
    mut candidate: Candidate,
    watch: &Watch,
) -> (Pattern, Candidate) {
    let of = pattern.kinds.iter().filter(|kind| **kind == VariableKind::Strength).count();
    for done in 0..of {
        let nearest = |value: f64| {
            let by_distance = |a: &f64, b: &f64| (a - value).abs().total_cmp(&(b - value).abs());
            problem.brief.stock_strengths_t.iter().copied().min_by(by_distance).unwrap_or(value)
        };
        let strengths = (0..candidate.variables.len()).filter(|&i| pattern.kinds[i] == VariableKind::Strength);
        let away = |i: usize| (candidate.variables[i] - nearest(candidate.variables[i])).abs();
        let Some(next) = strengths.min_by(|&a, &b| away(a).total_cmp(&away(b))) else { break };
        let value = nearest(candidate.variables[next]);
        pattern = without(&pattern, next, value);
        candidate.variables.remove(next);
        let best = Some(candidate.root_mean_square());
        let update = ProgressUpdate { stage: SearchStage::Strengths, done, of, best };
        let flow = watch.show(update);
        let variables = candidate.variables.clone();
        candidate = problem.least_squares.candidate_at(&pattern, variables).unwrap_or(candidate);
        // After a stop the remaining strengths are fixed without further descents.
        if flow.is_continue() {
            let (start, still) = (candidate.variables.clone(), &mut |_: &_| watch.show(update));
            let better = problem.least_squares.descend(&pattern, start, MOST_STEPS, still);
            candidate = better.unwrap_or(candidate);
        }
    }
    (pattern, candidate)
}

/// The pattern with one variable replaced by a constant.
fn without(pattern: &Pattern, variable: usize, value: f64) -> Pattern {
    let fixed = |number: &mut Affine| {
        let mut constant = number.constant;
        let mut terms = Vec::new();
        for &(index, factor) in &number.terms {
            match index.cmp(&variable) {
                std::cmp::Ordering::Less => terms.push((index, factor)),
                std::cmp::Ordering::Equal => constant += factor * value,
                std::cmp::Ordering::Greater => terms.push((index - 1, factor)),
            }
        }
        *number = Affine { constant, terms };
    };
    let mut pattern = pattern.clone();
    for variable_tile in &mut pattern.tiles {
        variable_tile.faces.iter_mut().flatten().for_each(fixed);
        [&mut variable_tile.direction, &mut variable_tile.tilt, &mut variable_tile.strength]
            .into_iter()
            .for_each(fixed);
    }
    pattern.kinds.remove(variable);
    pattern.start.remove(variable);
    pattern
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Terms of the variable become a part of the constant. Later variables have the next lower
    /// number.
    #[test]
    fn variables_are_replaced_by_constants() {
        let text = "format = 1\nname = \"film\"\n[ideal]\nwavelength_mm = 10.0\nthickness_mm = 1.0\namplitude_t = 0.12\n\
                    [volume]\nx_mm = [-2.0, 2.0]\ny_mm = [-2.0, 2.0]\nz_mm = [-5.0, -3.0]\nstep_mm = 2.0\n\
                    [design]\nvary = [\"size\", \"direction\", \"strength\"]\nstrength_t = { min = 0.0, max = 0.2 }\n\
                    [[tile]]\nposition_mm = [-2, 0, 0.5]\nsize_mm = [3, 2, 1]\npolarization_t = [-0.1, 0.05, 0]\n\
                    [[tile]]\nposition_mm = [2, 0, 0.5]\nsize_mm = [3, 2, 1]\npolarization_t = [0.1, 0.06, 0]\n";
        let layout = magsplice_layout::Layout::parse(text, "film").unwrap_or_else(|e| panic!("{e}"));
        let pattern = DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}")).pattern;
        let n = pattern.start.len();
        assert_eq!(n, 8);
        // Directions without a free angle are those of the layout.
        let kinds = pattern.kinds.iter().enumerate().filter(|(_, kind)| **kind != VariableKind::Angle);
        for (variable, kind) in kinds {
            let value = pattern.start[variable] + 0.01;
            let fixed = without(&pattern, variable, value);
            let mut changed = pattern.start.clone();
            changed[variable] = value;
            assert_eq!(fixed.all_tiles(&fixed.start), pattern.all_tiles(&changed), "{kind:?}");
            // Each other variable still has its effect.
            for other in (0..n).filter(|other| *other != variable) {
                let mut left = fixed.start.clone();
                let at = other - usize::from(other > variable);
                assert_eq!(fixed.kinds[at], pattern.kinds[other]);
                left[at] += 0.02;
                let mut all = changed.clone();
                all[other] += 0.02;
                assert_eq!(fixed.all_tiles(&left), pattern.all_tiles(&all), "{kind:?}, {other}");
            }
        }
    }
}
