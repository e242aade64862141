//! Tests of the sampling and the objective: derivatives, weights of a finer grid, symmetry.

use magsplice_layout::{Brief, Goal, Layout};

use crate::problem::design_problem::DesignProblem;
use crate::search::metrics::Metrics;

/// Boards that mirrors keep, and boards that they do not; one of the latter has a weight for each
/// axis.
pub(crate) const HEADS: [&str; 4] = [
    "[sensor]\nhead = \"pair-z\"\nspacing_mm = 2.0\n",
    "[sensor]\nhead = \"cross\"\n",
    "[sensor]\nhead = \"pair-xy\"\n",
    "[[sensor.element]]\nposition_mm = [0.2, -0.1, 0.0]\nweight = [1.4, 1.5, 1.6]\n\
     [[sensor.element]]\nposition_mm = [-0.3, 0.4, -2.0]\nweight = [-0.7, -0.9, -0.8]\n",
];

/// A plate of iron behind the film.
pub(crate) const PLATE: &str =
    "[[plane]]\npoint_mm = [0.0, 0.0, 4.0]\nnormal = [0, 0, -1]\nrelative_permeability = 9.0\n";

/// Central differences in every variable, for every goal, with all numbers free at once.
///
/// With steps of 1e-5 of a millimetre, a radian or a tesla times the strength, the differences are
/// off by the third derivative times 1e-10 and by round-off over 1e-5. Both are below 1e-7 of the
/// largest derivative of a variable.
#[test]
fn derivatives_agree_with_central_differences() {
    assert_derivatives("");
}

/// As above below heads: with the symmetry of the film and without it.
#[test]
fn derivatives_below_a_head_agree_with_central_differences() {
    HEADS.into_iter().for_each(assert_derivatives);
}

/// As above before iron.
#[test]
fn derivatives_before_iron_agree_with_central_differences() {
    assert_derivatives(PLATE);
}

fn assert_derivatives(sensor: &str) {
    let text = |design: &str, tiles: &str| {
        format!(
            "format = 1\nname = \"film\"\n[ideal]\nwavelength_mm = 10.0\nthickness_mm = 1.0\namplitude_t = 0.12\n[volume]\nx_mm = [-1.5, 2.0]\ny_mm = [-1.0, 1.0]\n\
             z_mm = [-5.0, -3.0]\nstep_mm = 1.0\n[design]\n{design}\nthickness_mm = {{ min = 0.5, max = 2.0 }}\nstrength_t = {{ min = 0.0, max = 1.0 }}\n{sensor}{tiles}"
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

/// The objective at the start, below a head or before iron, is that of the metrics, which are
/// evaluated without symmetry. The
/// amplitude is that of the ideal film as the head reads it.
#[test]
fn objective_below_a_head_is_that_of_the_metrics() {
    let text = std::fs::read_to_string("../../layouts/published-film.toml").expect("a shipped layout");
    let table = "[sensor]\n";
    for head in HEADS.into_iter().chain([PLATE]) {
        // The film has a table [sensor], to which the keys of a board are added.
        let text = if head.starts_with(table) { text.replace(table, head) } else { format!("{text}\n{head}") };
        let layout = Layout::parse(&text, "test").unwrap_or_else(|e| panic!("{e}"));
        let brief = Brief { goal: Goal::Displacement, ..layout.brief.clone().unwrap() };
        let problem = DesignProblem::from_brief(&layout, brief).unwrap();
        let (squares, volume) = (&problem.least_squares, layout.volume.unwrap());
        let residuals = squares.residuals(&problem.pattern, &problem.pattern.start, false).unwrap();
        let ideal = layout.ideal.unwrap();
        let metrics = Metrics::from_tiles(
            &layout.bare_tiles(),
            &layout.iron,
            layout.head(),
            &volume.grid,
            volume.reference_mm,
            &ideal,
        );
        let figures = metrics.unwrap().figures;
        assert_eq!(problem.grid().len(), volume.grid.len());
        let errors_mm = figures.displacement_rmse_mm.to_array();
        let expected: f64 = (0..3).map(|axis| (squares.objective.weights[axis] * errors_mm[axis]).powi(2)).sum();
        let found = 2.0 * residuals.loss();
        assert!((found / expected - 1.0).abs() < 1e-9, "{head}: {found} is not {expected}");
        let amplitude = residuals.amplitudes[0].0;
        assert!((amplitude / figures.amplitude - 1.0).abs() < 1e-12, "{head}: {amplitude}");
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
        &layout.iron,
        layout.head(),
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
