//! The closed form of a single cuboid, without tables (docs/physics.md, section 2.6).

use super::elements::{CornerGeometry, ElementSum, FieldSum, add_elements, add_small_elements, common_inverse};
use super::magnitude::{FieldAndMagnitude, MagnitudeTerms};
use super::rod::ratios_of_rod;
use super::terms::{AA, AB, AC, BB, BC, CC, Form, Terms};
use crate::block::Block;
use crate::tolerances::STRIP_ASPECT;
use magsplice_simd::compensated_sum::TwoSum;
use magsplice_simd::functions::Functions;

/// A cuboid whose axes a, b, c are ordered by length.
pub struct ClosedForm {
    axes: [usize; 3],
    /// Low and high plane along a, b, c: the coordinate, and minus its rounding error, scaled.
    planes: [[[f64; 2]; 2]; 3],
    scale: f64,
    terms: Terms,
    is_strip: bool,
    needed: [bool; 6],
    /// Contribution of one unit of half of 4 pi T to mu0 H, in tesla.
    coefficients: [[f64; 3]; 6],
    magnitude: MagnitudeTerms,
}

/// The elements that J with three components needs.
const GENERAL: [bool; 6] = [true, true, true, true, true, false];

/// See [`ClosedForm::ratios`].
#[derive(Clone, Copy)]
pub struct Ratios<N: Functions>([[N; 2]; 6]);

impl ClosedForm {
    /// Prepares a block whose lengths `scale` brings to order one.
    pub fn new(block: &Block, scale: f64, form: Form) -> ClosedForm {
        let terms = Terms::new(block, scale, form);
        ClosedForm {
            axes: terms.axes,
            planes: terms.axes.map(|axis| block.faces[axis].map(|plane: TwoSum| [plane.hi, -plane.lo * scale])),
            scale,
            is_strip: terms.squares[0] > (STRIP_ASPECT * STRIP_ASPECT) * terms.squares[1],
            needed: [0, 1, 2, 3, 4, 5].map(|element| terms.is_needed(element)),
            coefficients: [0, 1, 2, 3, 4, 5].map(|element| terms.group(element).coefficient),
            magnitude: MagnitudeTerms::new(block, &terms),
            terms,
        }
    }

    /// Offsets and distances of points relative to the cuboid.
    #[inline(always)]
    pub fn place<N: Functions>(&self, simd: N::Instructions, point: [N; 3]) -> CornerGeometry<N> {
        let zero = N::splat(simd, 0.0);
        let mut planes = [[[zero; 2]; 2]; 3];
        for (axis, planes) in planes.iter_mut().enumerate() {
            for (plane, &[coordinate, low]) in planes.iter_mut().zip(&self.planes[axis]) {
                // The scale is a power of two, so this product is exact.
                let offset = (point[self.axes[axis]] - coordinate).scale_add(self.scale, N::splat(simd, low));
                *plane = [offset, offset * offset];
            }
        }
        let [[a0, a1], [b0, b1], [c0, c1]] = planes;
        let (ab00, ab01, ab10, ab11) = (a0[1] + b0[1], a0[1] + b1[1], a1[1] + b0[1], a1[1] + b1[1]);
        // Two roots use the processor's root unit, in parallel with the multipliers; more would
        // wait for it.
        let (r000, r001) = ((ab00 + c0[1]).sqrt(), (ab00 + c1[1]).sqrt());
        let (r010, r011) = ((ab01 + c0[1]).root(simd), (ab01 + c1[1]).root(simd));
        let (r100, r101) = ((ab10 + c0[1]).root(simd), (ab10 + c1[1]).root(simd));
        let (r110, r111) = ((ab11 + c0[1]).root(simd), (ab11 + c1[1]).root(simd));
        let distances = [r000, r001, r010, r011, r100, r101, r110, r111];
        CornerGeometry { planes, distances }
    }

    /// Twice the offsets of points from the centre of the cuboid, scaled. Offsets from its faces
    /// have lost the last digits of small ones.
    #[inline(always)]
    pub fn twice_from_centre<N: Functions>(&self, simd: N::Instructions, point: [N; 3]) -> [N; 3] {
        let mut steps = [N::splat(simd, 0.0); 3];
        for (axis, (step, [low, high])) in steps.iter_mut().zip(self.planes).enumerate() {
            let (coordinate, centre) = (point[self.axes[axis]], TwoSum::new(low[0], high[0]));
            let rest = N::splat(simd, (low[1] + high[1]) - centre.lo * self.scale);
            *step = ((coordinate + coordinate) - centre.hi).scale_add(self.scale, rest);
        }
        steps
    }

    /// Numerator and denominator of the hyperbolic or circular tangent of half of 4 pi T, by
    /// element.
    #[inline(always)]
    pub fn ratios<N: Functions>(&self, simd: N::Instructions, place: &CornerGeometry<N>) -> Ratios<N> {
        let mut ratios = [[N::splat(simd, 0.0), N::splat(simd, 1.0)]; 6];
        let (factors, squares) = (&self.terms.factors, &self.terms.squares);
        if self.needed[AB] {
            ratios[AB] = place.ratio::<AB>(factors, squares);
        }
        if self.needed[AC] {
            ratios[AC] = place.ratio::<AC>(factors, squares);
        }
        if self.needed[BC] {
            ratios[BC] = place.ratio::<BC>(factors, squares);
        }
        if self.needed[AA] {
            ratios[AA] = place.ratio::<AA>(factors, squares);
        }
        if self.needed[BB] {
            ratios[BB] = place.ratio::<BB>(factors, squares);
        }
        if self.needed[CC] {
            ratios[CC] = place.ratio::<CC>(factors, squares);
        }
        Ratios(ratios)
    }

    /// [`ClosedForm::ratios`] of a cuboid prepared as a rod.
    #[inline(always)]
    pub fn ratios_of_rod<N: Functions>(&self, simd: N::Instructions, place: &CornerGeometry<N>) -> Ratios<N> {
        let mut ratios = [[N::splat(simd, 0.0), N::splat(simd, 1.0)]; 6];
        let (factors, squares) = (&self.terms.factors, &self.terms.squares);
        if self.needed[AB] {
            ratios[AB] = place.ratio::<AB>(factors, squares);
        }
        if self.needed[AC] {
            ratios[AC] = place.ratio::<AC>(factors, squares);
        }
        if self.needed[AA] {
            ratios[AA] = place.ratio::<AA>(factors, squares);
        }
        [ratios[BC], ratios[BB]] = ratios_of_rod(simd, place, factors, squares);
        Ratios(ratios)
    }

    /// A number that is at least 0 where a point is farther than a quarter of the second side from
    /// the edges of both ends along that side.
    #[inline(always)]
    fn beyond_ends<N: Functions>(&self, simd: N::Instructions, place: &CornerGeometry<N>) -> N {
        let mut square = N::splat(simd, -self.terms.squares[1] / 16.0);
        for [low, high] in [place.planes[0], place.planes[2]] {
            square = square + (low[0] + high[0]).where_at_least(0.0, high[1], low[1]);
        }
        square
    }

    /// mu0 H in tesla of a cuboid prepared as thin, in its frame.
    #[inline(always)]
    pub fn field_of_thin<N: Functions>(&self, simd: N::Instructions, place: &CornerGeometry<N>) -> [N; 3] {
        let (factors, squares) = (&self.terms.factors, &self.terms.squares);
        let mut ratios = [[N::splat(simd, 0.0), N::splat(simd, 1.0)]; 6];
        if self.needed[AB] {
            ratios[AB] = place.ratio::<AB>(factors, squares);
        }
        [ratios[BC], ratios[BB]] = ratios_of_rod(simd, place, factors, squares);
        // The same step with a and b exchanged.
        let CornerGeometry { planes: [a, b, c], distances: r } = *place;
        let exchanged =
            CornerGeometry { planes: [b, a, c], distances: [r[0], r[1], r[4], r[5], r[2], r[3], r[6], r[7]] };
        let mut across = *factors;
        (across[BC], across[BB]) = (factors[AC], factors[AA]);
        [ratios[AC], ratios[AA]] = ratios_of_rod(simd, &exchanged, &across, squares);
        if self.is_strip {
            // Beside a strip T_ac and T_aa come from its distant ends, which this form takes from
            // two long half-infinite strips across it.
            let far = self.beyond_ends(simd, place);
            let compact =
                [place.ratio::<AC>(&self.terms.compact, squares), place.ratio::<AA>(&self.terms.compact, squares)];
            for (element, compact) in [AC, AA].into_iter().zip(compact) {
                for (part, compact) in ratios[element].iter_mut().zip(compact) {
                    *part = far.where_at_least(0.0, compact, *part);
                }
            }
        }
        let mut sum = self.field_sum(simd);
        add_elements(simd, self.needed, &ratios, &mut sum);
        sum.field_t
    }

    /// Begins the sum of mu0 H of the cuboid in tesla, in its frame.
    #[inline(always)]
    pub fn field_sum<N: Functions>(&self, simd: N::Instructions) -> FieldSum<'_, N> {
        FieldSum { field_t: [N::splat(simd, 0.0); 3], coefficients: &self.coefficients }
    }

    /// Begins the same sum with an upper bound of the sum over k of |T e_k| |J_k| in tesla.
    #[inline(always)]
    pub fn field_and_magnitude<N: Functions>(&self, simd: N::Instructions) -> FieldAndMagnitude<'_, N> {
        FieldAndMagnitude::new(simd, self.field_sum(simd), &self.magnitude)
    }

    /// Adds the elements of a compact cuboid or a rod.
    #[inline(always)]
    pub fn add_elements<N: Functions>(
        &self,
        simd: N::Instructions,
        Ratios(ratios): &Ratios<N>,
        sum: &mut impl ElementSum<N>,
    ) {
        if self.needed != GENERAL {
            return add_elements(simd, self.needed, ratios, sum);
        }
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
        sum.add(BB, fifth.value(simd, fifth.numerator * (inverse * four)));
        inverse = inverse * fifth.denominator;
        sum.add(AA, fourth.value(simd, fourth.numerator * (inverse * three)));
        inverse = inverse * fourth.denominator;
        sum.add(BC, third.value(simd, third.numerator * (inverse * two)));
        inverse = inverse * third.denominator;
        sum.add(AC, second.value(simd, second.numerator * (inverse * first.denominator)));
        sum.add(AB, first.value(simd, first.numerator * (inverse * second.denominator)));
    }

    /// Adds the elements, with one division for each.
    #[inline(always)]
    pub fn add_divided<N: Functions>(
        &self,
        simd: N::Instructions,
        Ratios(ratios): &Ratios<N>,
        sum: &mut impl ElementSum<N>,
    ) {
        add_elements(simd, self.needed, ratios, sum);
    }

    /// Adds the elements, with one division for all. Half of 4 pi T of each must be at most
    /// [`SMALL_ANGLE`](crate::tolerances::SMALL_ANGLE).
    #[inline(always)]
    pub fn add_small_elements<N: Functions>(
        &self,
        simd: N::Instructions,
        Ratios(ratios): &Ratios<N>,
        sum: &mut impl ElementSum<N>,
    ) {
        let inverse = common_inverse(simd, self.needed, ratios);
        add_small_elements(simd, self.needed, ratios, inverse, false, sum);
    }
}
