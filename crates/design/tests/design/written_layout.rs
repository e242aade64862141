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
