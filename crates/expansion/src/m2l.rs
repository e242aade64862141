//! The M2L operator: translates multipole expansions of distant nodes to one local expansion around
//! a batch of points (docs/physics.md, section 5.2).
//!
//! Each translation rotates the moments until the new centre is on the z axis, translates along z,
//! and rotates back. A vector holds one node in each lane.

use std::any::Any;
use std::cell::RefCell;

use fearless_simd::prelude::*;
use glam::DVec3;
use magsplice_simd::lanes::{LONGEST_VECTOR, Lanes, Number};

use crate::local::{LocalExpansion, local_index};
use crate::m2l_factors::{
    BLOCK, EXCHANGES, HIGHEST_POTENTIAL_DEGREE, NORMS, Z_TRANSLATIONS, lowest_input_order, lowest_output_order,
};
use crate::moments::Moments;
use crate::tolerances::HIGHEST_DEGREE;

/// One multipole expansion to be translated.
#[derive(Clone, Copy)]
pub struct M2lInput<'a> {
    /// Moments about the centre of the node.
    pub moments: &'a Moments,
    /// Highest translated degree of the moments.
    pub degree: usize,
    /// Degree of the field of the local expansion.
    pub local_degree: usize,
    /// Vector from the centre of the node to the centre of the local expansion, in the unit of the
    /// moments.
    pub offset: DVec3,
    /// Unit of length of the moments over the unit of length of the local expansion.
    pub unit_ratio: f64,
}

/// Number of orders of one parity, rounded up to whole blocks.
const ORDERS: usize = HIGHEST_POTENTIAL_DEGREE / 2 + 1 + BLOCK;

/// Coefficients of one degree: real and imaginary parts, each by the parity of the order.
type DegreeRow<S> = [[[Lanes<S>; ORDERS]; 2]; 2];

/// Buffers for the nodes translated at the same time. Each holds real and imaginary parts.
struct M2lBuffers<S: Simd> {
    /// Moments, at [`Moments::index`].
    moments: [Vec<Lanes<S>>; 2],
    /// Moments after rotation, at [`local_index`].
    sources: [Vec<Lanes<S>>; 2],
    /// Coefficients around the new centres before they are rotated back.
    targets: [Vec<Lanes<S>>; 2],
    /// Coefficients of the local expansion, summed over the nodes of each lane.
    sums: [Vec<Lanes<S>>; 2],
}

thread_local! {
    /// Buffers of the instruction set last used, 200 kB.
    static BUFFERS: RefCell<Option<Box<dyn Any>>> = const { RefCell::new(None) };
}

/// The local expansion of many nodes around `centre`, up to `degree` of the field.
///
/// Nodes translated at the same time use the highest of their degrees, so nodes with nearly equal
/// degrees should follow each other. Lengths of the local expansion are multiplied by `scale`.
#[inline(always)]
pub fn translate<S: Simd>(simd: S, inputs: &[M2lInput], degree: usize, centre: DVec3, scale: f64) -> LocalExpansion {
    let zero = Lanes::<S>::splat(simd, 0.0);
    let kept = BUFFERS.take().and_then(|buffers| buffers.downcast().ok());
    let mut buffers: Box<M2lBuffers<S>> = kept.unwrap_or_else(|| {
        let next = HIGHEST_POTENTIAL_DEGREE + 1;
        let empty = || [0, 1].map(|_| vec![zero; local_index(next, 0)]);
        let moments = [0, 1].map(|_| vec![zero; Moments::index(next, 0).next_multiple_of(LONGEST_VECTOR)]);
        Box::new(M2lBuffers { moments, sources: empty(), targets: empty(), sums: empty() })
    });
    for sums in &mut buffers.sums {
        sums[..local_index(degree + 2, 0)].fill(zero);
    }
    for inputs in inputs.chunks(Lanes::<S>::LEN) {
        buffers.add(simd, inputs);
    }
    let count = local_index(degree + 2, 0);
    let mut potential = buffers.sums.each_ref().map(|sums| lane_sums(&sums[..count]));
    for part in &mut potential {
        part.iter_mut().zip(&*NORMS).for_each(|(sum, norm)| *sum *= norm);
    }
    let local = LocalExpansion::new(degree, centre, scale, potential.each_ref().map(|part| &part[..]));
    BUFFERS.set(Some(buffers));
    local
}

impl<S: Simd> M2lBuffers<S> {
    /// Translates one node in each lane, and adds the results to the sums.
    #[inline(always)]
    fn add(&mut self, simd: S, inputs: &[M2lInput]) {
        let zero = Lanes::<S>::splat(simd, 0.0);
        let degree = inputs.iter().map(|input| input.degree).max().unwrap_or(0);
        let local_degree = inputs.iter().map(|input| input.local_degree).max().unwrap_or(0);
        let [over, power_ratio] = numbers_in_lanes(simd, inputs, |input| {
            let over = 1.0 / input.offset.length();
            [over, over / input.unit_ratio]
        });
        // The first rotation about z brings the new centre above the y axis. The second, after the
        // exchange of x and z, brings it onto the x axis.
        let rotations = numbers_in_lanes(simd, inputs, |input| {
            let DVec3 { x, y, z } = input.offset;
            let (across, distance) = (x.hypot(y), input.offset.length());
            let [cos, sin] = if across > 0.0 { [y / across, -x / across] } else { [1.0, 0.0] };
            [cos, sin, z / distance, across / distance]
        });
        let highest = degree.max(local_degree + 1);
        let phases = [
            phase_powers(simd, [rotations[0], rotations[1]], highest),
            phase_powers(simd, [rotations[2], rotations[3]], highest),
        ];
        let (mut row, mut exchanged): (DegreeRow<S>, DegreeRow<S>) =
            ([[[zero; ORDERS]; 2]; 2], [[[zero; ORDERS]; 2]; 2]);
        self.set_moments(simd, inputs, degree);
        let mut power = over * over;
        for l in 1..=degree {
            power = power * over;
            let norms = &NORMS[local_index(l, 0)..=local_index(l, l)];
            for (row, moments) in row.iter_mut().zip(&self.moments) {
                let moments = &moments[Moments::index(l, 0)..=Moments::index(l, l)];
                for (m, (moment, norm)) in moments.iter().zip(norms).enumerate() {
                    row[m % 2][m / 2] = *moment * power * *norm;
                }
            }
            rotate_z(&mut row, &phases[0], l, 1.0);
            exchange_xz(simd, l, &row, &mut exchanged);
            rotate_z(&mut exchanged, &phases[1], l, 1.0);
            exchange_xz(simd, l, &exchanged, &mut row);
            for (kept, row) in self.sources.iter_mut().zip(&row) {
                for (m, kept) in kept[local_index(l, 0)..=local_index(l, l)].iter_mut().enumerate() {
                    *kept = row[m % 2][m / 2];
                }
            }
        }
        for m in 0..=local_degree + 1 {
            self.translate_along_z(simd, m, degree, local_degree);
        }
        let mut power = Lanes::<S>::splat(simd, 1.0);
        for n in 1..=local_degree + 1 {
            for (row, targets) in row.iter_mut().zip(&self.targets) {
                for (m, target) in targets[local_index(n, 0)..=local_index(n, n)].iter().enumerate() {
                    row[m % 2][m / 2] = *target;
                }
            }
            exchange_xz(simd, n, &row, &mut exchanged);
            rotate_z(&mut exchanged, &phases[1], n, -1.0);
            exchange_xz(simd, n, &exchanged, &mut row);
            rotate_z(&mut row, &phases[0], n, -1.0);
            for (sums, row) in self.sums.iter_mut().zip(&row) {
                for (m, sum) in sums[local_index(n, 0)..=local_index(n, n)].iter_mut().enumerate() {
                    *sum = row[m % 2][m / 2].mul_add(power, *sum);
                }
            }
            power = power * power_ratio;
        }
    }

    /// Loads the moments, one node in each lane. Missing degrees of a node and unused lanes are
    /// zero.
    #[inline(always)]
    fn set_moments(&mut self, simd: S, inputs: &[M2lInput], degree: usize) {
        let len = Lanes::<S>::LEN;
        for (part, moments) in self.moments.iter_mut().enumerate() {
            let mut parts: [&[f64]; LONGEST_VECTOR] = [&[]; LONGEST_VECTOR];
            for (own, input) in parts.iter_mut().zip(inputs) {
                *own = input.moments.parts(input.degree)[part];
            }
            for (number, moments) in
                moments.chunks_exact_mut(len).take(Moments::index(degree + 1, 0).div_ceil(len)).enumerate()
            {
                let mut nodes = [Lanes::<S>::splat(simd, 0.0); LONGEST_VECTOR];
                for (node, part) in nodes.iter_mut().zip(parts) {
                    *node = Lanes::load_some(simd, part.get(number * len..).unwrap_or_default());
                }
                moments.copy_from_slice(&Lanes::transposed(nodes)[..len]);
            }
        }
    }

    /// Translates one order of the rotated moments along z (Eq. P35).
    #[inline(always)]
    fn translate_along_z(&mut self, simd: S, m: usize, degree: usize, local_degree: usize) {
        let from = m.max(1);
        let blocks = (local_degree + 2 - from).div_ceil(BLOCK);
        for (block, factors) in Z_TRANSLATIONS[m].chunks_exact(HIGHEST_DEGREE + 1 - from).take(blocks).enumerate() {
            let mut sums = [[Lanes::<S>::splat(simd, 0.0); 2]; BLOCK];
            for (l, factors) in (from..=degree).zip(factors) {
                let (re, im) = (self.sources[0][local_index(l, m)], self.sources[1][local_index(l, m)]);
                for (sum, factor) in sums.iter_mut().zip(factors) {
                    *sum = [re.scale_add(*factor, sum[0]), im.scale_add(*factor, sum[1])];
                }
            }
            for (k, [re, im]) in sums.into_iter().enumerate() {
                let at = local_index(from + BLOCK * block + k, m);
                (self.targets[0][at], self.targets[1][at]) = (re, im);
            }
        }
    }
}

/// The sum of the lanes of each vector.
#[inline(always)]
fn lane_sums<S: Simd>(vectors: &[Lanes<S>]) -> Vec<f64> {
    let len = Lanes::<S>::LEN;
    let mut sums = vec![0.0; vectors.len().next_multiple_of(len)];
    for (sums, vectors) in sums.chunks_exact_mut(len).zip(vectors.chunks(len)) {
        let mut rows = [vectors[0]; LONGEST_VECTOR];
        rows[..vectors.len()].copy_from_slice(vectors);
        let lanes = Lanes::transposed(rows);
        let mut sum = lanes[0];
        for lane in &lanes[1..len] {
            sum = sum + *lane;
        }
        sum.store(sums);
    }
    sums
}

/// Rotates a row about z: multiplies each order by its power of the phase, or for `sign` -1 by the
/// conjugate.
#[inline(always)]
fn rotate_z<S: Simd>([re, im]: &mut DegreeRow<S>, [cos, sin]: &DegreeRow<S>, l: usize, sign: f64) {
    for parity in 0..2 {
        let orders = 0..(l + 2 - parity) / 2;
        let own = re[parity][orders.clone()].iter_mut().zip(&mut im[parity][orders.clone()]);
        for ((re, im), (cos, sin)) in own.zip(cos[parity][orders.clone()].iter().zip(&sin[parity][orders])) {
            let sin = *sin * sign;
            (*re, *im) = (re.mul_sub(*cos, *im * sin), re.mul_add(sin, *im * *cos));
        }
    }
}

/// Powers of a number on the unit circle, up to exponent `highest`.
#[inline(always)]
fn phase_powers<S: Simd>(simd: S, [cos, sin]: [Lanes<S>; 2], highest: usize) -> DegreeRow<S> {
    let (zero, one) = (Lanes::<S>::splat(simd, 0.0), Lanes::<S>::splat(simd, 1.0));
    let mut powers = [[[one; ORDERS]; 2], [[zero; ORDERS]; 2]];
    let (mut re, mut im) = (one, zero);
    for m in 1..=highest {
        (re, im) = (re.mul_sub(cos, im * sin), re.mul_add(sin, im * cos));
        (powers[0][m % 2][m / 2], powers[1][m % 2][m / 2]) = (re, im);
    }
    powers
}

/// Exchanges x and z (Eq. P36).
#[inline(always)]
fn exchange_xz<S: Simd>(simd: S, l: usize, row: &DegreeRow<S>, to: &mut DegreeRow<S>) {
    to[1][0][0] = Lanes::splat(simd, 0.0);
    for (part, (row, to)) in row.iter().zip(to).enumerate() {
        for (parity, row) in row.iter().enumerate() {
            let (from, into) = (lowest_input_order(part, parity), lowest_output_order(l, part, parity));
            if from > l || into > l {
                continue;
            }
            let inputs = &row[from / 2..=(l - parity) / 2];
            let blocks = EXCHANGES[l][part].factors[parity].chunks_exact(inputs.len());
            for (factors, outputs) in blocks.zip(to[into % 2][into / 2..].chunks_exact_mut(BLOCK)) {
                let mut sums = [Lanes::<S>::splat(simd, 0.0); BLOCK];
                for (input, factors) in inputs.iter().zip(factors) {
                    for (sum, factor) in sums.iter_mut().zip(factors) {
                        *sum = input.scale_add(*factor, *sum);
                    }
                }
                outputs.copy_from_slice(&sums);
            }
        }
    }
}

/// Values of the nodes, one node in each lane; unused lanes repeat the first.
#[inline(always)]
fn numbers_in_lanes<S: Simd, const N: usize>(
    simd: S,
    inputs: &[M2lInput],
    numbers: impl Fn(&M2lInput) -> [f64; N],
) -> [Lanes<S>; N] {
    let first = numbers(&inputs[0]);
    let mut values = first.map(|number| [number; LONGEST_VECTOR]);
    for (lane, input) in inputs.iter().enumerate() {
        for (values, number) in values.iter_mut().zip(numbers(input)) {
            values[lane] = number;
        }
    }
    let mut lanes = [Lanes::<S>::splat(simd, 0.0); N];
    for (lanes, values) in lanes.iter_mut().zip(&values) {
        *lanes = Lanes::load(simd, &values[..Lanes::<S>::LEN]);
    }
    lanes
}
