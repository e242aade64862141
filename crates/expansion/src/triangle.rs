//! Complex coefficients by degree and order, and the recurrences of solid harmonics
//! (docs/physics.md, Eqs. P21 and P22).

use std::ops::{Add, Mul, Sub};

use fearless_simd::prelude::*;
use glam::DVec3;
use magsplice_simd::lanes::{LONGEST_VECTOR, Lanes};

/// A number type of harmonics: one double, or a vector with one double for each source.
pub trait HarmonicNumber:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Mul<f64, Output = Self>
{
}

impl<T: Copy + Add<Output = T> + Sub<Output = T> + Mul<Output = T> + Mul<f64, Output = T>> HarmonicNumber for T {}

/// The vector v of a directional derivative v . grad. Derivatives along one axis are faster.
#[derive(Clone, Copy)]
pub enum DerivativeVector<N> {
    /// Along x, of this length.
    X(N),
    /// Along y, of this length.
    Y(N),
    /// Along z, of this length.
    Z(N),
    /// Components along x, y and z.
    Any([N; 3]),
}

/// Complex coefficients by degree l and order m, 0 <= m <= l.
///
/// Rows of equal degree also hold the orders -1, l + 1 and l + 2, so that all three neighbours in
/// the previous row exist.
#[derive(Clone, Debug)]
pub struct HarmonicTriangle<N> {
    pub(crate) degree: usize,
    pub(crate) re: Vec<N>,
    pub(crate) im: Vec<N>,
}

impl<N: HarmonicNumber> HarmonicTriangle<N> {
    /// Coefficients up to `degree`, all of them `zero`.
    #[inline(always)]
    pub fn new(degree: usize, zero: N) -> HarmonicTriangle<N> {
        let count = row_start(degree + 1);
        HarmonicTriangle { degree, re: vec![zero; count], im: vec![zero; count] }
    }

    /// Indices of a row.
    pub(crate) fn row(&self, l: usize) -> std::ops::Range<usize> {
        row_start(l)..row_start(l + 1)
    }

    /// Real and imaginary part of a coefficient.
    #[inline(always)]
    pub(crate) fn at(&self, l: usize, m: usize) -> [N; 2] {
        let index = triangle_index(l, m);
        [self.re[index], self.im[index]]
    }

    /// Sets the real and imaginary part of a coefficient.
    #[inline(always)]
    pub(crate) fn set(&mut self, l: usize, m: usize, [re, im]: [N; 2]) {
        let index = triangle_index(l, m);
        (self.re[index], self.im[index]) = (re, im);
    }

    /// Sets the coefficient of order -1 from the coefficient of order 1.
    #[inline(always)]
    pub(crate) fn complete_row(&mut self, l: usize) {
        let [re, im] = self.at(l, 1);
        let start = row_start(l);
        (self.re[start], self.im[start]) = (re * -1.0, im);
    }

    /// Sets the coefficients of order -1 in all rows.
    pub(crate) fn complete(&mut self) {
        (0..=self.degree).for_each(|l| self.complete_row(l));
    }

    /// Sets the regular harmonics R_lm at a point (Eq. P21), for all degrees.
    #[inline(always)]
    pub fn set_harmonics(&mut self, [x, y, z]: [N; 3], zero: N, one: N) {
        let square = x * x + y * y + z * z;
        self.set(0, 0, [one, zero]);
        self.complete_row(0);
        for l in 1..=self.degree {
            // (l + m)(l - m) R_l = (2l - 1) z R_(l-1) - r^2 R_(l-2)
            for m in 0..l {
                let over = 1.0 / ((l + m) * (l - m)) as f64;
                let along = z * ((2 * l - 1) as f64 * over);
                let [re, im] = self.at(l - 1, m);
                let back = if m + 2 <= l { self.at(l - 2, m) } else { [zero; 2] };
                let back_along = square * over;
                self.set(l, m, [along * re - back_along * back[0], along * im - back_along * back[1]]);
            }
            // R_ll = (x + i y) R_(l-1)(l-1) / 2l
            let ([re, im], over) = (self.at(l - 1, l - 1), 0.5 / l as f64);
            self.set(l, l, [(x * re - y * im) * over, (x * im + y * re) * over]);
            self.complete_row(l);
        }
    }

    /// Coefficient (l, m) of the derivative, from the coefficients of degree l - 1 (Eq. P22).
    #[inline(always)]
    pub fn derivative(&self, vector: DerivativeVector<N>, l: usize, m: usize) -> [N; 2] {
        let index = triangle_index(l - 1, m);
        let (re, im) = (&self.re[index - 1..index + 2], &self.im[index - 1..index + 2]);
        match vector {
            DerivativeVector::X(x) => [x * (re[0] - re[2]) * 0.5, x * (im[0] - im[2]) * 0.5],
            DerivativeVector::Y(y) => [y * (im[0] + im[2]) * -0.5, y * (re[0] + re[2]) * 0.5],
            DerivativeVector::Z(z) => [z * re[1], z * im[1]],
            DerivativeVector::Any([x, y, z]) => [
                z * re[1] + (x * (re[0] - re[2]) - y * (im[0] + im[2])) * 0.5,
                z * im[1] + (x * (im[0] - im[2]) + y * (re[0] + re[2])) * 0.5,
            ],
        }
    }

    /// Sets the coefficients to the derivative of `other`, from degree 1 up to `degree`.
    #[inline(always)]
    pub(crate) fn set_derivative(&mut self, other: &HarmonicTriangle<N>, vector: DerivativeVector<N>, degree: usize) {
        for l in 1..=degree {
            for m in 0..=l {
                let value = other.derivative(vector, l, m);
                self.set(l, m, value);
            }
            self.complete_row(l);
        }
    }

    /// Sets the coefficients to `before` plus `factor` times their own derivative, up to `degree`.
    #[inline(always)]
    pub(crate) fn add_derivative(
        &mut self,
        before: &HarmonicTriangle<N>,
        vector: DerivativeVector<N>,
        factor: f64,
        degree: usize,
    ) {
        // Each row is computed before the previous row changes.
        for l in (1..=degree).rev() {
            for m in 0..=l {
                let ([re, im], [own_re, own_im]) = (self.derivative(vector, l, m), before.at(l, m));
                self.set(l, m, [own_re + re * factor, own_im + im * factor]);
            }
            self.complete_row(l);
        }
    }

    /// Sets the coefficients to the mean of `before` over a bar from `-half` to `half`, except
    /// degree 0.
    ///
    /// The mean is the sum of (half . grad)^2k / (2k + 1)! applied to `before`. The sum is exact
    /// because derivatives beyond the degree vanish. `derived` holds intermediate results.
    #[inline(always)]
    pub(crate) fn set_mean_over_bar(
        &mut self,
        before: &HarmonicTriangle<N>,
        derived: &mut HarmonicTriangle<N>,
        half: DerivativeVector<N>,
    ) {
        for k in (1..=self.degree / 2).rev() {
            let factor = 1.0 / (2 * k * (2 * k + 1)) as f64;
            // Terms still to be differentiated are not needed up to the full degree.
            let degree = self.degree - 2 * (k - 1);
            derived.set_derivative(self, half, degree - 1);
            for l in 2..=degree {
                for m in 0..=l {
                    let ([re, im], [own_re, own_im]) = (derived.derivative(half, l, m), before.at(l, m));
                    self.set(l, m, [own_re + re * factor, own_im + im * factor]);
                }
                self.complete_row(l);
            }
        }
    }
}

impl HarmonicTriangle<f64> {
    /// The regular harmonics R_lm at a point up to `degree` (Eq. P21).
    pub fn regular(at: DVec3, degree: usize) -> HarmonicTriangle<f64> {
        let mut harmonics = HarmonicTriangle::new(degree, 0.0);
        harmonics.set_harmonics(at.to_array(), 0.0, 1.0);
        harmonics
    }

    /// The irregular harmonics I_lm at a point up to `degree` (Eq. P21).
    pub fn irregular(at: DVec3, degree: usize) -> HarmonicTriangle<f64> {
        let mut harmonics = HarmonicTriangle::new(degree, 0.0);
        let over = 1.0 / at.length_squared();
        harmonics.set(0, 0, [over.sqrt(), 0.0]);
        for l in 1..=degree {
            // r^2 I_l = (2l - 1) z I_(l-1) - ((l - 1)^2 - m^2) I_(l-2)
            for m in 0..l {
                let along = at.z * (2 * l - 1) as f64 * over;
                let [re, im] = harmonics.at(l - 1, m);
                let back = if m + 2 <= l { harmonics.at(l - 2, m) } else { [0.0; 2] };
                let back_along = ((l - 1) * (l - 1) - m * m) as f64 * over;
                harmonics.set(l, m, [along * re - back_along * back[0], along * im - back_along * back[1]]);
            }
            // r^2 I_ll = (2l - 1) (x + i y) I_(l-1)(l-1)
            let ([re, im], factor) = (harmonics.at(l - 1, l - 1), (2 * l - 1) as f64 * over);
            harmonics.set(l, l, [(at.x * re - at.y * im) * factor, (at.x * im + at.y * re) * factor]);
        }
        harmonics
    }

    /// Real and imaginary part of a harmonic's coefficient of any order; zero beyond the degree.
    pub(crate) fn at_order(&self, l: usize, m: isize) -> [f64; 2] {
        let order = m.unsigned_abs();
        if order > l {
            return [0.0; 2];
        }
        let [re, im] = self.at(l, order);
        match (m < 0, order.is_multiple_of(2)) {
            (false, _) => [re, im],
            (true, true) => [re, -im],
            (true, false) => [-re, im],
        }
    }

    /// Adds one lane of each coefficient.
    #[inline(always)]
    pub(crate) fn add_lane<S: Simd>(&mut self, lanes: &HarmonicTriangle<Lanes<S>>, lane: usize) {
        let parts = self.re.iter_mut().zip(&lanes.re).chain(self.im.iter_mut().zip(&lanes.im));
        parts.for_each(|(own, lanes)| *own += lanes.lane(lane));
    }
}

impl<S: Simd> HarmonicTriangle<Lanes<S>> {
    /// Sets the coefficients from one triangle for each lane.
    #[inline(always)]
    pub(crate) fn set_lanes(&mut self, simd: S, triangles: &[&HarmonicTriangle<f64>]) {
        let mut values = [[0.0; LONGEST_VECTOR]; 2];
        for index in 0..self.re.len() {
            for (lane, triangle) in triangles.iter().enumerate() {
                (values[0][lane], values[1][lane]) = (triangle.re[index], triangle.im[index]);
            }
            self.re[index] = Lanes::<S>::load(simd, &values[0][..Lanes::<S>::LEN]);
            self.im[index] = Lanes::<S>::load(simd, &values[1][..Lanes::<S>::LEN]);
        }
    }
}

/// Index of the first coefficient of a degree, which has order -1.
#[inline(always)]
pub fn row_start(l: usize) -> usize {
    l * (l + 7) / 2
}

/// Index of degree l and order m >= 0.
#[inline(always)]
pub fn triangle_index(l: usize, m: usize) -> usize {
    row_start(l) + 1 + m
}
