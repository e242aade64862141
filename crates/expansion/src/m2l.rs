//! Expansions of many nodes far from a batch of points added up as one expansion around the batch, several nodes at a time (docs/physics.md, section 5.2).

use std::any::Any;
use std::cell::RefCell;
use std::sync::LazyLock;

use fearless_simd::prelude::*;
use glam::DVec3;
use magsplice_simd::lanes::{LONGEST_VECTOR, Lanes, Number};

use crate::local::{LocalExpansion, place};
use crate::moments::Moments;
use crate::tolerances::{HIGHEST_DEGREE, HIGHEST_LOCAL_DEGREE};

/// The highest degree of potentials on both sides.
const MOST: usize = if HIGHEST_DEGREE > HIGHEST_LOCAL_DEGREE { HIGHEST_DEGREE } else { HIGHEST_LOCAL_DEGREE + 1 };

/// Outputs that are summed at the same time; where fewer are left the others are zero, and written where nothing is read.
const BLOCK: usize = 4;

/// A node that is translated.
#[derive(Clone, Copy)]
pub struct M2lInput<'a> {
    pub moments: &'a Moments,
    /// The degree up to which they are taken.
    pub degree: usize,
    /// The degree of the field around the new centre.
    pub local_degree: usize,
    /// To the new centre, in the unit of the moments.
    pub offset: DVec3,
    /// That unit over the one of the local expansion.
    pub unit: f64,
}

/// (l - m)! (l + m)! under the root, row after row of equal degree.
static NORMS: LazyLock<Vec<f64>> = LazyLock::new(|| {
    let mut root_factorials = vec![1.0];
    for n in 1..=2 * MOST {
        root_factorials.push(root_factorials[n - 1] * (n as f64).sqrt());
    }
    let pairs = (0..=MOST).flat_map(|l| (0..=l).map(move |m| (l, m)));
    pairs.map(|(l, m)| root_factorials[l - m] * root_factorials[l + m]).collect()
});

/// That of a pair, by which moments are multiplied and coefficients of local expansions divided: rotations then keep the sum of squares of a degree.
fn norm(l: usize, m: usize) -> f64 {
    NORMS[place(l, m)]
}

/// What a degree's coefficients become when x and z change places (Eq. P36), of the real and of the imaginary parts.
static EXCHANGES: LazyLock<Vec<[XzExchange; 2]>> = LazyLock::new(exchanges);

/// Half of an exchange's factors are zero: those of even orders go to even ones, or all to odd ones.
struct XzExchange {
    /// By the parity of the order that goes in: block after block of the orders that come out, what each gets from one that goes in after the other.
    factors: [Vec<[f64; BLOCK]>; 2],
}

/// From degree to degree in whole numbers, 2^l times as large, so that no digit is lost.
fn exchanges() -> Vec<[XzExchange; 2]> {
    let mut last: Vec<Vec<i128>> = vec![vec![1]];
    let mut exchanges = Vec::new();
    for degree in 0..=MOST {
        if degree > 0 {
            last = next_exchange(&last);
        }
        let scale = 0.5_f64.powi(degree as i32);
        let factor = |part: usize, m: usize, to: usize| {
            let sign = if m.is_multiple_of(2) == (part == 0) { 1 } else { -1 };
            let other = if m == 0 { 0 } else { sign * last[degree - m][to] };
            (last[degree + m][to] + other) as f64 * (norm(degree, m) / norm(degree, to) * scale)
        };
        let factor = &factor;
        exchanges.push([0, 1].map(|part| XzExchange {
            factors: [0, 1].map(|parity| {
                let inputs = || (first(part, parity)..=degree).step_by(2);
                let blocks = (first_out(degree, part, parity)..=degree).step_by(2 * BLOCK);
                let known = move |m: usize, to: usize| if to <= degree { factor(part, m, to) } else { 0.0 };
                let from = move |m: usize, block: usize| std::array::from_fn(|k| known(m, block + 2 * k));
                blocks.flat_map(|block| inputs().map(move |m| from(m, block))).collect()
            }),
        }));
    }
    exchanges
}

/// Orders from -l to l go in, orders from 0 to l come out.
fn next_exchange(last: &[Vec<i128>]) -> Vec<Vec<i128>> {
    let before = (last.len() / 2) as isize;
    let degree = before + 1;
    let at = |m: isize, to: isize| {
        if m.abs() > before || to > before { 0 } else { last[(m + before) as usize][to as usize] }
    };
    let new = |m: isize, to: isize| {
        if to < degree {
            at(m - 1, to) - at(m + 1, to)
        } else {
            2 * at(m, to - 1) + at(m + 1, to - 1) + at(m - 1, to - 1)
        }
    };
    (-degree..=degree).map(|m| (0..=degree).map(|to| new(m, to)).collect()).collect()
}

/// The lowest order of a parity; imaginary parts of order 0 are zero.
fn first(part: usize, parity: usize) -> usize {
    if part == 1 && parity == 0 { 2 } else { parity }
}

/// The lowest order that those of a parity go to.
fn first_out(degree: usize, part: usize, parity: usize) -> usize {
    first(part, (parity + degree + part) % 2)
}

/// What moments become along the z axis (Eq. P35), (-1)^(n + m) (l + n)! over the norms of both: by order, block after block of the degrees that come out, each degree that
/// goes in.
static ALONG: LazyLock<Vec<Vec<[f64; BLOCK]>>> = LazyLock::new(|| {
    let binomial = {
        let mut rows = vec![vec![1.0]];
        for n in 1..=2 * MOST {
            let last: &Vec<f64> = &rows[n - 1];
            let at = |k: usize| if k < last.len() { last[k] } else { 0.0 };
            rows.push((0..=n).map(|k| at(k) + if k > 0 { at(k - 1) } else { 0.0 }).collect());
        }
        rows
    };
    let factor = |l: usize, n: usize, m: usize| {
        // (l + n)! / norms = the root of two binomials: (l + n)! / (l - m)! (n + m)! and with -m.
        let size = (binomial[l + n][l - m] * binomial[l + n][l + m]).sqrt();
        if (n + m).is_multiple_of(2) { size } else { -size }
    };
    let factor = &factor;
    let order = |m: usize| {
        let highest = HIGHEST_LOCAL_DEGREE + 1;
        let blocks = (m.max(1)..=highest).step_by(BLOCK);
        let known = move |l: usize, n: usize| if n <= highest { factor(l, n, m) } else { 0.0 };
        let from = move |l: usize, block: usize| std::array::from_fn(|k| known(l, block + k));
        blocks.flat_map(|block| (m.max(1)..=HIGHEST_DEGREE).map(move |l| from(l, block))).collect()
    };
    (0..=HIGHEST_DEGREE.min(HIGHEST_LOCAL_DEGREE + 1)).map(order).collect()
});

/// Orders of one parity, with room for what fills a block.
const ORDERS: usize = MOST / 2 + 1 + BLOCK;

/// One degree: real and imaginary parts, of each the even orders and the odd ones.
type Row<S> = [[[Lanes<S>; ORDERS]; 2]; 2];

/// Room for the nodes that are translated at a time.
struct Room<S: Simd> {
    /// Moments as they come; real and imaginary parts, as [`Moments::place`] has them.
    moments: [Vec<Lanes<S>>; 2],
    /// The same turned.
    sources: [Vec<Lanes<S>>; 2],
    /// What they become around the new centres.
    targets: [Vec<Lanes<S>>; 2],
    /// The sum over nodes, one in each lane.
    sums: [Vec<Lanes<S>>; 2],
}

thread_local! {
    /// That of the instruction set last used: 200 kB.
    static ROOM: RefCell<Option<Box<dyn Any>>> = const { RefCell::new(None) };
}

/// The field of nodes around a centre, up to `degree`. Those that need nearly the same degrees should follow each other.
#[inline(always)]
pub fn translate<S: Simd>(simd: S, inputs: &[M2lInput], degree: usize, centre: DVec3, scale: f64) -> LocalExpansion {
    let zero = Lanes::<S>::splat(simd, 0.0);
    let mut room: Box<Room<S>> = ROOM.take().and_then(|room| room.downcast().ok()).unwrap_or_else(|| {
        let empty = || [0, 1].map(|_| vec![zero; place(MOST + 1, 0)]);
        let moments = [0, 1].map(|_| vec![zero; Moments::place(MOST + 1, 0).next_multiple_of(LONGEST_VECTOR)]);
        Box::new(Room { moments, sources: empty(), targets: empty(), sums: empty() })
    });
    for sums in &mut room.sums {
        sums[..place(degree + 2, 0)].fill(zero);
    }
    for inputs in inputs.chunks(Lanes::<S>::LEN) {
        room.add(simd, inputs);
    }
    let count = place(degree + 2, 0);
    let mut potential = room.sums.each_ref().map(|sums| lane_sums(&sums[..count]));
    for part in &mut potential {
        part.iter_mut().zip(&*NORMS).for_each(|(sum, norm)| *sum *= norm);
    }
    let local = LocalExpansion::new(degree, centre, scale, potential.each_ref().map(|part| &part[..]));
    ROOM.set(Some(room));
    local
}

impl<S: Simd> Room<S> {
    /// One node in each lane.
    #[inline(always)]
    fn add(&mut self, simd: S, inputs: &[M2lInput]) {
        let zero = Lanes::<S>::splat(simd, 0.0);
        let degree = inputs.iter().map(|input| input.degree).max().unwrap_or(0);
        let local_degree = inputs.iter().map(|input| input.local_degree).max().unwrap_or(0);
        let [over, fall] = lanes_of(simd, inputs, |input| {
            let over = 1.0 / input.offset.length();
            [over, over / input.unit]
        });
        // Turned about z so that the new centre lies above the y axis, and after the exchange so that it lies on the x axis.
        let turns = lanes_of(simd, inputs, |input| {
            let DVec3 { x, y, z } = input.offset;
            let (across, distance) = (x.hypot(y), input.offset.length());
            let [cos, sin] = if across > 0.0 { [y / across, -x / across] } else { [1.0, 0.0] };
            [cos, sin, z / distance, across / distance]
        });
        let most = degree.max(local_degree + 1);
        let about = [powers(simd, [turns[0], turns[1]], most), powers(simd, [turns[2], turns[3]], most)];
        let (mut row, mut exchanged): (Row<S>, Row<S>) = ([[[zero; ORDERS]; 2]; 2], [[[zero; ORDERS]; 2]; 2]);
        self.set_moments(simd, inputs, degree);
        let mut power = over * over;
        for l in 1..=degree {
            power = power * over;
            let norms = &NORMS[place(l, 0)..=place(l, l)];
            for (row, moments) in row.iter_mut().zip(&self.moments) {
                let moments = &moments[Moments::place(l, 0)..=Moments::place(l, l)];
                for (m, (moment, norm)) in moments.iter().zip(norms).enumerate() {
                    row[m % 2][m / 2] = *moment * power * *norm;
                }
            }
            rotate_z(&mut row, &about[0], l, 1.0);
            exchange_xz(simd, l, &row, &mut exchanged);
            rotate_z(&mut exchanged, &about[1], l, 1.0);
            exchange_xz(simd, l, &exchanged, &mut row);
            for (kept, row) in self.sources.iter_mut().zip(&row) {
                for (m, kept) in kept[place(l, 0)..=place(l, l)].iter_mut().enumerate() {
                    *kept = row[m % 2][m / 2];
                }
            }
        }
        for m in 0..=local_degree + 1 {
            self.along(simd, m, degree, local_degree);
        }
        let mut power = Lanes::<S>::splat(simd, 1.0);
        for n in 1..=local_degree + 1 {
            for (row, targets) in row.iter_mut().zip(&self.targets) {
                for (m, target) in targets[place(n, 0)..=place(n, n)].iter().enumerate() {
                    row[m % 2][m / 2] = *target;
                }
            }
            exchange_xz(simd, n, &row, &mut exchanged);
            rotate_z(&mut exchanged, &about[1], n, -1.0);
            exchange_xz(simd, n, &exchanged, &mut row);
            rotate_z(&mut row, &about[0], n, -1.0);
            for (sums, row) in self.sums.iter_mut().zip(&row) {
                for (m, sum) in sums[place(n, 0)..=place(n, n)].iter_mut().enumerate() {
                    *sum = row[m % 2][m / 2].mul_add(power, *sum);
                }
            }
            power = power * fall;
        }
    }

    /// Zero where a node has no such degree, and in lanes that are left.
    #[inline(always)]
    fn set_moments(&mut self, simd: S, inputs: &[M2lInput], degree: usize) {
        let len = Lanes::<S>::LEN;
        for (part, room) in self.moments.iter_mut().enumerate() {
            let mut parts: [&[f64]; LONGEST_VECTOR] = [&[]; LONGEST_VECTOR];
            for (own, input) in parts.iter_mut().zip(inputs) {
                *own = input.moments.parts(input.degree)[part];
            }
            for (number, room) in
                room.chunks_exact_mut(len).take(Moments::place(degree + 1, 0).div_ceil(len)).enumerate()
            {
                let mut nodes = [Lanes::<S>::splat(simd, 0.0); LONGEST_VECTOR];
                for (node, part) in nodes.iter_mut().zip(parts) {
                    *node = Lanes::load_some(simd, part.get(number * len..).unwrap_or_default());
                }
                room.copy_from_slice(&Lanes::transposed(nodes)[..len]);
            }
        }
    }

    /// An order of all degrees that come out from that of all degrees of the nodes.
    #[inline(always)]
    fn along(&mut self, simd: S, m: usize, degree: usize, local_degree: usize) {
        let from = m.max(1);
        let blocks = (local_degree + 2 - from).div_ceil(BLOCK);
        for (block, factors) in ALONG[m].chunks_exact(HIGHEST_DEGREE + 1 - from).take(blocks).enumerate() {
            let mut sums = [[Lanes::<S>::splat(simd, 0.0); 2]; BLOCK];
            for (l, factors) in (from..=degree).zip(factors) {
                let (re, im) = (self.sources[0][place(l, m)], self.sources[1][place(l, m)]);
                for (sum, factor) in sums.iter_mut().zip(factors) {
                    *sum = [re.scale_add(*factor, sum[0]), im.scale_add(*factor, sum[1])];
                }
            }
            for (k, [re, im]) in sums.into_iter().enumerate() {
                let at = place(from + BLOCK * block + k, m);
                (self.targets[0][at], self.targets[1][at]) = (re, im);
            }
        }
    }
}

/// The sum of the lanes of each.
#[inline(always)]
fn lane_sums<S: Simd>(vectors: &[Lanes<S>]) -> Vec<f64> {
    let len = Lanes::<S>::LEN;
    let mut sums = vec![0.0; vectors.len().next_multiple_of(len)];
    for (sums, vectors) in sums.chunks_exact_mut(len).zip(vectors.chunks(len)) {
        let mut some = [vectors[0]; LONGEST_VECTOR];
        some[..vectors.len()].copy_from_slice(vectors);
        let lanes = Lanes::transposed(some);
        let mut sum = lanes[0];
        for lane in &lanes[1..len] {
            sum = sum + *lane;
        }
        sum.store(sums);
    }
    sums
}

/// Times a power of the phases by order, or of their conjugates.
#[inline(always)]
fn rotate_z<S: Simd>([re, im]: &mut Row<S>, [cos, sin]: &Row<S>, l: usize, sign: f64) {
    for parity in 0..2 {
        let orders = 0..(l + 2 - parity) / 2;
        let own = re[parity][orders.clone()].iter_mut().zip(&mut im[parity][orders.clone()]);
        for ((re, im), (cos, sin)) in own.zip(cos[parity][orders.clone()].iter().zip(&sin[parity][orders])) {
            let sin = *sin * sign;
            (*re, *im) = (re.mul_sub(*cos, *im * sin), re.mul_add(sin, *im * *cos));
        }
    }
}

/// Of a number on the unit circle.
#[inline(always)]
fn powers<S: Simd>(simd: S, [cos, sin]: [Lanes<S>; 2], most: usize) -> Row<S> {
    let (zero, one) = (Lanes::<S>::splat(simd, 0.0), Lanes::<S>::splat(simd, 1.0));
    let mut powers = [[[one; ORDERS]; 2], [[zero; ORDERS]; 2]];
    let (mut re, mut im) = (one, zero);
    for m in 1..=most {
        (re, im) = (re.mul_sub(cos, im * sin), re.mul_add(sin, im * cos));
        (powers[0][m % 2][m / 2], powers[1][m % 2][m / 2]) = (re, im);
    }
    powers
}

/// x and z change places.
#[inline(always)]
fn exchange_xz<S: Simd>(simd: S, l: usize, row: &Row<S>, to: &mut Row<S>) {
    to[1][0][0] = Lanes::splat(simd, 0.0);
    for (part, (row, to)) in row.iter().zip(to).enumerate() {
        for (parity, row) in row.iter().enumerate() {
            let (from, into) = (first(part, parity), first_out(l, part, parity));
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

/// Numbers of each node side by side, those of the first where there are fewer nodes than lanes.
#[inline(always)]
fn lanes_of<S: Simd, const N: usize>(
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
