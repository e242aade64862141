//! The closed form of the gradient of one cuboid, in vectors.

use std::f64::consts::PI;

use fearless_simd::prelude::*;
use magsplice_simd::compensated_sum::TwoSum;
use magsplice_simd::functions::Functions;
use magsplice_simd::lanes::Lanes;

use crate::block::Block;
use crate::closed_form::gradient::COMPONENTS;
use crate::closed_form::near_edge::{Interior, offsets_and_steps};
use crate::closed_form::positive::Octant;
use crate::method::MethodRanges;
use crate::tolerances::{GRADIENT_REACH, THINNEST_GRADIENT};

/// One cuboid prepared for its gradient in vectors.
pub struct GradientEvaluator {
    /// The points close to the cuboid and in it, off the planes of its faces.
    near: Interior,
    is_resolved: bool,
    faces: [[TwoSum; 2]; 3],
    scale: f64,
    /// Sides, scaled.
    size: [f64; 3],
    /// J / 4 pi in tesla, times the scale.
    weights: [f64; 3],
}

impl GradientEvaluator {
    /// Prepares a block with its ranges.
    pub fn new(block: &Block, ranges: &MethodRanges) -> GradientEvaluator {
        let scale = ranges.scale;
        let size = block.size.map(|side| side * scale);
        let longest = size.into_iter().fold(0.0, f64::max);
        GradientEvaluator {
            near: Interior::new(block).within(GRADIENT_REACH / scale),
            is_resolved: size.into_iter().all(|side| side >= THINNEST_GRADIENT * longest),
            faces: block.faces,
            scale,
            size,
            weights: block.polarization_t.to_array().map(|j| j * scale / (4.0 * PI)),
        }
    }

    /// Whether the form covers points at which the field has no method in vectors: not on the
    /// planes of the faces, and not far away. Points are given by axis in whole vectors, with the
    /// bounds of the errors of their coordinates; the result is 1 or 0.
    pub fn cover_near<S: Simd>(&self, simd: S, points: [&[f64]; 3], roundoff: [&[f64]; 3], covered: &mut [f64]) {
        if self.is_resolved {
            self.near.cover(simd, points, roundoff, covered);
        } else {
            covered.fill(0.0);
        }
    }

    /// The gradient of B in tesla per length, in the frame of the cuboid, at points given by axis
    /// in whole vectors: xx, yy, zz, yz, xz, xy.
    #[inline(never)]
    pub fn gradients<S: Simd>(&self, simd: S, [x, y, z]: [&[f64]; 3], mut gradients: [&mut [f64]; COMPONENTS]) {
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
                    for (gradients, component) in gradients.iter_mut().zip(self.gradient(simd, point)) {
                        component.store(&mut gradients[lanes.clone()]);
                    }
                }
            },
        );
    }

    /// The gradient at numbers of any kind.
    #[inline(always)]
    pub(crate) fn gradient<N: Functions>(&self, simd: N::Instructions, point: [N; 3]) -> [N; COMPONENTS] {
        let (offsets, steps) = offsets_and_steps(simd, &self.faces, self.scale, point);
        let mut sum = [N::splat(simd, 0.0); COMPONENTS];
        Octant::new(simd, offsets, steps, self.size).add_gradient(simd, self.weights, &mut sum);
        sum
    }
}
