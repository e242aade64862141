//! The error bound of the exact field at points.

use glam::DVec3;
use magsplice_cuboid::tolerances::EXACT_BOUND;
use magsplice_simd::column::Column;
use rayon::prelude::*;

use super::direct_sum::DirectSum;

/// Number of points whose bounds are computed together.
const POINTS_TOGETHER: usize = 1024;

impl DirectSum {
    /// Upper bound of the error of the exact B at each point, in tesla. It is infinite at points
    /// that are not finite.
    pub fn error_bounds_t(&self, points: &[DVec3]) -> Vec<f64> {
        let bounds = |points: &[DVec3]| {
            let mut magnitudes_t = Column::default();
            // Bounds are computed at finite points only.
            let finite = points.iter().map(|p| if p.is_finite() { *p } else { DVec3::ZERO });
            self.magnitudes().write(self.level(), finite, &mut magnitudes_t);
            let bound = |(p, magnitude): (&DVec3, &f64)| {
                if p.is_finite() { EXACT_BOUND * magnitude } else { f64::INFINITY }
            };
            points.iter().zip(magnitudes_t.iter()).map(bound).collect::<Vec<f64>>()
        };
        points.par_chunks(POINTS_TOGETHER).flat_map_iter(bounds).collect()
    }
}
