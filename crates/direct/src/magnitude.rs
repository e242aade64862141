//! Upper bounds of the sum over tiles of the magnitudes of the fields of the single components of
//! J. Error bounds of the exact field are relative to it (docs/physics.md, section 2.10). Tiles
//! with moved faces have a larger weight in the sum.

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use glam::DVec3;
use magsplice_cuboid::far_magnitude::FarMagnitude;
use magsplice_cuboid::magnitude_bound::{MagnitudeBound, from_centre, length_squared};
use magsplice_cuboid::tolerances::{EXACT_BOUND, SERIES_BOUND_FROM};
use magsplice_magnet::tolerances::{ROTATED_SEAM_ROUNDINGS, UNIT_ROUNDOFF};
use magsplice_magnet::{BoundingBox, Tile};
use magsplice_simd::column::{Column, views};
use magsplice_simd::lanes::{Lanes, Number, PAIR};

use super::batches::neighbours_together;
use super::least_field::LeastField;
use super::open_points::OpenPoints;
use crate::tolerances::{GROUP_BOUND_FROM, TILES_PER_GROUP_BOUND};

/// Tiles prepared for upper bounds of the sum of their magnitudes.
#[derive(Clone, Debug)]
pub struct MagnitudeBounds {
    groups: Vec<GroupBound>,
    /// Index of each tile, in the order of the groups.
    order: Vec<u32>,
    /// Upper bound at every point, in tesla.
    largest_t: f64,
    /// Bound of the error of an offset from a face.
    roundoff: f64,
    /// Bound of all tiles from the distance to their middle.
    far: FarBound,
}

/// A bound of the sum of the magnitudes of tiles outside a sphere around them: of dipoles at the
/// point of the sphere that is nearest.
#[derive(Clone, Copy, Debug)]
pub struct FarBound {
    centre: [f64; 3],
    /// Inverse radius of the sphere.
    scale: f64,
    /// Bound at a distance of g radii from the sphere, times g^3, in tesla.
    strength_t: f64,
}

/// Smallest distance from the sphere of a [`FarBound`], in radii, at which it is tried. Nearer, it
/// is thousands of times the magnitude.
const FAR_FROM: f64 = 0.05;

/// Largest such distance.
const FARTHEST_COMPARED: f64 = 1e30;

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
        let far = FarBound::new(all());
        MagnitudeBounds { groups, order, largest_t, roundoff, far }
    }

    /// Leaves in `open` the points whose field may be too weak for a tolerance, with the bounds of
    /// their magnitudes. The points of a batch are given with their fields, in tesla over the last
    /// number, and with `tiles`, the boxes around the tiles.
    pub fn find_weak(
        &self,
        level: Level,
        least: LeastField,
        of: (&[DVec3], &[DVec3], f64),
        tiles: &[BoundingBox],
        open: &mut OpenPoints,
    ) {
        dispatch!(level, simd => self.find_weak_by(simd, least, of, tiles, open));
    }

    #[inline(always)]
    fn find_weak_by<S: Simd>(
        &self,
        simd: S,
        least: LeastField,
        (points, field, per_tesla): (&[DVec3], &[DVec3], f64),
        tiles: &[BoundingBox],
        open: &mut OpenPoints,
    ) {
        let weakest_squared = simd.vectorize(
            #[inline(always)]
            || open.set_fields(simd, field, per_tesla),
        );
        // One bound for all points decides nearly all batches.
        if weakest_squared >= least.squared_at(EXACT_BOUND * self.largest_t) {
            return open.clear();
        }
        let around = simd.vectorize(
            #[inline(always)]
            || open.set_points(simd, points),
        );
        let enough_t = least.error_t(weakest_squared) / EXACT_BOUND;
        if self.far.at_t(self.far.gap(&around)) <= enough_t {
            return open.clear();
        }
        // A bound from the distance of each tile takes longer than one from the distances of points
        // to the middle of many tiles.
        if self.are_few() && self.is_at_most_in_box(tiles, &around, enough_t) {
            return open.clear();
        }
        self.keep_weak_by_distance(simd, least, open);
        if open.is_empty() || !self.are_few() && self.is_at_most_in_box(tiles, &around, enough_t) {
            return open.clear();
        }
        if self.has_rough_bounds(&around) {
            self.keep_weak::<_, true>(simd, least, open);
        }
        self.keep_weak::<_, false>(simd, least, open);
    }

    /// Whether rough bounds of points in a box are tried first: near few tiles. Of many tiles, few
    /// are near. From [`SERIES_BOUND_FROM`] radii on, none is.
    pub fn has_rough_bounds(&self, points: &BoundingBox) -> bool {
        self.are_few() && self.far.gap(points) < SERIES_BOUND_FROM - 1.0
    }

    /// Removes the points that their distances to the middle of the tiles decide.
    #[inline(never)]
    pub fn keep_weak_by_distance<S: Simd>(&self, simd: S, least: LeastField, open: &mut OpenPoints) {
        simd.vectorize(
            #[inline(always)]
            || {
                let ([x, y, z], magnitudes_t) = open.points_and_magnitudes_t();
                let len = Lanes::<S>::LEN;
                let points = x.chunks_exact(len).zip(y.chunks_exact(len)).zip(z.chunks_exact(len));
                for (((x, y), z), own_t) in points.zip(magnitudes_t.chunks_exact_mut(len)) {
                    self.far_t(simd, [x, y, z].map(|axis| Lanes::load(simd, axis))).store(own_t);
                }
                open.keep_weak(simd, least);
            },
        );
    }

    /// Removes the points that the bounds of the single tiles decide.
    #[inline(never)]
    fn keep_weak<S: Simd, const ROUGH: bool>(&self, simd: S, least: LeastField, open: &mut OpenPoints) {
        let (points, magnitudes_t) = open.points_and_magnitudes_t();
        self.write_in_vectors::<_, ROUGH>(simd, points, magnitudes_t);
        simd.vectorize(
            #[inline(always)]
            || open.keep_weak(simd, least),
        );
    }

    /// Upper bounds from the distances of points to the middle of the tiles, in tesla.
    #[inline(always)]
    fn far_t<S: Simd>(&self, simd: S, points: [Lanes<S>; 3]) -> Lanes<S> {
        let FarBound { centre, scale, strength_t } = self.far;
        let largest = Lanes::<S>::splat(simd, self.largest_t);
        let distance = length_squared(simd, from_centre(points, centre, scale)).sqrt();
        let gap = distance - 1.0;
        let own = Lanes::splat(simd, strength_t).over(gap * gap * gap).max(Lanes::splat(simd, f64::MIN_POSITIVE));
        let own = distance.where_at_least(1.0 + FAR_FROM, own, largest);
        distance.where_at_least(FARTHEST_COMPARED, largest, own).min(largest)
    }

    /// Upper bound at every point, in tesla.
    pub fn largest_t(&self) -> f64 {
        self.largest_t
    }

    /// Bound of the error of an offset of a point close to the tiles from a face.
    pub(crate) fn roundoff(&self) -> f64 {
        self.roundoff
    }

    /// Upper bound at points that are at least this far from all tiles, in tesla.
    pub fn beyond_t(&self, distance: f64) -> f64 {
        self.groups.iter().flat_map(|group| &group.tiles).map(|tile| tile.beyond_t(distance)).sum()
    }

    /// Whether single precision bounds each group of neighbouring tiles far away.
    pub fn in_single_precision(&self) -> impl Iterator<Item = bool> {
        self.groups.iter().map(|group| group.in_single_precision.is_some())
    }

    /// Whether an upper bound in a box is at most `enough_t`, from the distances of `tiles`, the
    /// boxes around the tiles. A sum that exceeds it ends early.
    fn is_at_most_in_box(&self, tiles: &[BoundingBox], points: &BoundingBox, enough_t: f64) -> bool {
        let bounds = self.groups.iter().flat_map(|group| &group.tiles).zip(&self.order);
        let own_t = |(bound, &tile): (&MagnitudeBound, &u32)| bound.beyond_t(tiles[tile as usize].gap(points).length());
        let sum = bounds.map(own_t).try_fold(0.0, |sum, own_t| (sum + own_t <= enough_t).then_some(sum + own_t));
        sum.is_some()
    }

    /// Whether the tiles are so few that a bound of a box takes little time.
    fn are_few(&self) -> bool {
        self.groups.len() == 1
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
        dispatch!(level, simd => self.write_in_vectors::<_, false>(simd, views(&axes), bounds));
    }

    #[inline(never)]
    fn write_in_vectors<S: Simd, const ROUGH: bool>(&self, simd: S, [x, y, z]: [&[f64]; 3], bounds: &mut [f64]) {
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
                        sums = group.add_at::<S, ROUGH>(simd, points, sums);
                    }
                    let (first, second) = bounds.split_at_mut(Lanes::<S>::LEN);
                    sums[0].store(first);
                    sums[1].store(second);
                }
            },
        );
    }
}

impl FarBound {
    /// Distance of a box from the sphere, in radii; negative where the box reaches into it.
    fn gap(&self, points: &BoundingBox) -> f64 {
        let centre = DVec3::from(self.centre);
        points.gap(&BoundingBox { lower: centre, upper: centre }).length() * self.scale - 1.0
    }

    /// Upper bound at a distance from the sphere, in tesla; infinite near it, and so far away that
    /// the bound may be rounded to zero.
    fn at_t(&self, gap: f64) -> f64 {
        let is_far = (FAR_FROM..=FARTHEST_COMPARED).contains(&gap);
        if is_far { (self.strength_t / (gap * gap * gap)).max(f64::MIN_POSITIVE) } else { f64::INFINITY }
    }

    /// The bound of tiles.
    fn new<'a>(tiles: impl Iterator<Item = &'a MagnitudeBound> + Clone) -> FarBound {
        let centres = || tiles.clone().map(MagnitudeBound::centre);
        let (least, most) =
            (centres().fold(DVec3::INFINITY, DVec3::min), centres().fold(DVec3::NEG_INFINITY, DVec3::max));
        let centre = 0.5 * least + 0.5 * most;
        let longest = (most - least).max_element().max(f64::MIN_POSITIVE);
        let reach =
            |tile: &MagnitudeBound| longest * ((tile.centre() - centre) / longest).length() + tile.half_diagonal();
        let radius = tiles.clone().map(reach).fold(0.0, f64::max);
        let strength = |tile: &MagnitudeBound| tile.dipole_t() * (tile.half_diagonal() / radius).powi(3);
        // Round-off of distances is far below.
        const MARGIN: f64 = 1.0 + 1e-9;
        FarBound {
            centre: centre.to_array(),
            scale: 1.0 / radius,
            strength_t: MARGIN * tiles.map(strength).sum::<f64>(),
        }
    }
}

impl GroupBound {
    fn new(tiles: Vec<MagnitudeBound>) -> GroupBound {
        let FarBound { centre, scale, strength_t } = FarBound::new(tiles.iter());
        // |r - r'| >= r - radius for every point r' of the tiles.
        let far_t = strength_t / (1.0 - 1.0 / GROUP_BOUND_FROM).powi(3);
        let strength_t = |tile: &MagnitudeBound| tile.dipole_t() * (tile.half_diagonal() * scale).powi(3);
        let strength_t = tiles.iter().map(strength_t).fold(f64::MIN_POSITIVE, f64::max);
        let in_single_precision = |tile: &MagnitudeBound| tile.in_single_precision(centre, scale, strength_t);
        let in_single_precision = tiles.iter().map(in_single_precision).collect();
        GroupBound { centre, scale, far_t, in_single_precision, strength_t, tiles }
    }

    /// `sums` and the bounds of the tiles at a pair of vectors of points. The bound at a point
    /// depends on no other point.
    #[inline(always)]
    fn add_at<S: Simd, const ROUGH: bool>(
        &self,
        simd: S,
        points: [[Lanes<S>; 3]; 2],
        mut sums: [Lanes<S>; 2],
    ) -> [Lanes<S>; 2] {
        if let [tile] = self.tiles.as_slice() {
            return [sums[0] + tile.at::<S, ROUGH>(simd, points[0]), sums[1] + tile.at::<S, ROUGH>(simd, points[1])];
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
            let near = self.by_tiles::<S, ROUGH>(simd, points, offsets);
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
    fn by_tiles<S: Simd, const ROUGH: bool>(
        &self,
        simd: S,
        points: [[Lanes<S>; 3]; 2],
        offsets: [[Lanes<S>; 3]; 2],
    ) -> [Lanes<S>; 2] {
        let zero = Lanes::<S>::splat(simd, 0.0);
        let mut sums = [zero; 2];
        let Some(in_single_precision) = &self.in_single_precision else {
            for tile in &self.tiles {
                for half in 0..2 {
                    sums[half] = sums[half] + tile.at::<S, ROUGH>(simd, points[half]);
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
                    sums[half] = sums[half] + Lanes(is_far.select(zero.0, tile.at::<S, ROUGH>(simd, points[half]).0));
                }
            }
        }
        let far_sums = far_sum.widen();
        [Lanes(far_sums.0).scale_add(self.strength_t, sums[0]), Lanes(far_sums.1).scale_add(self.strength_t, sums[1])]
    }
}
