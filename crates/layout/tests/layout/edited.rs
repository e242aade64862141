//! Layouts that were changed, written into the text from which they were read.

use std::fs;

use glam::DVec3;
use magsplice_decouple::PerParameter;
use magsplice_layout::{Brief, COMMENTED_LAYOUT, Goal, Layout, TileForm};
use magsplice_magnet::Tile;

const FILM: &str = r#"# A film by hand.
format = 1            # the only one
name = "pair"         # as ordered
history = [
    "drawn",          # on paper
    "typed",
]

# The film to compare with.
[ideal]
amplitude_t = 0.12    # m0
wavelength_mm = 10
thickness_mm = 1

[volume]
x_mm = [-1, 1]
y_mm = [-1, 1]
z_mm = [-5, -4]       # below
step_mm = 0.5

# Two tiles.
[[tile]]
name = "left"         # the first
position_mm = [-1, 0, 0.5]
size_mm = [2, 2, 1]
polarization_t = [0.1, 0, 0]

[[tile]]
name = "right"
position_mm = [2, 0, 0.5]
size_mm = [2, 2, 1]
polarization_t = [0.1, 0.05, 0]

# Requirements.
[expect]
uniformity_rmse = { r_x = 0.07, r_y = 0.07 }  # angles
amplitude = { min = 0.8 }                     # fraction

# The end.
"#;

fn film() -> Layout {
    Layout::parse(FILM, "film").unwrap_or_else(|e| panic!("{e}"))
}

#[track_caller]
fn written(layout: &Layout, form: TileForm) -> String {
    let text = layout.to_edited_toml(form, "", "edited").unwrap_or_else(|e| panic!("{e}"));
    let read = Layout::parse(&text, "edited").unwrap_or_else(|e| panic!("{e}\n{text}"));
    let whole = if form == TileForm::Plain { layout.to_toml() } else { layout.to_compact_toml() };
    assert_eq!(read.to_toml(), Layout::parse(&whole, "whole").unwrap_or_else(|e| panic!("{e}")).to_toml(), "{text}");
    text
}

#[test]
fn unchanged_layout_is_written_as_it_was_read() {
    for text in [FILM, COMMENTED_LAYOUT, &FILM.replace('\n', "\r\n")] {
        let layout = Layout::parse(text, "film").unwrap_or_else(|e| panic!("{e}"));
        for form in [TileForm::Plain, TileForm::Compact] {
            let again = layout.to_edited_toml(form, "", "edited").unwrap_or_else(|e| panic!("{e}"));
            assert_eq!(again, text);
        }
    }
}

#[test]
fn values_are_replaced_where_they_stand() {
    let mut layout = film();
    layout.name = "pair, designed".to_owned();
    layout.expectations.bounds.uniformity_rmse = PerParameter { r_x: Some(0.01), r_y: Some(0.07), s_z: Some(0.02) };
    layout.expectations.bounds.least_amplitude = None;
    layout.expectations.least_clearance_mm = Some(3.0);
    let text = FILM
        .replace("name = \"pair\"  ", "name = \"pair, designed\"  ")
        .replace("{ r_x = 0.07, r_y = 0.07 }", "{ r_x = 0.01, r_y = 0.07, s_z = 0.02 }")
        .replace("amplitude = { min = 0.8 }                     # fraction\n", "clearance_mm = { min = 3.0 }\n");
    assert_eq!(written(&layout, TileForm::Plain), text);
}

#[test]
fn steps_are_added_to_the_history() {
    let mut layout = film();
    layout.history.push("designed".to_owned());
    let line = "    \"typed\",\n";
    assert_eq!(written(&layout, TileForm::Plain), FILM.replace(line, &format!("{line}    \"designed\",\n")));
    for (list, longer) in [
        ("[\"drawn\", \"typed\"]", "[\"drawn\", \"typed\", \"designed\"]"),
        ("[\n  \"drawn\",\n  \"typed\" # last\n]", "[\n  \"drawn\",\n  \"typed\", # last\n  \"designed\"\n]"),
        ("[]", "[\"drawn\", \"typed\", \"designed\"]"),
    ] {
        let (start, rest) = FILM.split_once('[').expect("a list");
        let (_, end) = rest.split_once("]\n").expect("its end");
        let mut layout = Layout::parse(&format!("{start}{list}\n{end}"), "film").unwrap_or_else(|e| panic!("{e}"));
        layout.history = ["drawn", "typed", "designed"].map(str::to_owned).to_vec();
        assert_eq!(written(&layout, TileForm::Plain), format!("{start}{longer}\n{end}"));
    }
    layout.file = None;
    assert_eq!(written(&layout, TileForm::Plain), layout.to_toml());
}

/// The layout with other tiles.
fn moved() -> Layout {
    let mut layout = film();
    for named in &mut layout.tiles {
        let tile = named.tile;
        let moved = Tile::new(tile.position() + DVec3::X, tile.size(), tile.polarization_t());
        named.tile = moved.unwrap_or_else(|e| panic!("{e}"));
    }
    layout
}

#[test]
fn tiles_are_replaced_and_other_tables_stay() {
    let (head, rest) = FILM.split_once("\n# The film").expect("tables");
    let (_, end) = rest.split_once("\n# Requirements").expect("tables");
    let (tables, _) = rest.split_once("\n# Two tiles.").expect("tiles");
    let plain = written(&moved(), TileForm::Plain);
    let tiles = plain.strip_prefix(&format!("{head}\n# The film{tables}\n# Requirements")).expect("the same tables");
    let (expect, tiles) = tiles.split_once("# fraction\n\n[[tile]]\n").expect("tiles");
    assert!(
        end.starts_with(expect) && tiles.starts_with("name = \"left\"\nposition_mm = [0.0, 0.0, 0.5]\n"),
        "{plain}"
    );
    assert!(plain.ends_with("\n# The end.\n"), "{plain}");

    let compact = written(&moved(), TileForm::Compact);
    let lines = "\ntile = [\n  { name = \"left\", size_mm = [2.0, 2.0, 1.0], position_mm = [0.0, 0.0, 0.5], strength_t = 0.1, \
                 direction_deg = 0.0 },\n  { name = \"right\", size_mm = [2.0, 2.0, 1.0], position_mm = [3.0, 0.0, 0.5], \
                 polarization_t = [0.1, 0.05, 0.0] },\n]\n";
    assert_eq!(compact, format!("{head}{lines}\n# The film{tables}\n# Requirements{end}"));
}

#[test]
fn comments_apart_from_the_first_tile_move_to_the_end() {
    let mut layout = Layout::parse(COMMENTED_LAYOUT, "film").unwrap_or_else(|e| panic!("{e}"));
    layout.tiles.remove(0);
    let text = written(&layout, TileForm::Compact);
    let (start, rest) = COMMENTED_LAYOUT.split_once("\n# A film cut").expect("a lattice");
    let (tables, material) = start.split_once("\n# The material").expect("a comment");
    let (_, end) = rest.split_once("\n\n").expect("an end");
    assert!(text.ends_with(&format!("\n# The material{material}\n{end}")), "{text}");
    let (head, tables) = tables.split_once("\n# The ideal film").expect("tables");
    assert!(text.starts_with(head) && text.contains(tables), "{text}");
    assert_eq!(text.matches("# The material").count(), 1);
}

/// The first table of the tiles may be one of a kind.
#[test]
fn comments_apart_from_the_first_kind_move_to_the_end() {
    let head = "format = 1\nname = \"pair\"\n";
    let kind = "# Squares.\n[kind.square]\nsize_mm = [2, 2, 1]\nstrength_t = 0.1\n";
    let tile = |x: i32| format!("\n[[tile]]\nkind = \"square\"\nposition_mm = [{x}, 0, 0.5]\ndirection_deg = 0\n");
    let text = format!("{head}\n# Apart.\n\n{kind}{}{}", tile(0), tile(4));
    let mut layout = Layout::parse(&text, "film").unwrap_or_else(|e| panic!("{e}"));
    layout.tiles.remove(0);
    let text = written(&layout, TileForm::Plain);
    assert!(text.starts_with(head) && text.trim_end().ends_with("# Apart."), "{text}");
}

#[test]
fn tables_are_added_and_omitted() {
    let mut layout = film();
    layout.ideal = None;
    layout.expectations = Default::default();
    layout.sensor = Layout::parse(&format!("{FILM}[sensor]\nnoise_ut = 5\n"), "film").expect("a sensor").sensor;
    let (start, rest) = FILM.split_once("\n# The film").expect("tables");
    let (tables, _) = rest.split_once("\n# Requirements").expect("tables");
    let (_, volume) = tables.split_once("thickness_mm = 1\n").expect("the ideal film");
    let text = format!("{start}{volume}\n[sensor]\nnoise_ut = 5.0\n\n# The end.\n");
    assert_eq!(written(&layout, TileForm::Plain), text);
}

#[test]
fn brief_changes_key_by_key() {
    let design = "[design]\nvary = [\"size\"]   # only that\ngoal = \"field\"   # for now\n";
    let text = format!("{FILM}{design}");
    let mut layout = Layout::parse(&text, "film").unwrap_or_else(|e| panic!("{e}"));
    layout.brief = layout.brief.map(|brief| Brief { goal: Goal::Displacement, starts: 3, ..brief });
    let changed = text.replace("\"field\"", "\"displacement\"") + "starts = 3\n";
    assert_eq!(written(&layout, TileForm::Plain), changed);
}

#[test]
fn tolerance_stays_while_it_means_the_same() {
    let tolerance = "\n[tolerance]   # by hand\npreset = \"by-hand\"\nstrength = 0.02\n\n[[tolerance.tile]]\ntiles = [\"l*\"]   # one\nposition_mm = 0.5\n";
    let text = format!("{FILM}{tolerance}");
    let mut layout = Layout::parse(&text, "film").unwrap_or_else(|e| panic!("{e}"));
    let same = { Layout { tiles: moved().tiles, ..layout.clone() } };
    for form in [TileForm::Plain, TileForm::Compact] {
        assert!(written(&same, form).contains(tolerance), "{}", written(&same, form));
    }
    // Without the key, the preset would have an error.
    for errors in &mut layout.tolerance.as_mut().expect("errors").tiles {
        errors.strength = Default::default();
    }
    let without = written(&layout, TileForm::Plain);
    assert!(
        !without.contains("preset") && without.contains("[tolerance]   # by hand\nposition_mm = 0.5\n"),
        "{without}"
    );
    assert!(without.starts_with(FILM));
    // Names that the tiles no longer have.
    let mut renamed = same;
    renamed.tiles[0].name = "other".to_owned();
    assert!(written(&renamed, TileForm::Compact).contains("[tolerance]   # by hand\nposition_mm = 0.5\n"));
}

#[test]
fn measured_errors_are_written_out_for_another_folder() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("errors.csv"), "0.1\n0.2\n").expect("written");
    let path = folder.path().join("film.toml");
    fs::write(&path, format!("{FILM}[tolerance]\nposition_mm = {{ file = \"errors.csv\" }}  # measured\n"))
        .expect("written");
    let layout = Layout::read(&path).unwrap_or_else(|e| panic!("{e}"));
    let text = |folder: &std::path::Path| layout.to_edited_toml(TileForm::Plain, folder, "edited").expect("valid");
    assert!(text(folder.path()).contains("{ file = \"errors.csv\" }  # measured"));
    let elsewhere = text(std::path::Path::new("/nowhere"));
    assert!(elsewhere.contains("values = [0.1, 0.2]") && elsewhere.contains("# m0"), "{elsewhere}");
}

#[test]
fn broken_rules_are_refused() {
    let mut layout = film();
    layout.tiles[1].tile = layout.tiles[0].tile;
    let error = layout.to_edited_toml(TileForm::Plain, "", "the film found").expect_err("tiles overlap").to_string();
    assert!(error.starts_with("the film found: line ") && error.contains("overlaps"), "{error}");
}
