//! A tile by itself at points as they lie, in runs that one form serves.

use fearless_simd::{Level, dispatch};

use magsplice_cuboid::evaluator::Evaluator;
use magsplice_cuboid::method::{MethodIndex, MethodRanges, SCALAR};
use magsplice_simd::column::{Column, room, views};
use magsplice_simd::lanes::PAIR;
use magsplice_simd::prefetch::Ahead;

use super::sorted_points::METHODS;
use crate::tolerances::MIXED_SHARE;

/// Points of a batch that lie together, whole pairs of vectors, and a form of a tile that serves all of them, or some.
#[derive(Clone, Debug)]
struct Run {
    form: MethodIndex,
    range: std::ops::Range<usize>,
    /// Whether some have another form.
    mixed: bool,
}

/// The runs of a batch; nothing in them grows with the number of tiles.
#[derive(Debug, Default)]
pub(super) struct Runs {
    runs: Vec<Run>,
    forms: Column,
}

impl Runs {
    /// One that holds all `count` points.
    pub(super) fn set_all(&mut self, form: MethodIndex, count: usize) {
        self.runs.clear();
        self.runs.push(Run { form, range: 0..count, mixed: false });
    }

    /// Divides points, given by axis in whole pairs of vectors. Returns whether that is worth while.
    pub(super) fn divide(
        &mut self,
        level: Level,
        ranges: &MethodRanges,
        points: &[Column; 3],
        stretched: bool,
    ) -> bool {
        let count = points[0].len();
        self.runs.clear();
        self.forms.set_len(count);
        dispatch!(level, simd => ranges.methods(simd, views(points), stretched, &mut self.forms));
        let most_mixed = count / PAIR / MIXED_SHARE;
        let mut mixed = 0;
        for (number, forms) in self.forms.chunks_exact(PAIR).enumerate() {
            let (start, end) = (number * PAIR, (number + 1) * PAIR);
            let form = forms[0] as MethodIndex;
            if forms.iter().fold(true, |all, other| all & (*other == forms[0])) {
                match self.runs.last_mut() {
                    Some(last) if last.form == form && !last.mixed => last.range.end = end,
                    _ => self.runs.push(Run { form, range: start..end, mixed: false }),
                }
                continue;
            }
            mixed += 1;
            if mixed > most_mixed {
                return false;
            }
            let present = forms.iter().fold(0_u64, |present, form| present | 1 << (*form as u64));
            let forms = (0..METHODS as MethodIndex).filter(|form| present >> form & 1 == 1);
            self.runs.extend(forms.map(|form| Run { form, range: start..end, mixed: true }));
        }
        true
    }

    /// mu0 H of `tile`, in its frame, at the same points; zero at those beside it, which are added to `near`.
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
        for Run { form, range, mixed: is_mixed } in &self.runs {
            let is_served = |index: &usize| !is_mixed || self.forms[*index] == f64::from(*form);
            if *form == SCALAR {
                near.extend(range.clone().filter(is_served).map(|index| index as u32));
                fields.iter_mut().for_each(|values| values[range.clone()].fill(0.0));
                continue;
            }
            let [x, y, z] = points.each_ref().map(|axis| &axis[range.clone()]);
            let served = if *is_mixed {
                mixed.each_mut().map(|axis| &mut axis[..])
            } else {
                fields.each_mut().map(|axis| &mut axis[range.clone()])
            };
            dispatch!(level, simd => tile.fields(simd, *form, [x, y, z], served, &mut Ahead::nothing()));
            if *is_mixed {
                for (values, mixed) in fields.iter_mut().zip(&mixed) {
                    for (index, value) in range.clone().zip(mixed).filter(|(index, _)| is_served(index)) {
                        values[index] = *value;
                    }
                }
            }
        }
    }
}
