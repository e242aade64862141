//! One cuboid at points that share a method.

use fearless_simd::prelude::*;
use magsplice_simd::lanes::{LanePair, Lanes};
use magsplice_simd::pairwise::{Pairwise, fields_of};
use magsplice_simd::prefetch::Prefetch;

use crate::block::Block;
use crate::closed_form::single_tile::ClosedForm;
use crate::closed_form::terms::Form;
use crate::method::{Method, MethodIndex, MethodRanges};
use crate::series::coefficients::Series;
use crate::series::multipole::{Distant, TruncatedSeries};
use crate::shape::Shape;

/// One cuboid with every method except the scalar kernel.
pub struct Evaluator<'a> {
    ranges: &'a MethodRanges,
    form: Form,
    closed_form: ClosedForm,
    distant: &'a Distant,
    series: &'a Series,
}

impl<'a> Evaluator<'a> {
    /// Prepares a block whose ranges, moment and series are given.
    pub fn new(block: &Block, ranges: &'a MethodRanges, distant: &'a Distant, series: &'a Series) -> Evaluator<'a> {
        let form = Shape::new(block, ranges.scale).form();
        Evaluator { ranges, form, closed_form: ClosedForm::new(block, ranges.scale, form), distant, series }
    }

    /// The ranges of its methods.
    pub fn ranges(&self) -> &MethodRanges {
        self.ranges
    }

    /// mu0 H in tesla, in the frame of the cuboid, at points given by axis. `fields` holds as many
    /// values as there are points, a multiple of [`PAIR`](magsplice_simd::lanes::PAIR). Each pair
    /// of vectors requests memory `ahead`.
    ///
    /// # Panics
    /// If the method is the scalar kernel or an expansion.
    #[inline]
    pub fn fields<S: Simd>(
        &self,
        simd: S,
        method: MethodIndex,
        points: [&[f64]; 3],
        fields: [&mut [f64]; 3],
        ahead: &mut Prefetch,
    ) {
        match self.ranges.method(method) {
            Method::ClosedForm if self.form == Form::Rod => {
                fields_of(simd, &Rod(&self.closed_form), points, fields, ahead);
            }
            Method::ClosedForm => fields_of(simd, &AllElements(&self.closed_form), points, fields, ahead),
            Method::SmallElements => fields_of(simd, &SmallElements(&self.closed_form), points, fields, ahead),
            Method::Series { order } => {
                let series = TruncatedSeries { tile: self.distant, series: self.series, order };
                fields_of(simd, &series, points, fields, ahead);
            }
            Method::Scalar | Method::Expansion { .. } => unreachable!("no method of one cuboid in vectors"),
        }
    }
}

struct AllElements<'a>(&'a ClosedForm);

impl<S: Simd> Pairwise<S> for AllElements<'_> {
    #[inline(always)]
    fn fields(&self, simd: S, points: [[Lanes<S>; 3]; 2]) -> [[Lanes<S>; 3]; 2] {
        let place = self.0.place(simd, side_by_side(points));
        separate(self.0.field(simd, &self.0.ratios(simd, &place)))
    }
}

/// The closed form of a rod.
struct Rod<'a>(&'a ClosedForm);

impl<S: Simd> Pairwise<S> for Rod<'_> {
    #[inline(always)]
    fn fields(&self, simd: S, points: [[Lanes<S>; 3]; 2]) -> [[Lanes<S>; 3]; 2] {
        let place = self.0.place(simd, side_by_side(points));
        separate(self.0.field_of_rod(simd, &place))
    }
}

/// The closed form where all elements are small.
struct SmallElements<'a>(&'a ClosedForm);

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
fn side_by_side<S: Simd>([first, second]: [[Lanes<S>; 3]; 2]) -> [LanePair<S>; 3] {
    [LanePair([first[0], second[0]]), LanePair([first[1], second[1]]), LanePair([first[2], second[2]])]
}

#[inline(always)]
fn separate<S: Simd>([x, y, z]: [LanePair<S>; 3]) -> [[Lanes<S>; 3]; 2] {
    let (LanePair([x, x_2]), LanePair([y, y_2]), LanePair([z, z_2])) = (x, y, z);
    [[x, y, z], [x_2, y_2, z_2]]
}
