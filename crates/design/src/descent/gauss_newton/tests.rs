//! Steps of a descent: their quadratic model, the nearest film that keeps the rules, and the end.

use magsplice_layout::Layout;

use super::*;
use crate::problem::design_problem::DesignProblem;

/// Two tiles 0.35 mm apart, with these demands.
fn layout(design: &str) -> Layout {
    let text = format!(
        "format = 1\nname = \"film\"\n[ideal]\nwavelength_mm = 10.0\nthickness_mm = 1.0\namplitude_t = 0.12\n\
         [volume]\nx_mm = [-2.0, 2.0]\ny_mm = [-2.0, 2.0]\nz_mm = [-5.0, -3.0]\nstep_mm = 2.0\n\
         [design]\noutline_mm = {{ x = [-4.0, 4.0], y = [-4.0, 4.0] }}\nsmallest_cut_mm = 1.9\n{design}\n\
         [[tile]]\nposition_mm = [-1.7, 0.3, 0.5]\nsize_mm = [3.0, 2.0, 1.0]\npolarization_t = [-0.1, 0.05, 0.0]\n\
         [[tile]]\nposition_mm = [1.7, 0.1, 0.5]\nsize_mm = [3.1, 2.5, 1.0]\npolarization_t = [0.1, 0.06, 0.0]\n"
    );
    Layout::parse(&text, "film").unwrap_or_else(|e| panic!("{e}"))
}

fn problem(layout: &Layout) -> DesignProblem<'_> {
    DesignProblem::new(layout).unwrap_or_else(|e| panic!("{e}"))
}

const ALL: &str = "vary = [\"size\", \"position\", \"direction\", \"strength\"]\nstrength_t = { min = 0.0, max = 0.2 }\n\
                   amplitude = { min = 0.3 }";

/// A step that is as long as the program allows has the gradient and the second derivatives of the
/// residuals, damping, limits of its length, the rules, and the price of the lacking amplitude.
#[test]
fn model_of_a_step_is_the_linearized_film() {
    let layout = layout(ALL);
    let problem = problem(&layout);
    let (pattern, squares) = (&problem.pattern, &problem.least_squares);
    let (start, n) = (&pattern.start, pattern.start.len());
    let residuals = squares.residuals(pattern, start, true).expect("a field");
    let rules = squares.rules(pattern, start);
    let mut steps = squares.steps(pattern);
    steps[1] = f64::INFINITY;
    let (damping, price) = (0.25, 7.0);
    let program = squares.model(&residuals, &rules, start, &steps, damping, price);
    let all = n + 1;
    let column = |i: usize| residuals.derivatives.iter().skip(i).step_by(n).copied().collect::<Vec<f64>>();
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    for (i, gradient) in program.gradient[..n].iter().enumerate() {
        assert!((gradient - product(&column(i), &residuals.values)).abs() < 1e-12, "{i}");
    }
    assert_eq!((program.gradient.len(), program.gradient[n]), (all, price));
    let Curvature::Dense(dense) = &program.curvature else { panic!("few variables") };
    let units: Vec<f64> = steps.iter().map(|step| if step.is_finite() { *step } else { 1.0 }).collect();
    let own: Vec<f64> = (0..n).map(|i| product(&column(i), &column(i))).collect();
    let damped = curvature::damped(&own, &units, damping);
    for (i, k) in (0..n).flat_map(|i| (i..n).map(move |k| (i, k))) {
        let known = product(&column(i), &column(k)) + if i == k { damped[i] } else { 0.0 };
        assert!((dense[i * all + k] - known).abs() < 1e-12 * (1.0 + known.abs()), "{i}, {k}");
    }
    assert!((0..=n).all(|i| dense[i * all + n] == 0.0));
    let mut known: Vec<(Vec<(usize, f64)>, f64)> =
        rules.iter().map(|rule| (rule.value.terms.clone(), -rule.value.eval(start))).collect();
    for i in (0..n).filter(|i| *i != 1) {
        known.extend([1.0, -1.0].map(|sign| (vec![(i, sign)], -steps[i])));
    }
    let least = squares.least_amplitude.expect("a bound");
    for (amplitude, derivatives) in &residuals.amplitudes {
        let terms = derivatives.iter().copied().enumerate().chain([(n, 1.0)]);
        known.push((terms.collect(), least - amplitude));
    }
    known.push((vec![(n, 1.0)], 0.0));
    assert_eq!(program.rules, known);
}

/// From 150 variables on, few rows stand for the curvature of all residuals of a symmetric film.
#[test]
fn factored_model_has_the_curvature_of_the_dense_one() {
    let text = std::fs::read_to_string("../../layouts/published-film.toml").expect("a shipped layout");
    let mut layout = Layout::parse(&text, "film").unwrap_or_else(|e| panic!("{e}"));
    let brief = layout.brief.as_mut().expect("a design");
    brief.symmetry = magsplice_layout::Symmetry::None;
    brief.least_amplitude = Some(0.5);
    let problem = problem(&layout);
    let (pattern, squares) = (&problem.pattern, &problem.least_squares);
    let n = pattern.start.len();
    assert!(n >= FACTORED_FROM, "{n}");
    let residuals = squares.residuals(pattern, &pattern.start, true).expect("a field");
    let steps = squares.steps(pattern);
    let program = squares.model(&residuals, &[], &pattern.start, &steps, 0.5, 1.0);
    let Curvature::Factored { diagonal, rows } = &program.curvature else { panic!("many variables") };
    let all = n + 1;
    assert!(diagonal.len() == all && diagonal[n] == 0.0 && rows.chunks_exact(all).all(|row| row[n] == 0.0));
    assert!(rows.len() / all < n);
    let own: Vec<f64> =
        (0..n).map(|i| residuals.derivatives.iter().skip(i).step_by(n).map(|value| value * value).sum()).collect();
    let damped = curvature::damped(&own, &steps, 0.5);
    // Changes of all variables, each by a part of its step.
    for number in 1..4 {
        let change: Vec<f64> = (0..n).map(|i| steps[i] * ((number * (i + 1)) as f64).sin()).collect();
        let square = |row: &[f64]| row.iter().zip(&change).map(|(a, b)| a * b).sum::<f64>().powi(2);
        let damping: f64 = damped.iter().zip(&change).map(|(damping, change)| damping * change * change).sum();
        let known = residuals.derivatives.chunks_exact(n).map(square).sum::<f64>() + damping;
        let found = rows.chunks_exact(all).map(|row| square(&row[..n])).sum::<f64>()
            + diagonal.iter().zip(&change).map(|(own, change)| own * change * change).sum::<f64>();
        assert!((found / known - 1.0).abs() < 1e-9, "{found}, not {known}");
    }
}

/// One row stands for all rows of a symmetric film that are multiples of it.
#[test]
fn distinct_rows_have_the_squares_of_all() {
    let layout = Layout::read("../../layouts/published-film.toml").unwrap_or_else(|e| panic!("{e}"));
    let problem = problem(&layout);
    let (pattern, squares) = (&problem.pattern, &problem.least_squares);
    let n = pattern.start.len();
    let residuals = squares.residuals(pattern, &pattern.start, true).expect("a field");
    let few = squares.distinct_rows(&residuals, n);
    assert!(few.len() * 3 < residuals.derivatives.len(), "{}", few.len());
    let product = |rows: &[f64], i: usize, k: usize| rows.chunks_exact(n).map(|row| row[i] * row[k]).sum::<f64>();
    for (i, k) in (0..n).flat_map(|i| (0..=i).map(move |k| (i, k))) {
        let known = product(&residuals.derivatives, i, k);
        let size = (product(&few, i, i) * product(&few, k, k)).sqrt();
        assert!((product(&few, i, k) - known).abs() < 1e-9 * size, "{i}, {k}");
    }
}

/// A film that keeps the rules is its own nearest one. Tiles that are too near move apart, each by
/// half of what is missing.
#[test]
fn nearest_film_keeps_the_rules() {
    let of = |design: &str| layout(&format!("vary = [\"position\"]\nresolution_mm = 0.001\n{design}"));
    let kept = of("");
    let kept = problem(&kept);
    assert_eq!(kept.least_squares.nearest(&kept.pattern, &kept.pattern.start), Ok(kept.pattern.start.clone()));
    let wide = of("gap_mm = 0.75");
    let wide = problem(&wide);
    let nearest = wide.least_squares.nearest(&wide.pattern, &wide.pattern.start).expect("a film");
    let moves: Vec<f64> = nearest.iter().zip(&wide.pattern.start).map(|(to, from)| to - from).collect();
    // Centres 3.8 mm apart instead of 3.4 mm, x first. The gap is kept after rounding too.
    for (found, known) in moves.iter().zip([-0.2, 0.0, 0.2, 0.0]) {
        assert!((found - known).abs() < 1e-3, "{moves:?}");
    }
    // Half a side from the end of the outline: no film.
    let none = of("gap_mm = 2.0");
    let none = problem(&none);
    let rules = none.least_squares.nearest(&none.pattern, &none.pattern.start).expect_err("no room");
    assert!(rules.len() == 1 && rules[0].tiles == (0, Some(1)), "{rules:?}");
    // Sides that cannot change break a rule, whatever the positions are.
    let short = of("").brief.map(|brief| magsplice_layout::Brief { smallest_cut_mm: Some(2.2), ..brief });
    let layout = of("");
    let short = DesignProblem::from_brief(&layout, short.expect("a design")).unwrap_or_else(|e| panic!("{e}"));
    let rules = short.least_squares.nearest(&short.pattern, &short.pattern.start).expect_err("a short side");
    assert!(rules.len() == 1 && rules[0].tiles == (0, None), "{rules:?}");
    assert!((rules[0].value.constant + 0.2).abs() < 1e-12, "{rules:?}");
}

#[test]
fn only_strengths_for_the_field_are_linear() {
    for (vary, goal, is_linear) in [
        ("\"strength\"", "field", true),
        ("\"strength\"", "displacement", false),
        ("\"strength\", \"direction\"", "field", false),
        ("\"direction\"", "field", false),
    ] {
        let layout = layout(&format!("vary = [{vary}]\ngoal = \"{goal}\"\nstrength_t = {{ min = 0.0, max = 0.2 }}"));
        let problem = problem(&layout);
        assert_eq!(problem.least_squares.is_linear(&problem.pattern), is_linear, "{vary} {goal}");
    }
}

/// Residuals of the displacement are lengths: a ten-millionth of the wavelength over 2 pi.
#[test]
fn films_without_error_and_lack_are_done() {
    for (goal, unit) in [("displacement", 10.0 / std::f64::consts::TAU), ("uniformity", 1.0), ("field", 1.0)] {
        let layout = layout(&format!("{ALL}\ngoal = \"{goal}\""));
        let problem = problem(&layout);
        let of = |rms: f64, lack: f64| {
            problem.least_squares.is_done(&Candidate { variables: Vec::new(), loss: 0.5 * rms * rms, lack })
        };
        assert!(of(0.99e-7 * unit, 0.0) && !of(1.01e-7 * unit, 0.0) && !of(0.0, 1e-9), "{goal}");
    }
}

/// Every step lowers the merit. A descent ends after its steps, when it is told to, or where eight
/// steps gain less than a thousandth.
#[test]
fn descents_end() {
    let layout = layout(ALL);
    let problem = problem(&layout);
    let (pattern, squares) = (&problem.pattern, &problem.least_squares);
    let descended = |most_steps: usize, most_calls: usize| {
        let mut merits = Vec::new();
        let mut observe = |candidate: &Candidate| {
            merits.push(candidate.merit());
            if merits.len() < most_calls { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        };
        let found = squares.descend(pattern, pattern.start.clone(), most_steps, &mut observe).expect("a field");
        assert!(squares.nearest(pattern, &found.variables).is_ok_and(|nearest| nearest == found.variables));
        (found, merits)
    };
    let (whole, merits) = descended(1000, usize::MAX);
    let mut steps = merits.clone();
    steps.dedup();
    assert!(steps.windows(2).all(|pair| pair[1] < pair[0]), "{merits:?}");
    assert_eq!(steps.last(), Some(&whole.merit()));
    let before = steps[steps.len() - 1 - PATIENCE];
    assert!(steps.len() > PATIENCE && whole.merit() > (1.0 - LEAST_GAIN) * before, "{steps:?}");
    let earlier = steps.windows(PATIENCE + 1).rev().nth(1).expect("more steps");
    assert!(earlier[PATIENCE] <= (1.0 - LEAST_GAIN) * earlier[0], "{steps:?}");
    let (third, few) = descended(3, usize::MAX);
    assert!(few.iter().all(|merit| steps[..3].contains(merit)) && third.merit() == steps[2], "{few:?}");
    let (first, one) = descended(1000, 1);
    assert_eq!((one.as_slice(), first.merit()), (&steps[..1], steps[0]));
    let none = descended(0, usize::MAX);
    assert_eq!((none.0.variables, none.1.len()), (pattern.start.clone(), 0));
}
