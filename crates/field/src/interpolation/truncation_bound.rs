//! Upper bound of the truncation error of a Chebyshev fit, from the tiles alone (docs/physics.md,
//! section 5.1).

use std::f64::consts::PI;

use glam::{DQuat, DVec3};
use magsplice_magnet::{BoundingBox, Tile};

use crate::tolerances::{DIPOLE_DEGREE, MAX_DECAY, MAX_FIT_NODES, PATCHES, PATCHES_PER_DISTANCE};
use magsplice_direct::direct_sum::DirectSum;

/// Numbers of nodes, and an upper bound of their truncation error.
#[derive(Clone, Copy, Debug)]
pub(super) struct NodeCounts {
    /// Numbers of nodes along x, y, z.
    pub(super) counts: [usize; 3],
    /// The axes, in the order of interpolation of the error bound.
    order: [usize; 3],
    /// Upper bound of the length of the error, in tesla.
    pub(super) error_t: f64,
}

/// Charges and dipoles whose fields add up to the field of all tiles, in relation to lines along
/// each axis of a box.
#[derive(Clone, Debug)]
pub(super) struct Sources {
    by_axis: [Vec<Source>; 3],
}

/// Charges or dipoles with a smallest distance from the lines along one axis of a box.
#[derive(Clone, Copy, Debug)]
struct Source {
    kind: Kind,
    /// Factor of the coefficients in Eqs. P49 and P50, in tesla.
    amplitude_t: f64,
    /// 1 / rho, the ratio of successive coefficients.
    decay: f64,
    /// Lower bound of sin theta (Eq. P49).
    sine: f64,
}

/// The poles of a source.
#[derive(Clone, Copy, Debug)]
enum Kind {
    /// Magnetic charges J . n on a part of a face.
    Charges,
    /// Dipoles J dV.
    Dipoles,
}

impl Sources {
    /// The sources of all tiles: dipoles of small and distant tiles, charges of other tiles.
    pub(super) fn new(direct: &DirectSum, region: &BoundingBox) -> Sources {
        let mut sources = Sources { by_axis: [vec![], vec![], vec![]] };
        let half_length = region.half_size().max_element();
        for (tile, around) in direct.tiles().iter().zip(direct.boxes()) {
            let distance = region.gap(around).length();
            match dipole_t(tile, distance.max(half_length)) {
                Some(dipole_t) => sources.add(Kind::Dipoles, dipole_t, around, region),
                None => sources.add_charges(tile, distance, region),
            }
        }
        sources
    }

    /// The charges of all tiles.
    pub(super) fn charges(direct: &DirectSum, region: &BoundingBox) -> Sources {
        let mut sources = Sources { by_axis: [vec![], vec![], vec![]] };
        for (tile, around) in direct.tiles().iter().zip(direct.boxes()) {
            sources.add_charges(tile, region.gap(around).length(), region);
        }
        sources
    }

    /// The smallest number of nodes with which the truncation error is at most `allowed_t`. `None`
    /// if an axis needs more than [`MAX_FIT_NODES`].
    pub(super) fn node_counts(&self, allowed_t: f64) -> Option<NodeCounts> {
        let mut counts = [1; 3];
        let mut errors_t = [0.0; 3];
        for axis in 0..3 {
            (counts[axis], errors_t[axis]) = self.count_along(axis, allowed_t)?;
        }
        // The axis with most nodes is interpolated first, so its error does not grow.
        let mut order = [0, 1, 2];
        order.sort_by_key(|&axis| std::cmp::Reverse(counts[axis]));
        loop {
            let mut growth = 1.0;
            let mut grown_t = [0.0; 3];
            for axis in order {
                grown_t[axis] = growth * errors_t[axis];
                growth *= lebesgue_bound(counts[axis]);
            }
            let error_t = grown_t.iter().sum();
            if error_t <= allowed_t {
                return Some(NodeCounts { counts, order, error_t });
            }
            let worst = (0..3).max_by(|&a, &b| grown_t[a].total_cmp(&grown_t[b])).expect("three axes");
            counts[worst] += 1;
            if counts[worst] > MAX_FIT_NODES {
                return None;
            }
            errors_t[worst] = self.error_along_t(worst, counts[worst]).0;
        }
    }

    /// Upper bound of the derivative of the error of interpolation along each axis, in tesla per
    /// unit of length (Eq. P51). The sources must be charges.
    pub(super) fn gradient_error_t(&self, nodes: NodeCounts, half: DVec3) -> DVec3 {
        let mut slopes_t = DVec3::ZERO;
        let mut growth = 1.0;
        let mut before = Vec::new();
        for axis in nodes.order {
            let count = nodes.counts[axis];
            let sum = |tail_t: &dyn Fn(&Source) -> f64| growth * self.by_axis[axis].iter().map(tail_t).sum::<f64>();
            let error_t = sum(&|source| source.tail_t(count));
            for other in 0..3 {
                slopes_t[other] += if other == axis {
                    sum(&|source| source.slope_tail_t(count)) / half[axis]
                } else if before.contains(&other) {
                    // A polynomial of degree d has a slope of at most d^2 times its values
                    // (Markov).
                    error_t * ((nodes.counts[other] - 1) as f64).powi(2) / half[other]
                } else {
                    sum(&|source| source.derivative(half[axis]).tail_t(count))
                };
            }
            growth *= lebesgue_bound(count);
            before.push(axis);
        }
        slopes_t
    }

    /// The smallest number of nodes along an axis with which the error of interpolation along it is
    /// at most `allowed_t`, and that error.
    fn count_along(&self, axis: usize, allowed_t: f64) -> Option<(usize, f64)> {
        if self.by_axis[axis].is_empty() {
            return Some((1, 0.0));
        }
        let mut count = 1;
        while count <= MAX_FIT_NODES {
            let (error_t, ratio) = self.error_along_t(axis, count);
            if error_t <= allowed_t {
                return Some((count, error_t));
            }
            // The ratio of successive errors grows with the number of nodes, so this step is never
            // too long.
            let steps = if error_t.is_finite() { ((allowed_t / error_t).ln() / ratio.ln()).ceil() } else { 1.0 };
            count += steps.clamp(1.0, MAX_FIT_NODES as f64) as usize;
        }
        None
    }

    /// Upper bound of the error of interpolation at `count` nodes along one axis, anywhere along
    /// the others, in tesla, and a lower bound of the ratio of the next bound to it.
    fn error_along_t(&self, axis: usize, count: usize) -> (f64, f64) {
        let (mut error_t, mut next_t) = (0.0, 0.0);
        for source in &self.by_axis[axis] {
            let tail_t = source.tail_t(count);
            error_t += tail_t;
            next_t += tail_t * source.decay;
        }
        (error_t, next_t / error_t)
    }

    fn add_charges(&mut self, tile: &Tile, distance: f64, region: &BoundingBox) {
        let (size, j_t) = (tile.size(), tile.polarization_t());
        let rotation = tile.rotation();
        for normal in (0..3).filter(|&axis| j_t[axis] != 0.0) {
            let [along, across] = [(normal + 1) % 3, (normal + 2) % 3];
            let counts = [along, across].map(|axis| patches(size[axis], distance));
            let mut half = DVec3::ZERO;
            (half[along], half[across]) = (0.5 * size[along] / counts[0], 0.5 * size[across] / counts[1]);
            let half_around = if rotation == DQuat::IDENTITY {
                half
            } else {
                (rotation * (half[along] * DVec3::AXES[along])).abs()
                    + (rotation * (half[across] * DVec3::AXES[across])).abs()
            };
            let charge_t = j_t[normal].abs() * (2.0 * half[along]) * (2.0 * half[across]) / (4.0 * PI);
            for i in 0..counts[0] as usize {
                for j in 0..counts[1] as usize {
                    let mut offset = DVec3::ZERO;
                    offset[normal] = 0.5 * size[normal];
                    offset[along] = (2.0 * i as f64 + 1.0) * half[along] - 0.5 * size[along];
                    offset[across] = (2.0 * j as f64 + 1.0) * half[across] - 0.5 * size[across];
                    for side in [1.0, -1.0] {
                        let centre = tile.position() + rotation * (side * offset);
                        let patch = BoundingBox { lower: centre - half_around, upper: centre + half_around };
                        self.add(Kind::Charges, charge_t, &patch, region);
                    }
                }
            }
        }
    }

    /// Adds charges or dipoles in a box to each axis along which the fitted box has an extent.
    fn add(&mut self, kind: Kind, strength_t: f64, around: &BoundingBox, region: &BoundingBox) {
        let (gap, half, centre) = (region.gap(around), region.half_size(), region.centre());
        for axis in (0..3).filter(|&axis| half[axis] > 0.0) {
            let aside = DVec3::new(0.0, gap[(axis + 1) % 3], gap[(axis + 2) % 3]).length();
            let [low, high] = [around.lower[axis], around.upper[axis]].map(|end| end - centre[axis]);
            let (nearest, farthest) = (low.max(-high).max(0.0), high.max(-low));
            let rho = rho(nearest, aside, half[axis]);
            let (decay, scale) = (half[axis] / rho, 2.0 / rho);
            let amplitude_t = match kind {
                Kind::Charges => 4.0 * strength_t * scale * scale,
                Kind::Dipoles => DIPOLE_FACTOR * 4.0 * strength_t * scale * scale * scale,
            };
            let sine = if aside > 0.0 { aside / farthest.hypot(aside) } else { 0.0 };
            self.by_axis[axis].push(Source { kind, amplitude_t, decay, sine });
        }
    }
}

/// The moment of a tile over 4 pi, in tesla, if its dipoles have a lower bound than its charges.
/// Both describe the same field.
fn dipole_t(tile: &Tile, distance: f64) -> Option<f64> {
    let (size, j_t) = (tile.size(), tile.polarization_t());
    let dipole_t = j_t.length() * size.element_product() / (4.0 * PI);
    let charge_t = j_t.abs().dot(size.element_product() / size) / (2.0 * PI);
    (DIPOLE_DEGREE * dipole_t < charge_t * distance).then_some(dipole_t)
}

/// Number of patches along a side of a face at a distance.
fn patches(side: f64, distance: f64) -> f64 {
    (PATCHES_PER_DISTANCE * side / distance).ceil().clamp(1.0, PATCHES)
}

/// Number of sources of a tile at a distance from a box with the half sides `half`, over all axes.
pub(super) fn expected_sources(tile: &Tile, distance: f64, half: &DVec3) -> f64 {
    let axes = half.to_array().into_iter().filter(|half| *half > 0.0).count() as f64;
    if dipole_t(tile, distance.max(half.max_element())).is_some() {
        return axes;
    }
    let counts = tile.size().to_array().map(|side| patches(side, distance));
    let faces = (0..3).filter(|&normal| tile.polarization_t()[normal] != 0.0);
    axes * faces.map(|normal| 2.0 * counts[(normal + 1) % 3] * counts[(normal + 2) % 3]).sum::<f64>()
}

/// Bound of the ratio of a dipole's coefficients to the coefficients of the derivative of a
/// charge's field along the line (Eq. P50).
const DIPOLE_FACTOR: f64 = 1.6;

impl Source {
    /// Upper bound of twice the sum of the coefficients of degree `count` and higher (Eqs. P49 and
    /// P50).
    fn tail_t(&self, count: usize) -> f64 {
        self.weighted_tail_t(count, |_| 1.0)
    }

    /// [`Source::tail_t`] with each coefficient times the square of its degree, which is the
    /// largest slope of its polynomial.
    fn slope_tail_t(&self, count: usize) -> f64 {
        self.weighted_tail_t(count, |k| k * k)
    }

    /// [`Source::tail_t`] with weights for each degree, whose ratios decrease.
    #[inline(always)]
    fn weighted_tail_t(&self, count: usize, weight: impl Fn(f64) -> f64) -> f64 {
        let n = count as f64;
        let (growth, products) = match self.kind {
            Kind::Charges => ((n + 2.0) / (n + 1.0), n + 1.0),
            Kind::Dipoles => ((n + 3.0) / (n + 1.0), (n + 1.0) * (n + 2.0)),
        };
        let square = self.decay * self.decay * growth;
        let ratio = self.decay * growth * (weight(n + 1.0) / weight(n));
        if ratio >= 1.0 {
            return f64::INFINITY;
        }
        let steps = (n + 1.0) * self.sine;
        let averaged = (2.0 / PI * (1.0 + 3.0 / steps) / steps).min(1.0).sqrt();
        let rest = match self.kind {
            Kind::Charges => (1.0 - square) * (1.0 - square) * (1.0 - ratio),
            Kind::Dipoles => (1.0 - square).powi(3) * (1.0 - ratio) * (1.0 - ratio * ratio),
        };
        self.amplitude_t * averaged * products * weight(n) * self.decay.powi(count as i32) / rest
    }

    /// The source of the derivative of the field of charges in any direction, per unit of length.
    /// It has the coefficients of dipoles.
    fn derivative(&self, half: f64) -> Source {
        let scale = 2.0 * self.decay / half;
        Source { kind: Kind::Dipoles, amplitude_t: DIPOLE_FACTOR * scale * self.amplitude_t, ..*self }
    }
}

/// The slowest decay of the coefficients of any tile along each axis of a box. `None` if a tile is
/// so near that the box needs more than [`MAX_FIT_NODES`].
pub(super) fn slowest_decays(direct: &DirectSum, region: &BoundingBox) -> Option<[f64; 3]> {
    let half = region.half_size();
    let mut decays = [0.0_f64; 3];
    for around in direct.boxes() {
        let gap = region.gap(around);
        for axis in (0..3).filter(|&axis| half[axis] > 0.0) {
            let aside = DVec3::new(0.0, gap[(axis + 1) % 3], gap[(axis + 2) % 3]).length();
            let beyond = if gap[axis] > 0.0 { half[axis] + gap[axis] } else { 0.0 };
            decays[axis] = decays[axis].max(half[axis] / rho(beyond, aside, half[axis]));
            if decays[axis] > MAX_DECAY {
                return None;
            }
        }
    }
    Some(decays)
}

/// rho of Eq. P26 times half the length of the box, which does not overflow in the shortest boxes.
fn rho(along: f64, aside: f64, half: f64) -> f64 {
    let root = |x: f64| (x * x + aside * aside).sqrt();
    let long_axis = 0.5 * (root(along + half) + root(along - half));
    long_axis + (long_axis * long_axis - half * half).max(0.0).sqrt()
}

/// Upper bound of the Lebesgue constant, by which interpolation at `count` nodes amplifies errors
/// of the values.
pub(super) fn lebesgue_bound(count: usize) -> f64 {
    2.0 / PI * (count as f64).ln() + 1.0
}

#[cfg(test)]
mod tests {
    use super::super::chebyshev::{nodes, transform};
    use super::*;

    /// Number of nodes for the coefficients. Aliases are below round-off for the tested decays.
    const MANY: usize = 120;

    /// Twice the sums of the lengths of the coefficients of degrees 1 and higher, 2 and higher, ...
    /// of a field along the x axis from -1 to 1.
    fn tails(field: impl Fn(DVec3) -> DVec3) -> Vec<f64> {
        let values: Vec<DVec3> = nodes(MANY).into_iter().map(|t| field(t * DVec3::X)).collect();
        let coefficient = |row: &Vec<f64>| row.iter().zip(&values).map(|(w, b)| *w * *b).sum::<DVec3>().length();
        let sizes: Vec<f64> = transform(MANY)[1..].iter().map(coefficient).collect();
        let mut tail = 0.0;
        let mut tails: Vec<f64> = sizes.iter().rev().map(|size| (tail += 2.0 * size, tail).1).collect();
        tails.reverse();
        tails
    }

    /// The smallest and the largest ratio of the bounds to the sums of the coefficients, for a
    /// source of unit strength at positions around the line.
    fn bounds_over_tails(kind: Kind, field: impl Fn(DVec3, f64) -> DVec3) -> [f64; 2] {
        let line = BoundingBox { lower: DVec3::NEG_X, upper: DVec3::X };
        let (mut least, mut largest) = (f64::INFINITY, 0.0_f64);
        for step in 0..=40 {
            let (along, aside) = (PI * f64::from(step) / 80.0).sin_cos();
            for distance in [0.25, 0.5, 1.0, 2.0, 6.0] {
                let source = DVec3::new((1.0 + distance) * along, distance * aside.max(0.0), 0.0);
                let mut sources = Sources { by_axis: [vec![], vec![], vec![]] };
                sources.add(kind, 1.0, &BoundingBox { lower: source, upper: source }, &line);
                let source_seen = sources.by_axis[0][0];
                for turn in 0..8 {
                    let tails = tails(|point| field(point - source, 0.25 * PI * f64::from(turn)));
                    for (count, tail) in (1..).zip(&tails).take_while(|(_, tail)| **tail > 1e-9 * tails[0]) {
                        let bound = source_seen.tail_t(count);
                        least = least.min(bound / tail);
                        if count > 10 && bound.is_finite() {
                            largest = largest.max(tail / bound);
                        }
                    }
                }
            }
        }
        [least, largest]
    }

    #[test]
    fn bound_holds_for_charges_in_every_direction() {
        let [least, closest] = bounds_over_tails(Kind::Charges, |offset, _| offset / offset.length().powi(3));
        assert!(least >= 1.0 && closest > 0.5, "{least} {closest}");
    }

    #[test]
    fn bound_holds_for_dipoles_in_every_direction() {
        let [least, closest] = bounds_over_tails(Kind::Dipoles, |offset, turn| {
            let moment = if turn < 6.0 { DVec3::new(turn.cos(), turn.sin(), 0.0) } else { DVec3::Z };
            (3.0 * offset * offset.dot(moment) / offset.length_squared() - moment) / offset.length().powi(3)
        });
        assert!(least >= 1.0 && closest > 0.2, "{least} {closest}");
    }
}
