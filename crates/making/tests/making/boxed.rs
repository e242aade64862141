//! Boxes of cut and measured tiles, for tests and for the example `boxes`.

use glam::DQuat;
use magsplice_layout::{Layout, Part};
use magsplice_making::{CutTile, PlaceGroup};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

fn normal(random: &mut ChaCha8Rng) -> f64 {
    let (radius, turn) = (1.0 - random.random::<f64>(), random.random::<f64>());
    (-2.0 * radius.ln()).sqrt() * (std::f64::consts::TAU * turn).cos()
}

/// A box with errors of 3 % of strength and 1 degree about both axes normal to J, with spare tiles
/// as a share of the places.
pub(crate) fn boxed(layout: &Layout, seed: u64, spares: f64) -> Vec<PlaceGroup> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let group = |part: Part| {
        let nominal_t = part.strength_t * part.direction;
        let across = part.direction.any_orthonormal_vector();
        let axes = [across, part.direction.cross(across)];
        let count = (part.count as f64 * (1.0 + spares)).round() as usize;
        let tiles = (0..count)
            .map(|number| {
                let turn = DQuat::from_scaled_axis(
                    axes[0] * normal(&mut random).to_radians() + axes[1] * normal(&mut random).to_radians(),
                );
                let polarization_t = (1.0 + 0.03 * normal(&mut random)) * (turn * nominal_t);
                CutTile { name: format!("{}-{number}", part.example), polarization_t, size_mm: part.size_mm }
            })
            .collect();
        PlaceGroup { size_mm: part.size_mm, polarization_t: nominal_t, places: part.tiles, tiles }
    };
    layout.parts().into_iter().map(group).collect()
}
