//! Touching tiles of one polarization have the field of their merged block on their seam, beside it
//! and on their common edges.

use std::f64::consts::FRAC_PI_2;

use glam::{DMat3, DQuat, DVec3};
use magsplice::magnet::tolerances::{ROTATED_SEAM_ROUNDINGS, SEAM_ROUNDINGS, UNIT_ROUNDOFF};
use magsplice_field::{PointErrorCause, Quantity, Scene, Tile, overlaps};

const J: DVec3 = DVec3::new(0.3, -0.5, 0.7);

/// A tile given by its lower and upper corner, built from centre and size as a user does.
fn tile(low: [f64; 3], high: [f64; 3]) -> Tile {
    let (low, high) = (DVec3::from(low), DVec3::from(high));
    Tile::new(0.5 * (low + high), high - low, J).expect("a valid tile")
}

fn b(scene: &Scene, point: DVec3) -> DVec3 {
    scene.field(Quantity::FluxDensity, point).unwrap_or_else(|cause| panic!("{point}: {cause}"))
}

/// Points on a seam at x = `x` and 1e-3 to 1e-16 beside it: inside, on the top face `z`, above and
/// below.
fn around(x: f64, y: f64, z: f64) -> Vec<DVec3> {
    let mut points = Vec::new();
    for dx in std::iter::once(0.0).chain((3..=16).flat_map(|d| [10_f64.powi(-d), -(10_f64.powi(-d))])) {
        for dz in [0.0, 1e-16, -1e-16, 1e-12, -1e-9, 1e-6, -1e-3, 0.2, -0.4] {
            points.push(DVec3::new(x + dx, y, z + dz));
        }
    }
    points
}

/// Asserts that the fields of `parts` equal the fields of `whole` to `allowed` of |J|.
#[track_caller]
fn assert_same(parts: &[Tile], whole: &Tile, points: &[DVec3], allowed: f64) {
    let (parts, whole) = (Scene::new(parts), Scene::new(&[*whole]));
    for &point in points {
        let (found, exact) = (b(&parts, point), b(&whole, point));
        let error = (found - exact).length();
        assert!(error <= allowed * J.length(), "at {point}: off by {error:e}");
        let [j_parts, j_whole] = [&parts, &whole].map(|s| s.field(Quantity::Polarization, point).unwrap());
        assert_eq!(j_parts, j_whole, "owner at {point}");
    }
}

/// Two unit cubes with J along z touch at x = 0. Their field is known independently.
#[test]
fn seam_of_two_cubes_has_the_known_field() {
    let cube = |x: f64| Tile::new(DVec3::new(x, 0.0, 0.0), DVec3::ONE, DVec3::Z).unwrap();
    let scene = Scene::new(&[cube(-0.5), cube(0.5)]);
    // 0.570 T inside on the seam (-0.430 T if J is lost there), and 0.398 T where the seam meets
    // the top face, approached from outside.
    assert!((b(&scene, DVec3::new(0.0, 0.1, 0.0)).z - 0.570).abs() < 5e-4);
    assert!((b(&scene, DVec3::new(0.0, 0.0, 0.5)).z - 0.398).abs() < 5e-4);
}

#[test]
fn two_tiles_are_their_block() {
    let parts = [tile([-2.0, -1.0, 0.0], [0.25, 1.0, 1.0]), tile([0.25, -1.0, 0.0], [1.5, 1.0, 1.0])];
    assert_same(&parts, &tile([-2.0, -1.0, 0.0], [1.5, 1.0, 1.0]), &around(0.25, 0.3, 1.0), 4e-15);
}

/// At a cut line of the published film, centre +- size / 2 of the two sides differ.
#[test]
fn cuts_that_are_not_binary_fractions() {
    let cut = -5.85;
    let parts = [
        Tile::new(DVec3::new(-7.5, 0.0, 0.5), DVec3::new(3.3, 3.3, 1.0), J).unwrap(),
        Tile::new(DVec3::new(-5.0, 0.0, 0.5), DVec3::new(1.7, 3.3, 1.0), J).unwrap(),
    ];
    let [left, right] = parts.map(|t| (t.position().x, 0.5 * t.size().x));
    assert!((left.0 + left.1) - left.0 != left.1 || left.0 + left.1 != right.0 - right.1, "the numbers are not exact");
    let whole = Tile::new(DVec3::new(-6.65, 0.0, 0.5), DVec3::new(5.0, 3.3, 1.0), J).unwrap();
    assert_same(&parts, &whole, &around(cut, 0.3, 1.0), 4e-15);
}

#[test]
fn four_tiles_that_meet_in_a_point_are_their_block() {
    let cuts = [[-1.3, 0.1, 2.0], [-0.9, -0.2, 1.1]];
    let mut parts = Vec::new();
    for i in 0..2 {
        for k in 0..2 {
            parts.push(tile([cuts[0][i], cuts[1][k], -0.7], [cuts[0][i + 1], cuts[1][k + 1], 0.6]));
        }
    }
    let whole = tile([-1.3, -0.9, -0.7], [2.0, 1.1, 0.6]);
    assert_same(&parts, &whole, &around(0.1, -0.2, 0.6), 4e-15);
    assert_same(&parts, &whole, &around(0.1, 0.4, 0.6), 4e-15);
}

/// Five tiles that fill a square, no two of which form a cuboid, so that every seam is computed.
fn pinwheel() -> ([Tile; 5], Tile) {
    let z = [0.0, 0.9];
    let part = |x: [f64; 2], y: [f64; 2]| tile([x[0], y[0], z[0]], [x[1], y[1], z[1]]);
    let parts = [
        part([0.0, 2.1], [0.0, 1.0]),
        part([2.1, 3.0], [0.0, 1.9]),
        part([0.8, 3.0], [1.9, 3.0]),
        part([0.0, 0.8], [1.0, 3.0]),
        part([0.8, 2.1], [1.0, 1.9]),
    ];
    (parts, part([0.0, 3.0], [0.0, 3.0]))
}

/// Bound on a computed seam, as a fraction of |J|: the rounding of ln(2^-240) = -166 for 5 tiles,
/// over 2 pi.
const COMPUTED_SEAM: f64 = 1.6e-14;

#[test]
fn seams_that_cannot_be_merged() {
    let (parts, whole) = pinwheel();
    for (x, y) in [(2.1, 0.4), (0.8, 1.5), (2.1, 1.0), (0.8, 1.0), (2.1, 1.9), (0.8, 1.9), (0.8, 2.7)] {
        assert_same(&parts, &whole, &around(x, y, 0.9), COMPUTED_SEAM);
        assert_same(&parts, &whole, &around(x, y, 0.0), COMPUTED_SEAM);
    }
}

/// Each part is given as a tile rotated by quarter turns about its centre.
#[test]
fn parts_turned_by_quarter_turns() {
    let (parts, whole) = pinwheel();
    let turns = [
        DQuat::from_rotation_z(FRAC_PI_2),
        DQuat::from_rotation_x(-FRAC_PI_2),
        DQuat::from_rotation_y(2.0 * FRAC_PI_2),
        DQuat::from_rotation_z(FRAC_PI_2) * DQuat::from_rotation_x(FRAC_PI_2),
        DQuat::from_rotation_y(-FRAC_PI_2),
    ];
    let mut turned = Vec::new();
    for (part, turn) in parts.iter().zip(turns) {
        // The rounded matrix is exactly a signed permutation.
        let own = DMat3::from_quat(turn.inverse()).to_cols_array().map(f64::round);
        let own = DMat3::from_cols_array(&own);
        let (size, j) = ((own * part.size()).abs(), own * J);
        turned.push(Tile::new(part.position(), size, j).unwrap().rotated(turn).unwrap());
    }
    for (x, y) in [(2.1, 0.4), (2.1, 1.0), (0.8, 1.9)] {
        assert_same(&turned, &whole, &around(x, y, 0.9), COMPUTED_SEAM);
    }
}

/// A film of touching tiles keeps its seams when it is rotated as a whole, which rounds its
/// coordinates.
#[test]
fn film_rotated_as_a_whole_keeps_its_seams() {
    let (parts, whole) = pinwheel();
    let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
    let place = |t: &Tile| Tile::new(turn * t.position(), t.size(), J).unwrap().rotated(turn).unwrap();
    let (parts, whole) = (Scene::new(&parts.each_ref().map(place)), Scene::new(&[place(&whole)]));
    for (x, y) in [(2.1, 0.4), (2.1, 1.0)] {
        for point in around(x, y, 0.9) {
            // Nearer to the top face, rounding in this test would decide the side.
            if (point.z - 0.9).abs() >= 1e-9 {
                let point = turn * point;
                let error = (b(&parts, point) - b(&whole, point)).length();
                // Faces of the parts are joined in the rotated frame as in the frame of the scene.
                assert!(error <= COMPUTED_SEAM * J.length(), "at {point}: off by {error:e}");
            }
        }
    }
}

/// Edges are exposed on the outline of the whole, and where tiles of different polarization meet.
#[test]
fn exposed_edges_are_named() {
    let (parts, _) = pinwheel();
    let scene = Scene::new(&parts);
    let at = |x: f64, y: f64, z: f64| scene.field(Quantity::FluxDensity, DVec3::new(x, y, z));
    assert_eq!(at(3.0, 0.4, 0.9), Err(PointErrorCause::Unbounded { tile: 1 }));
    assert_eq!(at(0.8, 3.0, 0.9), Err(PointErrorCause::Unbounded { tile: 2 }));
    let other = [parts[0], Tile::new(parts[1].position(), parts[1].size(), -J).unwrap()];
    let corner = DVec3::new(2.1, 0.4, 0.9);
    assert!(Scene::new(&other).field(Quantity::FluxDensity, corner).is_err());
    assert!(Scene::new(&[parts[0], parts[1]]).field(Quantity::FluxDensity, corner).is_ok());
    // In a merged block, an edge of the outline belongs to the tile there.
    let row = [0, 1, 2, 3].map(|i| tile([f64::from(i), 0.0, 0.0], [f64::from(i) + 1.0, 1.0, 1.0]));
    let end = Scene::new(&row).field(Quantity::FluxDensity, DVec3::new(2.5, 1.0, 1.0));
    assert_eq!(end, Err(PointErrorCause::Unbounded { tile: 2 }));
}

/// Parts that merge have the gradient of the whole. On the edge of a computed seam it is reported
/// as unresolved.
#[test]
fn gradient_on_seams() {
    let (parts, whole) = pinwheel();
    let scene = Scene::new(&parts);
    let edge = DVec3::new(2.1, 0.4, 0.9);
    assert!(matches!(scene.gradient(Quantity::FluxDensity, edge), Err(PointErrorCause::Unresolved { tile: 0 | 1 })));
    let exact = Scene::new(&[whole]).gradient(Quantity::FluxDensity, edge).unwrap();
    let halves = [tile([0.0, 0.0, 0.0], [3.0, 0.4, 0.9]), tile([0.0, 0.4, 0.0], [3.0, 3.0, 0.9])];
    let merged = Scene::new(&halves).gradient(Quantity::FluxDensity, edge).unwrap();
    assert!((merged - exact).to_cols_array().iter().all(|c| c.abs() <= 1e-14 * exact.x_axis.length()));
}

/// Tiles rotated about the normal of a seam by different angles share the plane of the seam.
#[test]
fn stacked_tiles_turned_in_the_plane() {
    let lower = Tile::new(DVec3::new(0.0, 0.0, 0.15), DVec3::new(10.0, 10.0, 0.3), DVec3::X).unwrap();
    let upper = |turn: DQuat| {
        let tile =
            Tile::new(DVec3::new(0.0, 0.0, 0.4), DVec3::new(10.0, 10.0, 0.2), turn.inverse() * DVec3::X).unwrap();
        tile.rotated(turn).unwrap()
    };
    let about_z = DQuat::from_rotation_z(FRAC_PI_2 / 2.0);
    for turn in [about_z, about_z * DQuat::from_rotation_x(2.0 * FRAC_PI_2), DQuat::from_rotation_z(1.0)] {
        let scene = Scene::new(&[lower, upper(turn)]);
        let at = |z: f64| {
            (b(&scene, DVec3::new(0.1, 0.2, z)), scene.field(Quantity::Polarization, DVec3::new(0.1, 0.2, z)).unwrap())
        };
        for z in [0.3, 0.3 + 1e-16, 0.3 - 1e-16, 0.3 + 1e-9] {
            let ((here, j), (below, _)) = (at(z), at(0.3 - 1e-8));
            // J is the same on both sides, so B is continuous and changes by at most |J| 1e-8 /
            // 0.3.
            assert!((here - below).length() < 1e-7 && (j - DVec3::X).length() < 1e-15, "at {z}: {here}, {j}");
        }
    }
}

/// Edges are found although round-off moves them away from the point.
#[test]
fn exposed_edges_of_rotated_tiles() {
    let cube = Tile::new(DVec3::ZERO, DVec3::ONE, DVec3::new(0.3, 0.4, 0.5)).unwrap();
    for angle in [30.0_f64, 45.0, 10.0] {
        let turn = DQuat::from_rotation_z(angle.to_radians());
        let scene = Scene::new(&[cube.rotated(turn).unwrap()]);
        let edge = turn * DVec3::new(0.5, 0.5, 0.2);
        assert_eq!(scene.field(Quantity::FluxDensity, edge), Err(PointErrorCause::Unbounded { tile: 0 }), "{angle}");
    }
}

/// Every point of a row of tiles has one owner, for any decimal cuts.
#[test]
fn one_owner_for_any_decimal_cuts() {
    let unit = |low: f64, high: f64| {
        let size = DVec3::new(high - low, 1.0, 1.0);
        Tile::new(DVec3::new(0.5 * (low + high), 0.0, 0.0), size, DVec3::X).unwrap()
    };
    let cuts = |n: i32| f64::from(n) / 10.0;
    for (a, c, e) in (-40..40).step_by(7).flat_map(|a| (1..60).step_by(3).map(move |b| (a, a + b, a + b + 1 + b % 5))) {
        let parts = [unit(cuts(a), cuts(c)), unit(cuts(c), cuts(e))];
        assert!(overlaps(&parts).next().is_none(), "{a} {c} {e} overlap");
        let scene = Scene::new(&parts);
        for n in [-2, -1, 0, 1, 2] {
            let x = cuts(c) + f64::from(n) * f64::EPSILON * cuts(c).abs();
            let j = scene.field(Quantity::Polarization, DVec3::new(x, 0.1, 0.2)).unwrap();
            assert_eq!(j, DVec3::X, "cuts {a}, {c}, {e} tenths: J at {x}");
        }
    }
    let long = Scene::new(&[unit(-100.0, 0.1), unit(0.1, 0.3)]);
    assert_eq!(long.field(Quantity::Polarization, DVec3::new(0.1, 0.1, 0.2)), Ok(DVec3::X));
}

/// Neither other tiles in the plane of a seam nor slivers thinner than round-off break the seam.
#[test]
fn bystanders_do_not_break_seams() {
    let e = f64::EPSILON;
    let part = |low: f64, high: f64, y: f64| {
        Tile::new(DVec3::new(0.5 * (low + high), y, 0.0), DVec3::new(high - low, 1.0, 1.0), DVec3::X).unwrap()
    };
    let sliver = Tile::new(DVec3::new(1.0, 50.0, 0.0), DVec3::new(1e-17, 1.0, 1.0), DVec3::X).unwrap();
    let scenes = [
        Scene::new(&[part(0.0, 1.0, 0.0), part(1.0 - 3.0 * e, 2.0, 0.0), part(1.0 - 5.5 * e, 2.0, 100.0)]),
        Scene::new(&[part(0.0, 1.0, 0.0), part(1.0 + e, 2.0, 0.0), sliver]),
    ];
    for scene in scenes {
        for n in -8..8 {
            let point = DVec3::new(1.0 + f64::from(n) * e, 0.1, 0.2);
            assert_eq!(scene.field(Quantity::Polarization, point), Ok(DVec3::X), "{point}");
        }
        assert!(scene.field(Quantity::FluxDensity, DVec3::new(1.0, 0.2, 0.5)).is_ok());
    }
}

/// Tiles that overlap by the round-off of their faces, at coordinates of up to 2, are joined, so
/// that each point has one owner. Deeper overlaps of round-off are not reported either.
#[test]
fn overlaps_of_round_off_are_joined() {
    let turned = DQuat::from_rotation_x(0.5);
    let half_turn = DQuat::from_rotation_x(2.0 * FRAC_PI_2);
    for (turn, roundings) in
        [(DQuat::IDENTITY, SEAM_ROUNDINGS), (half_turn, SEAM_ROUNDINGS), (turned, ROTATED_SEAM_ROUNDINGS)]
    {
        for steps in 0..60 {
            let depth = f64::from(steps) * f64::EPSILON;
            let size = DVec3::new(1.0 + depth, 1.0, 1.0);
            let other = Tile::new(DVec3::new(1.5 - 0.5 * depth, 0.0, 0.0), size, turn.inverse() * DVec3::X).unwrap();
            let tiles =
                [Tile::new(DVec3::new(0.5, 0.0, 0.0), DVec3::ONE, DVec3::X).unwrap(), other.rotated(turn).unwrap()];
            assert_eq!(overlaps(&tiles).next(), None, "{steps} steps");
            if depth <= roundings * UNIT_ROUNDOFF {
                let scene = Scene::new(&tiles);
                for n in 0..=steps {
                    let point = DVec3::new(1.0 - f64::from(n) * f64::EPSILON, 0.1, 0.2);
                    let j = scene.field(Quantity::Polarization, point).unwrap();
                    assert!((j - DVec3::X).length() < 1e-15, "{steps} steps deep, J is {j} at {point}");
                }
            }
        }
    }
}
