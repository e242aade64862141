//! Layouts with `[tolerance]` as they are written, and files beside them.

use super::*;

/// Asserts that a layout is read again with the same errors of each tile and group, from the plain
/// and the compact form.
#[track_caller]
pub(crate) fn assert_is_written(layout: &Layout, folder: &std::path::Path) {
    let wanted = layout.tolerance.as_ref().expect("stated");
    let again = |text: &str| Layout::parse_beside(text, "again", folder).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let plain = again(&layout.to_toml());
    assert_eq!(plain.tolerance.as_ref(), Some(wanted), "{}", layout.to_toml());
    assert_eq!(plain.expectations, layout.expectations);
    let text = layout.to_compact_toml();
    let compact = again(&text);
    let found = compact.tolerance.as_ref().expect("stated");
    assert_eq!(compact.expectations, layout.expectations);
    assert_eq!((&found.common, found.samples, found.seed), (&wanted.common, wanted.samples, wanted.seed), "{text}");
    // The tiles have another order.
    let place = |index: usize| {
        let tile = layout.tiles[index].tile;
        compact.tiles.iter().position(|named| named.tile == tile).expect("the same tile")
    };
    let places: Vec<usize> = (0..layout.tiles.len()).map(place).collect();
    for (index, errors) in wanted.tiles.iter().enumerate() {
        assert_eq!(&found.tiles[places[index]], errors, "{}", layout.tiles[index].name);
    }
    assert_eq!(found.groups.len(), wanted.groups.len());
    for (found, wanted) in found.groups.iter().zip(&wanted.groups) {
        let mut tiles: Vec<usize> = wanted.tiles.iter().map(|&tile| places[tile]).collect();
        tiles.sort_unstable();
        assert_eq!((&found.name, &found.tiles, &found.errors), (&wanted.name, &tiles, &wanted.errors));
    }
}

#[test]
fn layouts_are_written_with_their_tolerances() {
    let folder = tempfile::tempdir().expect("a folder");
    for tables in [
        "[tolerance]".to_owned(),
        "[tolerance]\npreset = \"by-hand\"\nsamples = 123\nseed = 456".to_owned(),
        COMMON.to_owned(),
        "[tolerance.stray_field]\nwhen = \"after\"".to_owned(),
        "[tolerance.iron]\ndistance_mm = 1.5".to_owned(),
        "[tolerance.iron]\ndistance_mm = 1.5\ndistance_error_mm = { uniform = 0.5 }\nnormal = [0.1, 0, -2]\n\
         relative_permeability = 900\nwhen = \"before\""
            .to_owned(),
        // Each error differs in one tile from that of the others.
        "[tolerance]\nposition_mm = 0.05\nrotation_deg = 0.4\nsize_mm = 0.03\nstrength = 0.02\ndirection_deg = 0.6\n\
         [[tolerance.tile]]\ntiles = [\"bar\"]\nposition_mm = 0.01\nrotation_deg = 0.1\nsize_mm = 0.015\n\
         strength = 0.005\ndirection_deg = 0.25"
            .to_owned(),
        format!(
            "[tolerance]\nposition_mm = [0.05, {{ uniform = 0.1 }}, {{ fixed = -0.01 }}]\nrotation_deg = {{ normal = 0.7, within = 1.1 }}\n\
             direction_deg = {{ values = [0.3, -0.1, 1.7] }}\n\
             [tolerance.kind.square]\nstrength = 0.02\n[[tolerance.tile]]\ntiles = [\"corner*\", \"bar\"]\nposition_mm = 0.1\n\
             [[tolerance.tile]]\ntiles = [\"bar-my\"]\nrotation_deg = 0\n\
             [[tolerance.group]]\nname = \"rows\"\nrows_along = \"x\"\nposition_mm = [0.1, 0, 0]\nrotation_deg = [0, 0, 0.2]\n\
             [[tolerance.group]]\neach = \"kind\"\nstrength = 0.01\n[[tolerance.group]]\ntiles = [\"bar*\"]\nsize_mm = 0\n{COMMON}\n\
             [expect.made]\namplitude = {{ min = 0.8 }}"
        ),
    ] {
        assert_is_written(&parse(&tables).unwrap_or_else(|e| panic!("{tables}: {e}")), folder.path());
    }
}

#[test]
fn asterisks_in_names_of_tiles_are_these_names() {
    let tile = |name: &str, x: f64| {
        format!(
            "[[tile]]\nname = \"{name}\"\nposition_mm = [{x}, 0, 20]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n"
        )
    };
    let tables =
        format!("[[tolerance.tile]]\ntiles = [\"a*\"]\nstrength = 0.1\n{}{}", tile("a*", 0.0), tile("ab", 5.0));
    let layout = parse(&tables).expect("valid");
    let with: Vec<&str> = layout
        .tiles
        .iter()
        .zip(&layout.tolerance.as_ref().expect("stated").tiles)
        .filter(|(_, errors)| !errors.strength.is_none())
        .map(|(tile, _)| tile.name.as_str())
        .collect();
    assert_eq!(with, ["a*"]);
    assert_is_written(&layout, std::path::Path::new(""));
}

#[test]
fn files_beside_the_layout_give_measured_errors_and_a_neighbour() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("written");
    write("measured.csv", "# laid by hand\nn;dx_mm;turn_deg\n1;0.02;0.5\n2;-0.03;-1\n");
    write(
        "other.toml",
        &format!(
            "{HEAD}[tolerance]\nposition_mm = {{ file = \"none.csv\" }}\n[[tile]]\nposition_mm = [1, 2, 0.5]\nsize_mm = [3, 2, 1]\npolarization_t = [0.1, 0, 0]\n"
        ),
    );
    let tables = "[tolerance]\nposition_mm = [{ file = \"measured.csv\", column = \"dx_mm\" }, 0, 0]\n\
        rotation_deg = { file = \"measured.csv\", column = \"turn_deg\" }\n\
        [tolerance.neighbour]\nlayout = \"other.toml\"\nposition_mm = [0, 0, -12]\n\
        rotation = { axis = [0, 1, 0], angle_deg = 180 }\nwhen = \"after\"";
    write("film.toml", &text(tables));
    let layout = Layout::read(folder.path().join("film.toml")).expect("valid");
    let found = layout.tolerance.as_ref().expect("stated");
    assert_eq!(found.tiles[3].position[0], Distribution::Tabulated([-0.03, 0.02].into()));
    let turns = [(-1.0_f64).to_radians(), 0.5_f64.to_radians()];
    assert_eq!(found.tiles[3].rotation[2], Distribution::Tabulated(turns.into()));
    let neighbour = found.common.neighbour.as_ref().expect("stated");
    assert!(neighbour.later && neighbour.layout == "other.toml" && neighbour.tiles.len() == 1);
    let tile = neighbour.tiles[0];
    assert!((tile.position() - DVec3::new(-1.0, 2.0, -12.5)).length() < 1e-12, "{tile:?}");
    assert!((tile.scene_polarization_t() - DVec3::new(-0.1, 0.0, 0.0)).length() < 1e-15, "{tile:?}");
    assert_is_written(&layout, folder.path());
    // From a text, paths are relative to the folder of its file.
    let origin = folder.path().join("film.toml").display().to_string();
    assert_eq!(Layout::parse(&text(tables), &origin).expect("valid").tolerance, layout.tolerance);
    assert!(Layout::parse(&text(tables), "film.toml").is_err());

    write("bad.csv", "a,b\n1,2\n3,x\n");
    write(
        "bad.toml",
        "format = 1\nname = \"bad\"\n[[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [1, 0, 1]\npolarization_t = [0, 0, 1]\n",
    );
    write("broken.toml", "format = 1\nname = \n");
    for (tables, rule) in [
        (
            "[tolerance]\nstrength = { file = \"bad.csv\", column = \"b\" }",
            "line 13: tolerance: strength: file \"bad.csv\": line 3: \"x\", must be a number",
        ),
        ("[tolerance]\nstrength = { file = \"bad.csv\", column = \"c\" }", "line 1: has no column \"c\""),
        (
            "[tolerance]\nposition_mm = { file = \"measured.csv\", column = \"turn_deg\" }",
            "column \"turn_deg\" is in degrees, must be in mm",
        ),
        ("[tolerance]\nstrength = { file = \".\" }", "file \".\": cannot be read: it is not a regular file"),
        (
            "[tolerance.neighbour]\nlayout = \"bad.toml\"\nposition_mm = [0, 0, -12]",
            "layout = \"bad.toml\": is refused: line 3: tile \"tile-1\": size_mm[1] = 0, must be greater than 0",
        ),
        (
            "[tolerance.neighbour]\nlayout = \"broken.toml\"\nposition_mm = [0, 0, -12]",
            "layout = \"broken.toml\": is refused: broken.toml: TOML parse error at line 2",
        ),
        ("[tolerance.neighbour]\nlayout = \"other.toml\"", "has no position_mm, the place of its origin"),
        (
            "[tolerance.neighbour]\nlayout = \"other.toml\"\nposition_mm = [0, inf, 0]",
            "position_mm = [0.0, inf, 0.0], must be three finite numbers",
        ),
        (
            "[tolerance.neighbour]\nlayout = \"other.toml\"\nposition_mm = [0, 0, 0]\nrotation = {}",
            "rotation gives nothing",
        ),
    ] {
        write("film.toml", &text(tables));
        let message = Layout::read(folder.path().join("film.toml")).expect_err(tables).to_string();
        assert!(message.contains(rule) && message.lines().count() == 1, "{tables:?}: {message}");
    }
    // A layout may be its own neighbour.
    write("film.toml", &text("[tolerance.neighbour]\nlayout = \"film.toml\"\nposition_mm = [0, 0, -12]"));
    let twice = Layout::read(folder.path().join("film.toml")).expect("valid").tolerance.expect("stated");
    assert_eq!(twice.common.neighbour.expect("stated").tiles.len(), 8);
}

#[test]
fn errors_of_omitted_tiles_are_omitted() {
    let mut found = tolerance(
        "[tolerance]\nstrength = 0.01\n[[tolerance.tile]]\ntiles = [\"bar\"]\nstrength = 0.02\n\
         [[tolerance.group]]\nname = \"a\"\ntiles = [\"corner\", \"bar\"]\nstrength = 0.1\n\
         [[tolerance.group]]\nname = \"b\"\ntiles = [\"corner\"]\nstrength = 0.1",
    );
    assert_eq!(found.groups[0].tiles, [0, 4]);
    found.retain_tiles(|index| index != 0 && index != 2);
    assert_eq!(found.tiles.len(), 6);
    assert_eq!(found.tiles[2].strength, Distribution::normal(0.02));
    assert_eq!(found.groups.len(), 1);
    assert_eq!((found.groups[0].name.as_str(), &found.groups[0].tiles[..]), ("a", &[2][..]));
}
