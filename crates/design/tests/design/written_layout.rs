//! Layouts of films that were found.

use magsplice_decouple::{Figures, PerParameter};
use magsplice_design::{DesignProblem, Metrics, SearchResult};
use magsplice_layout::{ExpectedField, FigureBounds, Layout};

/// The layout of a film that was found, with expectations of the film before.
#[test]
fn expectations_are_the_errors_reached() {
    let text = "format = 1\nname = \"film\"\n[ideal]\nwavelength_mm = 10.0\nthickness_mm = 1.0\n\
                amplitude_t = 0.12\n[volume]\nx_mm = [-2.0, 2.0]\ny_mm = [-2.0, 2.0]\nz_mm = [-5.0, -3.0]\n\
                step_mm = 1.0\n[design]\nvary = [\"direction\"]\n[expect]\nclearance_mm = { min = 2.0 }\n\
                [[tile]]\nposition_mm = [0, 0, 0.5]\nsize_mm = [1, 1, 1]\npolarization_t = [0.1, 0.1, 0]\n";
    let mut layout = Layout::parse(text, "film").unwrap_or_else(|e| panic!("{e}"));
    layout.expectations.bounds = FigureBounds {
        uniformity_rmse: [Some(0.5); 3].into(),
        displacement_rmse_mm: [Some(0.5); 3].into(),
        least_amplitude: Some(0.05),
    };
    layout.expectations.field = Some(ExpectedField { file: "field.csv".into(), within: 1e-9 });
    let problem = DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}"));
    let reached = [0.0012341, 0.0023451, 0.0034561];
    let metrics = Metrics {
        points: 9,
        figures: Figures {
            uniformity_rmse: reached.map(Some).into(),
            displacement_rmse_mm: reached.map(|error| 10.0 * error).into(),
            amplitude: 0.712345,
        },
        ideal_rmse: PerParameter { r_x: 1.0, r_y: 1.0, s_z: 1.0 },
        scaled_relative_rmse: None,
    };
    let result = SearchResult {
        tiles: layout.bare_tiles(),
        spacing_mm: None,
        before: metrics,
        after: metrics,
        finer: metrics,
        made: None,
        error: 0.0,
        stages: Vec::new(),
        parts: 1,
        agreeing_starts: 1,
        short_of: Vec::new(),
        interrupted: false,
    };
    let written = problem.designed_layout(&result, "test").expectations;
    // A hundredth above the errors, rounded up to three digits.
    let FigureBounds { uniformity_rmse, displacement_rmse_mm, least_amplitude } = written.bounds;
    assert_eq!(uniformity_rmse.to_array(), [Some(0.00125), Some(0.00237), Some(0.0035)]);
    assert_eq!(displacement_rmse_mm.to_array(), [Some(0.0125), Some(0.0237), Some(0.035)]);
    // Rounded down, so that the film meets it.
    assert_eq!(least_amplitude, Some(0.7123));
    // The baseline is the field of the film before. The clearance is a demand on any film.
    assert_eq!((written.field, written.made), (None, None));
    assert_eq!(written.least_clearance_mm, Some(2.0));
}

/// Tiles without strength are left out, with their errors. The history has the errors before and
/// after, the name says that the film is designed, once, and the description goes.
#[test]
fn found_film_has_a_name_and_a_history() {
    let text = |name: &str| {
        let tile = |x: f64| {
            format!("[[tile]]\nposition_mm = [{x}, 0, 0.5]\nsize_mm = [1, 1, 1]\npolarization_t = [0.1, 0, 0]\n")
        };
        format!(
            "format = 1\nname = \"{name}\"\ndescription = \"by hand\"\n[ideal]\nwavelength_mm = 10.0\nthickness_mm = 1.0\n\
             amplitude_t = 0.12\n[volume]\nx_mm = [-2.0, 2.0]\ny_mm = [-2.0, 2.0]\nz_mm = [-5.0, -3.0]\nstep_mm = 1.0\n\
             [design]\nvary = [\"direction\"]\nstarts = 5\nseed = 7\n[tolerance]\nstrength = 0.01\n{}{}{}",
            tile(-2.0),
            tile(0.0),
            tile(2.0)
        )
    };
    let metrics = |factor: f64| Metrics {
        points: 9,
        figures: Figures {
            uniformity_rmse: [Some(0.001 * factor), Some(0.002 * factor), None].into(),
            displacement_rmse_mm: [0.01 * factor, 0.02 * factor, 0.03 * factor].into(),
            amplitude: 0.25 * factor,
        },
        ideal_rmse: PerParameter { r_x: 1.0, r_y: 1.0, s_z: 1.0 },
        scaled_relative_rmse: None,
    };
    let written = |name: &str, interrupted: bool, is_spliced: bool| {
        let layout = Layout::parse(&text(name), "film").unwrap_or_else(|e| panic!("{e}"));
        let problem = DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}"));
        let mut tiles = layout.bare_tiles();
        let middle = tiles[1];
        tiles[1] = magsplice_magnet::Tile::new(middle.position(), middle.size(), glam::DVec3::ZERO).unwrap();
        let result = SearchResult {
            tiles,
            spacing_mm: None,
            before: metrics(2.0),
            after: metrics(1.0),
            finer: metrics(1.0),
            made: None,
            error: 0.0,
            stages: Vec::new(),
            parts: 1,
            agreeing_starts: 1,
            short_of: Vec::new(),
            interrupted,
        };
        let designed =
            if is_spliced { problem.spliced_layout(&result, "test") } else { problem.designed_layout(&result, "test") };
        (designed, layout)
    };
    let (designed, before) = written("film", false, false);
    assert_eq!((designed.name.as_str(), designed.description), ("film, designed", None));
    let names: Vec<&str> = designed.tiles.iter().map(|named| &named.name[..]).collect();
    assert_eq!(names, ["tile-1", "tile-3"]);
    assert_eq!(designed.tolerance.map(|tolerance| tolerance.tiles.len()), Some(2));
    let errors = "3 free parameters, 5 starts, seed 7: uniformity RMSE 2.000e-3, 4.000e-3, one point, displacement RMSE \
                  2.000e-2, 4.000e-2, 6.000e-2 mm, amplitude 0.5000 -> uniformity RMSE 1.000e-3, 2.000e-3, one point, \
                  displacement RMSE 1.000e-2, 2.000e-2, 3.000e-2 mm, amplitude 0.2500";
    assert_eq!(designed.history, [format!("test: from \"film\" (sha256 {}), {errors}", &before.sha256[..12])]);
    let (stopped, _) = written("film, designed", true, false);
    assert_eq!(stopped.name, "film, designed");
    assert!(stopped.history[0].ends_with("amplitude 0.2500; interrupted, the best film found until then"));
    let (spliced, _) = written("film", false, true);
    assert_eq!(spliced.name, "film");
    let start = "test: from the start pattern (Dai 2024, Fig. 5) for \"film\", 3 free parameters";
    assert!(spliced.history[0].starts_with(start), "{:?}", spliced.history);
    // A longer name would be refused.
    let (long, long_before) = written(&"n".repeat(195), false, false);
    assert_eq!(long.name, long_before.name);
    let (longest, _) = written(&"n".repeat(190), false, false);
    assert_eq!(longest.name, "n".repeat(190) + ", designed");
}
