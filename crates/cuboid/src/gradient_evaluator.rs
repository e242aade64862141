//! The gradient of one cuboid at points that share a method.

use std::f64::consts::PI;

use fearless_simd::prelude::*;
use magsplice_simd::compensated_sum::TwoSum;
use magsplice_simd::functions::Functions;
use magsplice_simd::lanes::Lanes;
use magsplice_simd::lanes::Number;

use crate::block::{Block, LocalPoint};
use crate::closed_form::gradient::{COMPONENTS, GradientTerms};
use crate::closed_form::near_edge::{Interior, offsets_and_steps};
use crate::closed_form::positive::Octant;
use crate::closed_form::single_tile::ClosedForm;
use crate::method::MethodRanges;
use crate::shape::Shape;
use crate::tolerances::POSITIVE_REACH;

/// One cuboid prepared for its gradient in vectors.
pub struct GradientEvaluator {
    /// The points of [`GradientMethod::Near`].
    near: Interior,
    /// The points of [`GradientMethod::Positive`].
    around: Interior,
    positive: PositiveTerms,
    closed_form: ClosedForm,
    terms: GradientTerms,
}

/// A cuboid's data for the gradient by [`Octant`].
pub(crate) struct PositiveTerms {
    faces: [[TwoSum; 2]; 3],
    scale: f64,
    /// Sides, scaled.
    size: [f64; 3],
    /// J / 2 pi in tesla, times the scale.
    weights: [f64; 3],
}

impl PositiveTerms {
    /// The terms of a block whose lengths `scale` brings to order one.
    pub(crate) fn new(block: &Block, scale: f64) -> PositiveTerms {
        let weights = block.polarization_t.to_array().map(|j| j * scale / (2.0 * PI));
        PositiveTerms { faces: block.faces, scale, size: block.size.map(|side| side * scale), weights }
    }

    /// Adds the gradient at a vector of points.
    #[inline(always)]
    pub(crate) fn add<N: Functions>(&self, simd: N::Instructions, point: [N; 3], sum: &mut [N; COMPONENTS]) {
        let (offsets, steps) = offsets_and_steps(simd, &self.faces, self.scale, point);
        Octant::differentiated(simd, offsets, steps, self.size).add_gradient(simd, self.weights, sum);
    }
}

/// A form of the gradient near a cuboid, in vectors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GradientMethod {
    /// The differentiated sums of positive terms, off the planes of the faces.
    Positive,
    /// The closed form inside and close to a cuboid, off the planes of its faces.
    Near,
    /// The closed form, in the range of the field's closed form.
    ClosedForm,
}

impl GradientEvaluator {
    /// Prepares a block with its ranges.
    pub fn new(block: &Block, ranges: &MethodRanges) -> GradientEvaluator {
        let form = Shape::new(block, ranges.scale).form();
        let terms = GradientTerms::from_block(block, ranges.scale, form);
        GradientEvaluator {
            near: Interior::new(block).within(terms.near_reach() / ranges.scale),
            around: Interior::new(block).within(POSITIVE_REACH / ranges.scale),
            positive: PositiveTerms::new(block, ranges.scale),
            closed_form: ClosedForm::new(block, ranges.scale, form),
            terms,
        }
    }

    /// Whether the closed form keeps its bound.
    pub fn has_closed_form(&self) -> bool {
        self.terms.has_closed_form()
    }

    /// The method for a point at which the field has no method in vectors, or no closed form with a
    /// gradient; `None` near the planes of the faces and far away.
    pub fn method_near(&self, point: &LocalPoint) -> Option<GradientMethod> {
        let method = if self.near.covers(point) { GradientMethod::Near } else { GradientMethod::Positive };
        (self.terms.is_resolved() && self.around.covers(point)).then_some(method)
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
                        GradientMethod::Positive => self.positive.add(simd, point, &mut sum),
                        GradientMethod::Near => {
                            let place = self.closed_form.place(simd, point);
                            let steps = self.closed_form.twice_from_centre(simd, point);
                            self.terms.add(simd, &place, Some(&steps), &mut sum);
                        }
                        GradientMethod::ClosedForm => {
                            let place = self.closed_form.place(simd, point);
                            self.terms.add(simd, &place, None, &mut sum);
                        }
                    }
                    for (gradients, component) in gradients.iter_mut().zip(sum) {
                        component.store(&mut gradients[lanes.clone()]);
                    }
                }
            },
        );
    }
}
