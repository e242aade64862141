//! Solid harmonics and the matrices that translate expansions.
//!
//! With R_lm = r^l P_lm(cos theta) e^(i m phi) / (l + m)! and I_lm = (l - m)! P_lm(cos theta) e^(i
//! m phi) / r^(l + 1), P_lm without the sign (-1)^m, and points a and b about the centres of two
//! nodes,
//!
//! ```text
//! 1 / |c + a - b| = sum over l, m, k, n of (-1)^l R_lm(a)* I_(l+k)(m+n)(c) R_kn(b)*
//! R_lm(a + b) = sum over k, n of R_kn(a) R_(l-k)(m-n)(b)
//! ```
//!
//! for the vector c from the centre of b to that of a, and R_l(-m) = (-1)^m R_lm*. Expansions are
//! vectors of the real and imaginary parts of R_lm for m >= 0: W. Dehnen, Comput. Astrophys.
//! Cosmol. 1, 1 (2014). The degree 0 is left out: the mean gradient of a cell has none.

use fearless_simd::prelude::*;
use glam::DVec3;
use magsplice_simd::lanes::{LONGEST_VECTOR, Lanes, Number};

/// Highest degree of expansions.
pub(super) const DEGREE: usize = 8;

/// Number of real coefficients of an expansion.
pub(super) const COEFFICIENTS: usize = (DEGREE + 1) * (DEGREE + 1) - 1;

const _: () = assert!(COEFFICIENTS.is_multiple_of(2 * LONGEST_VECTOR));

/// The coefficients of an expansion.
pub(super) type Coefficients = [f64; COEFFICIENTS];

/// Real and imaginary part.
type Complex = [f64; 2];

/// Functions of degree l and order m by their value at 0 <= m <= l.
struct Triangle(Vec<Complex>);

impl Triangle {
    fn index(l: usize, m: usize) -> usize {
        l * (l + 1) / 2 + m
    }

    /// The value of any order; zero beyond the degree.
    fn at(&self, l: usize, m: isize) -> Complex {
        let order = m.unsigned_abs();
        if order > l {
            return [0.0; 2];
        }
        let [re, im] = self.0[Triangle::index(l, order)];
        match (m < 0, order.is_multiple_of(2)) {
            (false, _) => [re, im],
            (true, true) => [re, -im],
            (true, false) => [-re, im],
        }
    }

    /// R_lm up to a degree.
    fn regular(x: DVec3, degree: usize) -> Triangle {
        let square = x.length_squared();
        let mut all = vec![[1.0, 0.0]];
        for l in 1..=degree {
            for m in 0..l {
                let over = 1.0 / ((l + m) * (l - m)) as f64;
                let along = x.z * (2 * l - 1) as f64 * over;
                let last = all[Triangle::index(l - 1, m)];
                let before = if m + 2 <= l { all[Triangle::index(l - 2, m)] } else { [0.0; 2] };
                all.push([0, 1].map(|part: usize| along * last[part] - square * over * before[part]));
            }
            let ([re, im], over) = (all[Triangle::index(l - 1, l - 1)], 0.5 / l as f64);
            all.push([(x.x * re - x.y * im) * over, (x.x * im + x.y * re) * over]);
        }
        Triangle(all)
    }

    /// I_lm up to a degree.
    fn irregular(x: DVec3, degree: usize) -> Triangle {
        let over = 1.0 / x.length_squared();
        let mut all = vec![[over.sqrt(), 0.0]];
        for l in 1..=degree {
            for m in 0..l {
                let along = x.z * (2 * l - 1) as f64 * over;
                let last = all[Triangle::index(l - 1, m)];
                let before = if m + 2 <= l { all[Triangle::index(l - 2, m)] } else { [0.0; 2] };
                let back = ((l - 1) * (l - 1) - m * m) as f64 * over;
                all.push([0, 1].map(|part: usize| along * last[part] - back * before[part]));
            }
            let ([re, im], factor) = (all[Triangle::index(l - 1, l - 1)], (2 * l - 1) as f64 * over);
            all.push([(x.x * re - x.y * im) * factor, (x.x * im + x.y * re) * factor]);
        }
        Triangle(all)
    }
}

/// Degrees from 1 and orders with the index of the real part; the imaginary part follows if m > 0.
fn orders() -> impl Iterator<Item = (usize, usize, usize)> {
    (1..=DEGREE).flat_map(|l| (0..=l).map(move |m| (l, m, l * l - 1 + (2 * m).saturating_sub(1))))
}

/// The gradients of all coefficients at a point.
pub(super) fn gradients(x: DVec3) -> [DVec3; COEFFICIENTS] {
    let harmonics = Triangle::regular(x, DEGREE - 1);
    let mut all = [DVec3::ZERO; COEFFICIENTS];
    for (l, m, at) in orders() {
        let [lower, own, upper] = [-1, 0, 1].map(|step| harmonics.at(l - 1, m as isize + step));
        all[at] = DVec3::new(0.5 * (lower[0] - upper[0]), -0.5 * (lower[1] + upper[1]), own[0]);
        if m > 0 {
            all[at + 1] = DVec3::new(0.5 * (lower[1] - upper[1]), 0.5 * (lower[0] + upper[0]), own[1]);
        }
    }
    all
}

/// A matrix that takes coefficients to coefficients, column after column.
pub(super) struct Translation(Box<[Coefficients]>);

impl Translation {
    fn zero() -> Translation {
        Translation(vec![[0.0; COEFFICIENTS]; COEFFICIENTS].into_boxed_slice())
    }

    /// From the coefficients of a node with half the side, whose centre is at `shift` in sides of
    /// the other.
    pub(super) fn to_parent(shift: DVec3) -> Translation {
        let harmonics = Triangle::regular(shift, DEGREE);
        let mut matrix = Translation::zero();
        for (l, m, row) in orders() {
            for (k, n, column) in orders().filter(|(k, ..)| *k <= l) {
                let scale = 0.5_f64.powi(k as i32);
                let [re, im] = harmonics.at(l - k, m as isize - n as isize).map(|part| scale * part);
                // The conjugate stands for the order -n.
                let sign = if n == 0 {
                    0.0
                } else if n.is_multiple_of(2) {
                    scale
                } else {
                    -scale
                };
                let [re_back, im_back] = harmonics.at(l - k, (m + n) as isize).map(|part| sign * part);
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

    /// From moments of one node to the local expansion of another one: `offset` leads from the
    /// centre of the source to that of the receiver, in sides of the receiver; `ratio` is the side
    /// of the source over that of the receiver.
    pub(super) fn to_local(offset: DVec3, ratio: f64) -> Translation {
        let harmonics = Triangle::irregular(offset, 2 * DEGREE);
        let mut matrix = Translation::zero();
        for (l, m, row) in orders() {
            for (k, n, column) in orders() {
                // Each order stands for itself and its negative.
                let weight = if m + n == 0 { 1.0 } else { 2.0 };
                let scale = weight * ratio.powi(k as i32) * if l.is_multiple_of(2) { 1.0 } else { -1.0 };
                let [re, im] = harmonics.at(l + k, (m + n) as isize).map(|part| scale * part);
                let sign = if m == 0 || n == 0 {
                    0.0
                } else if m.is_multiple_of(2) {
                    scale
                } else {
                    -scale
                };
                let [re_back, im_back] = harmonics.at(l + k, n as isize - m as isize).map(|part| sign * part);
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

    /// The products with several vectors, for which the matrix is read once.
    #[inline(always)]
    pub(super) fn products<S: Simd, const N: usize>(&self, simd: S, from: [&Coefficients; N]) -> [Coefficients; N] {
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
    pub(super) fn add_transposed_product(&self, from: &Coefficients, to: &mut Coefficients) {
        for (column, to) in self.0.iter().zip(to) {
            *to += column.iter().zip(from).map(|(element, from)| element * from).sum::<f64>();
        }
    }
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};

    use super::*;

    fn add_product(matrix: &Translation, from: &Coefficients, to: &mut Coefficients) {
        let [product] = dispatch!(Level::new(), simd => matrix.products(simd, [from]));
        to.iter_mut().zip(product).for_each(|(to, product)| *to += product);
    }

    fn coefficients(x: DVec3) -> Coefficients {
        let harmonics = Triangle::regular(x, DEGREE);
        let mut all = [0.0; COEFFICIENTS];
        for (l, m, at) in orders() {
            let [re, im] = harmonics.at(l, m as isize);
            all[at] = re;
            if m > 0 {
                all[at + 1] = im;
            }
        }
        all
    }

    /// The expansion without its terms of degree 0 in one of the points: the mixed difference of 1
    /// / r.
    #[test]
    fn translation_to_local_gives_the_potential() {
        let (offset, ratio) = (DVec3::new(3.0, -2.0, 2.5), 0.5);
        let (a, b) = (DVec3::new(0.2, 0.3, -0.1), DVec3::new(-0.4, 0.2, 0.5));
        let potential = |a: DVec3, b: DVec3| 1.0 / (offset + a - b * ratio).length();
        let mut local = [0.0; COEFFICIENTS];
        add_product(&Translation::to_local(offset, ratio), &coefficients(b), &mut local);
        let sum: f64 = local.iter().zip(coefficients(a)).map(|(local, a)| local * a).sum();
        let exact = potential(a, b) - potential(a, DVec3::ZERO) - potential(DVec3::ZERO, b)
            + potential(DVec3::ZERO, DVec3::ZERO);
        assert!((sum - exact).abs() <= 1e-8, "{sum} {exact}");
    }

    #[test]
    fn translation_to_parent_moves_the_centre() {
        let (shift, b) = (DVec3::new(0.25, -0.25, 0.25), DVec3::new(0.3, 0.2, -0.7));
        let mut moved = coefficients(shift).map(|part| -part);
        add_product(&Translation::to_parent(shift), &coefficients(b), &mut moved);
        // Without the degree 0 of b, R(shift) is missing.
        let exact = coefficients(0.5 * b + shift);
        for (at, (moved, exact)) in moved.iter().zip(exact).enumerate() {
            let missing = 2.0 * coefficients(shift)[at];
            assert!((moved + missing - exact).abs() <= 1e-15, "{at}: {moved} {exact}");
        }
    }

    #[test]
    fn gradients_are_those_of_the_coefficients() {
        let (x, step) = (DVec3::new(0.3, -0.2, 0.4), 1e-5);
        let gradients = gradients(x);
        for axis in DVec3::AXES {
            let (ahead, back) = (coefficients(x + step * axis), coefficients(x - step * axis));
            for at in 0..COEFFICIENTS {
                let difference = (ahead[at] - back[at]) / (2.0 * step);
                assert!((difference - gradients[at].dot(axis)).abs() <= 1e-10, "{at}");
            }
        }
    }
}
