//! Tiles together far away: the expansion of their field in irregular solid harmonics, in the lanes of a vector (docs/physics.md,
//! section 2.8).

use std::collections::HashMap;
use std::sync::LazyLock;

use fearless_simd::prelude::*;
use glam::DVec3;

use super::harmonics::{Moments, moments_of_tiles};
use super::lanes::{Lanes, Number};
use crate::block::Block;
use crate::tolerances::{HIGHEST_DEGREE, NEAREST_EXPANSION, NEGLIGIBLE_TERM};
use crate::two_sum::TwoSum;

/// The degree of the field is one higher than that of the potential.
const FIELD_DEGREE: usize = HIGHEST_DEGREE + 1;

/// The field of tiles outside a sphere around them.
#[derive(Clone, Debug)]
pub(super) struct Expansion {
    centre: [f64; 3],
    scale: f64,
    /// Real and negative imaginary parts for x, y, z: row after row of equal order, by degree from that of the order on.
    coefficients: Vec<[f64; 6]>,
}

/// Where the row of an order begins.
fn row(order: usize) -> usize {
    order * (2 * FIELD_DEGREE + 3 - order) / 2
}

/// How the polynomials follow from each other (Eq. P24), in rows as the coefficients.
static RECURRENCE: LazyLock<Vec<f64>> = LazyLock::new(|| {
    let mut factors = Vec::with_capacity(row(FIELD_DEGREE + 1));
    for order in 0..=FIELD_DEGREE {
        // From this degree to the next.
        for degree in order..=FIELD_DEGREE {
            let (l, m) = (degree as f64, order as f64);
            factors.push((l * l - m * m) / (4.0 * l * l - 1.0));
        }
    }
    factors
});

impl Expansion {
    /// Of blocks of one frame; lengths are multiplied by `scale`.
    pub(super) fn of(blocks: &[Block], centre: [f64; 3], scale: f64) -> Expansion {
        let mut shapes: HashMap<[u64; 3], usize> = HashMap::new();
        let mut alike: Vec<Alike> = Vec::new();
        for block in blocks {
            let shape = *shapes.entry(block.size.map(f64::to_bits)).or_insert_with(|| {
                alike.push(Alike { size: block.size.map(|s| s * scale), tiles: Vec::new() });
                alike.len() - 1
            });
            let middle = |axis: usize| {
                let [low, high] = block.faces[axis];
                let offset = |face: TwoSum| face.minus(TwoSum::exact(centre[axis])).value();
                (0.5 * offset(low) + 0.5 * offset(high)) * scale
            };
            alike[shape].tiles.push((DVec3::from([0, 1, 2].map(middle)), block.polarization_t));
        }
        let radius = radius(blocks, centre) * scale;
        let mut moments = Moments::new(HIGHEST_DEGREE);
        for Alike { size, tiles } in alike {
            let half_diagonal = 0.5 * DVec3::from(size).length();
            let terms = terms(half_diagonal / ((NEAREST_EXPANSION - 1.0) * radius));
            moments.add(&moments_of_tiles(size, &tiles, HIGHEST_DEGREE, terms));
        }
        Expansion { centre, scale, coefficients: coefficients(&moments) }
    }

    /// mu0 H of the tiles, in their frame, from the potential up to `degree`, at two vectors of points: each coefficient is fetched
    /// once for both.
    #[inline(always)]
    pub(super) fn fields<S: Simd>(&self, simd: S, degree: usize, points: [[Lanes<S>; 3]; 2]) -> [[Lanes<S>; 3]; 2] {
        let (zero, one) = (Lanes::<S>::splat(simd, 0.0), Lanes::<S>::splat(simd, 1.0));
        let places = [Place::of(simd, self, points[0]), Place::of(simd, self, points[1])];
        let mut phase = [[one, zero]; 2];
        let mut field = [[zero; 3]; 2];
        let recurrence = &RECURRENCE[..];
        for order in 0..=degree + 1 {
            let span = row(order)..row(order) + degree + 2 - order;
            let (coefficients, factors) = (&self.coefficients[span.clone()], &recurrence[span]);
            let (mut last, mut polynomial) = ([zero; 2], [one; 2]);
            let mut sums = [[zero; 6]; 2];
            for (coefficients, factor) in coefficients.iter().zip(factors) {
                for (part, coefficient) in coefficients.iter().enumerate() {
                    let coefficient = Lanes::<S>::splat(simd, *coefficient);
                    sums[0][part] = polynomial[0].mul_add(coefficient, sums[0][part]);
                    sums[1][part] = polynomial[1].mul_add(coefficient, sums[1][part]);
                }
                for at in 0..2 {
                    let back = (places[at].inverse_square * last[at]) * -*factor;
                    let next = polynomial[at].mul_add(places[at].along, back);
                    (last[at], polynomial[at]) = (polynomial[at], next);
                }
            }
            for at in 0..2 {
                let [re, im] = phase[at];
                for axis in 0..3 {
                    field[at][axis] =
                        sums[at][2 * axis].mul_add(re, sums[at][2 * axis + 1].mul_add(im, field[at][axis]));
                }
                let [x, y] = places[at].across;
                phase[at] = [re.mul_sub(x, im * y), re.mul_add(y, im * x)];
            }
        }
        for at in 0..2 {
            for component in &mut field[at] {
                *component = *component * places[at].inverse_distance;
            }
        }
        field
    }
}

/// Tiles with the same sides: centre and polarization.
struct Alike {
    size: [f64; 3],
    tiles: Vec<(DVec3, DVec3)>,
}

/// The distance of the farthest corner from `centre`.
pub(super) fn radius(blocks: &[Block], centre: [f64; 3]) -> f64 {
    let corner = |block: &Block| {
        let reach = |axis: usize| {
            let [low, high] = block.faces[axis];
            (low.hi - centre[axis]).abs().max((high.hi - centre[axis]).abs())
        };
        DVec3::from([0, 1, 2].map(reach)).length()
    };
    blocks.iter().map(corner).fold(0.0, f64::max)
}

/// How many terms of the series in the size of a tile matter, whose half diagonal is this fraction of the least distance. Half the degree is all
/// there are: further derivatives vanish.
fn terms(ratio: f64) -> usize {
    let left_out = |terms: usize| (2 * terms + 4) as f64 * (ratio * ratio).powi(terms as i32 + 1);
    (0..HIGHEST_DEGREE / 2).find(|&terms| left_out(terms) < NEGLIGIBLE_TERM).unwrap_or(HIGHEST_DEGREE / 2)
}

/// Eq. P23, with what makes the polynomials' first coefficients one.
fn coefficients(moments: &Moments) -> Vec<[f64; 6]> {
    let mut odd_factorials = vec![1.0];
    for degree in 1..=FIELD_DEGREE {
        odd_factorials.push(odd_factorials[degree - 1] * (2 * degree - 1) as f64);
    }
    let mut coefficients = Vec::with_capacity(row(FIELD_DEGREE + 1));
    for order in 0..=FIELD_DEGREE {
        for (degree, odd_factorial) in (order..).zip(&odd_factorials[order..]) {
            if degree < 2 {
                coefficients.push([0.0; 6]);
                continue;
            }
            let m = order as isize;
            let [own, above] = [moments.at(degree - 1, m), moments.at(degree - 1, m + 1)];
            let parts = if order == 0 {
                [-above[0], 0.0, above[1], 0.0, own[0], 0.0]
            } else {
                let below = moments.at(degree - 1, m - 1);
                let (x, y) = ([below[0] - above[0], below[1] - above[1]], [below[1] + above[1], -below[0] - above[0]]);
                [x[0], -x[1], y[0], -y[1], 2.0 * own[0], -2.0 * own[1]]
            };
            coefficients.push(parts.map(|part| part * odd_factorial));
        }
    }
    coefficients
}

/// Where points lie relative to the centre.
struct Place<S: Simd> {
    inverse_distance: Lanes<S>,
    inverse_square: Lanes<S>,
    /// z / r^2
    along: Lanes<S>,
    /// x / r^2 and y / r^2
    across: [Lanes<S>; 2],
}

impl<S: Simd> Place<S> {
    #[inline(always)]
    fn of(simd: S, expansion: &Expansion, mut point: [Lanes<S>; 3]) -> Place<S> {
        for (coordinate, centre) in point.iter_mut().zip(&expansion.centre) {
            *coordinate = (*coordinate - *centre) * expansion.scale;
        }
        let [x, y, z] = point;
        let inverse_square = Lanes::<S>::splat(simd, 1.0).over(z.mul_add(z, y.mul_add(y, x * x)));
        Place {
            inverse_distance: inverse_square.sqrt(),
            inverse_square,
            along: z * inverse_square,
            across: [x * inverse_square, y * inverse_square],
        }
    }
}
