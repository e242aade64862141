//! The gradient of one cuboid at points that share a method.

use fearless_simd::prelude::*;
use magsplice_simd::lanes::Lanes;
use magsplice_simd::lanes::Number;

use crate::block::Block;
use crate::closed_form::gradient::{COMPONENTS, GradientTerms};
use crate::closed_form::single_tile::ClosedForm;
use crate::method::MethodRanges;
use crate::series::coefficients::Series;
use crate::series::multipole::{Distant, TruncatedSeries};
use crate::shape::Shape;

/// One cuboid prepared for its gradient in vectors.
pub struct GradientEvaluator<'a> {
    closed_form: ClosedForm,
    terms: GradientTerms,
    distant: &'a Distant,
    series: &'a Series,
    highest_order: usize,
}

/// A method for the gradient in vectors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GradientMethod {
    /// The closed form inside and close to a cuboid, off the planes of its faces.
    Near,
    /// The closed form, in the range of the field's closed form.
    ClosedForm,
    /// The multipole series up to an order in (half diagonal / distance)^2.
    Series(usize),
}

impl<'a> GradientEvaluator<'a> {
    /// Prepares a block with its ranges, moment and series.
    pub fn new(
        block: &Block,
        ranges: &'a MethodRanges,
        distant: &'a Distant,
        series: &'a Series,
    ) -> GradientEvaluator<'a> {
        let form = Shape::new(block, ranges.scale).form();
        GradientEvaluator {
            closed_form: ClosedForm::new(block, ranges.scale, form),
            terms: GradientTerms::from_block(block, ranges.scale, form),
            distant,
            series,
            highest_order: ranges.highest_order(),
        }
    }

    /// Whether the closed form keeps its bound.
    pub fn has_closed_form(&self) -> bool {
        self.terms.has_closed_form()
    }

    /// Whether the closed form keeps its bound inside and close to the cuboid.
    pub fn has_near_form(&self) -> bool {
        self.terms.has_near_form()
    }

    /// The gradient of B in tesla per length, in the frame of the cuboid, at points given by axis
    /// in whole vectors: xx, yy, zz, yz, xz, xy.
    #[inline(never)]
    pub fn gradients<S: Simd>(
        &self,
        simd: S,
        method: GradientMethod,
        [x, y, z]: [&[f64]; 3],
        mut gradients: [&mut [f64]; COMPONENTS],
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                for start in (0..x.len()).step_by(Lanes::<S>::LEN) {
                    let lanes = start..start + Lanes::<S>::LEN;
                    let point = [
                        Lanes::load(simd, &x[lanes.clone()]),
                        Lanes::load(simd, &y[lanes.clone()]),
                        Lanes::load(simd, &z[lanes.clone()]),
                    ];
                    let mut sum = [Lanes::splat(simd, 0.0); COMPONENTS];
                    match method {
                        GradientMethod::Near => {
                            let place = self.closed_form.place(simd, point);
                            let steps = self.closed_form.twice_from_centre(simd, point);
                            self.terms.add(simd, &place, Some(&steps), &mut sum);
                        }
                        GradientMethod::ClosedForm => {
                            let place = self.closed_form.place(simd, point);
                            self.terms.add(simd, &place, None, &mut sum);
                        }
                        GradientMethod::Series(order) => self.add_series(simd, order, point, &mut sum),
                    }
                    for (gradients, component) in gradients.iter_mut().zip(sum) {
                        component.store(&mut gradients[lanes.clone()]);
                    }
                }
            },
        );
    }

    /// Adds the series. The gradient needs one order more than the field.
    #[inline(always)]
    fn add_series<S: Simd>(&self, simd: S, order: usize, point: [Lanes<S>; 3], sum: &mut [Lanes<S>; COMPONENTS]) {
        let order = (order + 1).min(self.highest_order);
        let series = TruncatedSeries { tile: self.distant, series: self.series, order };
        let [x, y, z] = series.differentiated(simd, point);
        let components = [x.slope[0], y.slope[1], z.slope[2], y.slope[2], x.slope[2], x.slope[1]];
        for (sum, component) in sum.iter_mut().zip(components) {
            *sum = *sum + component;
        }
    }
}
