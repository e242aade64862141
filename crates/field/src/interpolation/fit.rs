//! Chebyshev fits: B in a box without tiles as a sum of products of Chebyshev polynomials
//! (docs/physics.md, section 5.1).

use glam::DVec3;
use magsplice_cuboid::field_bound::tile_field_bound_t;
use magsplice_cuboid::tolerances::EXACT_BOUND;
use magsplice_magnet::{BoundingBox, Quantity, Tolerance};

use super::chebyshev::{decay, nodes, polynomials, transform};
use super::weighted_sums::{padded, weighted_sum_at};
use crate::direct::direct_sum::DirectSum;
use crate::tolerances::{
    AXIS_ERROR_SHARE, CHECK_POINTS, MAX_DECAY, MAX_FIT_NODES, MAX_FIT_ROUNDS, MIN_DECAY, MIN_FIELD_SHARE, MIN_FIT_NODES,
};

/// B in a box as a sum of products of Chebyshev polynomials (Eq. P25).
#[derive(Clone, Debug)]
pub(crate) struct ChebyshevFit {
    pub(crate) region: BoundingBox,
    /// Numbers of polynomials along x, y, z.
    pub(crate) counts: [usize; 3],
    /// Coefficients of each component in tesla: (a, b, c) at (a * y count + b) * padded z count +
    /// c.
    pub(super) coefficients: [Vec<f64>; 3],
    /// Upper bound of the length of the error, in tesla.
    pub(crate) error_t: f64,
    /// Allowed error, in tesla.
    pub(super) allowed_error_t: f64,
}

/// The reason why a box has no fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum FitFailure {
    /// The fit would need too many nodes: the box is too close to tiles for its size.
    TooNear,
    /// The rounding error of the exact field alone exceeds the tolerance.
    TooExact,
}

impl ChebyshevFit {
    /// A fit within the tolerance, from at most `max_nodes` exact fields.
    ///
    /// The number of nodes along each axis is estimated from the geometry, then from lines through
    /// the box, then from the coefficients of the fit itself.
    pub(crate) fn new(
        direct: &DirectSum,
        region: BoundingBox,
        tolerance: Tolerance,
        max_nodes: usize,
    ) -> Result<ChebyshevFit, FitFailure> {
        let half = region.half_size();
        let (decays, magnitude_t) = decays_and_magnitude(direct, &region)?;
        let relative = match tolerance {
            Tolerance::Relative { fraction, .. } => fraction,
            Tolerance::AbsoluteT { error_t, .. } => error_t / magnitude_t,
        };
        // The numbers of nodes that the asymptotic decay of the coefficients suggests.
        let expected = decays.map(|decay| (relative.min(0.5).ln() / decay.ln()).ceil());
        let expected = [0, 1, 2].map(|axis: usize| if half[axis] == 0.0 { 1.0 } else { expected[axis] });
        if expected.iter().any(|&count| count > MAX_FIT_NODES as f64)
            || expected.iter().product::<f64>() > max_nodes as f64
        {
            return Err(FitFailure::TooNear);
        }
        let Some(mut counts) = LineSamples::new(direct, region, expected).and_then(|lines| lines.counts(tolerance))
        else {
            return Err(FitFailure::TooNear);
        };
        for _ in 0..MAX_FIT_ROUNDS {
            let total = counts.iter().try_fold(1_usize, |product, &count| product.checked_mul(count));
            if counts.iter().any(|&count| count > MAX_FIT_NODES) || total.is_none_or(|total| total > max_nodes) {
                return Err(FitFailure::TooNear);
            }
            let Some(samples) = BoxSamples::new(direct, region, counts) else { return Err(FitFailure::TooNear) };
            let rounding_t = EXACT_BOUND * magnitude_t * counts.map(lebesgue_bound).iter().product::<f64>();
            let allowed_error_t = allowed_error_t(tolerance, samples.min_t, samples.max_t);
            if rounding_t > 0.5 * allowed_error_t {
                return Err(FitFailure::TooExact);
            }
            let tails = [0, 1, 2].map(|axis| samples.tail(axis));
            let truncation_error_t: f64 = tails.iter().map(|tail| tail.sum_t).sum();
            let error_t = truncation_error_t + rounding_t;
            if error_t <= allowed_error_t {
                let coefficients = samples.coefficients(direct);
                let fit = ChebyshevFit { region, counts, coefficients, error_t, allowed_error_t };
                if fit.passes_check(direct) {
                    return Ok(fit);
                }
                // The last coefficients were small by chance.
                counts = counts.map(|count| if count > 1 { count + count / 4 + 1 } else { 1 });
                continue;
            }
            for (count, tail) in counts.iter_mut().zip(tails) {
                let share_t = AXIS_ERROR_SHARE * allowed_error_t;
                if tail.sum_t > share_t {
                    *count += ((share_t / tail.sum_t).ln() / tail.decay.ln()).ceil() as usize + 1;
                }
            }
        }
        Err(FitFailure::TooNear)
    }

    /// Whether the error is within its bound at some points. Among them are the corners of the box,
    /// where the magnitudes of all polynomials are 1.
    fn passes_check(&self, direct: &DirectSum) -> bool {
        let points: Vec<DVec3> = (0..CHECK_POINTS).map(|number| self.check_point(number)).collect();
        let mut exact = vec![DVec3::ZERO; points.len()];
        let evaluated = direct.exact_field_into(Quantity::FluxDensity, &points, &mut exact);
        evaluated.is_ok() && points.iter().zip(exact).all(|(&p, exact)| (self.at(p) - exact).length() <= self.error_t)
    }

    fn check_point(&self, number: usize) -> DVec3 {
        let half = self.region.half_size();
        let sign = |bit: usize| if number >> bit & 1 == 1 { 1.0 } else { -1.0 };
        let place = if number < 8 {
            DVec3::new(sign(0), sign(1), sign(2))
        } else {
            // A sequence that is evenly distributed in three dimensions: multiples of powers of 1 /
            // g, with g^4 = g + 1.
            let g = 1.220_744_084_605_759_5_f64;
            DVec3::from([1, 2, 3].map(|power| 2.0 * (number as f64 * g.powi(-power)).fract() - 1.0))
        };
        self.region.centre() + half * place
    }

    /// The interpolated field at a point of the box, in tesla.
    pub(super) fn at(&self, point: DVec3) -> DVec3 {
        let (centre, half) = (self.region.centre(), self.region.half_size());
        let along = [0, 1, 2].map(|axis: usize| {
            let mut values = vec![0.0; self.counts[axis]];
            polynomials(if half[axis] > 0.0 { (point[axis] - centre[axis]) / half[axis] } else { 0.0 }, &mut values);
            values
        });
        let stride = padded(self.counts[2]);
        let component = |coefficients: &Vec<f64>| {
            let mut sum = 0.0;
            for (row, coefficients) in coefficients.chunks_exact(stride).enumerate() {
                let on_line: f64 = coefficients.iter().zip(&along[2]).map(|(c, t)| c * t).sum();
                sum += along[0][row / self.counts[1]] * along[1][row % self.counts[1]] * on_line;
            }
            sum
        };
        let [x, y, z] = &self.coefficients;
        DVec3::new(component(x), component(y), component(z))
    }

    /// Length of the coefficients of one component with the same degree along x.
    pub(super) fn slab_len(counts: [usize; 3]) -> usize {
        counts[1] * padded(counts[2])
    }
}

/// Allowed error in a box where |B| lies between two values, in tesla.
fn allowed_error_t(tolerance: Tolerance, min_t: f64, max_t: f64) -> f64 {
    match tolerance {
        Tolerance::Relative { fraction, .. } => fraction * min_t.max(MIN_FIELD_SHARE * max_t),
        Tolerance::AbsoluteT { error_t, .. } => error_t,
    }
}

/// The field on lines through a box, from which the number of nodes is estimated before the box is
/// sampled in three dimensions.
struct LineSamples {
    /// Along each axis, the largest coefficient of each degree on any of the lines, in tesla. Empty
    /// along an axis on which the box has no extent.
    coefficients_t: [Vec<f64>; 3],
    /// Smallest and largest |B| on the lines, in tesla.
    min_t: f64,
    max_t: f64,
}

impl LineSamples {
    /// Samples the edges of the box and its centre line along each axis, at somewhat more nodes
    /// than `expected`. `None` if a node has no field.
    fn new(direct: &DirectSum, region: BoundingBox, expected: [f64; 3]) -> Option<LineSamples> {
        let (centre, half) = (region.centre(), region.half_size());
        let mut lines = LineSamples { coefficients_t: [vec![], vec![], vec![]], min_t: f64::INFINITY, max_t: 0.0 };
        for axis in 0..3 {
            if half[axis] == 0.0 {
                continue;
            }
            let count = (1.3 * expected[axis]) as usize + MIN_FIT_NODES;
            let (positions, rows) = (nodes(count), transform(count));
            let mut largest = vec![0.0_f64; count];
            for aside in [[0.0, 0.0], [1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] {
                let point = |t: &f64| {
                    let mut place = DVec3::ZERO;
                    (place[axis], place[(axis + 1) % 3], place[(axis + 2) % 3]) = (*t, aside[0], aside[1]);
                    centre + half * place
                };
                let points: Vec<DVec3> = positions.iter().map(point).collect();
                let mut field = vec![DVec3::ZERO; count];
                direct.exact_field_into(Quantity::FluxDensity, &points, &mut field).ok()?;
                for b in &field {
                    (lines.min_t, lines.max_t) = (lines.min_t.min(b.length()), lines.max_t.max(b.length()));
                }
                for (largest, row) in largest.iter_mut().zip(&rows) {
                    let coefficient: DVec3 = row.iter().zip(&field).map(|(w, b)| *w * *b).sum();
                    *largest = largest.max(coefficient.length());
                }
            }
            lines.coefficients_t[axis] = largest;
        }
        Some(lines)
    }

    /// Number of nodes along each axis that keep its share of the allowed error. `None` if the
    /// lines have too few nodes to show it.
    fn counts(&self, tolerance: Tolerance) -> Option<[usize; 3]> {
        let share_t = AXIS_ERROR_SHARE * allowed_error_t(tolerance, self.min_t, self.max_t);
        let mut counts = [1; 3];
        for (count, coefficients) in counts.iter_mut().zip(&self.coefficients_t) {
            if coefficients.is_empty() {
                continue;
            }
            let mut tail_t = 0.0;
            let needed = coefficients.iter().enumerate().rev().find_map(|(degree, coefficient)| {
                tail_t += 2.0 * coefficient;
                (tail_t > share_t).then_some(degree + 1)
            });
            *count = needed.unwrap_or(0).max(MIN_FIT_NODES);
            if *count > coefficients.len() {
                return None;
            }
        }
        Some(counts)
    }
}

/// Asymptotic decay of the coefficients along each axis, and an upper bound of the sum of the
/// magnitudes of the tiles' fields in the box, in tesla.
///
/// # Errors
/// If a tile is too near to the box.
fn decays_and_magnitude(direct: &DirectSum, region: &BoundingBox) -> Result<([f64; 3], f64), FitFailure> {
    let half = region.half_size();
    let (mut decays, mut magnitude_t) = ([0.0_f64; 3], 0.0);
    for (tile, around) in direct.tiles().iter().zip(direct.boxes()) {
        let gap = region.gap(around);
        magnitude_t += tile_field_bound_t(tile, gap.length());
        for axis in 0..3 {
            let aside = [gap[(axis + 1) % 3], gap[(axis + 2) % 3]];
            let aside = aside[0].hypot(aside[1]);
            if half[axis] > 0.0 {
                decays[axis] = decays[axis].max(decay(gap[axis] / half[axis], aside / half[axis]));
                if decays[axis] > MAX_DECAY {
                    return Err(FitFailure::TooNear);
                }
            }
        }
    }
    Ok((decays, magnitude_t))
}

/// Upper bound of the Lebesgue constant, by which interpolation at `count` nodes amplifies errors
/// of the values.
fn lebesgue_bound(count: usize) -> f64 {
    2.0 / std::f64::consts::PI * (count as f64).ln() + 1.0
}

/// B at the nodes of a box.
struct BoxSamples {
    counts: [usize; 3],
    /// Values of each component, in the order of [`ChebyshevFit::coefficients`].
    values_t: [Vec<f64>; 3],
    /// Smallest and largest |B| at the nodes, in tesla.
    min_t: f64,
    max_t: f64,
}

impl BoxSamples {
    /// Samples a box. `None` if a node has no field.
    fn new(direct: &DirectSum, region: BoundingBox, counts: [usize; 3]) -> Option<BoxSamples> {
        let (centre, half) = (region.centre(), region.half_size());
        let along = [0, 1, 2].map(|axis: usize| -> Vec<f64> {
            nodes(counts[axis]).into_iter().map(|t| centre[axis] + half[axis] * t).collect()
        });
        let [nx, ny, nz] = counts;
        let indices = (0..nx * ny * nz).map(|index| [index / (ny * nz), index / nz % ny, index % nz]);
        let points: Vec<DVec3> =
            indices.clone().map(|[i, j, k]| DVec3::new(along[0][i], along[1][j], along[2][k])).collect();
        let mut field = vec![DVec3::ZERO; points.len()];
        direct.exact_field_into(Quantity::FluxDensity, &points, &mut field).ok()?;
        let stride = padded(nz);
        let mut values_t = [0, 1, 2].map(|_| vec![0.0; nx * ny * stride]);
        let (mut min_t, mut max_t) = (f64::INFINITY, 0.0_f64);
        for (b, [i, j, k]) in field.iter().zip(indices) {
            (min_t, max_t) = (min_t.min(b.length()), max_t.max(b.length()));
            for (values, value) in values_t.iter_mut().zip(b.to_array()) {
                values[(i * ny + j) * stride + k] = value;
            }
        }
        Some(BoxSamples { counts, values_t, min_t, max_t })
    }

    /// The estimated tail along an axis, from the largest coefficients on any line of nodes. It is
    /// closer than an estimate from the magnitudes of the coefficients of the box, which ignores
    /// their signs.
    fn tail(&self, axis: usize) -> CoefficientTail {
        let count = self.counts[axis];
        if count == 1 {
            return CoefficientTail { sum_t: 0.0, decay: MIN_DECAY };
        }
        let [nx, ny, nz] = self.counts;
        let stride = padded(nz);
        let step = [ny * stride, stride, 1][axis];
        let [along, across] =
            [[1, 2], [0, 2], [0, 1]][axis].map(|other| (self.counts[other], [ny * stride, stride, 1][other]));
        debug_assert_eq!(along.0 * across.0 * count, nx * ny * nz);
        let last = MIN_FIT_NODES - 2;
        let rows = transform(count).split_off(count - last);
        let mut sizes = vec![0.0_f64; last];
        for i in 0..along.0 {
            for j in 0..across.0 {
                let start = i * along.1 + j * across.1;
                for (size, row) in sizes.iter_mut().zip(&rows) {
                    let coefficient = [0, 1, 2].map(|component: usize| -> f64 {
                        let values = self.values_t[component][start..].iter().step_by(step);
                        row.iter().zip(values).map(|(weight, value)| weight * value).sum()
                    });
                    *size = size.max(DVec3::from(coefficient).length());
                }
            }
        }
        tail_of(&sizes)
    }

    /// The Chebyshev coefficients of the values.
    fn coefficients(self, direct: &DirectSum) -> [Vec<f64>; 3] {
        let [nx, _, nz] = self.counts;
        let (stride, slab) = (padded(nz), ChebyshevFit::slab_len(self.counts));
        let [along_x, along_y, along_z] = self.counts.map(transform);
        self.values_t.map(|mut values| {
            let mut row = vec![0.0; nz];
            for values in values.chunks_exact_mut(stride) {
                for (sum, weights) in row.iter_mut().zip(&along_z) {
                    *sum = weights.iter().zip(&*values).map(|(w, v)| w * v).sum();
                }
                values[..nz].copy_from_slice(&row);
            }
            let mut sums = vec![0.0; slab];
            for values in values.chunks_exact_mut(slab) {
                for (sum, weights) in sums.chunks_exact_mut(stride).zip(&along_y) {
                    weighted_sum_at(direct.level(), weights, values, sum);
                }
                values.copy_from_slice(&sums);
            }
            let mut coefficients = vec![0.0; nx * slab];
            for (sum, weights) in coefficients.chunks_exact_mut(slab).zip(&along_x) {
                weighted_sum_at(direct.level(), weights, &values, sum);
            }
            coefficients
        })
    }
}

/// The estimated sum of the coefficients beyond the last, in tesla, and their decay.
#[derive(Clone, Copy)]
pub(super) struct CoefficientTail {
    pub(super) sum_t: f64,
    decay: f64,
}

/// The tail along one axis, extrapolated from the decay of the last of `sizes`, the magnitudes of
/// the terms by degree. Two neighbouring terms are combined, because every second coefficient of an
/// even or odd function is zero.
pub(super) fn tail_of(sizes: &[f64]) -> CoefficientTail {
    let last = |back: usize| sizes[sizes.len() - back];
    let (end, before) = (last(1).max(last(2)), last(3).max(last(4)));
    let decay = if before > 0.0 { (end / before).sqrt().clamp(MIN_DECAY, MAX_DECAY) } else { MIN_DECAY };
    let next = (last(1) * decay).max(last(2) * decay * decay);
    // Twice, because at the nodes higher degrees appear as lower ones (aliasing).
    CoefficientTail { sum_t: 2.0 * next / (1.0 - decay), decay }
}
