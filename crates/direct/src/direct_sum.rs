//! Tiles prepared for the exact field, and the vector instructions.

use std::sync::{Arc, OnceLock};

use fearless_simd::Level;
use glam::{DMat3, DVec3};
use magsplice_cuboid::block::PlacedPoint;
use magsplice_cuboid::scalar::kernel::FieldKind;
use magsplice_magnet::{BoundingBox, MU_0, PointErrorCause, PointErrors, Quantity, Tile, is_in_range};
use magsplice_simd::column::Column;

use super::batches::{Batches, PointProgress, for_each_batch};
use super::edges::EdgesAtPoint;
use super::gradient_sum::GradientSum;
use super::magnitude::MagnitudeBounds;
use super::sum::Sum;
use super::weak_points::{MethodBounds, WeakPoints};
use crate::prepare::frames::{Frame, Frames};
use crate::tolerances::{POINTS_OF_ONE_TILE, POINTS_PER_BATCH, REGROUPED_PARTS};

/// Tiles prepared for direct summation.
#[derive(Clone, Debug)]
pub struct DirectSum {
    frames: Frames,
    tiles: Vec<Tile>,
    /// The index in errors of each tile, if it differs from the position of the tile.
    owners: Option<Arc<[usize]>>,
    /// The box around each tile.
    boxes: Vec<BoundingBox>,
    /// See [`DirectSum::error_weights`].
    error_weights: Vec<f64>,
    level: Level,
    /// Built when a tolerance first needs it.
    magnitudes: OnceLock<MagnitudeBounds>,
    /// Likewise, for a scene of one tile.
    by_method: OnceLock<MethodBounds>,
}

impl DirectSum {
    /// Prepares tiles.
    pub fn new(tiles: &[Tile], level: Level) -> DirectSum {
        let frames = Frames::new(tiles);
        let mut error_weights = vec![1.0; tiles.len()];
        for block in frames.frames().iter().flat_map(|frame| &frame.unmerged) {
            error_weights[block.tile] = block.error_weight();
        }
        DirectSum {
            frames,
            error_weights,
            tiles: tiles.to_vec(),
            owners: None,
            boxes: tiles.iter().map(BoundingBox::from_tile).collect(),
            level,
            magnitudes: OnceLock::new(),
            by_method: OnceLock::new(),
        }
    }

    /// Replaces the indices of tiles in errors.
    pub fn with_owners(self, owners: Arc<[usize]>) -> DirectSum {
        DirectSum { owners: Some(owners), ..self }
    }

    /// The index of a tile in errors.
    pub fn owner(&self, tile: usize) -> usize {
        self.owners.as_ref().map_or(tile, |owners| owners[tile])
    }

    /// Replaces the vector instructions.
    pub fn with_level(self, level: Level) -> DirectSum {
        DirectSum { level, ..self }
    }

    /// The tiles by orientation.
    pub fn frames(&self) -> &Frames {
        &self.frames
    }

    /// The tiles, as given.
    pub fn tiles(&self) -> &[Tile] {
        &self.tiles
    }

    /// The bounding box of each tile.
    pub fn boxes(&self) -> &[BoundingBox] {
        &self.boxes
    }

    /// The error bound of the field of each tile over
    /// [`EXACT_BOUND`](magsplice_cuboid::tolerances::EXACT_BOUND): 1, and more for tiles with moved
    /// faces.
    pub fn error_weights(&self) -> &[f64] {
        &self.error_weights
    }

    /// The vector instructions in use.
    pub fn level(&self) -> Level {
        self.level
    }

    pub(super) fn magnitudes(&self) -> &MagnitudeBounds {
        self.magnitudes.get_or_init(|| MagnitudeBounds::new(&self.tiles, &self.error_weights))
    }

    /// Bounds of the magnitude of the only tile, which has this frame.
    pub(super) fn magnitudes_by_method(&self, frame: &Frame) -> &MethodBounds {
        let ranges = &frame.clusters.tiles[0].ranges;
        self.by_method.get_or_init(|| MethodBounds::new(&frame.blocks[0], ranges, self.magnitudes()))
    }

    /// The division of points into batches.
    pub(super) fn batches(&self) -> Batches {
        let parts = self.frames.frames().iter().map(|frame| frame.clusters.parts()).sum::<usize>();
        let most = if self.frames.only_tile().is_some() { POINTS_OF_ONE_TILE } else { POINTS_PER_BATCH[1] };
        // Many clusters change their methods at different points, so a batch holds neighbouring
        // points.
        Batches { most, regroup: parts >= REGROUPED_PARTS }
    }

    /// The field at each point of a batch. Points without a field are passed to `failed`, and their
    /// field is NaN.
    pub fn field_of_batch(
        &self,
        quantity: Quantity,
        points: &[DVec3],
        field: &mut [DVec3],
        failed: &mut dyn FnMut(usize, PointErrorCause),
    ) {
        self.field_and_weak_points_of_batch(quantity, points, field, None, failed);
    }

    /// [`DirectSum::field_of_batch`] with the points of a single tile whose field may be too weak
    /// for a tolerance, if requested.
    pub(super) fn field_and_weak_points_of_batch(
        &self,
        quantity: Quantity,
        points: &[DVec3],
        field: &mut [DVec3],
        weak: Option<&mut WeakPoints>,
        failed: &mut dyn FnMut(usize, PointErrorCause),
    ) {
        let kind = match quantity {
            Quantity::FluxDensity => FieldKind::Density,
            Quantity::FieldStrength => FieldKind::Strength,
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
        self.field_of_batch_by(kind, points, field, failed, |sum, field| {
            sum.sum_all(self.level, &self.frames, kind, points, field, weak);
        });
    }

    /// [`DirectSum::field_of_batch`] with B or mu0 H in tesla written by `evaluate`.
    pub fn field_of_batch_by(
        &self,
        kind: FieldKind,
        points: &[DVec3],
        field: &mut [DVec3],
        failed: &mut dyn FnMut(usize, PointErrorCause),
        evaluate: impl FnOnce(&mut Sum, &mut [DVec3]),
    ) {
        Sum::with_buffers(|sum| {
            evaluate(sum, field);
            if kind == FieldKind::Strength {
                field.iter_mut().for_each(|h| *h /= MU_0);
            }
            for (index, edges) in sum.edges() {
                if edges.exposed() {
                    failed(index, PointErrorCause::Unbounded { tile: self.tile_with_edge_at(points[index], edges) });
                    field[index] = DVec3::NAN;
                }
            }
            if sum.is_finite() {
                return;
            }
            for (index, field) in field.iter_mut().enumerate() {
                // The point or the result is out of range.
                if !field.is_finite() && !sum.is_exposed(index) {
                    failed(index, PointErrorCause::OutOfRange);
                    *field = DVec3::NAN;
                }
            }
        });
    }

    /// The exact field at every point.
    ///
    /// # Errors
    /// All points without a field at once; their entries of `field` are NaN and all others are
    /// valid.
    pub fn exact_field_into(
        &self,
        quantity: Quantity,
        points: &[DVec3],
        field: &mut [DVec3],
    ) -> Result<(), PointErrors> {
        self.exact_field_with_progress(quantity, points, field, &|_| {})
    }

    /// [`DirectSum::exact_field_into`] with progress.
    pub fn exact_field_with_progress(
        &self,
        quantity: Quantity,
        points: &[DVec3],
        field: &mut [DVec3],
        progress: PointProgress,
    ) -> Result<(), PointErrors> {
        for_each_batch(points, field, self.batches(), progress, |points, field, failed| {
            self.field_of_batch(quantity, points, field, failed);
        })
    }

    /// Upper bounds, in tesla, of the sum over tiles of the magnitudes of the fields of the single
    /// components of J, times their [error weights](DirectSum::error_weights). Points must be in
    /// range.
    pub fn magnitudes_t(&self, points: &[DVec3]) -> Vec<f64> {
        let mut magnitudes_t = Column::default();
        self.magnitudes().write(self.level, points.iter().copied(), &mut magnitudes_t);
        magnitudes_t[..points.len()].to_vec()
    }

    /// The gradient of B at each point of a batch: column j is dB/dx_j, in tesla per unit of
    /// length. Points without a gradient are passed to `failed`, and their gradient is NaN.
    pub fn flux_density_gradient_of_batch(
        &self,
        points: &[DVec3],
        gradient: &mut [DMat3],
        failed: &mut dyn FnMut(usize, PointErrorCause),
    ) {
        GradientSum::with_buffers(|sum| {
            sum.sum_all(self.level, &self.frames, points, gradient);
            for (index, edges) in sum.edges().filter(|(_, edges)| edges.singular()) {
                let tile = self.tile_with_edge_at(points[index], edges);
                failed(
                    index,
                    if edges.exposed() {
                        PointErrorCause::Unbounded { tile }
                    } else {
                        PointErrorCause::Unresolved { tile }
                    },
                );
                gradient[index] = DMat3::NAN;
            }
            if sum.is_finite() {
                return;
            }
            for (index, gradient) in gradient.iter_mut().enumerate() {
                if !gradient.is_finite() && !sum.is_singular(index) {
                    failed(index, PointErrorCause::OutOfRange);
                    *gradient = DMat3::NAN;
                }
            }
        });
    }

    /// The gradient of B at every point of `points`, written to `gradient` in the same order, in
    /// parallel.
    ///
    /// # Errors
    /// All points without a gradient at once; their entries are then NaN and all others are valid.
    ///
    /// # Panics
    /// If the two slices differ in length.
    pub fn flux_density_gradient_into(&self, points: &[DVec3], gradient: &mut [DMat3]) -> Result<(), PointErrors> {
        // A gradient has twice the components of a field, so half the points fill the first cache.
        let batches = Batches { most: self.batches().most / 2, ..self.batches() };
        for_each_batch(points, gradient, batches, &|_| {}, |points, gradient, failed| {
            self.flux_density_gradient_of_batch(points, gradient, failed);
        })
    }

    /// Index in errors of a tile whose edge makes the point singular. `blocks` are the edges of
    /// merged blocks.
    fn tile_with_edge_at(&self, point: DVec3, blocks: &EdgesAtPoint) -> usize {
        let mut edges = EdgesAtPoint::default();
        for (frame, local) in self.frames.locals(point) {
            for block in &frame.unmerged {
                if let Some(placed) = block.place(&local).filter(PlacedPoint::on_edge_line) {
                    edges.add(block, &placed, &frame.to_scene);
                }
            }
        }
        self.owner(edges.tile().or(blocks.tile()).expect("the point is singular"))
    }

    fn polarization(&self, point: DVec3) -> Result<DVec3, PointErrorCause> {
        check_range(point)?;
        let mut total = DVec3::ZERO;
        for (frame, local) in self.frames.locals(point) {
            for block in &frame.blocks {
                if block.place(&local).is_some_and(|placed| placed.inside()) {
                    total += frame.to_scene.vector(block.polarization_t);
                }
            }
        }
        Ok(total)
    }
}

fn check_range(point: DVec3) -> Result<(), PointErrorCause> {
    if is_in_range(point) { Ok(()) } else { Err(PointErrorCause::OutOfRange) }
}
