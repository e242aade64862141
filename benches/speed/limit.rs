//! What the processor would need for the operations of the closed form alone.

use std::hint::black_box;
use std::time::Instant;

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch};
use glam::DVec3;
use magsplice::field::{InstructionSet, Quantity, Scene};
use magsplice_benches::{median, shipped_layout, working_volume};

use crate::Effort;

/// Operations for one vector of points on the published film, counted in the source: 48 cuboids stand for its 56 tiles, with 22 planes, 192 corners, 96
/// elements off the diagonal and 48 on it, in 23 groups.
pub(crate) const ROOTS: f64 = 192.0;
pub(crate) const DIVISIONS: f64 = 23.0;
/// 4 for a plane, 2 for a corner, 8 for a cuboid, 21 and 45 for an element off and on the diagonal, 35 for a group.
pub(crate) const OTHERS: f64 = 22.0 * 4.0 + 192.0 * 2.0 + 48.0 * 8.0 + 96.0 * 21.0 + 48.0 * 45.0 + 23.0 * 35.0;
pub(crate) const TILES: f64 = 56.0;

pub(crate) struct Limit {
    pub(crate) set: InstructionSet,
    pub(crate) lanes: usize,
    /// Nanoseconds of one vector operation where nothing waits for another.
    pub(crate) root_ns: f64,
    pub(crate) division_ns: f64,
    pub(crate) multiply_add_ns: f64,
    /// What a tile and a point of the film take.
    pub(crate) measured_ns: f64,
}

impl Limit {
    /// Roots and divisions share a unit; multiply-adds go on beside it.
    pub(crate) fn least_ns(&self) -> f64 {
        let slow = ROOTS * self.root_ns + DIVISIONS * self.division_ns;
        slow.max(OTHERS * self.multiply_add_ns) / (TILES * self.lanes as f64)
    }
}

#[derive(Clone, Copy)]
enum Operation {
    Root,
    Division,
    MultiplyAdd,
}

/// Sixteen chains, so that latency does not count.
#[inline(always)]
fn chains<S: Simd>(simd: S, operation: Operation, turns: usize) -> (f64, usize) {
    let factor = S::f64s::splat(simd, black_box(0.999));
    let mut values = [S::f64s::splat(simd, black_box(1.7)); 16];
    for _ in 0..turns {
        for value in &mut values {
            *value = match operation {
                Operation::Root => value.sqrt(),
                Operation::Division => factor / *value,
                Operation::MultiplyAdd => value.mul_add(factor, factor),
            };
        }
    }
    let mut sum = values[0];
    for value in values {
        sum += value;
    }
    (sum[0], S::f64s::LEN)
}

pub(crate) fn measure(effort: Effort) -> Limit {
    let turns = effort.pairs / 16;
    let level = Level::new();
    let time = |operation: Operation| {
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
    Limit {
        set: InstructionSet::available()[0],
        lanes: dispatch!(level, simd => chains(simd, Operation::MultiplyAdd, 1)).1,
        root_ns: time(Operation::Root),
        division_ns: time(Operation::Division),
        multiply_add_ns: time(Operation::MultiplyAdd),
        measured_ns: median((0..effort.runs).map(|_| film()).collect()),
    }
}
