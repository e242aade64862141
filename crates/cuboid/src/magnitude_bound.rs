//! An upper bound, in vectors of points, of the sum of the magnitudes of the fields of a cuboid's
//! single components of J (docs/physics.md, section 2.10).

use std::f64::consts::{LN_2, PI};

use fearless_simd::prelude::*;
use glam::{DMat3, DQuat, DVec3};
use magsplice_magnet::Tile;
use magsplice_simd::lanes::{Lanes, Number};

use crate::block::Block;
use crate::shape::Shape;
use crate::tolerances::{FARTHEST_BOUND, LARGEST_FIELD_OVER_J, MAGNITUDE_ROUNDING, SERIES_BOUND_FROM};

/// The tangent of (1 + 3 s)^1/2 at s = 1/3 is this factor of 1 + s, 3 / 8^1/2.
pub(crate) const TANGENT: f64 = 1.060_660_171_779_822;

/// A cuboid whose field is bounded. Its lengths are in half diagonals, except the centre.
#[derive(Clone, Debug)]
pub struct MagnitudeBound {
    centre: [f64; 3],
    /// Inverse of the half diagonal.
    scale: f64,
    /// V / 2 pi times the sum of |J_k|, in tesla.
    dipole_t: f64,
    /// The coefficients of q^2 and q^4 in Eq. P45.
    pub(crate) quadratic: f64,
    pub(crate) quartic: f64,
    /// Shares of |J_k| in their sum, as a quadratic form of the offset: xx, yy, zz, and twice yz,
    /// zx, xy if the cuboid is rotated.
    pub(crate) shares: [f64; 3],
    pub(crate) mixed_shares: Option<[f64; 3]>,
    /// |J_k|, in tesla.
    j_t: [f64; 3],
    volume_over_2_pi: f64,
    /// Areas of the faces normal to each axis, over 4 pi.
    faces: [f64; 3],
    /// Half sides.
    half: [f64; 3],
    /// The shortest side, and the product of the two shortest.
    shortest: f64,
    cross_section: f64,
    /// Bound of the error of an offset from a face.
    roundoff: f64,
    /// Rotation to the frame of the cuboid, if it differs from the scene's frame.
    to_own: Option<DMat3>,
}

impl MagnitudeBound {
    /// Prepares a tile. `roundoff` bounds the error of an offset from a face, in the unit of
    /// lengths. The bound is multiplied by `error_weight`.
    pub fn new(tile: &Tile, error_weight: f64, roundoff: f64) -> MagnitudeBound {
        let to_own = (tile.rotation() != DQuat::IDENTITY).then(|| DMat3::from_quat(tile.rotation().inverse()));
        let weighted_t = tile.polarization_t() * error_weight;
        MagnitudeBound::of_cuboid(tile.position(), tile.size(), weighted_t, to_own, roundoff)
    }

    /// Prepares a block, in its frame and times its error weight.
    pub fn of_block(block: &Block, roundoff: f64) -> MagnitudeBound {
        let centre = DVec3::from(block.faces.map(|[low, high]| 0.5 * low.hi + 0.5 * high.hi));
        let weighted_t = block.polarization_t * block.error_weight();
        MagnitudeBound::of_cuboid(centre, block.size.into(), weighted_t, None, roundoff)
    }

    fn of_cuboid(centre: DVec3, size: DVec3, j_t: DVec3, to_own: Option<DMat3>, roundoff: f64) -> MagnitudeBound {
        let longest = size.max_element();
        let half_diagonal = 0.5 * longest * (size / longest).length();
        let sides = size / half_diagonal;
        let shape = Shape::from_sides(sides.to_array());
        let j_t = j_t.abs();
        let nearest = 1.0 / SERIES_BOUND_FROM;
        let tail = shape.mean_inverse_cube(nearest) - 1.0 - 2.0 * nearest.powi(2);
        let shares = DMat3::from_diagonal(j_t / j_t.element_sum().max(f64::MIN_POSITIVE));
        let shares = to_own.map_or(shares, |to_own| to_own.transpose() * shares * to_own);
        let [x, y, z] = [shares.x_axis, shares.y_axis, shares.z_axis];
        MagnitudeBound {
            centre: centre.to_array(),
            scale: 1.0 / half_diagonal,
            dipole_t: shape.volume / (2.0 * PI) * j_t.element_sum(),
            quadratic: sides.max_element().powi(2) - sides.min_element().powi(2),
            quartic: 2.0 * tail / nearest.powi(4),
            shares: [x.x, y.y, z.z],
            mixed_shares: to_own.is_some().then_some([2.0 * y.z, 2.0 * z.x, 2.0 * x.y]),
            j_t: j_t.to_array(),
            volume_over_2_pi: shape.volume / (2.0 * PI),
            faces: (shape.volume / sides / (4.0 * PI)).to_array(),
            half: (0.5 * sides).to_array(),
            shortest: sides.min_element(),
            cross_section: shape.volume / shape.largest,
            roundoff: roundoff / half_diagonal,
            to_own,
        }
    }

    /// Centre of the cuboid.
    pub fn centre(&self) -> DVec3 {
        self.centre.into()
    }

    /// Half of the diagonal.
    pub fn half_diagonal(&self) -> f64 {
        1.0 / self.scale
    }

    /// V / 2 pi times the sum of |J_k|, in tesla and cubed half diagonals.
    pub fn dipole_t(&self) -> f64 {
        self.dipole_t
    }

    /// Upper bound at every point, in tesla.
    pub fn largest_t(&self) -> f64 {
        LARGEST_FIELD_OVER_J * self.j_t.iter().sum::<f64>()
    }

    /// Upper bound at points that are at least this far from the cuboid, in tesla.
    pub fn beyond_t(&self, distance: f64) -> f64 {
        let gap = (distance * self.scale - self.roundoff).max(0.0);
        let by_dipoles_t = self.dipole_t * (1.0 + MAGNITUDE_ROUNDING) / gap.powi(3);
        // The bound by elements is at least this.
        if by_dipoles_t <= 0.5 * self.j_t.iter().sum::<f64>() {
            return by_dipoles_t;
        }
        let of_edges = self.half.map(|half| (half / gap).asinh() / (2.0 * PI));
        let by_elements = |axis: usize| DVec3::new(0.5, of_edges[(axis + 1) % 3], of_edges[(axis + 2) % 3]).length();
        let own_t = |axis: usize| self.j_t[axis] * by_elements(axis).min(LARGEST_FIELD_OVER_J);
        by_dipoles_t.min((0..3).map(own_t).sum::<f64>() * (1.0 + MAGNITUDE_ROUNDING))
    }

    /// Upper bounds at a vector of points, in tesla. Near the cuboid, `ROUGH` bounds take less than
    /// half the time.
    #[inline(always)]
    pub fn at<S: Simd, const ROUGH: bool>(&self, simd: S, point: [Lanes<S>; 3]) -> Lanes<S> {
        let d = from_centre(point, self.centre, self.scale);
        let square = length_squared(simd, d);
        let q = square.reciprocal_root_bound(simd);
        let q_squared = q * q;
        let [x, y, z] = d;
        let [xx, yy, zz] = self.shares;
        let mut along_j = (z * z).scale_add(zz, (y * y).scale_add(yy, x * x * xx));
        if let Some([yz, zx, xy]) = self.mixed_shares {
            along_j = (y * z).scale_add(yz, (z * x).scale_add(zx, (x * y).scale_add(xy, along_j)));
        }
        // Beyond, products may overflow.
        let along_j = square.where_at_least(FARTHEST_BOUND, square, along_j);
        let rest = q_squared.scale_add(self.quartic, Lanes::splat(simd, self.quadratic));
        let series = q_squared.mul_add(along_j.scale_add(TANGENT, rest), Lanes::splat(simd, TANGENT));
        let far = q_squared * q * (series * (0.5 * self.dipole_t));
        let from = SERIES_BOUND_FROM * SERIES_BOUND_FROM;
        if !square.any_below(from) {
            return far;
        }
        let d = self.in_own_frame(d);
        let near = if ROUGH { self.roughly_near(simd, d, q_squared) } else { self.near(simd, d, q_squared) };
        square.where_at_least(from, far, near)
    }

    #[inline(always)]
    fn in_own_frame<S: Simd>(&self, d: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
        match &self.to_own {
            None => d,
            Some(to_own) => {
                let [x, y, z] = [to_own.x_axis, to_own.y_axis, to_own.z_axis];
                [
                    d[2].scale_add(z.x, d[1].scale_add(y.x, d[0] * x.x)),
                    d[2].scale_add(z.y, d[1].scale_add(y.y, d[0] * x.y)),
                    d[2].scale_add(z.z, d[1].scale_add(y.z, d[0] * x.z)),
                ]
            }
        }
    }

    /// Dipoles at the nearest point, on the nearest line of a rod, or on the nearest plane of a
    /// plate, at these squared distances from the cuboid.
    #[inline(always)]
    fn by_dipoles<S: Simd>(&self, simd: S, gap_squared: Lanes<S>) -> Lanes<S> {
        let inverse = gap_squared.reciprocal_root_bound(simd);
        let of_rod = inverse * inverse * (self.cross_section / PI);
        let of_plate = inverse * self.shortest;
        let of_point = inverse * inverse * inverse * self.volume_over_2_pi;
        of_point.min(of_rod).min(of_plate)
    }

    /// Upper bounds near the cuboid from the nearest edge and from dipoles at the nearest point;
    /// `d` is the offset from the centre in half diagonals, along its axes.
    #[inline(always)]
    fn roughly_near<S: Simd>(&self, simd: S, d: [Lanes<S>; 3], q_squared: Lanes<S>) -> Lanes<S> {
        let (zero, one) = (Lanes::<S>::splat(simd, 0.0), Lanes::<S>::splat(simd, 1.0));
        let (mut nearer, mut gap_squared) = ([zero; 3], Lanes::<S>::splat(simd, 1.0 / FARTHEST_BOUND));
        let mut outside = Lanes::<S>::splat(simd, f64::NEG_INFINITY);
        for axis in 0..3 {
            let from_face = d[axis].abs() - self.half[axis];
            let to_nearer = (from_face.abs() - self.roundoff).max(zero);
            let gap = (from_face - self.roundoff).max(zero);
            nearer[axis] = to_nearer * to_nearer;
            gap_squared = gap.mul_add(gap, gap_squared);
            outside = outside.max(from_face);
        }
        let diagonal = outside.where_more(self.roundoff, q_squared.min(one) * 0.5, one);
        let from_edge = (nearer[0] + nearer[1]).min(nearer[1] + nearer[2]).min(nearer[2] + nearer[0]);
        // Closer than 1.5 half diagonals, the farthest edge is at most 2.5 away.
        let farthest = Lanes::splat(simd, (SERIES_BOUND_FROM + 1.0).powi(2) * (1.0 + 1e-6));
        let by_edges = farthest.log2_of_ratio_bound(simd, from_edge) * (2.0 * LN_2 / (4.0 * PI));
        let own = (diagonal + by_edges).min(self.by_dipoles(simd, gap_squared));
        own.min(Lanes::splat(simd, LARGEST_FIELD_OVER_J)) * self.j_t.iter().sum::<f64>()
    }

    /// Upper bounds near the cuboid; `d` is the offset from the centre in half diagonals, along its
    /// axes.
    #[inline(always)]
    fn near<S: Simd>(&self, simd: S, d: [Lanes<S>; 3], q_squared: Lanes<S>) -> Lanes<S> {
        let (zero, one) = (Lanes::<S>::splat(simd, 0.0), Lanes::<S>::splat(simd, 1.0));
        // Squared distances from the nearer and the farther faces, and from the slabs between them.
        let (mut nearer, mut farther, mut gaps) = ([zero; 3], [zero; 3], [zero; 3]);
        let mut farthest = [zero; 3];
        let mut outside = Lanes::<S>::splat(simd, f64::NEG_INFINITY);
        for axis in 0..3 {
            let distance = d[axis].abs();
            let from_face = distance - self.half[axis];
            let to_nearer = (from_face.abs() - self.roundoff).max(zero);
            let to_farther = distance + Lanes::splat(simd, self.half[axis] - self.roundoff);
            let gap = (from_face - self.roundoff).max(zero);
            let at_most = to_farther + Lanes::splat(simd, 2.0 * self.roundoff);
            (nearer[axis], farther[axis]) = (to_nearer * to_nearer, to_farther * to_farther);
            farthest[axis] = at_most * at_most;
            gaps[axis] = gap * gap;
            outside = outside.max(from_face);
        }
        let least = Lanes::<S>::splat(simd, 1.0 / FARTHEST_BOUND);
        let gap_squared = (gaps[0] + gaps[1] + gaps[2]).max(least);
        let by_dipoles = self.by_dipoles(simd, gap_squared);
        // The diagonal element by solid angles of faces, the others by logarithms of edges.
        let diagonal = outside.where_more(self.roundoff, q_squared.min(one) * 0.5, one);
        // J itself inside.
        let inside = outside.where_more(self.roundoff, zero, one);
        let mut by_edges = [zero; 3];
        for (axis, by_edges) in by_edges.iter_mut().enumerate() {
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            let ratio = (farthest[next] + farthest[last]).log2_of_ratio_bound(simd, nearer[next] + nearer[last]);
            *by_edges = ratio * (LN_2 / (4.0 * PI));
        }
        // Charges or currents of density |J| on the pair of faces normal to an axis.
        let mut by_faces = [zero; 3];
        for axis in 0..3 {
            let aside = gaps[(axis + 1) % 3] + gaps[(axis + 2) % 3];
            for along in [nearer[axis], farther[axis]] {
                let inverse = (along + aside).max(least).reciprocal_root_bound(simd);
                by_faces[axis] = (inverse * inverse).scale_add(self.faces[axis], by_faces[axis]);
            }
        }
        let mut sum = zero;
        for axis in 0..3 {
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            let by_elements = diagonal + by_edges[next] + by_edges[last];
            let by_charges = by_faces[axis] + inside;
            let by_currents = by_faces[next] + by_faces[last];
            let own = by_elements.min(by_charges).min(by_currents).min(by_dipoles);
            sum = own.min(Lanes::splat(simd, LARGEST_FIELD_OVER_J)).scale_add(self.j_t[axis], sum);
        }
        sum
    }
}

/// Offsets of points from a centre, scaled.
#[inline(always)]
pub fn from_centre<S: Simd>([x, y, z]: [Lanes<S>; 3], centre: [f64; 3], scale: f64) -> [Lanes<S>; 3] {
    [(x - centre[0]) * scale, (y - centre[1]) * scale, (z - centre[2]) * scale]
}

/// Squared lengths, limited to [`FARTHEST_BOUND`].
#[inline(always)]
pub fn length_squared<S: Simd>(simd: S, [x, y, z]: [Lanes<S>; 3]) -> Lanes<S> {
    z.mul_add(z, y.mul_add(y, x * x)).min(Lanes::splat(simd, FARTHEST_BOUND))
}

#[cfg(test)]
mod tests {
    use fearless_simd::dispatch;
    use magsplice_magnet::{MAX_LENGTH, MIN_SIZE};
    use magsplice_simd::InstructionSet;

    use super::*;
    use crate::block::LocalPoint;
    use crate::far_magnitude::FarMagnitude;
    use crate::scalar::kernel::{FieldKind, cuboid_field};
    use crate::tolerances::SMALLEST_IN_SINGLE_PRECISION;

    /// Numbers evenly distributed between 0 and 1.
    struct Sequence(u64);

    impl Sequence {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        }

        fn between(&mut self, low: f64, high: f64) -> f64 {
            low + (high - low) * self.next()
        }
    }

    /// The sum of the magnitudes by the scalar kernel.
    fn magnitude_t(tile: &Tile, point: DVec3) -> f64 {
        let block = Block::new(0, DVec3::ZERO, tile.size(), tile.polarization_t(), tile.size().min_element());
        let local = tile.rotation().inverse() * (point - tile.position());
        let at = LocalPoint { coordinates: local.to_array(), roundoff: [0.0; 3] };
        let placed = block.place(&at).expect("near enough");
        let alone = |axis: DVec3| {
            let j = tile.polarization_t() * axis;
            DVec3::from(cuboid_field(&placed.offsets, j.to_array(), FieldKind::Density)).length()
        };
        DVec3::AXES.into_iter().map(alone).sum()
    }

    fn bounds(tile: &Tile, point: DVec3) -> Vec<f64> {
        let alone = in_double_precision::<false>(tile, point);
        alone.into_iter().chain(in_single_precision(&MagnitudeBound::new(tile, 1.0, 1e-15), point)).collect()
    }

    fn in_double_precision<const ROUGH: bool>(tile: &Tile, point: DVec3) -> Vec<f64> {
        let bound = MagnitudeBound::new(tile, 1.0, 1e-15);
        let at = |set: InstructionSet| {
            let level = set.detected().expect("available");
            dispatch!(level, simd => {
                let point = point.to_array().map(|c| Lanes::splat(simd, c));
                bound.at::<_, ROUGH>(simd, point).lane(0)
            })
        };
        InstructionSet::available().into_iter().map(at).collect()
    }

    /// Bounds as one of the largest and as one of the smallest tiles of a group, where they hold.
    fn in_single_precision(bound: &MagnitudeBound, point: DVec3) -> Vec<f64> {
        let mut bounds = Vec::new();
        for share in [1.0, 1.01 * SMALLEST_IN_SINGLE_PRECISION] {
            let radius = bound.half_diagonal() / share;
            let origin = bound.centre() + radius * DVec3::new(0.6, -0.64, 0.48);
            let strength_t = 0.3 * bound.dipole_t();
            let far = bound.in_single_precision(origin.to_array(), share / bound.half_diagonal(), strength_t);
            let offset = (point - origin) / radius;
            if offset.length() > 10.0 {
                continue;
            }
            for set in InstructionSet::available() {
                let level = set.detected().expect("available");
                bounds.extend(
                    dispatch!(level, simd => lane_of(simd, far.as_ref().expect("large enough"), offset))
                        .map(|bound| bound * strength_t),
                );
            }
        }
        bounds
    }

    #[inline(always)]
    fn lane_of<S: Simd>(simd: S, far: &FarMagnitude, offset: DVec3) -> Option<f64> {
        let (bound, is_far) = far.at(simd, offset.to_array().map(|c| S::f32s::splat(simd, c as f32)));
        is_far.all_true().then(|| f64::from(bound[0]))
    }

    /// Bounds over magnitudes at random points, in order, for random cuboids of aspects up to
    /// `aspect` with one or three components of J. The points are inside, or 1e-6 to 1e4 sizes away
    /// from a random point inside, on a face, on an edge or at a corner.
    fn excesses(aspect: f64, cases: usize, bounds: fn(&Tile, DVec3) -> Vec<f64>) -> Vec<f64> {
        let mut random = Sequence(5);
        let mut excesses = Vec::new();
        for case in 0..cases {
            let mut vector = |from: f64, to: f64| DVec3::from([0, 1, 2].map(|_| random.between(from, to)));
            let size = vector(-aspect.log10(), 0.0).to_array().map(|d| 10_f64.powf(d));
            let j = if case % 2 == 0 { DVec3::AXES[case % 3] } else { vector(-1.0, 1.0) };
            let centre = vector(-1.0, 1.0);
            let turn = if case % 3 == 0 { DQuat::from_scaled_axis(vector(-1.0, 1.0)) } else { DQuat::IDENTITY };
            let tile = Tile::new(centre, size.into(), j).expect("valid").rotated(turn).expect("a rotation");
            let mut local = vector(-0.5, 0.5);
            let direction = vector(-1.0, 1.0);
            for axis in 0..random.between(0.0, 4.0) as usize {
                local[(case + axis) % 3] = 0.5 * local[(case + axis) % 3].signum();
            }
            let shift = direction * 10_f64.powf(random.between(-6.0, 4.0)) * tile.size().max_element();
            let point = centre + turn * (local * tile.size() + shift);
            let exact = magnitude_t(&tile, point);
            for bound in bounds(&tile, point) {
                assert!(bound >= exact, "{tile:?} at {point}: {bound:e} is below {exact:e}");
                excesses.push(bound / exact);
            }
            let gap = ((local * tile.size() + shift).abs() - 0.5 * tile.size()).max(DVec3::ZERO);
            let beyond_t = MagnitudeBound::new(&tile, 1.0, 1e-15).beyond_t(gap.length());
            assert!(beyond_t >= exact, "{tile:?} at {point}: {beyond_t:e} is below {exact:e}");
        }
        excesses.sort_by(f64::total_cmp);
        excesses
    }

    #[test]
    fn bounds_are_never_below_the_magnitude_and_not_far_above() {
        for (aspect, median, largest) in [(1.0, 2.1, 15.0), (10.0, 2.1, 25.0), (1e3, 2.1, 60.0)] {
            let excesses = excesses(aspect, 40_000, bounds);
            let [middle, last] = [excesses[excesses.len() / 2], excesses[excesses.len() - 1]];
            println!("{middle} in the median, {last} at most, aspect {aspect}");
            assert!(middle <= median && last <= largest, "{middle} in the median, {last} at most, aspect {aspect}");
        }
    }

    #[test]
    fn rough_bounds_are_never_below_the_magnitude_and_not_far_above() {
        for (aspect, median, largest) in [(1.0, 2.6, 26.0), (10.0, 2.8, 150.0), (1e3, 3.2, 1e5)] {
            let excesses = excesses(aspect, 40_000, in_double_precision::<true>);
            let [middle, last] = [excesses[excesses.len() / 2], excesses[excesses.len() - 1]];
            println!("{middle} in the median, {last} at most, aspect {aspect}");
            assert!(middle <= median && last <= largest, "{middle} in the median, {last} at most, aspect {aspect}");
        }
    }

    #[test]
    fn bounds_are_numbers_at_the_largest_distances() {
        let size = DVec3::splat(MIN_SIZE);
        let turn = DQuat::from_scaled_axis(DVec3::ONE);
        for tile in [DVec3::X, DVec3::ONE].map(|j| Tile::new(DVec3::ZERO, size, j).expect("valid")) {
            for tile in [tile, tile.rotated(turn).expect("a rotation")] {
                for distance in [1.0, 1e100, 1e150, MAX_LENGTH] {
                    for bound in bounds(&tile, distance * DVec3::new(1.0, 0.0, -1.0)) {
                        assert!((0.0..1e-200).contains(&bound), "{bound:e} at {distance:e}");
                    }
                }
            }
        }
    }

    #[test]
    fn bound_at_a_distance_is_that_of_the_elements_near_a_face() {
        let cube = Tile::new(DVec3::ZERO, DVec3::ONE, DVec3::Z).expect("valid");
        // The square root of 1/4 + 2 (asinh(2) / 2 pi)^2.
        let beyond_t = MagnitudeBound::new(&cube, 1.0, 0.0).beyond_t(0.25);
        assert!((beyond_t - 0.596_306).abs() < 1e-6, "{beyond_t}");
    }
}
