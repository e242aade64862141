//! Physical laws on random scenes: sides up to twelve decades apart, any polarization and rotation,
//! and points near and on faces, edges, corners and their extensions.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};
use magsplice_field::{Quantity, Scene, Tile};
use magsplice_tests::{cases, scenes};
use proptest::prelude::*;

fn rebuilt(tile: &Tile, position: DVec3, size: DVec3, j: DVec3) -> Tile {
    Tile::new(position, size, j).expect("a valid tile").rotated(tile.rotation()).expect("a valid rotation")
}

fn b(scene: &Scene, point: DVec3) -> Option<DVec3> {
    scene.field(Quantity::FluxDensity, point).ok()
}

/// Whether a point is exactly on a face. The owner of a face is on one side, so mirror images
/// differ there.
fn on_a_face(tile: &Tile, point: DVec3) -> bool {
    (0..3).any(|axis| {
        // Two-sum: the difference from the centre, and its rounding error.
        let (p, c) = (point[axis], -tile.position()[axis]);
        let sum = p + c;
        let c_part = sum - p;
        let lost = (p - (sum - c_part)) + (c - c_part);
        sum.abs() == 0.5 * tile.size()[axis] && lost == 0.0
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(10_000), failure_persistence: None, ..ProptestConfig::default() })]

    /// Every field and gradient is finite or an error.
    #[test]
    fn fields_are_finite_or_errors(
        tiles in prop::collection::vec((scenes::tile(12.0), scenes::rotation()), 1..4),
        places in scenes::face_offsets(),
        at in 0..3_usize,
    ) {
        let near = &tiles[at % tiles.len()];
        let centred = rebuilt(&near.0, DVec3::ZERO, near.0.size(), near.0.polarization_t());
        let point = near.0.position() + near.1 * scenes::point(&centred, places);
        let turned: Vec<Tile> = tiles.iter().map(|(t, r)| t.rotated(*r).unwrap()).collect();
        let scene = Scene::new(&turned);
        for quantity in [Quantity::FluxDensity, Quantity::FieldStrength, Quantity::Polarization] {
            if let Ok(field) = scene.field(quantity, point) {
                prop_assert!(field.is_finite(), "{quantity:?} is {field} at {point}");
            }
        }
        if let Ok(gradient) = scene.gradient(Quantity::FluxDensity, point) {
            prop_assert!(gradient.is_finite(), "the gradient is {gradient} at {point}");
        }
    }

    /// A block is the sum of its parts, cut at random several times.
    #[test]
    fn block_is_the_sum_of_its_parts(
        tile in scenes::tile(2.0),
        cuts in prop::collection::vec((0..3_usize, 0.1..0.9_f64, 0..8_usize), 1..6),
        places in scenes::face_offsets(),
    ) {
        let tile = rebuilt(&tile, DVec3::ZERO, tile.size(), tile.polarization_t());
        let mut parts = vec![(-0.5 * tile.size(), 0.5 * tile.size())];
        for (axis, share, which) in cuts {
            let (low, high) = parts.swap_remove(which % parts.len());
            let (mut middle_low, mut middle_high) = (low, high);
            middle_low[axis] = low[axis] + share * (high[axis] - low[axis]);
            middle_high[axis] = middle_low[axis];
            parts.push((low, middle_high));
            parts.push((middle_low, high));
        }
        let parts: Vec<Tile> = parts
            .iter()
            .map(|(low, high)| Tile::new(0.5 * (*low + *high), *high - *low, tile.polarization_t()).unwrap())
            .collect();
        let point = scenes::point(&tile, places);
        let (whole, scene) = (Scene::new(&[tile]), Scene::new(&parts));
        let owner = |scene: &Scene| scene.field(Quantity::Polarization, point).unwrap();
        if owner(&whole) != owner(&scene) {
            // The outer faces of the parts are rounded, and the point is within this rounding.
            let depth = (point.abs() - 0.5 * tile.size()) / tile.size().max_element();
            prop_assert!(depth.to_array().iter().any(|d| d.abs() <= 4e-16), "{point} lost its owner");
        } else if let (Some(exact), Some(found)) = (b(&whole, point), b(&scene, point)) {
            // Faces of the parts are rounded by up to two units of 1.1e-16 of the size. This
            // changes the field as much as moving the point by this distance, so the gradients of
            // the whole and of its parts bound the change.
            let moved = 4.0 * 1.1e-16 * tile.size().max_element();
            let alone: Vec<Scene> = parts.iter().map(|t| Scene::new(&[*t])).collect();
            let slopes: f64 = alone.iter().chain([&whole]).filter_map(|s| s.gradient(Quantity::FluxDensity, point).ok())
                .map(|g| g.to_cols_array().iter().map(|c| c.abs()).fold(0.0, f64::max)).sum();
            let sum: f64 = alone.iter().filter_map(|s| b(s, point)).map(DVec3::length).sum();
            let allowed = 2e-14 * (sum + tile.polarization_t().length()) + 3.0 * moved * slopes;
            prop_assert!((found - exact).length() <= allowed, "{found}, not {exact}, at {point}; allowed {allowed:e}");
        }
    }

    /// Reversing J reverses B, and scaling lengths by a power of two does not change it, both to
    /// the last bit. Mirroring exchanges near and far corners and mirrors B up to round-off.
    #[test]
    fn reversed_scaled_and_mirrored_tiles(tile in scenes::tile(12.0), places in scenes::face_offsets(), axis in 0..3_usize, exponent in -200..200_i32) {
        let (j, point) = (tile.polarization_t(), scenes::point(&tile, places));
        let own = b(&Scene::new(&[tile]), point);
        let reversed = rebuilt(&tile, tile.position(), tile.size(), -j);
        prop_assert_eq!(b(&Scene::new(&[reversed]), point), own.map(|b| -b));

        let factor = 2_f64.powi(exponent);
        let scaled = rebuilt(&tile, factor * tile.position(), factor * tile.size(), j);
        prop_assert_eq!(b(&Scene::new(&[scaled]), factor * point), own);

        if !on_a_face(&tile, point) {
            let mut signs = DVec3::ONE;
            signs[axis] = -1.0;
            let mirrored = rebuilt(&tile, signs * tile.position(), tile.size(), signs * j);
            let found = b(&Scene::new(&[mirrored]), signs * point);
            prop_assert_eq!(found.is_some(), own.is_some());
            if let (Some(found), Some(own)) = (found, own) {
                let alone = |j: DVec3| {
                    let tile = rebuilt(&tile, tile.position(), tile.size(), j);
                    b(&Scene::new(&[tile]), point).map_or(f64::INFINITY, DVec3::length)
                };
                let sum: f64 = DVec3::AXES.iter().filter(|a| j.dot(**a) != 0.0).map(|a| alone(*a * j.dot(*a))).sum();
                prop_assert!((signs * found - own).length() <= 4e-14 * sum, "{found} is no mirror image of {own}");
            }
        }
    }

    /// The gradient is symmetric and without trace (div B = 0, curl H = 0), and agrees with
    /// differences of the field.
    #[test]
    fn gradient_of_a_rotated_tile(
        tile in scenes::tile(2.0),
        rotation in scenes::rotation(),
        direction in scenes::polarization(),
        distance in 1.0..3.0_f64,
    ) {
        let tile = tile.rotated(rotation).unwrap();
        let scene = Scene::new(&[tile]);
        let reach = tile.size().length();
        let point = tile.position() + distance * reach * direction.normalize();
        let gradient = scene.gradient(Quantity::FluxDensity, point).unwrap();
        let size = gradient.to_cols_array().into_iter().map(f64::abs).fold(0.0, f64::max);
        let trace = gradient.x_axis.x + gradient.y_axis.y + gradient.z_axis.z;
        let skew = (gradient - gradient.transpose()).to_cols_array().into_iter().map(f64::abs).fold(0.0, f64::max);
        // Rotating the tensor there and back adds a few roundings.
        prop_assert!(trace.abs() <= 1e-14 * size && skew <= 1e-14 * size, "trace {trace:e}, skew {skew:e} of {size:e}");

        // Fourth-order differences with step h. Truncation: h^4 / 30 times the fifth derivative.
        // For a field that falls as r^-3 this derivative is 4 5 6 7 / d^4 of the gradient, with d
        // >= reach / 2 the distance to the body: 28 (2e-3)^4 = 4.5e-10. Rounding: 1e-15 |B| / h,
        // with |B| below 1.5 reach times the gradient: 3e-12.
        let h = 1e-3 * reach;
        for axis in 0..3 {
            let step = |n: f64| b(&scene, point + n * h * DVec3::AXES[axis]).unwrap();
            let slope = (8.0 * (step(1.0) - step(-1.0)) - (step(2.0) - step(-2.0))) / (12.0 * h);
            let error = (slope - gradient.col(axis)).length();
            prop_assert!(error <= 5e-10 * size, "axis {axis}: off by {error:e} of {size:e}");
        }
    }

    /// Far away the field and its gradient approach the field and gradient of a dipole as (size /
    /// distance)^2.
    #[test]
    fn distant_fields_approach_a_dipole(tile in scenes::tile(4.0), direction in scenes::polarization(), decades in 1.0..12.0_f64) {
        let (n, longest) = (direction.normalize(), tile.size().max_element());
        let distance = longest * 10_f64.powf(decades);
        let point = tile.position() + distance * n;
        // The direction and the distance after rounding the point.
        let r = point - tile.position();
        let (n, distance) = (r.normalize(), r.length());
        let moment = tile.polarization_t() * tile.size().element_product() / (4.0 * PI);
        let along = moment.dot(n);
        let field = (3.0 * along * n - moment) / distance.powi(3);
        let outer = |a: DVec3, b: DVec3| DMat3::from_cols(a * b.x, a * b.y, a * b.z);
        let gradient = 3.0 / distance.powi(4)
            * (outer(moment, n) + outer(n, moment) + along * (DMat3::IDENTITY - 5.0 * outer(n, n)));
        let scene = Scene::new(&[tile]);
        let allowed = 10.0 * (longest / distance).powi(2) + 2e-14;
        let found = b(&scene, point).unwrap();
        prop_assert!((found - field).length() <= allowed * field.length());
        let found = scene.gradient(Quantity::FluxDensity, point).unwrap();
        let error = (found - gradient).to_cols_array().into_iter().map(f64::abs).fold(0.0, f64::max);
        let size = gradient.to_cols_array().into_iter().map(f64::abs).fold(0.0, f64::max);
        prop_assert!(error <= 3.0 * allowed * size, "gradient off by {:e}", error / size);
    }
}
