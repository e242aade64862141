//! Strengths that are at hand: one after the other is fixed, and the rest makes good what that costs.

use std::ops::ControlFlow;

use crate::affine::Affine;
use crate::descent::Found;
use crate::pattern::{Kind, Pattern};
use crate::search::{Progress, Stage, Watch};
use crate::setting::Setting;
use crate::tolerances::MOST_STEPS;

/// Fixes the strength nearest to one at hand, goes down with what is still free, and so on until all are fixed.
pub(crate) fn from_stock(setting: &Setting, mut pattern: Pattern, mut found: Found, watch: Watch) -> (Pattern, Found) {
    let of = pattern.kinds.iter().filter(|kind| **kind == Kind::Strength).count();
    for done in 0..of {
        let nearest = |value: f64| {
            let by_distance = |a: &f64, b: &f64| (a - value).abs().total_cmp(&(b - value).abs());
            setting.brief.stock_strengths_t.iter().copied().min_by(by_distance).unwrap_or(value)
        };
        let strengths = (0..found.at.len()).filter(|&i| pattern.kinds[i] == Kind::Strength);
        let away = |i: usize| (found.at[i] - nearest(found.at[i])).abs();
        let Some(next) = strengths.min_by(|&a, &b| away(a).total_cmp(&away(b))) else { break };
        let value = nearest(found.at[next]);
        pattern = without(&pattern, next, value);
        found.at.remove(next);
        let told = watch(Progress { stage: Stage::Strengths, done, of, best: Some(setting.root_mean_square(&found)) });
        // Broken off, the rest is fixed without making good.
        found = setting.problem.found_at(&pattern, found.at.clone()).unwrap_or(found);
        if told.is_continue()
            && let Some(better) =
                setting.problem.descend(&pattern, found.at.clone(), MOST_STEPS, &mut |_| ControlFlow::Continue(()))
        {
            found = better;
        }
    }
    (pattern, found)
}

/// The pattern with a variable made a constant.
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
    for shape in &mut pattern.shapes {
        shape.faces.iter_mut().flatten().for_each(fixed);
        [&mut shape.direction, &mut shape.tilt, &mut shape.strength].into_iter().for_each(fixed);
    }
    pattern.kinds.remove(variable);
    pattern.start.remove(variable);
    pattern
}
