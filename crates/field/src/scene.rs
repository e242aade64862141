//! Tiles together: the superposed field of a film.

use std::sync::OnceLock;

use fearless_simd::Level;
use glam::{DMat3, DVec3};

use crate::arrangement::{Arrangement, ToScene};
use crate::batch::Superposition;
use crate::batch::assignment::Assigned;
use crate::batch::instruction_set::{InstructionSet, MissingInstructions};
use crate::batch::tree::Tree;
use crate::block::{Block, Local, Placed};
use crate::edge_policy::Edges;
use crate::evaluate::Batches;
use crate::kernel::{Part, cuboid_field, cuboid_gradient};
use crate::quantity::{MU_0, Quantity};
use crate::tile::Tile;
use crate::tolerances::{DIPOLE_DISTANCE, MAX_LENGTH, POINTS_OF_ONE_TILE, POINTS_PER_BATCH, REGROUPED_PARTS};
use crate::two_sum::RunningSum;
use crate::within::accuracy::Accuracy;
use crate::within::magnitude::{Box3, most_field_of_t, most_field_t};

/// Tiles prepared for evaluation. Their fields add up; tiles do not influence each other.
///
/// Every point has one owner at most: a tile owns its points with lo <= p < hi along each of its axes, and faces of
/// touching tiles are recognised as one (within 8 units of round-off of their coordinates, 32 for rotated tiles). On the seam of
/// two tiles with the same polarization the field is that of the block they form.
///
/// # Units
/// Lengths in any one unit, the same for tiles and points. Polarization and B in tesla, H in ampere per metre.
///
/// # Accuracy
/// Of a single unrotated tile, B and H are right to 2e-14 (typically 1e-15) of the sum of the fields that the three components of J
/// make alone, at every point: far, near, thin, on edge extensions and on faces (one-sided limits); beside the tile, nearer than 0.08 of its
/// largest side, to 4e-15. See docs/accuracy.md. In a scene
/// the error is that fraction of the sum over tiles. In the frame of a rotated tile the point is off by up to four units of round-off of its distance
/// from the tiles with that orientation, and on a face within that distance of one.
///
/// The bounds hold for every [`InstructionSet`].
#[derive(Clone, Debug)]
pub struct Scene {
    arrangement: Arrangement,
    tiles: Vec<Tile>,
    /// Around each tile.
    boxes: Vec<Box3>,
    level: Level,
    accuracy: Accuracy,
    /// Made when first needed.
    tree: OnceLock<Tree>,
}

/// Why there is no field at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cause {
    /// The point is on an exposed edge or corner, where the field grows without bound like the logarithm of the distance.
    Unbounded {
        /// Index of a tile with that edge.
        tile: usize,
    },
    /// The point is on an edge that tiles share whose singular terms cancel. The field is given there, but the
    /// gradient would be the difference of terms without bound.
    Unresolved {
        /// Index of a tile with that edge.
        tile: usize,
    },
    /// A coordinate of the point is not finite, or beyond [`MAX_LENGTH`]; or the result is beyond the range of numbers.
    OutOfRange,
    /// The tolerance cannot be kept: the exact field has at most this error in tesla, and that is more.
    TooExact {
        /// The bound of the exact field's error.
        bound_t: f64,
    },
}

impl Scene {
    /// Prepares tiles for evaluation. Indices of tiles in answers are positions in `tiles`.
    pub fn new(tiles: &[Tile]) -> Scene {
        Scene {
            arrangement: Arrangement::of(tiles),
            tiles: tiles.to_vec(),
            boxes: tiles.iter().map(Box3::of_tile).collect(),
            level: Level::new(),
            accuracy: Accuracy::Exact,
            tree: OnceLock::new(),
        }
    }

    /// How many tiles there are.
    pub fn tile_count(&self) -> usize {
        self.tiles.len()
    }

    pub(crate) fn tiles(&self) -> &[Tile] {
        &self.tiles
    }

    pub(crate) fn boxes(&self) -> &[Box3] {
        &self.boxes
    }

    pub(crate) fn level(&self) -> Level {
        self.level
    }

    /// The same scene evaluated to this accuracy by [`Scene::field_into`] and [`Scene::field_on_grid`]. Single points, gradients and J are exact
    /// in any case.
    ///
    /// Whether exact values keep a tolerance is decided by 2e-14 of the sum over tiles. The rounding of points in the frames of rotated tiles (see
    /// Accuracy above) is not in that: beside rotated tiles far from others of their orientation a tolerance near it may be missed.
    pub fn with_accuracy(self, accuracy: Accuracy) -> Scene {
        Scene { accuracy, tree: OnceLock::new(), ..self }
    }

    /// For the tolerance of the scene.
    pub(crate) fn tree(&self) -> &Tree {
        self.tree.get_or_init(|| {
            let most_j_t = self.tiles.iter().map(|tile| tile.polarization_t().length()).fold(0.0, f64::max);
            Tree::of(self.level, &self.arrangement, &self.tiles, self.accuracy.degree(most_j_t))
        })
    }

    /// How exact fields are made.
    pub fn accuracy(&self) -> Accuracy {
        self.accuracy
    }

    /// At most [`Scene::magnitude_t`], without computing a field.
    pub(crate) fn most_magnitude_t(&self, point: DVec3) -> f64 {
        let at = Box3 { lower: point, upper: point };
        self.boxes.iter().zip(&self.tiles).map(|(around, tile)| most_field_t(tile, around.gap(&at).length())).sum()
    }

    /// At most the sum over tiles of the magnitudes of the fields that the components of J make alone at a point, in tesla: what errors are
    /// measured by. Of tiles many sizes away it is the bound of dipoles, at most four times too large; of near ones it is computed.
    pub(crate) fn magnitude_t(&self, point: DVec3) -> f64 {
        let own = |block: &Block, local: &Local| {
            let gap = block.gap(local);
            let half_diagonal = 0.5 * DVec3::from(block.size).length();
            if gap > DIPOLE_DISTANCE * half_diagonal {
                return most_field_of_t(DVec3::from(block.size), block.polarization_t, gap);
            }
            let Some(placed) = block.place(local) else { return 0.0 };
            let of_component = |axis: DVec3| {
                let own = cuboid_field(&placed.offsets, (block.polarization_t * axis).to_array(), Part::Density);
                DVec3::from(own).length()
            };
            DVec3::AXES.into_iter().map(of_component).sum()
        };
        let of_frames = self.arrangement.locals(point);
        of_frames.map(|(frame, local)| frame.blocks.iter().map(|block| own(block, &local)).sum::<f64>()).sum()
    }

    /// How points are divided for the exact field.
    pub(crate) fn batches(&self) -> Batches {
        let parts = self.arrangement.frames().iter().map(|frame| frame.table.parts()).sum::<usize>();
        let most = if self.arrangement.only_tile().is_some() { POINTS_OF_ONE_TILE } else { POINTS_PER_BATCH[1] };
        // So many parts take their own forms that points of a batch should be neighbours.
        Batches { most, regroup: parts >= REGROUPED_PARTS }
    }

    /// The same scene computed with these instructions instead of the best ones the processor has.
    ///
    /// # Errors
    /// If the processor lacks them.
    pub fn with_instruction_set(self, set: InstructionSet) -> Result<Scene, MissingInstructions> {
        let level = set.detected().ok_or(MissingInstructions(set))?;
        Ok(Scene { level, tree: OnceLock::new(), ..self })
    }

    /// The field at one point, digit for digit what [`Scene::field_into`] gives there.
    ///
    /// # Errors
    /// If the field is unbounded at the point or the point is not a finite number; never a value that is not finite.
    pub fn field(&self, quantity: Quantity, point: DVec3) -> Result<DVec3, Cause> {
        let (mut field, mut failure) = ([DVec3::NAN], None);
        self.field_of_batch(quantity, None, &[point], &mut field, &mut |_, cause| failure = Some(cause));
        failure.map_or(Ok(field[0]), Err)
    }

    /// The field at each point of a batch, or of those parts of the tree that have been assigned to it; points without one are handed to `failed`, and their
    /// field is NaN.
    pub(crate) fn field_of_batch(
        &self,
        quantity: Quantity,
        assigned: Option<Assigned>,
        points: &[DVec3],
        field: &mut [DVec3],
        failed: &mut dyn FnMut(usize, Cause),
    ) {
        let part = match quantity {
            Quantity::FluxDensity => Part::Density,
            Quantity::FieldStrength => Part::Strength,
            Quantity::Polarization => {
                for (index, (&point, polarization)) in points.iter().zip(field).enumerate() {
                    *polarization = self.polarization(point).unwrap_or_else(|cause| {
                        failed(index, cause);
                        DVec3::NAN
                    });
                }
                return;
            }
        };
        Superposition::of_this_thread(|superposition| {
            let assigned = assigned.map(|assigned| (self.tree(), assigned));
            superposition.add_up(self.level, &self.arrangement, assigned, part, points, field);
            if part == Part::Strength {
                field.iter_mut().for_each(|h| *h /= MU_0);
            }
            for (index, edges) in superposition.edges() {
                if edges.exposed() {
                    failed(index, Cause::Unbounded { tile: self.tile_with_edge_at(points[index], edges) });
                    field[index] = DVec3::NAN;
                }
            }
            if superposition.is_finite() {
                return;
            }
            for (index, field) in field.iter_mut().enumerate() {
                // Where the point is out of range, or the result.
                if !field.is_finite() && !superposition.is_exposed(index) {
                    failed(index, Cause::OutOfRange);
                    *field = DVec3::NAN;
                }
            }
        });
    }

    /// The gradient of B at one point: column j is dB/dx_j, in tesla per unit of length.
    ///
    /// Inside a tile as outside it is mu0 times the gradient of H, so it is symmetric and without trace. On a face it is
    /// the limit from the side of the point's owner.
    ///
    /// # Accuracy
    /// Of a single unrotated tile, every component is right to 2e-14 (typically 5e-16) of the largest component, at every point; in a
    /// scene to that fraction of the sum over tiles.
    ///
    /// # Errors
    /// If the gradient is unbounded at the point, if it cannot be resolved there (see [`Cause::Unresolved`]), or if the point
    /// is not a finite number.
    pub fn flux_density_gradient(&self, point: DVec3) -> Result<DMat3, Cause> {
        let (sum, edges) = self.sum_over_tiles::<9>(point, |block, placed, to_scene| {
            let gradient = cuboid_gradient(&placed.offsets, block.polarization_t.to_array());
            let scaled = gradient.map(|row| row.map(|slope| slope * placed.scale));
            to_scene.tensor(DMat3::from_cols_array_2d(&scaled)).to_cols_array()
        })?;
        match (edges.exposed(), edges.singular()) {
            (true, _) => Err(Cause::Unbounded { tile: self.tile_with_edge_at(point, &edges) }),
            (false, true) => Err(Cause::Unresolved { tile: self.tile_with_edge_at(point, &edges) }),
            (false, false) if sum.iter().all(|c| c.is_finite()) => Ok(DMat3::from_cols_array(&sum)),
            (false, false) => Err(Cause::OutOfRange),
        }
    }

    /// Adds what `term` gives for every tile that matters at `point`, and collects the edges the point lies on.
    fn sum_over_tiles<const N: usize>(
        &self,
        point: DVec3,
        term: impl Fn(&Block, &Placed, &ToScene) -> [f64; N],
    ) -> Result<([f64; N], Edges), Cause> {
        check_range(point)?;
        let mut sum = [RunningSum::default(); N];
        let mut edges = Edges::default();
        for (frame, local) in self.arrangement.locals(point) {
            for block in &frame.blocks {
                let Some(placed) = block.place(&local) else { continue };
                for (total, term) in sum.iter_mut().zip(term(block, &placed, &frame.to_scene)) {
                    total.add(term);
                }
                if placed.on_edge_line() {
                    edges.add(block, &placed, &frame.to_scene);
                }
            }
        }
        Ok((sum.map(RunningSum::value), edges))
    }

    /// A tile whose edge makes the point singular, as `blocks`, which may be several tiles each, do.
    fn tile_with_edge_at(&self, point: DVec3, blocks: &Edges) -> usize {
        let mut edges = Edges::default();
        for (frame, local) in self.arrangement.locals(point) {
            for block in &frame.unmerged {
                if let Some(placed) = block.place(&local).filter(Placed::on_edge_line) {
                    edges.add(block, &placed, &frame.to_scene);
                }
            }
        }
        edges.tile().or(blocks.tile()).expect("the point is singular")
    }

    fn polarization(&self, point: DVec3) -> Result<DVec3, Cause> {
        check_range(point)?;
        let mut total = DVec3::ZERO;
        for (frame, local) in self.arrangement.locals(point) {
            for block in &frame.blocks {
                if block.place(&local).is_some_and(|placed| placed.inside()) {
                    total += frame.to_scene.vector(block.polarization_t);
                }
            }
        }
        Ok(total)
    }
}

fn check_range(point: DVec3) -> Result<(), Cause> {
    if is_in_range(point) { Ok(()) } else { Err(Cause::OutOfRange) }
}

pub(crate) fn is_in_range(point: DVec3) -> bool {
    // Componentwise, so that NaN fails the test.
    point.abs().cmple(DVec3::splat(MAX_LENGTH)).all()
}
