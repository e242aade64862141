//! The closed form of a tile by itself, without tables (docs/physics.md, section 2.6).

use super::closed_form::{across, angle_of_faces, edge_pair, face, ratio_of_edges};
use super::functions::{Functions, odd_series};
use super::terms::{AA, AB, AC, BB, BC, CC, Terms};
use crate::block::Block;
use crate::two_sum::TwoSum;

/// A tile whose axes a, b, c are ordered by length.
pub(super) struct Alone {
    axes: [usize; 3],
    /// Low and high plane along a, b, c: the coordinate, and minus what it is short of the plane's, scaled.
    planes: [[[f64; 2]; 2]; 3],
    scale: f64,
    terms: Terms,
    wanted: [bool; 6],
    /// What one unit of half of 4 pi T adds to mu0 H.
    coefficients: [[f64; 3]; 6],
}

/// What J with three components needs.
const GENERAL: [bool; 6] = [true, true, true, true, true, false];

/// Where points lie relative to the tile, in its scale.
#[derive(Clone, Copy)]
pub(super) struct Place<N> {
    /// Offset and square, by plane.
    planes: [[[N; 2]; 2]; 3],
    /// Distances from the corners, bits 2, 1, 0: low or high along a, b, c.
    distances: [N; 8],
}

/// See [`Alone::ratios`].
#[derive(Clone, Copy)]
pub(super) struct Ratios<N: Functions>([[N; 2]; 6]);

impl Alone {
    pub(super) fn of(block: &Block, scale: f64) -> Alone {
        let terms = Terms::of(block, scale);
        Alone {
            axes: terms.axes,
            planes: terms.axes.map(|axis| block.faces[axis].map(|plane: TwoSum| [plane.hi, -plane.lo * scale])),
            scale,
            wanted: [0, 1, 2, 3, 4, 5].map(|element| terms.is_needed(element)),
            coefficients: [0, 1, 2, 3, 4, 5].map(|element| terms.group(element).coefficient),
            terms,
        }
    }

    #[inline(always)]
    pub(super) fn place<N: Functions>(&self, simd: N::Instructions, point: [N; 3]) -> Place<N> {
        let zero = N::splat(simd, 0.0);
        let mut planes = [[[zero; 2]; 2]; 3];
        for (axis, planes) in planes.iter_mut().enumerate() {
            for (plane, &[coordinate, low]) in planes.iter_mut().zip(&self.planes[axis]) {
                // The scale is a power of two: the same digits as if applied at the end.
                let offset = (point[self.axes[axis]] - coordinate).scale_add(self.scale, N::splat(simd, low));
                *plane = [offset, offset * offset];
            }
        }
        let [[a0, a1], [b0, b1], [c0, c1]] = planes;
        let (ab00, ab01, ab10, ab11) = (a0[1] + b0[1], a0[1] + b1[1], a1[1] + b0[1], a1[1] + b1[1]);
        // The processor's unit for roots works beside those that multiply; more than two would have to wait for it.
        let (r000, r001) = ((ab00 + c0[1]).sqrt(), (ab00 + c1[1]).sqrt());
        let (r010, r011) = ((ab01 + c0[1]).root(simd), (ab01 + c1[1]).root(simd));
        let (r100, r101) = ((ab10 + c0[1]).root(simd), (ab10 + c1[1]).root(simd));
        let (r110, r111) = ((ab11 + c0[1]).root(simd), (ab11 + c1[1]).root(simd));
        let distances = [r000, r001, r010, r011, r100, r101, r110, r111];
        Place { planes, distances }
    }

    /// Numerator and denominator of the hyperbolic or circular tangent of half of 4 pi T, by element.
    #[inline(always)]
    pub(super) fn ratios<N: Functions>(&self, simd: N::Instructions, place: &Place<N>) -> Ratios<N> {
        let (zero, one) = (N::splat(simd, 0.0), N::splat(simd, 1.0));
        let r = &place.distances;
        let [[a0, a1], [b0, b1], [c0, c1]] = place.planes;
        let (factors, squares) = (&self.terms.factors, &self.terms.squares);
        let along_b = [r[0] + r[2], r[1] + r[3], r[4] + r[6], r[5] + r[7]];
        let along_c = [r[0] + r[1], r[2] + r[3], r[4] + r[5], r[6] + r[7]];
        let mut ratios = [[zero, one]; 6];
        if self.wanted[AB] {
            let step = (b0[0] + b1[0]) * factors[AB];
            let low = edge_pair([along_b[0], along_b[1]], [along_c[0], along_c[1]], squares[2]);
            let high = edge_pair([along_b[2], along_b[3]], [along_c[2], along_c[3]], squares[2]);
            ratios[AB] = ratio_of_edges(step, low, high);
        }
        if self.wanted[AC] {
            let step = (c0[0] + c1[0]) * factors[AC];
            let low = edge_pair([along_c[0], along_c[1]], [along_b[0], along_b[1]], squares[1]);
            let high = edge_pair([along_c[2], along_c[3]], [along_b[2], along_b[3]], squares[1]);
            ratios[AC] = ratio_of_edges(step, low, high);
        }
        if self.wanted[BC] {
            let along_a = [r[0] + r[4], r[1] + r[5], r[2] + r[6], r[3] + r[7]];
            let step = (c0[0] + c1[0]) * factors[BC];
            let low = edge_pair([along_c[0], along_c[2]], [along_a[0], along_a[1]], squares[0]);
            let high = edge_pair([along_c[1], along_c[3]], [along_a[2], along_a[3]], squares[0]);
            ratios[BC] = ratio_of_edges(step, low, high);
        }
        if self.wanted[AA] {
            let across = across(b0, b1, c0, c1);
            let low = face([r[0], r[1], r[2], r[3]], a0, across, factors[AA]);
            let high = face([r[4], r[5], r[6], r[7]], a1, across, factors[AA]);
            ratios[AA] = angle_of_faces(low, high);
        }
        if self.wanted[BB] {
            let across = across(c0, c1, a0, a1);
            let low = face([r[0], r[4], r[1], r[5]], b0, across, factors[BB]);
            let high = face([r[2], r[6], r[3], r[7]], b1, across, factors[BB]);
            ratios[BB] = angle_of_faces(low, high);
        }
        if self.wanted[CC] {
            let across = across(a0, a1, b0, b1);
            let low = face([r[0], r[2], r[4], r[6]], c0, across, factors[CC]);
            let high = face([r[1], r[3], r[5], r[7]], c1, across, factors[CC]);
            ratios[CC] = angle_of_faces(low, high);
        }
        Ratios(ratios)
    }

    /// mu0 H of the tile, in its frame.
    #[inline(always)]
    pub(super) fn field<N: Functions>(&self, simd: N::Instructions, Ratios(ratios): &Ratios<N>) -> [N; 3] {
        if self.wanted == GENERAL {
            let [ab, ac, bc, aa, bb, _] = *ratios;
            let first = N::artanh_of_ratio(simd, ab[0], ab[1]);
            let second = N::artanh_of_ratio(simd, ac[0], ac[1]);
            let third = N::artanh_of_ratio(simd, bc[0], bc[1]);
            let fourth = N::angle(simd, aa[1], aa[0]);
            let fifth = N::angle(simd, bb[1], bb[0]);
            let two = first.denominator * second.denominator;
            let three = two * third.denominator;
            let four = three * fourth.denominator;
            let mut inverse = N::splat(simd, 1.0).over(four * fifth.denominator);
            let mut sum = [N::splat(simd, 0.0); 3];
            add(&mut sum, fifth.value(simd, fifth.numerator * (inverse * four)), &self.coefficients[BB]);
            inverse = inverse * fifth.denominator;
            add(&mut sum, fourth.value(simd, fourth.numerator * (inverse * three)), &self.coefficients[AA]);
            inverse = inverse * fourth.denominator;
            add(&mut sum, third.value(simd, third.numerator * (inverse * two)), &self.coefficients[BC]);
            inverse = inverse * third.denominator;
            add(&mut sum, second.value(simd, second.numerator * (inverse * first.denominator)), &self.coefficients[AC]);
            add(&mut sum, first.value(simd, first.numerator * (inverse * second.denominator)), &self.coefficients[AB]);
            return sum;
        }
        let mut sum = [N::splat(simd, 0.0); 3];
        add_elements(simd, self.wanted, ratios, &self.coefficients, &mut sum);
        sum
    }

    /// One division for all elements: one over the product of their denominators.
    #[inline(always)]
    pub(super) fn common_inverse<N: Functions>(&self, simd: N::Instructions, Ratios(ratios): &Ratios<N>) -> N {
        common_inverse(simd, self.wanted, ratios)
    }

    /// mu0 H of the tile, in its frame, where no element's half of 4 pi T is beyond [`SMALL_ANGLE`](crate::tolerances::SMALL_ANGLE).
    #[inline(always)]
    pub(super) fn field_of_small<N: Functions>(
        &self,
        simd: N::Instructions,
        Ratios(ratios): &Ratios<N>,
        inverse: N,
    ) -> [N; 3] {
        let mut sum = [N::splat(simd, 0.0); 3];
        add_small_elements(simd, self.wanted, ratios, inverse, odd_series, &self.coefficients, &mut sum);
        sum
    }
}

/// What the wanted elements add to mu0 H.
#[inline(always)]
pub(super) fn add_elements<N: Functions>(
    simd: N::Instructions,
    wanted: [bool; 6],
    ratios: &[[N; 2]; 6],
    coefficients: &[[f64; 3]; 6],
    sum: &mut [N; 3],
) {
    for (element, &[n, m]) in ratios.iter().enumerate() {
        if wanted[element] {
            let reduced = if element < AA { N::artanh_of_ratio(simd, n, m) } else { N::angle(simd, m, n) };
            add(sum, reduced.divided(simd), &coefficients[element]);
        }
    }
}

/// One over the product of the denominators of the wanted elements.
#[inline(always)]
pub(super) fn common_inverse<N: Functions>(simd: N::Instructions, wanted: [bool; 6], ratios: &[[N; 2]; 6]) -> N {
    let mut product = N::splat(simd, 1.0);
    for (element, &[_, m]) in ratios.iter().enumerate() {
        if wanted[element] {
            product = product * m;
        }
    }
    N::splat(simd, 1.0).over(product)
}

/// What the wanted elements add to mu0 H where `series` serves each of them.
#[inline(always)]
pub(super) fn add_small_elements<N: Functions>(
    simd: N::Instructions,
    wanted: [bool; 6],
    ratios: &[[N; 2]; 6],
    mut inverse: N,
    series: impl Fn(N::Instructions, N, bool) -> N,
    coefficients: &[[f64; 3]; 6],
    sum: &mut [N; 3],
) {
    let one = N::splat(simd, 1.0);
    let mut products = [one; 6];
    let mut product = one;
    for (element, &[_, m]) in ratios.iter().enumerate() {
        products[element] = product;
        if wanted[element] {
            product = product * m;
        }
    }
    for element in (0..6).rev() {
        if wanted[element] {
            let [n, m] = ratios[element];
            let s = n * (inverse * products[element]);
            inverse = inverse * m;
            add(sum, series(simd, s, element >= AA), &coefficients[element]);
        }
    }
}

#[inline(always)]
fn add<N: Functions>(sum: &mut [N; 3], half: N, coefficient: &[f64; 3]) {
    for (sum, coefficient) in sum.iter_mut().zip(coefficient) {
        *sum = half.scale_add(*coefficient, *sum);
    }
}
