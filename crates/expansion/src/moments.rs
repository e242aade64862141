//! Moments of cuboids in regular solid harmonics: P2M and M2M (docs/physics.md, sections 2.8 and
//! 5.2).

use std::any::Any;
use std::cell::RefCell;
use std::f64::consts::PI;

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use glam::DVec3;
use magsplice_simd::lanes::{LONGEST_VECTOR, Lanes, Number};
use rustc_hash::FxHashMap;

use crate::source::CuboidSource;
use crate::triangle::{DerivativeVector, HarmonicTriangle, row_start, triangle_index};

/// Parity of a potential in z, relative to the centre of its expansion.
///
/// The potential of a flat film is even if J is in its plane, and odd if J is normal to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parity {
    /// Neither even nor odd.
    Neither,
    /// Even: all moments with l + m odd are zero.
    Even,
    /// Odd: all moments with l + m even are zero.
    Odd,
}

/// Moments M_lm of the scalar potential (Eq. P21), by degree l and order m, 0 <= m <= l.
///
/// Moments of order -m are (-1)^m times the conjugates of the moments of order m. A moment of
/// degree l is in tesla times length^(l + 2).
#[derive(Clone, Debug)]
pub struct Moments(HarmonicTriangle<f64>);

impl Moments {
    /// Moments up to `degree`, all zero.
    pub fn new(degree: usize) -> Moments {
        Moments(HarmonicTriangle::new(degree, 0.0))
    }

    /// Moments of cuboids up to `degree` (P2M); bit-identical for all instruction sets.
    pub fn from_sources(level: Level, sources: &[CuboidSource], degree: usize) -> Moments {
        Moments::from_groups(level, &[sources], degree).pop().expect("one group")
    }

    /// Moments of each group of cuboids up to `degree` (P2M); bit-identical to
    /// [`Moments::from_sources`] of each group, and faster.
    pub fn from_groups(level: Level, groups: &[&[CuboidSource]], degree: usize) -> Vec<Moments> {
        let mut moments = vec![Moments::new(degree); groups.len()];
        dispatch!(level, simd => add_sources(simd, groups, degree, &mut moments));
        moments.iter_mut().for_each(|moments| moments.0.complete());
        moments
    }

    /// Highest degree.
    pub fn degree(&self) -> usize {
        self.0.degree
    }

    /// Real and imaginary part of a moment; zero for m > l.
    pub fn at(&self, l: usize, m: usize) -> [f64; 2] {
        if m > l { [0.0; 2] } else { self.0.at(l, m) }
    }

    /// The parity, derived from moments that are exactly zero.
    pub fn parity(&self) -> Parity {
        let pairs = || (0..=self.degree()).flat_map(|l| (0..=l).map(move |m| (l, m)));
        let are_zero = |odd: usize| pairs().all(|(l, m)| (l + m) % 2 != odd || self.at(l, m) == [0.0; 2]);
        match (are_zero(1), are_zero(0)) {
            (true, _) => Parity::Even,
            (false, true) => Parity::Odd,
            (false, false) => Parity::Neither,
        }
    }

    /// Real and imaginary parts up to a degree, at [`Moments::index`].
    pub fn parts(&self, degree: usize) -> [&[f64]; 2] {
        let count = row_start(degree + 1);
        [&self.0.re[..count], &self.0.im[..count]]
    }

    /// Index of degree l and order m in [`Moments::parts`].
    pub fn index(l: usize, m: usize) -> usize {
        triangle_index(l, m)
    }

    /// The moments up to a lower degree.
    pub fn truncated(&self, degree: usize) -> Moments {
        let count = row_start(degree + 1);
        Moments(HarmonicTriangle { degree, re: self.0.re[..count].to_vec(), im: self.0.im[..count].to_vec() })
    }

    /// Adds moments about the same centre, of the same degree.
    pub fn add(&mut self, other: &Moments) {
        let Moments(HarmonicTriangle { re, im, .. }) = self;
        for (own, other) in re.iter_mut().zip(&other.0.re).chain(im.iter_mut().zip(&other.0.im)) {
            *own += other;
        }
    }

    /// The moments about another centre (M2M, Eq. P27). `offset` is the vector from the new centre
    /// to the old centre.
    pub fn translated(&self, offset: DVec3) -> Moments {
        // Moments belong to conjugate harmonics, the harmonics of the point mirrored in y.
        let offset = DerivativeVector::Any([offset.x, -offset.y, offset.z]);
        let mut translated = self.0.clone();
        for k in (1..self.degree()).rev() {
            // Terms still to be differentiated are not needed up to the full degree.
            translated.add_derivative(&self.0, offset, 1.0 / k as f64, self.degree() + 1 - k);
        }
        Moments(translated)
    }

    /// The moments of the potential's derivatives along x and y, up to the same degree.
    pub fn slopes(&self) -> [Moments; 2] {
        // Sources that move by a step change the potential by minus its derivative. Moments belong
        // to conjugate harmonics, the harmonics of the point mirrored in y.
        [DerivativeVector::X(-1.0), DerivativeVector::Y(1.0)].map(|along| {
            let mut slope = Moments::new(self.degree());
            slope.0.set_derivative(&self.0, along, self.degree());
            slope
        })
    }

    /// The moments with all lengths multiplied by `factor`.
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

    /// Upper bound of the field of each degree at distance 1, in tesla, from degree 0 on: q_l of
    /// Eq. P28.
    pub fn field_bounds(&self) -> Vec<f64> {
        let mut root_factorials = vec![1.0];
        for n in 1..=2 * self.degree() {
            root_factorials.push(root_factorials[n - 1] * (n as f64).sqrt());
        }
        let bound = |l: usize| {
            let square = |m: usize| {
                let [re, im] = self.at(l, m).map(|part| part * root_factorials[l - m] * root_factorials[l + m]);
                (re * re + im * im) * if m == 0 { 1.0 } else { 2.0 }
            };
            (l + 1) as f64 * (0..=l).map(square).sum::<f64>().sqrt()
        };
        (0..=self.degree()).map(bound).collect()
    }
}

/// Adds the moments of each group of cuboids, except moments of order -1.
///
/// A vector holds one cuboid in each lane, and after that one shape in each lane. Products are
/// rounded before they are added, and sums follow the order of the sources, so the result does not
/// depend on the instruction set or on the other groups.
#[inline(always)]
fn add_sources<S: Simd>(simd: S, groups: &[&[CuboidSource]], degree: usize, moments: &mut [Moments]) {
    let zero = Lanes::<S>::splat(simd, 0.0);
    // Entries that are not overwritten are zero in all buffers.
    let kept = BUFFERS.take().and_then(|buffers| buffers.downcast::<[HarmonicTriangle<Lanes<S>>; 3]>().ok());
    let kept = kept.filter(|buffers| buffers[0].degree == degree);
    let mut buffers = kept.unwrap_or_else(|| Box::new([0, 1, 2].map(|_| HarmonicTriangle::new(degree, zero))));
    let mut waiting: Vec<ShapeDipoles> = Vec::new();
    for (group, sources) in groups.iter().enumerate() {
        let shapes = SourceShapes::new(sources);
        let own = waiting.len();
        let dipoles = |&half_sides| ShapeDipoles { group, half_sides, moments: HarmonicTriangle::new(degree, 0.0) };
        waiting.extend(shapes.half_sides.iter().map(dipoles));
        for (sources, shapes) in sources.chunks(Lanes::<S>::LEN).zip(shapes.shape_of_source.chunks(Lanes::<S>::LEN)) {
            let centre = vectors_in_lanes(simd, sources, |source| source.centre);
            let dipole =
                vectors_in_lanes(simd, sources, |source| source.polarization_t * (source.volume() / (4.0 * PI)));
            let [harmonics, potential, _] = &mut *buffers;
            harmonics.set_harmonics(centre, zero, Lanes::<S>::splat(simd, 1.0));
            potential.set_derivative(harmonics, DerivativeVector::Any(dipole), degree);
            for (lane, &shape) in shapes.iter().enumerate() {
                waiting[own + shape].moments.add_lane(potential, lane);
            }
        }
        let is_last = group + 1 == groups.len();
        let whole = if is_last { waiting.len() } else { waiting.len() / Lanes::<S>::LEN * Lanes::<S>::LEN };
        for dipoles in waiting[..whole].chunks(Lanes::<S>::LEN) {
            spread_dipoles(simd, &mut buffers, dipoles, moments);
        }
        waiting.drain(..whole);
    }
    BUFFERS.set(Some(buffers));
}

/// Spreads dipoles at the centres of cuboids over the cuboids, one shape in each lane, and adds
/// their moments.
#[inline(always)]
fn spread_dipoles<S: Simd>(
    simd: S,
    buffers: &mut [HarmonicTriangle<Lanes<S>>; 3],
    dipoles: &[ShapeDipoles],
    moments: &mut [Moments],
) {
    let [potential, before, derived] = buffers;
    let triangles: Vec<&HarmonicTriangle<f64>> = dipoles.iter().map(|dipoles| &dipoles.moments).collect();
    potential.set_lanes(simd, &triangles);
    for axis in 0..3 {
        before.re.copy_from_slice(&potential.re);
        before.im.copy_from_slice(&potential.im);
        let half = vectors_in_lanes(simd, dipoles, |dipoles| dipoles.half_sides[axis]);
        let is_aligned = |sides: &[DVec3; 3]| sides[axis].abs() == DVec3::AXES[axis] * sides[axis].length();
        let half = match (dipoles.iter().all(|dipoles| is_aligned(&dipoles.half_sides)), axis) {
            (false, _) => DerivativeVector::Any(half),
            (true, 0) => DerivativeVector::X(half[0]),
            (true, 1) => DerivativeVector::Y(half[1]),
            (true, _) => DerivativeVector::Z(half[2]),
        };
        potential.set_mean_over_bar(before, derived, half);
    }
    // Moments belong to conjugate harmonics.
    potential.im.iter_mut().for_each(|im| *im = *im * -1.0);
    for (lane, dipoles) in dipoles.iter().enumerate() {
        moments[dipoles.group].0.add_lane(potential, lane);
    }
}

/// Moments of the cuboids of one shape in a group, each replaced by a dipole at its centre.
struct ShapeDipoles {
    group: usize,
    half_sides: [DVec3; 3],
    moments: HarmonicTriangle<f64>,
}

thread_local! {
    /// Three triangles in vectors of the instruction set last used. They take 300 kB, too much for
    /// an allocation per group.
    static BUFFERS: RefCell<Option<Box<dyn Any>>> = const { RefCell::new(None) };
}

/// The distinct shapes of cuboids, and the shape of each.
struct SourceShapes {
    half_sides: Vec<[DVec3; 3]>,
    shape_of_source: Vec<usize>,
}

impl SourceShapes {
    fn new(sources: &[CuboidSource]) -> SourceShapes {
        let mut known: FxHashMap<[u64; 9], usize> = FxHashMap::default();
        let mut shapes = SourceShapes { half_sides: Vec::new(), shape_of_source: Vec::new() };
        for source in sources {
            let [x, y, z] = source.half_sides.map(|side| side.to_array().map(f64::to_bits));
            let next = shapes.half_sides.len();
            let shape = *known.entry([x[0], x[1], x[2], y[0], y[1], y[2], z[0], z[1], z[2]]).or_insert(next);
            if shape == next {
                shapes.half_sides.push(source.half_sides);
            }
            shapes.shape_of_source.push(shape);
        }
        shapes
    }
}

/// Components of one vector of each item, one item in each lane; zero in unused lanes.
#[inline(always)]
fn vectors_in_lanes<S: Simd, T>(simd: S, items: &[T], vector: impl Fn(&T) -> DVec3) -> [Lanes<S>; 3] {
    let mut values = [[0.0; LONGEST_VECTOR]; 3];
    for (lane, item) in items.iter().enumerate() {
        for (values, value) in values.iter_mut().zip(vector(item).to_array()) {
            values[lane] = value;
        }
    }
    let [x, y, z] = &values;
    let len = Lanes::<S>::LEN;
    [Lanes::load(simd, &x[..len]), Lanes::load(simd, &y[..len]), Lanes::load(simd, &z[..len])]
}
