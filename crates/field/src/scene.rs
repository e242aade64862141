//! The field of many cuboids: the facade over direct summation, tree and interpolation.

use fearless_simd::Level;
use glam::{DMat3, DVec3};
use magsplice_magnet::{
    Accuracy, BoundingBox, Grid, IronPlanes, MU_0, PointError, PointErrorCause, PointErrors, Quantity, Tile,
    TileBehindPlane, Tolerance,
};
use magsplice_simd::{InstructionSet, MissingInstructions};

use crate::interpolation::fitted_field::{FittedField, FittedFieldError};
use crate::plan::{Plan, plan_at_points, plan_on_grid};
use crate::tolerances::GRID_POINTS_AT_ONCE;
use crate::tree::lazy_tree::LazyTree;
use crate::within::{at_points, on_grid};
use magsplice_direct::batches::none_or;
use magsplice_direct::direct_sum::DirectSum;

/// Tiles prepared for evaluation. Fields of tiles add up without mutual influence.
///
/// Every point has at most one owner: a tile owns its points with lo <= p < hi along each of its
/// axes. Faces of touching tiles count as one if their coordinates differ by at most 8 units of
/// round-off (32 for rotated tiles). On the seam of two tiles with the same polarization the field
/// is the field of the merged block.
///
/// # Units
/// Lengths are in any one unit, the same for tiles and points. Polarization and B are in tesla, H
/// in ampere per metre.
///
/// # Accuracy
/// The error of B and H of a single unrotated tile is at most [`EXACT_BOUND`](crate::EXACT_BOUND)
/// (typically 1e-15) of the sum of the magnitudes of the fields of the three components of J, at
/// every point: far, near, beside thin tiles, on edge extensions and on faces (one-sided limits).
/// See docs/accuracy.md. In a scene the error is that fraction of the sum over tiles. In the frame
/// of a rotated tile the point has an error of up to four units of round-off of its distance from
/// the tiles with that orientation, and counts as on a face within that distance.
///
/// The bounds hold for every [`InstructionSet`].
///
/// # Example
/// ```
/// use glam::DVec3;
/// use magsplice_field::Scene;
/// use magsplice_magnet::{Quantity, Tile};
///
/// let cube = Tile::new(DVec3::ZERO, DVec3::ONE, DVec3::new(0.0, 0.0, 1.2))?;
/// let scene = Scene::new(&[cube]);
/// // The demagnetizing factors at the centre of a cube are one third each.
/// let b_t = scene.field(Quantity::FluxDensity, DVec3::ZERO)?;
/// assert!((b_t.z - 0.8).abs() < 1e-15);
/// // On an edge the field is unbounded, which is an error.
/// assert!(scene.field(Quantity::FluxDensity, DVec3::new(0.5, 0.0, 0.5)).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Scene {
    direct: DirectSum,
    accuracy: Accuracy,
    tree: LazyTree,
    /// Number of tiles, which precede their images.
    tiles: usize,
    iron: Iron,
}

impl Scene {
    /// Prepares tiles for evaluation. Indices of tiles in errors refer to `tiles`.
    pub fn new(tiles: &[Tile]) -> Scene {
        Scene::of_direct(DirectSum::new(tiles, Level::new()))
    }

    fn of_direct(direct: DirectSum) -> Scene {
        let (tree, tiles) = (LazyTree::new(&direct, Accuracy::Exact), direct.tiles().len());
        Scene { tree, accuracy: Accuracy::Exact, tiles, iron: Iron::default(), direct }
    }

    /// Prepares the cells of divided tiles. `owners` holds the index of the tile of each cell, for
    /// errors.
    ///
    /// # Panics
    /// If the numbers of cells and owners differ.
    pub fn of_cells(cells: &[Tile], owners: &[usize]) -> Scene {
        assert_eq!(cells.len(), owners.len(), "one owner for each cell");
        Scene::of_direct(DirectSum::new(cells, Level::new()).with_owners(owners.into()))
    }

    /// Adds the field of flat iron that the tiles magnetize, as the field of their images. The
    /// scene then has a field before all planes only, and no other iron.
    ///
    /// One plane adds no error. Between two planes the field lacks the images of
    /// [`Scene::truncation_error_t`], beside the error of its accuracy.
    ///
    /// # Errors
    /// The first tile that is not before all planes.
    pub fn with_planes(self, planes: &IronPlanes) -> Result<Scene, TileBehindPlane> {
        if planes.is_empty() && self.planes().is_empty() {
            return Ok(self);
        }
        let own = &self.direct.tiles()[..self.tiles];
        let images = planes.images(own)?;
        let owner = |tile: usize| self.direct.owner(tile);
        let owners: Vec<usize> = (0..own.len()).chain(images.owners).map(owner).collect();
        let tiles = [own, &images.tiles].concat();
        let direct = DirectSum::new(&tiles, self.direct.level()).with_owners(owners.into());
        let iron = Iron { planes: planes.clone(), truncation_error_t: images.truncation_error_t };
        Ok(Scene { tree: LazyTree::new(&direct, self.accuracy), direct, iron, ..self })
    }

    /// The iron around the tiles.
    pub fn planes(&self) -> &IronPlanes {
        &self.iron.planes
    }

    /// Largest flux density of the omitted images between two planes of iron, in tesla; 0 without.
    pub fn truncation_error_t(&self) -> f64 {
        self.iron.truncation_error_t
    }

    /// Number of tiles with their images.
    pub fn tile_count(&self) -> usize {
        self.direct.tiles().len()
    }

    /// The box around all tiles, without images.
    pub fn bounding_box(&self) -> BoundingBox {
        BoundingBox::from_tiles(&self.direct.tiles()[..self.tiles])
    }

    /// The accuracy of the fields.
    pub fn accuracy(&self) -> Accuracy {
        self.accuracy
    }

    /// Sets the accuracy of [`Scene::field_into`], [`Scene::field_at`] and the calls for grids.
    /// Single points, gradients and J are always exact.
    ///
    /// Where no faster model keeps the tolerance, the field is exact. A tolerance takes at most
    /// little more time than the exact field, except tolerances below 1e-9 beside a few tiles, long
    /// thin tiles, and refused points, which take up to four times as long.
    ///
    /// Exact values keep a tolerance if [`EXACT_BOUND`](crate::EXACT_BOUND) times an upper bound of
    /// the sum over tiles keeps it (docs/physics.md, section 2.10); other points are refused. Tiles
    /// whose faces were joined to other faces count more. The median of the bound is about
    /// twice the sum. The largest factors found beside random single tiles are 15 for a cube, 25
    /// for aspects up to 10, and 60 for aspects up to 1000. The bound excludes the rounding of
    /// points in the frames of rotated tiles (see Accuracy above): close to rotated tiles and far
    /// from others of their orientation a tolerance near that rounding may be missed.
    pub fn with_accuracy(self, accuracy: Accuracy) -> Scene {
        Scene { accuracy, tree: LazyTree::new(&self.direct, accuracy), ..self }
    }

    /// Sets the vector instructions, in place of the best instructions of the processor.
    ///
    /// # Errors
    /// If the processor lacks them.
    pub fn with_instruction_set(self, set: InstructionSet) -> Result<Scene, MissingInstructions> {
        let level = set.detected().ok_or(MissingInstructions(set))?;
        let direct = self.direct.with_level(level);
        Ok(Scene { tree: LazyTree::new(&direct, self.accuracy), direct, ..self })
    }

    /// The exact field at one point, bit-identical to the value of [`Scene::field_into`] in an
    /// exact scene.
    ///
    /// # Errors
    /// If the field is unbounded at the point or the point is not a finite number. Returned values
    /// are finite.
    pub fn field(&self, quantity: Quantity, point: DVec3) -> Result<DVec3, PointErrorCause> {
        self.iron.check(point)?;
        let (mut field, mut failure) = ([DVec3::NAN], None);
        self.direct.field_of_batch(quantity, &[point], &mut field, &mut |_, cause| failure = Some(cause));
        failure.map_or(Ok(field[0]), Err)
    }

    /// The field at every point, in the order of the points; [`Scene::field_into`] with a new
    /// vector.
    ///
    /// # Errors
    /// All points without a field at once.
    pub fn field_at(&self, quantity: Quantity, points: &[DVec3]) -> Result<Vec<DVec3>, PointErrors> {
        let mut field = vec![DVec3::ZERO; points.len()];
        self.field_into(quantity, points, &mut field).map(|()| field)
    }

    /// The field at every point, written to `field` in the order of the points, in parallel over
    /// points, to the [`Accuracy`] of the scene.
    ///
    /// An exact field is bit-identical for any number of threads and any division of the points
    /// into calls. Memory does not grow with tiles times points.
    ///
    /// # Errors
    /// All points without a field at once; their entries of `field` are NaN and all others are
    /// valid.
    ///
    /// # Panics
    /// If the two slices differ in length.
    pub fn field_into(&self, quantity: Quantity, points: &[DVec3], field: &mut [DVec3]) -> Result<(), PointErrors> {
        self.field_with_progress(quantity, points, field, &|_| {})
    }

    /// [`Scene::field_into`] with progress. `progress` receives, from any thread, the number of
    /// points that begin: a few thousand at a time, all interpolated points, or 0 where points
    /// begin anew with another model.
    ///
    /// # Errors
    /// As [`Scene::field_into`].
    ///
    /// # Panics
    /// If the two slices differ in length. A panic of `progress` ends the evaluation and reaches
    /// the caller, which permits interruption.
    pub fn field_with_progress(
        &self,
        quantity: Quantity,
        points: &[DVec3],
        field: &mut [DVec3],
        progress: &(dyn Fn(usize) + Sync),
    ) -> Result<(), PointErrors> {
        let result = match self.tolerance_for(quantity) {
            Some(tolerance) => {
                assert_eq!(points.len(), field.len(), "one value per point");
                none_or(at_points(&self.direct, &self.tree, tolerance, quantity, points, field, progress))
            }
            None => self.direct.exact_field_with_progress(quantity, points, field, progress),
        };
        self.iron.without_inner(result, points.iter().copied(), field, DVec3::NAN)
    }

    /// Upper bound of the error of the exact B at each point, in tesla:
    /// [`EXACT_BOUND`](crate::EXACT_BOUND) times an upper bound of the sum over tiles of the
    /// magnitudes of the fields of the three components of J, and the error of joined faces.
    /// Omitted images between planes of iron count.
    ///
    /// A component of B below the bound may be pure rounding. The bound is infinite at points that
    /// are not finite. It excludes the displacement of points in the frames of rotated tiles (see
    /// [`Scene`]).
    pub fn error_bounds_t(&self, points: &[DVec3]) -> Vec<f64> {
        let mut bounds_t = self.direct.error_bounds_t(points);
        bounds_t.iter_mut().for_each(|bound_t| *bound_t += self.iron.truncation_error_t);
        bounds_t
    }

    /// The field at every point of a grid, z fastest; [`Scene::field_on_grid_into`] with a new
    /// vector.
    ///
    /// # Errors
    /// All points without a field at once.
    pub fn field_on_grid(&self, quantity: Quantity, grid: &Grid) -> Result<Vec<DVec3>, PointErrors> {
        let mut field = vec![DVec3::ZERO; grid.len()];
        self.field_on_grid_into(quantity, grid, &mut field).map(|()| field)
    }

    /// The field at every point of a grid, z fastest, like [`Scene::field_into`].
    ///
    /// Within a tolerance a fine grid away from the tiles takes much less time than the same points
    /// in a list, because it is evaluated by Chebyshev interpolation (docs/physics.md, section 5).
    /// The result is bit-identical for any number of threads.
    ///
    /// # Errors
    /// All points without a field at once; their entries of `field` are NaN and all others are
    /// valid.
    ///
    /// # Panics
    /// If `field` does not have one entry for each point.
    pub fn field_on_grid_into(&self, quantity: Quantity, grid: &Grid, field: &mut [DVec3]) -> Result<(), PointErrors> {
        self.field_on_grid_with_progress(quantity, grid, field, &|_| {})
    }

    /// [`Scene::field_on_grid_into`] with the progress of [`Scene::field_with_progress`].
    /// Interpolated points are reported all at once.
    ///
    /// # Errors
    /// As [`Scene::field_on_grid_into`].
    ///
    /// # Panics
    /// If `field` does not have one entry for each point, and if `progress` does.
    pub fn field_on_grid_with_progress(
        &self,
        quantity: Quantity,
        grid: &Grid,
        field: &mut [DVec3],
        progress: &(dyn Fn(usize) + Sync),
    ) -> Result<(), PointErrors> {
        assert_eq!(grid.len(), field.len(), "one value per point");
        if let Some(tolerance) = self.tolerance_for(quantity) {
            let errors = on_grid(&self.direct, &self.tree, tolerance, quantity, grid, field, progress);
            return self.iron.without_inner(none_or(errors), grid.points(), field, DVec3::NAN);
        }
        let mut errors = Vec::new();
        for (number, field) in field.chunks_mut(GRID_POINTS_AT_ONCE).enumerate() {
            let start = number * GRID_POINTS_AT_ONCE;
            let points = grid.points_in(start..start + field.len());
            if let Err(PointErrors(found)) = self.direct.exact_field_with_progress(quantity, &points, field, progress) {
                errors.extend(found.into_iter().map(|error| PointError { index: start + error.index, ..error }));
            }
        }
        self.iron.without_inner(none_or(errors), grid.points(), field, DVec3::NAN)
    }

    /// The gradient at one point: column j is the derivative along x_j, in the unit of the quantity
    /// per unit of length.
    ///
    /// The gradient of B is mu0 times the gradient of H inside and outside tiles, so it is
    /// symmetric without trace. The gradient of J is zero. On a face the gradient is the limit from
    /// the side of the point's owner.
    ///
    /// # Accuracy
    /// The error of every component of a single unrotated tile is at most
    /// [`GRADIENT_BOUND`](crate::GRADIENT_BOUND) (typically 5e-16) of the sum of the largest
    /// components for each component of J, at every point; in a scene it is at most that fraction
    /// of the sum over tiles.
    ///
    /// # Errors
    /// If the gradient is unbounded at the point, if it cannot be resolved there (see
    /// [`PointErrorCause::Unresolved`]), or if the point is not a finite number.
    pub fn gradient(&self, quantity: Quantity, point: DVec3) -> Result<DMat3, PointErrorCause> {
        self.iron.check(point)?;
        let (mut gradient, mut failure) = ([DMat3::NAN], None);
        self.direct.flux_density_gradient_of_batch(&[point], &mut gradient, &mut |_, cause| failure = Some(cause));
        failure.map_or(Ok(in_unit_of(quantity, gradient[0])), Err)
    }

    /// The gradient at every point, in the order of the points; [`Scene::gradient_into`] with a new
    /// vector.
    ///
    /// # Errors
    /// All points without a gradient at once.
    pub fn gradient_at(&self, quantity: Quantity, points: &[DVec3]) -> Result<Vec<DMat3>, PointErrors> {
        let mut gradient = vec![DMat3::ZERO; points.len()];
        self.gradient_into(quantity, points, &mut gradient).map(|()| gradient)
    }

    /// The gradient of [`Scene::gradient`] at every point, written to `gradient` in the order of
    /// the points, in parallel over points.
    ///
    /// # Errors
    /// All points without a gradient at once; their entries are NaN and all others are valid.
    ///
    /// # Panics
    /// If the two slices differ in length.
    pub fn gradient_into(
        &self,
        quantity: Quantity,
        points: &[DVec3],
        gradient: &mut [DMat3],
    ) -> Result<(), PointErrors> {
        let result = self.direct.flux_density_gradient_into(points, gradient);
        let result = self.iron.without_inner(result, points.iter().copied(), gradient, DMat3::NAN);
        gradient.iter_mut().for_each(|gradient| *gradient = in_unit_of(quantity, *gradient));
        result
    }

    /// B in the box between two corners, prepared for repeated look-ups within a tolerance.
    ///
    /// # Errors
    /// See [`FittedFieldError`].
    pub fn fitted_field(
        &self,
        lower: DVec3,
        upper: DVec3,
        tolerance: Tolerance,
    ) -> Result<FittedField, FittedFieldError> {
        if [lower, upper].into_iter().any(|corner| self.iron.check(corner).is_err()) {
            return Err(FittedFieldError::InIron);
        }
        FittedField::new(&self.direct, lower, upper, tolerance)
    }

    /// The models of [`Scene::field_on_grid_into`] for a grid. Interpolations are built to test
    /// whether they keep the tolerance, so planning takes a part of the time of the evaluation.
    pub fn plan_on_grid(&self, grid: &Grid) -> Plan {
        plan_on_grid(&self.direct, &self.tree, self.accuracy, grid)
    }

    /// The models of [`Scene::field_into`] for points. The tree is built and the field at some of
    /// the points is computed, so planning takes a part of the time of the evaluation. Points out
    /// of range do not count.
    pub fn plan_at_points(&self, points: &[DVec3]) -> Plan {
        plan_at_points(&self.direct, &self.tree, self.accuracy, points)
    }

    fn tolerance_for(&self, quantity: Quantity) -> Option<Tolerance> {
        match (self.accuracy, quantity) {
            (Accuracy::Within(tolerance), Quantity::FluxDensity | Quantity::FieldStrength) => Some(tolerance),
            (Accuracy::Exact, _) | (_, Quantity::Polarization) => None,
        }
    }
}

/// The iron around a scene.
#[derive(Clone, Debug, Default)]
struct Iron {
    planes: IronPlanes,
    truncation_error_t: f64,
}

impl Iron {
    fn check(&self, point: DVec3) -> Result<(), PointErrorCause> {
        self.planes.plane_before(point).map_or(Ok(()), |plane| Err(PointErrorCause::InIron { plane }))
    }

    /// Replaces the values of points in iron, where the images give no field, by `nan` and errors.
    fn without_inner<V: Copy>(
        &self,
        result: Result<(), PointErrors>,
        points: impl Iterator<Item = DVec3>,
        values: &mut [V],
        nan: V,
    ) -> Result<(), PointErrors> {
        if self.planes.is_empty() {
            return result;
        }
        let mut errors = result.err().unwrap_or(PointErrors(Vec::new())).0;
        errors.retain(|error| self.check(error.point).is_ok());
        for (index, (point, value)) in points.zip(values.iter_mut()).enumerate() {
            if let Err(cause) = self.check(point) {
                *value = nan;
                errors.push(PointError { index, point, cause });
            }
        }
        errors.sort_by_key(|error| error.index);
        none_or(errors)
    }
}

/// The gradient of a quantity from the gradient of B.
fn in_unit_of(quantity: Quantity, gradient: DMat3) -> DMat3 {
    match quantity {
        Quantity::FluxDensity => gradient,
        Quantity::FieldStrength => gradient / MU_0,
        Quantity::Polarization => gradient * 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_in_cells_name_their_tiles() {
        let cell = |x: f64| Tile::new(DVec3::new(x, 0.0, 0.0), DVec3::ONE, DVec3::Z).unwrap();
        let cells = [cell(0.0), cell(1.0), cell(3.0)];
        let scene = Scene::of_cells(&cells, &[7, 7, 4]);
        for (x, tile) in [(1.5, 7), (3.5, 4)] {
            let point = DVec3::new(x, 0.0, 0.5);
            assert_eq!(scene.field(Quantity::FluxDensity, point), Err(PointErrorCause::Unbounded { tile }));
            assert_eq!(scene.gradient(Quantity::FluxDensity, point), Err(PointErrorCause::Unbounded { tile }));
        }
    }
}
