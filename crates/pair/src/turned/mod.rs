//! Mean tensor, force and torque of two cuboids turned against each other.
//!
//! Integrals extend over the smaller cuboid in the exact field of the larger, because that field is
//! smoother there and the integrals need fewer parts.

use glam::DVec3;
use magsplice_field::Scene;
use magsplice_magnet::Tile;

/// The mean tensor, by averages over the volume.
pub(crate) mod average;
/// Force and torque, by the charges of faces.
pub(crate) mod charges;

/// A box in the frame of another box: its centre, and half of each side as a vector.
#[derive(Clone, Copy)]
struct TurnedBox {
    centre: DVec3,
    sides: [DVec3; 3],
}

impl TurnedBox {
    /// A tile in the frame of `source`, with the centre of `source` at the origin.
    fn in_frame_of(source: &Tile, tile: &Tile) -> TurnedBox {
        let to_source = source.rotation().inverse();
        let relative = to_source * tile.rotation();
        TurnedBox {
            centre: to_source * (tile.position() - source.position()),
            sides: [0, 1, 2].map(|axis: usize| relative * (0.5 * tile.size()[axis] * DVec3::AXES[axis])),
        }
    }
}

/// A tile with another polarization in its own frame, with its centre at the origin.
fn scene_of(source: &Tile, polarization_t: DVec3) -> Scene {
    let tile = Tile::new(DVec3::ZERO, source.size(), polarization_t);
    Scene::new(&[tile.expect("a tile that is moved to the origin obeys the same rules")])
}
