//! Upper bounds of the sum over tiles of the magnitudes of the fields that the components of J make
//! alone. Errors of the exact field are stated relative to it (docs/physics.md, section 2.10).

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use glam::DVec3;
use magsplice_cuboid::magnitude_bound::{MagnitudeBound, from_centre, length_squared};
use magsplice_magnet::tolerances::{ROTATED_SEAM_ROUNDINGS, UNIT_ROUNDOFF};
use magsplice_magnet::{BoundingBox, Tile, Tolerance};
use magsplice_simd::column::{Column, views};
use magsplice_simd::lanes::{Lanes, Number, PAIR};

use super::batches::neighbours_together;
use crate::tolerances::{GROUP_BOUND_FROM, TILES_PER_GROUP_BOUND};

/// Tiles prepared for upper bounds of the sum of their magnitudes.
#[derive(Clone, Debug)]
pub(super) struct MagnitudeBounds {
    groups: Vec<GroupBound>,
    /// Index of each tile, in the order of the groups.
    order: Vec<u32>,
    /// Upper bound at every point, in tesla.
    largest_t: f64,
}

/// Neighbouring tiles, which far away are bounded together.
#[derive(Clone, Debug)]
struct GroupBound {
    tiles: Vec<MagnitudeBound>,
    centre: [f64; 3],
    /// Inverse radius of a sphere around the tiles.
    scale: f64,
    /// Bound of the sum of magnitudes at r radii from the centre, times r^3, in tesla.
    far_t: f64,
}

impl MagnitudeBounds {
    /// Prepares tiles.
    pub(super) fn new(tiles: &[Tile]) -> MagnitudeBounds {
        let reach = |tile: &Tile| tile.position().abs().max_element().max(tile.size().max_element());
        let extent = tiles.iter().map(reach).fold(0.0, f64::max);
        let roundoff = 2.0 * ROTATED_SEAM_ROUNDINGS * UNIT_ROUNDOFF * extent;
        let centres: Vec<DVec3> = tiles.iter().map(Tile::position).collect();
        let order = neighbours_together(&centres, 0..tiles.len() as u32, &[TILES_PER_GROUP_BOUND]);
        let group = |members: &[u32]| {
            let bound = |&index: &u32| MagnitudeBound::new(&tiles[index as usize], roundoff);
            GroupBound::new(members.iter().map(bound).collect())
        };
        let groups: Vec<GroupBound> = order.chunks(TILES_PER_GROUP_BOUND).map(group).collect();
        let largest_t = groups.iter().flat_map(|group| &group.tiles).map(MagnitudeBound::largest_t).sum();
        MagnitudeBounds { groups, order, largest_t }
    }

    /// Upper bound at every point, in tesla.
    pub(super) fn largest_t(&self) -> f64 {
        self.largest_t
    }

    /// Upper bound in a box, in tesla, from the distances of `tiles`, the boxes around the tiles.
    pub(super) fn in_box_t(&self, tiles: &[BoundingBox], points: &BoundingBox) -> f64 {
        let bounds = self.groups.iter().flat_map(|group| &group.tiles).zip(&self.order);
        bounds.map(|(bound, &tile)| bound.beyond_t(tiles[tile as usize].gap(points).length())).sum()
    }

    /// Writes an upper bound at each point, in tesla. Points must be finite.
    pub(super) fn write(&self, level: Level, points: impl ExactSizeIterator<Item = DVec3>, bounds: &mut Column) {
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
                for (number, bounds) in bounds.chunks_exact_mut(Lanes::<S>::LEN).enumerate() {
                    let (start, end) = (number * Lanes::<S>::LEN, (number + 1) * Lanes::<S>::LEN);
                    let point = [
                        Lanes::<S>::load(simd, &x[start..end]),
                        Lanes::<S>::load(simd, &y[start..end]),
                        Lanes::<S>::load(simd, &z[start..end]),
                    ];
                    let mut sum = Lanes::<S>::splat(simd, 0.0);
                    for group in &self.groups {
                        sum = group.add_at(simd, point, sum);
                    }
                    sum.store(bounds);
                }
            },
        );
    }
}

/// The smallest field at which an error keeps a tolerance.
#[derive(Clone, Copy)]
pub(super) struct LeastField {
    /// The field over the error.
    per_error: f64,
    /// The error that any field allows, in tesla.
    allowed_t: f64,
}

impl LeastField {
    pub(super) fn new(tolerance: Tolerance) -> LeastField {
        // Far above round-off of the fields that are compared.
        const MARGIN: f64 = 1.0 + 1e-9;
        match tolerance {
            Tolerance::Relative { fraction, .. } => {
                LeastField { per_error: MARGIN * (1.0 + 1.0 / fraction), allowed_t: 0.0 }
            }
            Tolerance::AbsoluteT { error_t, .. } => LeastField { per_error: f64::INFINITY, allowed_t: error_t },
        }
    }

    /// The smallest |B| in tesla at an error; infinite if no field allows it.
    #[inline(always)]
    pub(super) fn at_t(self, error_t: f64) -> f64 {
        if error_t <= self.allowed_t { 0.0 } else { self.per_error * error_t }
    }
}

impl GroupBound {
    fn new(tiles: Vec<MagnitudeBound>) -> GroupBound {
        let least = tiles.iter().map(MagnitudeBound::centre).fold(DVec3::INFINITY, DVec3::min);
        let most = tiles.iter().map(MagnitudeBound::centre).fold(DVec3::NEG_INFINITY, DVec3::max);
        let centre = 0.5 * least + 0.5 * most;
        let longest = (most - least).max_element().max(f64::MIN_POSITIVE);
        let reach =
            |tile: &MagnitudeBound| longest * ((tile.centre() - centre) / longest).length() + tile.half_diagonal();
        let radius = tiles.iter().map(reach).fold(0.0, f64::max);
        let strength = |tile: &MagnitudeBound| tile.dipole_t() * (tile.half_diagonal() / radius).powi(3);
        // |r - r'| >= r - radius for every point r' of the tiles.
        let nearer = (1.0 - 1.0 / GROUP_BOUND_FROM).powi(-3);
        let far_t = nearer * tiles.iter().map(strength).sum::<f64>();
        GroupBound { centre: centre.to_array(), scale: 1.0 / radius, far_t, tiles }
    }

    /// `sum` and the bounds of the tiles at a vector of points.
    #[inline(always)]
    fn add_at<S: Simd>(&self, simd: S, point: [Lanes<S>; 3], mut sum: Lanes<S>) -> Lanes<S> {
        if self.tiles.len() > 1 {
            let square = length_squared(simd, from_centre(point, self.centre, self.scale));
            if !square.any_below(GROUP_BOUND_FROM * GROUP_BOUND_FROM) {
                let inverse = square.reciprocal_root_bound(simd);
                return (inverse * inverse).mul_add(inverse * self.far_t, sum);
            }
        }
        for tile in &self.tiles {
            sum = sum + tile.at(simd, point);
        }
        sum
    }
}
