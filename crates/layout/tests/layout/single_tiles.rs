//! Rules of a single tile: its kind and its polarization.

use magsplice_layout::Layout;

const HEAD: &str = "format = 1\nname = \"test\"\n";
const TILE: &str = "[[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n";

fn parse(tables: &str) -> Result<Layout, String> {
    Layout::parse(&format!("{HEAD}{tables}"), "test.toml").map_err(|error| error.to_string())
}

/// A tile has its polarization from one key, its own or its kind's.
#[test]
fn polarization_is_given_once() {
    let parsed = |kind: &str, tile: &str| {
        parse(&format!(
            "[kind.k]\nsize_mm = [1, 1, 1]\n{kind}\n[[tile]]\nkind = \"k\"\nposition_mm = [0, 0, 0]\n{tile}\n"
        ))
    };
    let (vector, strength) = ("polarization_t = [0, 0, 1]", "strength_t = 1\ndirection_deg = 0");
    for (kind, tile) in [(vector, ""), ("strength_t = 1", "direction_deg = 0"), ("", vector), ("", strength)] {
        assert!(parsed(kind, tile).is_ok(), "{kind:?}, {tile:?}: {:?}", parsed(kind, tile));
    }
    let both = format!("{vector}\n{strength}");
    for (kind, tile) in
        [(vector, vector), (vector, strength), ("strength_t = 1", vector), ("strength_t = 1", strength), ("", &both)]
    {
        let message = parsed(kind, tile).expect_err("given twice");
        assert!(message.contains("gives its polarization twice"), "{kind:?}, {tile:?}: {message}");
    }
    let message = parsed("", "").expect_err("not given");
    assert!(message.contains("has no polarization: give"), "{message}");
}

#[test]
fn strengths_are_finite_and_not_negative() {
    let parsed = |strength: &str| {
        let magnitude = format!("strength_t = {strength}\ndirection_deg = 0");
        parse(&TILE.replace("polarization_t = [0, 0, 1]", &magnitude))
    };
    assert!(parsed("0").is_ok() && parsed("1").is_ok());
    for (strength, shown) in [("-1", "-1"), ("inf", "inf"), ("nan", "NaN")] {
        let message = parsed(strength).expect_err("no magnitude");
        let rule = format!("strength_t = {shown}, must be a finite number of at least 0");
        assert!(message.contains(&rule), "{message}");
    }
}

/// The magnitude stands beside a polarization with several components alone.
#[test]
fn polarizations_that_no_material_has_are_told_with_what_was_meant() {
    let message = |polarization: &str| {
        parse(&TILE.replace("polarization_t = [0, 0, 1]", &format!("polarization_t = [{polarization}]")))
            .expect_err("no material")
    };
    let rule = "must be at most 2.5 T, more than any material has; did you mean";
    let one_axis = message("0, 120, 0");
    assert!(one_axis.contains(&format!("polarization_t = [0.0, 120.0, 0.0], {rule} 0.12 T")), "{one_axis}");
    let diagonal = message("30, 0, 40");
    let wanted = format!("polarization_t = [30.0, 0.0, 40.0] has a magnitude of 50.0000 T, {rule} 0.05 T");
    assert!(diagonal.contains(&wanted), "{diagonal}");
}

/// Twenty kinds are listed; the others are counted.
#[test]
fn unknown_kind_is_told_with_the_declared_ones() {
    let message = |count: usize| {
        let kinds: String = (0..count).map(|n| format!("[kind.k{n:02}]\nsize_mm = [1, 1, 1]\n")).collect();
        let tile = TILE.replace("size_mm = [1, 1, 1]", "kind = \"other\"");
        parse(&format!("{kinds}{tile}")).expect_err("an unknown kind")
    };
    let rule = "kind = \"other\", must be declared as [kind.other] (declared:";
    for (count, end) in [(0, " none)"), (1, " k00)"), (20, ", k18, k19)"), (21, ", k18, k19, and 1 more)")] {
        let message = message(count);
        let line = message.lines().find(|line| line.contains(rule)).unwrap_or_else(|| panic!("{message}"));
        assert!(line.trim_end().ends_with(end), "{line}");
    }
}
