//! Discs and waves: their tiles and their rules.

use glam::DVec3;
use magsplice_layout::{Distribution, Layout, TileErrors};

const HEAD: &str = "format = 1\nname = \"shapes\"\n";

const DISC: &str = "[[tile]]\nname = \"d\"\nshape = \"disc\"\ndiameter_mm = 4\nheight_mm = 1\nposition_mm = [1, 2, 3]\n\
                    polarization_t = [0, 0, 1]\n";

const WAVE: &str = "wavelength_mm = 10, slices = 4, direction = \"upright\", length_mm = [10, 5]";

fn layout(tables: &str) -> Layout {
    Layout::parse(&format!("{HEAD}{tables}"), "shapes").unwrap_or_else(|error| panic!("{error}"))
}

#[track_caller]
fn refused(tables: &str, rule: &str) {
    let error = Layout::parse(&format!("{HEAD}{tables}"), "shapes").expect_err(rule).to_string();
    assert!(error.contains(rule), "{rule} is not in {error}");
}

/// A hundredth needs ten strips. Strips are repeated and mirrored with their disc, turned with it,
/// and written out as tiles.
#[test]
fn discs_are_strips() {
    let repeated = layout(&format!(
        "{DISC}rotation = {{ axis = [0, 0, 1], angle_deg = 90 }}\n\
         grid = {{ count = [2, 1, 1], pitch_mm = [5, 0, 0], alternate = [\"x\"] }}\nmirror = {{ axes = [\"y\"] }}\n"
    ));
    assert_eq!((repeated.tiles.len(), repeated.shape_error), (40, Some(0.01)));
    let of = |name: &str| repeated.tiles.iter().find(|tile| tile.name == name).expect(name).tile;
    let (first, copy, image) = (of("d-x1-s1"), of("d-x2-s1"), of("d-x1-my-s1"));
    // The first strip is at the lower end of y of the disc, turned to the upper end of x.
    assert!(first.position().x > 2.8 && (first.position().y - 2.0).abs() < 1e-15, "{first:?}");
    assert!((copy.position() - first.position() - DVec3::new(5.0, 0.0, 0.0)).length() < 1e-15);
    assert!(copy.polarization_t().z == -1.0 && (image.position().y + first.position().y).abs() < 1e-15, "{image:?}");
    let again = Layout::parse(&repeated.to_toml(), "again").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(again.bare_tiles(), repeated.bare_tiles());
    let fine = layout(&DISC.replace("height_mm", "shape_error = 0.0001\nheight_mm"));
    assert_eq!(fine.tiles.len(), 100);
    let of_kind = "[kind.coin]\nshape = \"disc\"\ndiameter_mm = 4\nheight_mm = 1\n[[tile]]\nname = \"d\"\nkind = \"coin\"\n\
                   position_mm = [1, 2, 3]\npolarization_t = [0, 0, 1]\n";
    assert_eq!(layout(of_kind).bare_tiles(), layout(DISC).bare_tiles());
}

#[test]
fn rules_of_discs_have_their_keys() {
    let with = |key: &str| format!("{DISC}{key}\n");
    refused(&with("size_mm = [4, 4, 1]"), "tile \"d\": gives size_mm, which a disc does not have");
    refused(&with("shape_error = 0.2"), "shape_error = 0.2, must be from 0.0001 to 0.1");
    refused(&DISC.replace("diameter_mm = 4\n", ""), "has no diameter_mm, which a disc needs");
    refused(&DISC.replace("= 4", "= -4"), "diameter_mm = -4, must be");
    refused(&DISC.replace("shape = \"disc\"\n", ""), "gives diameter_mm, which goes with shape = \"disc\"");
    refused(&DISC.replace("\"disc\"", "\"ring\""), "ring");
    refused(&with("kind = \"k\"\n[kind.k]\nsize_mm = [1, 1, 1]"), "gives shape, which its kind already gives");
    // Strips are parts of one magnet.
    refused(
        &format!("{DISC}[tolerance]\npreset = \"jig\"\n"),
        "\"d\" has errors of size_mm, which would change every strip",
    );
    let sizes = "[[tolerance.group]]\ntiles = [\"d-s*\"]\nsize_mm = 0.01\n";
    refused(&format!("{DISC}{sizes}"), "\"group-1\" has errors of size_mm, which would change every strip of a disc");
    let one = "[[tolerance.tile]]\ntiles = [\"d-s2\"]\nposition_mm = 0.05\n";
    refused(&format!("{DISC}{one}"), "the strips of the disc \"d\" have different errors, must have the same");
}

/// Errors of each tile are those of whole discs, and rows are rows of discs. The narrowest strip,
/// of 0.1 mm, does not limit them.
#[test]
fn errors_of_discs_are_those_of_their_strips_together() {
    let grid = "grid = { count = [2, 3, 1], pitch_mm = [5, 5, 0], alternate = [\"x\"] }\n";
    let discs = |tolerance: &str| layout(&format!("{DISC}{grid}{tolerance}")).tolerance.expect("stated");
    let made = discs("[tolerance]\npreset = \"by-hand\"\nsize_mm = 0\n");
    assert!(made.tiles.is_empty() && made.groups.len() == 6, "{made:?}");
    assert!(
        made.groups.iter().all(|group| group.tiles.len() == 10 && group.errors.strength == Distribution::normal(0.03))
    );
    assert_eq!(made.groups[1].name, "d-x1-y2");
    let rows = discs("[[tolerance.group]]\nname = \"row\"\nrows_along = \"x\"\nposition_mm = 0.2\n");
    assert_eq!(rows.groups.iter().map(|row| row.tiles.len()).collect::<Vec<_>>(), [20; 3]);
    // A block beside discs keeps errors of its own.
    let block = "[[tile]]\nposition_mm = [30, 0, 0]\nsize_mm = [1, 1, 1]\npolarization_t = [1, 0, 0]\n";
    let both = discs(&format!("{block}[tolerance]\nposition_mm = 0.05\n"));
    let has_errors: Vec<bool> = both.tiles.iter().map(|errors| *errors != TileErrors::default()).collect();
    assert!(both.groups.len() == 6 && has_errors[60] && !has_errors[..60].contains(&true), "{has_errors:?}");
}

/// The pattern of slices is the wave at their middles over sinc(pi / 4), with its phase at the
/// origin.
#[test]
fn waves_are_slices() {
    let wave = |keys: &str| {
        let axes = "axes = [\"x\"]";
        layout(&format!(
            "[[lattice]]\nname = \"w\"\nstart_mm = [0, 0, 0]\nheight_mm = 1\ncomponent_t = 0.1\nwave = {{ {keys}, {axes} }}\n"
        ))
    };
    let j_t = |layout: &Layout| layout.tiles.iter().map(|of| of.tile.polarization_t()).collect::<Vec<_>>();
    let size = 0.1 * std::f64::consts::FRAC_PI_4;
    let close = |found: &[DVec3], known: [[f64; 3]; 4]| {
        found.iter().zip(known).all(|(found, known)| (*found - size * DVec3::from(known)).length() < 1e-15)
    };
    let upright = wave(WAVE);
    assert!(close(&j_t(&upright), [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.0, 0.0, -1.0], [0.0, 0.0, 1.0]]));
    assert_eq!(upright.tiles[3].tile.size(), DVec3::new(2.5, 5.0, 1.0));
    assert_eq!(upright.tiles[3].tile.position(), DVec3::new(8.75, 2.5, 0.5));
    let one_sided = wave(&format!("{}, phase_deg = 90", WAVE.replace("upright", "one-sided")));
    assert!(close(&j_t(&one_sided), [[1.0, 0.0, -1.0], [-1.0, 0.0, -1.0], [-1.0, 0.0, 1.0], [1.0, 0.0, 1.0]]));
    // Slices at zeros of the wave have no tile.
    let in_plane = wave(&format!("{}, phase_deg = 45", WAVE.replace("upright", "in-plane")));
    assert_eq!(in_plane.tiles.iter().map(|of| of.name.as_str()).collect::<Vec<_>>(), ["w-x1-y1", "w-x3-y1"]);
}

#[test]
fn rules_of_waves_have_their_keys() {
    let with = |keys: &str| {
        format!("[[lattice]]\nstart_mm = [0, 0, 0]\nheight_mm = 1\ncomponent_t = 0.1\nwave = {{ {keys} }}\n")
    };
    refused(&with(&WAVE.replace("[10, 5]", "[10, 6]")), "wave.length_mm[1] = 6, must be a whole number of slices");
    refused(&with(&WAVE.replace("= 4", "= 2")), "wave.slices = 2, must be a whole number from 3 to 100");
    refused(&with(&WAVE.replace("wavelength_mm = 10", "wavelength_mm = 0")), "wave.wavelength_mm = 0, must be");
    refused(&with(&format!("{WAVE}, axes = [\"x\", \"x\"]")), "wave.axes must be");
    refused(&with(&format!("{WAVE}, axes = []")), "wave.axes must be");
    refused(&with(&WAVE.replace("[10, 5]", "[1e9, 10]")), "cells, must be at most 4000000 tiles");
    refused(
        &with(WAVE).replace("component_t = 0.1", "strength_t = 0.1"),
        "gives strength_t, and a wave has component_t",
    );
    refused(
        &format!("{}x = [{{ widths_mm = [1], pattern = [1] }}]\n", with(WAVE)),
        "gives wave and x, must give only one of them",
    );
    // Films of 12 T are no magnets.
    refused(&with(&WAVE.replace("[10, 5]", "[10, 10]")).replace("0.1", "12"), "component_t = 12");
}

/// The error of slices is stated where the volume is nearest to the film.
#[test]
fn errors_of_slices_are_those_at_the_volume() {
    let volume = "[volume]\nx_mm = [-1, 1]\ny_mm = [-1, 1]\nz_mm = [-5, -3]\nstep_mm = 1\n";
    let film = format!(
        "[[lattice]]\nstart_mm = [0, 0, 0]\nheight_mm = 1\ncomponent_t = 0.1\nwave = {{ {} }}\n",
        WAVE.replace("[10, 5]", "[10, 10]")
    );
    let stated = layout(&format!("{volume}{film}")).slice_error.expect("a wave");
    assert!((stated - (-0.4 * std::f64::consts::PI * 3.0).exp()).abs() < 1e-15, "{stated}");
    assert_eq!(layout(&film).slice_error, None);
}
