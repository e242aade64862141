//! Prepared tiles with the vector instructions: the exact field.

use fearless_simd::Level;
use glam::{DMat3, DVec3};
use magsplice_cuboid::block::{Block, LocalPoint, PlacedPoint};
use magsplice_cuboid::field_bound::{field_bound_t, tile_field_bound_t};
use magsplice_cuboid::scalar::kernel::{FieldKind, cuboid_field};
use magsplice_cuboid::tolerances::EXACT_BOUND;
use magsplice_magnet::{BoundingBox, Cause, MU_0, PointError, PointErrors, Quantity, Tile, Tolerance, is_in_range};
use rayon::prelude::*;

use super::batches::{Batches, for_each_batch};
use super::edges::EdgesAtPoint;
use super::gradient_sum::GradientSum;
use super::sum::Sum;
use crate::prepare::frames::Frames;
use crate::tolerances::{DIPOLE_DISTANCE, POINTS_OF_ONE_TILE, POINTS_PER_BATCH, REGROUPED_PARTS};

/// Tiles prepared for direct summation.
#[derive(Clone, Debug)]
pub(crate) struct DirectSum {
    frames: Frames,
    tiles: Vec<Tile>,
    /// The box around each tile.
    boxes: Vec<BoundingBox>,
    level: Level,
}

impl DirectSum {
    /// Prepares tiles.
    pub(crate) fn new(tiles: &[Tile], level: Level) -> DirectSum {
        DirectSum {
            frames: Frames::new(tiles),
            tiles: tiles.to_vec(),
            boxes: tiles.iter().map(BoundingBox::from_tile).collect(),
            level,
        }
    }

    /// The same tiles with other vector instructions.
    pub(crate) fn with_level(self, level: Level) -> DirectSum {
        DirectSum { level, ..self }
    }

    pub(crate) fn frames(&self) -> &Frames {
        &self.frames
    }

    pub(crate) fn tiles(&self) -> &[Tile] {
        &self.tiles
    }

    pub(crate) fn boxes(&self) -> &[BoundingBox] {
        &self.boxes
    }

    pub(crate) fn level(&self) -> Level {
        self.level
    }

    /// Upper bound of [`DirectSum::magnitude_t`] that evaluates no field.
    pub(crate) fn most_magnitude_t(&self, point: DVec3) -> f64 {
        let at = BoundingBox { lower: point, upper: point };
        self.boxes
            .iter()
            .zip(&self.tiles)
            .map(|(around, tile)| tile_field_bound_t(tile, around.gap(&at).length()))
            .sum()
    }

    /// Upper bound, in tesla, of the sum over tiles of the magnitudes of the fields that the
    /// components of J make alone at a point. Errors of the exact field are stated relative to it.
    /// For tiles many sizes away it is the bound of dipoles, at most four times too large; for near
    /// tiles the fields are evaluated.
    pub(crate) fn magnitude_t(&self, point: DVec3) -> f64 {
        let own = |block: &Block, local: &LocalPoint| {
            let gap = block.gap(local);
            let half_diagonal = 0.5 * DVec3::from(block.size).length();
            if gap > DIPOLE_DISTANCE * half_diagonal {
                return field_bound_t(DVec3::from(block.size), block.polarization_t, gap);
            }
            let Some(placed) = block.place(local) else { return 0.0 };
            let of_component = |axis: DVec3| {
                let own = cuboid_field(&placed.offsets, (block.polarization_t * axis).to_array(), FieldKind::Density);
                DVec3::from(own).length()
            };
            DVec3::AXES.into_iter().map(of_component).sum()
        };
        let of_frames = self.frames.locals(point);
        of_frames.map(|(frame, local)| frame.blocks.iter().map(|block| own(block, &local)).sum::<f64>()).sum()
    }

    /// The division of points into batches.
    fn batches(&self) -> Batches {
        let parts = self.frames.frames().iter().map(|frame| frame.clusters.parts()).sum::<usize>();
        let most = if self.frames.only_tile().is_some() { POINTS_OF_ONE_TILE } else { POINTS_PER_BATCH[1] };
        // Many clusters change their methods at different points, so that a batch holds
        // neighbouring points.
        Batches { most, regroup: parts >= REGROUPED_PARTS }
    }

    /// The field at each point of a batch. Points without one are passed to `failed`, and their
    /// field is NaN.
    pub(crate) fn field_of_batch(
        &self,
        quantity: Quantity,
        points: &[DVec3],
        field: &mut [DVec3],
        failed: &mut dyn FnMut(usize, Cause),
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
            sum.sum_all(self.level, &self.frames, kind, points, field);
        });
    }

    /// [`DirectSum::field_of_batch`] with B or mu0 H in tesla written by `evaluate`.
    pub(crate) fn field_of_batch_by(
        &self,
        kind: FieldKind,
        points: &[DVec3],
        field: &mut [DVec3],
        failed: &mut dyn FnMut(usize, Cause),
        evaluate: impl FnOnce(&mut Sum, &mut [DVec3]),
    ) {
        Sum::with_buffers(|sum| {
            evaluate(sum, field);
            if kind == FieldKind::Strength {
                field.iter_mut().for_each(|h| *h /= MU_0);
            }
            for (index, edges) in sum.edges() {
                if edges.exposed() {
                    failed(index, Cause::Unbounded { tile: self.tile_with_edge_at(points[index], edges) });
                    field[index] = DVec3::NAN;
                }
            }
            if sum.is_finite() {
                return;
            }
            for (index, field) in field.iter_mut().enumerate() {
                // The point or the result is out of range.
                if !field.is_finite() && !sum.is_exposed(index) {
                    failed(index, Cause::OutOfRange);
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
    pub(crate) fn exact_field_into(
        &self,
        quantity: Quantity,
        points: &[DVec3],
        field: &mut [DVec3],
    ) -> Result<(), PointErrors> {
        for_each_batch(points, field, self.batches(), |points, field, failed| {
            self.field_of_batch(quantity, points, field, failed);
        })
    }

    /// Writes the exact field at the points with these indices, where it keeps the tolerance;
    /// returns the other points.
    pub(crate) fn exact_at(
        &self,
        tolerance: Tolerance,
        quantity: Quantity,
        points: &[DVec3],
        indices: &[usize],
        field: &mut [DVec3],
    ) -> Vec<PointError> {
        let chosen: Vec<DVec3> = indices.iter().map(|&index| points[index]).collect();
        let mut values = vec![DVec3::ZERO; chosen.len()];
        let errors = self.checked_exact_into(tolerance, quantity, &chosen, &mut values);
        for (&index, value) in indices.iter().zip(values) {
            field[index] = value;
        }
        errors.into_iter().map(|error| PointError { index: indices[error.index], ..error }).collect()
    }

    /// Writes the exact field where it keeps the tolerance; returns the other points.
    fn checked_exact_into(
        &self,
        tolerance: Tolerance,
        quantity: Quantity,
        points: &[DVec3],
        field: &mut [DVec3],
    ) -> Vec<PointError> {
        let mut errors = self.exact_field_into(quantity, points, field).err().map_or(Vec::new(), |errors| errors.0);
        let in_tesla = if quantity == Quantity::FieldStrength { MU_0 } else { 1.0 };
        let most_t: f64 = self.tiles.iter().map(|tile| tile_field_bound_t(tile, 0.0)).sum();
        let checked = points.par_iter().zip(field).enumerate().filter_map(|(index, (&point, value))| {
            // Cheap upper bounds of the sum over tiles decide nearly all points.
            let is_kept = |magnitude_t: f64| tolerance.is_kept(*value * in_tesla, EXACT_BOUND * magnitude_t);
            if value.is_nan() || is_kept(most_t) || is_kept(self.most_magnitude_t(point)) {
                return None;
            }
            let magnitude_t = self.magnitude_t(point);
            if is_kept(magnitude_t) {
                return None;
            }
            *value = DVec3::NAN;
            Some(PointError { index, point, cause: Cause::TooExact { bound_t: EXACT_BOUND * magnitude_t } })
        });
        errors.extend(checked.collect::<Vec<PointError>>());
        errors.sort_by_key(|error| error.index);
        errors
    }

    /// The gradient of B at each point of a batch: column j is dB/dx_j, in tesla per unit of length.
    /// Points without one are passed to `failed`, and their gradient is NaN.
    pub(crate) fn flux_density_gradient_of_batch(
        &self,
        points: &[DVec3],
        gradient: &mut [DMat3],
        failed: &mut dyn FnMut(usize, Cause),
    ) {
        GradientSum::with_buffers(|sum| {
            sum.sum_all(self.level, &self.frames, points, gradient);
            for (index, edges) in sum.edges().filter(|(_, edges)| edges.singular()) {
                let tile = self.tile_with_edge_at(points[index], edges);
                failed(index, if edges.exposed() { Cause::Unbounded { tile } } else { Cause::Unresolved { tile } });
                gradient[index] = DMat3::NAN;
            }
            for (index, gradient) in gradient.iter_mut().enumerate() {
                let is_singular = sum.is_singular(index);
                if !gradient.is_finite() && !is_singular {
                    failed(index, Cause::OutOfRange);
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
    pub(crate) fn flux_density_gradient_into(
        &self,
        points: &[DVec3],
        gradient: &mut [DMat3],
    ) -> Result<(), PointErrors> {
        for_each_batch(points, gradient, self.batches(), |points, gradient, failed| {
            self.flux_density_gradient_of_batch(points, gradient, failed);
        })
    }

    /// Index of a tile whose edge makes the point singular. `blocks` are the edges of merged
    /// blocks.
    fn tile_with_edge_at(&self, point: DVec3, blocks: &EdgesAtPoint) -> usize {
        let mut edges = EdgesAtPoint::default();
        for (frame, local) in self.frames.locals(point) {
            for block in &frame.unmerged {
                if let Some(placed) = block.place(&local).filter(PlacedPoint::on_edge_line) {
                    edges.add(block, &placed, &frame.to_scene);
                }
            }
        }
        edges.tile().or(blocks.tile()).expect("the point is singular")
    }

    fn polarization(&self, point: DVec3) -> Result<DVec3, Cause> {
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

fn check_range(point: DVec3) -> Result<(), Cause> {
    if is_in_range(point) { Ok(()) } else { Err(Cause::OutOfRange) }
}
