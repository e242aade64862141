//! Layouts to begin with have the pattern that was published, and the demands of the request.

use magsplice_design::{DesignError, DesignProblem, Shortfall, SpliceChange, SpliceRequest, ignore_progress};
use magsplice_layout::{Brief, Goal, Layout, Outline, Preset, StatedSensor, Symmetry, Under, Variable};
use magsplice_magnet::Tile;

use crate::search::PUBLISHED;

fn request() -> SpliceRequest {
    SpliceRequest {
        name: Some("pad of a finger".to_owned()),
        wavelength_mm: 12.0,
        film_mm: [24.0, 30.0],
        thickness_mm: 1.5,
        remanence_t: 0.2,
        range_mm: [4.0, 3.0],
        distance_mm: [3.0, 5.0],
        smallest_cut_mm: 0.9,
        preset: Some(Preset::Jig),
        one_sided: false,
        sensor: StatedSensor::of_part("MLX90393"),
        head: None,
        brief: Brief {
            gap_mm: 0.05,
            resolution_mm: 0.02,
            resolution_deg: 0.5,
            least_amplitude: Some(0.6),
            parts: Some(7),
            goal: Goal::Displacement,
            starts: 17,
            seed: 23,
            ..Default::default()
        },
    }
}

/// Both tables survive a file.
#[test]
fn layout_has_the_errors_and_the_sensor_of_the_request() {
    let layout = request().layout().unwrap_or_else(|e| panic!("{e}"));
    let read = Layout::parse(&layout.to_toml(), "spliced").unwrap_or_else(|e| panic!("{e}"));
    for layout in [layout, read] {
        assert_eq!(layout.name, "pad of a finger");
        let tolerance = layout.tolerance.expect("errors");
        assert_eq!(tolerance.tiles.len(), layout.tiles.len());
        assert!(tolerance.tiles.iter().all(|errors| *errors == Preset::Jig.errors()));
        assert_eq!(layout.sensor, StatedSensor::of_part("MLX90393"));
    }
    let bare = SpliceRequest::new(10.0, [20.0, 20.0]).layout().unwrap_or_else(|e| panic!("{e}"));
    assert_eq!((bare.tolerance, bare.sensor), (None, None));
}

/// A one-sided film has iron at a tenth of the wavelength among its errors, alone or beside those
/// of the tiles, and directions out of the plane.
#[test]
fn one_sided_films_are_designed_for_iron() {
    for preset in [None, Some(Preset::Jig)] {
        let of_parts = SpliceRequest { one_sided: true, preset, ..request() };
        let refused = of_parts.layout().expect_err("parts in the plane").to_string();
        assert!(refused.contains("parts: 7 with one-sided, must be left out"), "{refused}");
        let request = SpliceRequest { brief: Brief { parts: None, ..of_parts.brief.clone() }, ..of_parts };
        let layout = request.layout().unwrap_or_else(|e| panic!("{e}"));
        let read = Layout::parse(&layout.to_toml(), "spliced").unwrap_or_else(|e| panic!("{e}"));
        for layout in [layout, read] {
            let tolerance = layout.tolerance.expect("errors");
            let iron = tolerance.common.iron.expect("iron");
            assert_eq!((iron.distance_mm, iron.later, tolerance.tiles.is_empty()), (1.2, true, preset.is_none()));
            let brief = layout.brief.expect("a brief");
            assert!(brief.under == Under::Tolerance && brief.vary.contains(&Variable::Tilt));
        }
    }
}

fn brief(request: &SpliceRequest) -> Brief {
    request.layout().unwrap_or_else(|e| panic!("{e}")).brief.expect("a brief")
}

/// Each demand of the request differs from the value that a brief has without it.
#[test]
fn brief_has_the_demands_of_the_request() {
    let Brief {
        vary,
        symmetry,
        goal,
        under,
        weights,
        least_amplitude,
        outline_mm,
        smallest_cut_mm,
        gap_mm,
        resolution_mm,
        resolution_deg,
        parts,
        stock,
        stock_strengths_t,
        starts,
        seed,
        ..
    } = brief(&request());
    assert_eq!((goal, under, weights), (Goal::Displacement, Under::Nominal, [1.0; 3]));
    assert_eq!((least_amplitude, smallest_cut_mm, gap_mm), (Some(0.6), Some(0.9), 0.05));
    assert_eq!((resolution_mm, resolution_deg), (0.02, 0.5));
    assert_eq!((parts, starts, seed), (Some(7), 17, 23));
    assert!(stock.is_empty() && stock_strengths_t.is_empty());
    // Half of the extents, because the film is centred on 0.
    assert_eq!(outline_mm, Outline { x: Some([-12.0, 12.0]), y: Some([-15.0, 15.0]) });
    // Shapes and directions are free. Cut lines, heights and J are the user's.
    assert_eq!(vary, [Variable::Size, Variable::Position, Variable::Direction].into());
    assert_eq!(symmetry, Symmetry::Mirror);
}

/// x and y can be exchanged only if neither the film nor the working volume tells them apart.
#[test]
fn square_films_over_square_ranges_are_four_fold() {
    let square = SpliceRequest { film_mm: [24.0, 24.0], range_mm: [4.0, 4.0], ..request() };
    assert_eq!(brief(&square).symmetry, Symmetry::FourFold);
    let over_a_strip = SpliceRequest { range_mm: [4.0, 3.0], ..square.clone() };
    assert_eq!(brief(&over_a_strip).symmetry, Symmetry::Mirror);
    let oblong = SpliceRequest { film_mm: [24.0, 30.0], ..square };
    assert_eq!(brief(&oblong).symmetry, Symmetry::Mirror);
}

#[test]
fn splice_request_has_the_published_pattern() {
    let mut request = SpliceRequest::new(10.0, [20.0, 20.0]);
    request.brief.starts = 1;
    let layout = request.layout().unwrap();
    assert_eq!(layout.tiles.len(), 56);
    // Intervals are 10 / 3 and 10 / 6 mm wide, where the paper has 3.3 and 1.7.
    let published = Layout::parse(&format!("format = 1\nname = \"film\"\n{PUBLISHED}"), "published").unwrap();
    for own in layout.bare_tiles() {
        let is_there = |other: &Tile| (own.position() - other.position()).length() < 0.05;
        let other = published.bare_tiles().into_iter().find(is_there).expect("a tile there");
        assert!((own.size() - other.size()).length() < 0.06);
        assert!((own.polarization_t() - other.polarization_t()).length() < 1e-15);
    }
    let small =
        SpliceRequest { film_mm: [8.0, 20.0], range_mm: [6.0, 5.0], distance_mm: [5.0, 3.0], ..request.clone() };
    let Err(DesignError::Request(problems)) = small.layout() else { panic!("refused") };
    assert_eq!(problems.len(), 1, "{problems:?}");
    let small = SpliceRequest { film_mm: [8.0, 20.0], range_mm: [6.0, 5.0], ..request.clone() };
    let Err(DesignError::Request(problems)) = small.layout() else { panic!("refused") };
    assert_eq!(problems.len(), 2, "{problems:?}");
    let brief = Brief { seed: u64::MAX, ..request.brief.clone() };
    let large = SpliceRequest { brief, ..request.clone() };
    let Err(DesignError::Request(problems)) = large.layout() else { panic!("refused") };
    assert!(problems[0].to_string().starts_with("seed: 18446744073709551615, must be at most"), "{problems:?}");
    // Outlines that leave narrow rims.
    for width in [8.4, 9.0, 11.7, 13.0, 16.5, 25.1] {
        let layout = SpliceRequest { film_mm: [width, 20.0], ..request.clone() }.layout().unwrap();
        assert!(layout.tiles.iter().all(|t| t.tile.size().min_element() >= 0.8 - 1e-9), "{width}");
        assert!(layout.tiles.iter().all(|t| t.tile.position().x.abs() + 0.5 * t.tile.size().x <= 0.5 * width + 1e-9));
        DesignProblem::new(&layout).unwrap();
    }
}

/// A film too small for its distance: its errors are above a tenth of the travel. A larger film is
/// enough.
fn too_small() -> SpliceRequest {
    let default = SpliceRequest::new(8.0, [7.0, 7.0]);
    let brief = Brief { starts: 1, ..default.brief.clone() };
    SpliceRequest { smallest_cut_mm: 2.0, distance_mm: [6.0, 9.0], brief, ..default }
}

#[test]
fn useless_film_misses_a_demand_along_each_axis_that_counts() {
    let missed = |request: &SpliceRequest, weights| {
        let mut layout = request.layout().unwrap_or_else(|e| panic!("{e}"));
        layout.brief.as_mut().expect("a brief").weights = weights;
        let result = DesignProblem::new(&layout).and_then(|problem| problem.search(&ignore_progress));
        let of_axis = |short: &Shortfall| match short {
            Shortfall::Travel { axis, error_mm, travel_mm, .. } => {
                assert!(*error_mm > 0.1 * travel_mm, "{short}");
                axis.index()
            }
            other => panic!("{other}"),
        };
        result.unwrap_or_else(|e| panic!("{e}")).short_of.iter().map(of_axis).collect::<Vec<_>>()
    };
    assert_eq!(missed(&too_small(), [1.0; 3]), [0, 1, 2]);
    assert_eq!(missed(&too_small(), [1.0, 1.0, 0.0]), [0, 1]);
    assert_eq!(missed(&too_small().changed(SpliceChange::FilmMm([11.0; 2])), [1.0; 3]), [0; 0]);
}

#[test]
fn trials_find_the_number_in_the_way() {
    let trials = too_small().trials(&ignore_progress);
    let enough: Vec<SpliceChange> = trials.iter().filter(|trial| trial.is_enough).map(|trial| trial.change).collect();
    assert_eq!(enough, [SpliceChange::FilmMm([11.0, 11.0])]);
    assert_eq!((trials.len(), trials[0].change), (6, SpliceChange::Starts(32)));
    assert!(!trials[0].is_enough);
    // The first update stops the first search.
    assert_eq!(too_small().trials(&|_| std::ops::ControlFlow::Break(())), []);
}
