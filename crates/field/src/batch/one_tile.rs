//! One tile by itself at points that have the same form.

use fearless_simd::prelude::*;

use super::ahead::Ahead;
use super::alone::Alone;
use super::lanes::{Lanes, Two};
use super::multipole::{Distant, Distributed};
use super::pairwise::{Pairwise, fields_of};
use super::range::{FarForm, Form, MIDDLE, NEAR, OUTER, Range};
use super::series::Series;
use crate::arrangement::Frame;

/// That of a tile's shape, `made` if it is not kept.
pub(super) fn series<'a>(frame: &'a Frame, index: usize, made: &'a mut Option<Series>) -> &'a Series {
    let (block, range) = (&frame.blocks[index], &frame.table.tiles[index].range);
    frame.table.series(index).unwrap_or_else(|| made.insert(Series::of(block.size, range.highest_order())))
}

/// A tile in all its forms but the one for points beside it.
pub(super) struct OneTile<'a> {
    range: &'a Range,
    alone: Alone,
    distant: &'a Distant,
    series: &'a Series,
}

impl<'a> OneTile<'a> {
    /// The series of its shape is `made` if it is not kept.
    pub(super) fn of(frame: &'a Frame, index: usize, made: &'a mut Option<Series>) -> OneTile<'a> {
        let (block, tile) = (&frame.blocks[index], &frame.table.tiles[index]);
        OneTile {
            range: &tile.range,
            alone: Alone::of(block, tile.range.scale),
            distant: &tile.far,
            series: series(frame, index, made),
        }
    }

    /// Where its forms serve.
    pub(super) fn range(&self) -> &Range {
        self.range
    }

    /// mu0 H, in the tile's frame, at points given by axis. As many values as there are points, a multiple of [`PAIR`](super::lanes::PAIR).
    /// Each pair of vectors asks for memory `ahead`.
    pub(super) fn fields<S: Simd>(
        &self,
        simd: S,
        form: Form,
        points: [&[f64]; 3],
        fields: [&mut [f64]; 3],
        ahead: &mut Ahead,
    ) {
        match form {
            NEAR => unreachable!("points beside a tile have no form of this kind"),
            MIDDLE => fields_of(simd, &ClosedForm(&self.alone), points, fields, ahead),
            OUTER => fields_of(simd, &SmallElements(&self.alone), points, fields, ahead),
            _ => {
                let FarForm::Series { order } = self.range.far(form) else {
                    unreachable!("a tile by itself has a series only")
                };
                let what = Distributed { tile: self.distant, series: self.series, order };
                fields_of(simd, &what, points, fields, ahead);
            }
        }
    }
}

struct ClosedForm<'a>(&'a Alone);

impl<S: Simd> Pairwise<S> for ClosedForm<'_> {
    #[inline(always)]
    fn fields(&self, simd: S, points: [[Lanes<S>; 3]; 2]) -> [[Lanes<S>; 3]; 2] {
        let place = self.0.place(simd, side_by_side(points));
        separate(self.0.field(simd, &self.0.ratios(simd, &place)))
    }
}

/// The same where all elements are small.
struct SmallElements<'a>(&'a Alone);

impl<S: Simd> Pairwise<S> for SmallElements<'_> {
    #[inline(always)]
    fn fields(&self, simd: S, points: [[Lanes<S>; 3]; 2]) -> [[Lanes<S>; 3]; 2] {
        let place = self.0.place(simd, side_by_side(points));
        let ratios = self.0.ratios(simd, &place);
        let inverse = self.0.common_inverse(simd, &ratios);
        separate(self.0.field_of_small(simd, &ratios, inverse))
    }
}

#[inline(always)]
fn side_by_side<S: Simd>([first, second]: [[Lanes<S>; 3]; 2]) -> [Two<S>; 3] {
    [Two([first[0], second[0]]), Two([first[1], second[1]]), Two([first[2], second[2]])]
}

#[inline(always)]
fn separate<S: Simd>([x, y, z]: [Two<S>; 3]) -> [[Lanes<S>; 3]; 2] {
    let (Two([x, x_2]), Two([y, y_2]), Two([z, z_2])) = (x, y, z);
    [[x, y, z], [x_2, y_2, z_2]]
}
