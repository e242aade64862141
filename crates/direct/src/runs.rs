//! Runs of consecutive points that share a method of a single tile.

use fearless_simd::{Level, dispatch};

use magsplice_cuboid::evaluator::Evaluator;
use magsplice_cuboid::method::{MethodIndex, MethodRanges, SCALAR};
use magsplice_simd::column::{Column, room, views};
use magsplice_simd::lanes::PAIR;
use magsplice_simd::prefetch::Prefetch;

use super::sorted_points::METHODS;
use crate::tolerances::MIXED_SHARE;

/// Consecutive points of a batch, in whole pairs of vectors, and the method of all or some of them.
#[derive(Clone, Debug)]
struct Run {
    method: MethodIndex,
    range: std::ops::Range<usize>,
    /// Whether some points have another method.
    mixed: bool,
}

/// The runs of a batch. Their buffers do not grow with the number of tiles.
#[derive(Debug, Default)]
pub(super) struct Runs {
    runs: Vec<Run>,
    methods: Column,
}

impl Runs {
    /// Makes one run of all `count` points.
    pub(super) fn set_all(&mut self, method: MethodIndex, count: usize) {
        self.runs.clear();
        self.runs.push(Run { method, range: 0..count, mixed: false });
    }

    /// Divides points, given by axis in whole pairs of vectors, into runs. Returns whether runs are
    /// worthwhile.
    pub(super) fn divide(
        &mut self,
        level: Level,
        ranges: &MethodRanges,
        points: &[Column; 3],
        stretched: bool,
    ) -> bool {
        let count = points[0].len();
        self.runs.clear();
        self.methods.set_len(count);
        dispatch!(level, simd => ranges.methods(simd, views(points), stretched, &mut self.methods));
        let most_mixed = count / PAIR / MIXED_SHARE;
        let mut mixed = 0;
        for (number, methods) in self.methods.chunks_exact(PAIR).enumerate() {
            let (start, end) = (number * PAIR, (number + 1) * PAIR);
            let method = methods[0] as MethodIndex;
            if methods.iter().fold(true, |all, other| all & (*other == methods[0])) {
                match self.runs.last_mut() {
                    Some(last) if last.method == method && !last.mixed => last.range.end = end,
                    _ => self.runs.push(Run { method, range: start..end, mixed: false }),
                }
                continue;
            }
            mixed += 1;
            if mixed > most_mixed {
                return false;
            }
            let present = methods.iter().fold(0_u64, |present, method| present | 1 << (*method as u64));
            let methods = (0..METHODS as MethodIndex).filter(|method| present >> method & 1 == 1);
            self.runs.extend(methods.map(|method| Run { method, range: start..end, mixed: true }));
        }
        true
    }

    /// mu0 H of `tile` in tesla, in its frame, at the same points. It is zero at points of the
    /// scalar method, which are appended to `near`.
    pub(super) fn fields(
        &self,
        level: Level,
        tile: &Evaluator,
        points: &[Column; 3],
        fields: &mut [Column; 3],
        near: &mut Vec<u32>,
    ) {
        let mut mixed = [[0.0; PAIR]; 3];
        room(fields, points[0].len());
        for Run { method, range, mixed: is_mixed } in &self.runs {
            let has_method = |index: &usize| !is_mixed || self.methods[*index] == f64::from(*method);
            if *method == SCALAR {
                near.extend(range.clone().filter(has_method).map(|index| index as u32));
                fields.iter_mut().for_each(|values| values[range.clone()].fill(0.0));
                continue;
            }
            let [x, y, z] = points.each_ref().map(|axis| &axis[range.clone()]);
            let served = if *is_mixed {
                mixed.each_mut().map(|axis| &mut axis[..])
            } else {
                fields.each_mut().map(|axis| &mut axis[range.clone()])
            };
            dispatch!(level, simd => tile.fields(simd, *method, [x, y, z], served, &mut Prefetch::nothing()));
            if *is_mixed {
                for (values, mixed) in fields.iter_mut().zip(&mixed) {
                    for (index, value) in range.clone().zip(mixed).filter(|(index, _)| has_method(index)) {
                        values[index] = *value;
                    }
                }
            }
        }
    }
}
