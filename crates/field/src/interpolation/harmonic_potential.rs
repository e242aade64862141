//! The field in a small box without tiles as the gradient of one harmonic potential
//! (docs/physics.md, section 5.1).
//!
//! One potential has no divergence and no curl. Three separate components would need three times as
//! many free coefficients and more terms each.

use fearless_simd::prelude::*;
use glam::{DMat3, DVec3};

use magsplice_expansion::triangle::{DerivativeVector, HarmonicTriangle};
use magsplice_simd::lanes::{LONGEST_VECTOR, Lanes, Number};

use crate::tolerances::CELL_DEGREE;

/// Number of pairs of degree l and order m, 0 <= m <= l <= [`CELL_DEGREE`].
const PAIRS: usize = (CELL_DEGREE + 1) * (CELL_DEGREE + 2) / 2;
/// Number of coefficients of a pair: the real and the imaginary part for each component.
const PARTS_PER_PAIR: usize = 6;
/// Number of coefficients of a cell (a_ilm and b_ilm of Eq. P31): pair after pair, by order, with
/// padding so that the longest vector can be loaded from the last pair on.
pub(super) const CELL_COEFFICIENTS: usize =
    (PARTS_PER_PAIR * PAIRS + LONGEST_VECTOR - PARTS_PER_PAIR).next_multiple_of(LONGEST_VECTOR);

/// Vector operations of a look-up for one vector of points.
///
/// Each pair but the first of an order has six sums, or three if the order is 0, and three
/// operations of the recurrence. Each order has about twelve more.
pub(crate) const LOOK_UP_COST: usize = 9 * (PAIRS - CELL_DEGREE - 1) - 3 * CELL_DEGREE + 12 * (CELL_DEGREE + 1);

/// Factors of the recurrence (Eq. P31) from a degree to the next, pair after pair: 2 l + 1 and
/// l^2 - m^2.
const RECURRENCE: [[f64; 2]; PAIRS] = {
    let mut factors = [[0.0; 2]; PAIRS];
    let (mut pair, mut order) = (0, 0);
    while order <= CELL_DEGREE {
        let mut degree = order;
        while degree <= CELL_DEGREE {
            factors[pair] = [(2 * degree + 1) as f64, (degree * degree - order * order) as f64];
            pair += 1;
            degree += 1;
        }
        order += 1;
    }
    factors
};

/// Leading coefficients, pair after pair: R_lm over (x + i y)^m and the polynomial of the
/// recurrence.
const LEADING: [f64; PAIRS] = {
    let mut factors = [1.0; PAIRS];
    let (mut pair, mut order, mut first) = (0, 0, 1.0);
    while order <= CELL_DEGREE {
        let mut degree = order;
        while degree <= CELL_DEGREE {
            factors[pair] = if degree == order { first } else { factors[pair - 1] / RECURRENCE[pair][1] };
            pair += 1;
            degree += 1;
        }
        order += 1;
        first *= 0.5 / order as f64;
    }
    factors
};

/// A real harmonic potential: the real or the imaginary part of R_lm.
#[derive(Clone, Copy, Debug)]
pub(super) struct HarmonicPotential {
    degree: usize,
    order: usize,
    imaginary: bool,
}

impl HarmonicPotential {
    /// All potentials whose field has at most degree [`CELL_DEGREE`].
    pub(super) fn all() -> impl Iterator<Item = HarmonicPotential> {
        let orders = (1..=CELL_DEGREE + 1).flat_map(|degree| (0..=degree).map(move |order| (degree, order)));
        orders.flat_map(|(degree, order)| {
            let parts = [false, true].into_iter().take(if order == 0 { 1 } else { 2 });
            parts.map(move |imaginary| HarmonicPotential { degree, order, imaginary })
        })
    }

    /// Whether the potential is odd in x, y and z.
    pub(super) fn odd(&self) -> [bool; 3] {
        [(self.order + usize::from(self.imaginary)) % 2 == 1, self.imaginary, (self.degree - self.order) % 2 == 1]
    }

    /// The gradient at a point with these harmonics (Eq. P22).
    pub(super) fn gradient(&self, harmonics: &HarmonicTriangle<f64>) -> DVec3 {
        let along = |along| harmonics.derivative(along, self.degree, self.order)[usize::from(self.imaginary)];
        DVec3::new(along(DerivativeVector::X(1.0)), along(DerivativeVector::Y(1.0)), along(DerivativeVector::Z(1.0)))
    }

    /// The gradient in terms of a cell's coefficients: index and factor of each (Eq. P22).
    pub(super) fn gradient_terms(&self) -> Vec<(usize, f64)> {
        let HarmonicPotential { degree, order, imaginary } = *self;
        let l = degree - 1;
        let part = |component: usize, order: usize, imaginary: bool, factor: f64| {
            (order <= l && !(imaginary && order == 0)).then(|| {
                let pair = pair(l, order);
                (PARTS_PER_PAIR * pair + 2 * component + usize::from(imaginary), factor * LEADING[pair])
            })
        };
        let own = part(2, order, imaginary, 1.0);
        let others = if order == 0 {
            [part(0, 1, false, -1.0), part(1, 1, true, -1.0), None, None]
        } else {
            let sign = if imaginary { 0.5 } else { -0.5 };
            [
                part(0, order - 1, imaginary, 0.5),
                part(0, order + 1, imaginary, -0.5),
                part(1, order - 1, !imaginary, sign),
                part(1, order + 1, !imaginary, sign),
            ]
        };
        others.into_iter().chain([own]).flatten().collect()
    }
}

/// Index of a pair of degree and order.
fn pair(l: usize, m: usize) -> usize {
    m * (CELL_DEGREE + 1) - m * m.saturating_sub(1) / 2 + l - m
}

/// The regular harmonics at a point, up to a degree.
pub(super) fn harmonics(degree: usize, point: DVec3) -> HarmonicTriangle<f64> {
    let mut harmonics = HarmonicTriangle::new(degree, 0.0);
    harmonics.set_harmonics(point.to_array(), 0.0, 1.0);
    harmonics
}

/// The field of a cell at two vectors of points, relative to its centre and scaled. Each
/// coefficient is loaded once for both.
#[inline(always)]
pub(super) fn fields<S: Simd>(simd: S, coefficients: &[f64], points: [[Lanes<S>; 3]; 2]) -> [[Lanes<S>; 3]; 2] {
    let zero = Lanes::<S>::splat(simd, 0.0);
    let mut steps = [[[zero; 2]; 2]; CELL_DEGREE];
    let mut squares = [zero; 2];
    for at in 0..2 {
        let [x, y, z] = points[at];
        let square = z.mul_add(z, y.mul_add(y, x * x));
        squares[at] = square;
        for (degree, step) in (0..).zip(&mut steps) {
            let degree = f64::from(degree);
            step[at] = [z * (2.0 * degree + 1.0), square * (degree * degree)];
        }
    }
    let (first, mut rest) = coefficients.split_at(PARTS_PER_PAIR * (CELL_DEGREE + 1));
    // Coefficients of order 0 are real.
    let mut field = row_sums::<S, { PARTS_PER_PAIR / 2 }>(simd, 0, first, squares, &steps);
    let mut phase = points.map(|[x, y, _]| [x, y]);
    for order in 1..=CELL_DEGREE {
        let own;
        (own, rest) = rest.split_at(PARTS_PER_PAIR * (CELL_DEGREE + 1 - order));
        let sums = row_sums::<S, PARTS_PER_PAIR>(simd, order, own, squares, &steps);
        for at in 0..2 {
            let [re, im] = phase[at];
            for (component, field) in field[at].iter_mut().enumerate() {
                let [own_re, own_im] = [sums[at][2 * component], sums[at][2 * component + 1]];
                *field = own_im.mul_add(im, own_re.mul_add(re, *field));
            }
            let [x, y, _] = points[at];
            phase[at] = [re.mul_sub(x, im * y), re.mul_add(y, im * x)];
        }
    }
    field
}

/// Sums over degrees of coefficient times polynomial, for all parts or for every second one.
///
/// `steps` are (2 l + 1) z and l^2 r^2 for each degree l from 0 on.
#[inline(always)]
fn row_sums<S: Simd, const WANTED: usize>(
    simd: S,
    order: usize,
    coefficients: &[f64],
    squares: [Lanes<S>; 2],
    steps: &[[[Lanes<S>; 2]; 2]; CELL_DEGREE],
) -> [[Lanes<S>; WANTED]; 2] {
    let every = PARTS_PER_PAIR / WANTED;
    let mut coefficients = coefficients.chunks_exact(PARTS_PER_PAIR);
    let mut sums = [[Lanes::splat(simd, 0.0); WANTED]; 2];
    // The first polynomial is 1, the second (2 l + 1) z.
    if let Some(coefficients) = coefficients.next() {
        for (part, coefficient) in coefficients.iter().step_by(every).enumerate() {
            let sum = Lanes::splat(simd, *coefficient);
            (sums[0][part], sums[1][part]) = (sum, sum);
        }
    }
    let mut last = [Lanes::splat(simd, 1.0); 2];
    let mut polynomial = steps[order.min(CELL_DEGREE - 1)].map(|[along, _]| along);
    let order_squared = (order * order) as f64;
    let below = [squares[0] * order_squared, squares[1] * order_squared];
    let mut steps = steps.iter().skip(order + 1);
    for coefficients in coefficients {
        for at in 0..2 {
            for (sum, coefficient) in sums[at].iter_mut().zip(coefficients.iter().step_by(every)) {
                *sum = polynomial[at].scale_add(*coefficient, *sum);
            }
        }
        let Some(step) = steps.next() else { break };
        for at in 0..2 {
            let [along, square] = step[at];
            let back = (square - below[at]) * last[at];
            (last[at], polynomial[at]) = (polynomial[at], along.mul_sub(polynomial[at], back));
        }
    }
    sums
}

/// The field of a cell at one point, relative to its centre and scaled. The parts of a pair are
/// lanes.
#[inline(always)]
pub(super) fn field<S: Simd>(simd: S, coefficients: &[f64], point: DVec3) -> DVec3 {
    let length = Lanes::<S>::LEN;
    let load = |values: &[f64; LONGEST_VECTOR]| Lanes::<S>::load(simd, &values[..length]);
    // Powers of x + i y, with alternating real and imaginary parts; in the second vector imaginary
    // parts come first.
    let mut phases = [load(&[1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0]), load(&[0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0])];
    let [x, y] = [point.x, point.y];
    let turns = [load(&[-y, y, -y, y, -y, y, -y, y]), load(&[y, -y, y, -y, y, -y, y, -y])];
    let square = point.length_squared();
    // Largest number of vectors that hold all parts.
    const MAX_VECTORS: usize = LONGEST_VECTOR / 2;
    let count = PARTS_PER_PAIR.div_ceil(length);
    let mut totals = [Lanes::<S>::splat(simd, 0.0); MAX_VECTORS];
    let mut pair = 0;
    for order in 0..=CELL_DEGREE {
        let (mut last, mut polynomial) = (0.0, 1.0);
        let mut sums = [Lanes::<S>::splat(simd, 0.0); MAX_VECTORS];
        for _ in order..=CELL_DEGREE {
            let coefficients = &coefficients[PARTS_PER_PAIR * pair..PARTS_PER_PAIR * pair + LONGEST_VECTOR];
            for (sum, coefficients) in sums[..count].iter_mut().zip(coefficients.chunks_exact(length)) {
                *sum = Lanes::<S>::load(simd, coefficients).scale_add(polynomial, *sum);
            }
            let [along, back] = RECURRENCE[pair];
            let next = polynomial * (along * point.z) - square * back * last;
            (last, polynomial) = (polynomial, next);
            pair += 1;
        }
        for (total, sum) in totals[..count].iter_mut().zip(sums) {
            *total = sum.mul_add(phases[0], *total);
        }
        let [own, other] = phases;
        phases = [own.scale_add(x, other * turns[0]), other.scale_add(x, own * turns[1])];
    }
    let mut parts = [0.0; LONGEST_VECTOR];
    for (total, parts) in totals[..count].iter().zip(parts.chunks_exact_mut(length)) {
        total.store(parts);
    }
    DVec3::new(parts[0] + parts[1], parts[2] + parts[3], parts[4] + parts[5])
}

/// The gradient of the field of a cell, in tesla per scaled unit of length. Column j is the
/// derivative along axis j.
pub(super) fn gradient(coefficients: &[f64], point: DVec3) -> DMat3 {
    let harmonics = harmonics(CELL_DEGREE, point);
    let axes = [DerivativeVector::X(1.0), DerivativeVector::Y(1.0), DerivativeVector::Z(1.0)];
    let mut columns = [DVec3::ZERO; 3];
    for l in 1..=CELL_DEGREE {
        for m in 0..=l {
            let pair = pair(l, m);
            let (coefficients, over) = (&coefficients[PARTS_PER_PAIR * pair..][..PARTS_PER_PAIR], 1.0 / LEADING[pair]);
            let [re, im] = [0, 1]
                .map(|part| DVec3::new(coefficients[part], coefficients[2 + part], coefficients[4 + part]) * over);
            for (column, axis) in columns.iter_mut().zip(axes) {
                let derivative = harmonics.derivative(axis, l, m);
                *column += re * derivative[0] + im * derivative[1];
            }
        }
    }
    DMat3::from_cols_array_2d(&columns.map(|c| c.to_array()))
}
