//! The six elements of the demagnetizing tensor from distances and offsets (docs/physics.md,
//! section 2.6).

use magsplice_simd::functions::{Functions, odd_series, short_odd_series};
use magsplice_simd::lanes::Number;

use super::terms::{AA, AB, AC, BB, BC, CC};

/// Position of points relative to a tile, in its scale.
#[derive(Clone, Copy)]
pub struct CornerGeometry<N> {
    /// Offset and its square, by plane: low and high along a, b, c.
    pub planes: [[[N; 2]; 2]; 3],
    /// Distances from the corners; bits 2, 1, 0 are set for the high side along a, b, c.
    pub distances: [N; 8],
}

impl<N: Number> CornerGeometry<N> {
    /// Numerator and denominator of the hyperbolic or circular tangent of half of 4 pi T, for one
    /// element. `factors` and `squares` come from [`Terms`](super::terms::Terms).
    #[inline(always)]
    pub fn ratio<const ELEMENT: usize>(&self, factors: &[f64; 6], squares: &[f64; 3]) -> [N; 2] {
        let (r, [[a0, a1], [b0, b1], [c0, c1]]) = (&self.distances, self.planes);
        let factor = factors[ELEMENT];
        // Sums over the ends of edges along an axis, by the sides along the other two axes.
        let along_a = [r[0] + r[4], r[1] + r[5], r[2] + r[6], r[3] + r[7]];
        let along_b = [r[0] + r[2], r[1] + r[3], r[4] + r[6], r[5] + r[7]];
        let along_c = [r[0] + r[1], r[2] + r[3], r[4] + r[5], r[6] + r[7]];
        match ELEMENT {
            AB => {
                let step = (b0[0] + b1[0]) * factor;
                let low = edge_pair([along_b[0], along_b[1]], [along_c[0], along_c[1]], squares[2]);
                let high = edge_pair([along_b[2], along_b[3]], [along_c[2], along_c[3]], squares[2]);
                ratio_of_edges(step, low, high)
            }
            AC => {
                let step = (c0[0] + c1[0]) * factor;
                let low = edge_pair([along_c[0], along_c[1]], [along_b[0], along_b[1]], squares[1]);
                let high = edge_pair([along_c[2], along_c[3]], [along_b[2], along_b[3]], squares[1]);
                ratio_of_edges(step, low, high)
            }
            BC => {
                let step = (c0[0] + c1[0]) * factor;
                let low = edge_pair([along_c[0], along_c[2]], [along_a[0], along_a[1]], squares[0]);
                let high = edge_pair([along_c[1], along_c[3]], [along_a[2], along_a[3]], squares[0]);
                ratio_of_edges(step, low, high)
            }
            AA => {
                let across = across(b0, b1, c0, c1);
                let low = face([r[0], r[1], r[2], r[3]], a0, across, factor);
                let high = face([r[4], r[5], r[6], r[7]], a1, across, factor);
                angle_of_faces(low, high)
            }
            BB => {
                let across = across(c0, c1, a0, a1);
                let low = face([r[0], r[4], r[1], r[5]], b0, across, factor);
                let high = face([r[2], r[6], r[3], r[7]], b1, across, factor);
                angle_of_faces(low, high)
            }
            CC => {
                let across = across(a0, a1, b0, b1);
                let low = face([r[0], r[2], r[4], r[6]], c0, across, factor);
                let high = face([r[1], r[3], r[5], r[7]], c1, across, factor);
                angle_of_faces(low, high)
            }
            _ => unreachable!("there are six elements"),
        }
    }
}

/// Numerator and denominator of tanh(2 pi T_ij), from the edges on the low and the high side along
/// j (Eq. P18).
#[inline(always)]
fn ratio_of_edges<N: Number>(step: N, (p_low, e_low): (N, N), (p_high, e_high): (N, N)) -> [N; 2] {
    let (low, high) = (step * p_low, step * p_high);
    [high.mul_sub(e_low, low * e_high), e_low.mul_sub(e_high, low * high)]
}

/// Numerator and denominator of tan(2 pi T_ii): the angle of the high face minus the angle of the
/// low face (Eq. P19).
#[inline(always)]
fn angle_of_faces<N: Number>((re_low, im_low): (N, N), (re_high, im_high): (N, N)) -> [N; 2] {
    [re_low.mul_sub(im_high, im_low * re_high), re_low.mul_add(re_high, im_low * im_high)]
}

/// P and E of Eq. P18 for the two edges on one side along j, from the sums across i at both ends
/// and along k at both sides.
#[inline(always)]
fn edge_pair<N: Number>(across: [N; 2], along: [N; 2], length_squared: f64) -> (N, N) {
    (across[0] + across[1], (across[0] * across[1]) * along[0].mul_sub_constant(along[1], length_squared))
}

/// Products of the vectors to the corners of a face, without the square of its distance: 00.11,
/// then 00.01 and 01.11, then 00.10 and 10.11. Planes are given as offset and square.
#[inline(always)]
fn across<N: Number>(y0: [N; 2], y1: [N; 2], z0: [N; 2], z1: [N; 2]) -> [N; 5] {
    let (yy, zz) = (y0[0] * y1[0], z0[0] * z1[0]);
    [yy + zz, y0[1] + zz, yy + z1[1], yy + z0[1], y1[1] + zz]
}

/// A complex number whose angle is half the solid angle of a face: the product of such numbers of
/// its two triangles (Eq. P19).
#[inline(always)]
fn face<N: Number>([r00, r01, r10, r11]: [N; 4], [offset, square]: [N; 2], across: [N; 5], area: f64) -> (N, N) {
    let diagonal = r00.mul_add(r11, square + across[0]);
    let common = square * (r00 + r11);
    let a = r01.mul_add(diagonal, across[1].mul_add(r11, across[2].mul_add(r00, common)));
    let b = r10.mul_add(diagonal, across[3].mul_add(r11, across[4].mul_add(r00, common)));
    let n = offset * area;
    (a.mul_sub(b, n * n), n * (a + b))
}

/// A sum over the elements of a tile, added one after the other.
pub trait ElementSum<N> {
    /// Adds an element, given as half of 4 pi T.
    fn add(&mut self, element: usize, half: N);
}

/// mu0 H of a tile, in tesla.
pub struct FieldSum<'a, N> {
    /// The sum so far.
    pub field_t: [N; 3],
    /// Contribution of one unit of half of 4 pi T to mu0 H, by element.
    pub coefficients: &'a [[f64; 3]; 6],
}

impl<N: Number> ElementSum<N> for FieldSum<'_, N> {
    #[inline(always)]
    fn add(&mut self, element: usize, half: N) {
        for (sum, coefficient) in self.field_t.iter_mut().zip(&self.coefficients[element]) {
            *sum = half.scale_add(*coefficient, *sum);
        }
    }
}

/// Adds the needed elements.
#[inline(always)]
pub fn add_elements<N: Functions>(
    simd: N::Instructions,
    needed: [bool; 6],
    ratios: &[[N; 2]; 6],
    sum: &mut impl ElementSum<N>,
) {
    for (element, &[n, m]) in ratios.iter().enumerate() {
        if needed[element] {
            let reduced = if element < AA { N::artanh_of_ratio(simd, n, m) } else { N::angle(simd, m, n) };
            sum.add(element, reduced.divided(simd));
        }
    }
}

/// The reciprocal of the product of the denominators of the needed elements.
#[inline(always)]
pub fn common_inverse<N: Functions>(simd: N::Instructions, needed: [bool; 6], ratios: &[[N; 2]; 6]) -> N {
    let mut product = N::splat(simd, 1.0);
    for (element, &[_, m]) in ratios.iter().enumerate() {
        if needed[element] {
            product = product * m;
        }
    }
    N::splat(simd, 1.0).over(product)
}

/// Adds the needed elements, with one division for all. Half of 4 pi T of each must be at most
/// [`SMALL_ANGLE`](crate::tolerances::SMALL_ANGLE), or
/// [`SMALLER_ANGLE`](crate::tolerances::SMALLER_ANGLE) with `is_short`.
#[inline(always)]
pub fn add_small_elements<N: Functions>(
    simd: N::Instructions,
    needed: [bool; 6],
    ratios: &[[N; 2]; 6],
    mut inverse: N,
    is_short: bool,
    sum: &mut impl ElementSum<N>,
) {
    let one = N::splat(simd, 1.0);
    let mut products = [one; 6];
    let mut product = one;
    for (element, &[_, m]) in ratios.iter().enumerate() {
        products[element] = product;
        if needed[element] {
            product = product * m;
        }
    }
    for element in (0..6).rev() {
        if needed[element] {
            let [n, m] = ratios[element];
            let s = n * (inverse * products[element]);
            inverse = inverse * m;
            let is_angle = element >= AA;
            let half = if is_short { short_odd_series(simd, s, is_angle) } else { odd_series(simd, s, is_angle) };
            sum.add(element, half);
        }
    }
}
