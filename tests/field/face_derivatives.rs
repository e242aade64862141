//! Derivatives of B by the faces of a tile, against the oracle, gradients and thin layers.

use glam::{DMat3, DQuat, DVec3};
use magsplice_field::{FaceDerivatives, Quantity, Scene, Tile};
use magsplice_tests::cases;
use magsplice_tests::oracle::Oracle;
use proptest::prelude::*;

fn vector(reach: f64) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-reach..reach).prop_map(DVec3::from)
}

/// The sum of the magnitudes of the contributions of all edges, the measure of accuracy here.
///
/// An edge of length l at distance d contributes at most l / d^2 for a current, as much for a
/// charge, and at most as much to the gradient of either.
fn magnitude(tile: &Tile, point: DVec3) -> f64 {
    let (half, local) = (0.5 * tile.size(), point - tile.position());
    let mut sum = 0.0;
    for axis in 0..3 {
        for (a, b) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            let rho = (local[next] - a * half[next]).hypot(local[last] - b * half[last]);
            // The integral of 1 / r^2 over the edge, which bounds both contributions.
            let (from, to) = (-half[axis] - local[axis], half[axis] - local[axis]);
            sum +=
                if rho > 0.0 { ((to / rho).atan() - (from / rho).atan()) / rho } else { (1.0 / from - 1.0 / to).abs() };
        }
    }
    2.0 * sum * tile.polarization_t().length() / (4.0 * std::f64::consts::PI)
}

fn worst(found: &FaceDerivatives, truth: [DMat3; 2]) -> f64 {
    let difference = [found.lower - truth[0], found.upper - truth[1]];
    difference.iter().flat_map(|m| [m.x_axis, m.y_axis, m.z_axis]).map(DVec3::length).fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(cases(300)))]

    /// Inside and outside, against differences of the textbook formula in 130 digits.
    #[test]
    fn derivatives_agree_with_the_oracle(size in vector(1.0), place in vector(4.0), j in vector(1.0), centre in vector(3.0)) {
        let tile = Tile::new(centre, size.map(|d| 10_f64.powf(d)), j).expect("a valid tile");
        let point = centre + place;
        let found = FaceDerivatives::new(&tile, point).expect("no point on an edge");
        let truth = Oracle::new().face_derivatives(&tile, point);
        // The corners are rounded once. Near an edge this error grows as one over the distance.
        let edge = nearest_edge(&tile, point);
        let corners = f64::EPSILON * (centre.length() + place.length() + tile.size().length()) / edge;
        let allowed = (32.0 * f64::EPSILON + 4.0 * corners) * magnitude(&tile, point);
        prop_assert!(worst(&found, truth) <= allowed, "{} of {allowed}: {found:?} is not {truth:?}", worst(&found, truth));
    }

    /// Moving both faces of every axis moves the tile, which equals moving the point backwards.
    #[test]
    fn sum_over_both_faces_is_minus_the_gradient(
        size in vector(1.0), place in vector(9.0), j in vector(1.0), turn in vector(2.0),
    ) {
        let turn = DQuat::from_scaled_axis(turn);
        let tile = Tile::new(DVec3::ZERO, size.map(|d| 10_f64.powf(d)), j).and_then(|t| t.rotated(turn)).expect("a valid tile");
        let slopes = FaceDerivatives::new(&tile, place).expect("no point on an edge");
        let gradient = Scene::new(&[tile]).gradient(Quantity::FluxDensity, place).expect("no point on an edge");
        // Columns of the derivatives belong to the tile's own axes.
        let moved = (slopes.lower + slopes.upper) * DMat3::from_quat(turn.inverse());
        let local = turn.inverse() * place;
        let flat = Tile::new(DVec3::ZERO, tile.size(), j).expect("a valid tile");
        let allowed = (64.0 * f64::EPSILON + 8.0 * f64::EPSILON * (place.length() + tile.size().length()) / nearest_edge(&flat, local)) * magnitude(&flat, local);
        let error = (moved + gradient).to_cols_array().iter().fold(0.0_f64, |most, c| most.max(c.abs()));
        prop_assert!(error <= allowed, "{error} of {allowed}");
    }

    /// Moving a face outwards adds a thin layer with the same polarization.
    #[test]
    fn derivative_by_a_face_is_the_field_of_a_thin_layer(place in vector(5.0), j in vector(1.0), axis in 0..3_usize) {
        prop_assume!(place.abs().max_element() > 2.0);
        let thin = 1e-4;
        let mut size = DVec3::new(1.0, 2.0, 0.5);
        let tile = Tile::new(DVec3::ZERO, size, j).expect("a valid tile");
        let mut centre = DVec3::ZERO;
        centre[axis] = 0.5 * size[axis] + 0.5 * thin;
        size[axis] = thin;
        let layer = Tile::new(centre, size, j).expect("a valid tile");
        let field = Scene::new(&[layer]).field(Quantity::FluxDensity, place).expect("outside") / thin;
        let slope = FaceDerivatives::new(&tile, place).expect("outside").upper.col(axis);
        // The middle of the layer is half its thickness away from the face. Over a unit of length
        // the field of the layer changes by at most its own size.
        prop_assert!((field - slope).length() <= 10.0 * thin * slope.length().max(0.01 * j.length()));
    }
}

/// Distance from a point to the nearest edge of an unrotated tile.
fn nearest_edge(tile: &Tile, point: DVec3) -> f64 {
    let (half, local) = (0.5 * tile.size(), point - tile.position());
    let mut nearest = f64::INFINITY;
    for axis in 0..3 {
        for (a, b) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            let beyond = (local[axis].abs() - half[axis]).max(0.0);
            let across = (local[next] - a * half[next]).hypot(local[last] - b * half[last]);
            nearest = nearest.min(across.hypot(beyond));
        }
    }
    nearest
}

#[test]
fn points_on_an_edge_have_no_derivatives() {
    let tile = Tile::new(DVec3::ZERO, DVec3::splat(2.0), DVec3::ONE).unwrap();
    assert_eq!(FaceDerivatives::new(&tile, DVec3::new(1.0, 0.3, -1.0)), None);
    // On the extension of an edge and on a face they are bounded.
    assert!(FaceDerivatives::new(&tile, DVec3::new(1.0, 1.5, -1.0)).is_some());
    assert!(FaceDerivatives::new(&tile, DVec3::new(1.0, 0.3, 0.2)).is_some());
}

#[test]
fn derivatives_scale_with_lengths() {
    let at = |unit: f64| {
        let tile = Tile::new(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0) * unit, DVec3::ONE).unwrap();
        FaceDerivatives::new(&tile, DVec3::new(4.0, 1.0, -2.0) * unit).unwrap().upper * unit
    };
    for unit in [2_f64.powi(600), 2_f64.powi(-600)] {
        assert_eq!(at(unit), at(1.0));
    }
}
