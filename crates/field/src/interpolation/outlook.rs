//! The outlook of a Chebyshev fit, from distances alone: whether it can be faster than the exact
//! field.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};
use magsplice_cuboid::field_bound::tile_field_bound_t;
use magsplice_cuboid::tolerances::EXACT_BOUND;
use magsplice_magnet::{BoundingBox, Quantity, Tolerance};

use super::truncation_bound::expected_sources;
use crate::tolerances::{MIN_FIELD_SHARE, MIN_FIT_FRACTION};
use magsplice_direct::direct_sum::DirectSum;

/// What the distances of tiles suggest for a fit of the field in a box, before any field is
/// computed.
pub(crate) struct Outlook {
    /// Numbers of nodes along x, y, z from the asymptotic decay of the coefficients (Eq. P26),
    /// below the numbers that a fit needs.
    pub(crate) nodes: DVec3,
    /// Number of sources in the bound of the truncation error.
    pub(crate) sources: f64,
}

/// Whether a fit of the field in a box may succeed and `pays`. Sampling a box whose fit then fails
/// takes time; distances take nearly none.
///
/// The fit amplifies the rounding of the exact values, which is compared with the tolerance at the
/// corners of the box.
pub(crate) fn is_promising(
    direct: &DirectSum,
    region: &BoundingBox,
    tolerance: Tolerance,
    pays: impl FnOnce(&Outlook) -> bool,
) -> bool {
    if matches!(tolerance, Tolerance::Relative { fraction, .. } if fraction < MIN_FIT_FRACTION) {
        return false;
    }
    let half = region.half_size();
    let (mut slowest, mut magnitude_t, mut rounding_t, mut sources) = ([0.0_f64; 3], 0.0, 0.0, 0.0);
    for ((tile, around), weight) in direct.tiles().iter().zip(direct.boxes()).zip(direct.error_weights()) {
        let gap = region.gap(around);
        let own_t = tile_field_bound_t(tile, gap.length());
        magnitude_t += own_t;
        rounding_t += EXACT_BOUND * weight * own_t;
        sources += expected_sources(tile, gap.length(), &half);
        for axis in (0..3).filter(|&axis| half[axis] > 0.0) {
            let gap = gap / half[axis];
            let aside = DVec2::new(gap[(axis + 1) % 3], gap[(axis + 2) % 3]).length();
            slowest[axis] = slowest[axis].max(decay(gap[axis], aside));
        }
    }
    let relative = match tolerance {
        Tolerance::Relative { fraction, .. } => fraction,
        Tolerance::AbsoluteT { error_t, .. } => error_t / magnitude_t,
    };
    let nodes = |axis: usize| {
        if half[axis] > 0.0 { (relative.min(0.5).ln() / slowest[axis].ln()).ceil().max(1.0) } else { 1.0 }
    };
    let expected = DVec3::new(nodes(0), nodes(1), nodes(2));
    if !pays(&Outlook { nodes: expected, sources }) {
        return false;
    }
    let amplified = expected.to_array().map(|count| 2.0 / PI * count.ln() + 1.0).iter().product::<f64>();
    let rounding_t = rounding_t * amplified;
    match tolerance {
        Tolerance::AbsoluteT { error_t, .. } => rounding_t <= error_t,
        Tolerance::Relative { fraction, .. } => {
            let corner = |n: usize| DVec3::from([0, 1, 2].map(|axis| if n >> axis & 1 == 1 { 1.0 } else { -1.0 }));
            let points: Vec<DVec3> = (0..8).map(|n| region.centre() + half * corner(n)).collect();
            let mut field = [DVec3::ZERO; 8];
            let evaluated = direct.exact_field_into(Quantity::FluxDensity, &points, &mut field);
            let lengths_t = field.map(DVec3::length);
            let weakest_t = lengths_t.into_iter().fold(f64::INFINITY, f64::min);
            let strongest_t = lengths_t.into_iter().fold(0.0, f64::max);
            evaluated.is_ok() && rounding_t <= fraction * weakest_t.max(MIN_FIELD_SHARE * strongest_t)
        }
    }
}

/// Decay of the Chebyshev coefficients along an axis (Eq. P26). Arguments are the distances of a
/// singularity beyond the end of the box and to its side, in half lengths of the box.
fn decay(beyond: f64, aside: f64) -> f64 {
    let place = if beyond > 0.0 { 1.0 + beyond } else { 0.0 };
    let half_sum = 0.5 * (DVec2::new(place + 1.0, aside).length() + DVec2::new(place - 1.0, aside).length());
    1.0 / (half_sum + (half_sum * half_sum - 1.0).max(0.0).sqrt())
}
