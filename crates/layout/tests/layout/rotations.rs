//! Rotations of tiles in every form: what each means, its rules, and that it is written as it was.

use glam::{DMat3, DQuat, DVec3};
use magsplice_layout::{EulerOrder, Layout, Rotation};

const TILE: &str = "format = 1\nname = \"test\"\n[[tile]]\nposition_mm = [3, 1, 5]\nsize_mm = [2, 1, 0.5]\n\
                    polarization_t = [0.3, 0.2, -0.1]\n";

fn parse(rotation: &str) -> Result<Layout, String> {
    Layout::parse(&format!("{TILE}rotation = {rotation}\n"), "test.toml").map_err(|error| error.to_string())
}

fn rotation(text: &str) -> DQuat {
    parse(text).unwrap_or_else(|error| panic!("{error}")).tiles[0].tile.rotation()
}

#[track_caller]
fn same(found: DQuat, wanted: DQuat, error: f64) {
    // A quaternion and its negative are one rotation.
    assert!(found.dot(wanted).abs() > 1.0 - error && (found.length() - 1.0).abs() < 1e-15, "{found} {wanted}");
}

/// 120 degrees about (1, 1, 1) take x to y, y to z and z to x.
#[test]
fn every_form_is_the_same_rotation() {
    let wanted = DQuat::from_xyzw(0.5, 0.5, 0.5, 0.5);
    for text in [
        "{ axis = [1, 1, 1], angle_deg = 120 }",
        "{ quaternion = [0.5, 0.5, 0.5, 0.5] }",
        "{ quaternion = [-3, -3, -3, -3] }",
        "{ quaternion = [1e300, 1e300, 1e300, 1e300] }",
        // About x first: y to z. Then about the fixed z: x to y.
        "{ euler_deg = [90, 0, 90], order = \"xyz\" }",
        // About z first: x to y. Then about the turned x, which is y.
        "{ euler_deg = [90, 0, 90], order = \"ZYX\" }",
        "{ euler_deg = [0, 90, 90], order = \"zxz\" }",
        "{ matrix = [[0, 0, 1], [1, 0, 0], [0, 1, 0]] }",
    ] {
        same(rotation(text), wanted, 1e-15);
        assert!((rotation(text) * DVec3::X - DVec3::Y).length() < 1e-15, "{text}");
    }
    // A division by its norm would change the last digit of these.
    let unit = [0.3, 0.1, -0.9, 0.3];
    assert_eq!(rotation("{ quaternion = [0.3, 0.1, -0.9, 0.3] }").to_array(), unit, "norm 1 keeps its digits");
}

/// scipy.spatial.transform.Rotation.from_euler(order, [10, 20, 30], degrees=True).as_quat().
#[test]
fn euler_angles_are_those_of_scipy() {
    let quarter = |axis: usize, degrees: f64| DMat3::from_axis_angle(DVec3::AXES[axis], degrees.to_radians());
    for (order, product) in [
        ("xyz", quarter(2, 30.0) * quarter(1, 20.0) * quarter(0, 10.0)),
        ("XYZ", quarter(0, 10.0) * quarter(1, 20.0) * quarter(2, 30.0)),
        ("zyx", quarter(0, 30.0) * quarter(1, 20.0) * quarter(2, 10.0)),
        ("ZXZ", quarter(2, 10.0) * quarter(0, 20.0) * quarter(2, 30.0)),
    ] {
        let found = rotation(&format!("{{ euler_deg = [10, 20, 30], order = \"{order}\" }}"));
        same(found, DQuat::from_mat3(&product), 1e-15);
    }
    let xyz = rotation("{ euler_deg = [10, 20, 30], order = \"xyz\" }");
    // Printed by scipy.
    let printed = DQuat::from_xyzw(0.03813457647485013, 0.18930785741199999, 0.23929833774473033, 0.9515485246437885);
    same(xyz, printed, 1e-15);
}

#[test]
fn matrices_with_rounded_decimals_become_the_nearest_rotation() {
    let found = rotation("{ matrix = [[0.866025, -0.5, 0], [0.5, 0.866025, 0], [0, 0, 1]] }");
    same(found, DQuat::from_rotation_z(30_f64.to_radians()), 1e-12);
}

#[test]
fn rules_name_the_value() {
    for (text, message) in [
        (
            "{ quaternion = [0, 0, 0, 0] }",
            "tile \"tile-1\": rotation.quaternion = [0.0, 0.0, 0.0, 0.0], must be finite and not zero",
        ),
        ("{ quaternion = [0, nan, 0, 1] }", "rotation.quaternion = [0.0, NaN, 0.0, 1.0], must be finite"),
        ("{ euler_deg = [0, inf, 0], order = \"xyz\" }", "rotation.euler_deg = [0.0, inf, 0.0], must be three finite"),
        ("{ euler_deg = [0, 1, 0], order = \"xxz\" }", "rotation.order = \"xxz\", must be three letters"),
        ("{ euler_deg = [0, 1, 0], order = \"xYz\" }", "rotation.order = \"xYz\", must be three letters"),
        ("{ euler_deg = [0, 1, 0], order = \"xy\" }", "rotation.order = \"xy\", must be three letters"),
        ("{ euler_deg = [0, 1, 0] }", "rotation has euler_deg without an order, such as \"xyz\""),
        ("{ order = \"xyz\" }", "rotation has order without euler_deg"),
        ("{ axis = [0, 0, 1] }", "rotation has axis without an angle_deg"),
        ("{ angle_deg = 1 }", "rotation has angle_deg without an axis"),
        ("{}", "rotation gives nothing, must give one of: axis and angle_deg; quaternion;"),
        (
            "{ axis = [0, 0, 1], angle_deg = 3, quaternion = [0, 0, 0, 1] }",
            "rotation gives axis and angle_deg, quaternion, must give one of",
        ),
        ("{ matrix = [[1, 0, 0], [0, 1, 0], [0, 0, -1]] }", "rotation.matrix has the determinant -1, a reflection"),
        (
            "{ matrix = [[1, 0, 0], [0, 1, 0.001], [0, 0, 1]] }",
            "rotation.matrix times its transpose deviates by 1.0e-3 from the unit matrix, must be at most 1e-5",
        ),
        ("{ matrix = [[1, 0, 0], [0, 1, 0], [0, 0, nan]] }", "must be nine finite numbers"),
        ("{ matrix = [[1e300, 0, 0], [0, 1, 0], [0, 0, 1]] }", "deviates by inf from the unit matrix"),
        ("{ quarternion = [0, 0, 0, 1] }", "unknown field `quarternion`"),
    ] {
        let error = parse(text).expect_err(text);
        assert!(error.contains(message), "{text}: {error}");
    }
}

/// Mirror images too are written in the form of the original, and come back bit for bit.
#[test]
fn written_rotations_give_the_same_tiles() {
    for text in [
        "{ axis = [1, 2, 3], angle_deg = 40 }",
        "{ quaternion = [0.1, -0.7, 0.3, 0.2] }",
        "{ quaternion = [0, 0.6, 0.8, 0] }",
        "{ euler_deg = [10, -200, 30], order = \"ZXZ\" }",
        "{ euler_deg = [10, 20, 30], order = \"yzx\" }",
        "{ matrix = [[0.36, 0.48, -0.8], [-0.8, 0.6, 0], [0.48, 0.64, 0.6]] }",
        "{ matrix = [[-1, 0, 0], [0, 0.28, 0.96], [0, 0.96, -0.28]] }",
    ] {
        for polarization in ["reflect", "keep"] {
            let mirror = format!("mirror = {{ axes = [\"x\", \"z\"], polarization = \"{polarization}\" }}");
            let layout = parse(&format!("{text}\n{mirror}")).unwrap_or_else(|error| panic!("{error}"));
            let again = Layout::parse(&layout.to_toml(), "plain form").expect("a layout");
            assert_eq!(again.tiles.len(), 4);
            for (tile, again) in layout.tiles.iter().zip(&again.tiles) {
                assert_eq!((tile.rotation, tile.tile), (again.rotation, again.tile), "{text}");
            }
            // A corner of the image is the mirror image of a corner.
            let corner = |i: usize, x: f64, z: f64| {
                let tile = layout.tiles[i].tile;
                tile.rotation() * (0.5 * tile.size() * DVec3::new(x, 1.0, z))
            };
            let difference = corner(0, 1.0, 1.0) * DVec3::new(-1.0, 1.0, 1.0) - corner(1, -1.0, 1.0);
            assert!(difference.length() < 1e-14, "{text}: {difference}");
        }
    }
}

#[test]
fn orders_are_written_as_they_are_read() {
    for text in ["xyz", "ZYX", "yxy", "ZXZ"] {
        let order: EulerOrder = text.parse().expect("an order");
        assert_eq!(order.to_string(), text);
    }
    let order = "xyz".parse().expect("an order");
    assert!(Rotation::Euler { angles_deg: [f64::NAN, 0.0, 0.0], order }.checked().is_err());
}
