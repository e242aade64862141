//! Moments of tiles in regular solid harmonics (docs/physics.md, section 2.8).

use std::any::Any;
use std::cell::RefCell;
use std::f64::consts::PI;
use std::ops::{Add, Mul, Sub};

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use glam::{DMat3, DVec3};
use rustc_hash::FxHashMap;

use super::lanes::{LONGEST_VECTOR, Lanes, Number};

/// A cuboid seen from the centre of an expansion, lengths scaled.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Source {
    pub(super) centre: DVec3,
    /// Half of each side as a vector along it.
    pub(super) half_sides: [DVec3; 3],
    pub(super) polarization_t: DVec3,
}

impl Source {
    /// A cuboid with sides along the columns of `rotation`, or along x, y, z.
    pub(super) fn new(centre: DVec3, size: DVec3, rotation: Option<&DMat3>, polarization_t: DVec3) -> Source {
        let half_sides = [0, 1, 2].map(|axis: usize| {
            let direction = rotation.map_or(DVec3::AXES[axis], |rotation| rotation.col(axis));
            direction * (0.5 * size[axis])
        });
        Source { centre, half_sides, polarization_t }
    }

    fn volume(&self) -> f64 {
        self.half_sides.iter().map(|side| 2.0 * side.length()).product()
    }
}

/// Of the potential as a function of z above and below the centre. That of a flat film is even with J in its plane, and odd with J across.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Parity {
    Neither,
    /// There is no moment with l + m odd,
    Even,
    /// or none with l + m even.
    Odd,
}

/// The moments M of the scalar potential (Eq. P21), by degree l and order m, 0 <= m <= l; those of order -m are (-1)^m times their conjugates.
#[derive(Clone, Debug)]
pub(super) struct Moments(Triangle<f64>);

impl Moments {
    /// All zero, up to `degree`.
    pub(super) fn new(degree: usize) -> Moments {
        Moments(Triangle::new(degree, 0.0))
    }

    /// Of cuboids. The same digits with all instructions.
    pub(super) fn of(level: Level, sources: &[Source], degree: usize) -> Moments {
        Moments::of_each(level, &[sources], degree).pop().expect("one group")
    }

    /// Of groups of cuboids; several take less together than one by one.
    pub(super) fn of_each(level: Level, groups: &[&[Source]], degree: usize) -> Vec<Moments> {
        let mut moments = vec![Moments::new(degree); groups.len()];
        dispatch!(level, simd => add_sources(simd, groups, degree, &mut moments));
        moments.iter_mut().for_each(|moments| moments.0.complete());
        moments
    }

    pub(super) fn degree(&self) -> usize {
        self.0.degree
    }

    /// Real and imaginary part; zero beyond m = l.
    pub(super) fn at(&self, l: usize, m: usize) -> [f64; 2] {
        if m > l { [0.0; 2] } else { self.0.at(l, m) }
    }

    /// Which of them are zero to the last digit.
    pub(super) fn parity(&self) -> Parity {
        let pairs = || (0..=self.degree()).flat_map(|l| (0..=l).map(move |m| (l, m)));
        let are_zero = |odd: usize| pairs().all(|(l, m)| (l + m) % 2 != odd || self.at(l, m) == [0.0; 2]);
        match (are_zero(1), are_zero(0)) {
            (true, _) => Parity::Even,
            (false, true) => Parity::Odd,
            (false, false) => Parity::Neither,
        }
    }

    /// The real and the imaginary parts up to a degree, as [`Moments::place`] has them.
    pub(super) fn parts(&self, degree: usize) -> [&[f64]; 2] {
        let count = row_start(degree + 1);
        [&self.0.re[..count], &self.0.im[..count]]
    }

    /// Where a pair of degree and order is.
    pub(super) fn place(l: usize, m: usize) -> usize {
        row_start(l) + 1 + m
    }

    /// Those of no higher degree.
    pub(super) fn up_to(&self, degree: usize) -> Moments {
        let count = row_start(degree + 1);
        Moments(Triangle { degree, re: self.0.re[..count].to_vec(), im: self.0.im[..count].to_vec() })
    }

    /// Adds other ones of the same degree.
    pub(super) fn add(&mut self, other: &Moments) {
        let Moments(Triangle { re, im, .. }) = self;
        for (own, other) in re.iter_mut().zip(&other.0.re).chain(im.iter_mut().zip(&other.0.im)) {
            *own += other;
        }
    }

    /// The moments about another point, from which that of these is `offset` away: the sum of (offset . grad)^k / k!.
    pub(super) fn moved(&self, offset: DVec3) -> Moments {
        // The moments are those of conjugate harmonics, which are harmonics of the point mirrored in y.
        let offset = Along::Any([offset.x, -offset.y, offset.z]);
        let mut moved = self.0.clone();
        for k in (1..self.degree()).rev() {
            // What is derived k times more need not be known up to the full degree.
            moved.add_derivative(&self.0, offset, 1.0 / k as f64, self.degree() + 1 - k);
        }
        Moments(moved)
    }

    /// Lengths in another unit, `factor` times as many: a moment of degree l is a polarization times length^(l + 2).
    pub(super) fn rescaled(mut self, factor: f64) -> Moments {
        let mut power = factor * factor;
        for l in 0..=self.degree() {
            let row = self.0.row(l);
            for value in self.0.re[row.clone()].iter_mut().chain(&mut self.0.im[row]) {
                *value *= power;
            }
            power *= factor;
        }
        self
    }

    /// At most the field of each degree at distance 1, from 0 on (Eq. P28).
    pub(super) fn powers(&self) -> Vec<f64> {
        let mut root_factorials = vec![1.0];
        for n in 1..=2 * self.degree() {
            root_factorials.push(root_factorials[n - 1] * (n as f64).sqrt());
        }
        let power = |l: usize| {
            let square = |m: usize| {
                let [re, im] = self.at(l, m).map(|part| part * root_factorials[l - m] * root_factorials[l + m]);
                (re * re + im * im) * if m == 0 { 1.0 } else { 2.0 }
            };
            (l + 1) as f64 * (0..=l).map(square).sum::<f64>().sqrt()
        };
        (0..=self.degree()).map(power).collect()
    }
}

/// As many cuboids, and as many of their shapes, at a time as a vector is long. Products are rounded before they are added, and sums are taken in the order
/// of the sources, so that no digit depends on the instructions, nor on which groups are taken together.
#[inline(always)]
fn add_sources<S: Simd>(simd: S, groups: &[&[Source]], degree: usize, moments: &mut [Moments]) {
    let zero = Lanes::<S>::splat(simd, 0.0);
    // What is not written anew is zero in all of them.
    let kept = ROOM.take().and_then(|room| room.downcast::<[Triangle<Lanes<S>>; 3]>().ok());
    let kept = kept.filter(|room| room[0].degree == degree);
    let mut room = kept.unwrap_or_else(|| Box::new([0, 1, 2].map(|_| Triangle::new(degree, zero))));
    let mut waiting: Vec<Dipoles> = Vec::new();
    for (group, sources) in groups.iter().enumerate() {
        let shapes = Shapes::of(sources);
        let own = waiting.len();
        let dipoles = |&half_sides| Dipoles { group, half_sides, moments: Triangle::new(degree, 0.0) };
        waiting.extend(shapes.half_sides.iter().map(dipoles));
        for (sources, shapes) in sources.chunks(Lanes::<S>::LEN).zip(shapes.of_source.chunks(Lanes::<S>::LEN)) {
            let centre = side_by_side(simd, sources, |source| source.centre);
            let moment = side_by_side(simd, sources, |source| source.polarization_t * (source.volume() / (4.0 * PI)));
            let [harmonics, potential, _] = &mut *room;
            harmonics.set_harmonics(centre, zero, Lanes::<S>::splat(simd, 1.0));
            potential.set_derivative(harmonics, Along::Any(moment), degree);
            for (lane, &shape) in shapes.iter().enumerate() {
                waiting[own + shape].moments.add_lane(potential, lane);
            }
        }
        let is_last = group + 1 == groups.len();
        let whole = if is_last { waiting.len() } else { waiting.len() / Lanes::<S>::LEN * Lanes::<S>::LEN };
        for dipoles in waiting[..whole].chunks(Lanes::<S>::LEN) {
            add_spread(simd, &mut room, dipoles, moments);
        }
        waiting.drain(..whole);
    }
    ROOM.set(Some(room));
}

/// Spreads dipoles at the middles of cuboids over these, one shape in each lane.
#[inline(always)]
fn add_spread<S: Simd>(simd: S, room: &mut [Triangle<Lanes<S>>; 3], dipoles: &[Dipoles], moments: &mut [Moments]) {
    let [potential, before, derived] = room;
    potential.set_lanes(simd, dipoles);
    for axis in 0..3 {
        before.re.copy_from_slice(&potential.re);
        before.im.copy_from_slice(&potential.im);
        let half = side_by_side(simd, dipoles, |dipoles| dipoles.half_sides[axis]);
        let is_aligned = |sides: &[DVec3; 3]| sides[axis].abs() == DVec3::AXES[axis] * sides[axis].length();
        let along = match (dipoles.iter().all(|dipoles| is_aligned(&dipoles.half_sides)), axis) {
            (false, _) => Along::Any(half),
            (true, 0) => Along::X(half[0]),
            (true, 1) => Along::Y(half[1]),
            (true, _) => Along::Z(half[2]),
        };
        potential.spread(before, derived, along);
    }
    // The moments are of conjugate harmonics.
    potential.im.iter_mut().for_each(|im| *im = *im * -1.0);
    for (lane, dipoles) in dipoles.iter().enumerate() {
        moments[dipoles.group].0.add_lane(potential, lane);
    }
}

/// The cuboids of one shape in a group, each as a dipole in its middle.
struct Dipoles {
    group: usize,
    half_sides: [DVec3; 3],
    moments: Triangle<f64>,
}

thread_local! {
    /// Three triangles of the vectors last used: 300 kB, too much to be asked of the system for each group of tiles.
    static ROOM: RefCell<Option<Box<dyn Any>>> = const { RefCell::new(None) };
}

/// Which sources have the same sides.
struct Shapes {
    half_sides: Vec<[DVec3; 3]>,
    of_source: Vec<usize>,
}

impl Shapes {
    fn of(sources: &[Source]) -> Shapes {
        let mut known: FxHashMap<[u64; 9], usize> = FxHashMap::default();
        let mut shapes = Shapes { half_sides: Vec::new(), of_source: Vec::new() };
        for source in sources {
            let [x, y, z] = source.half_sides.map(|side| side.to_array().map(f64::to_bits));
            let next = shapes.half_sides.len();
            let shape = *known.entry([x[0], x[1], x[2], y[0], y[1], y[2], z[0], z[1], z[2]]).or_insert(next);
            if shape == next {
                shapes.half_sides.push(source.half_sides);
            }
            shapes.of_source.push(shape);
        }
        shapes
    }
}

/// A vector of each of some things, one thing in each lane; zero in the lanes that are left.
#[inline(always)]
fn side_by_side<S: Simd, T>(simd: S, things: &[T], vector: impl Fn(&T) -> DVec3) -> [Lanes<S>; 3] {
    let mut values = [[0.0; LONGEST_VECTOR]; 3];
    for (lane, thing) in things.iter().enumerate() {
        for (values, value) in values.iter_mut().zip(vector(thing).to_array()) {
            values[lane] = value;
        }
    }
    let [x, y, z] = &values;
    let len = Lanes::<S>::LEN;
    [Lanes::load(simd, &x[..len]), Lanes::load(simd, &y[..len]), Lanes::load(simd, &z[..len])]
}

/// What harmonics are computed with: a double, or one for each of several tiles.
pub(crate) trait Scalar:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Mul<f64, Output = Self>
{
}

impl<T: Copy + Add<Output = T> + Sub<Output = T> + Mul<Output = T> + Mul<f64, Output = T>> Scalar for T {}

/// A vector along which something is derived; those along an axis take less.
#[derive(Clone, Copy)]
pub(crate) enum Along<N> {
    X(N),
    Y(N),
    Z(N),
    Any([N; 3]),
}

/// Complex numbers by degree l and order m. Rows have room for the orders -1, l + 1 and l + 2, so that all three neighbours in the row before exist.
#[derive(Clone, Debug)]
pub(crate) struct Triangle<N> {
    degree: usize,
    re: Vec<N>,
    im: Vec<N>,
}

impl<N: Scalar> Triangle<N> {
    #[inline(always)]
    pub(crate) fn new(degree: usize, zero: N) -> Triangle<N> {
        let count = row_start(degree + 1);
        Triangle { degree, re: vec![zero; count], im: vec![zero; count] }
    }

    #[inline(always)]
    fn place(&self, l: usize, m: usize) -> usize {
        Moments::place(l, m)
    }

    fn row(&self, l: usize) -> std::ops::Range<usize> {
        row_start(l)..row_start(l + 1)
    }

    #[inline(always)]
    fn at(&self, l: usize, m: usize) -> [N; 2] {
        let place = self.place(l, m);
        [self.re[place], self.im[place]]
    }

    #[inline(always)]
    fn set(&mut self, l: usize, m: usize, [re, im]: [N; 2]) {
        let place = self.place(l, m);
        (self.re[place], self.im[place]) = (re, im);
    }

    /// The number of order -1 from that of order 1.
    #[inline(always)]
    fn complete_row(&mut self, l: usize) {
        let [re, im] = self.at(l, 1);
        let start = row_start(l);
        (self.re[start], self.im[start]) = (re * -1.0, im);
    }

    fn complete(&mut self) {
        (0..=self.degree).for_each(|l| self.complete_row(l));
    }

    /// The harmonics R at a point.
    #[inline(always)]
    pub(crate) fn set_harmonics(&mut self, [x, y, z]: [N; 3], zero: N, one: N) {
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
    pub(crate) fn derivative(&self, along: Along<N>, l: usize, m: usize) -> [N; 2] {
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
    fn set_derivative(&mut self, other: &Triangle<N>, along: Along<N>, degree: usize) {
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
    fn add_derivative(&mut self, before: &Triangle<N>, along: Along<N>, factor: f64, degree: usize) {
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
    fn spread(&mut self, before: &Triangle<N>, derived: &mut Triangle<N>, half: Along<N>) {
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
    fn add_lane<S: Simd>(&mut self, lanes: &Triangle<Lanes<S>>, lane: usize) {
        let parts = self.re.iter_mut().zip(&lanes.re).chain(self.im.iter_mut().zip(&lanes.im));
        parts.for_each(|(own, lanes)| *own += lanes.lane(lane));
    }
}

impl<S: Simd> Triangle<Lanes<S>> {
    /// Becomes as many as there are lanes, side by side.
    #[inline(always)]
    fn set_lanes(&mut self, simd: S, dipoles: &[Dipoles]) {
        let mut values = [[0.0; LONGEST_VECTOR]; 2];
        for place in 0..self.re.len() {
            for (lane, Dipoles { moments, .. }) in dipoles.iter().enumerate() {
                (values[0][lane], values[1][lane]) = (moments.re[place], moments.im[place]);
            }
            self.re[place] = Lanes::<S>::load(simd, &values[0][..Lanes::<S>::LEN]);
            self.im[place] = Lanes::<S>::load(simd, &values[1][..Lanes::<S>::LEN]);
        }
    }
}

/// Where the row of a degree begins.
#[inline(always)]
fn row_start(l: usize) -> usize {
    l * (l + 7) / 2
}
