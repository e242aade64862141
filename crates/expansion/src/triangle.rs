//! Complex numbers by degree and order, and the recurrences of solid harmonics over them.

use std::ops::{Add, Mul, Sub};

use fearless_simd::prelude::*;
use magsplice_simd::lanes::{LONGEST_VECTOR, Lanes};

/// What harmonics are computed with: a double, or one for each of several tiles.
pub trait Scalar:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Mul<f64, Output = Self>
{
}

impl<T: Copy + Add<Output = T> + Sub<Output = T> + Mul<Output = T> + Mul<f64, Output = T>> Scalar for T {}

/// A vector along which something is derived; those along an axis take less.
#[derive(Clone, Copy)]
pub enum Along<N> {
    X(N),
    Y(N),
    Z(N),
    Any([N; 3]),
}

/// Complex numbers by degree l and order m. Rows have room for the orders -1, l + 1 and l + 2, so that all three neighbours in the row before exist.
#[derive(Clone, Debug)]
pub struct Triangle<N> {
    pub(crate) degree: usize,
    pub(crate) re: Vec<N>,
    pub(crate) im: Vec<N>,
}

impl<N: Scalar> Triangle<N> {
    #[inline(always)]
    pub fn new(degree: usize, zero: N) -> Triangle<N> {
        let count = row_start(degree + 1);
        Triangle { degree, re: vec![zero; count], im: vec![zero; count] }
    }

    #[inline(always)]
    pub(crate) fn place(&self, l: usize, m: usize) -> usize {
        place(l, m)
    }

    pub(crate) fn row(&self, l: usize) -> std::ops::Range<usize> {
        row_start(l)..row_start(l + 1)
    }

    #[inline(always)]
    pub(crate) fn at(&self, l: usize, m: usize) -> [N; 2] {
        let place = self.place(l, m);
        [self.re[place], self.im[place]]
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, l: usize, m: usize, [re, im]: [N; 2]) {
        let place = self.place(l, m);
        (self.re[place], self.im[place]) = (re, im);
    }

    /// The number of order -1 from that of order 1.
    #[inline(always)]
    pub(crate) fn complete_row(&mut self, l: usize) {
        let [re, im] = self.at(l, 1);
        let start = row_start(l);
        (self.re[start], self.im[start]) = (re * -1.0, im);
    }

    pub(crate) fn complete(&mut self) {
        (0..=self.degree).for_each(|l| self.complete_row(l));
    }

    /// The harmonics R at a point.
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

    /// The derivative of the harmonics of the degree before (Eq. P22).
    #[inline(always)]
    pub fn derivative(&self, along: Along<N>, l: usize, m: usize) -> [N; 2] {
        let place = self.place(l - 1, m);
        let (re, im) = (&self.re[place - 1..place + 2], &self.im[place - 1..place + 2]);
        match along {
            Along::X(x) => [x * (re[0] - re[2]) * 0.5, x * (im[0] - im[2]) * 0.5],
            Along::Y(y) => [y * (im[0] + im[2]) * -0.5, y * (re[0] + re[2]) * 0.5],
            Along::Z(z) => [z * re[1], z * im[1]],
            Along::Any([x, y, z]) => [
                z * re[1] + (x * (re[0] - re[2]) - y * (im[0] + im[2])) * 0.5,
                z * im[1] + (x * (im[0] - im[2]) + y * (re[0] + re[2])) * 0.5,
            ],
        }
    }

    /// Becomes the derivative of `other`, up to `degree`; nothing at degree 0.
    #[inline(always)]
    pub(crate) fn set_derivative(&mut self, other: &Triangle<N>, along: Along<N>, degree: usize) {
        for l in 1..=degree {
            for m in 0..=l {
                let value = other.derivative(along, l, m);
                self.set(l, m, value);
            }
            self.complete_row(l);
        }
    }

    /// Becomes `before` plus `factor` times its own derivative, up to `degree`.
    #[inline(always)]
    pub(crate) fn add_derivative(&mut self, before: &Triangle<N>, along: Along<N>, factor: f64, degree: usize) {
        // Each row needs the one before as it was.
        for l in (1..=degree).rev() {
            for m in 0..=l {
                let ([re, im], [own_re, own_im]) = (self.derivative(along, l, m), before.at(l, m));
                self.set(l, m, [own_re + re * factor, own_im + im * factor]);
            }
            self.complete_row(l);
        }
    }

    /// From those of a point, `before`, the mean over a bar that reaches from `-half` to `half`: the sum of (half . grad)^2k / (2k + 1)!. All
    /// terms there are: derivatives beyond the degree vanish. Nothing is known of degree 0.
    #[inline(always)]
    pub(crate) fn spread(&mut self, before: &Triangle<N>, derived: &mut Triangle<N>, half: Along<N>) {
        for k in (1..=self.degree / 2).rev() {
            let factor = 1.0 / (2 * k * (2 * k + 1)) as f64;
            // What is derived k times more need not be known up to the full degree.
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

impl Triangle<f64> {
    /// Adds one lane of others.
    #[inline(always)]
    pub(crate) fn add_lane<S: Simd>(&mut self, lanes: &Triangle<Lanes<S>>, lane: usize) {
        let parts = self.re.iter_mut().zip(&lanes.re).chain(self.im.iter_mut().zip(&lanes.im));
        parts.for_each(|(own, lanes)| *own += lanes.lane(lane));
    }
}

impl<S: Simd> Triangle<Lanes<S>> {
    /// Becomes as many as there are lanes, side by side.
    #[inline(always)]
    pub(crate) fn set_lanes(&mut self, simd: S, triangles: &[&Triangle<f64>]) {
        let mut values = [[0.0; LONGEST_VECTOR]; 2];
        for place in 0..self.re.len() {
            for (lane, triangle) in triangles.iter().enumerate() {
                (values[0][lane], values[1][lane]) = (triangle.re[place], triangle.im[place]);
            }
            self.re[place] = Lanes::<S>::load(simd, &values[0][..Lanes::<S>::LEN]);
            self.im[place] = Lanes::<S>::load(simd, &values[1][..Lanes::<S>::LEN]);
        }
    }
}

/// Where the row of a degree begins.
#[inline(always)]
pub fn row_start(l: usize) -> usize {
    l * (l + 7) / 2
}

/// Where a pair of degree and order is in a triangle.
#[inline(always)]
pub fn place(l: usize, m: usize) -> usize {
    row_start(l) + 1 + m
}
