//! A tile far away: the multipole series of a cuboid, in the lanes of a vector (docs/physics.md, section 2.7).

use std::f64::consts::PI;
use std::sync::LazyLock;

use fearless_simd::prelude::*;

use super::lanes::Lanes;
use crate::block::Block;
use crate::tolerances::HIGHEST_ORDER;
use crate::two_sum::TwoSum;

/// The series of five elements of one shape's tensor, xx, yy, xy, xz, yz, divided by V / 4 pi r^3 and by the factor xy/r^2, xz/r^2, yz/r^2
/// if off the diagonal. A polynomial in sigma = (half diagonal / r)^2, whose coefficients are polynomials in u = x^2/r^2 and v = y^2/r^2.
#[derive(Clone, Debug)]
pub(super) struct Series {
    /// By order in sigma.
    orders: [Coefficients; HIGHEST_ORDER + 1],
}

#[derive(Clone, Debug, Default)]
struct Coefficients {
    /// Of the monomials of degree up to the order: of all five elements.
    low: Vec<[f64; 5]>,
    /// Of the monomials of the next degree: of the two diagonal ones.
    high: Vec<[f64; 2]>,
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
        let mut orders = [const { Coefficients { low: Vec::new(), high: Vec::new() } }; HIGHEST_ORDER + 1];
        for (order, coefficients) in orders.iter_mut().enumerate() {
            let low = monomial_count(order);
            coefficients.low.resize(low, [0.0; 5]);
            coefficients.high.resize(monomial_count(order + 1) - low, [0.0; 2]);
            for moment in &MOMENTS[order] {
                // The moment of a cuboid, by derivatives: half side^(2a) / (2a + 1)!
                let weight: f64 = (0..3).map(|axis| share[axis].powi(moment.powers[axis] as i32)).product();
                for (element, polynomial) in moment.polynomials.iter().enumerate() {
                    for (monomial, c) in polynomial.iter().enumerate() {
                        match monomial.checked_sub(low) {
                            None => coefficients.low[monomial][element] += weight * c,
                            Some(high) => coefficients.high[high][element] += weight * c,
                        }
                    }
                }
            }
        }
        Series { orders }
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

/// mu0 H of the tile, in its frame, from its series to the given order in sigma.
#[inline(always)]
pub(super) fn field<S: Simd>(
    simd: S,
    tile: &Distant,
    series: &Series,
    order: usize,
    mut point: [Lanes<S>; 3],
) -> [Lanes<S>; 3] {
    for (coordinate, centre) in point.iter_mut().zip(&tile.centre) {
        *coordinate = ((*coordinate - centre.hi) - centre.lo) * tile.scale;
    }
    let [x, y, z] = point;
    let zero = Lanes::<S>::splat(simd, 0.0);
    let one = Lanes::<S>::splat(simd, 1.0);
    let inverse_square = one.over(x * x + y * y + z * z);
    let sigma = inverse_square * tile.half_diagonal_squared;
    let (u, v) = (x * x * inverse_square, y * y * inverse_square);
    let mut monomials = [one; MOST_MONOMIALS];
    for degree in 1..=order + 1 {
        let (start, before) = (monomial_index(degree, 0), monomial_index(degree - 1, 0));
        for b in 0..degree {
            monomials[start + b] = monomials[before + b] * u;
        }
        monomials[start + degree] = monomials[before + degree - 1] * v;
    }
    let mut elements = [zero; 5];
    for (order, coefficients) in series.orders[..=order].iter().enumerate().rev() {
        let (low, high) = monomials.split_at(monomial_count(order));
        let [mut xx, mut yy, mut xy, mut xz, mut yz] = [zero; 5];
        for (c, monomial) in coefficients.low.iter().zip(low) {
            xx = monomial.scale_add(c[0], xx);
            yy = monomial.scale_add(c[1], yy);
            xy = monomial.scale_add(c[2], xy);
            xz = monomial.scale_add(c[3], xz);
            yz = monomial.scale_add(c[4], yz);
        }
        for (c, monomial) in coefficients.high.iter().zip(high) {
            xx = monomial.scale_add(c[0], xx);
            yy = monomial.scale_add(c[1], yy);
        }
        elements = [
            elements[0].mul_add(sigma, xx),
            elements[1].mul_add(sigma, yy),
            elements[2].mul_add(sigma, xy),
            elements[3].mul_add(sigma, xz),
            elements[4].mul_add(sigma, yz),
        ];
    }
    let [xx, yy, xy, xz, yz] = elements;
    let (xy, xz, yz) = (xy * x * y * inverse_square, xz * x * z * inverse_square, yz * y * z * inverse_square);
    let cube = inverse_square * inverse_square.sqrt();
    let [jx, jy, jz] = tile.moment;
    [
        (xx * jx + xy * jy + xz * jz) * cube,
        (xy * jx + yy * jy + yz * jz) * cube,
        (xz * jx + yz * jy - (xx + yy) * jz) * cube,
    ]
}
