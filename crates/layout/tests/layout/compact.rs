//! Layouts written compactly read back as the same tiles.

use magsplice_layout::{COMMENTED_LAYOUT, Layout};

fn parsed(text: &str) -> Layout {
    Layout::parse(text, "test").unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// The tiles as text, in an order of their own.
fn tiles(layout: &Layout) -> Vec<String> {
    let mut tiles: Vec<String> = layout
        .tiles
        .iter()
        .map(|named| format!("{:?}", named.tile).replace("-0.0,", "0.0,").replace("-0.0)", "0.0)"))
        .collect();
    tiles.sort();
    tiles
}

fn tile(keys: &str) -> String {
    format!("format = 1\nname = \"film\"\n[[tile]]\nposition_mm = [1, 2, 0.5]\nsize_mm = [1, 2, 1]\n{keys}\n")
}

#[test]
fn compact_layouts_have_the_same_tiles() {
    let odd = "polarization_t = [0.123456789012345, -0.03, 0.01]\nmirror = { axes = [\"x\", \"y\"] }";
    let kept = "polarization_t = [0.1, 0.02, 0]\nmirror = { axes = [\"x\"], polarization = \"keep\" }";
    let turned =
        "polarization_t = [0.1, 0.02, 0]\nrotation = { axis = [0, 0, 1], angle_deg = 10 }\nmirror = { axes = [\"y\"] }";
    let tilted = "strength_t = 0.12\ndirection_deg = 121.5\ntilt_deg = -12.25\nmirror = { axes = [\"y\"] }";
    for text in [COMMENTED_LAYOUT.to_owned(), tile(odd), tile(kept), tile(turned), tile(tilted)] {
        let layout = parsed(&text);
        let compact = layout.to_compact_toml();
        let again = parsed(&compact);
        assert_eq!(tiles(&again), tiles(&layout), "{compact}");
        assert_eq!(
            (again.volume, &again.brief, &again.expectations),
            (layout.volume, &layout.brief, &layout.expectations)
        );
        assert!(compact.lines().all(|line| line.matches("position_mm").count() <= 1));
        // Writing again changes nothing.
        assert_eq!(again.to_compact_toml(), compact);
    }
    let compact = parsed(&tile(tilted)).to_compact_toml();
    assert!(compact.contains("strength_t = 0.12, direction_deg = 121.5, tilt_deg = -12.25, mirror"), "{compact}");
    assert!(parsed(&tile(odd)).to_compact_toml().contains("polarization_t = [0.123456789012345, -0.03, 0.01]"));
}

/// All tables besides the tiles survive, and so do the lines above them.
#[test]
fn compact_layouts_have_the_same_tables() {
    let text = tile("strength_t = 0.12\ndirection_deg = 30").replace(
        "[[tile]]",
        "description = \"by hand\"\nhistory = [\"drawn\", \"typed\"]\n[material]\nstrength_per_k = -0.001\n\
         [sensor]\nnoise_ut = 5\n[elastomer]\narea_mm2 = 1\nthickness_mm = 1\nyoungs_modulus_mpa = 1\n\
         poisson_ratio = 0.5\n[tolerance]\nstrength = 0.01\n[[tile]]",
    );
    let layout = parsed(&text);
    let compact = layout.to_compact_toml();
    // The lines above the tables come before the tiles.
    let (head, _) = compact.split_once("tile = [").expect("tiles");
    assert!(["format = ", "name = ", "description = ", "history = "].iter().all(|key| head.contains(key)), "{compact}");
    let again = parsed(&compact);
    assert_eq!((&again.name, &again.description, &again.history), (&layout.name, &layout.description, &layout.history));
    assert_eq!(layout.history, ["drawn", "typed"]);
    assert_eq!((again.sensor, again.elastomer, again.tolerance), (layout.sensor, layout.elastomer, layout.tolerance));
    assert_eq!(again.material, layout.material);
}

#[test]
fn directions_in_degrees_are_checked() {
    let j = parsed(&tile("strength_t = 0.12\ndirection_deg = 30")).tiles[0].tile.polarization_t();
    assert!((j.x - 0.06 * 3_f64.sqrt()).abs() < 1e-16 && (j.y - 0.06).abs() < 1e-16 && j.z == 0.0, "{j}");
    for (keys, message) in [
        ("strength_t = 0.12\ndirection_deg = inf", "direction_deg = inf, must be a finite number"),
        ("strength_t = 0.12\ndirection_deg = 1\ntilt_deg = nan", "tilt_deg = NaN, must be a finite number"),
        ("strength_t = 0.12\ntilt_deg = 1\ndirection = [1, 0, 0]", "gives a tilt_deg, which goes with direction_deg"),
        ("strength_t = 1\ndirection_deg = 1\ndirection = [1, 0, 0]", "gives both direction and direction_deg"),
        ("polarization_t = [1, 0, 0]\ndirection_deg = 1", "gives a direction, which goes with strength_t"),
        ("strength_t = 0.12", "has a strength_t and no direction or direction_deg"),
    ] {
        let error = Layout::parse(&tile(keys), "test").expect_err(keys).to_string();
        assert!(error.contains(message), "{message:?} is not in {error}");
    }
}

/// Sizes and strengths that tiles share are written once, below a blank line, and mirror images on
/// a zero coordinate are found whichever sign the zero has.
#[test]
fn compact_layouts_share_kinds_and_images() {
    let text = "format = 1\nname = \"film\"\n\
        [[tile]]\nname = \"a\"\nposition_mm = [-0.0, 5, 0]\nsize_mm = [2, 1, 1]\nstrength_t = 0.12\ndirection_deg = 90\n\
        [[tile]]\nname = \"a-my\"\nposition_mm = [0, -5, 0]\nsize_mm = [2, 1, 1]\nstrength_t = 0.12\ndirection_deg = -90\n\
        [[tile]]\nname = \"b\"\nposition_mm = [5, 5, 0]\nsize_mm = [2, 1, 1]\nstrength_t = 0.12\ndirection_deg = 0\n";
    let written = parsed(text).to_compact_toml();
    assert_eq!(written.matches("size_mm").count(), 1, "{written}");
    assert!(written.contains("\n\nkind.kind-1 = {"), "{written}");
    assert!(written.contains("mirror = { axes = [\"y\"] }"), "{written}");
    assert_eq!(tiles(&parsed(&written)).len(), 3);
}
