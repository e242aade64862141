//! Rounded films: multiples of the resolution, the linear model of the lattice, and its moves.

use std::ops::ControlFlow;

use magsplice_layout::Layout;

use super::*;

/// Two tiles that nearly touch, with these demands.
fn layout(design: &str) -> Layout {
    let text = format!(
        "format = 1\nname = \"film\"\n[ideal]\nwavelength_mm = 10.0\nthickness_mm = 1.0\namplitude_t = 0.12\n\
         [volume]\nx_mm = [-2.0, 2.0]\ny_mm = [-2.0, 2.0]\nz_mm = [-5.0, -3.0]\nstep_mm = 2.0\n\
         [design]\noutline_mm = {{ x = [-4.0, 4.0], y = [-4.0, 4.0] }}\n{design}\n\
         [[tile]]\nposition_mm = [-1.7, 0.3, 0.5]\nsize_mm = [3.0, 2.0, 1.0]\npolarization_t = [-0.1, 0.05, 0.0]\n\
         [[tile]]\nposition_mm = [1.7, 0.1, 0.5]\nsize_mm = [3.1, 2.5, 1.0]\npolarization_t = [0.1, 0.06, 0.0]\n"
    );
    Layout::parse(&text, "film").unwrap_or_else(|e| panic!("{e}"))
}

const ALL: &str = "vary = [\"size\", \"position\", \"direction\", \"strength\"]\nsmallest_cut_mm = 1.9\n\
                   strength_t = { min = 0.0, max = 0.2 }";

#[test]
fn multiples_become_short_decimals_without_negative_zero() {
    assert_eq!(decimal(to_multiple(0.30000000000000004, 0.1)), 0.3);
    assert_eq!(decimal(to_multiple(-2.3456, 0.001)), -2.346);
    assert_eq!(decimal(to_multiple(-1e-9, 0.001)).to_bits(), 0.0_f64.to_bits());
}

/// Each change is the change of the model: of the rules at the moved variables, of the largest lack
/// of amplitude, and of the quadratic form of the loss. Steps are so coarse that rules break.
#[test]
fn changes_of_moves_are_those_of_the_model() {
    let layout = layout(&format!("{ALL}\namplitude = {{ min = 0.3 }}"));
    let problem = DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}"));
    let (pattern, least_squares) = (&problem.pattern, &problem.least_squares);
    let (start, n) = (&pattern.start, pattern.start.len());
    let rules = exact_rules(&problem, pattern, start);
    // The last variable has no step.
    let mut steps: Vec<Option<f64>> = (0..n).map(|i| Some(0.1 + 0.01 * i as f64)).collect();
    steps[n - 1] = None;
    let mut lattice = RoundingLattice::new(least_squares, pattern, start, &steps, &rules).expect("a field");
    let moves: Vec<Move> = lattice.moves().collect();
    assert_eq!(moves.len(), 2 * (n - 1));
    assert!(
        (0..n - 1).all(|i| moves.contains(&(i, 0.1 + 0.01 * i as f64)) && moves.contains(&(i, -0.1 - 0.01 * i as f64)))
    );

    let residuals = least_squares.residuals(pattern, start, true).expect("a field");
    let mut gradient = vec![0.0; n];
    residuals.add_gradient(n, &mut gradient);
    let least = least_squares.least_amplitude.expect("a bound");
    // Rules, lack and loss of variables that differ by `by` from the start.
    let state = |by: &[f64]| -> Change {
        let variables: Vec<f64> = start.iter().zip(by).map(|(value, by)| value + by).collect();
        let broken: f64 =
            rules.iter().map(|rule| rule.value.eval(&variables)).filter(|v| *v < -KEPT_MM).map(|v| -v).sum();
        let product = |row: &[f64]| -> f64 { row.iter().zip(by).map(|(a, b)| a * b).sum() };
        let lacks = residuals.amplitudes.iter().map(|(amplitude, row)| (least - amplitude - product(row)).max(0.0));
        let loss = product(&gradient)
            + 0.5 * residuals.derivatives.chunks_exact(n).map(|row| product(row).powi(2)).sum::<f64>();
        [broken, lacks.fold(0.0, f64::max), loss]
    };
    let mut by = vec![0.0; n];
    let mut seen = [false; 3];
    for number in 0..60 {
        for &(variable, step) in &moves {
            let mut next = by.clone();
            next[variable] += step;
            let (before, after) = (state(&by), state(&next));
            let found = lattice.change((variable, step));
            for part in 0..3 {
                let known = after[part] - before[part];
                let size = 1e-9 * (1e-3 + after[part].abs() + before[part].abs());
                assert!((found[part] - known).abs() < size, "{number}, part {part}: {found:?}, not {known}");
                seen[part] |= known.abs() > 1e-3;
            }
        }
        let one = moves[(7 * number + number * number) % moves.len()];
        lattice.make(one);
        by[one.0] += one.1;
        let moved = lattice.moved.iter().zip(&steps).map(|(moved, step)| moved * step.unwrap_or(0.0));
        assert!(moved.zip(&by).all(|(moved, by)| (moved - by).abs() < 1e-12));
    }
    assert_eq!(seen, [true; 3]);
}

/// The best move and the best pair are the best of all, tried one by one. Trying leaves the lattice
/// as it was.
#[test]
fn best_moves_are_the_best_of_all() {
    let layout = layout(&format!("{ALL}\namplitude = {{ min = 0.3 }}"));
    let problem = DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}"));
    let pattern = &problem.pattern;
    let rules = exact_rules(&problem, pattern, &pattern.start);
    let steps: Vec<Option<f64>> = (0..pattern.start.len()).map(|i| Some(0.05 + 0.01 * i as f64)).collect();
    let lattice =
        || RoundingLattice::new(&problem.least_squares, pattern, &pattern.start, &steps, &rules).expect("a field");
    let plain = lattice();
    let best = plain.moves().map(|one| plain.change(one)).min_by(order).expect("moves");
    assert_eq!(plain.best_move().expect("moves").0, best);
    let mut least = NONE;
    for first in plain.moves() {
        for second in plain.moves() {
            let mut moved = lattice();
            let of_first = moved.change(first);
            moved.make(first);
            let of_second = moved.change(second);
            let change = std::array::from_fn(|part| of_first[part] + of_second[part]);
            if order(&change, &least) == Ordering::Less {
                least = change;
            }
        }
    }
    let mut tried = lattice();
    let (change, moves) = tried.best_pair().expect("pairs");
    assert!(order(&change, &NONE) == Ordering::Less && moves.len() == 2);
    // Moves back leave round-off.
    assert!((0..3).all(|part| (change[part] - least[part]).abs() < 1e-12), "{change:?}, not {least:?}");
    assert_eq!(tried.moved, plain.moved);
    let largest = |of: &[f64]| of.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let left: Vec<f64> = tried.gradient.iter().zip(&plain.gradient).map(|(a, b)| a - b).collect();
    assert!(largest(&left) < 1e-12 * largest(&plain.gradient));
    assert!(tried.rules.iter().zip(&plain.rules).all(|(a, b)| (a - b).abs() < 1e-12));
}

/// Improved lattices have no helping move or pair left, and report whether they moved.
#[test]
fn improvement_ends_where_no_move_helps() {
    let layout = layout(&format!("{ALL}\namplitude = {{ min = 0.3 }}"));
    let problem = DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}"));
    let pattern = &problem.pattern;
    let rules = exact_rules(&problem, pattern, &pattern.start);
    let steps: Vec<Option<f64>> = vec![Some(0.02); pattern.start.len()];
    let mut lattice =
        RoundingLattice::new(&problem.least_squares, pattern, &pattern.start, &steps, &rules).expect("a field");
    assert!(lattice.improve());
    assert!(lattice.moved.iter().any(|steps| *steps != 0.0));
    let is_help = |change: &Change| order(change, &NONE) == Ordering::Less;
    assert!(!is_help(&lattice.best_move().expect("moves").0));
    assert!(!is_help(&lattice.best_pair().expect("pairs").0));
    let moved = lattice.moved.clone();
    assert!(!lattice.improve());
    assert_eq!(lattice.moved, moved);
}

#[test]
fn rules_come_before_amplitude_and_loss() {
    let less = |a: Change, b: Change| order(&a, &b) == Ordering::Less && order(&b, &a) == Ordering::Greater;
    assert!(less([1.0, 9.0, 9.0], [2.0, 0.0, 0.0]));
    assert!(less([1.0, 1.0, 9.0], [1.0, 2.0, 0.0]));
    assert!(less([1.0, 1.0, 1.0], [1.0, 1.0, 2.0]));
    // Round-off of rules and of the amplitude is no difference; round-off of the loss is one.
    assert!(less([2e-13, 0.0, 1.0], [1e-13, 0.0, 2.0]) && less([0.0, 2e-13, 1.0], [0.0, 1e-13, 2.0]));
    assert!(less([1e-12 / 3.0, 0.0, 1e-13], [0.0, 0.0, 2e-13]) && less([0.0; 3], [3e-12, 0.0, -1.0]));
    assert_eq!(order(&[1.0; 3], &[1.0; 3]), Ordering::Equal);
}

/// Lengths and angles have the resolution of the brief, strengths a fraction of the largest one.
#[test]
fn steps_have_the_resolution_of_the_brief() {
    let layout = layout(&format!("{ALL}\nresolution_mm = 0.02\nresolution_deg = 0.5"));
    let problem = DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}"));
    let of = |kind| step(&problem, kind).expect("a step");
    let found = [VariableKind::Length, VariableKind::Angle, VariableKind::Strength].map(of);
    assert_eq!(found, [0.02, 0.5_f64.to_radians(), 1e-5 * 0.2]);
    let fixed = self::layout("vary = [\"size\"]");
    let fixed = DesignProblem::new(&fixed).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(step(&fixed, VariableKind::Strength), None);
}

/// Rules count by the amounts by which they are broken. Amounts below the accuracy of the solver
/// are none.
#[test]
fn broken_rules_are_summed() {
    let layout = layout(ALL);
    let problem = DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}"));
    let (pattern, start) = (&problem.pattern, &problem.pattern.start);
    let rules = exact_rules(&problem, pattern, start);
    assert_eq!(broken(&rules, start), 0.0);
    assert!(broken_rules(&problem, pattern, start).is_empty());
    let shifted = |by: f64| -> Vec<LinearRule> {
        let mut rules = rules.clone();
        for rule in &mut rules {
            rule.value.constant = -by - (rule.value.eval(start) - rule.value.constant);
        }
        rules
    };
    let each = 0.25 * KEPT_MM / rules.len() as f64;
    assert_eq!(broken(&shifted(each), start), 0.0);
    assert!((broken(&shifted(0.5), start) - 0.5 * rules.len() as f64).abs() < 1e-9);
    // The tiles are 0.35 mm apart along x; a gap of 0.5 mm is the only rule that breaks.
    let gap = self::layout(&format!("{ALL}\ngap_mm = 0.5"));
    let gap = DesignProblem::new(&gap).unwrap_or_else(|e| panic!("{e}"));
    let found = broken_rules(&gap, &gap.pattern, &gap.pattern.start);
    assert!(found.len() == 1 && found[0].tiles == (0, Some(1)), "{found:?}");
    assert!((found[0].value.eval(&gap.pattern.start) + 0.15).abs() < 1e-12, "{found:?}");
    assert_eq!(rounded_merit(&gap, &gap.pattern, &gap.pattern.start).is_some(), {
        let rounded = rounded(&gap, &gap.pattern, &gap.pattern.start);
        broken_rules(&gap, &gap.pattern, &rounded).is_empty()
    });
}

/// A rounded film near the best one is better than the film whose numbers are the nearest
/// multiples.
#[test]
fn rounded_films_are_multiples_and_better_than_the_nearest_ones() {
    let layout = layout(&format!("{ALL}\nresolution_mm = 0.1\nresolution_deg = 5.0"));
    let problem = DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}"));
    let (pattern, least_squares) = (&problem.pattern, &problem.least_squares);
    let steps: Vec<f64> = pattern.kinds.iter().map(|kind| step(&problem, *kind).expect("a step")).collect();
    let start = least_squares.descend(pattern, pattern.start.clone(), 40, &mut |_| ControlFlow::Continue(()));
    let start = start.expect("a field").variables;
    let plain: Vec<f64> = start.iter().zip(&steps).map(|(value, step)| to_multiple(*value, *step)).collect();
    let found = rounded(&problem, pattern, &start);
    assert!(found.iter().zip(&steps).all(|(value, step)| (value - to_multiple(*value, *step)).abs() < 1e-12));
    let loss = |variables: &[f64]| least_squares.candidate_at(pattern, variables.to_vec()).expect("a field").loss;
    assert!(broken_rules(&problem, pattern, &found).is_empty());
    assert!(loss(&found) < 0.9 * loss(&plain), "{} and {}", loss(&found), loss(&plain));
    let merit = rounded_merit(&problem, pattern, &start).expect("no rule is broken");
    assert!((merit - loss(&found)).abs() < 1e-15, "{merit}");
}

/// Numbers of free tiles have ten decimals. Constants keep the digits of the layout.
#[test]
fn rounded_tiles_have_ten_decimals() {
    let tile_of = |vary: &str, by: f64| {
        let layout = layout(&format!("vary = [\"{vary}\"]\nstrength_t = {{ min = 0.0, max = 0.2 }}"));
        let problem = DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}"));
        let variables: Vec<f64> = problem.pattern.start.iter().map(|value| value + by).collect();
        (tile(&problem.pattern.tiles[0], &variables).expect("sides above 0"), layout.tiles[0].tile)
    };
    let third = 1.0 / 3.0;
    let (moved, original) = tile_of("position", third);
    assert_eq!(moved.position(), DVec3::new(-1.366_666_666_7, 0.633_333_333_3, 0.5));
    assert_eq!(moved.size(), original.size());
    assert!(moved.polarization_t().distance(original.polarization_t()) < 4.0 * f64::EPSILON * 0.12, "{moved:?}");
    let (grown, original) = tile_of("size", third);
    assert_eq!(grown.size(), DVec3::new(3.333_333_333_3, 2.333_333_333_3, 1.0));
    assert_eq!(grown.position(), original.position());
    let (turned, original) = tile_of("direction", third);
    let degrees = decimal((original.polarization_t().y.atan2(original.polarization_t().x) + third).to_degrees());
    let j_t = decimal(original.polarization_t().length()) * direction_from_degrees([degrees, 0.0]);
    assert!(turned.polarization_t().distance(j_t) < 1e-16, "{turned:?}");
    let (stronger, original) = tile_of("strength", 0.01 * third);
    let strength = decimal(original.polarization_t().length() + 0.01 * third);
    assert!(stronger.polarization_t().distance(strength * original.polarization_t().normalize()) < 1e-16);
}

/// A polarization that strength and angles of ten decimals give is written so; others keep their
/// digits.
#[test]
fn polarizations_are_written_short_where_nothing_changes() {
    let short = 0.12 * direction_from_degrees([30.0, 0.0]);
    let noisy = short * (1.0 + f64::EPSILON);
    assert_eq!(short_form(noisy), short);
    let long = DVec3::new(0.1, 0.05, 0.0);
    assert_eq!(short_form(long), long);
}
