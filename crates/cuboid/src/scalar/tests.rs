//! The scalar kernel against a law.

use glam::DVec3;

use super::kernel::{FieldKind, cuboid_field};
use crate::block::{Block, LocalPoint};
use crate::tolerances::EXACT_BOUND;

/// Inside a tile, B = mu0 H + J for any direction of J. The scalar kernel computes the two from
/// different elements there.
#[test]
fn flux_density_inside_is_the_strength_plus_the_polarization() {
    let polarizations = [DVec3::X, DVec3::new(0.3, -0.7, 0.0), DVec3::new(0.5, 0.0, 0.2), DVec3::new(-0.4, 0.6, 1.1)];
    for size in [DVec3::ONE, DVec3::new(3.3, 1.7, 1.0), DVec3::new(1.0, 1.0, 0.02), DVec3::new(0.05, 1.0, 0.05)] {
        for j in polarizations {
            let block = Block::new(0, DVec3::ZERO, size, j, 0.1);
            for n in 0..50 {
                let turn = f64::from(n);
                let place = DVec3::new((0.754 * turn).fract(), (0.569 * turn).fract(), (0.311 * turn).fract()) - 0.5;
                let at = LocalPoint { coordinates: (0.99 * place * size).to_array(), roundoff: [0.0; 3] };
                let placed = block.place(&at).expect("near enough");
                let [density, strength] = [FieldKind::Density, FieldKind::Strength]
                    .map(|kind| DVec3::from(cuboid_field(&placed.offsets, j.to_array(), kind)));
                let error = (density - strength - j).length();
                // No element of either tensor is larger than one at these points.
                let magnitude: f64 = 3.0 * j.to_array().iter().map(|component| component.abs()).sum::<f64>();
                assert!(error <= 2.0 * EXACT_BOUND * magnitude, "{size}, {j}: {error:e} at {place}");
            }
        }
    }
}
