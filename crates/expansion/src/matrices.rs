//! Translations of expansions of one low degree as matrices (M2M, M2L, L2L).
//!
//! Matrices replace the operators of [`moments`](crate::moments) and [`m2l`](crate::m2l) where few
//! distinct shifts occur, each many times, because each matrix is computed once. At degree 8 the
//! product takes a tenth of the time of [`m2l::translate`](crate::m2l::translate), which is
//! designed for high degrees. Moments and local expansions are vectors of the same form. The
//! translation of local expansions by a shift is the transpose of the translation of moments by the
//! opposite shift, to round-off.
//!
//! With points a and b relative to the centres of two nodes,
//!
//! ```text
//! 1 / |c + a - b| = sum over l, m, k, n of (-1)^l R_lm(a)* I_(l+k)(m+n)(c) R_kn(b)*
//! R_lm(a + b) = sum over k, n of R_kn(a) R_(l-k)(m-n)(b)
//! ```
//!
//! for the vector c from the centre of b to the centre of a, and R_l(-m) = (-1)^m R_lm*
//! (docs/physics.md, Eq. P21). Expansions are vectors of the real and imaginary parts of
//! coefficients of R_lm for m >= 0: W. Dehnen, Comput. Astrophys. Cosmol. 1, 1 (2014). Degree 0 is
//! omitted, because cuboids have no net charge.

use fearless_simd::prelude::*;
use glam::DVec3;
use magsplice_simd::lanes::{LONGEST_VECTOR, Lanes, Number};

use crate::moments::Moments;
use crate::triangle::HarmonicTriangle;

/// Highest degree of expansions translated by matrices.
pub const MATRIX_DEGREE: usize = 8;

/// Number of real coefficients of an expansion.
pub const COEFFICIENTS: usize = (MATRIX_DEGREE + 1) * (MATRIX_DEGREE + 1) - 1;

const _: () = assert!(COEFFICIENTS.is_multiple_of(2 * LONGEST_VECTOR));

/// The coefficients of an expansion.
pub type Coefficients = [f64; COEFFICIENTS];

/// Degrees from 1 and orders with the index of the real part; the imaginary part follows if m > 0.
fn orders() -> impl Iterator<Item = (usize, usize, usize)> {
    (1..=MATRIX_DEGREE).flat_map(|l| (0..=l).map(move |m| (l, m, l * l - 1 + (2 * m).saturating_sub(1))))
}

/// The coefficients of moments of degree [`MATRIX_DEGREE`]. They belong to R_lm; moments are their
/// conjugates.
///
/// # Panics
/// If the moments have a lower degree.
pub fn coefficients(moments: &Moments) -> Coefficients {
    let mut all = [0.0; COEFFICIENTS];
    for (l, m, at) in orders() {
        let [re, im] = moments.at(l, m);
        all[at] = re;
        if m > 0 {
            all[at + 1] = -im;
        }
    }
    all
}

/// A matrix that translates coefficients, column after column.
pub struct Translation(Box<[Coefficients]>);

impl Translation {
    fn zero() -> Translation {
        Translation(vec![[0.0; COEFFICIENTS]; COEFFICIENTS].into_boxed_slice())
    }

    /// The translation from a node of half the side, whose centre is at `shift` in sides of the
    /// parent.
    pub fn to_parent(shift: DVec3) -> Translation {
        let harmonics = HarmonicTriangle::regular(shift, MATRIX_DEGREE);
        let mut matrix = Translation::zero();
        for (l, m, row) in orders() {
            for (k, n, column) in orders().filter(|(k, ..)| *k <= l) {
                let scale = 0.5_f64.powi(k as i32);
                let [re, im] = harmonics.at_order(l - k, m as isize - n as isize).map(|part| scale * part);
                // The order -n is the conjugate.
                let sign = if n == 0 {
                    0.0
                } else if n.is_multiple_of(2) {
                    scale
                } else {
                    -scale
                };
                let [re_back, im_back] = harmonics.at_order(l - k, (m + n) as isize).map(|part| sign * part);
                matrix.0[column][row] += re + re_back;
                if n > 0 {
                    matrix.0[column + 1][row] += im_back - im;
                }
                if m > 0 {
                    matrix.0[column][row + 1] += im + im_back;
                    if n > 0 {
                        matrix.0[column + 1][row + 1] += re - re_back;
                    }
                }
            }
        }
        matrix
    }

    /// The translation from moments of one node to the local expansion of another. `offset` is the
    /// vector from the centre of the source to the centre of the receiver, in sides of the
    /// receiver; `ratio` is the side of the source over the side of the receiver.
    pub fn to_local(offset: DVec3, ratio: f64) -> Translation {
        let harmonics = HarmonicTriangle::irregular(offset, 2 * MATRIX_DEGREE);
        let mut matrix = Translation::zero();
        for (l, m, row) in orders() {
            for (k, n, column) in orders() {
                // Each order represents itself and its negative.
                let weight = if m + n == 0 { 1.0 } else { 2.0 };
                let scale = weight * ratio.powi(k as i32) * if l.is_multiple_of(2) { 1.0 } else { -1.0 };
                let [re, im] = harmonics.at_order(l + k, (m + n) as isize).map(|part| scale * part);
                let sign = if m == 0 || n == 0 {
                    0.0
                } else if m.is_multiple_of(2) {
                    scale
                } else {
                    -scale
                };
                let [re_back, im_back] = harmonics.at_order(l + k, n as isize - m as isize).map(|part| sign * part);
                matrix.0[column][row] += re + re_back;
                if m > 0 {
                    matrix.0[column][row + 1] += im - im_back;
                }
                if n > 0 {
                    matrix.0[column + 1][row] += im + im_back;
                    if m > 0 {
                        matrix.0[column + 1][row + 1] += re_back - re;
                    }
                }
            }
        }
        matrix
    }

    /// The products with several vectors. The matrix is read once.
    #[inline(always)]
    pub fn products<S: Simd, const N: usize>(&self, simd: S, from: [&Coefficients; N]) -> [Coefficients; N] {
        let length = Lanes::<S>::LEN;
        let mut products = [[0.0; COEFFICIENTS]; N];
        for start in (0..COEFFICIENTS).step_by(2 * length) {
            let (middle, end) = (start + length, start + 2 * length);
            let mut sums = [[Lanes::<S>::splat(simd, 0.0); 2]; N];
            for (index, column) in self.0.iter().enumerate() {
                let (low, high) = (Lanes::load(simd, &column[start..middle]), Lanes::load(simd, &column[middle..end]));
                for (sum, from) in sums.iter_mut().zip(from) {
                    sum[0] = low.scale_add(from[index], sum[0]);
                    sum[1] = high.scale_add(from[index], sum[1]);
                }
            }
            for (product, sum) in products.iter_mut().zip(sums) {
                sum[0].store(&mut product[start..middle]);
                sum[1].store(&mut product[middle..end]);
            }
        }
        products
    }

    /// Adds the product of the transpose with `from`.
    pub fn add_transposed_product(&self, from: &Coefficients, to: &mut Coefficients) {
        for (column, to) in self.0.iter().zip(to) {
            *to += column.iter().zip(from).map(|(element, from)| element * from).sum::<f64>();
        }
    }
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};

    use super::*;
    use crate::source::CuboidSource;

    fn add_product(matrix: &Translation, from: &Coefficients, to: &mut Coefficients) {
        let [product] = dispatch!(Level::new(), simd => matrix.products(simd, [from]));
        to.iter_mut().zip(product).for_each(|(to, product)| *to += product);
    }

    fn harmonics(x: DVec3) -> Coefficients {
        let harmonics = HarmonicTriangle::regular(x, MATRIX_DEGREE);
        let mut all = [0.0; COEFFICIENTS];
        for (l, m, at) in orders() {
            let [re, im] = harmonics.at(l, m);
            all[at] = re;
            if m > 0 {
                all[at + 1] = im;
            }
        }
        all
    }

    /// The mixed difference of 1 / r, which is the expansion without its terms of degree 0 in
    /// either point.
    #[test]
    fn translation_to_local_gives_the_potential() {
        let (offset, ratio) = (DVec3::new(3.0, -2.0, 2.5), 0.5);
        let (a, b) = (DVec3::new(0.2, 0.3, -0.1), DVec3::new(-0.4, 0.2, 0.5));
        let potential = |a: DVec3, b: DVec3| 1.0 / (offset + a - b * ratio).length();
        let mut local = [0.0; COEFFICIENTS];
        add_product(&Translation::to_local(offset, ratio), &harmonics(b), &mut local);
        let sum: f64 = local.iter().zip(harmonics(a)).map(|(local, a)| local * a).sum();
        let exact = potential(a, b) - potential(a, DVec3::ZERO) - potential(DVec3::ZERO, b)
            + potential(DVec3::ZERO, DVec3::ZERO);
        assert!((sum - exact).abs() <= 1e-8, "{sum} {exact}");
    }

    #[test]
    fn translation_to_parent_moves_the_centre() {
        let (shift, b) = (DVec3::new(0.25, -0.25, 0.25), DVec3::new(0.3, 0.2, -0.7));
        let mut moved = harmonics(shift).map(|part| -part);
        add_product(&Translation::to_parent(shift), &harmonics(b), &mut moved);
        // R(shift) is missing without the degree 0 of b.
        let exact = harmonics(0.5 * b + shift);
        for (at, (moved, exact)) in moved.iter().zip(exact).enumerate() {
            let missing = 2.0 * harmonics(shift)[at];
            assert!((moved + missing - exact).abs() <= 1e-15, "{at}: {moved} {exact}");
        }
    }

    /// The moments of a small cuboid of the polarization J are the derivatives of the harmonics
    /// along the dipole J V / 4 pi.
    #[test]
    fn coefficients_of_moments_are_derivatives_of_harmonics() {
        let (x, step, side) = (DVec3::new(0.3, -0.2, 0.4), 1e-5, 1e-4);
        for axis in DVec3::AXES {
            let polarization_t = axis * (4.0 * std::f64::consts::PI / (side * side * side));
            let source = CuboidSource::new(x, DVec3::splat(side), None, polarization_t);
            let moments = coefficients(&Moments::from_sources(Level::new(), &[source], MATRIX_DEGREE));
            let (ahead, back) = (harmonics(x + step * axis), harmonics(x - step * axis));
            for at in 0..COEFFICIENTS {
                let difference = (ahead[at] - back[at]) / (2.0 * step);
                assert!((difference - moments[at]).abs() <= 1e-9, "{at}: {difference} {}", moments[at]);
            }
        }
    }
}
