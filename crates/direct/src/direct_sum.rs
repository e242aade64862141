//! Tiles prepared for the exact field, and the vector instructions.

use std::cell::OnceCell;
use std::sync::{Arc, OnceLock};

use fearless_simd::Level;
use glam::{DMat3, DVec3};
use magsplice_cuboid::block::PlacedPoint;
use magsplice_cuboid::scalar::kernel::FieldKind;
use magsplice_cuboid::tolerances::EXACT_BOUND;
use magsplice_magnet::{
    BoundingBox, MU_0, PointError, PointErrorCause, PointErrors, Quantity, Tile, Tolerance, is_in_range,
};
use magsplice_simd::column::Column;

use super::batches::{Batches, PointProgress, for_each_batch};
use super::edges::EdgesAtPoint;
use super::gradient_sum::GradientSum;
use super::magnitude::{LeastField, MagnitudeBounds};
use super::sum::Sum;
use crate::prepare::frames::Frames;
use crate::tolerances::{DECIDED_BY_BOX, POINTS_OF_ONE_TILE, POINTS_PER_BATCH, REGROUPED_PARTS};

/// Smallest length of a field whose square is a normal number.
const LEAST_COMPARED: f64 = 1e-153;

/// Number of points compared with a bound at a time, without a branch.
const POINTS_COMPARED: usize = 64;

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
        }
    }

    /// Replaces the indices of tiles in errors.
    pub fn with_owners(self, owners: Arc<[usize]>) -> DirectSum {
        DirectSum { owners: Some(owners), ..self }
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
    /// [`EXACT_BOUND`]: 1, and more for tiles with moved faces.
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

    /// The division of points into batches.
    fn batches(&self) -> Batches {
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
        self.field_and_magnitudes_of_batch(quantity, points, field, None, failed);
    }

    /// [`DirectSum::field_of_batch`] with upper bounds of the magnitude of a single tile, if
    /// requested.
    fn field_and_magnitudes_of_batch(
        &self,
        quantity: Quantity,
        points: &[DVec3],
        field: &mut [DVec3],
        magnitudes_t: Option<&mut Vec<f64>>,
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
            sum.sum_all(self.level, &self.frames, kind, points, field, magnitudes_t);
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

    /// Writes the exact field at every point where it keeps the tolerance; returns the other
    /// points, where `field` is NaN.
    pub fn field_within_into(
        &self,
        tolerance: Tolerance,
        quantity: Quantity,
        points: &[DVec3],
        field: &mut [DVec3],
        progress: PointProgress,
    ) -> Vec<PointError> {
        let evaluated = for_each_batch(points, field, self.batches(), progress, |points, field, failed| {
            self.field_of_batch_within(tolerance, quantity, points, field, failed);
        });
        evaluated.err().map_or(Vec::new(), |errors| errors.0)
    }

    /// The field at each point of a batch. Points without one, and points at which the bound of its
    /// error does not keep the tolerance, are passed to `failed`, and their field is NaN.
    fn field_of_batch_within(
        &self,
        tolerance: Tolerance,
        quantity: Quantity,
        points: &[DVec3],
        field: &mut [DVec3],
        failed: &mut dyn FnMut(usize, PointErrorCause),
    ) {
        let per_tesla = if quantity == Quantity::FieldStrength { 1.0 / MU_0 } else { 1.0 };
        let (magnitudes, least) = (self.magnitudes(), LeastField::new(tolerance));
        let least_t = |magnitude_t: f64| least.at_t(EXACT_BOUND * magnitude_t);
        // Smallest square of the field that a magnitude allows.
        let least_squared = |magnitude_t: f64| {
            let least = least_t(magnitude_t) * per_tesla;
            // Squares that are normal numbers can be compared.
            if least > 0.0 { least.max(LEAST_COMPARED).powi(2) } else { 0.0 }
        };
        let is_weak = |value: &DVec3, least: f64| value.length_squared() < least;
        let in_box_t = OnceCell::new();
        let of_box = || magnitudes.in_box_t(&self.boxes, &BoundingBox::from_points(points));
        let in_box_t = || *in_box_t.get_or_init(of_box);
        let decides = |magnitude_t: f64| least_t(magnitude_t) <= DECIDED_BY_BOX * magnitude_t;
        let is_only = self.frames.only_tile().is_some();
        let by_closed_form = is_only && !decides(magnitudes.largest_t()) && !decides(in_box_t());
        let mut magnitudes_t = Vec::new();
        let wanted = by_closed_form.then_some(&mut magnitudes_t);
        self.field_and_magnitudes_of_batch(quantity, points, field, wanted, failed);
        // One bound for all points decides nearly all batches, and a bound for the box around the
        // points most of the others.
        let any_weak = |least: f64| {
            field.chunks(POINTS_COMPARED).any(|some| some.iter().fold(false, |any, b| any | is_weak(b, least)))
        };
        if !by_closed_form && (!any_weak(least_squared(magnitudes.largest_t())) || !any_weak(least_squared(in_box_t())))
        {
            return;
        }
        // Without a branch for each point, because usually no field is weak.
        let any_weak_by_own = |own_t: &[f64]| {
            let points = field.chunks(POINTS_COMPARED).zip(own_t.chunks(POINTS_COMPARED));
            points.into_iter().any(|(some, own_t)| {
                some.iter().zip(own_t).fold(false, |any, (b, own_t)| any | is_weak(b, least_squared(*own_t)))
            })
        };
        if magnitudes_t.len() == field.len() && !any_weak_by_own(&magnitudes_t) {
            return;
        }
        let least_in_box = least_squared(in_box_t());
        let is_open = |index: usize| {
            let least = magnitudes_t.get(index).map_or(least_in_box, |own_t| least_squared(*own_t));
            is_weak(&field[index], least)
        };
        let open = indices_where(points.len(), is_open);
        if open.is_empty() {
            return;
        }
        let at_open: Vec<DVec3> = open.iter().map(|&index| points[index as usize]).collect();
        let own_t = if !is_only {
            self.magnitudes_t(&at_open)
        } else if by_closed_form {
            magnitudes_t.resize(points.len(), f64::INFINITY);
            self.completed_magnitudes_t(&at_open, open.iter().map(|&index| magnitudes_t[index as usize]).collect())
        } else {
            let (mut again, mut own_t) = (vec![DVec3::ZERO; open.len()], Vec::new());
            self.field_and_magnitudes_of_batch(quantity, &at_open, &mut again, Some(&mut own_t), &mut |_, _| ());
            own_t.resize(open.len(), f64::INFINITY);
            self.completed_magnitudes_t(&at_open, own_t)
        };
        let is_refused = |number: usize| is_weak(&field[open[number] as usize], least_squared(own_t[number]));
        for number in indices_where(open.len(), is_refused) {
            let (index, magnitude_t) = (open[number as usize] as usize, own_t[number as usize]);
            field[index] = DVec3::NAN;
            failed(index, PointErrorCause::TooExact { bound_t: EXACT_BOUND * magnitude_t });
        }
    }

    /// The bounds of a single tile from its closed form, completed at points of other methods,
    /// where they are infinite.
    fn completed_magnitudes_t(&self, points: &[DVec3], mut magnitudes_t: Vec<f64>) -> Vec<f64> {
        let others = indices_where(points.len(), |index| magnitudes_t[index].is_infinite());
        let at_others: Vec<DVec3> = others.iter().map(|&index| points[index as usize]).collect();
        let others_t = self.magnitudes_t(&at_others);
        others.iter().zip(others_t).for_each(|(&index, own_t)| magnitudes_t[index as usize] = own_t);
        magnitudes_t
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
            for (index, gradient) in gradient.iter_mut().enumerate() {
                let is_singular = sum.is_singular(index);
                if !gradient.is_finite() && !is_singular {
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
        for_each_batch(points, gradient, self.batches(), &|_| {}, |points, gradient, failed| {
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
        let tile = edges.tile().or(blocks.tile()).expect("the point is singular");
        self.owners.as_ref().map_or(tile, |owners| owners[tile])
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

/// The indices below `count` that are `wanted`, found without a branch for each.
fn indices_where(count: usize, wanted: impl Fn(usize) -> bool) -> Vec<u32> {
    let (mut indices, mut found) = (vec![0; count], 0);
    for index in 0..count {
        indices[found] = index as u32;
        found += usize::from(wanted(index));
    }
    indices.truncate(found);
    indices
}
