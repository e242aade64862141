//! Tiles together: the superposed field of a film.

use glam::{DMat3, DVec3};

use crate::block::Block;
use crate::edge_policy::EdgeCharge;
use crate::kernel::offsets::Offsets;
use crate::kernel::{Part, cuboid_field};
use crate::orientation;
use crate::quantity::{MU_0, Quantity};
use crate::seam::join_faces;
use crate::tile::Tile;
use crate::tolerances::{MAX_LENGTH, ROTATED_SEAM_ROUNDINGS, SEAM_ROUNDINGS};
use crate::two_sum::RunningSum;

/// Tiles prepared for evaluation. Their fields add up; tiles do not influence each other.
///
/// Every point has one owner at most: a tile owns its points with lo <= p < hi along each of its axes, and faces of
/// touching tiles are recognised as one (within four units of round-off of their coordinates, sixteen for rotated tiles). On
/// the seam of two tiles with the same polarization the field is that of the block they form.
///
/// # Units
/// Lengths in any one unit, the same for tiles and points. Polarization and B in tesla, H in ampere per metre.
///
/// # Accuracy
/// Of a single unrotated tile, |B| and |H| have relative error below 1e-13 at every point (typically 1e-15), far, near, thin, on
/// edge extensions and on faces (one-sided limits): see docs/accuracy.md. In a scene the error is that fraction of the sum of
/// the magnitudes of the tiles' fields. Rotation moves the point in the tile's frame by at most four units of round-off of its
/// distance from the tile.
#[derive(Clone, Debug)]
pub struct Scene {
    frames: Vec<Frame>,
    tiles: usize,
}

/// Blocks with a common orientation.
#[derive(Clone, Debug)]
struct Frame {
    /// From the frame to the scene, and the frame's origin; `None` for the scene's own frame.
    pose: Option<(DMat3, DVec3)>,
    blocks: Vec<Block>,
}

impl Frame {
    fn to_frame(&self, point: DVec3) -> DVec3 {
        self.pose.map_or(point, |(rotation, origin)| rotation.transpose() * (point - origin))
    }

    fn to_scene(&self, vector: DVec3) -> DVec3 {
        self.pose.map_or(vector, |(rotation, _)| rotation * vector)
    }
}

/// Why there is no field at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// The point is on an exposed edge or corner, where the field grows without bound like the logarithm of the distance.
    Unbounded {
        /// Index of a tile with that edge.
        tile: usize,
    },
    /// A coordinate of the point is not finite, or beyond [`MAX_LENGTH`].
    OutOfRange,
}

impl Scene {
    /// Prepares tiles for evaluation. Indices of tiles in answers are positions in `tiles`.
    pub fn new(tiles: &[Tile]) -> Scene {
        let rotations: Vec<_> = tiles.iter().map(Tile::rotation).collect();
        let (members, rotations) = orientation::frames(&rotations);
        let smallest = tiles.iter().map(|t| t.size().min_element()).fold(f64::INFINITY, f64::min);
        let mut frames: Vec<Frame> = Vec::with_capacity(rotations.len());
        let own_frame = Frame { pose: None, blocks: Vec::new() };
        frames.push(own_frame);
        frames.extend(rotations[1..].iter().map(|&r| Frame { pose: Some((r, DVec3::NAN)), blocks: Vec::new() }));
        for (index, (tile, (frame, turn))) in tiles.iter().zip(&members).enumerate() {
            let frame = &mut frames[*frame];
            if let Some((_, origin)) = &mut frame.pose
                && frame.blocks.is_empty()
            {
                *origin = tile.position();
            }
            let centre = frame.to_frame(tile.position());
            let block = Block::new(index, centre, turn.size(tile.size()), turn.vector(tile.polarization_t()), smallest);
            frame.blocks.push(block);
        }
        let extent = tiles.iter().map(|t| t.position().abs().max_element()).fold(0.0, f64::max);
        for frame in &mut frames {
            let rotated = frame.pose.is_some();
            join_faces(&mut frame.blocks, |block, axis| {
                let reach = block.faces[axis].iter().map(|f| f.hi.abs()).fold(0.0, f64::max);
                let roundings =
                    if rotated { ROTATED_SEAM_ROUNDINGS * (extent + reach) } else { SEAM_ROUNDINGS * reach };
                roundings * 0.5 * f64::EPSILON
            });
        }
        Scene { frames, tiles: tiles.len() }
    }

    /// How many tiles there are.
    pub fn tile_count(&self) -> usize {
        self.tiles
    }

    /// The field at one point.
    ///
    /// # Errors
    /// If the field is unbounded at the point or the point is not a finite number; never a value that is not finite.
    pub fn field(&self, quantity: Quantity, point: DVec3) -> Result<DVec3, Cause> {
        // Componentwise, so that NaN fails the test.
        if !point.abs().cmple(DVec3::splat(MAX_LENGTH)).all() {
            return Err(Cause::OutOfRange);
        }
        match quantity {
            Quantity::FluxDensity => self.sum_over_tiles(Part::Density, point),
            Quantity::FieldStrength => Ok(self.sum_over_tiles(Part::Strength, point)? / MU_0),
            Quantity::Polarization => Ok(self.polarization(point)),
        }
    }

    fn sum_over_tiles(&self, part: Part, point: DVec3) -> Result<DVec3, Cause> {
        let mut total = [RunningSum::default(); 3];
        let mut edges = EdgeCharge::default();
        for frame in &self.frames {
            if frame.blocks.is_empty() {
                continue;
            }
            let local = frame.to_frame(point);
            let mut sum = [RunningSum::default(); 3];
            for block in &frame.blocks {
                let Some(offsets) = block.offsets(local) else { continue };
                let field = cuboid_field(&offsets, block.polarization_t.to_array(), part);
                for (component, term) in sum.iter_mut().zip(field) {
                    component.add(term);
                }
                if offsets.iter().filter(|o| o.on_face).count() >= 2 {
                    edges.add(block, &offsets, |v| frame.to_scene(v));
                }
            }
            let field = frame.to_scene(DVec3::from_array(sum.map(RunningSum::value)));
            for (component, term) in total.iter_mut().zip(field.to_array()) {
                component.add(term);
            }
        }
        match edges.exposed() {
            Some(tile) => Err(Cause::Unbounded { tile }),
            None => Ok(DVec3::from_array(total.map(RunningSum::value))),
        }
    }

    fn polarization(&self, point: DVec3) -> DVec3 {
        let mut total = DVec3::ZERO;
        for frame in &self.frames {
            let local = frame.to_frame(point);
            for block in &frame.blocks {
                let owns = block.offsets(local).is_some_and(|offsets| offsets.iter().all(Offsets::within));
                if owns {
                    total += frame.to_scene(block.polarization_t);
                }
            }
        }
        total
    }
}
