//! One cuboid at points that share a method.

use fearless_simd::prelude::*;
use magsplice_simd::functions::Functions;
use magsplice_simd::lanes::{LanePair, Lanes};
use magsplice_simd::pairwise::{Pairwise, each_pair, fields_of};
use magsplice_simd::prefetch::Prefetch;

use crate::block::Block;
use crate::closed_form::elements::{CornerGeometry, ElementSum};
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
    /// Prepares a block with its ranges, moment and series.
    pub fn new(block: &Block, ranges: &'a MethodRanges, distant: &'a Distant, series: &'a Series) -> Evaluator<'a> {
        let form = Shape::new(block, ranges.scale).form();
        Evaluator { ranges, form, closed_form: ClosedForm::new(block, ranges.scale, form), distant, series }
    }

    /// The ranges of the methods.
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
            Method::Series { order } => {
                let series = TruncatedSeries { tile: self.distant, series: self.series, order };
                fields_of(simd, &series, points, fields, ahead);
            }
            _ => self.closed_form(simd, method, points, fields, None, ahead),
        }
    }

    /// [`Evaluator::fields`] of the closed form, with an upper bound of the sum over k of
    /// |T e_k| |J_k| in tesla for each point.
    ///
    /// # Panics
    /// If the method is not a closed form.
    #[inline]
    pub fn fields_and_magnitudes<S: Simd>(
        &self,
        simd: S,
        method: MethodIndex,
        points: [&[f64]; 3],
        fields: [&mut [f64]; 3],
        magnitudes_t: &mut [f64],
        ahead: &mut Prefetch,
    ) {
        self.closed_form(simd, method, points, fields, Some(magnitudes_t), ahead);
    }

    #[inline(always)]
    fn closed_form<S: Simd>(
        &self,
        simd: S,
        method: MethodIndex,
        points: [&[f64]; 3],
        fields: [&mut [f64]; 3],
        magnitudes_t: Option<&mut [f64]>,
        ahead: &mut Prefetch,
    ) {
        let closed_form = &self.closed_form;
        match self.ranges.method(method) {
            Method::ClosedForm if self.form == Form::Rod => {
                evaluate(simd, &Elements::<OF_ROD>(closed_form), points, fields, magnitudes_t, ahead);
            }
            Method::ClosedForm => {
                evaluate(simd, &Elements::<ALL>(closed_form), points, fields, magnitudes_t, ahead);
            }
            Method::SmallElements => {
                evaluate(simd, &Elements::<SMALL>(closed_form), points, fields, magnitudes_t, ahead);
            }
            other => unreachable!("{other:?} is no closed form in vectors"),
        }
    }
}

/// Elements of a cuboid that is not a rod.
const ALL: u8 = 0;
/// Elements of a rod.
const OF_ROD: u8 = 1;
/// Elements that are all at most `SMALL_ANGLE`.
const SMALL: u8 = 2;

/// The closed form of a cuboid with the elements [`ALL`], [`OF_ROD`] or [`SMALL`].
struct Elements<'a, const WHICH: u8>(&'a ClosedForm);

impl<const WHICH: u8> Elements<'_, WHICH> {
    #[inline(always)]
    fn add<N: Functions>(&self, simd: N::Instructions, place: &CornerGeometry<N>, sum: &mut impl ElementSum<N>) {
        match WHICH {
            OF_ROD => self.0.add_divided(simd, &self.0.ratios_of_rod(simd, place), sum),
            SMALL => self.0.add_small_elements(simd, &self.0.ratios(simd, place), sum),
            _ => self.0.add_elements(simd, &self.0.ratios(simd, place), sum),
        }
    }

    #[inline(always)]
    fn fields_and_magnitudes_t<S: Simd>(
        &self,
        simd: S,
        points: [[Lanes<S>; 3]; 2],
    ) -> ([[Lanes<S>; 3]; 2], [Lanes<S>; 2]) {
        let place = self.0.place(simd, side_by_side(points));
        let mut sum = self.0.field_and_magnitude(simd);
        self.add(simd, &place, &mut sum);
        let LanePair(magnitudes_t) = sum.magnitude_t();
        (separate(sum.field.field_t), magnitudes_t)
    }
}

impl<S: Simd, const WHICH: u8> Pairwise<S> for Elements<'_, WHICH> {
    #[inline(always)]
    fn fields(&self, simd: S, points: [[Lanes<S>; 3]; 2]) -> [[Lanes<S>; 3]; 2] {
        let place = self.0.place(simd, side_by_side(points));
        let mut sum = self.0.field_sum(simd);
        self.add(simd, &place, &mut sum);
        separate(sum.field_t)
    }
}

#[inline(always)]
fn evaluate<S: Simd, const WHICH: u8>(
    simd: S,
    elements: &Elements<WHICH>,
    points: [&[f64]; 3],
    fields: [&mut [f64]; 3],
    magnitudes_t: Option<&mut [f64]>,
    ahead: &mut Prefetch,
) {
    match magnitudes_t {
        None => fields_of(simd, elements, points, fields, ahead),
        Some(magnitudes_t) => with_magnitudes(simd, elements, points, fields, magnitudes_t, ahead),
    }
}

/// Writes the field and the bound of its magnitude.
#[inline(never)]
fn with_magnitudes<S: Simd, const WHICH: u8>(
    simd: S,
    elements: &Elements<WHICH>,
    points: [&[f64]; 3],
    fields: [&mut [f64]; 3],
    magnitudes_t: &mut [f64],
    ahead: &mut Prefetch,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            each_pair(
                simd,
                #[inline(always)]
                |start, pair| {
                    ahead.request();
                    let (fields, [first, second]) = elements.fields_and_magnitudes_t(simd, pair);
                    let (low, high) = magnitudes_t[start..start + 2 * Lanes::<S>::LEN].split_at_mut(Lanes::<S>::LEN);
                    first.store(low);
                    second.store(high);
                    fields
                },
                points,
                fields,
            );
        },
    );
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
