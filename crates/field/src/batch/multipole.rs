//! A tile far away: the multipole series of a cuboid, in the lanes of a vector (docs/physics.md, section 2.7).

use std::f64::consts::PI;
use std::sync::LazyLock;

use fearless_simd::prelude::*;

use super::lanes::{Lanes, Number};
use crate::block::Block;
use crate::tolerances::HIGHEST_ORDER;
use crate::two_sum::TwoSum;

/// The series of five elements of one shape's tensor, xx, yy, xy, xz, yz, divided by V / 4 pi r^3 and by the factor xy/r^2, xz/r^2, yz/r^2
/// if off the diagonal. A polynomial in sigma = (half diagonal / r)^2, whose coefficients are polynomials in u = x^2/r^2 and v = y^2/r^2.
#[derive(Clone, Debug)]
pub(super) struct Series {
    /// Order by order, of the monomials of degree up to the order: of all five elements.
    low: [[f64; 5]; low_start(HIGHEST_ORDER + 1)],
    /// Of the monomials of the next degree: of the two diagonal ones.
    high: [[f64; 2]; high_start(HIGHEST_ORDER + 1)],
}

/// Where the coefficients of an order begin.
const fn low_start(order: usize) -> usize {
    order * (order + 1) * (order + 2) / 6
}

/// See [`low_start`].
const fn high_start(order: usize) -> usize {
    order * (order + 3) / 2
}

/// Derivatives beyond the moments' own, along x, y, z.
const ELEMENTS: [[usize; 3]; 5] = [[2, 0, 0], [0, 2, 0], [1, 1, 0], [1, 0, 1], [0, 1, 1]];

/// One unit of sigma to this order has polynomials of this degree in u and v.
const fn degree(element: usize, order: usize) -> usize {
    if element < 2 { order + 1 } else { order }
}

/// Monomials u^a v^b of degree at most `degree`, ordered by degree.
const fn monomial_count(degree: usize) -> usize {
    (degree + 1) * (degree + 2) / 2
}

const MOST_MONOMIALS: usize = monomial_count(HIGHEST_ORDER + 1);

impl Series {
    /// For a cuboid of these side lengths.
    pub(super) fn of(size: [f64; 3]) -> Series {
        let largest = size.iter().copied().fold(0.0, f64::max);
        let squares = size.map(|s| (s / largest) * (s / largest));
        let total: f64 = squares.iter().sum();
        let share = squares.map(|s| s / total);
        let mut series =
            Series { low: [[0.0; 5]; low_start(HIGHEST_ORDER + 1)], high: [[0.0; 2]; high_start(HIGHEST_ORDER + 1)] };
        for (order, moments) in MOMENTS.iter().enumerate() {
            let count = monomial_count(order);
            for moment in moments {
                // The moment of a cuboid, by derivatives: half side^(2a) / (2a + 1)!
                let weight: f64 = (0..3).map(|axis| share[axis].powi(moment.powers[axis] as i32)).product();
                for (element, polynomial) in moment.polynomials.iter().enumerate() {
                    for (monomial, c) in polynomial.iter().enumerate() {
                        match monomial.checked_sub(count) {
                            None => series.low[low_start(order) + monomial][element] += weight * c,
                            Some(next) => series.high[high_start(order) + next][element] += weight * c,
                        }
                    }
                }
            }
        }
        series
    }
}

/// One moment <x^2a y^2b z^2c> and the polynomials of the derivatives of 1/r it comes with.
struct Moment {
    powers: [usize; 3],
    polynomials: [Vec<f64>; 5],
}

/// By order a + b + c.
static MOMENTS: LazyLock<Vec<Vec<Moment>>> = LazyLock::new(|| {
    (0..=HIGHEST_ORDER)
        .map(|order| {
            let pairs = (0..=order).flat_map(|a| (0..=order - a).map(move |b| [a, b, order - a - b]));
            pairs.map(Moment::of).collect()
        })
        .collect()
});

impl Moment {
    fn of(powers: [usize; 3]) -> Moment {
        let over: f64 = powers.iter().map(|&a| factorial(2 * a + 1)).product();
        let polynomials = [0, 1, 2, 3, 4].map(|element: usize| {
            let derivative = [0, 1, 2].map(|axis| 2 * powers[axis] + ELEMENTS[element][axis]);
            let order = powers.iter().sum();
            let polynomial = derivative_of_reciprocal_distance(derivative, degree(element, order));
            polynomial.into_iter().map(|c| c / over).collect()
        });
        Moment { powers, polynomials }
    }
}

/// r^(n+1) times the derivative of 1/r of n-th order, without odd powers, as a polynomial in u and v, w = 1 - u - v:
/// with D = (x^2 + y^2 + z^2)^(-1/2) each axis gives a sum over j of (alpha! / j! (alpha - 2j)!) (2x)^(alpha - 2j) D^(alpha - j).
fn derivative_of_reciprocal_distance(derivative: [usize; 3], degree: usize) -> Vec<f64> {
    let order: usize = derivative.iter().sum();
    let mut sum = vec![0.0; monomial_count(degree)];
    let [x, y, z] = derivative;
    for i in 0..=x / 2 {
        for j in 0..=y / 2 {
            for k in 0..=z / 2 {
                let left = i + j + k;
                let choices: f64 = [(x, i), (y, j), (z, k)]
                    .iter()
                    .map(|&(alpha, j)| factorial(alpha) / (factorial(j) * factorial(alpha - 2 * j)))
                    .product();
                let rank = order - left;
                let odd: f64 = (1..=rank).map(|m| (2 * m - 1) as f64).product();
                let sign = if rank.is_multiple_of(2) { 1.0 } else { -1.0 };
                let c = sign * choices * odd * 0.5f64.powi(left as i32);
                // u^a v^b (1 - u - v)^p
                let [a, b, p] = [(x - 2 * i) / 2, (y - 2 * j) / 2, (z - 2 * k) / 2];
                for m in 0..=p {
                    for n in 0..=p - m {
                        let sign = if (m + n).is_multiple_of(2) { 1.0 } else { -1.0 };
                        let ways = factorial(p) / (factorial(m) * factorial(n) * factorial(p - m - n));
                        sum[monomial_index(a + m, b + n)] += c * sign * ways;
                    }
                }
            }
        }
    }
    sum
}

/// Position of u^a v^b.
const fn monomial_index(a: usize, b: usize) -> usize {
    let degree = a + b;
    degree * (degree + 1) / 2 + b
}

fn factorial(n: usize) -> f64 {
    (1..=n).map(|k| k as f64).product()
}

/// A tile for points far away.
#[derive(Clone, Copy, Debug)]
pub(super) struct Distant {
    centre: [TwoSum; 3],
    scale: f64,
    /// Scaled, as the offsets are.
    half_diagonal_squared: f64,
    /// V J / 4 pi, scaled.
    moment: [f64; 3],
}

impl Distant {
    pub(super) fn of(block: &Block, scale: f64) -> Distant {
        let size = block.size.map(|s| s * scale);
        let volume_over_4pi = size[0] * size[1] * size[2] / (4.0 * PI);
        let centre = block.faces.map(|[low, high]| {
            let sum = TwoSum::of(0.5 * low.hi, 0.5 * high.hi);
            TwoSum { hi: sum.hi, lo: sum.lo + (0.5 * low.lo + 0.5 * high.lo) }
        });
        Distant {
            centre,
            scale,
            half_diagonal_squared: 0.25 * size.iter().map(|s| s * s).sum::<f64>(),
            moment: block.polarization_t.to_array().map(|j| j * volume_over_4pi),
        }
    }
}

/// mu0 H of the tile, in its frame, from its series to the given order in sigma, at two vectors of points: each coefficient is fetched once for
/// both.
#[inline(always)]
pub(super) fn fields<S: Simd>(
    simd: S,
    tile: &Distant,
    series: &Series,
    order: usize,
    points: [[Lanes<S>; 3]; 2],
) -> [[Lanes<S>; 3]; 2] {
    let (first, second) = (Place::of(simd, tile, points[0]), Place::of(simd, tile, points[1]));
    let (u, v) = ([first.u, second.u], [first.v, second.v]);
    let sigma = [first.sigma, second.sigma];
    let (zero, one) = (Lanes::<S>::splat(simd, 0.0), Lanes::<S>::splat(simd, 1.0));
    let mut sums = Sums { monomials: [[one; 2]; MOST_MONOMIALS], elements: [[zero; 2]; 5] };
    sums.extend::<1>(u, v);
    sums.extend::<2>(u, v);
    sums.extend::<3>(u, v);
    sums.extend::<4>(u, v);
    if order >= 4 {
        sums.extend::<5>(u, v);
        if order >= 5 {
            sums.extend::<6>(u, v);
            if order >= 6 {
                sums.extend::<7>(u, v);
                sums.add::<6>(simd, series, sigma);
            }
            sums.add::<5>(simd, series, sigma);
        }
        sums.add::<4>(simd, series, sigma);
    }
    sums.add::<3>(simd, series, sigma);
    sums.add::<2>(simd, series, sigma);
    sums.add::<1>(simd, series, sigma);
    sums.add::<0>(simd, series, sigma);
    let [xx, yy, xy, xz, yz] = sums.elements;
    [
        first.field([xx[0], yy[0], xy[0], xz[0], yz[0]], tile.moment),
        second.field([xx[1], yy[1], xy[1], xz[1], yz[1]], tile.moment),
    ]
}

/// Where points lie relative to a tile.
struct Place<S: Simd> {
    offset: [Lanes<S>; 3],
    inverse_square: Lanes<S>,
    u: Lanes<S>,
    v: Lanes<S>,
    sigma: Lanes<S>,
}

impl<S: Simd> Place<S> {
    #[inline(always)]
    fn of(simd: S, tile: &Distant, mut point: [Lanes<S>; 3]) -> Place<S> {
        for (coordinate, centre) in point.iter_mut().zip(&tile.centre) {
            *coordinate = ((*coordinate - centre.hi) - centre.lo) * tile.scale;
        }
        let [x, y, z] = point;
        let (x2, y2) = (x * x, y * y);
        let inverse_square = Lanes::<S>::splat(simd, 1.0).over(z.mul_add(z, x2 + y2));
        Place {
            offset: point,
            inverse_square,
            u: x2 * inverse_square,
            v: y2 * inverse_square,
            sigma: inverse_square * tile.half_diagonal_squared,
        }
    }

    #[inline(always)]
    fn field(&self, [xx, yy, xy, xz, yz]: [Lanes<S>; 5], [jx, jy, jz]: [f64; 3]) -> [Lanes<S>; 3] {
        let [x, y, z] = self.offset;
        let (x_over, y_over) = (x * self.inverse_square, y * self.inverse_square);
        let (xy, xz, yz) = (xy * (x_over * y), xz * (x_over * z), yz * (y_over * z));
        let cube = self.inverse_square * self.inverse_square.sqrt();
        [
            xx.scale_add(jx, xy.scale_add(jy, xz * jz)) * cube,
            xy.scale_add(jx, yy.scale_add(jy, yz * jz)) * cube,
            xz.scale_add(jx, yz.scale_add(jy, (xx + yy) * -jz)) * cube,
        ]
    }
}

/// Every loop has a fixed number of turns, so that none is left in the program.
struct Sums<S: Simd> {
    monomials: [[Lanes<S>; 2]; MOST_MONOMIALS],
    elements: [[Lanes<S>; 2]; 5],
}

impl<S: Simd> Sums<S> {
    /// The monomials of one more degree.
    #[inline(always)]
    fn extend<const DEGREE: usize>(&mut self, u: [Lanes<S>; 2], v: [Lanes<S>; 2]) {
        let (start, before) = (monomial_index(DEGREE, 0), monomial_index(DEGREE - 1, 0));
        for b in 0..DEGREE {
            let [first, second] = self.monomials[before + b];
            self.monomials[start + b] = [first * u[0], second * u[1]];
        }
        let [first, second] = self.monomials[before + DEGREE - 1];
        self.monomials[start + DEGREE] = [first * v[0], second * v[1]];
    }

    /// sigma times the sums so far, and one order's polynomials.
    #[inline(always)]
    fn add<const ORDER: usize>(&mut self, simd: S, series: &Series, sigma: [Lanes<S>; 2]) {
        let mut polynomials = [[Lanes::<S>::splat(simd, 0.0); 2]; 5];
        for monomial in 0..monomial_count(ORDER) {
            let coefficients = &series.low[low_start(ORDER) + monomial];
            let [first, second] = self.monomials[monomial];
            for (polynomial, coefficient) in polynomials.iter_mut().zip(coefficients) {
                let coefficient = Lanes::<S>::splat(simd, *coefficient);
                *polynomial = [first.mul_add(coefficient, polynomial[0]), second.mul_add(coefficient, polynomial[1])];
            }
        }
        for next in 0..ORDER + 2 {
            let coefficients = &series.high[high_start(ORDER) + next];
            let [first, second] = self.monomials[monomial_count(ORDER) + next];
            for (polynomial, coefficient) in polynomials.iter_mut().zip(coefficients) {
                let coefficient = Lanes::<S>::splat(simd, *coefficient);
                *polynomial = [first.mul_add(coefficient, polynomial[0]), second.mul_add(coefficient, polynomial[1])];
            }
        }
        for (element, polynomial) in self.elements.iter_mut().zip(polynomials) {
            *element = [element[0].mul_add(sigma[0], polynomial[0]), element[1].mul_add(sigma[1], polynomial[1])];
        }
    }
}
