//! Searches find better films that keep their rules, and give the same film for any number of
//! threads.

use std::ops::ControlFlow;

use glam::DVec3;
use magsplice_decouple::Figures;
use magsplice_design::{
    DesignError, DesignProblem, NeededTable, ProgressUpdate, SearchResult, SearchStage, Shortfall, ignore_progress,
};
use magsplice_layout::{FilmTolerance, Goal, Layout, Under};
use magsplice_magnet::{Tile, overlaps};
use magsplice_tolerance::{EvaluationGrid, RealFilm, Sampler, Statistics};

const TABLES: &str = "format = 1\nname = \"film\"\n[ideal]\nwavelength_mm = 10.0\nthickness_mm = 1.0\namplitude_t = 0.12\n[volume]\nx_mm = [-2.0, 2.0]\n\
                      y_mm = [-2.0, 2.0]\nz_mm = [-5.0, -3.0]\nstep_mm = 1.0\n";
pub(crate) const PUBLISHED: &str = "[[lattice]]\nstart_mm = [-10.0, -10.0, 0.0]\nheight_mm = 1.0\nstrength_t = 0.12\n\
                         x = [{ widths_mm = [0.85, 3.3, 1.7, 3.3, 1.7, 3.3, 1.7, 3.3, 0.85], pattern = [0, 1, 0, -1, 0, 1, 0, -1, 0] }]\n";

fn layout(design: &str) -> Layout {
    Layout::parse(&format!("{TABLES}[design]\n{design}\n{PUBLISHED}"), "test").unwrap_or_else(|e| panic!("{e}"))
}

fn search(layout: &Layout) -> SearchResult {
    DesignProblem::new(layout).and_then(|problem| problem.search(&ignore_progress)).unwrap_or_else(|e| panic!("{e}"))
}

/// Asserts the rules that hold for every goal: no overlap, the shortest side, the outline.
fn assert_rules(result: &SearchResult, smallest_cut_mm: f64, half_mm: f64) {
    assert_eq!(overlaps(&result.tiles).count(), 0);
    for tile in &result.tiles {
        let (position, size) = (tile.position(), tile.size());
        assert!(size.x >= smallest_cut_mm - 1e-9 && size.y >= smallest_cut_mm - 1e-9, "{size}");
        let reach = position.abs() + 0.5 * size;
        assert!(reach.x <= half_mm + 1e-9 && reach.y <= half_mm + 1e-9, "{reach}");
    }
}

/// The message with which a search for a film like the published one is refused.
fn refused(design: &str) -> String {
    let layout = layout(&format!("{design}\nstarts = 1"));
    let result = DesignProblem::new(&layout).and_then(|problem| problem.search(&ignore_progress));
    result.expect_err("there is no such film").to_string()
}

/// Films as made with the errors of a workshop: the published film has 0.27 mm along x at the 95th
/// percentile.
#[test]
fn films_that_are_made_become_ten_times_better() {
    let design = "vary = [\"size\", \"position\", \"direction\"]\nsymmetry = \"four-fold\"\ngoal = \"displacement\"\n\
                  amplitude = { min = 0.8 }\nsmallest_cut_mm = 0.8\nstarts = 1\n";
    let tolerance = "[tolerance]\npreset = \"workshop\"\nsamples = 400\n";
    let nominal = search(&layout(&format!("{design}{tolerance}")));
    assert!(nominal.made.is_none());
    let layout = layout(&format!("{design}under = \"tolerance\"\n{tolerance}"));
    let problem = DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}"));
    let result = problem.search(&ignore_progress).unwrap_or_else(|e| panic!("{e}"));
    assert_rules(&result, 0.8, 10.0);
    assert!(result.short_of.is_empty() && result.after.figures.amplitude >= 0.8, "{:?}", result.short_of);
    let made = result.made.as_ref().expect("samples");
    assert_eq!((made.samples, made.seed), (400, 1));
    let p95 = |errors: &Figures<Statistics>| errors.displacement_rmse_mm.map(|axis| axis.p95.value).to_array();
    let (before, after) = (p95(made.before.as_ref().expect("the film before")), p95(&made.after));
    for axis in 0..3 {
        assert!(after[axis] < 0.1 * before[axis], "axis {axis}: {before:?}, {after:?}");
    }
    // The film that is best without errors loses to it.
    let of_nominal = RealFilm::new(&nominal.tiles, layout.tolerance.as_ref().unwrap());
    let volume = layout.volume.unwrap();
    let volume = EvaluationGrid { grid: volume.grid, reference: volume.reference_mm };
    let errors =
        Sampler::new(&of_nominal, &volume, layout.ideal.as_ref().unwrap(), 1).unwrap().errors_of_range(0..400, || {});
    let of_nominal = magsplice_tolerance::statistics(&errors.unwrap()).unwrap().displacement_rmse_mm.x.p95.value;
    assert!(after[0] < 0.9 * of_nominal, "{} and {of_nominal}", after[0]);
    assert!(nominal.after.figures.displacement_rmse_mm.x < 0.5 * result.after.figures.displacement_rmse_mm.x);
    // The layout written demands the percentiles that were found, a little larger.
    let written = problem.designed_layout(&result, "test");
    let bounds = written.expectations.made.expect("bounds of films as made");
    assert_eq!(bounds.percentile, 95.0);
    let bounds = bounds.bounds.displacement_rmse_mm.to_array();
    for (bound, found) in bounds.into_iter().zip(made.after.displacement_rmse_mm.to_array()) {
        let ratio = bound.unwrap() / found.p95.interval[1];
        assert!((1.02..1.03).contains(&ratio), "{bound:?}, {found:?}");
    }
    assert_eq!(written.brief.unwrap().under, Under::Tolerance);
}

/// The command line cannot state it, but the library can.
#[test]
fn films_that_are_made_need_errors_and_a_displacement() {
    let mut layout = layout("vary = [\"direction\"]\ngoal = \"displacement\"");
    let brief = layout.brief.as_mut().unwrap();
    brief.under = Under::Tolerance;
    let refused = |layout: &Layout| DesignProblem::new(layout).map(|_| ()).expect_err("refused");
    assert_eq!(refused(&layout), DesignError::Missing(NeededTable::Tolerance));
    layout.tolerance = Some(FilmTolerance::default());
    layout.brief.as_mut().unwrap().goal = Goal::Uniformity;
    assert_eq!(refused(&layout), DesignError::NotDisplacement);
}

#[test]
fn coarse_resolution_is_named_as_the_cause() {
    let cut = refused("vary = [\"cut\"]\nsymmetry = \"four-fold\"\nsmallest_cut_mm = 0.8\nresolution_mm = 5.0");
    assert!(cut.starts_with(
        "rounding to resolution_mm = 5 and resolution_deg = 0.01 of [design] leaves no valid film: tile "
    ));
    assert!(cut.ends_with("has a side of 0 mm; choose a finer resolution"), "{cut}");
    let direction = refused("vary = [\"direction\"]\nresolution_deg = 1e5");
    assert!(
        direction.contains("resolution_deg = 100000 of [design] leaves no valid film: B_z vanishes"),
        "{direction}"
    );
}

#[test]
fn contradictions_explain_the_gap_and_are_counted_after_twenty() {
    // Centres of strips are 2.075 mm apart without a gap. The next multiple of 0.05 mm above
    // 2.175 mm is 2.2 mm.
    let touching = refused("vary = [\"position\"]\ngap_mm = 0.1\nresolution_mm = 0.05");
    let rule = "must be at least 0.125 mm apart: gap_mm = 0.1, and resolution_mm = 0.05 for the rounding of positions";
    assert!(touching.contains(rule), "{touching}");
    let wide = refused("vary = [\"size\", \"position\"]\ngap_mm = 2.0");
    assert_eq!(wide.lines().count(), 22, "{wide}");
    assert!(
        wide.contains("must be at least 2 mm apart\n") && wide.lines().last().unwrap().starts_with("  and "),
        "{wide}"
    );
}

/// Centres of touching tiles are apart by a multiple of the resolution, which rounding keeps.
#[test]
fn positions_of_touching_tiles_vary_without_a_gap() {
    for symmetry in ["four-fold", "none"] {
        let layout = layout(&format!("vary = [\"position\"]\nsymmetry = \"{symmetry}\"\ngap_mm = 0.0\nstarts = 1"));
        let result = search(&layout);
        assert_rules(&result, 0.85, 10.0);
        let [before, after] = [&result.before, &result.after].map(|film| film.figures.uniformity_rmse.r_x.unwrap());
        assert!(after < 0.8 * before, "{symmetry}: {after}, not below {before}");
    }
}

/// With sizes, positions and one angle free.
#[test]
fn uniformity_becomes_a_hundred_times_better() {
    let layout = layout(
        "vary = [\"size\", \"position\", \"direction\"]\nsymmetry = \"four-fold\"\namplitude = { min = 0.65 }\nsmallest_cut_mm = 0.8\nstarts = 3",
    );
    let result = search(&layout);
    assert_rules(&result, 0.8, 10.0);
    for metrics in [&result.after, &result.finer] {
        let reached = metrics.figures.uniformity_rmse.map(Option::unwrap);
        assert!(reached.r_x <= 0.0006 && reached.r_y <= 0.0006 && reached.s_z <= 0.0006, "{reached:?}");
        assert!(metrics.figures.amplitude >= 0.65, "{}", metrics.figures.amplitude);
    }
    assert!(result.before.figures.uniformity_rmse.r_x.unwrap() > 0.06);
    for tile in &result.tiles {
        assert!((tile.polarization_t().length() - 0.12).abs() < 1e-15);
        // Sides are multiples of a micrometre, and faces of half of it about a plane of symmetry.
        let is_multiple = |lengths: DVec3| (lengths * 1e3 - (lengths * 1e3).round()).length() < 1e-6;
        assert!(is_multiple(tile.size()) && is_multiple(2.0 * tile.position() - tile.size()), "{tile:?}");
    }
}

/// With five cut lines free.
#[test]
fn cut_lines_improve_the_film_and_stay_shared() {
    let layout = layout(
        "vary = [\"cut\"]\nsymmetry = \"four-fold\"\ngoal = \"displacement\"\nsmallest_cut_mm = 0.8\nstarts = 1",
    );
    assert_eq!(DesignProblem::new(&layout).unwrap().variable_count(), 5);
    let result = search(&layout);
    assert_rules(&result, 0.8, 10.0);
    assert!(
        result.after.ideal_rmse.r_x < 0.01 && result.after.figures.uniformity_rmse.r_x.unwrap() < 0.01,
        "{:?}",
        result.after
    );
    let lines = |tiles: &[Tile]| {
        let mut lines: Vec<i64> = tiles
            .iter()
            .flat_map(|t| [t.position().x - 0.5 * t.size().x, t.position().x + 0.5 * t.size().x])
            .map(|x| (x * 1e6).round() as i64)
            .collect();
        lines.sort_unstable();
        lines.dedup();
        lines.len()
    };
    assert_eq!(lines(&result.tiles), lines(&layout.bare_tiles()));
}

#[test]
fn parts_are_as_few_as_asked_and_parts_in_stock_are_unchanged() {
    let layout = layout(
        "vary = [\"size\", \"position\", \"direction\"]\nsymmetry = \"four-fold\"\ngoal = \"displacement\"\namplitude = { min = 0.6 }\nsmallest_cut_mm = 0.8\n\
         starts = 1\nparts = 4\nstock = [{ size_mm = [3.3, 3.3], direction_deg = 45 }, { size_mm = [0.85, 3.3], direction_deg = 90 }]",
    );
    let result = search(&layout);
    assert_rules(&result, 0.8, 10.0);
    assert_eq!(result.short_of, []);
    assert!(result.parts <= 4, "{}", result.parts);
    let problem = DesignProblem::new(&layout).unwrap();
    let designed = Layout::parse(&problem.designed_layout(&result, "test").to_toml(), "designed")
        .unwrap_or_else(|e| panic!("{e}"));
    let parts = designed.parts();
    let square = |p: &&magsplice_layout::Part| p.size_mm.x == 3.3 && p.size_mm.y == 3.3;
    let strip = |p: &&magsplice_layout::Part| p.size_mm.x == 3.3 && p.size_mm.y == 0.85;
    let made = parts.iter().filter(|p| !square(p) && !strip(p)).count();
    assert!(made <= 2, "{parts:?}");
    // Parts in stock keep their direction.
    for part in parts.iter().filter(square) {
        assert!((part.direction.x - part.direction.y).abs() < 1e-9, "{part:?}");
    }
    for part in parts.iter().filter(strip) {
        assert!((part.direction.x - 1.0).abs() < 1e-9, "{part:?}");
    }
    assert!(result.after.ideal_rmse.r_x < 0.01, "{:?}", result.after);
    assert_eq!(designed.history.len(), 1);
    assert_eq!(designed.brief, layout.brief);
}

/// With strengths free and the field as the goal, the problem is linear.
#[test]
fn linear_problem_is_solved_in_one_step() {
    let design = |goal: &str, more: &str| {
        layout(&format!(
            "vary = [\"strength\"]\nsymmetry = \"four-fold\"\ngoal = \"{goal}\"\namplitude = {{ min = 0.5 }}\nstrength_t = {{ min = 0.0, max = 0.12 }}\nstarts = 1\n{more}"
        ))
    };
    let result = search(&design("field", ""));
    let error = result.after.scaled_relative_rmse.unwrap();
    assert!(error < 0.02, "{error}");
    assert!(result.tiles.iter().all(|t| t.polarization_t().length() <= 0.12 + 1e-9));
    let steps = std::sync::atomic::AtomicUsize::new(0);
    let layout = design("field", "");
    let count = |update: ProgressUpdate| {
        steps.fetch_add(usize::from(update.stage == SearchStage::Starts), std::sync::atomic::Ordering::Relaxed);
        ControlFlow::Continue(())
    };
    DesignProblem::new(&layout).unwrap().search(&count).unwrap();
    // The step, and at most one more by round-off.
    assert!(steps.into_inner() <= 2);
    let fixed = search(&design("field", "stock_strengths_t = [0.0, 0.04, 0.08, 0.12]"));
    for tile in &fixed.tiles {
        let strength = tile.polarization_t().length();
        assert!([0.0, 0.04, 0.08, 0.12].iter().any(|s| (strength - s).abs() < 1e-12), "{strength}");
    }
    // Strengths in stock cost accuracy, and each stage is listed.
    assert!(fixed.after.scaled_relative_rmse.unwrap() > error);
    assert_eq!(fixed.stages.len(), 3);
}

#[test]
fn result_is_the_same_for_any_number_of_threads() {
    let layout = layout(
        "vary = [\"size\", \"direction\"]\nsymmetry = \"four-fold\"\namplitude = { min = 0.7 }\nsmallest_cut_mm = 0.8\nstarts = 4\nseed = 7",
    );
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| search(&layout).tiles)
    };
    assert_eq!(with(1), with(3));
}

#[test]
fn interrupted_search_keeps_its_best_film() {
    let layout = layout("vary = [\"size\"]\nsymmetry = \"mirror\"\nsmallest_cut_mm = 0.8\nstarts = 2");
    let count = std::sync::atomic::AtomicUsize::new(0);
    let stop = |_: ProgressUpdate| {
        let told = count.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        if told < 5 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    };
    let result = DesignProblem::new(&layout).unwrap().search(&stop).unwrap();
    assert!(result.interrupted);
    assert_rules(&result, 0.8, 10.0);
    let [before, after] = [result.before, result.after].map(|metrics| metrics.figures.uniformity_rmse.r_x.unwrap());
    assert!(after < before);
}

#[test]
fn contradictions_are_errors_and_missed_demands_are_listed() {
    let error = |design: &str| {
        let layout = layout(design);
        DesignProblem::new(&layout).and_then(|problem| problem.search(&ignore_progress)).unwrap_err().to_string()
    };
    let told = error("vary = [\"size\"]\nsmallest_cut_mm = 3.0\nsymmetry = \"four-fold\"\nstarts = 1");
    assert!(told.contains("a side must be at least 3 mm") && told.contains("lattice-1-"), "{told}");
    let told = error("vary = [\"position\"]\noutline_mm = { x = [-5.0, 5.0] }\nstarts = 1");
    assert!(told.contains("must stay within outline_mm, x = [-5.0, 5.0]"), "{told}");
    // A demand out of reach is no error: the result is the nearest film, and lists the demand.
    let layout = layout(
        "vary = [\"size\"]\nsymmetry = \"four-fold\"\nsmallest_cut_mm = 0.8\nstarts = 1\namplitude = { min = 5.0 }",
    );
    let result = search(&layout);
    assert!(matches!(result.short_of[..], [Shortfall::Amplitude { least: 5.0, .. }]), "{:?}", result.short_of);
    assert_rules(&result, 0.8, 10.0);
}
