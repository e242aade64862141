//! Coefficients of the multipole series of a shape (docs/physics.md, section 2.7).

use std::sync::LazyLock;

use magsplice_simd::lanes::Number;

use crate::tolerances::HIGHEST_ORDER;

/// A_x, A_y, P_xy, P_xz and P_yz (Eq. P39).
pub const POLYNOMIALS: usize = 5;

/// B_xxy, B_xxz, B_yyx, B_yyz, B_zzx, B_zzy and P_xyz (Eq. P75).
pub const GRADIENT_POLYNOMIALS: usize = 7;

/// The multipole series of one shape: polynomials in sigma = (half diagonal / r)^2, whose
/// coefficients are polynomials in u - 1/3 and v - 1/3, u = x^2/r^2 and v = y^2/r^2.
#[derive(Clone, Debug)]
pub struct Series {
    /// Coefficients of each polynomial by order of sigma, within an order at [`place`].
    coefficients: [[f64; start(HIGHEST_ORDER + 1)]; POLYNOMIALS],
}

/// Centre of the range of u and v, u + v <= 1. Powers of the deviation from it cancel least.
pub const THIRD: f64 = 1.0 / 3.0;

/// Index of the first coefficient of an order.
const fn start(order: usize) -> usize {
    order * (order + 1) * (order + 2) / 6
}

/// Index of u^a v^b among the coefficients of an order, as Horner's scheme needs them: rows of
/// equal b, highest powers first.
const fn place(order: usize, a: usize, b: usize) -> usize {
    let row = order - b;
    row * (row + 1) / 2 + row - a
}

impl Series {
    /// The series of a cuboid with these side lengths, up to order `highest`.
    pub fn new(size: [f64; 3], highest: usize) -> Series {
        Series { coefficients: coefficients_of_shape(size, highest, &MOMENTS) }
    }

    /// The polynomials at sigma, u - 1/3 and v - 1/3, without orders above `highest`, which is at
    /// least 3.
    #[inline(always)]
    pub fn polynomials<N: Number>(&self, simd: N::Instructions, highest: usize, at: [N; 3]) -> [N; POLYNOMIALS] {
        match highest {
            0..=3 => polynomials::<3, POLYNOMIALS, N>(simd, &self.coefficients, at),
            4 => polynomials::<4, POLYNOMIALS, N>(simd, &self.coefficients, at),
            5 => polynomials::<5, POLYNOMIALS, N>(simd, &self.coefficients, at),
            6 => polynomials::<6, POLYNOMIALS, N>(simd, &self.coefficients, at),
            _ => polynomials::<HIGHEST_ORDER, POLYNOMIALS, N>(simd, &self.coefficients, at),
        }
    }
}

/// The multipole series of the gradient of one shape, in the form of [`Series`].
#[derive(Clone, Debug)]
pub struct GradientSeries {
    coefficients: [[f64; start(HIGHEST_ORDER + 1)]; GRADIENT_POLYNOMIALS],
}

impl GradientSeries {
    /// The series of a cuboid with these side lengths, up to order `highest`.
    pub fn new(size: [f64; 3], highest: usize) -> GradientSeries {
        GradientSeries { coefficients: coefficients_of_shape(size, highest, &GRADIENT_MOMENTS) }
    }

    /// The polynomials at sigma, u - 1/3 and v - 1/3, without orders above `highest`, which is at
    /// least 4.
    #[inline(always)]
    pub fn polynomials<N: Number>(
        &self,
        simd: N::Instructions,
        highest: usize,
        at: [N; 3],
    ) -> [N; GRADIENT_POLYNOMIALS] {
        match highest {
            0..=4 => polynomials::<4, GRADIENT_POLYNOMIALS, N>(simd, &self.coefficients, at),
            5 => polynomials::<5, GRADIENT_POLYNOMIALS, N>(simd, &self.coefficients, at),
            6 => polynomials::<6, GRADIENT_POLYNOMIALS, N>(simd, &self.coefficients, at),
            7 => polynomials::<7, GRADIENT_POLYNOMIALS, N>(simd, &self.coefficients, at),
            _ => polynomials::<HIGHEST_ORDER, GRADIENT_POLYNOMIALS, N>(simd, &self.coefficients, at),
        }
    }
}

/// The coefficients of a cuboid with these side lengths, up to order `highest`.
fn coefficients_of_shape<const COUNT: usize>(
    size: [f64; 3],
    highest: usize,
    moments: &[LazyLock<Vec<Moment<COUNT>>>],
) -> [[f64; start(HIGHEST_ORDER + 1)]; COUNT] {
    let largest = size.iter().copied().fold(0.0, f64::max);
    let squares = size.map(|s| (s / largest) * (s / largest));
    let total: f64 = squares.iter().sum();
    let share = squares.map(|s| s / total);
    let mut series = [[0.0; start(HIGHEST_ORDER + 1)]; COUNT];
    for (order, moments) in moments.iter().enumerate().take(highest + 1) {
        for moment in &**moments {
            let weight: f64 = (0..3).map(|axis| share[axis].powi(moment.powers[axis] as i32)).product();
            for (sums, coefficients) in series.iter_mut().zip(&moment.coefficients) {
                for (sum, coefficient) in sums[start(order)..].iter_mut().zip(coefficients) {
                    *sum += weight * coefficient;
                }
            }
        }
    }
    series
}

/// Polynomials with these coefficients at sigma, u - 1/3 and v - 1/3, without orders above
/// `HIGHEST`.
#[inline(always)]
fn polynomials<const HIGHEST: usize, const COUNT: usize, N: Number>(
    simd: N::Instructions,
    coefficients: &[[f64; start(HIGHEST_ORDER + 1)]; COUNT],
    [sigma, u, v]: [N; 3],
) -> [N; COUNT] {
    let mut polynomials = [N::splat(simd, 0.0); COUNT];
    // One polynomial after the other, because the partial sums of all exceed the registers.
    for (polynomial, coefficients) in polynomials.iter_mut().zip(coefficients) {
        let mut sum = order::<HIGHEST, N>(simd, coefficients, u, v);
        if HIGHEST > 7 {
            sum = sum.mul_add(sigma, order::<7, N>(simd, coefficients, u, v));
        }
        if HIGHEST > 6 {
            sum = sum.mul_add(sigma, order::<6, N>(simd, coefficients, u, v));
        }
        if HIGHEST > 5 {
            sum = sum.mul_add(sigma, order::<5, N>(simd, coefficients, u, v));
        }
        if HIGHEST > 4 {
            sum = sum.mul_add(sigma, order::<4, N>(simd, coefficients, u, v));
        }
        if HIGHEST > 3 {
            sum = sum.mul_add(sigma, order::<3, N>(simd, coefficients, u, v));
        }
        sum = sum.mul_add(sigma, order::<2, N>(simd, coefficients, u, v));
        sum = sum.mul_add(sigma, order::<1, N>(simd, coefficients, u, v));
        *polynomial = sum.mul_add(sigma, order::<0, N>(simd, coefficients, u, v));
    }
    polynomials
}

/// One order of a polynomial, by Horner's scheme in v of Horner's scheme in u.
#[inline(always)]
fn order<const ORDER: usize, N: Number>(
    simd: N::Instructions,
    coefficients: &[f64; start(HIGHEST_ORDER + 1)],
    u: N,
    v: N,
) -> N {
    let coefficients = &coefficients[start(ORDER)..start(ORDER + 1)];
    let mut sum = N::splat(simd, coefficients[0]);
    // The compiler unrolls loops with constant bounds.
    for row in 1..=HIGHEST_ORDER {
        if row <= ORDER {
            let first = row * (row + 1) / 2;
            let mut own = N::splat(simd, coefficients[first]);
            for column in 1..=HIGHEST_ORDER {
                if column <= row {
                    own = own.mul_add(u, N::splat(simd, coefficients[first + column]));
                }
            }
            sum = sum.mul_add(v, own);
        }
    }
    sum
}

/// One moment <x^2a y^2b z^2c>, and the polynomials of the derivatives of 1/r that multiply it.
struct Moment<const COUNT: usize> {
    powers: [usize; 3],
    /// Coefficients of each polynomial in the order of [`place`].
    coefficients: [Vec<f64>; COUNT],
}

/// Moments by order a + b + c. High orders are rarely needed.
static MOMENTS: [LazyLock<Vec<Moment<POLYNOMIALS>>>; HIGHEST_ORDER + 1] = [
    LazyLock::new(|| moments(0, field_polynomials)),
    LazyLock::new(|| moments(1, field_polynomials)),
    LazyLock::new(|| moments(2, field_polynomials)),
    LazyLock::new(|| moments(3, field_polynomials)),
    LazyLock::new(|| moments(4, field_polynomials)),
    LazyLock::new(|| moments(5, field_polynomials)),
    LazyLock::new(|| moments(6, field_polynomials)),
    LazyLock::new(|| moments(7, field_polynomials)),
    LazyLock::new(|| moments(8, field_polynomials)),
];

/// [`MOMENTS`] of the gradient.
static GRADIENT_MOMENTS: [LazyLock<Vec<Moment<GRADIENT_POLYNOMIALS>>>; HIGHEST_ORDER + 1] = [
    LazyLock::new(|| moments(0, gradient_polynomials)),
    LazyLock::new(|| moments(1, gradient_polynomials)),
    LazyLock::new(|| moments(2, gradient_polynomials)),
    LazyLock::new(|| moments(3, gradient_polynomials)),
    LazyLock::new(|| moments(4, gradient_polynomials)),
    LazyLock::new(|| moments(5, gradient_polynomials)),
    LazyLock::new(|| moments(6, gradient_polynomials)),
    LazyLock::new(|| moments(7, gradient_polynomials)),
    LazyLock::new(|| moments(8, gradient_polynomials)),
];

fn moments<const COUNT: usize>(
    order: usize,
    polynomials: fn(usize, [usize; 3]) -> [Polynomial; COUNT],
) -> Vec<Moment<COUNT>> {
    let pairs = (0..=order).flat_map(|a| (0..=order - a).map(move |b| [a, b, order - a - b]));
    pairs.map(|powers| Moment::new(order, powers, polynomials(order, powers))).collect()
}

impl<const COUNT: usize> Moment<COUNT> {
    fn new(order: usize, powers: [usize; 3], polynomials: [Polynomial; COUNT]) -> Moment<COUNT> {
        // The moment of a cuboid, by derivatives: half side^(2a) / (2a + 1)!
        let over: f64 = powers.iter().map(|&a| factorial(2 * a + 1)).product();
        let coefficients = polynomials.map(|polynomial| {
            let mut coefficients = vec![0.0; (order + 1) * (order + 2) / 2];
            // The coefficients of degree order + 1 are zero.
            let about_middle = polynomial.about_middle(order);
            for b in 0..=order {
                for a in 0..=order - b {
                    coefficients[place(order, a, b)] = about_middle.0[a][b] / over;
                }
            }
            coefficients
        });
        Moment { powers, coefficients }
    }
}

/// The derivative of 1/r along these axes and twice along each axis for each of its powers.
fn derivative<const AXES: usize>(powers: [usize; 3], axes: [usize; AXES]) -> Polynomial {
    let mut derivative = powers.map(|power| 2 * power);
    axes.into_iter().for_each(|axis| derivative[axis] += 1);
    derivative_of_reciprocal_distance(derivative)
}

/// The polynomials of the field, of degree `order`.
fn field_polynomials(order: usize, powers: [usize; 3]) -> [Polynomial; POLYNOMIALS] {
    // Eq. P39; w = 1 - u - v
    let mut polynomials = [[0, 0], [1, 1], [0, 1], [0, 2], [1, 2]].map(|axes| derivative(powers, axes));
    for b in 0..=order {
        for a in 0..=order - b {
            let at = |element: usize| polynomials[element].0[a][b];
            let (xy, xz, yz) = (at(2), at(3), at(4));
            let [ax, ay, ..] = &mut polynomials;
            for (sum, u, v, w) in [(ax, 0.0, xy, xz), (ay, xy, 0.0, yz)] {
                sum.0[a][b] += w - xy;
                sum.0[a + 1][b] += u - w;
                sum.0[a][b + 1] += v - w;
            }
        }
    }
    polynomials
}

/// The polynomials of the gradient, of degree `order`.
fn gradient_polynomials(order: usize, powers: [usize; 3]) -> [Polynomial; GRADIENT_POLYNOMIALS] {
    // Eq. P75; w = 1 - u - v
    let axes = [[0, 0, 1], [0, 0, 2], [1, 1, 0], [1, 1, 2], [2, 2, 0], [2, 2, 1], [0, 1, 2]];
    let mut polynomials = axes.map(|axes| derivative(powers, axes));
    let [twice @ .., mixed] = &mut polynomials;
    for (polynomial, [own, ..]) in twice.iter_mut().zip(axes) {
        for b in 0..=order {
            for a in 0..=order - b {
                let xyz = mixed.0[a][b];
                match own {
                    0 => polynomial.0[a + 1][b] -= xyz,
                    1 => polynomial.0[a][b + 1] -= xyz,
                    _ => {
                        polynomial.0[a][b] -= xyz;
                        polynomial.0[a + 1][b] += xyz;
                        polynomial.0[a][b + 1] += xyz;
                    }
                }
            }
        }
    }
    polynomials
}

/// Coefficients of u^a v^b.
#[derive(Clone, Copy)]
struct Polynomial([[f64; HIGHEST_ORDER + 2]; HIGHEST_ORDER + 2]);

impl Polynomial {
    /// The polynomial in powers of u - 1/3 and v - 1/3, up to `degree`.
    fn about_middle(mut self, degree: usize) -> Polynomial {
        let Polynomial(rows) = &mut self;
        for step in 0..degree {
            for a in (step..degree).rev() {
                let next = rows[a + 1];
                for (own, next) in rows[a].iter_mut().zip(next) {
                    *own += next * THIRD;
                }
            }
        }
        for row in &mut rows[..=degree] {
            for step in 0..degree {
                for b in (step..degree).rev() {
                    row[b] += row[b + 1] * THIRD;
                }
            }
        }
        self
    }
}

/// r^(n+1) times the n-th derivative of 1/r, without odd powers, as a polynomial in u and v,
/// w = 1 - u - v.
///
/// With D = (x^2 + y^2 + z^2)^(-1/2) each axis gives a sum over j of
/// `alpha! / (j! (alpha - 2j)!) (2x)^(alpha - 2j) D^(alpha - j)`.
fn derivative_of_reciprocal_distance(derivative: [usize; 3]) -> Polynomial {
    let order: usize = derivative.iter().sum();
    let mut sum = Polynomial([[0.0; HIGHEST_ORDER + 2]; HIGHEST_ORDER + 2]);
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
                        sum.0[a + m][b + n] += c * sign * ways;
                    }
                }
            }
        }
    }
    sum
}

fn factorial(n: usize) -> f64 {
    (1..=n).map(|k| k as f64).product()
}
