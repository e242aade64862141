//! A tile by itself at points as they lie, in stretches that one form serves.

use fearless_simd::{Level, dispatch};

use super::ahead::Ahead;
use super::column::{Column, room, views};
use super::lanes::PAIR;
use super::one_tile::OneTile;
use super::range::{FORMS, Form, NEAR, Range};
use crate::tolerances::MIXED_SHARE;

/// Points of a batch that lie together, whole pairs of vectors, and a form of a tile that serves all of them, or some.
#[derive(Clone, Debug)]
struct Stretch {
    form: Form,
    range: std::ops::Range<usize>,
    /// Whether some have another form.
    mixed: bool,
}

/// The stretches of a batch; nothing in them grows with the number of tiles.
#[derive(Debug, Default)]
pub(super) struct Stretches {
    stretches: Vec<Stretch>,
    forms: Column,
}

impl Stretches {
    /// One that holds all `count` points.
    pub(super) fn set_all(&mut self, form: Form, count: usize) {
        self.stretches.clear();
        self.stretches.push(Stretch { form, range: 0..count, mixed: false });
    }

    /// Divides points, given by axis in whole pairs of vectors. Returns whether that is worth while.
    pub(super) fn divide(&mut self, level: Level, range: &Range, points: &[Column; 3], stretched: bool) -> bool {
        let count = points[0].len();
        self.stretches.clear();
        self.forms.set_len(count);
        dispatch!(level, simd => range.forms(simd, views(points), stretched, &mut self.forms));
        let most_mixed = count / PAIR / MIXED_SHARE;
        let mut mixed = 0;
        for (number, forms) in self.forms.chunks_exact(PAIR).enumerate() {
            let (start, end) = (number * PAIR, (number + 1) * PAIR);
            let form = forms[0] as Form;
            if forms.iter().fold(true, |all, other| all & (*other == forms[0])) {
                match self.stretches.last_mut() {
                    Some(last) if last.form == form && !last.mixed => last.range.end = end,
                    _ => self.stretches.push(Stretch { form, range: start..end, mixed: false }),
                }
                continue;
            }
            mixed += 1;
            if mixed > most_mixed {
                return false;
            }
            let present = forms.iter().fold(0_u64, |present, form| present | 1 << (*form as u64));
            let forms = (0..FORMS as Form).filter(|form| present >> form & 1 == 1);
            self.stretches.extend(forms.map(|form| Stretch { form, range: start..end, mixed: true }));
        }
        true
    }

    /// mu0 H of `tile`, in its frame, at the same points; zero at those beside it, which are added to `near`.
    pub(super) fn fields(
        &self,
        level: Level,
        tile: &OneTile,
        points: &[Column; 3],
        fields: &mut [Column; 3],
        near: &mut Vec<u32>,
    ) {
        let mut mixed = [[0.0; PAIR]; 3];
        room(fields, points[0].len());
        for Stretch { form, range, mixed: is_mixed } in &self.stretches {
            let is_served = |index: &usize| !is_mixed || self.forms[*index] == f64::from(*form);
            if *form == NEAR {
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
