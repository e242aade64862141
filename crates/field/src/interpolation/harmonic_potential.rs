//! The field in a small box without tiles as the gradient of one harmonic potential (docs/physics.md, section 5.1): a third of the numbers that three
//! components by themselves would take, fewer terms for each, and neither divergence nor curl.

use fearless_simd::prelude::*;
use glam::{DMat3, DVec3};

use magsplice_expansion::triangle::{DerivativeVector, HarmonicTriangle};
use magsplice_simd::lanes::{LONGEST_VECTOR, Lanes, Number};

use crate::tolerances::CELL_DEGREE;

/// Pairs of degree l and order m, 0 <= m <= l <= [`CELL_DEGREE`].
const PAIRS: usize = (CELL_DEGREE + 1) * (CELL_DEGREE + 2) / 2;
/// For each pair the factors of the real and the imaginary part in each component.
const PARTS: usize = 6;
/// Numbers of a cell: pair after pair, equal orders together, and room for the longest vector from the last pair on.
pub(super) const CELL: usize = (PARTS * PAIRS + LONGEST_VECTOR - PARTS).next_multiple_of(LONGEST_VECTOR);

/// Operations of vectors for a vector of points: for each pair but the first of an order six sums, or three of order 0, and three of the recurrence; and about
/// twelve for each order.
pub(crate) const LOOK_UP_COST: usize = 9 * (PAIRS - CELL_DEGREE - 1) - 3 * CELL_DEGREE + 12 * (CELL_DEGREE + 1);

/// The factors of the recurrence (Eq. P31), pair after pair, from this degree to the next: 2 l + 1 and l^2 - m^2.
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

/// R_lm over the polynomial of the recurrence times (x + i y)^m, pair after pair.
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

/// A real potential: the real or the imaginary part of R_lm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Potential {
    degree: usize,
    order: usize,
    imaginary: bool,
}

impl Potential {
    /// All whose field is no more than of degree [`CELL_DEGREE`].
    pub(super) fn all() -> impl Iterator<Item = Potential> {
        let orders = (1..=CELL_DEGREE + 1).flat_map(|degree| (0..=degree).map(move |order| (degree, order)));
        orders.flat_map(|(degree, order)| {
            let parts = [false, true].into_iter().take(if order == 0 { 1 } else { 2 });
            parts.map(move |imaginary| Potential { degree, order, imaginary })
        })
    }

    /// Whether it is odd in x, y and z.
    pub(super) fn odd(&self) -> [bool; 3] {
        [(self.order + usize::from(self.imaginary)) % 2 == 1, self.imaginary, (self.degree - self.order) % 2 == 1]
    }

    /// Its gradient where the harmonics are these.
    pub(super) fn gradient(&self, harmonics: &HarmonicTriangle<f64>) -> DVec3 {
        let along = |along| harmonics.derivative(along, self.degree, self.order)[usize::from(self.imaginary)];
        DVec3::new(along(DerivativeVector::X(1.0)), along(DerivativeVector::Y(1.0)), along(DerivativeVector::Z(1.0)))
    }

    /// Which of a cell's numbers its gradient is made of, with the factor of each (Eq. P22).
    pub(super) fn parts(&self) -> Vec<(usize, f64)> {
        let Potential { degree, order, imaginary } = *self;
        let l = degree - 1;
        let part = |component: usize, order: usize, imaginary: bool, factor: f64| {
            (order <= l && !(imaginary && order == 0)).then(|| {
                let pair = pair(l, order);
                (PARTS * pair + 2 * component + usize::from(imaginary), factor * LEADING[pair])
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

/// The place of a pair among all.
fn pair(l: usize, m: usize) -> usize {
    m * (CELL_DEGREE + 1) - m * m.saturating_sub(1) / 2 + l - m
}

/// The harmonics at a place up to so many degrees.
pub(super) fn harmonics(degree: usize, place: DVec3) -> HarmonicTriangle<f64> {
    let mut harmonics = HarmonicTriangle::new(degree, 0.0);
    harmonics.set_harmonics(place.to_array(), 0.0, 1.0);
    harmonics
}

/// The field of a cell's numbers at two vectors of places: each number is fetched once for both.
#[inline(always)]
pub(super) fn fields<S: Simd>(simd: S, numbers: &[f64], places: [[Lanes<S>; 3]; 2]) -> [[Lanes<S>; 3]; 2] {
    let zero = Lanes::<S>::splat(simd, 0.0);
    let mut steps = [[[zero; 2]; 2]; CELL_DEGREE];
    let mut squares = [zero; 2];
    for at in 0..2 {
        let [x, y, z] = places[at];
        let square = z.mul_add(z, y.mul_add(y, x * x));
        squares[at] = square;
        for (degree, step) in (0..).zip(&mut steps) {
            let degree = f64::from(degree);
            step[at] = [z * (2.0 * degree + 1.0), square * (degree * degree)];
        }
    }
    let (first, mut rest) = numbers.split_at(PARTS * (CELL_DEGREE + 1));
    // Of order 0 no number has an imaginary part.
    let mut field = row_sums::<S, { PARTS / 2 }>(simd, 0, first, squares, &steps);
    let mut phase = places.map(|[x, y, _]| [x, y]);
    for order in 1..=CELL_DEGREE {
        let own;
        (own, rest) = rest.split_at(PARTS * (CELL_DEGREE + 1 - order));
        let sums = row_sums::<S, PARTS>(simd, order, own, squares, &steps);
        for at in 0..2 {
            let [re, im] = phase[at];
            for (component, field) in field[at].iter_mut().enumerate() {
                let [own_re, own_im] = [sums[at][2 * component], sums[at][2 * component + 1]];
                *field = own_im.mul_add(im, own_re.mul_add(re, *field));
            }
            let [x, y, _] = places[at];
            phase[at] = [re.mul_sub(x, im * y), re.mul_add(y, im * x)];
        }
    }
    field
}

/// For each of the parts, of which all or every other one are wanted, the sum over degrees of its number times the polynomial. `steps` are
/// (2 l + 1) z and l^2 r^2 for each degree l from 0 on.
#[inline(always)]
fn row_sums<S: Simd, const WANTED: usize>(
    simd: S,
    order: usize,
    numbers: &[f64],
    squares: [Lanes<S>; 2],
    steps: &[[[Lanes<S>; 2]; 2]; CELL_DEGREE],
) -> [[Lanes<S>; WANTED]; 2] {
    let every = PARTS / WANTED;
    let mut numbers = numbers.chunks_exact(PARTS);
    let mut sums = [[Lanes::splat(simd, 0.0); WANTED]; 2];
    // The polynomial of the first degree is 1, that of the next its step along z.
    if let Some(numbers) = numbers.next() {
        for (part, number) in numbers.iter().step_by(every).enumerate() {
            let sum = Lanes::splat(simd, *number);
            (sums[0][part], sums[1][part]) = (sum, sum);
        }
    }
    let mut last = [Lanes::splat(simd, 1.0); 2];
    let mut polynomial = steps[order.min(CELL_DEGREE - 1)].map(|[along, _]| along);
    let order_squared = (order * order) as f64;
    let below = [squares[0] * order_squared, squares[1] * order_squared];
    let mut steps = steps.iter().skip(order + 1);
    for numbers in numbers {
        for at in 0..2 {
            for (sum, number) in sums[at].iter_mut().zip(numbers.iter().step_by(every)) {
                *sum = polynomial[at].scale_add(*number, *sum);
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

/// The same at one place: the parts of a pair are the lanes.
#[inline(always)]
pub(super) fn field<S: Simd>(simd: S, numbers: &[f64], place: DVec3) -> DVec3 {
    let length = Lanes::<S>::LEN;
    let load = |values: &[f64; LONGEST_VECTOR]| Lanes::<S>::load(simd, &values[..length]);
    // Real and imaginary parts in turns, and the imaginary ones first.
    let mut phases = [load(&[1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0]), load(&[0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0])];
    let [x, y] = [place.x, place.y];
    let turns = [load(&[-y, y, -y, y, -y, y, -y, y]), load(&[y, -y, y, -y, y, -y, y, -y])];
    let square = place.length_squared();
    // Vectors that hold all parts.
    const MOST: usize = LONGEST_VECTOR / 2;
    let count = PARTS.div_ceil(length);
    let mut totals = [Lanes::<S>::splat(simd, 0.0); MOST];
    let mut pair = 0;
    for order in 0..=CELL_DEGREE {
        let (mut last, mut polynomial) = (0.0, 1.0);
        let mut sums = [Lanes::<S>::splat(simd, 0.0); MOST];
        for _ in order..=CELL_DEGREE {
            let numbers = &numbers[PARTS * pair..PARTS * pair + LONGEST_VECTOR];
            for (sum, numbers) in sums[..count].iter_mut().zip(numbers.chunks_exact(length)) {
                *sum = Lanes::<S>::load(simd, numbers).scale_add(polynomial, *sum);
            }
            let [along, back] = RECURRENCE[pair];
            let next = polynomial * (along * place.z) - square * back * last;
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

/// The gradient of the field of a cell's numbers, in its own unit of length: column j is that along axis j.
pub(super) fn gradient(numbers: &[f64], place: DVec3) -> DMat3 {
    let harmonics = harmonics(CELL_DEGREE, place);
    let axes = [DerivativeVector::X(1.0), DerivativeVector::Y(1.0), DerivativeVector::Z(1.0)];
    let mut columns = [DVec3::ZERO; 3];
    for l in 1..=CELL_DEGREE {
        for m in 0..=l {
            let pair = pair(l, m);
            let (numbers, over) = (&numbers[PARTS * pair..][..PARTS], 1.0 / LEADING[pair]);
            let [re, im] = [0, 1].map(|part| DVec3::new(numbers[part], numbers[2 + part], numbers[4 + part]) * over);
            for (column, axis) in columns.iter_mut().zip(axes) {
                let slope = harmonics.derivative(axis, l, m);
                *column += re * slope[0] + im * slope[1];
            }
        }
    }
    DMat3::from_cols_array_2d(&columns.map(|c| c.to_array()))
}
