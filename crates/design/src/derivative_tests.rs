//! Tests of the sampling and the objective: derivatives, weights of a finer grid, symmetry.

use magsplice_layout::{Goal, Layout};

use crate::problem::design_problem::DesignProblem;
use crate::search::metrics::Metrics;

/// Central differences in every variable, for every goal, with all numbers free at once.
///
/// With steps of 1e-5 of a millimetre, a radian or a tesla times the strength, the differences are
/// off by the third derivative times 1e-10 and by round-off over 1e-5. Both are below 1e-7 of the
/// largest derivative of a variable.
#[test]
fn derivatives_agree_with_central_differences() {
    let text = |design: &str, tiles: &str| {
        format!(
            "format = 1\nname = \"film\"\n[ideal]\nwavelength_mm = 10.0\nthickness_mm = 1.0\namplitude_t = 0.12\n[volume]\nx_mm = [-1.5, 2.0]\ny_mm = [-1.0, 1.0]\n\
             z_mm = [-5.0, -3.0]\nstep_mm = 1.0\n[design]\n{design}\nthickness_mm = {{ min = 0.5, max = 2.0 }}\nstrength_t = {{ min = 0.0, max = 1.0 }}\n{tiles}"
        )
    };
    let mirrored = "[[tile]]\nposition_mm = [2.5, 2.3, 0.5]\nsize_mm = [3.0, 2.0, 1.0]\npolarization_t = [0.12, 0.05, 0.01]\nmirror = { axes = [\"x\", \"y\"] }\n\
                    [[tile]]\nposition_mm = [6.0, 0.0, 0.6]\nsize_mm = [2.0, 1.0, 1.2]\npolarization_t = [-0.1, 0.0, 0.02]\nmirror = { axes = [\"x\"] }\n";
    let alone = "[[tile]]\nposition_mm = [1.5, 0.3, 0.5]\nsize_mm = [3.0, 2.0, 1.0]\npolarization_t = [0.12, 0.05, 0.01]\n\
                 [[tile]]\nposition_mm = [-2.0, -0.4, 0.5]\nsize_mm = [2.0, 2.5, 1.0]\npolarization_t = [-0.1, 0.03, 0.0]\n";
    let all = "\"thickness\", \"direction\", \"tilt\", \"strength\"]";
    for (vary, symmetry, tiles) in [
        (format!("vary = [\"size\", \"position\", {all}"), "mirror", mirrored),
        (format!("vary = [\"cut\", {all}"), "mirror", mirrored),
        (format!("vary = [\"size\", {all}"), "none", alone),
        (format!("vary = [\"position\", {all}"), "none", alone),
    ] {
        for goal in [Goal::Uniformity, Goal::Displacement, Goal::Field] {
            let text = text(
                &format!("{vary}\nsymmetry = \"{symmetry}\"\nweights = {{ r_x = 1.0, r_y = 2.0, s_z = 0.5 }}"),
                tiles,
            );
            let layout = Layout::parse(&text, "test").unwrap_or_else(|e| panic!("{e}"));
            let mut brief = layout.brief.clone().unwrap();
            brief.goal = goal;
            let problem = DesignProblem::from_brief(&layout, brief).unwrap();
            assert!(problem.variable_count() >= 8, "{}", problem.variable_count());
            let (pattern, sampling) = (&problem.pattern, &problem.least_squares.sampling);
            let residuals = |variables: &[f64], with_derivatives: bool| {
                problem
                    .least_squares
                    .objective
                    .residuals(sampling, &sampling.field(pattern, variables, with_derivatives).unwrap())
                    .unwrap()
            };
            let start = &pattern.start;
            let (here, n) = (residuals(start, true), start.len());
            for variable in 0..n {
                let h = 1e-5;
                let moved = |by: f64| {
                    let mut variables = start.clone();
                    variables[variable] += by;
                    residuals(&variables, false)
                };
                let [above, below] = [h, -h].map(moved);
                let derivatives: Vec<f64> = here.derivatives.iter().skip(variable).step_by(n).copied().collect();
                let largest = derivatives.iter().fold(0.0_f64, |most, derivative| most.max(derivative.abs()));
                assert!(largest > 0.0, "variable {variable} of {vary} changes nothing");
                for (row, derivative) in derivatives.iter().enumerate() {
                    let difference = (above.values[row] - below.values[row]) / (2.0 * h);
                    assert!(
                        (difference - derivative).abs() <= 1e-6 * largest,
                        "{goal:?}, variable {variable} of {vary}, row {row}: {difference} is not {derivative}"
                    );
                }
                for (index, (_, derivatives)) in here.amplitudes.iter().enumerate() {
                    let difference = (above.amplitudes[index].0 - below.amplitudes[index].0) / (2.0 * h);
                    assert!((difference - derivatives[variable]).abs() <= 1e-7 * derivatives[variable].abs().max(1e-2));
                }
            }
        }
    }
}

#[test]
fn weighted_amplitude_is_that_of_the_finer_grid() {
    let layout = Layout::read("../../layouts/published-film.toml").unwrap_or_else(|e| panic!("{e}"));
    let problem = DesignProblem::new(&layout).unwrap();
    let field = problem.least_squares.sampling.field(&problem.pattern, &problem.pattern.start, false).unwrap();
    let residuals = problem.least_squares.objective.residuals(&problem.least_squares.sampling, &field).unwrap();
    let exact = Metrics::from_tiles(
        &layout.bare_tiles(),
        &problem.finer_grid(),
        layout.volume.unwrap().reference_mm,
        &layout.ideal.unwrap(),
    );
    let exact = exact.unwrap().figures.amplitude;
    // The coarse grid and the finer one differ by 7e-3.
    assert!((residuals.amplitudes[1].0 - exact).abs() < 2e-5, "{} is not {exact}", residuals.amplitudes[1].0);
    assert!((residuals.amplitudes[0].0 - exact).abs() > 1e-4, "the grids differ");
}

#[test]
fn field_at_images_of_points_is_the_image_of_the_field() {
    let layout = Layout::read("../../layouts/published-film.toml").unwrap_or_else(|e| panic!("{e}"));
    let problem = DesignProblem::new(&layout).unwrap();
    let sampling = &problem.least_squares.sampling;
    assert_eq!(sampling.grid.len(), 405);
    // 15 points in an eighth of each of 5 planes, and the reference.
    assert_eq!(sampling.computed().len(), 15 * 5 + 1);
    let field = sampling.field(&problem.pattern, &problem.pattern.start, false).unwrap();
    let scene = magsplice_field::Scene::new(&layout.bare_tiles());
    for (point, &(index, operation)) in sampling.grid.points().zip(sampling.images()) {
        let exact = scene.field(magsplice_magnet::Quantity::FluxDensity, point).unwrap();
        assert!((operation.apply(field.flux_density_t[index]) - exact).length() < 1e-15);
    }
}
