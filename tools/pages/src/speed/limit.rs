//! The smallest possible time of the processor for the operations of the closed form.

use std::hint::black_box;
use std::time::Instant;

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch};
use glam::DVec3;
use magsplice::field::{InstructionSet, Quantity, Scene};
use magsplice_benches::{median, shipped_layout, working_volume};

use super::effort::SpeedEffort;

/// Square roots for one vector of points on the published film, counted in the source.
///
/// The 56 tiles merge into 48 cuboids with 22 planes and 192 corners. They have 96 off-diagonal and
/// 48 diagonal elements in 23 groups of equal strength.
pub(crate) const ROOTS: f64 = 192.0;
/// Number of divisions.
pub(crate) const DIVISIONS: f64 = 23.0;
/// Number of additions, multiplications and multiply-adds: 4 for a plane, 2 for a corner, 8 for a
/// cuboid, 21 for an off-diagonal element, 45 for a diagonal element, 35 for a group.
pub(crate) const OTHERS: f64 = 22.0 * 4.0 + 192.0 * 2.0 + 48.0 * 8.0 + 96.0 * 21.0 + 48.0 * 45.0 + 23.0 * 35.0;
const TILES: f64 = 56.0;

/// Times of vector operations, and of the published film.
pub(crate) struct ProcessorLimit {
    /// The best instruction set of the processor.
    pub(crate) set: InstructionSet,
    /// Doubles in a vector.
    pub(crate) lanes: usize,
    /// Nanoseconds of one independent vector operation.
    pub(crate) root_ns: f64,
    pub(crate) division_ns: f64,
    pub(crate) multiply_add_ns: f64,
    /// Nanoseconds for a tile and a point of the published film.
    pub(crate) measured_ns: f64,
}

impl ProcessorLimit {
    /// Smallest possible nanoseconds for a tile and a point. Roots and divisions share a unit of
    /// the processor; multiply-adds run beside it.
    pub(crate) fn least_ns(&self) -> f64 {
        let slow = ROOTS * self.root_ns + DIVISIONS * self.division_ns;
        slow.max(OTHERS * self.multiply_add_ns) / (TILES * self.lanes as f64)
    }
}

#[derive(Clone, Copy)]
enum VectorOperation {
    Root,
    Division,
    MultiplyAdd,
}

/// Sums sixteen independent chains of operations, so that their latency does not count.
#[inline(always)]
fn chains<S: Simd>(simd: S, operation: VectorOperation, turns: usize) -> (f64, usize) {
    let factor = S::f64s::splat(simd, black_box(0.999));
    let mut values = [S::f64s::splat(simd, black_box(1.7)); 16];
    for _ in 0..turns {
        for value in &mut values {
            *value = match operation {
                VectorOperation::Root => value.sqrt(),
                VectorOperation::Division => factor / *value,
                VectorOperation::MultiplyAdd => value.mul_add(factor, factor),
            };
        }
    }
    let mut sum = values[0];
    for value in values {
        sum += value;
    }
    (sum[0], S::f64s::LEN)
}

pub(crate) fn measure(effort: SpeedEffort) -> ProcessorLimit {
    let turns = effort.pairs / 16;
    let level = Level::new();
    let time = |operation: VectorOperation| {
        let run = || {
            let start = Instant::now();
            black_box(dispatch!(level, simd => chains(simd, operation, turns)));
            1e9 * start.elapsed().as_secs_f64() / (16 * turns) as f64
        };
        median(std::iter::repeat_with(run).take(effort.runs).collect())
    };
    let tiles = shipped_layout("published-film").bare_tiles();
    let scene = Scene::new(&tiles);
    let points: Vec<DVec3> = working_volume([81, 81, 41]).points().take(effort.pairs / tiles.len()).collect();
    let mut field = vec![DVec3::ZERO; points.len()];
    let mut film = || {
        let start = Instant::now();
        scene.field_into(Quantity::FluxDensity, black_box(&points), &mut field).expect("bounded");
        1e9 * start.elapsed().as_secs_f64() / (points.len() * tiles.len()) as f64
    };
    ProcessorLimit {
        set: InstructionSet::available()[0],
        lanes: dispatch!(level, simd => chains(simd, VectorOperation::MultiplyAdd, 1)).1,
        root_ns: time(VectorOperation::Root),
        division_ns: time(VectorOperation::Division),
        multiply_add_ns: time(VectorOperation::MultiplyAdd),
        measured_ns: median((0..effort.runs).map(|_| film()).collect()),
    }
}
