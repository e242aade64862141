//! Tiles together far away: the expansion of their field in irregular solid harmonics, in the lanes of a vector (docs/physics.md,
//! section 2.8).

use std::sync::LazyLock;

use fearless_simd::Level;
use fearless_simd::prelude::*;
use glam::DVec3;

use super::harmonics::{Moments, Parity, Source};
use super::lanes::{Lanes, Number};
use super::pairwise::each_pair;
use crate::block::Block;
use crate::tolerances::{HIGHEST_DEGREE, POINTS_PER_DEGREE};
use crate::two_sum::TwoSum;

/// The degree of the field is one higher than that of the potential.
const FIELD_DEGREE: usize = HIGHEST_DEGREE + 1;

/// The field of tiles outside a sphere around them.
#[derive(Clone, Debug)]
pub(super) struct Expansion {
    centre: [f64; 3],
    scale: f64,
    /// That of the potential.
    degree: usize,
    /// Real and imaginary parts of (2l - 1)!! M_(l-1)m, row after row of equal order m, see [`Expansion::row`].
    moments: Vec<[f64; 2]>,
    parity: Parity,
}

/// Where the factors of an order begin.
fn row(order: usize) -> usize {
    order * (2 * FIELD_DEGREE + 3 - order) / 2
}

/// How the polynomials follow from each other (Eq. P24): row after row of equal order, by degree from that of the order on.
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
    pub(super) fn of(level: Level, blocks: &[Block], centre: [f64; 3], scale: f64) -> Expansion {
        let source = |block: &Block| {
            let middle = [0, 1, 2].map(|axis: usize| {
                let [low, high] = block.faces[axis].map(|face| face.minus(TwoSum::exact(centre[axis])).value());
                0.5 * low + 0.5 * high
            });
            Source::new(DVec3::from(middle) * scale, DVec3::from(block.size) * scale, None, block.polarization_t)
        };
        let sources: Vec<Source> = blocks.iter().map(source).collect();
        Expansion::of_moments(&Moments::of(level, &sources, HIGHEST_DEGREE), centre, scale)
    }

    /// Of the moments about a point of what has been scaled.
    pub(super) fn of_moments(moments: &Moments, centre: [f64; 3], scale: f64) -> Expansion {
        let degree = moments.degree();
        let mut odd_factorials = vec![1.0];
        for l in 1..=degree + 1 {
            odd_factorials.push(odd_factorials[l - 1] * (2 * l - 1) as f64);
        }
        let rows = (0..=degree + 2).flat_map(|order| (first_degree(order)..=degree + 1).map(move |l| (order, l)));
        let coefficients = rows
            .map(
                |(order, l)| {
                    if l < 2 { [0.0; 2] } else { moments.at(l - 1, order).map(|part| part * odd_factorials[l]) }
                },
            )
            .collect();
        Expansion { centre, scale, degree, moments: coefficients, parity: moments.parity() }
    }

    /// The moments of an order, for the degrees of the field from `from` on.
    #[inline(always)]
    fn row(&self, order: usize, from: usize) -> &[[f64; 2]] {
        let (first, last) = (first_degree(order), self.degree + 1);
        let before = order * (last + 1) - first * first.saturating_sub(1) / 2;
        &self.moments[before + from - first..before + last + 1 - first]
    }

    /// mu0 H of the tiles, in their frame, at points given by axis, from the potential up to the degrees that each [`POINTS_PER_DEGREE`] points have.
    #[inline(never)]
    pub(super) fn fields<S: Simd>(&self, simd: S, degrees: &[usize], points: [&[f64]; 3], fields: [&mut [f64]; 3]) {
        simd.vectorize(
            #[inline(always)]
            || {
                each_pair(
                    simd,
                    #[inline(always)]
                    |first, pair| self.fields_of_pair(simd, degrees[first / POINTS_PER_DEGREE], pair),
                    points,
                    fields,
                );
            },
        );
    }

    /// The same at two vectors of points.
    #[inline(always)]
    pub(super) fn fields_of_pair<S: Simd>(
        &self,
        simd: S,
        degree: usize,
        points: [[Lanes<S>; 3]; 2],
    ) -> [[Lanes<S>; 3]; 2] {
        // Not by `map`: operations on vectors in a closure are calls.
        let (first, over_first) = self.place(simd, points[0]);
        let (second, over_second) = self.place(simd, points[1]);
        // Those of the own order, of the next and of the one before.
        let rows = |order: usize| [order, order + 1, order.saturating_sub(1)].map(|other| self.row(other, order));
        let places = [first, second];
        let fields = match self.parity {
            Parity::Neither => fields_of_rows::<S, ALL>(simd, &places, degree + 1, rows),
            Parity::Even => fields_of_rows::<S, OTHERS_FIRST>(simd, &places, degree + 1, rows),
            Parity::Odd => fields_of_rows::<S, OWN_FIRST>(simd, &places, degree + 1, rows),
        };
        let [[x, y, z], [x_2, y_2, z_2]] = fields;
        [[x * over_first, y * over_first, z * over_first], [x_2 * over_second, y_2 * over_second, z_2 * over_second]]
    }

    /// Where a point lies relative to the centre, and the inverse of its distance.
    #[inline(always)]
    fn place<S: Simd>(&self, simd: S, mut point: [Lanes<S>; 3]) -> (Place<S>, Lanes<S>) {
        for (coordinate, centre) in point.iter_mut().zip(&self.centre) {
            *coordinate = (*coordinate - *centre) * self.scale;
        }
        let [x, y, z] = point;
        let square = Lanes::<S>::splat(simd, 1.0).over(z.mul_add(z, y.mul_add(y, x * x)));
        (Place { square, along: z * square, across: [x * square, y * square] }, square.sqrt())
    }
}

/// What the polynomials of an expansion are made of, z / r^2 and so on; or of one around its centre, z and so on.
pub(super) struct Place<S: Simd> {
    /// 1 / r^2, or r^2
    pub(super) square: Lanes<S>,
    /// z / r^2
    pub(super) along: Lanes<S>,
    /// x / r^2 and y / r^2
    pub(super) across: [Lanes<S>; 2],
}

/// Which coefficients of a row there are. In rows of an expansion with a parity those of the order itself alternate with those of its neighbours, beginning at the
/// degree of the order.
pub(super) const ALL: u8 = 0;
const OWN_FIRST: u8 = 1;
const OTHERS_FIRST: u8 = 2;

/// The field (Eq. P23) up to `degree` at two vectors of points. `rows` gives the coefficients of an order, of the next and of the one before, from the degree
/// of the order on.
#[inline(always)]
pub(super) fn fields_of_rows<'a, S: Simd, const WHICH: u8>(
    simd: S,
    places: &[Place<S>; 2],
    degree: usize,
    rows: impl Fn(usize) -> [&'a [[f64; 2]]; 3],
) -> [[Lanes<S>; 3]; 2] {
    let (zero, one) = (Lanes::<S>::splat(simd, 0.0), Lanes::<S>::splat(simd, 1.0));
    let mut phase = [[one, zero]; 2];
    let mut field = [[zero; 3]; 2];
    for order in 0..=degree {
        let count = degree + 1 - order;
        let factors = &RECURRENCE[row(order)..row(order) + count];
        let sums = row_sums::<S, WHICH>(simd, places, rows(order).map(|row| &row[..count]), factors);
        for at in 0..2 {
            let [own_re, own_im, above_re, above_im, below_re, below_im] = sums[at];
            let [re, im] = phase[at];
            let [x, y, z] = &mut field[at];
            if order == 0 {
                (*x, *y, *z) = (*x - above_re, *y + above_im, *z + own_re);
            } else {
                *x = (below_re - above_re).mul_add(re, (above_im - below_im).mul_add(im, *x));
                *y = (below_im + above_im).mul_add(re, (below_re + above_re).mul_add(im, *y));
                *z = own_re.mul_add(re + re, *z) - own_im * (im + im);
            }
            let [across_x, across_y] = places[at].across;
            phase[at] = [re.mul_sub(across_x, im * across_y), re.mul_add(across_y, im * across_x)];
        }
    }
    field
}

/// The lowest degree of the field to which an order of the potential's moments belongs.
fn first_degree(order: usize) -> usize {
    order.saturating_sub(1)
}

/// Sums over degrees of polynomial times moment, at two vectors of points: each moment is fetched once for both.
#[inline(always)]
fn row_sums<S: Simd, const WHICH: u8>(
    simd: S,
    places: &[Place<S>; 2],
    rows: [&[[f64; 2]]; 3],
    factors: &[f64],
) -> [[Lanes<S>; 6]; 2] {
    let mut row = Row::new(simd);
    let [own, above, below] = rows;
    let (mut own, mut above, mut below) = (own.chunks_exact(2), above.chunks_exact(2), below.chunks_exact(2));
    let mut factors = factors.chunks_exact(2);
    for (((own, above), below), factors) in (&mut own).zip(&mut above).zip(&mut below).zip(&mut factors) {
        if WHICH != OTHERS_FIRST {
            row.add_own(simd, own[0]);
        }
        if WHICH != OWN_FIRST {
            row.add_others(simd, above[0], below[0]);
        }
        row.go_on(places, factors[0]);
        if WHICH != OWN_FIRST {
            row.add_own(simd, own[1]);
        }
        if WHICH != OTHERS_FIRST {
            row.add_others(simd, above[1], below[1]);
        }
        row.go_on(places, factors[1]);
    }
    if let ([own], [above], [below]) = (own.remainder(), above.remainder(), below.remainder()) {
        if WHICH != OTHERS_FIRST {
            row.add_own(simd, *own);
        }
        if WHICH != OWN_FIRST {
            row.add_others(simd, *above, *below);
        }
    }
    row.sums
}

/// A row's sums so far, at two vectors of points: of the order itself, of the next and of the one before.
struct Row<S: Simd> {
    last: [Lanes<S>; 2],
    polynomial: [Lanes<S>; 2],
    sums: [[Lanes<S>; 6]; 2],
}

impl<S: Simd> Row<S> {
    #[inline(always)]
    fn new(simd: S) -> Row<S> {
        let (zero, one) = (Lanes::<S>::splat(simd, 0.0), Lanes::<S>::splat(simd, 1.0));
        Row { last: [zero; 2], polynomial: [one; 2], sums: [[zero; 6]; 2] }
    }

    #[inline(always)]
    fn add(&mut self, simd: S, part: usize, moment: f64) {
        let moment = Lanes::<S>::splat(simd, moment);
        self.sums[0][part] = self.polynomial[0].mul_add(moment, self.sums[0][part]);
        self.sums[1][part] = self.polynomial[1].mul_add(moment, self.sums[1][part]);
    }

    #[inline(always)]
    fn add_own(&mut self, simd: S, [re, im]: [f64; 2]) {
        self.add(simd, 0, re);
        self.add(simd, 1, im);
    }

    #[inline(always)]
    fn add_others(&mut self, simd: S, above: [f64; 2], below: [f64; 2]) {
        self.add(simd, 2, above[0]);
        self.add(simd, 3, above[1]);
        self.add(simd, 4, below[0]);
        self.add(simd, 5, below[1]);
    }

    /// To the next degree.
    #[inline(always)]
    fn go_on(&mut self, places: &[Place<S>; 2], factor: f64) {
        for (place, (last, polynomial)) in places.iter().zip(self.last.iter_mut().zip(&mut self.polynomial)) {
            let next = polynomial.mul_add(place.along, (place.square * *last) * -factor);
            (*last, *polynomial) = (*polynomial, next);
        }
    }
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

#[cfg(test)]
mod tests {
    use fearless_simd::dispatch;
    use glam::DQuat;

    use super::super::instruction_set::InstructionSet;
    use super::super::tree::Tree;
    use super::*;
    use crate::arrangement::Arrangement;
    use crate::tile::Tile;

    /// Tiles of one thickness between the same planes, half of them turned in these, with parts of J in the plane and across.
    fn flat_film(in_plane: f64, across: f64) -> Tree {
        let tile = |n: usize| {
            let (x, y, n) = ((n % 12) as f64, (n / 12) as f64, n as f64);
            let j = DVec3::new(in_plane * (0.6 * x).sin(), in_plane * (0.7 * y).cos(), across * (0.3 * n).cos());
            let size = DVec3::new(0.9, 0.6, 0.85);
            let tile =
                Tile::new(DVec3::new(1.1 * x, 1.1 * y, -0.37), size, j + 0.1 * DVec3::new(in_plane, 0.0, across));
            let turn = if n < 70.0 { DQuat::IDENTITY } else { DQuat::from_rotation_z(0.01 * n) };
            tile.expect("a valid tile").rotated(turn).expect("a rotation")
        };
        let tiles: Vec<Tile> = (0..144).map(tile).collect();
        Tree::of(Level::new(), &Arrangement::of(&tiles), &tiles, 20)
    }

    #[test]
    fn flat_films_take_half_of_the_moments_and_have_the_same_digits() {
        let points = [0, 1, 2].map(|axis| -> Vec<f64> {
            (0..32).map(|n| [0.9, -1.3, 1.7][axis] * (f64::from(n) + 3.0) + 40.0 * [1.0, 1.0, 0.0][axis]).collect()
        });
        let views = || points.each_ref().map(|axis| &axis[..]);
        for (in_plane, across, parity) in
            [(0.3, 0.0, Parity::Even), (0.0, 0.3, Parity::Odd), (0.3, 0.2, Parity::Neither)]
        {
            let tree = flat_film(in_plane, across);
            for node in 0..tree.nodes.len() {
                let expansion = tree.expansion(node);
                assert_eq!(expansion.parity, parity, "node {node}");
                let all = Expansion { parity: Parity::Neither, ..expansion.clone() };
                for set in InstructionSet::available() {
                    let level = set.detected().expect("available");
                    let field = |expansion: &Expansion| {
                        let mut fields = [const { [f64::NAN; 32] }; 3];
                        let degrees = [expansion.degree, expansion.degree.div_ceil(2)];
                        let room = fields.each_mut().map(|values| &mut values[..]);
                        dispatch!(level, simd => expansion.fields(simd, &degrees, views(), room));
                        fields
                    };
                    assert_eq!(field(expansion), field(&all), "node {node} with {set:?}");
                }
            }
        }
    }
}
