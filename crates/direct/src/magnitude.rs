//! Upper bounds of the sum over tiles of the magnitudes of the fields of the single components of
//! J. Error bounds of the exact field are relative to it (docs/physics.md, section 2.10). Tiles
//! with moved faces have a larger weight in the sum.

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use glam::DVec3;
use magsplice_cuboid::far_magnitude::FarMagnitude;
use magsplice_cuboid::magnitude_bound::{MagnitudeBound, from_centre, length_squared};
use magsplice_cuboid::tolerances::EXACT_BOUND;
use magsplice_magnet::tolerances::{ROTATED_SEAM_ROUNDINGS, UNIT_ROUNDOFF};
use magsplice_magnet::{BoundingBox, Tile, Tolerance};
use magsplice_simd::column::{Column, views};
use magsplice_simd::lanes::{Lanes, Number, PAIR};

use super::batches::neighbours_together;
use crate::tolerances::{GROUP_BOUND_FROM, TILES_PER_GROUP_BOUND};

/// Tiles prepared for upper bounds of the sum of their magnitudes.
#[derive(Clone, Debug)]
pub struct MagnitudeBounds {
    groups: Vec<GroupBound>,
    /// Index of each tile, in the order of the groups.
    order: Vec<u32>,
    /// Upper bound at every point, in tesla.
    largest_t: f64,
    /// Bounds of all tiles from each of [`FAR_FROM`] on.
    far: [FarBound; 2],
}

/// A bound of the sum of the magnitudes of tiles, at a distance from them.
#[derive(Clone, Copy, Debug)]
pub struct FarBound {
    centre: [f64; 3],
    /// Inverse radius of a sphere around the tiles.
    scale: f64,
    /// Bound at r radii from the centre, times r^3, in tesla.
    strength_t: f64,
}

/// Distances from the centre, in radii, from which a [`FarBound`] of all tiles holds. The first
/// bound is at most 8 times the magnitude of dipoles, the second 1.5 times.
const FAR_FROM: [f64; 2] = [2.0, GROUP_BOUND_FROM];

/// Largest square of such a distance whose cube times a square of a field does not overflow.
const FARTHEST_COMPARED: f64 = 1e60;

/// Neighbouring tiles with one bound far away.
#[derive(Clone, Debug)]
struct GroupBound {
    tiles: Vec<MagnitudeBound>,
    /// The tiles in single precision; `None` if one of them is too small.
    in_single_precision: Option<Vec<FarMagnitude>>,
    /// Factor of bounds in single precision, in tesla.
    strength_t: f64,
    centre: [f64; 3],
    /// Inverse radius of a sphere around the tiles.
    scale: f64,
    /// Bound of the sum of magnitudes at r radii from the centre, times r^3, in tesla.
    far_t: f64,
}

impl MagnitudeBounds {
    /// Prepares tiles with their [error weights](magsplice_cuboid::block::Block::error_weight).
    pub fn new(tiles: &[Tile], error_weights: &[f64]) -> MagnitudeBounds {
        let reach = |tile: &Tile| tile.position().abs().max_element().max(tile.size().max_element());
        let extent = tiles.iter().map(reach).fold(0.0, f64::max);
        let roundoff = 2.0 * ROTATED_SEAM_ROUNDINGS * UNIT_ROUNDOFF * extent;
        let centres: Vec<DVec3> = tiles.iter().map(Tile::position).collect();
        let order = neighbours_together(&centres, 0..tiles.len() as u32, &[TILES_PER_GROUP_BOUND]);
        let group = |members: &[u32]| {
            let bound = |index: usize| MagnitudeBound::new(&tiles[index], error_weights[index], roundoff);
            GroupBound::new(members.iter().map(|&index| bound(index as usize)).collect())
        };
        let groups: Vec<GroupBound> = order.chunks(TILES_PER_GROUP_BOUND).map(group).collect();
        let all = || groups.iter().flat_map(|group| &group.tiles);
        let largest_t = all().map(MagnitudeBound::largest_t).sum();
        let far = FAR_FROM.map(|from| FarBound::new(all(), from));
        MagnitudeBounds { groups, order, largest_t, far }
    }

    /// The indices of points whose field may be too weak for a tolerance, judged by one bound for
    /// all points and by their distances. Fields are in tesla over `per_tesla`.
    pub fn open_points(
        &self,
        level: Level,
        least: LeastField,
        points: &[DVec3],
        field: &[DVec3],
        per_tesla: f64,
    ) -> Vec<u32> {
        dispatch!(level, simd => self.open_points_by(simd, least, points, field, per_tesla))
    }

    #[inline(always)]
    fn open_points_by<S: Simd>(
        &self,
        simd: S,
        least: LeastField,
        points: &[DVec3],
        field: &[DVec3],
        per_tesla: f64,
    ) -> Vec<u32> {
        let FarBound { centre: [x, y, z], scale, .. } = self.far[0];
        let in_tesla = per_tesla.recip().powi(2);
        let near = least.squared_at(EXACT_BOUND * self.largest_t);
        let errors_t = self.far.map(|far| EXACT_BOUND * far.strength_t);
        // The error keeps the tolerance where |B|^2 r^6 is at least the first, or r^6 the second.
        let by_field = errors_t.map(|error_t| (least.per_error * error_t).powi(2));
        let by_distance = (errors_t[0] / least.allowed_t).powi(2);
        let [from, farther] = FAR_FROM.map(|from| from * from);
        let is_open = |point: &DVec3, b: &DVec3| {
            let (dx, dy, dz) = ((point.x - x) * scale, (point.y - y) * scale, (point.z - z) * scale);
            let square = dx * dx + dy * dy + dz * dz;
            let (sixth, b_squared) = (square * square * square, b.length_squared() * in_tesla);
            let is_far = (from..=FARTHEST_COMPARED).contains(&square);
            let by_field = if square >= farther { by_field[1] } else { by_field[0] };
            let by_far = (b_squared >= LEAST_COMPARED * LEAST_COMPARED) & (b_squared * sixth >= by_field);
            // A field that is NaN was refused before.
            (b_squared < near) & !(is_far & (by_far | (sixth >= by_distance)))
        };
        simd.vectorize(
            #[inline(always)]
            || indices_where(points.len(), |index| is_open(&points[index], &field[index])),
        )
    }

    /// Upper bound at every point, in tesla.
    pub fn largest_t(&self) -> f64 {
        self.largest_t
    }

    /// Upper bound at points that are at least this far from all tiles, in tesla.
    pub fn beyond_t(&self, distance: f64) -> f64 {
        self.groups.iter().flat_map(|group| &group.tiles).map(|tile| tile.beyond_t(distance)).sum()
    }

    /// Whether single precision bounds each group of neighbouring tiles far away.
    pub fn in_single_precision(&self) -> impl Iterator<Item = bool> {
        self.groups.iter().map(|group| group.in_single_precision.is_some())
    }

    /// Upper bound in a box, in tesla, from the distances of `tiles`, the boxes around the tiles.
    pub fn in_box_t(&self, tiles: &[BoundingBox], points: &BoundingBox) -> f64 {
        let bounds = self.groups.iter().flat_map(|group| &group.tiles).zip(&self.order);
        bounds.map(|(bound, &tile)| bound.beyond_t(tiles[tile as usize].gap(points).length())).sum()
    }

    /// Writes an upper bound at each point, in tesla. Points must be finite.
    pub fn write(&self, level: Level, points: impl ExactSizeIterator<Item = DVec3>, bounds: &mut Column) {
        let whole = points.len().next_multiple_of(PAIR);
        let mut axes: [Column; 3] = Default::default();
        axes.iter_mut().for_each(|axis| axis.fill_with(0.0, whole));
        let [x, y, z] = &mut axes;
        for (((x, y), z), point) in x.iter_mut().zip(y.iter_mut()).zip(z.iter_mut()).zip(points) {
            (*x, *y, *z) = (point.x, point.y, point.z);
        }
        bounds.set_len(whole);
        dispatch!(level, simd => self.write_in_vectors(simd, views(&axes), bounds));
    }

    #[inline(never)]
    fn write_in_vectors<S: Simd>(&self, simd: S, [x, y, z]: [&[f64]; 3], bounds: &mut [f64]) {
        simd.vectorize(
            #[inline(always)]
            || {
                for (number, bounds) in bounds.chunks_exact_mut(2 * Lanes::<S>::LEN).enumerate() {
                    let start = number * 2 * Lanes::<S>::LEN;
                    let middle = start + Lanes::<S>::LEN;
                    let zero = Lanes::<S>::splat(simd, 0.0);
                    let mut points = [[zero; 3]; 2];
                    for (point, from) in points.iter_mut().zip([start, middle]) {
                        let part = from..from + Lanes::<S>::LEN;
                        for (coordinate, axis) in point.iter_mut().zip([x, y, z]) {
                            *coordinate = Lanes::load(simd, &axis[part.clone()]);
                        }
                    }
                    let mut sums = [zero; 2];
                    for group in &self.groups {
                        sums = group.add_at(simd, points, sums);
                    }
                    let (first, second) = bounds.split_at_mut(Lanes::<S>::LEN);
                    sums[0].store(first);
                    sums[1].store(second);
                }
            },
        );
    }
}

/// Smallest length of a field whose square is a normal number, in any unit.
pub(crate) const LEAST_COMPARED: f64 = 1e-153;

/// The smallest field at which an error keeps a tolerance.
#[derive(Clone, Copy, Debug)]
pub struct LeastField {
    /// The field over the error.
    per_error: f64,
    /// The error allowed for any field, in tesla.
    allowed_t: f64,
}

impl LeastField {
    /// The smallest field for a tolerance.
    pub fn new(tolerance: Tolerance) -> LeastField {
        // Far above the round-off of the compared fields.
        const MARGIN: f64 = 1.0 + 1e-9;
        match tolerance {
            Tolerance::Relative { fraction, .. } => {
                LeastField { per_error: MARGIN * (1.0 + 1.0 / fraction), allowed_t: 0.0 }
            }
            Tolerance::AbsoluteT { error_t, .. } => LeastField { per_error: f64::INFINITY, allowed_t: error_t },
        }
    }

    /// The smallest |B| in tesla for an error; infinite if no field allows it.
    #[inline(always)]
    pub fn at_t(self, error_t: f64) -> f64 {
        if error_t <= self.allowed_t { 0.0 } else { self.per_error * error_t }
    }

    /// Smallest |B|^2 in square tesla that allows an error. Squares that are normal numbers can be
    /// compared.
    #[inline(always)]
    pub fn squared_at(self, error_t: f64) -> f64 {
        let least_t = self.at_t(error_t);
        if least_t > 0.0 { least_t.max(LEAST_COMPARED).powi(2) } else { 0.0 }
    }
}

impl FarBound {
    /// The bound of tiles at least `from` radii from their centre.
    fn new<'a>(tiles: impl Iterator<Item = &'a MagnitudeBound> + Clone, from: f64) -> FarBound {
        let centres = || tiles.clone().map(MagnitudeBound::centre);
        let (least, most) =
            (centres().fold(DVec3::INFINITY, DVec3::min), centres().fold(DVec3::NEG_INFINITY, DVec3::max));
        let centre = 0.5 * least + 0.5 * most;
        let longest = (most - least).max_element().max(f64::MIN_POSITIVE);
        let reach =
            |tile: &MagnitudeBound| longest * ((tile.centre() - centre) / longest).length() + tile.half_diagonal();
        let radius = tiles.clone().map(reach).fold(0.0, f64::max);
        let strength = |tile: &MagnitudeBound| tile.dipole_t() * (tile.half_diagonal() / radius).powi(3);
        // |r - r'| >= r - radius for every point r' of the tiles.
        let nearer = (1.0 - 1.0 / from).powi(-3);
        FarBound {
            centre: centre.to_array(),
            scale: 1.0 / radius,
            strength_t: nearer * tiles.map(strength).sum::<f64>(),
        }
    }
}

impl GroupBound {
    fn new(tiles: Vec<MagnitudeBound>) -> GroupBound {
        let FarBound { centre, scale, strength_t: far_t } = FarBound::new(tiles.iter(), GROUP_BOUND_FROM);
        let strength_t = |tile: &MagnitudeBound| tile.dipole_t() * (tile.half_diagonal() * scale).powi(3);
        let strength_t = tiles.iter().map(strength_t).fold(f64::MIN_POSITIVE, f64::max);
        let in_single_precision = |tile: &MagnitudeBound| tile.in_single_precision(centre, scale, strength_t);
        let in_single_precision = tiles.iter().map(in_single_precision).collect();
        GroupBound { centre, scale, far_t, in_single_precision, strength_t, tiles }
    }

    /// `sums` and the bounds of the tiles at a pair of vectors of points. The bound at a point
    /// depends on no other point.
    #[inline(always)]
    fn add_at<S: Simd>(&self, simd: S, points: [[Lanes<S>; 3]; 2], mut sums: [Lanes<S>; 2]) -> [Lanes<S>; 2] {
        if let [tile] = self.tiles.as_slice() {
            return [sums[0] + tile.at(simd, points[0]), sums[1] + tile.at(simd, points[1])];
        }
        const FAR: f64 = GROUP_BOUND_FROM * GROUP_BOUND_FROM;
        let (mut offsets, mut squares, mut bounds) = (points, sums, sums);
        let mut any_near = false;
        for half in 0..2 {
            offsets[half] = from_centre(points[half], self.centre, self.scale);
            squares[half] = length_squared(simd, offsets[half]);
            any_near |= squares[half].any_below(FAR);
            let inverse = squares[half].reciprocal_root_bound(simd);
            bounds[half] = inverse * inverse * (inverse * self.far_t);
        }
        if any_near {
            let near = self.by_tiles(simd, points, offsets);
            for half in 0..2 {
                bounds[half] = squares[half].where_at_least(FAR, bounds[half], near[half]);
            }
        }
        for half in 0..2 {
            sums[half] = sums[half] + bounds[half];
        }
        sums
    }

    /// The sums of the bounds of the tiles at points near the group; `offsets` are the points in
    /// radii from the centre.
    #[inline(always)]
    fn by_tiles<S: Simd>(&self, simd: S, points: [[Lanes<S>; 3]; 2], offsets: [[Lanes<S>; 3]; 2]) -> [Lanes<S>; 2] {
        let zero = Lanes::<S>::splat(simd, 0.0);
        let mut sums = [zero; 2];
        let Some(in_single_precision) = &self.in_single_precision else {
            for tile in &self.tiles {
                for half in 0..2 {
                    sums[half] = sums[half] + tile.at(simd, points[half]);
                }
            }
            return sums;
        };
        let mut offset = [S::f32s::splat(simd, 0.0); 3];
        for axis in 0..3 {
            offset[axis] = offsets[0][axis].0.narrow(offsets[1][axis].0);
        }
        let mut far_sum = S::f32s::splat(simd, 0.0);
        for (tile, far) in self.tiles.iter().zip(in_single_precision) {
            let (bound, is_far) = far.at(simd, offset);
            if is_far.all_true() {
                far_sum += bound;
                continue;
            }
            far_sum += is_far.select(bound, S::f32s::splat(simd, 0.0));
            let is_far = is_far.widen();
            for (half, is_far) in [is_far.0, is_far.1].into_iter().enumerate() {
                if !is_far.all_true() {
                    sums[half] = sums[half] + Lanes(is_far.select(zero.0, tile.at(simd, points[half]).0));
                }
            }
        }
        let far_sums = far_sum.widen();
        [Lanes(far_sums.0).scale_add(self.strength_t, sums[0]), Lanes(far_sums.1).scale_add(self.strength_t, sums[1])]
    }
}

/// The indices below `count` that are `wanted`, found without a branch for each.
#[inline(always)]
fn indices_where(count: usize, wanted: impl Fn(usize) -> bool) -> Vec<u32> {
    let (mut indices, mut found) = (vec![0; count], 0);
    for index in 0..count {
        indices[found] = index as u32;
        found += usize::from(wanted(index));
    }
    indices.truncate(found);
    indices
}
