//! Fronts of error against amplitude and against the number of parts.

use std::ops::ControlFlow;
use std::sync::Mutex;

use magsplice_design::{DesignProblem, ProgressUpdate, SearchStage};
use magsplice_layout::Layout;

/// Starts of each amplitude.
const STARTS: usize = 3;

/// Four squares on the diagonals and four strips on the axes. The brief wants one part, of
/// which there is a stock, and two starts.
const FILM: &str = r#"
    format = 1
    name = "film"
    [ideal]
    wavelength_mm = 10.0
    thickness_mm = 1.0
    amplitude_t = 0.12
    [volume]
    x_mm = [-1.0, 1.0]
    y_mm = [-1.0, 1.0]
    z_mm = [-4.0, -3.0]
    step_mm = 1.0
    [design]
    vary = ["size", "position"]
    symmetry = "four-fold"
    outline_mm = { x = [-6.0, 6.0], y = [-6.0, 6.0] }
    amplitude = { min = 0.2 }
    parts = 1
    stock = [{ size_mm = [3.0, 3.0], direction_deg = 45 }]
    starts = 2
    [[tile]]
    position_mm = [3.5, 3.5, 0.5]
    size_mm = [3.0, 3.0, 1.0]
    polarization_t = [0.085, 0.085, 0.0]
    mirror = { axes = ["x", "y"] }
    [[tile]]
    position_mm = [3.5, 0.0, 0.5]
    size_mm = [3.0, 2.0, 1.0]
    polarization_t = [0.12, 0.0, 0.0]
    mirror = { axes = ["x"] }
    [[tile]]
    position_mm = [0.0, 3.5, 0.5]
    size_mm = [2.0, 3.0, 1.0]
    polarization_t = [0.0, 0.12, 0.0]
    mirror = { axes = ["y"] }
"#;

/// Along the amplitude any number of parts is allowed, and stock plays no role. Along the
/// number of parts no film misses a demand because it has more parts than the brief wants.
#[test]
fn number_of_parts_binds_no_film_of_a_front() {
    let layout = Layout::parse(FILM, "film").unwrap_or_else(|e| panic!("{e}"));
    let problem = DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}"));
    let starts = Mutex::new(Vec::new());
    let note = |update: ProgressUpdate| {
        if update.stage == SearchStage::Starts {
            starts.lock().unwrap().push(update.of);
        }
        ControlFlow::Continue(())
    };
    // The film of least error has an amplitude of 1.19.
    let front = problem.pareto_front(&[1.3, 0.3], &note).unwrap_or_else(|e| panic!("{e}"));
    // The amplitudes come first, each with three starts. The film of all parts has those of the
    // brief.
    let mut starts = starts.into_inner().unwrap();
    starts.dedup();
    assert_eq!(starts, [STARTS, 2]);
    assert_eq!(front.by_amplitude.len(), 2);
    for (least, film) in &front.by_amplitude {
        assert_eq!(film.short_of, []);
        assert!(film.after.figures.amplitude >= *least, "{}", film.after.figures.amplitude);
        let stages: Vec<SearchStage> = film.stages.iter().map(|stage| stage.stage).collect();
        assert_eq!(stages, [SearchStage::Starts, SearchStage::Rounding]);
    }
    let counts: Vec<usize> = front.by_parts.iter().map(|film| film.parts).collect();
    assert!(counts.contains(&2), "{counts:?}");
    assert!(front.by_parts.iter().all(|film| film.short_of.is_empty()), "{:?}", front.by_parts);
}
