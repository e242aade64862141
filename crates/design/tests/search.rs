//! Films are found, keep their rules, and are the same for any number of threads.

use std::ops::ControlFlow;

use magsplice_design::{DesignError, Outcome, Progress, Request, Setting};
use magsplice_field::{Tile, overlaps};
use magsplice_layout::{Goal, Layout};

const TABLES: &str = "format = 1\nname = \"film\"\n[ideal]\nwavelength_mm = 10.0\nthickness_mm = 1.0\namplitude_t = 0.12\n[volume]\nx_mm = [-2.0, 2.0]\n\
                      y_mm = [-2.0, 2.0]\nz_mm = [-5.0, -3.0]\nstep_mm = 1.0\n";
const PUBLISHED: &str = "[[lattice]]\nstart_mm = [-10.0, -10.0, 0.0]\nheight_mm = 1.0\nstrength_t = 0.12\n\
                         x = [{ widths_mm = [0.85, 3.3, 1.7, 3.3, 1.7, 3.3, 1.7, 3.3, 0.85], pattern = [0, 1, 0, -1, 0, 1, 0, -1, 0] }]\n";

fn layout(design: &str) -> Layout {
    Layout::parse(&format!("{TABLES}[design]\n{design}\n{PUBLISHED}"), "test").unwrap_or_else(|e| panic!("{e}"))
}

fn go_on(_: Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn found(layout: &Layout) -> Outcome {
    Setting::of(layout).and_then(|setting| setting.search(&go_on)).unwrap_or_else(|e| panic!("{e}"))
}

/// What every film must keep, whatever it was designed for.
fn assert_kept(outcome: &Outcome, smallest_cut_mm: f64, half_mm: f64) {
    assert_eq!(overlaps(&outcome.tiles).count(), 0);
    for tile in &outcome.tiles {
        let (position, size) = (tile.position(), tile.size());
        assert!(size.x >= smallest_cut_mm - 1e-9 && size.y >= smallest_cut_mm - 1e-9, "{size}");
        let reach = position.abs() + 0.5 * size;
        assert!(reach.x <= half_mm + 1e-9 && reach.y <= half_mm + 1e-9, "{reach}");
    }
}

/// Sizes, positions and one angle: far beyond what the published film reaches.
#[test]
fn a_far_better_film_is_found() {
    let layout = layout(
        "vary = [\"size\", \"position\", \"direction\"]\nsymmetry = \"four-fold\"\namplitude = { min = 0.65 }\nsmallest_cut_mm = 0.8\nstarts = 3",
    );
    let outcome = found(&layout);
    assert_kept(&outcome, 0.8, 10.0);
    for figures in [&outcome.after, &outcome.finer] {
        let reached = figures.uniformity_rmse;
        assert!(reached.r_x <= 0.0006 && reached.r_y <= 0.0006 && reached.s_z <= 0.0006, "{reached:?}");
        assert!(figures.amplitude >= 0.65, "{}", figures.amplitude);
    }
    assert!(outcome.before.uniformity_rmse.r_x > 0.06);
    for tile in &outcome.tiles {
        assert!((tile.polarization_t().length() - 0.12).abs() < 1e-15);
        // Faces at multiples of a micrometre.
        for face in [tile.position() - 0.5 * tile.size(), tile.position() + 0.5 * tile.size()] {
            assert!((face * 1e3 - (face * 1e3).round()).length() < 1e-6, "{face}");
        }
    }
}

/// Five cut lines.
#[test]
fn cut_lines_alone_make_it_better_and_stay_shared() {
    let layout = layout(
        "vary = [\"cut\"]\nsymmetry = \"four-fold\"\ngoal = \"displacement\"\nsmallest_cut_mm = 0.8\nstarts = 1",
    );
    assert_eq!(Setting::of(&layout).unwrap().free(), 5);
    let outcome = found(&layout);
    assert_kept(&outcome, 0.8, 10.0);
    assert!(outcome.after.ideal_rmse.r_x < 0.01 && outcome.after.uniformity_rmse.r_x < 0.01, "{:?}", outcome.after);
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
    assert_eq!(lines(&outcome.tiles), lines(&layout.bare_tiles()));
}

#[test]
fn parts_are_as_few_as_asked_and_those_at_hand_are_used_as_they_are() {
    let layout = layout(
        "vary = [\"size\", \"position\", \"direction\"]\nsymmetry = \"four-fold\"\ngoal = \"displacement\"\namplitude = { min = 0.6 }\nsmallest_cut_mm = 0.8\n\
         starts = 1\nparts = 4\nstock = [{ size_mm = [3.3, 3.3], direction_deg = 45 }, { size_mm = [0.85, 3.3], direction_deg = 90 }]",
    );
    let outcome = found(&layout);
    assert_kept(&outcome, 0.8, 10.0);
    assert_eq!(outcome.short_of, [""; 0]);
    assert!(outcome.parts <= 4, "{}", outcome.parts);
    let setting = Setting::of(&layout).unwrap();
    let designed =
        Layout::parse(&setting.layout_of(&outcome, "test").to_toml(), "designed").unwrap_or_else(|e| panic!("{e}"));
    let parts = designed.parts();
    let square = |p: &&magsplice_layout::Part| p.size_mm.x == 3.3 && p.size_mm.y == 3.3;
    let strip = |p: &&magsplice_layout::Part| p.size_mm.x == 3.3 && p.size_mm.y == 0.85;
    let made = parts.iter().filter(|p| !square(p) && !strip(p)).count();
    assert!(made <= 2, "{parts:?}");
    // What is at hand keeps its direction.
    for part in parts.iter().filter(square) {
        assert!((part.direction.x - part.direction.y).abs() < 1e-9, "{part:?}");
    }
    for part in parts.iter().filter(strip) {
        assert!((part.direction.x - 1.0).abs() < 1e-9, "{part:?}");
    }
    assert!(outcome.after.ideal_rmse.r_x < 0.01, "{:?}", outcome.after);
    assert_eq!(designed.history.len(), 1);
    assert_eq!(designed.brief, layout.brief);
}

/// For strengths alone and the field as the goal the problem is linear: wherever it starts, it ends at the same film in one step.
#[test]
fn strengths_for_the_field_are_found_in_one_step() {
    let design = |goal: &str, more: &str| {
        layout(&format!(
            "vary = [\"strength\"]\nsymmetry = \"four-fold\"\ngoal = \"{goal}\"\namplitude = {{ min = 0.5 }}\nstrength_t = {{ min = 0.0, max = 0.12 }}\nstarts = 1\n{more}"
        ))
    };
    let outcome = found(&design("field", ""));
    let error = outcome.after.scaled_relative_rmse.unwrap();
    assert!(error < 0.02, "{error}");
    assert!(outcome.tiles.iter().all(|t| t.polarization_t().length() <= 0.12 + 1e-9));
    let steps = std::sync::atomic::AtomicUsize::new(0);
    let layout = design("field", "");
    let count = |progress: Progress| {
        steps.fetch_add(
            usize::from(progress.stage == magsplice_design::Stage::Starts),
            std::sync::atomic::Ordering::Relaxed,
        );
        ControlFlow::Continue(())
    };
    Setting::of(&layout).unwrap().search(&count).unwrap();
    // The step, and at most one more that only rounds off.
    assert!(steps.into_inner() <= 2);
    let fixed = found(&design("field", "stock_strengths_t = [0.0, 0.04, 0.08, 0.12]"));
    for tile in &fixed.tiles {
        let strength = tile.polarization_t().length();
        assert!([0.0, 0.04, 0.08, 0.12].iter().any(|s| (strength - s).abs() < 1e-12), "{strength}");
    }
    // Rounding costs something, and it is said.
    assert!(fixed.after.scaled_relative_rmse.unwrap() > error);
    assert_eq!(fixed.stages.len(), 3);
}

#[test]
fn threads_do_not_matter() {
    let layout = layout(
        "vary = [\"size\", \"direction\"]\nsymmetry = \"four-fold\"\namplitude = { min = 0.7 }\nsmallest_cut_mm = 0.8\nstarts = 4\nseed = 7",
    );
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| found(&layout).tiles)
    };
    assert_eq!(with(1), with(3));
}

#[test]
fn an_interrupted_search_keeps_its_best() {
    let layout = layout("vary = [\"size\"]\nsymmetry = \"mirror\"\nsmallest_cut_mm = 0.8\nstarts = 2");
    let count = std::sync::atomic::AtomicUsize::new(0);
    let stop = |_: Progress| {
        let told = count.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        if told < 5 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    };
    let outcome = Setting::of(&layout).unwrap().search(&stop).unwrap();
    assert!(outcome.interrupted);
    assert_kept(&outcome, 0.8, 10.0);
    assert!(outcome.after.uniformity_rmse.r_x < outcome.before.uniformity_rmse.r_x);
}

#[test]
fn what_cannot_be_designed_is_said() {
    let error = |design: &str| {
        let layout = layout(design);
        Setting::of(&layout).and_then(|setting| setting.search(&go_on)).unwrap_err().to_string()
    };
    let told = error("vary = [\"size\"]\nsmallest_cut_mm = 3.0\nsymmetry = \"four-fold\"\nstarts = 1");
    assert!(told.contains("a side must be at least 3 mm") && told.contains("lattice-1-"), "{told}");
    let told = error("vary = [\"position\"]\noutline_mm = { x = [-5.0, 5.0] }\nstarts = 1");
    assert!(told.contains("must stay within outline_mm, x = [-5.0, 5.0]"), "{told}");
    // What is out of reach is no error: the nearest film, and what it is short of.
    let layout = layout(
        "vary = [\"size\"]\nsymmetry = \"four-fold\"\nsmallest_cut_mm = 0.8\nstarts = 1\namplitude = { min = 5.0 }",
    );
    let outcome = found(&layout);
    assert!(
        outcome.short_of.len() == 1 && outcome.short_of[0].ends_with("must be at least 5"),
        "{:?}",
        outcome.short_of
    );
    assert_kept(&outcome, 0.8, 10.0);
}

#[test]
fn a_film_from_nothing_has_the_published_pattern() {
    let request = Request {
        wavelength_mm: 10.0,
        film_mm: [20.0, 20.0],
        thickness_mm: 1.0,
        remanence_t: 0.12,
        range_mm: [4.0, 4.0],
        distance_mm: [3.0, 5.0],
        smallest_cut_mm: 0.8,
        gap_mm: 0.0,
        least_amplitude: 0.65,
        parts: None,
        goal: Goal::Displacement,
        starts: 1,
        seed: 1,
    };
    let layout = request.layout().unwrap();
    assert_eq!(layout.tiles.len(), 56);
    // 10 / 3 and 10 / 6 where the paper has 3.3 and 1.7.
    let published = Layout::parse(&format!("{TABLES}{PUBLISHED}"), "published").unwrap();
    for (own, other) in layout.bare_tiles().iter().zip(published.bare_tiles()) {
        assert!((own.position() - other.position()).length() < 0.05 && (own.size() - other.size()).length() < 0.06);
        assert!((own.polarization_t() - other.polarization_t()).length() < 1e-15);
    }
    let small = Request { film_mm: [8.0, 20.0], range_mm: [6.0, 5.0], distance_mm: [5.0, 3.0], ..request.clone() };
    let Err(DesignError::Request(problems)) = small.layout() else { panic!("refused") };
    assert_eq!(problems.len(), 1, "{problems:?}");
    let small = Request { film_mm: [8.0, 20.0], range_mm: [6.0, 5.0], ..request.clone() };
    let Err(DesignError::Request(problems)) = small.layout() else { panic!("refused") };
    assert_eq!(problems.len(), 2, "{problems:?}");
    // Odd outlines and rims.
    for width in [8.4, 9.0, 11.7, 13.0, 16.5, 25.1] {
        let layout = Request { film_mm: [width, 20.0], ..request.clone() }.layout().unwrap();
        assert!(layout.tiles.iter().all(|t| t.tile.size().min_element() >= 0.8 - 1e-9), "{width}");
        assert!(layout.tiles.iter().all(|t| t.tile.position().x.abs() + 0.5 * t.tile.size().x <= 0.5 * width + 1e-9));
        Setting::of(&layout).unwrap();
    }
}
