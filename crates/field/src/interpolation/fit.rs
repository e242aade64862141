//! The Chebyshev expansion of the field in a box without tiles.

use glam::DVec3;
use magsplice_cuboid::field_bound::tile_field_bound_t;
use magsplice_cuboid::tolerances::EXACT_BOUND;
use magsplice_magnet::{BoundingBox, Quantity, Tolerance};

use super::chebyshev::{decay, nodes, polynomials, transform};
use super::weighted_sums::{combine, padded};
use crate::direct::direct_sum::DirectSum;
use crate::tolerances::{
    CHECKED_POINTS, FIT_ROUNDS, LEAST_DECAY, LEAST_NODES, LOWEST_FIELD_SHARE, MOST_DECAY, MOST_NODES, SHARE_OF_AXIS,
};

/// B in a box as a sum of products of Chebyshev polynomials.
#[derive(Clone, Debug)]
pub(crate) struct Fit {
    pub(crate) region: BoundingBox,
    /// Polynomials along x, y, z.
    pub(crate) counts: [usize; 3],
    /// By component: coefficient (a, b, c) at a * y count * z room + b * z room + c.
    pub(super) coefficients: [Vec<f64>; 3],
    /// At most the length of the error, in tesla.
    pub(crate) error_t: f64,
    /// The error that was to be reached.
    pub(super) wanted_t: f64,
}

/// Why a box has no expansion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum FitFailure {
    /// It would take too many nodes: the box is too close to tiles for its size.
    TooNear,
    /// The rounding of the exact field is already more than the tolerance.
    TooExact,
}

impl Fit {
    /// To the tolerance, by at most `most_nodes` exact values.
    pub(crate) fn new(
        direct: &DirectSum,
        region: BoundingBox,
        tolerance: Tolerance,
        most_nodes: usize,
    ) -> Result<Fit, FitFailure> {
        let half = region.half_size();
        let (decays, magnitude_t) = surroundings(direct, &region)?;
        let relative = match tolerance {
            Tolerance::Relative { fraction, .. } => fraction,
            Tolerance::AbsoluteT { error_t, .. } => error_t / magnitude_t,
        };
        // What the geometry lets expect, as if nothing but the fall of the coefficients mattered.
        let expected = decays.map(|decay| (relative.min(0.5).ln() / decay.ln()).ceil());
        let expected = [0, 1, 2].map(|axis: usize| if half[axis] == 0.0 { 1.0 } else { expected[axis] });
        if expected.iter().any(|&count| count > MOST_NODES as f64)
            || expected.iter().product::<f64>() > most_nodes as f64
        {
            return Err(FitFailure::TooNear);
        }
        let Some(mut counts) = Lines::new(direct, region, expected).and_then(|lines| lines.counts(tolerance)) else {
            return Err(FitFailure::TooNear);
        };
        for _ in 0..FIT_ROUNDS {
            let total = counts.iter().try_fold(1_usize, |product, &count| product.checked_mul(count));
            if counts.iter().any(|&count| count > MOST_NODES) || total.is_none_or(|total| total > most_nodes) {
                return Err(FitFailure::TooNear);
            }
            let Some(samples) = Samples::new(direct, region, counts) else { return Err(FitFailure::TooNear) };
            let noise_t = EXACT_BOUND * magnitude_t * counts.map(lebesgue).iter().product::<f64>();
            let wanted_t = wanted_t(tolerance, samples.least_t, samples.most_t);
            if noise_t > 0.5 * wanted_t {
                return Err(FitFailure::TooExact);
            }
            let tails = [0, 1, 2].map(|axis| samples.tail(axis));
            let truncated_t: f64 = tails.iter().map(|tail| tail.sum_t).sum();
            let error_t = truncated_t + noise_t;
            if error_t <= wanted_t {
                let coefficients = samples.coefficients(direct);
                let fit = Fit { region, counts, coefficients, error_t, wanted_t };
                if fit.holds(direct) {
                    return Ok(fit);
                }
                // The last coefficients fell by chance.
                counts = counts.map(|count| if count > 1 { count + count / 4 + 1 } else { 1 });
                continue;
            }
            for (count, tail) in counts.iter_mut().zip(tails) {
                let share_t = SHARE_OF_AXIS * wanted_t;
                if tail.sum_t > share_t {
                    *count += ((share_t / tail.sum_t).ln() / tail.decay.ln()).ceil() as usize + 1;
                }
            }
        }
        Err(FitFailure::TooNear)
    }

    /// Whether the error is as small as it should be at some points, among them corners of the box, where all polynomials add up.
    fn holds(&self, direct: &DirectSum) -> bool {
        let points: Vec<DVec3> = (0..CHECKED_POINTS).map(|number| self.check_point(number)).collect();
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
            // Evenly spread, without repeating along any axis: multiples of powers of the number with g^4 = g + 1.
            let g = 1.220_744_084_605_759_5_f64;
            DVec3::from([1, 2, 3].map(|power| 2.0 * (number as f64 * g.powi(-power)).fract() - 1.0))
        };
        self.region.centre() + half * place
    }

    /// The expansion at a point of the box.
    pub(super) fn at(&self, point: DVec3) -> DVec3 {
        let (centre, half) = (self.region.centre(), self.region.half_size());
        let along = [0, 1, 2].map(|axis: usize| {
            let mut values = vec![0.0; self.counts[axis]];
            polynomials(if half[axis] > 0.0 { (point[axis] - centre[axis]) / half[axis] } else { 0.0 }, &mut values);
            values
        });
        let room = padded(self.counts[2]);
        let component = |coefficients: &Vec<f64>| {
            let mut sum = 0.0;
            for (row, coefficients) in coefficients.chunks_exact(room).enumerate() {
                let on_line: f64 = coefficients.iter().zip(&along[2]).map(|(c, t)| c * t).sum();
                sum += along[0][row / self.counts[1]] * along[1][row % self.counts[1]] * on_line;
            }
            sum
        };
        let [x, y, z] = &self.coefficients;
        DVec3::new(component(x), component(y), component(z))
    }

    /// Numbers of one component with the same degree along x.
    pub(super) fn slab(counts: [usize; 3]) -> usize {
        counts[1] * padded(counts[2])
    }
}

/// The error to be reached in a box where |B| lies between these.
fn wanted_t(tolerance: Tolerance, least_t: f64, most_t: f64) -> f64 {
    match tolerance {
        Tolerance::Relative { fraction, .. } => fraction * least_t.max(LOWEST_FIELD_SHARE * most_t),
        Tolerance::AbsoluteT { error_t, .. } => error_t,
    }
}

/// The field on lines through a box, from which the number of nodes is told before it is sampled in three dimensions.
struct Lines {
    /// Along each axis, the largest coefficient of each degree on any of the lines, in tesla; nothing where the box is flat.
    coefficients_t: [Vec<f64>; 3],
    least_t: f64,
    most_t: f64,
}

impl Lines {
    /// The edges of the box and its middle line along each axis, at somewhat more nodes than `expected`; `None` if a node has no field.
    fn new(direct: &DirectSum, region: BoundingBox, expected: [f64; 3]) -> Option<Lines> {
        let (centre, half) = (region.centre(), region.half_size());
        let mut lines = Lines { coefficients_t: [vec![], vec![], vec![]], least_t: f64::INFINITY, most_t: 0.0 };
        for axis in 0..3 {
            if half[axis] == 0.0 {
                continue;
            }
            let count = (1.3 * expected[axis]) as usize + LEAST_NODES;
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
                    (lines.least_t, lines.most_t) = (lines.least_t.min(b.length()), lines.most_t.max(b.length()));
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

    /// Along each axis, how many nodes leave an error that is the axis's share; `None` if the lines do not show it.
    fn counts(&self, tolerance: Tolerance) -> Option<[usize; 3]> {
        let share_t = SHARE_OF_AXIS * wanted_t(tolerance, self.least_t, self.most_t);
        let mut counts = [1; 3];
        for (count, coefficients) in counts.iter_mut().zip(&self.coefficients_t) {
            if coefficients.is_empty() {
                continue;
            }
            let mut left_out_t = 0.0;
            let needed = coefficients.iter().enumerate().rev().find_map(|(degree, coefficient)| {
                left_out_t += 2.0 * coefficient;
                (left_out_t > share_t).then_some(degree + 1)
            });
            *count = needed.unwrap_or(0).max(LEAST_NODES);
            if *count > coefficients.len() {
                return None;
            }
        }
        Some(counts)
    }
}

/// How fast coefficients fall along each axis, and at most the sum of the magnitudes of the tiles' fields in the box, in tesla. Not all
/// tiles are asked if one is too near.
fn surroundings(direct: &DirectSum, region: &BoundingBox) -> Result<([f64; 3], f64), FitFailure> {
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
                if decays[axis] > MOST_DECAY {
                    return Err(FitFailure::TooNear);
                }
            }
        }
    }
    Ok((decays, magnitude_t))
}

/// At most how much interpolation at so many nodes enlarges errors of the values.
fn lebesgue(count: usize) -> f64 {
    2.0 / std::f64::consts::PI * (count as f64).ln() + 1.0
}

struct Samples {
    counts: [usize; 3],
    /// By component, in the order of [`Fit::coefficients`].
    values_t: [Vec<f64>; 3],
    least_t: f64,
    most_t: f64,
}

impl Samples {
    /// `None` if a node has no field.
    fn new(direct: &DirectSum, region: BoundingBox, counts: [usize; 3]) -> Option<Samples> {
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
        let room = padded(nz);
        let mut values_t = [0, 1, 2].map(|_| vec![0.0; nx * ny * room]);
        let (mut least_t, mut most_t) = (f64::INFINITY, 0.0_f64);
        for (b, [i, j, k]) in field.iter().zip(indices) {
            (least_t, most_t) = (least_t.min(b.length()), most_t.max(b.length()));
            for (values, value) in values_t.iter_mut().zip(b.to_array()) {
                values[(i * ny + j) * room + k] = value;
            }
        }
        Some(Samples { counts, values_t, least_t, most_t })
    }

    /// What is left out along an axis: the expansions along all lines of nodes are looked at, which tell more than the sum of the coefficients of the box,
    /// whatever their sign.
    fn tail(&self, axis: usize) -> Tail {
        let count = self.counts[axis];
        if count == 1 {
            return Tail { sum_t: 0.0, decay: LEAST_DECAY };
        }
        let [nx, ny, nz] = self.counts;
        let room = padded(nz);
        let step = [ny * room, room, 1][axis];
        let [along, across] =
            [[1, 2], [0, 2], [0, 1]][axis].map(|other| (self.counts[other], [ny * room, room, 1][other]));
        debug_assert_eq!(along.0 * across.0 * count, nx * ny * nz);
        let last = LEAST_NODES - 2;
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

    fn coefficients(self, direct: &DirectSum) -> [Vec<f64>; 3] {
        let [nx, _, nz] = self.counts;
        let (room, slab) = (padded(nz), Fit::slab(self.counts));
        let [along_x, along_y, along_z] = self.counts.map(transform);
        self.values_t.map(|mut values| {
            let mut row = vec![0.0; nz];
            for values in values.chunks_exact_mut(room) {
                for (sum, weights) in row.iter_mut().zip(&along_z) {
                    *sum = weights.iter().zip(&*values).map(|(w, v)| w * v).sum();
                }
                values[..nz].copy_from_slice(&row);
            }
            let mut sums = vec![0.0; slab];
            for values in values.chunks_exact_mut(slab) {
                for (sum, weights) in sums.chunks_exact_mut(room).zip(&along_y) {
                    combine(direct.level(), weights, values, sum);
                }
                values.copy_from_slice(&sums);
            }
            let mut coefficients = vec![0.0; nx * slab];
            for (sum, weights) in coefficients.chunks_exact_mut(slab).zip(&along_x) {
                combine(direct.level(), weights, &values, sum);
            }
            coefficients
        })
    }
}

/// What the coefficients not taken may add up to.
#[derive(Clone, Copy)]
pub(super) struct Tail {
    pub(super) sum_t: f64,
    decay: f64,
}

/// Along one axis, from how the last of the `sizes` of terms fall, by degree. LanePair neighbours are taken together, since those of odd or of even
/// functions are zero.
pub(super) fn tail_of(sizes: &[f64]) -> Tail {
    let last = |back: usize| sizes[sizes.len() - back];
    let (end, before) = (last(1).max(last(2)), last(3).max(last(4)));
    let decay = if before > 0.0 { (end / before).sqrt().clamp(LEAST_DECAY, MOST_DECAY) } else { LEAST_DECAY };
    let next = (last(1) * decay).max(last(2) * decay * decay);
    // Those left out, and as much again, since they appear as lower ones at the nodes.
    Tail { sum_t: 2.0 * next / (1.0 - decay), decay }
}
