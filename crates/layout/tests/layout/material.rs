//! The material of tiles: permeabilities, the knee, the change of the strength with temperature.

use std::collections::BTreeMap;

use magsplice_layout::{Layout, LayoutError};

fn parse(body: &str) -> Result<Layout, LayoutError> {
    Layout::parse(&format!("format = 1\nname = \"test\"\n{body}"), "test.toml")
}

fn layout(body: &str) -> Layout {
    parse(body).unwrap_or_else(|e| panic!("{e}"))
}

fn message(body: &str) -> String {
    parse(body).expect_err("the layout is faulty").to_string()
}

/// A tile has its own permeability, else that of its kind, else that of the material.
#[test]
fn nearest_permeability_counts() {
    let body = r#"
        [material]
        recoil_permeability = 1.05
        recoil_error = 0.01
        knee_field_t = 0.6
        strength_per_k = -0.0012
        [kind.square]
        size_mm = [3, 3, 1]
        recoil_permeability = { along = 1.1, across = 1.2 }
        [[tile]]
        name = "of material"
        position_mm = [0, 0, 0.5]
        size_mm = [3, 3, 1]
        polarization_t = [0.1, 0, 0]
        [[tile]]
        name = "of kind"
        kind = "square"
        position_mm = [10, 0, 0.5]
        polarization_t = [0.1, 0, 0]
        mirror = { axes = ["x"] }
        [[tile]]
        name = "own"
        kind = "square"
        position_mm = [20, 0, 0.5]
        polarization_t = [0.1, 0, 0]
        recoil_permeability = 1
        [[lattice]]
        name = "cut"
        start_mm = [30, 0, 0]
        height_mm = 1
        strength_t = 0.1
        recoil_permeability = 1.3
        x = [{ widths_mm = [2], pattern = [1] }]
    "#;
    let found = layout(body);
    let expected = [[1.05; 2], [1.1, 1.2], [1.1, 1.2], [1.0, 1.0], [1.3, 1.3]];
    let permeabilities = |layout: &Layout| -> BTreeMap<String, [f64; 2]> {
        let named = layout.tiles.iter().zip(layout.permeabilities());
        named.map(|(named, of)| (named.name.clone(), [of.along(), of.across()])).collect()
    };
    let names = ["of material", "of kind", "of kind-mx", "own", "cut-x1-y1"].map(str::to_owned);
    assert_eq!(permeabilities(&found), names.into_iter().zip(expected).collect());
    for text in [found.to_toml(), found.to_compact_toml()] {
        let again = Layout::parse(&text, "written").unwrap();
        assert_eq!((again.material, permeabilities(&again)), (found.material, permeabilities(&found)), "{text}");
    }
    assert!(
        !layout(&body.replace("1.05", "1").replace("1.1,", "1,").replace("1.2 }", "1 }").replace("1.3", "1"))
            .has_recoil()
    );
}

/// Tiles that differ in permeability alone are no mirror images of each other.
#[test]
fn mirror_images_have_one_permeability() {
    let text = "[[tile]]\nposition_mm = [-2, 0, 0.5]\nsize_mm = [1, 1, 1]\npolarization_t = [-0.1, 0, 0]\n\
                [[tile]]\nposition_mm = [2, 0, 0.5]\nsize_mm = [1, 1, 1]\npolarization_t = [0.1, 0, 0]\nrecoil_permeability = 1.2\n";
    let written = layout(text).to_compact_toml();
    assert_eq!(
        Layout::parse(&written, "compact").unwrap().permeabilities().iter().filter(|of| of.is_rigid()).count(),
        1
    );
    assert!(!written.contains("mirror"), "{written}");
}

#[test]
fn faulty_materials_are_refused() {
    let tile = "[[tile]]\nposition_mm = [0, 0, 0.5]\nsize_mm = [1, 1, 1]\npolarization_t = [0.1, 0, 0]\n";
    for (material, expected) in [
        (
            "recoil_permeability = 0.05",
            "recoil_permeability = 0.05, must be from 1 to 10000 (the permeability, not the susceptibility: 1.05?)",
        ),
        ("recoil_permeability = { along = 1.1, across = 2e4 }", "recoil_permeability.across = 20000, must be from 1"),
        ("recoil_permeability = nan", "recoil_permeability = NaN, must be from 1 to 10000"),
        (
            "recoil_permeability = \"1.05\"",
            "one number, or a table such as { along = 1.05, across = 1.15 }, not a string: write",
        ),
        ("recoil_permeability = { along = 1.1 }", "missing field `across`"),
        ("recoil_error = 0", "recoil_error = 0, must be at least 0.0001 and below 1"),
        ("recoil_error = 1", "recoil_error = 1, must be at least 0.0001 and below 1"),
        ("knee_field_t = -0.6", "knee_field_t = -0.6, must be a finite number greater than 0"),
        ("strength_per_k = -0.12", "must be from -0.02 to 0.02 (a fraction, not per cent: -0.0012?)"),
    ] {
        let found = message(&format!("[material]\n{material}\n{tile}"));
        assert!(found.contains(expected), "{found}");
    }
    let faulty =
        message(&format!("{tile}recoil_permeability = 0.9\n[kind.a]\nsize_mm = [1, 1, 1]\nrecoil_permeability = 0\n"));
    assert!(
        faulty.contains("tile \"tile-1\": recoil_permeability = 0.9") && faulty.contains("kind \"a\": recoil"),
        "{faulty}"
    );
    let unusual = layout(&format!("[material]\nrecoil_permeability = 100\n{tile}"));
    assert!(unusual.findings[0].to_string().contains("Alnico up to 5"), "{:?}", unusual.findings);
    // Along and across, and exactly at the limit.
    for (along, across, is_unusual) in [(1.05, 6.1, true), (6.1, 1.05, true), (6.0, 6.0, false)] {
        let stated = format!("recoil_permeability = {{ along = {along}, across = {across} }}");
        let found = layout(&format!("[material]\n{stated}\n{tile}")).findings;
        assert_eq!(found.iter().any(|finding| finding.to_string().contains("Alnico up to 5")), is_unusual, "{found:?}");
    }
}

/// The change of the strength per kelvin is that of the table, else that of the material.
#[test]
fn temperature_takes_the_coefficient_of_the_material() {
    let tile = "[[tile]]\nposition_mm = [0, 0, 0.5]\nsize_mm = [1, 1, 1]\npolarization_t = [0.1, 0, 0]\n";
    let read = |material: &str, own: &str| {
        let body =
            format!("{material}\n[tolerance]\nstrength = 0.01\n[tolerance.temperature]\nchange_k = 10\n{own}\n{tile}");
        parse(&format!("{VOLUME}{body}"))
    };
    let of = |layout: Layout| layout.tolerance.unwrap().common.temperature.unwrap().strength_per_k;
    let material = "[material]\nstrength_per_k = -0.002";
    assert_eq!(of(read(material, "").unwrap()), -0.002);
    assert_eq!(of(read(material, "strength_per_k = -0.001").unwrap()), -0.001);
    let error = read("", "").unwrap_err().to_string();
    assert!(error.contains("has no strength_per_k, and [material] has none either"), "{error}");
}

/// A film with a working volume.
const VOLUME: &str = "[ideal]\nwavelength_mm = 10\nthickness_mm = 1\namplitude_t = 0.12\n\
                      [volume]\nx_mm = [-2, 2]\ny_mm = [-2, 2]\nz_mm = [-5, -3]\nstep_mm = 1\n";
