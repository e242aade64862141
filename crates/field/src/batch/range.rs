//! Which form serves a tile, or tiles together, at a point.

use fearless_simd::prelude::*;

use super::expansion;
use super::lanes::{Lanes, Number};
use crate::block::Block;
use crate::tolerances::{
    ALONE_COST, CLOSED_FORM_COST, EXPANSION_DEGREES, FARTHEST, FORM_MARGIN, GROUP_DISTANCE, LONGEST_NEEDLE,
    MIDDLE_REACH, MULTIPOLE_ORDERS, NEAR_FRACTION, PRODUCT_RANGE, RADIUS_BISECTIONS, SMALL_ANGLE, SMALL_GROUP,
    SMALLER_ANGLE, STRETCH,
};

/// The form, as a number to sort points by: from [`FAR`] on positions in [`Range::far`].
pub(super) type Form = u8;
/// None of the others: tiles together are taken one by one, a tile by the kernel of one point.
pub(super) const NEAR: Form = 0;
/// The closed form in vectors.
pub(super) const MIDDLE: Form = 1;
/// The same where each element is small: of a tile alone, and to a tolerance of tiles together.
pub(super) const OUTER: Form = 2;
/// The first of those far away.
pub(super) const FAR: Form = 3;
/// An expansion to a tolerance, see [`super::assignment`].
pub(super) const BEYOND: Form = FAR + MOST_STEPS as Form;
/// How many there may be.
pub(super) const FORMS: usize = BEYOND as usize + 1;
/// One for each distance at which another form may begin: that of each order and degree, and the end of the closed form.
const MOST_STEPS: usize = MULTIPOLE_ORDERS.len() + EXPANSION_DEGREES.len() + 1;

/// A form for points far away.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FarForm {
    /// The multipole series of each tile.
    Series { order: usize },
    /// The expansion of tiles together.
    Expansion { degree: usize },
}

impl FarForm {
    /// The multiply-adds of one vector for so many tiles, about.
    fn cost(self, tiles: usize) -> f64 {
        match self {
            FarForm::Series { order } => (tiles * (5 * (order + 1) * (order + 2) * (order + 3) / 6 + 60)) as f64,
            // Six sums and three for the recurrence.
            FarForm::Expansion { degree } => (9 * (degree + 2) * (degree + 3) / 2 + 60) as f64,
        }
    }
}

/// Where each form serves.
#[derive(Clone, Debug)]
pub(super) struct Range {
    /// A power of two that takes the lengths of the tiles to order one. What follows is scaled with it, but for the centre.
    pub(super) scale: f64,
    pub(super) centre: [f64; 3],
    half_size: [f64; 3],
    /// Square of the least distance from the box for the closed form.
    near: f64,
    /// Square of the least distance from the box at which each element of a tile alone is small,
    outer: f64,
    /// and from the centre; either is enough.
    outer_radius: f64,
    /// The same to a tolerance, of each group of tiles together.
    small: f64,
    /// Square of the greatest distance from the centre for the closed form.
    middle: f64,
    /// The same to a tolerance that leaves room for [`crate::tolerances::STRETCHED_BOUND`].
    stretched: f64,
    /// Squares of the distances from the centre at which another form begins, and which.
    far: Vec<(f64, FarForm)>,
}

impl Range {
    pub(super) fn of_tile(block: &Block) -> Range {
        let [[x0, x1], [y0, y1], [z0, z1]] = block.faces.map(|faces| faces.map(|face| face.hi));
        let scale = power_of_two_reciprocal(largest(block.size));
        let shape = Shape::of(block, scale);
        let middle = if shape.largest <= LONGEST_NEEDLE * shape.second { MIDDLE_REACH * shape.second } else { 0.0 };
        let outer = (shape.volume / SMALL_ANGLE).cbrt().powi(2);
        Range {
            scale,
            centre: [0.5 * x0 + 0.5 * x1, 0.5 * y0 + 0.5 * y1, 0.5 * z0 + 0.5 * z1],
            half_size: block.size.map(|s| 0.5 * s * scale),
            near: (NEAR_FRACTION * shape.largest).powi(2),
            outer,
            outer_radius: shape.small_from().powi(2),
            small: outer,
            middle: middle * middle,
            stretched: middle * middle,
            far: far_of_tile(&shape, middle).into_iter().map(squared).collect(),
        }
    }

    /// The box around tiles: its centre and half its size.
    fn around(blocks: &[Block]) -> ([f64; 3], [f64; 3]) {
        let face = |block: &Block, axis: usize, upper: usize| block.faces[axis][upper].hi;
        let least = [0, 1, 2].map(|axis| blocks.iter().map(|b| face(b, axis, 0)).fold(f64::INFINITY, f64::min));
        let most = [0, 1, 2].map(|axis| blocks.iter().map(|b| face(b, axis, 1)).fold(f64::NEG_INFINITY, f64::max));
        let middle = [0, 1, 2].map(|axis: usize| 0.5 * least[axis] + 0.5 * most[axis]);
        (middle, [0, 1, 2].map(|axis: usize| 0.5 * most[axis] - 0.5 * least[axis]))
    }

    /// Of the sphere around that box.
    pub(super) fn radius_of(blocks: &[Block]) -> f64 {
        let [x, y, z] = Range::around(blocks).1;
        x.hypot(y).hypot(z)
    }

    /// The scale of tiles together.
    pub(super) fn scale_of(blocks: &[Block]) -> f64 {
        power_of_two_reciprocal(largest(Range::around(blocks).1))
    }

    /// Of tiles together: each point that is not [`NEAR`] has the same form for all of them. `group_volume` is that of the tiles that share a
    /// series, scaled, and `group_tiles` their number. `blocks` are what the closed form takes, `tiles` as how many the other forms take them.
    pub(super) fn of_tiles(blocks: &[Block], tiles: usize, group_volume: f64, group_tiles: usize) -> Range {
        let (centre, half) = Range::around(blocks);
        let scale = Range::scale_of(blocks);
        let half_size = half.map(|h| h * scale);
        let radius = half_size.iter().map(|h| h * h).sum::<f64>().sqrt();
        let shapes: Vec<Shape> = blocks.iter().map(|b| Shape::of(b, scale)).collect();
        let most_of = |length: fn(&Shape) -> f64| shapes.iter().map(length).fold(0.0, f64::max);
        let near =
            (NEAR_FRACTION * most_of(|s| s.largest)).max(GROUP_DISTANCE * group_volume.cbrt()).max(1.0 / PRODUCT_RANGE);
        // Errors add up like volume / second side.
        let volume: f64 = shapes.iter().map(|s| s.volume).sum();
        let second = volume / shapes.iter().map(|s| s.volume / s.second).sum::<f64>();
        let is_needle = |s: &Shape| s.largest > LONGEST_NEEDLE * s.second;
        let reach = if shapes.iter().any(is_needle) { 0.0 } else { (MIDDLE_REACH * second).min(PRODUCT_RANGE) };
        let middle = (reach - radius).max(0.0);
        let stretched = ((STRETCH * reach).min(PRODUCT_RANGE) - radius).max(0.0);
        let half_diagonal = most_of(|s| s.half_diagonal);
        let sphere = expansion::radius(blocks, centre) * scale;
        let expansions =
            EXPANSION_DEGREES.into_iter().map(|(degree, radii)| (radii * sphere, FarForm::Expansion { degree }));
        // Orders that take long are for tiles by themselves, as which all are taken where no form serves them together.
        let series = series(|half_diagonals| half_diagonals * half_diagonal + radius);
        let candidates: Vec<(f64, FarForm)> =
            series.filter(|(_, form)| form.cost(1) <= ALONE_COST).chain(expansions).collect();
        Range {
            scale,
            centre,
            half_size,
            near: near * near,
            outer: f64::INFINITY,
            outer_radius: f64::INFINITY,
            small: if group_tiles > SMALL_GROUP {
                f64::INFINITY
            } else {
                (group_volume / SMALLER_ANGLE).cbrt().powi(2)
            },
            middle: middle * middle,
            stretched: stretched * stretched,
            far: cheapest(&candidates, tiles, middle).into_iter().map(squared).collect(),
        }
    }

    /// Whether the closed form serves tiles together at all: up to at least as far from their centre as they reach.
    pub(super) fn is_compact(&self) -> bool {
        self.middle >= self.half_size.iter().map(|h| h * h).sum()
    }

    /// The form at each of the points, given by axis in whole vectors. Any, where the point is not a number. The closed form may be `stretched`.
    #[inline(never)]
    pub(super) fn forms<S: Simd>(&self, simd: S, [x, y, z]: [&[f64]; 3], stretched: bool, forms: &mut [f64]) {
        simd.vectorize(
            #[inline(always)]
            || {
                let (last, outer_from) = self.closed_form(stretched);
                let zero = Lanes::<S>::splat(simd, 0.0);
                let middle = Lanes::<S>::splat(simd, f64::from(MIDDLE));
                let outer = Lanes::<S>::splat(simd, f64::from(OUTER));
                let mut steps = [zero; MOST_STEPS];
                for (number, step) in steps.iter_mut().enumerate() {
                    *step = Lanes::<S>::splat(simd, f64::from(FAR + number as Form));
                }
                for (number, forms) in forms.chunks_exact_mut(Lanes::<S>::LEN).enumerate() {
                    let (start, end) = (number * Lanes::<S>::LEN, (number + 1) * Lanes::<S>::LEN);
                    let point = [&x[start..end], &y[start..end], &z[start..end]];
                    let (mut gap, mut distance) = (zero, zero);
                    for (axis, coordinates) in point.into_iter().enumerate() {
                        let offset = ((Lanes::<S>::load(simd, coordinates) - self.centre[axis]) * self.scale).abs();
                        let beyond = (offset - self.half_size[axis]).max(zero);
                        gap = beyond.mul_add(beyond, gap);
                        distance = offset.mul_add(offset, distance);
                    }
                    let reached = gap.at_least(simd, self.near) * distance.at_most(simd, last);
                    let by_radius = distance.where_at_least(self.outer_radius, outer, middle);
                    let mut form = reached * gap.where_at_least(outer_from, outer, by_radius);
                    for (step, (least, _)) in steps.iter().zip(&self.far) {
                        form = distance.where_at_least(*least, *step, form);
                    }
                    let form = distance.where_more(FARTHEST, zero, form);
                    form.store(forms);
                }
            },
        );
    }

    /// Where it ends, and from where its elements are small.
    #[inline(always)]
    fn closed_form(&self, stretched: bool) -> (f64, f64) {
        if stretched { (self.stretched, self.small) } else { (self.middle, self.outer) }
    }

    #[inline(always)]
    fn form(&self, gap: f64, distance: f64, stretched: bool) -> Form {
        let (last, outer) = self.closed_form(stretched);
        let passed = self.far.iter().map(|&(least, _)| u8::from(distance >= least)).sum::<u8>();
        if passed > 0 && distance <= FARTHEST {
            FAR + passed - 1
        } else if gap >= self.near && distance <= last {
            if gap >= outer || distance >= self.outer_radius { OUTER } else { MIDDLE }
        } else {
            NEAR
        }
    }

    /// The last of the forms that occur, but for those to a tolerance.
    pub(super) fn last_form(&self) -> Form {
        FAR + self.far.len() as Form - 1
    }

    /// That of the series which begins nearest.
    pub(super) fn highest_order(&self) -> usize {
        let order = |form: &FarForm| if let FarForm::Series { order } = form { *order } else { 0 };
        self.far.iter().map(|(_, form)| order(form)).max().unwrap_or(0)
    }

    /// What a form from [`FAR`] on is.
    pub(super) fn far(&self, form: Form) -> FarForm {
        self.far[usize::from(form - FAR)].1
    }

    /// The form of all points in a box, if it is certainly the same and not [`NEAR`].
    pub(super) fn form_of_box(&self, low: [f64; 3], high: [f64; 3], stretched: bool) -> Option<Form> {
        let (mut gap, mut widest, mut nearest, mut farthest) = (0.0, 0.0, 0.0, 0.0);
        for axis in 0..3 {
            let [low, high] = [low[axis], high[axis]].map(|c| (c - self.centre[axis]) * self.scale);
            let least = low.max(-high).max(0.0);
            let most = high.max(-low);
            gap += (least - self.half_size[axis]).max(0.0).powi(2);
            widest += (most - self.half_size[axis]).max(0.0).powi(2);
            nearest += least * least;
            farthest += most * most;
        }
        // So much that no point decides differently by round-off.
        let (gap, nearest) = (gap * (1.0 - FORM_MARGIN), nearest * (1.0 - FORM_MARGIN));
        let (widest, farthest) = (widest * (1.0 + FORM_MARGIN), farthest * (1.0 + FORM_MARGIN));
        let (form, other) = (self.form(gap, nearest, stretched), self.form(widest, farthest, stretched));
        (form == other && form != NEAR && farthest <= FARTHEST).then_some(form)
    }
}

/// Where each order of the series begins, given by what `distance` makes of half diagonals.
fn series(distance: impl Fn(f64) -> f64) -> impl Iterator<Item = (f64, FarForm)> {
    MULTIPOLE_ORDERS
        .into_iter()
        .map(move |(order, half_diagonals)| (distance(half_diagonals), FarForm::Series { order }))
}

/// The series of a tile by itself, whose closed form ends at `middle`: an order that takes longer than that does not begin before.
fn far_of_tile(shape: &Shape, middle: f64) -> Vec<(f64, FarForm)> {
    let mut steps: Vec<(f64, FarForm)> = Vec::new();
    for (distance, form) in series(|half_diagonals| half_diagonals * shape.half_diagonal) {
        let distance = if form.cost(1) > ALONE_COST { distance.max(middle) } else { distance };
        // What begins no later is cheaper.
        steps.retain(|(earlier, _)| *earlier < distance);
        steps.push((distance, form));
    }
    steps
}

fn squared((distance, form): (f64, FarForm)) -> (f64, FarForm) {
    (distance * distance, form)
}

/// Of the forms that may be taken from some distances on the cheapest everywhere, and none where the closed form, which ends at `middle`, costs
/// less.
fn cheapest(candidates: &[(f64, FarForm)], tiles: usize, middle: f64) -> Vec<(f64, FarForm)> {
    let mut distances: Vec<f64> = candidates.iter().map(|(least, _)| *least).chain([middle]).collect();
    distances.sort_by(f64::total_cmp);
    let mut steps: Vec<(f64, FarForm)> = Vec::new();
    for distance in distances {
        let usable = candidates.iter().filter(|(least, _)| *least <= distance).map(|(_, form)| *form);
        let Some(best) = usable.min_by(|a, b| a.cost(tiles).total_cmp(&b.cost(tiles))) else { continue };
        let closed_form_is_cheaper = distance < middle && best.cost(tiles) > CLOSED_FORM_COST * tiles as f64;
        if !closed_form_is_cheaper && steps.last().is_none_or(|(_, form)| *form != best) {
            steps.push((distance, best));
        }
    }
    steps
}

/// Lengths of a tile, scaled.
struct Shape {
    largest: f64,
    second: f64,
    half_diagonal: f64,
    /// The mean of the fourth power of the distance from the centre, over that of the half diagonal.
    fourth_moment: f64,
    volume: f64,
}

impl Shape {
    fn of(block: &Block, scale: f64) -> Shape {
        let mut sides = block.size.map(|s| s * scale);
        sides.sort_by(f64::total_cmp);
        let [third, second, largest] = sides;
        let [a, b, c] = sides.map(|s| 0.25 * s * s);
        let square = a + b + c;
        Shape {
            largest,
            second,
            half_diagonal: square.sqrt(),
            fourth_moment: ((a * a + b * b + c * c) / 5.0 + (a * b + b * c + c * a) / 4.5) / (square * square),
            volume: third * second * largest,
        }
    }

    /// A distance from the centre from which on no element has half of 4 pi T beyond [`SMALL_ANGLE`].
    ///
    /// With q the half diagonal over it that is at most the integral of dV / |r - r'|^3 <= V / r^3 (1 + 2 q^2 + m (S - 1 - 6 q^2)), m the fourth moment: the part of
    /// even degree l in r' is at most (l + 1) (l + 2) / 2 (r' / r)^l of 1 / r^3, their sum S over all l where r' is the half diagonal; odd ones cancel, and from
    /// l = 4 on the mean of r'^l is at most m of its largest value.
    fn small_from(&self) -> f64 {
        let bound = |radius: f64| {
            let q = self.half_diagonal / radius;
            let sum = 0.5 * ((1.0 - q).powi(-3) + (1.0 + q).powi(-3));
            self.volume / radius.powi(3) * (1.0 + 2.0 * q * q + self.fourth_moment * (sum - 1.0 - 6.0 * q * q))
        };
        // It is nowhere nearer, and certainly there.
        let mut low = (self.volume / SMALL_ANGLE).cbrt();
        let mut high = low + self.half_diagonal;
        for _ in 0..RADIUS_BISECTIONS {
            let middle = 0.5 * (low + high);
            if middle > self.half_diagonal && bound(middle) <= SMALL_ANGLE {
                high = middle;
            } else {
                low = middle;
            }
        }
        high
    }
}

fn largest(lengths: [f64; 3]) -> f64 {
    lengths.into_iter().fold(0.0, f64::max)
}

/// The power of two that takes a normal number into [1, 2).
pub(super) fn power_of_two_reciprocal(length: f64) -> f64 {
    f64::from_bits((2046 << 52) - (length.to_bits() & (0x7ff << 52)))
}
