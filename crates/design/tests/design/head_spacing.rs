//! Searches that vary the spacing of the head.

use magsplice_design::{DesignError, DesignProblem, SearchResult, ignore_progress};
use magsplice_layout::{Layout, LayoutError};

/// A film of four tiles below a head.
fn film(sensor: &str, design: &str) -> Result<Layout, LayoutError> {
    let text = format!(
        "format = 1\nname = \"film\"\n[ideal]\nwavelength_mm = 10.0\nthickness_mm = 1.0\namplitude_t = 0.12\n\
         [volume]\nx_mm = [-1.0, 1.0]\ny_mm = [-1.0, 1.0]\nz_mm = [-4.0, -3.0]\nstep_mm = 1.0\n\
         [sensor]\n{sensor}\n[design]\ngoal = \"displacement\"\nsymmetry = \"four-fold\"\nstarts = 1\n{design}\n\
         under = \"tolerance\"\noutline_mm = {{ x = [-6.0, 6.0], y = [-6.0, 6.0] }}\n\
         [tolerance]\nsamples = 200\n[tolerance.sensor]\nposition_mm = 0.03\nrotation_deg = 0.5\ngain = 0.01\n\
         [[tile]]\nposition_mm = [2.5, 2.5, 0.5]\nsize_mm = [3.3, 3.3, 1.0]\npolarization_t = [0.085, 0.085, 0.0]\n\
         mirror = {{ axes = [\"x\", \"y\"] }}\n"
    );
    Layout::parse(&text, "film")
}

fn found(layout: &Layout) -> (Layout, SearchResult) {
    let problem = DesignProblem::new(layout).unwrap_or_else(|e| panic!("{e}"));
    let result = problem.search(&ignore_progress).unwrap_or_else(|e| panic!("{e}"));
    (problem.designed_layout(&result, "test"), result)
}

/// The film for the best spacing is no worse than films found for 7 fixed ones, with the tiles
/// free and without.
#[test]
fn the_best_spacing_of_a_head_is_found() {
    for (tiles, bounds) in [("\"size\", \"position\", ", [0.5, 6.5]), ("", [0.5, 6.5])] {
        let [min, max] = bounds;
        let varied = format!("vary = [{tiles}\"head\"]\nspacing_mm = {{ min = {min}, max = {max} }}");
        let start = film("head = \"pair-z\"\nspacing_mm = 3.5", &varied).unwrap_or_else(|e| panic!("{e}"));
        let (layout, result) = found(&start);
        let fixed: Vec<f64> = (0..=6)
            .map(|step| {
                let spacing_mm = min + (max - min) * f64::from(step) / 6.0;
                let sensor = format!("head = \"pair-z\"\nspacing_mm = {spacing_mm}");
                // Without free tiles, the errors are those of the film as it is.
                let vary =
                    format!("vary = [{}]", if tiles.is_empty() { "\"strength\"" } else { "\"size\", \"position\"" });
                let bound = "strength_t = { min = 0.12, max = 0.12 }";
                found(&film(&sensor, &format!("{vary}\n{bound}")).unwrap_or_else(|e| panic!("{e}"))).1.error
            })
            .collect();
        let (least, most) = fixed.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), of| (a.min(*of), b.max(*of)));
        println!("{} at {:?}, {fixed:?}", result.error, result.spacing_mm);
        assert!(most > 1.2 * least, "the spacing matters: {fixed:?}");
        // The search minimizes the mean square of made films, not the percentile.
        assert!(result.error < 1.05 * least, "{} at {:?}, {fixed:?}", result.error, result.spacing_mm);
        // The layout has the spacing, rounded to the resolution, and is read again with its error.
        assert_eq!(layout.head_spacing_mm(), result.spacing_mm);
        let spacing_um = 1e3 * result.spacing_mm.expect("a spacing");
        assert!((spacing_um - spacing_um.round()).abs() < 1e-6 && (1e3 * min..=1e3 * max).contains(&spacing_um));
        let text = layout.to_toml();
        let again = Layout::parse(&text, "film").unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(again.head(), layout.head());
    }
}

#[test]
fn heads_without_a_spacing_do_not_vary() {
    let vary = "vary = [\"head\"]\nspacing_mm = { min = 1.0, max = 4.0 }";
    for sensor in ["", "head = \"reskin\"", "element = [{ position_mm = [0, 0, 0] }, { position_mm = [0, 0, -1] }]"] {
        let layout = film(sensor, vary).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(DesignProblem::new(&layout).err(), Some(DesignError::NoSpacing), "{sensor}");
    }
    let error = film("head = \"pair-z\"\nspacing_mm = 1.0", "vary = [\"head\"]").expect_err("refused").to_string();
    assert!(error.contains("vary has head, so spacing_mm = { min = ..., max = ... } must be given"), "{error}");
}
