//! Tests of the expected square: its value against the model of first order, its derivatives
//! against differences.

use glam::DVec3;
use magsplice_decouple::{Branch, Parameters};
use magsplice_field::Scene;
use magsplice_layout::{Layout, Under, WorkingVolume};
use magsplice_magnet::{Quantity, Tile};
use magsplice_tolerance::{EvaluationGrid, FirstOrder, RealFilm};

use crate::derivative_tests::{HEADS, PLATE};
use crate::problem::design_problem::DesignProblem;
use crate::problem::reading::Reading;

const TABLES: &str = "format = 1\nname = \"film\"\n[ideal]\nwavelength_mm = 10.0\nthickness_mm = 1.0\namplitude_t = 0.12\n[volume]\nx_mm = [-1.5, 2.0]\n\
                      y_mm = [-1.0, 1.0]\nz_mm = [-5.0, -3.0]\nstep_mm = 1.0\n";

const TILE_ERRORS: &str = "[tolerance]\nposition_mm = [0.05, 0.03, 0.04]\nrotation_deg = [0.5, 0.3, 1.0]\nsize_mm = [0.02, 0.01, 0.03]\nstrength = 0.01\n\
                           direction_deg = [1.0, 0.7]\n";

/// Errors that tiles share, and those of the surroundings and of the sensor, beside those of the
/// tiles.
const SHARED_ERRORS: &str = "film = { position_mm = [0.1, 0.05, 0.08], rotation_deg = [0.4, 0.6, 0.5] }\nstray_field = { field_ut = [50.0, 20.0, 10.0] }\n\
                             temperature = { change_k = 10.0, strength_per_k = -0.0012 }\n\
                             sensor = { offset_ut = 3.0, rotation_deg = [0.5, 0.4, 0.3], gain = 0.01, noise_ut = 5.0 }\n\
                             [[tolerance.group]]\nname = \"pair\"\ntiles = [\"a\", \"b\"]\nposition_mm = 0.07\nrotation_deg = 0.6\nsize_mm = 0.02\n\
                             strength = 0.02\ndirection_deg = [0.9, 0.5]\n";

/// Errors that sensors have by themselves, beside those of `SHARED_ERRORS`.
fn with_displaced_sensors(errors: &str) -> String {
    errors.replace("sensor = {", "sensor = { position_mm = [0.04, 0.03, 0.05],")
}

const PAIR: &str = "[[tile]]\nname = \"a\"\nposition_mm = [1.5, 0.3, 0.5]\nsize_mm = [3.0, 2.0, 1.0]\npolarization_t = [0.12, 0.05, 0.01]\n\
                    [[tile]]\nname = \"b\"\nposition_mm = [-2.0, -0.4, 0.5]\nsize_mm = [2.0, 2.5, 1.0]\npolarization_t = [-0.1, 0.03, 0.0]\n";

const MIRRORED: &str = "[[tile]]\nname = \"a\"\nposition_mm = [2.5, 2.3, 0.5]\nsize_mm = [3.0, 2.0, 1.0]\npolarization_t = [0.12, 0.05, 0.01]\nmirror = { axes = [\"x\", \"y\"] }\n\
                        [[tile]]\nname = \"b\"\nposition_mm = [6.0, 0.0, 0.6]\nsize_mm = [2.0, 1.0, 1.2]\npolarization_t = [-0.1, 0.0, 0.02]\nmirror = { axes = [\"x\"] }\n";

fn layout(errors: &str, design: &str, tiles: &str) -> Layout {
    let text = format!(
        "{TABLES}{errors}[design]\nunder = \"tolerance\"\ngoal = \"displacement\"\nthickness_mm = {{ min = 0.5, max = 2.0 }}\nstrength_t = {{ min = 0.0, max = 1.0 }}\n{design}\n{tiles}"
    );
    Layout::parse(&text, "test").unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn published(symmetry: &str) -> Layout {
    let text = std::fs::read_to_string("../../layouts/published-film.toml").expect("a shipped layout");
    let mut layout = Layout::parse(&text, "test").unwrap_or_else(|e| panic!("{e}"));
    let errors = Layout::parse(&format!("{TABLES}{TILE_ERRORS}{PAIR}"), "test").unwrap_or_else(|e| panic!("{e}"));
    let mut tolerance = errors.tolerance.expect("errors");
    tolerance.tiles = vec![tolerance.tiles[0].clone(); layout.tiles.len()];
    layout.tolerance = Some(tolerance);
    let brief = layout.brief.as_mut().expect("a design");
    brief.goal = magsplice_layout::Goal::Displacement;
    brief.under = Under::Tolerance;
    if symmetry == "none" {
        brief.symmetry = magsplice_layout::Symmetry::None;
    }
    layout
}

/// The published film below a head, with equal errors along x and y where `errors` has none of its
/// own.
fn published_below(head: &str, errors: &str) -> Layout {
    let mut layout = published("four-fold");
    let other = Layout::parse(&format!("{TABLES}{errors}{PAIR}{head}"), "test").unwrap_or_else(|e| panic!("{e}"));
    layout.sensor = other.sensor;
    let tolerance = layout.tolerance.as_mut().expect("errors");
    tolerance.common = other.tolerance.expect("errors").common;
    // Few points, for the time of the model of first order.
    let WorkingVolume { lower_mm, upper_mm, reference_mm, .. } = layout.volume.expect("a volume");
    layout.volume = WorkingVolume::new(lower_mm, upper_mm, 0.25 * (upper_mm - lower_mm), reference_mm).ok();
    layout
}

/// Two independent ways to the same number: the model of first order has no symmetry, no
/// derivatives by variables, and other sums.
#[test]
fn expected_square_is_that_of_the_model_of_first_order() {
    let vary = "vary = [\"size\"]";
    let shared = format!("{TILE_ERRORS}{SHARED_ERRORS}");
    let with_images = shared.replace(r#"["a", "b"]"#, r#"["a*"]"#);
    let mirror = format!("{vary}\nsymmetry = \"mirror\"");
    for (name, layout, terms) in [
        ("alone", layout(&shared, vary, PAIR), 30),
        ("mirrored, all errors", layout(&with_images, &format!("{vary}\nsymmetry = \"mirror\""), MIRRORED), 30),
        ("mirrored", layout(TILE_ERRORS, &format!("{vary}\nsymmetry = \"mirror\""), MIRRORED), 12),
        ("alone before iron", layout(&shared, vary, &format!("{PAIR}{PLATE}")), 30),
        ("mirrored before iron", layout(&with_images, &mirror, &format!("{MIRRORED}{PLATE}")), 30),
        ("published", published("four-fold"), 12 * 56),
        ("published without symmetry", published("none"), 12 * 56),
    ] {
        assert_square_is_that_of_the_model_of_first_order(name, &layout, terms);
    }
}

/// As above below heads: boards with the symmetry of the film and without, errors of sensors that
/// differ along x and y and that do not.
#[test]
fn expected_square_below_a_head_is_that_of_the_model_of_first_order() {
    let vary = "vary = [\"size\"]";
    let shared = with_displaced_sensors(&format!("{TILE_ERRORS}{SHARED_ERRORS}"));
    let with_images = shared.replace(r#"["a", "b"]"#, r#"["a*"]"#);
    let equal = "[tolerance]\nsensor = { position_mm = 0.03, offset_ut = 3.0, rotation_deg = 0.5, gain = 0.01, noise_ut = 5.0 }\n";
    for head in HEADS {
        let below = |errors: &str, design: &str, tiles: &str| layout(errors, design, &format!("{tiles}{head}"));
        let mirror = format!("{vary}\nsymmetry = \"mirror\"");
        for (name, layout, terms) in [
            ("alone", below(&shared, vary, PAIR), 30),
            ("mirrored", below(&with_images, &mirror, MIRRORED), 30),
            ("published, equal errors", published_below(head, equal), 12 * 56),
            ("published, other errors", published_below(head, &shared), 12 * 56),
        ] {
            assert_square_is_that_of_the_model_of_first_order(&format!("{name}, {head}"), &layout, terms);
        }
    }
}

fn assert_square_is_that_of_the_model_of_first_order(name: &str, layout: &Layout, terms: usize) {
    let problem = DesignProblem::new(layout).unwrap_or_else(|e| panic!("{name}: {e}"));
    let residuals = problem.least_squares.residuals(&problem.pattern, &problem.pattern.start, false).unwrap();
    let film = RealFilm::new(&layout.bare_tiles(), layout.tolerance.as_ref().unwrap());
    let film = film.with_iron(layout.iron.clone()).with_head(layout.head().cloned());
    let volume = layout.volume.unwrap();
    let volume = EvaluationGrid { grid: volume.grid, reference: volume.reference_mm };
    let model = FirstOrder::new(&film, &volume, layout.ideal.as_ref().unwrap()).unwrap();
    assert!(model.terms().len() >= terms, "{name}: {} terms", model.terms().len());
    let weighted = |of: &dyn Fn(usize) -> f64| -> f64 {
        (0..3).map(|axis| problem.least_squares.objective.weights[axis].powi(2) * of(axis)).sum()
    };
    let expected = weighted(&|axis| model.axis_errors(axis).expected_mm2);
    let nominal = weighted(&|axis| model.axis_errors(axis).nominal_mm2);
    let found = 2.0 * residuals.loss();
    assert!((found / expected - 1.0).abs() < 1e-9, "{name}: {found} is not {expected}");
    assert!(expected > 1.0001 * nominal, "{name}: the errors count for nothing");
}

/// Central differences in every variable, for errors of every kind. See
/// `derivatives_agree_with_central_differences` for the step.
#[test]
fn derivatives_of_the_expected_square_agree_with_central_differences() {
    let all = "\"thickness\", \"direction\", \"tilt\", \"strength\"]\nweights = { r_x = 1.0, r_y = 2.0, s_z = 0.5 }";
    let shared = format!("{TILE_ERRORS}{SHARED_ERRORS}");
    let with_sensors = with_displaced_sensors(&shared);
    let iron = |when: &str| {
        format!("{TILE_ERRORS}iron = {{ distance_mm = 2.0, relative_permeability = 20.0, when = \"{when}\" }}\n")
    };
    let [iron_before, iron_after] = ["before", "after"].map(iron);
    let mirrored = format!("vary = [\"size\", \"position\", {all}\nsymmetry = \"mirror\"");
    for (errors, design, tiles, head) in [
        (&shared, mirrored.clone(), MIRRORED, ""),
        (&shared, format!("vary = [\"cut\", {all}\nsymmetry = \"mirror\""), MIRRORED, ""),
        (&shared, format!("vary = [\"size\", {all}"), PAIR, ""),
        (&shared, format!("vary = [\"position\", {all}"), PAIR, ""),
        (&iron_after, mirrored.clone(), MIRRORED, ""),
        (&iron_before, format!("vary = [\"size\", {all}"), PAIR, ""),
        (&iron_after, mirrored.clone(), MIRRORED, HEADS[0]),
        (&shared, mirrored.clone(), MIRRORED, PLATE),
        (&shared, format!("vary = [\"size\", \"position\", {all}"), PAIR, PLATE),
        (&with_sensors, mirrored.clone(), MIRRORED, HEADS[0]),
        (&with_sensors, mirrored.clone(), MIRRORED, HEADS[1]),
        (&with_sensors, mirrored, MIRRORED, HEADS[2]),
        (&with_sensors, format!("vary = [\"size\", {all}"), PAIR, HEADS[3]),
    ] {
        // Groups name tiles, and a mirrored tile is several.
        let errors = if tiles == PAIR { &errors[..] } else { errors.split("[[").next().unwrap() };
        let layout = layout(errors, &design, &format!("{tiles}{head}"));
        let problem = DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}"));
        let (pattern, least_squares) = (&problem.pattern, &problem.least_squares);
        let start = &pattern.start;
        let n = start.len();
        assert!(n >= 8, "{n}");
        let residuals = least_squares.residuals(pattern, start, true).unwrap();
        let expected = residuals.expected.expect("errors");
        let loss =
            |variables: &[f64]| least_squares.residuals(pattern, variables, false).unwrap().expected.unwrap().loss;
        assert!((loss(start) / expected.loss - 1.0).abs() < 1e-12);
        let largest = expected.gradient.iter().fold(0.0_f64, |most, slope| most.max(slope.abs()));
        for variable in 0..n {
            let h = 1e-5;
            let moved = |by: f64| {
                let mut variables = start.clone();
                variables[variable] += by;
                loss(&variables)
            };
            let difference = (moved(h) - moved(-h)) / (2.0 * h);
            let slope = expected.gradient[variable];
            assert!(
                (difference - slope).abs() <= 1e-6 * largest,
                "variable {variable} of {design}: {difference} is not {slope}"
            );
            for other in 0..n {
                let [a, b] = [variable * n + other, other * n + variable].map(|at| expected.curvature[at]);
                assert!((a - b).abs() <= 1e-9 * (a.abs() + b.abs() + 1e-30), "{variable}, {other}: {a} and {b}");
            }
        }
    }
}

/// What iron adds, from its definition: the field of image tiles times the derivatives of the
/// parameters, without symmetry and with, and below a head.
#[test]
fn iron_adds_the_square_of_what_its_images_change() {
    for (tiles, design, head) in [(PAIR, "", ""), (MIRRORED, "symmetry = \"mirror\"", ""), (PAIR, "", HEADS[1])] {
        for when in ["before", "after"] {
            let iron = format!(
                "[tolerance]\niron = {{ distance_mm = 1.5, relative_permeability = 9.0, when = \"{when}\" }}\n"
            );
            let layout = layout(&iron, &format!("vary = [\"size\"]\n{design}"), &format!("{tiles}{head}"));
            let problem = DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}"));
            let residuals = problem.least_squares.residuals(&problem.pattern, &problem.pattern.start, false).unwrap();
            let found = 2.0 * residuals.expected.expect("errors").loss;

            let film = layout.bare_tiles();
            let stated = layout.tolerance.as_ref().and_then(|tolerance| tolerance.common.iron.as_ref()).expect("iron");
            let plane = stated.plane(&film, 0.0).expect("a plane");
            let images: Vec<Tile> = film.iter().map(|tile| plane.image(tile).expect("a tile")).collect();
            let volume = layout.volume.unwrap();
            let points: Vec<DVec3> = volume.grid.points().chain([volume.reference_mm]).collect();
            let reading = Reading::new(layout.head());
            let read = |tiles: &[Tile]| -> Vec<DVec3> {
                let at_places = Scene::new(tiles).field_at(Quantity::FluxDensity, &reading.places(&points)).unwrap();
                let of_point = |values: &[DVec3]| reading.sum(values.iter().copied());
                at_places.chunks_exact(reading.sensors().len()).map(of_point).collect()
            };
            let (read_t, mut changes_t) = (read(&film), read(&images));
            let last = points.len() - 1;
            if when == "after" {
                changes_t[last] = DVec3::ZERO;
            }
            let branch = Branch::from_axis_field(read_t[last]).expect("a field");
            let change = |point: usize| {
                let (_, by) = Parameters::with_derivatives(read_t[point], branch).expect("regular");
                DVec3::new(by.r_x.dot(changes_t[point]), by.r_y.dot(changes_t[point]), by.s_z.dot(changes_t[point]))
            };
            let k = layout.ideal.unwrap().wavenumber();
            let weights = DVec3::from(problem.least_squares.objective.weights) / k;
            let square = |point: usize| (weights * (change(point) - change(last))).length_squared();
            let expected = (0..last).map(square).sum::<f64>() / last as f64;
            assert!((found / expected - 1.0).abs() < 1e-9, "{design} {head} {when}: {found} is not {expected}");
        }
    }
}

/// Errors of the distance of iron give the mean of the squares at all distances, by Simpson's rule.
/// At a third of the distance the three distances of the model are right to 1 %.
#[test]
fn errors_of_the_distance_of_iron_are_averaged() {
    let loss = |distance: f64, error: &str| {
        let iron = format!("[tolerance]\niron = {{ distance_mm = {distance}{error}, when = \"after\" }}\n");
        let layout = layout(&iron, "vary = [\"size\"]", PAIR);
        let problem = DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}"));
        let residuals = problem.least_squares.residuals(&problem.pattern, &problem.pattern.start, false).unwrap();
        residuals.expected.expect("errors").loss
    };
    let found = loss(1.5, ", distance_error_mm = { uniform = 0.5 }");
    let weight = |n: u32| if n == 0 || n == 20 { 1.0 } else { f64::from(2 + 2 * (n % 2)) };
    let mean = (0..=20).map(|n| weight(n) * loss(1.0 + f64::from(n) / 20.0, "")).sum::<f64>() / 60.0;
    let middle = loss(1.5, "");
    assert!((found / mean - 1.0).abs() < 0.01, "{found} is not {mean}");
    assert!(mean > 1.05 * middle, "{mean} is near {middle}");
}

/// The derivatives of sensitivities are never formed. Differences of the sensitivities of the model
/// of first order stand for them here.
#[test]
fn curvature_is_the_product_of_the_derivatives_of_sensitivities() {
    // Noise at each point is no term of that model.
    let errors = format!("{TILE_ERRORS}{SHARED_ERRORS}").replace(", noise_ut = 5.0", "");
    let design = "vary = [\"size\", \"direction\", \"tilt\"]\nweights = { r_x = 1.0, r_y = 2.0, s_z = 0.5 }";
    assert_curvature(&layout(&errors, design, PAIR));
    for head in HEADS {
        assert_curvature(&layout(&with_displaced_sensors(&errors), design, &format!("{PAIR}{head}")));
    }
}

fn assert_curvature(layout: &Layout) {
    let problem = DesignProblem::new(layout).unwrap_or_else(|e| panic!("{e}"));
    let (pattern, least_squares) = (&problem.pattern, &problem.least_squares);
    let n = pattern.start.len();
    let expected = least_squares.residuals(pattern, &pattern.start, true).unwrap().expected.unwrap();
    let volume = layout.volume.unwrap();
    let volume = EvaluationGrid { grid: volume.grid, reference: volume.reference_mm };
    // All sensitivities times deviations, weighted like residuals.
    let rows = |variables: &[f64]| -> Vec<f64> {
        let tiles = pattern.all_tiles(variables).unwrap();
        let film = RealFilm::new(&tiles, layout.tolerance.as_ref().unwrap()).with_head(layout.head().cloned());
        let model = FirstOrder::new(&film, &volume, layout.ideal.as_ref().unwrap()).unwrap();
        let per_point = 1.0 / (volume.grid.len() as f64).sqrt();
        let of_axis = |axis: usize| -> Vec<f64> {
            let weight = least_squares.objective.weights[axis] * per_point;
            model.sensitivities_mm(axis).flat_map(|(_, column)| column).map(|value| weight * value).collect()
        };
        [0, 1, 2].map(of_axis).concat()
    };
    let derivatives: Vec<Vec<f64>> = (0..n)
        .map(|variable| {
            let h = 1e-5;
            let moved = |by: f64| {
                let mut variables = pattern.start.clone();
                variables[variable] += by;
                rows(&variables)
            };
            moved(h).iter().zip(moved(-h)).map(|(above, below)| (above - below) / (2.0 * h)).collect()
        })
        .collect();
    let square: f64 = rows(&pattern.start).iter().map(|row| row * row).sum();
    assert!((square / (2.0 * expected.loss) - 1.0).abs() < 1e-9, "{square} is not {}", 2.0 * expected.loss);
    assert!(n >= 6 && derivatives[0].len() >= 30, "{n}");
    for (i, k) in (0..n).flat_map(|i| (0..n).map(move |k| (i, k))) {
        let product = |i: usize, k: usize| derivatives[i].iter().zip(&derivatives[k]).map(|(a, b)| a * b).sum::<f64>();
        let found = expected.curvature[i * n + k];
        let scale = (product(i, i) * product(k, k)).sqrt();
        assert!((found - product(i, k)).abs() <= 1e-6 * scale, "{i}, {k}: {found} is not {}", product(i, k));
    }
}
