//! The choice of the method for a cuboid, or a cluster of cuboids, by distance.
//!
//! | method | where | argument |
//! |---|---|---|
//! | scalar | inside, and nearer than `NEAR_FRACTION` of the longest side, or of the second of a rod | exact everywhere, one point at a time |
//! | closed form | up to `CLOSED_FORM_REACH` second sides, or longest sides of a rod | the error of the vector form grows with that ratio |
//! | small elements | in the same range, where half of 4 pi T is below [`SMALL_ANGLE`](crate::tolerances::SMALL_ANGLE) | logarithms and arctangents need no reduction |
//! | series | beyond, by `MULTIPOLE_ORDERS` | the truncation error of each order is below the bound from its distance on |
//! | expansion | clusters, from their radii on | the truncation error of each degree likewise |
//!
//! Inside compact cuboids and close to them, and close to plates and rods,
//! [`NearEdges`](crate::closed_form::near_edge::NearEdges) evaluates points in vectors, except
//! points near the planes of the faces of compact cuboids.
//!
//! The method, and therefore every digit of the field, depends on the cuboid and the point alone.

use fearless_simd::prelude::*;
use magsplice_simd::lanes::{Lanes, Number};
use magsplice_simd::power_of_two::power_of_two_reciprocal;

use crate::block::Block;
use crate::closed_form::terms::Form;
use crate::shape::Shape;
use crate::tolerances::{CLOSED_FORM_COST, FARTHEST, METHOD_MARGIN, MULTIPOLE_ORDERS, SINGLE_TILE_COST, SMALL_ANGLE};

/// A way to evaluate the field of a cuboid, or of a cluster of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// The reference kernel, one point at a time. Clusters are divided into their tiles.
    Scalar,
    /// The closed form in vectors.
    ClosedForm,
    /// The closed form in vectors where every element is small. All share a division.
    SmallElements,
    /// The multipole series of each cuboid.
    Series {
        /// Highest order in (half diagonal / distance)^2.
        order: usize,
    },
    /// The expansion of a cluster in solid harmonics.
    Expansion {
        /// Highest degree of the field.
        degree: usize,
    },
}

impl Method {
    /// The time for one vector of points and `tiles` cuboids, in multiply-adds of vectors.
    pub fn cost(self, tiles: usize) -> f64 {
        match self {
            Method::Scalar => f64::INFINITY,
            Method::ClosedForm | Method::SmallElements => CLOSED_FORM_COST * tiles as f64,
            Method::Series { order } => (tiles * (5 * (order + 1) * (order + 2) * (order + 3) / 6 + 60)) as f64,
            // Six sums, and three operations for the recurrence.
            Method::Expansion { degree } => (9 * (degree + 2) * (degree + 3) / 2 + 60) as f64,
        }
    }
}

/// A method as a number to sort points by; from [`FIRST_FAR`] on, positions in
/// [`MethodRanges::far`].
pub type MethodIndex = u8;
/// [`Method::Scalar`].
pub const SCALAR: MethodIndex = 0;
/// [`Method::ClosedForm`].
pub const CLOSED_FORM: MethodIndex = 1;
/// [`Method::SmallElements`].
pub const SMALL_ELEMENTS: MethodIndex = 2;
/// The first of [`MethodRanges::far`].
pub const FIRST_FAR: MethodIndex = 3;
/// Largest number of entries in [`MethodRanges::far`]: one for each order of the series, one for
/// each degree of the expansion of a cluster, and one for the end of the closed form.
pub const MOST_FAR: usize = 12;

/// The distances at which each method of a cuboid, or of a cluster, reaches the error bound.
#[derive(Clone, Debug)]
pub struct MethodRanges {
    /// A power of two that brings lengths to order one. The other lengths are scaled with it,
    /// except the centre.
    pub scale: f64,
    /// Centre of the box around the cuboids.
    pub centre: [f64; 3],
    /// Half of the sides of the box.
    pub half_size: [f64; 3],
    /// Square of the smallest distance from the box for the closed form.
    pub closed_form_from: f64,
    /// Square of the smallest distance from the box at which every element is small.
    pub small_elements_from: f64,
    /// Square of the smallest distance from the centre at which every element is small; one of the
    /// two conditions is sufficient.
    pub small_elements_from_centre: f64,
    /// `small_elements_from` of each group of a cluster, to a tolerance.
    pub small_groups_from: f64,
    /// Square of the largest distance from the centre for the closed form.
    pub closed_form_to: f64,
    /// `closed_form_to` under a tolerance that allows a larger error.
    pub stretched_closed_form_to: f64,
    /// Squares of the distances from the centre at which the next method begins, and that method.
    pub far: Vec<(f64, Method)>,
}

impl MethodRanges {
    /// The ranges of one cuboid.
    pub fn from_block(block: &Block) -> MethodRanges {
        let [[x0, x1], [y0, y1], [z0, z1]] = block.faces.map(|faces| faces.map(|face| face.hi));
        let scale = power_of_two_reciprocal(block.size.into_iter().fold(0.0, f64::max));
        let shape = Shape::new(block, scale);
        let form = shape.form();
        let closed_form_to = shape.closed_form_to(form);
        // The form of small elements without argument reduction does not exist for rods.
        let small_elements_from = |distance: f64| if form == Form::Rod { f64::INFINITY } else { distance * distance };
        MethodRanges {
            scale,
            centre: [0.5 * x0 + 0.5 * x1, 0.5 * y0 + 0.5 * y1, 0.5 * z0 + 0.5 * z1],
            half_size: block.size.map(|s| 0.5 * s * scale),
            closed_form_from: shape.closed_form_from(form).powi(2),
            small_elements_from: small_elements_from((shape.volume / SMALL_ANGLE).cbrt()),
            small_elements_from_centre: small_elements_from(shape.small_elements_from()),
            small_groups_from: small_elements_from((shape.volume / SMALL_ANGLE).cbrt()),
            closed_form_to: closed_form_to * closed_form_to,
            stretched_closed_form_to: closed_form_to * closed_form_to,
            far: series_of_block(&shape, closed_form_to).into_iter().map(squared).collect(),
        }
    }

    /// The method of each of the points, given by axis in whole vectors, as a [`MethodIndex`].
    /// Points that are not numbers get an arbitrary method. `stretched` extends the closed form as
    /// a tolerance allows.
    #[inline(never)]
    pub fn methods<S: Simd>(&self, simd: S, [x, y, z]: [&[f64]; 3], stretched: bool, methods: &mut [f64]) {
        simd.vectorize(
            #[inline(always)]
            || {
                let (last, small_from) = self.closed_form_limits(stretched);
                let zero = Lanes::<S>::splat(simd, 0.0);
                let closed_form = Lanes::<S>::splat(simd, f64::from(CLOSED_FORM));
                let small_elements = Lanes::<S>::splat(simd, f64::from(SMALL_ELEMENTS));
                let mut far = [zero; MOST_FAR];
                for (number, far) in far.iter_mut().enumerate() {
                    *far = Lanes::<S>::splat(simd, f64::from(FIRST_FAR + number as MethodIndex));
                }
                for (number, methods) in methods.chunks_exact_mut(Lanes::<S>::LEN).enumerate() {
                    let (start, end) = (number * Lanes::<S>::LEN, (number + 1) * Lanes::<S>::LEN);
                    let point = [&x[start..end], &y[start..end], &z[start..end]];
                    let (mut gap, mut distance) = (zero, zero);
                    for (axis, coordinates) in point.into_iter().enumerate() {
                        let offset = ((Lanes::<S>::load(simd, coordinates) - self.centre[axis]) * self.scale).abs();
                        let outside = (offset - self.half_size[axis]).max(zero);
                        gap = outside.mul_add(outside, gap);
                        distance = offset.mul_add(offset, distance);
                    }
                    let reached = gap.at_least(simd, self.closed_form_from) * distance.at_most(simd, last);
                    let by_radius =
                        distance.where_at_least(self.small_elements_from_centre, small_elements, closed_form);
                    let mut method = reached * gap.where_at_least(small_from, small_elements, by_radius);
                    for (far, (from, _)) in far.iter().zip(&self.far) {
                        method = distance.where_at_least(*from, *far, method);
                    }
                    let method = distance.where_more(FARTHEST, zero, method);
                    method.store(methods);
                }
            },
        );
    }

    /// The squared distances at which the closed form ends and from which its elements are small.
    #[inline(always)]
    fn closed_form_limits(&self, stretched: bool) -> (f64, f64) {
        if stretched {
            (self.stretched_closed_form_to, self.small_groups_from)
        } else {
            (self.closed_form_to, self.small_elements_from)
        }
    }

    #[inline(always)]
    fn index(&self, gap: f64, distance: f64, stretched: bool) -> MethodIndex {
        let (last, small_from) = self.closed_form_limits(stretched);
        let passed = self.far.iter().map(|&(from, _)| u8::from(distance >= from)).sum::<u8>();
        if passed > 0 && distance <= FARTHEST {
            FIRST_FAR + passed - 1
        } else if gap >= self.closed_form_from && distance <= last {
            if gap >= small_from || distance >= self.small_elements_from_centre { SMALL_ELEMENTS } else { CLOSED_FORM }
        } else {
            SCALAR
        }
    }

    /// The method of a point.
    pub fn method_at(&self, point: [f64; 3]) -> Method {
        let (mut gap, mut distance) = (0.0, 0.0);
        for (axis, coordinate) in point.into_iter().enumerate() {
            let offset = ((coordinate - self.centre[axis]) * self.scale).abs();
            gap += (offset - self.half_size[axis]).max(0.0).powi(2);
            distance += offset * offset;
        }
        self.method(self.index(gap, distance, false))
    }

    /// The index of the last method.
    pub fn last_index(&self) -> MethodIndex {
        FIRST_FAR + self.far.len() as MethodIndex - 1
    }

    /// The order of the series that begins nearest; 0 if there is none.
    pub fn highest_order(&self) -> usize {
        let order = |method: &Method| if let Method::Series { order } = method { *order } else { 0 };
        self.far.iter().map(|(_, method)| order(method)).max().unwrap_or(0)
    }

    /// The method with an index.
    #[inline]
    pub fn method(&self, index: MethodIndex) -> Method {
        match index {
            SCALAR => Method::Scalar,
            CLOSED_FORM => Method::ClosedForm,
            SMALL_ELEMENTS => Method::SmallElements,
            far => self.far[usize::from(far - FIRST_FAR)].1,
        }
    }

    /// The method of all points in a box; `None` if methods may differ or are [`Method::Scalar`].
    #[inline]
    pub fn method_of_box(&self, low: [f64; 3], high: [f64; 3], stretched: bool) -> Option<MethodIndex> {
        let (mut gap, mut widest, mut nearest, mut farthest) = (0.0, 0.0, 0.0, 0.0);
        for axis in 0..3 {
            let [low, high] = [low[axis], high[axis]].map(|c| (c - self.centre[axis]) * self.scale);
            let least = low.max(-high).max(0.0);
            let most = high.max(-low);
            gap += (least - self.half_size[axis]).max(0.0).powi(2);
            widest += (most - self.half_size[axis]).max(0.0).powi(2);
            nearest += least * least;
            farthest += most * most;
        }
        // The margin exceeds the round-off of the decision for a point.
        let (gap, nearest) = (gap * (1.0 - METHOD_MARGIN), nearest * (1.0 - METHOD_MARGIN));
        let (widest, farthest) = (widest * (1.0 + METHOD_MARGIN), farthest * (1.0 + METHOD_MARGIN));
        let (method, other) = (self.index(gap, nearest, stretched), self.index(widest, farthest, stretched));
        (method == other && method != SCALAR && farthest <= FARTHEST).then_some(method)
    }
}

/// Each order of the series and the distance at which it begins. `distance` converts from half
/// diagonals.
pub fn series(distance: impl Fn(f64) -> f64) -> impl Iterator<Item = (f64, Method)> {
    MULTIPOLE_ORDERS
        .into_iter()
        .map(move |(order, half_diagonals)| (distance(half_diagonals), Method::Series { order }))
}

/// The series of one cuboid whose closed form ends at `closed_form_to`. An order slower than the
/// closed form begins there at the earliest.
fn series_of_block(shape: &Shape, closed_form_to: f64) -> Vec<(f64, Method)> {
    let mut steps: Vec<(f64, Method)> = Vec::new();
    for (distance, method) in series(|half_diagonals| half_diagonals * shape.half_diagonal) {
        let distance = if method.cost(1) > SINGLE_TILE_COST { distance.max(closed_form_to) } else { distance };
        // An order that begins no later is cheaper.
        steps.retain(|(earlier, _)| *earlier < distance);
        steps.push((distance, method));
    }
    steps
}

/// A step with the square of its distance.
pub fn squared((distance, method): (f64, Method)) -> (f64, Method) {
    (distance * distance, method)
}
