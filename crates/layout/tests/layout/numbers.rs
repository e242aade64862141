//! Numbers of tiles: what the file says in decimals is what the tiles have.

use magsplice_layout::{Layout, Rotation};

fn layout(body: &str) -> Layout {
    Layout::parse(&format!("format = 1\nname = \"test\"\n{body}"), "test.toml").unwrap_or_else(|e| panic!("{e}"))
}

const TURNED: &str = "[[tile]]\nposition_mm = [3, 1, 5]\nsize_mm = [2, 1, 0.5]\npolarization_t = [0.3, 0.2, -0.1]\n\
                      rotation = { axis = [1, 2, 3], angle_deg = 40 }\nmirror = { axes = [\"x\", \"z\"] }\n";

#[test]
fn mirrored_tiles_have_the_mirrored_axis_and_the_opposite_angle() {
    let layout = layout(TURNED);
    let written: Vec<Rotation> = layout.tiles.iter().map(|tile| tile.rotation.expect("a rotation")).collect();
    let expected =
        [([1.0, 2.0, 3.0], 40.0), ([-1.0, 2.0, 3.0], -40.0), ([1.0, 2.0, -3.0], -40.0), ([-1.0, 2.0, -3.0], 40.0)];
    assert_eq!(written, expected.map(|(axis, angle_deg)| Rotation::AxisAngle { axis, angle_deg }));
}

/// The rotation as written describes the tile, so that the plain form is the same film.
#[test]
fn mirrored_rotated_tiles_survive_a_round_trip() {
    let layout = layout(TURNED);
    let again = Layout::parse(&layout.to_toml(), "plain form").expect("a layout");
    for (tile, again) in layout.tiles.iter().zip(&again.tiles) {
        assert_eq!((&tile.name, tile.tile.position()), (&again.name, again.tile.position()));
        let [j, again_j] = [tile, again].map(|named| named.tile.scene_polarization_t());
        assert!((j - again_j).length() < 1e-15, "{}: {j} and {again_j}", tile.name);
        let turned = tile.tile.rotation().dot(again.tile.rotation()).abs();
        assert!((turned - 1.0).abs() < 1e-15, "{}: {turned}", tile.name);
    }
}

/// 0.1 ten times is 0.9999999999999999 in binary, and less exact after a thousand times.
#[test]
fn widths_of_a_lattice_add_up_to_decimals() {
    let film = layout(
        "[[lattice]]\nstart_mm = [0.3, 0, 0]\nheight_mm = 1\nstrength_t = 1\n\
         x = [{ widths_mm = [0.1], pattern = [1], times = 3000 }]\ny = [{ widths_mm = [1], pattern = [0] }]\n",
    );
    for (index, named) in film.tiles.iter().enumerate() {
        let centre = (2 * index + 7) as f64 / 20.0;
        let error = (named.tile.position().x - centre).abs();
        assert!(
            error <= 2.0 * f64::EPSILON * centre,
            "{}: {} is {error:e} from {centre}",
            named.name,
            named.tile.position().x
        );
    }
}

/// Decimal steps are off by 1e-16; what is off by 1e-4 of a step was written so.
#[test]
fn volume_includes_its_end_where_round_off_misses_it_and_nowhere_else() {
    let volume = |end: &str, step: &str| {
        layout(&format!(
            "[volume]\nx_mm = [0, {end}]\ny_mm = [0, 1]\nz_mm = [-2, -1]\nstep_mm = [{step}, 1, 1]\n[[tile]]\n\
             position_mm = [0, 0, 5]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n"
        ))
    };
    for (end, step, count, upper, findings) in [
        ("0.3", "0.1", 4, 0.3, 0),
        ("100.3", "0.1", 1004, 100.3, 0),
        ("0.29999", "0.1", 3, 0.2, 1),
        ("0.30001", "0.1", 4, 0.1 * 3.0, 1),
        ("0.2999999999", "0.1", 4, 0.2999999999, 0),
    ] {
        let found = volume(end, step);
        let grid = found.volume.expect("a volume").grid;
        assert_eq!((grid.counts()[0], grid.upper().x), (count, upper), "{end} by {step}");
        assert_eq!(found.findings.len(), findings, "{end} by {step}: {:?}", found.findings);
    }
}

/// The message counts the values of a list that is too short or too long.
#[test]
fn lists_have_as_many_values_as_their_key_takes() {
    let read = |position: &str| {
        let body = format!("position_mm = [{position}]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n");
        Layout::parse(&format!("format = 1\nname = \"test\"\n[[tile]]\n{body}"), "test.toml")
    };
    assert!(read("0, 0, 7").is_ok());
    for (position, count) in [("", 0), ("0, 0", 2), ("0, 0, 0, 7", 4), ("0, 0, 0, 7, 7, 7", 6)] {
        let message = read(position).expect_err("a list of another length").to_string();
        let wanted = format!("position_mm is a list of three numbers in mm, not a list of {count},");
        assert!(message.contains(&wanted), "{message}");
    }
}
