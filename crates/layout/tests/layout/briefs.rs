//! Rules of `[design]`: each value is refused just beyond its limit and accepted at it.

use magsplice_layout::{Brief, Layout, MinMax, Outline, Under};

/// A layout of one tile with these lines of `[volume]` and `[design]`.
fn layout(volume: &str, design: &str) -> Result<Layout, String> {
    let ideal = "[ideal]\nwavelength_mm = 10\nthickness_mm = 1\namplitude_t = 0.12\n";
    let tile = "[[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n";
    let text = format!("format = 1\nname = \"test\"\n{ideal}[volume]\n{volume}\n[design]\n{design}\n{tile}");
    Layout::parse(&text, "test.toml").map_err(|error| error.to_string())
}

const VOLUME: &str = "x_mm = [-2, 2]\ny_mm = [-2, 2]\nz_mm = [-5, -3]\nstep_mm = 0.5";

#[track_caller]
fn accepted(design: &str) -> Brief {
    layout(VOLUME, design).expect("a valid brief").brief.expect("it is given")
}

/// Requires that exactly this rule is broken.
#[track_caller]
fn refused(design: &str, rule: &str) {
    let message = layout(VOLUME, design).expect_err("a broken rule");
    assert!(message.ends_with(rule) && message.lines().count() == 1, "{design:?}: {message}");
}

#[test]
fn lengths_and_weights_have_limits() {
    for key in ["resolution_mm", "resolution_deg", "step_mm", "smallest_cut_mm", "amplitude.min"] {
        accepted(&format!("vary = [\"size\"]\n{key} = 0.5"));
        for value in ["0.0", "-1.0", "inf"] {
            let rule = format!("{key} = {}, must be a finite number greater than 0", value.trim_end_matches(".0"));
            refused(&format!("vary = [\"size\"]\n{key} = {value}"), &rule);
        }
    }
    assert_eq!(accepted("vary = [\"size\"]\ngap_mm = 0.0").gap_mm, 0.0);
    refused("vary = [\"size\"]\ngap_mm = -0.1", "gap_mm = -0.1, must be a finite number of at least 0");
    let weights = |r_x: f64| format!("vary = [\"size\"]\nweights = {{ r_x = {r_x}, r_y = 0, s_z = 0 }}");
    assert_eq!(accepted(&weights(2.0)).weights, [2.0, 0.0, 0.0]);
    refused(&weights(-1.0), "weights.r_x = -1, must be a finite number of at least 0");
    refused(&weights(0.0), "weights are all 0, at least one must be greater than 0");
}

#[test]
fn outlines_are_ranges() {
    let brief = accepted("vary = [\"size\"]\noutline_mm = { x = [-5, 5] }");
    assert_eq!(brief.outline_mm, Outline { x: Some([-5.0, 5.0]), y: None });
    for range in ["[5, 5]", "[5, -5]", "[-inf, 5]", "[-5, inf]"] {
        let rule = format!("outline_mm.y = {range}, must be two finite numbers, the first less than the second");
        refused(&format!("vary = [\"size\"]\noutline_mm = {{ y = {range} }}"), &rule);
    }
}

#[test]
fn ranges_of_thickness_and_strength_are_given_with_the_variable() {
    let given = |variable: &str, key: &str, range: [&str; 2]| {
        format!("vary = [\"{variable}\"]\n{key} = {{ min = {}, max = {} }}", range[0], range[1])
    };
    assert_eq!(
        accepted(&given("thickness", "thickness_mm", ["1", "1"])).thickness_mm,
        Some(MinMax { min: 1.0, max: 1.0 })
    );
    assert_eq!(accepted(&given("strength", "strength_t", ["0", "1"])).strength_t, Some(MinMax { min: 0.0, max: 1.0 }));
    for (variable, key, least, rule) in [
        ("thickness", "thickness_mm", "0", "must be finite with 0 < min <= max"),
        ("strength", "strength_t", "-1", "must be finite with 0 <= min <= max"),
    ] {
        for [min, max] in [[least, "2"], ["2", "1"], ["1", "inf"]] {
            let rule = format!("{key} = {{ min = {min}, max = {max} }}, {rule}");
            refused(&given(variable, key, [min, max]), &rule);
        }
        let rule = format!("vary has {variable}, so {key} = {{ min = ..., max = ... }} must be given");
        refused(&format!("vary = [\"{variable}\"]"), &rule);
    }
}

/// A percentile of the uniformity alone finds films that are weak in slope, so the goal is fixed.
#[test]
fn films_that_are_made_need_errors_and_the_displacement_as_goal() {
    let with_errors = format!("{VOLUME}\n[tolerance]\npreset = \"workshop\"");
    let under = "vary = [\"size\"]\nunder = \"tolerance\"";
    let read = layout(&with_errors, &format!("{under}\ngoal = \"displacement\"")).expect("a valid brief");
    assert_eq!(read.brief.as_ref().expect("a brief").under, Under::Tolerance);
    let written = Layout::parse(&read.to_toml(), "again").expect("it is read again");
    assert_eq!(written.brief, read.brief);
    assert_eq!(accepted("vary = [\"size\"]").under, Under::Nominal);
    assert!(!layout(VOLUME, "vary = [\"size\"]").expect("a brief").to_toml().contains("under"));
    refused(
        &format!("{under}\ngoal = \"displacement\""),
        "under = \"tolerance\" needs the table [tolerance], which the layout does not have: it has the errors of films \
         as made",
    );
    for goal in ["uniformity", "field"] {
        let message = layout(&with_errors, &format!("{under}\ngoal = \"{goal}\"")).expect_err("a broken rule");
        let start = format!("goal = \"{goal}\" with under = \"tolerance\", must be \"displacement\": ");
        assert!(message.contains(&start) && message.lines().count() == 1, "{message}");
    }
}

#[test]
fn variables_exclude_each_other() {
    refused("vary = []", "cut, thickness, direction, tilt, strength, head");
    accepted("vary = [\"cut\", \"direction\"]");
    for other in ["size", "position"] {
        refused(&format!("vary = [\"cut\", \"{other}\"]"), "must have only one of the two");
    }
}

#[test]
fn parts_need_free_sizes_and_stay_in_the_plane() {
    let free = "vary = [\"size\", \"position\"]\n";
    let stock = "stock = [{ size_mm = [3, 2], direction_deg = 45 }]\n";
    for wanted in ["parts = 2", stock] {
        for names in ["\"size\"", "\"position\""] {
            refused(&format!("vary = [{names}]\n{wanted}"), "the search exchanges sizes");
        }
        accepted(&format!("{free}{wanted}"));
        refused(
            &format!("vary = [\"size\", \"position\", \"tilt\"]\n{wanted}"),
            "parts are polarized in the film plane",
        );
    }
    refused(&format!("{free}parts = 0"), "parts = 0, must be at least 1");
    let two = "stock = [{ size_mm = [3, 2], direction_deg = 45 }, { size_mm = [3, 3], direction_deg = 0 }]";
    assert_eq!(accepted(&format!("{free}parts = 2\n{two}")).parts, Some(2));
    refused(&format!("{free}parts = 1\n{two}"), "parts = 1, must not be less than the 2 parts of the stock");
    for side in ["0.0", "-1.0", "inf"] {
        let rule = format!("stock[0].size_mm = [{side}, 2.0], must be two finite numbers greater than 0");
        refused(&format!("{free}stock = [{{ size_mm = [{side}, 2], direction_deg = 45 }}]"), &rule);
    }
    refused(
        &format!("{free}stock = [{{ size_mm = [1, 2], direction_deg = nan }}]"),
        "stock[0].direction_deg = NaN, must be a finite number",
    );
    refused(&format!("{free}stock_strengths_t = [1.2]"), "stock_strengths_t is given, so vary must have strength");
}

#[test]
fn points_of_the_search_are_limited() {
    let volume = "x_mm = [-49.5, 49.5]\ny_mm = [-49.5, 49.5]\nz_mm = [-12, -3]\nstep_mm = 3";
    let points = |step: &str| layout(volume, &format!("vary = [\"size\"]\nstep_mm = {step}"));
    points("1.0").expect("100 by 100 by 10 points");
    let message = points("0.99").expect_err("more points");
    let rule = "step_mm = 0.99 makes 1.029e5 points in the working volume, must make at most 1e5";
    assert!(message.ends_with(rule), "{message}");
}

#[test]
fn starts_are_limited() {
    for starts in [1, 10_000] {
        assert_eq!(accepted(&format!("vary = [\"size\"]\nstarts = {starts}")).starts, starts);
    }
    for starts in [0, 10_001] {
        let rule = format!("starts = {starts}, must be from 1 to 10000");
        refused(&format!("vary = [\"size\"]\nstarts = {starts}"), &rule);
    }
}

/// A written layout is read as it was.
#[test]
fn briefs_and_expectations_are_written_as_they_are_read() {
    let volumes = ["step_mm = 0.5", "step_mm = [0.5, 0.5, 0.25]", "step_mm = [0.5, 0.25, 0.5]"];
    let briefs = [
        "vary = [\"size\"]",
        "vary = [\"cut\"]\noutline_mm = { x = [-5, 5] }",
        "vary = [\"strength\", \"direction\"]\nstrength_t = { min = 0, max = 1 }\noutline_mm = { y = [-5, 5] }",
    ];
    let expectations = [
        "",
        "[expect]\namplitude = { min = 0.5 }",
        "[expect.displacement_rmse_mm]\nx = 1",
        "[expect.uniformity_rmse]\ns_z = 1",
    ];
    let ranges = "x_mm = [-2, 2]\ny_mm = [-2, 2]\nz_mm = [-5, -3]";
    for volume in volumes {
        for brief in briefs {
            for expect in expectations {
                let read = layout(&format!("{ranges}\n{volume}"), &format!("{brief}\n{expect}")).expect("valid");
                let again = Layout::parse(&read.to_toml(), "again.toml").expect("valid");
                assert_eq!(
                    (&again.volume, &again.expectations, &again.brief),
                    (&read.volume, &read.expectations, &read.brief)
                );
                assert_eq!(again.bare_tiles(), read.bare_tiles());
                assert_eq!(again.bare_tiles().len(), 1);
            }
        }
    }
}

#[test]
fn other_formats_are_refused() {
    let text = "format = 2\nname = \"test\"\n[[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n";
    let message = Layout::parse(text, "test.toml").expect_err("an unknown format").to_string();
    assert!(message.ends_with("format = 2, must be 1, the only version supported"), "{message}");
}
