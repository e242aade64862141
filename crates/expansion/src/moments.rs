//! Moments of tiles in regular solid harmonics (docs/physics.md, section 2.8).

use std::any::Any;
use std::cell::RefCell;
use std::f64::consts::PI;

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use glam::DVec3;
use magsplice_simd::lanes::{LONGEST_VECTOR, Lanes, Number};
use rustc_hash::FxHashMap;

use crate::source::Source;
use crate::triangle::{Along, Triangle, place, row_start};

/// Of the potential as a function of z above and below the centre. That of a flat film is even with J in its plane, and odd with J across.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parity {
    Neither,
    /// There is no moment with l + m odd,
    Even,
    /// or none with l + m even.
    Odd,
}

/// The moments M of the scalar potential (Eq. P21), by degree l and order m, 0 <= m <= l; those of order -m are (-1)^m times their conjugates.
#[derive(Clone, Debug)]
pub struct Moments(Triangle<f64>);

impl Moments {
    /// All zero, up to `degree`.
    pub fn new(degree: usize) -> Moments {
        Moments(Triangle::new(degree, 0.0))
    }

    /// Of cuboids. The same digits with all instructions.
    pub fn from_sources(level: Level, sources: &[Source], degree: usize) -> Moments {
        Moments::from_groups(level, &[sources], degree).pop().expect("one group")
    }

    /// Of groups of cuboids; several take less together than one by one.
    pub fn from_groups(level: Level, groups: &[&[Source]], degree: usize) -> Vec<Moments> {
        let mut moments = vec![Moments::new(degree); groups.len()];
        dispatch!(level, simd => add_sources(simd, groups, degree, &mut moments));
        moments.iter_mut().for_each(|moments| moments.0.complete());
        moments
    }

    pub fn degree(&self) -> usize {
        self.0.degree
    }

    /// Real and imaginary part; zero beyond m = l.
    pub fn at(&self, l: usize, m: usize) -> [f64; 2] {
        if m > l { [0.0; 2] } else { self.0.at(l, m) }
    }

    /// Which of them are zero to the last digit.
    pub fn parity(&self) -> Parity {
        let pairs = || (0..=self.degree()).flat_map(|l| (0..=l).map(move |m| (l, m)));
        let are_zero = |odd: usize| pairs().all(|(l, m)| (l + m) % 2 != odd || self.at(l, m) == [0.0; 2]);
        match (are_zero(1), are_zero(0)) {
            (true, _) => Parity::Even,
            (false, true) => Parity::Odd,
            (false, false) => Parity::Neither,
        }
    }

    /// The real and the imaginary parts up to a degree, as [`Moments::place`] has them.
    pub fn parts(&self, degree: usize) -> [&[f64]; 2] {
        let count = row_start(degree + 1);
        [&self.0.re[..count], &self.0.im[..count]]
    }

    /// Where a pair of degree and order is.
    pub fn place(l: usize, m: usize) -> usize {
        place(l, m)
    }

    /// Those of no higher degree.
    pub fn up_to(&self, degree: usize) -> Moments {
        let count = row_start(degree + 1);
        Moments(Triangle { degree, re: self.0.re[..count].to_vec(), im: self.0.im[..count].to_vec() })
    }

    /// Adds other ones of the same degree.
    pub fn add(&mut self, other: &Moments) {
        let Moments(Triangle { re, im, .. }) = self;
        for (own, other) in re.iter_mut().zip(&other.0.re).chain(im.iter_mut().zip(&other.0.im)) {
            *own += other;
        }
    }

    /// The moments about another point, from which that of these is `offset` away: the sum of (offset . grad)^k / k!.
    pub fn moved(&self, offset: DVec3) -> Moments {
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
    pub fn rescaled(mut self, factor: f64) -> Moments {
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
    pub fn powers(&self) -> Vec<f64> {
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
    let triangles: Vec<&Triangle<f64>> = dipoles.iter().map(|dipoles| &dipoles.moments).collect();
    potential.set_lanes(simd, &triangles);
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
