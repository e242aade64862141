//! A tile far away: the multipole series of a cuboid, in the lanes of a vector (docs/physics.md, section 2.7).

use std::f64::consts::PI;
use std::sync::LazyLock;

use fearless_simd::prelude::*;

use super::lanes::{Horner, Lanes, Number, Singles, Two};
use crate::block::Block;
use crate::tolerances::{FIRST_SINGLE_ORDER, HIGHEST_ORDER};
use crate::two_sum::TwoSum;

/// The series of five elements of one shape's tensor, xx, yy, xy, xz, yz, divided by V / 4 pi r^3 and by the factor xy/r^2, xz/r^2, yz/r^2
/// if off the diagonal. A polynomial in sigma = (half diagonal / r)^2, whose coefficients are polynomials in u = x^2/r^2 and v = y^2/r^2.
#[derive(Clone, Debug)]
pub(super) struct Series {
    /// Order by order, of the monomials of degree up to the order: of all five elements. As [`low_place`] says.
    low: [[f64; 5]; low_start(HIGHEST_ORDER + 1)],
    /// Of the monomials of the next degree, the highest power of v first: of the two diagonal ones.
    high: [[f64; 2]; high_start(HIGHEST_ORDER + 1)],
    /// The same from [`FIRST_SINGLE_ORDER`] on, in single precision and in powers of u - 1/3 and v - 1/3, which cancel far less.
    single_low: [[f32; 5]; low_start(HIGHEST_ORDER + 1) - low_start(FIRST_SINGLE_ORDER)],
    single_high: [[f32; 2]; high_start(HIGHEST_ORDER + 1) - high_start(FIRST_SINGLE_ORDER)],
}

/// About the middle of what u and v may be, where u + v <= 1.
const THIRD: f64 = 1.0 / 3.0;

/// Where the coefficients of an order begin.
const fn low_start(order: usize) -> usize {
    order * (order + 1) * (order + 2) / 6
}

/// See [`low_start`].
const fn high_start(order: usize) -> usize {
    order * (order + 3) / 2
}

/// Where u^a v^b is among the coefficients of an order: as Horner's scheme needs them, row after row of equal b, the highest powers first.
const fn low_place(order: usize, a: usize, b: usize) -> usize {
    let row = order - b;
    low_start(order) + row * (row + 1) / 2 + row - a
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

impl Series {
    /// For a cuboid of these side lengths.
    pub(super) fn of(size: [f64; 3]) -> Series {
        let largest = size.iter().copied().fold(0.0, f64::max);
        let squares = size.map(|s| (s / largest) * (s / largest));
        let total: f64 = squares.iter().sum();
        let share = squares.map(|s| s / total);
        let mut series = Series {
            low: [[0.0; 5]; low_start(HIGHEST_ORDER + 1)],
            high: [[0.0; 2]; high_start(HIGHEST_ORDER + 1)],
            single_low: [[0.0; 5]; low_start(HIGHEST_ORDER + 1) - low_start(FIRST_SINGLE_ORDER)],
            single_high: [[0.0; 2]; high_start(HIGHEST_ORDER + 1) - high_start(FIRST_SINGLE_ORDER)],
        };
        for (order, moments) in MOMENTS.iter().enumerate() {
            for moment in moments {
                // The moment of a cuboid, by derivatives: half side^(2a) / (2a + 1)!
                let weight: f64 = (0..3).map(|axis| share[axis].powi(moment.powers[axis] as i32)).product();
                for (element, polynomial) in moment.polynomials.iter().enumerate() {
                    for b in 0..=degree(element, order) {
                        for a in 0..=degree(element, order) - b {
                            let term = weight * polynomial[monomial_index(a, b)];
                            if a + b <= order {
                                series.low[low_place(order, a, b)][element] += term;
                            } else {
                                series.high[high_start(order) + order + 1 - b][element] += term;
                            }
                        }
                    }
                }
            }
        }
        for order in FIRST_SINGLE_ORDER..=HIGHEST_ORDER {
            for element in 0..5 {
                for b in 0..=degree(element, order) {
                    for a in 0..=degree(element, order) - b {
                        let single = series.about_middle(order, element, [a, b]) as f32;
                        if a + b <= order {
                            series.single_low[low_place(order, a, b) - low_start(FIRST_SINGLE_ORDER)][element] = single;
                        } else {
                            let place = high_start(order) + order + 1 - b;
                            series.single_high[place - high_start(FIRST_SINGLE_ORDER)][element] = single;
                        }
                    }
                }
            }
        }
        series
    }

    /// The coefficient of (u - 1/3)^a (v - 1/3)^b.
    fn about_middle(&self, order: usize, element: usize, [a, b]: [usize; 2]) -> f64 {
        let degree = degree(element, order);
        let mut sum = 0.0;
        for d in b..=degree {
            for c in a..=degree - d {
                let coefficient = if c + d <= order {
                    self.low[low_place(order, c, d)][element]
                } else {
                    self.high[high_start(order) + order + 1 - d][element]
                };
                sum += coefficient * choose(c, a) * choose(d, b) * THIRD.powi((c - a + d - b) as i32);
            }
        }
        sum
    }

    /// The largest sum of the magnitudes of one order's monomials in single precision, of any element.
    #[cfg(test)]
    pub(super) fn magnitude(&self, order: usize, [u, v]: [f64; 2]) -> f64 {
        let (low, high) = (low_start(FIRST_SINGLE_ORDER), high_start(FIRST_SINGLE_ORDER));
        let power = |a: usize, b: usize| (u - THIRD).abs().powi(a as i32) * (v - THIRD).abs().powi(b as i32);
        let mut sums = [0.0; 5];
        for b in 0..=order {
            for a in 0..=order - b {
                let coefficients = self.single_low[low_place(order, a, b) - low];
                sums.iter_mut().zip(coefficients).for_each(|(sum, c)| *sum += f64::from(c.abs()) * power(a, b));
            }
        }
        for b in 0..=order + 1 {
            let coefficients = self.single_high[high_start(order) + order + 1 - b - high];
            let power = power(order + 1 - b, b);
            sums.iter_mut().zip(coefficients).for_each(|(sum, c)| *sum += f64::from(c.abs()) * power);
        }
        sums.into_iter().fold(0.0, f64::max)
    }

    /// One order's coefficients.
    #[inline(always)]
    fn doubles<const ORDER: usize>(&self) -> Coefficients<'_, f64> {
        Coefficients {
            low: &self.low[low_start(ORDER)..low_start(ORDER + 1)],
            high: &self.high[high_start(ORDER)..high_start(ORDER + 1)],
        }
    }

    /// See [`Series::doubles`].
    #[inline(always)]
    fn singles<const ORDER: usize>(&self) -> Coefficients<'_, f32> {
        let (low, high) = (low_start(FIRST_SINGLE_ORDER), high_start(FIRST_SINGLE_ORDER));
        Coefficients {
            low: &self.single_low[low_start(ORDER) - low..low_start(ORDER + 1) - low],
            high: &self.single_high[high_start(ORDER) - high..high_start(ORDER + 1) - high],
        }
    }
}

/// One order's, as [`Series`] has them.
struct Coefficients<'a, C> {
    low: &'a [[C; 5]],
    high: &'a [[C; 2]],
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

fn choose(n: usize, k: usize) -> f64 {
    factorial(n) / (factorial(k) * factorial(n - k))
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
    let (u, v) = (Two([first.u, second.u]), Two([first.v, second.v]));
    let mut sums = Sums::new(simd, u, v, Two([first.sigma, second.sigma]));
    if order >= FIRST_SINGLE_ORDER {
        let mut singles = Sums::new(simd, Singles::of(u - THIRD), Singles::of(v - THIRD), Singles::of(sums.sigma));
        match order {
            6.. => singles.add::<6>(simd, series.singles::<6>()),
            5 => singles.add::<5>(simd, series.singles::<5>()),
            _ => singles.add::<4>(simd, series.singles::<4>()),
        }
        for (double, single) in sums.elements.iter_mut().zip(singles.elements) {
            *double = single.widened();
        }
        if order >= 6 {
            sums.add::<5>(simd, series.doubles::<5>());
        }
        if order >= 5 {
            sums.add::<4>(simd, series.doubles::<4>());
        }
    }
    sums.add::<3>(simd, series.doubles::<3>());
    sums.add::<2>(simd, series.doubles::<2>());
    sums.add::<1>(simd, series.doubles::<1>());
    sums.add::<0>(simd, series.doubles::<0>());
    let [Two(xx), Two(yy), Two(xy), Two(xz), Two(yz)] = sums.elements;
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

/// The five elements so far.
struct Sums<N> {
    u: N,
    v: N,
    sigma: N,
    elements: [N; 5],
}

impl<N: Horner> Sums<N> {
    #[inline(always)]
    fn new(simd: N::Instructions, u: N, v: N, sigma: N) -> Sums<N> {
        Sums { u, v, sigma, elements: [N::coefficient(simd, N::Coefficient::default()); 5] }
    }

    /// sigma times the sums so far, and one order's polynomials, by Horner's scheme in v of Horner's scheme in u.
    #[inline(always)]
    fn add<const ORDER: usize>(
        &mut self,
        simd: N::Instructions,
        Coefficients { low, high }: Coefficients<N::Coefficient>,
    ) {
        let zero = N::coefficient(simd, N::Coefficient::default());
        let (mut polynomials, mut sums) = ([zero; 5], [zero; 5]);
        for (polynomial, top) in polynomials.iter_mut().zip(&high[0]) {
            *polynomial = N::coefficient(simd, *top);
        }
        let mut start = 0;
        for row in 0..=ORDER {
            for (sum, first) in sums.iter_mut().zip(&low[start]) {
                *sum = N::coefficient(simd, *first);
            }
            for (sum, top) in sums.iter_mut().zip(&high[row + 1]) {
                *sum = N::coefficient(simd, *top).times_and(self.u, *sum);
            }
            for coefficients in &low[start + 1..start + 1 + row] {
                for (sum, coefficient) in sums.iter_mut().zip(coefficients) {
                    *sum = sum.times_and(self.u, N::coefficient(simd, *coefficient));
                }
            }
            start += row + 1;
            for (polynomial, sum) in polynomials.iter_mut().zip(sums) {
                *polynomial = polynomial.times_and(self.v, sum);
            }
        }
        for (element, polynomial) in self.elements.iter_mut().zip(polynomials) {
            *element = element.times_and(self.sigma, polynomial);
        }
    }
}
