//! Chebyshev fits: B in a box without tiles as a sum of products of Chebyshev polynomials
//! (docs/physics.md, section 5.1).

use fearless_simd::{Simd, dispatch};
use glam::DVec3;
use magsplice_cuboid::field_bound::tile_field_bound_t;
use magsplice_cuboid::tolerances::EXACT_BOUND;
use magsplice_magnet::{BoundingBox, Quantity, Tolerance};

use super::chebyshev::{nodes, transform};
use super::mirror::Mirrors;
use super::truncation_bound::{NodeCounts, Sources, lebesgue_bound, slowest_decays};
use super::weighted_sums::{padded, weighted_sum};
use crate::tolerances::{
    LARGER_ROUNDING, MIN_FIELD_SHARE, MIN_TRUNCATION_SHARE, NODE_ROUNDING, RANGE_POINTS, TRUNCATION_SHARE,
};
use magsplice_direct::direct_sum::DirectSum;

/// B in a box as a sum of products of Chebyshev polynomials (Eq. P25).
#[derive(Clone, Debug)]
pub(crate) struct ChebyshevFit {
    pub(crate) region: BoundingBox,
    /// Numbers of polynomials along x, y, z.
    pub(crate) counts: [usize; 3],
    /// Degrees along x and y with coefficients, for each component.
    pub(super) degrees: [[Degrees; 2]; 3],
    /// Coefficients of each component in tesla: (a, b, c) at (a * y count + b) * padded z count +
    /// c, where a and b number the degrees along x and y.
    pub(super) coefficients: [Vec<f64>; 3],
    /// Upper bound of the length of the error, in tesla.
    pub(crate) error_t: f64,
    /// Allowed error, in tesla.
    pub(super) allowed_error_t: f64,
    /// Number of exact fields from which the fit was made.
    pub(crate) exact_values: usize,
    nodes: NodeCounts,
}

/// The reason why a box has no fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum FitFailure {
    /// The fit would need too many nodes: the box is too close to tiles for its size.
    TooNear,
    /// The rounding error of the exact field exceeds the tolerance.
    TooExact,
}

/// Degrees of polynomials along an axis. In a symmetric field half of the degrees have no
/// coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Degrees {
    All,
    Even,
    Odd,
}

impl Degrees {
    /// The degrees of a component that has this factor at mirror images.
    fn from_factor(factor: Option<f64>) -> Degrees {
        match factor {
            None => Degrees::All,
            Some(factor) if factor > 0.0 => Degrees::Even,
            Some(_) => Degrees::Odd,
        }
    }

    /// The degrees below `count`.
    pub(super) fn below(self, count: usize) -> impl Iterator<Item = usize> {
        let (first, step) = match self {
            Degrees::All => (0, 1),
            Degrees::Even => (0, 2),
            Degrees::Odd => (1, 2),
        };
        (first..count).step_by(step)
    }
}

impl ChebyshevFit {
    /// A fit within the tolerance, if `pays` holds for its numbers of nodes and of exact fields.
    ///
    /// [`Sources`] determines a number of nodes that is proved to be sufficient.
    pub(crate) fn new(
        direct: &DirectSum,
        region: BoundingBox,
        tolerance: Tolerance,
        pays: impl Fn([f64; 3], f64) -> bool,
    ) -> Result<ChebyshevFit, FitFailure> {
        let decays = slowest_decays(direct, &region).ok_or(FitFailure::TooNear)?;
        let mirrors = Mirrors::new(direct, &region);
        let value_error_t = value_rounding_t(direct, &region) + mirrors.error_t;
        let relative = match tolerance {
            Tolerance::Relative { fraction, .. } => fraction,
            Tolerance::AbsoluteT { error_t, .. } => error_t * EXACT_BOUND / value_error_t,
        };
        // The smallest numbers of nodes that the decays allow, before any evaluation.
        let least = decays.map(|decay| if decay > 0.0 { (relative.min(0.5).ln() / decay.ln()).max(1.0) } else { 1.0 });
        let halved = mirrors.signs.iter().flatten().count() as i32;
        if !pays(least, least.iter().product::<f64>() / 2_f64.powi(halved)) {
            return Err(FitFailure::TooNear);
        }
        let allowed_error_t = allowed_error_t(direct, &region, &mirrors, tolerance).ok_or(FitFailure::TooNear)?;
        let sources = Sources::new(direct, &region);
        let rounding_t = |counts: [usize; 3]| value_error_t * counts.map(lebesgue_bound).iter().product::<f64>();
        let mut nodes = sources.node_counts(TRUNCATION_SHARE * allowed_error_t).ok_or(FitFailure::TooNear)?;
        if nodes.error_t + rounding_t(nodes.counts) > allowed_error_t {
            // Rounding takes a larger share of the allowed error.
            let left_t = allowed_error_t - LARGER_ROUNDING * rounding_t(nodes.counts);
            if left_t < MIN_TRUNCATION_SHARE * allowed_error_t {
                return Err(FitFailure::TooExact);
            }
            nodes = sources.node_counts(left_t).ok_or(FitFailure::TooNear)?;
        }
        let error_t = nodes.error_t + rounding_t(nodes.counts);
        if error_t > allowed_error_t {
            return Err(FitFailure::TooExact);
        }
        let samples = NodeSamples::new(region, nodes.counts, mirrors);
        let exact_values: usize = samples.own_counts().iter().product();
        if !pays(nodes.counts.map(|count| count as f64), exact_values as f64) {
            return Err(FitFailure::TooNear);
        }
        let values_t = samples.evaluate(direct).ok_or(FitFailure::TooNear)?;
        let degrees = [0, 1, 2].map(|c: usize| [0, 1].map(|axis| Degrees::from_factor(mirrors.factor(c, axis))));
        let level = direct.level();
        let coefficients = dispatch!(level, simd => all_coefficients(simd, nodes.counts, degrees, &values_t));
        Ok(ChebyshevFit {
            region,
            counts: nodes.counts,
            degrees,
            coefficients,
            error_t,
            allowed_error_t,
            exact_values,
            nodes,
        })
    }

    /// Upper bound of the derivative of the error along each axis, in tesla per unit of length.
    pub(super) fn gradient_error_t(&self, direct: &DirectSum) -> DVec3 {
        let half = self.region.half_size();
        let truncation_t = Sources::charges(direct, &self.region).gradient_error_t(self.nodes, half);
        let rounding_t = self.error_t - self.nodes.error_t;
        let slopes = DVec3::from(self.counts.map(|count| ((count - 1) as f64).powi(2))) / half;
        truncation_t + rounding_t * slopes
    }

    /// Coefficients of a component in the order of [`ChebyshevFit::coefficients`], of all degrees.
    pub(super) fn dense_coefficients(&self, component: usize) -> Vec<f64> {
        let [nx, ny, nz] = self.counts;
        let stride = padded(nz);
        let mut dense = vec![0.0; nx * ny * stride];
        let [along_x, along_y] = self.degrees[component];
        let rows = along_x.below(nx).flat_map(|a| along_y.below(ny).map(move |b| a * ny + b));
        for (row, coefficients) in rows.zip(self.coefficients[component].chunks_exact(stride)) {
            dense[row * stride..(row + 1) * stride].copy_from_slice(coefficients);
        }
        dense
    }

    /// Length of the coefficients of one component with the same degree along x.
    pub(super) fn slab_len(&self, component: usize) -> usize {
        self.degrees[component][1].below(self.counts[1]).count() * padded(self.counts[2])
    }
}

/// Allowed error in a box, in tesla, from the smallest |B| at some points. `None` if a point has no
/// field.
fn allowed_error_t(direct: &DirectSum, region: &BoundingBox, mirrors: &Mirrors, tolerance: Tolerance) -> Option<f64> {
    let fraction = match tolerance {
        Tolerance::AbsoluteT { error_t, .. } => return Some(error_t),
        Tolerance::Relative { fraction, .. } => fraction,
    };
    let (centre, half) = (region.centre(), region.half_size());
    let places = [0, 1, 2].map(|axis: usize| -> Vec<f64> {
        let count = if half[axis] > 0.0 { RANGE_POINTS } else { 1 };
        let own = if mirrors.signs[axis].is_some() { count.div_ceil(2) } else { count };
        (0..own).map(|i| 1.0 - 2.0 * i as f64 / (RANGE_POINTS - 1) as f64).collect()
    });
    let [x, y, z] = &places;
    let points: Vec<DVec3> = x
        .iter()
        .flat_map(|&x| y.iter().flat_map(move |&y| z.iter().map(move |&z| centre + half * DVec3::new(x, y, z))))
        .collect();
    let mut field = vec![DVec3::ZERO; points.len()];
    direct.exact_field_into(Quantity::FluxDensity, &points, &mut field).ok()?;
    let min_t = field.iter().map(|b| b.length()).fold(f64::INFINITY, f64::min);
    let max_t = field.iter().map(|b| b.length()).fold(0.0, f64::max);
    Some(fraction * min_t.max(MIN_FIELD_SHARE * max_t))
}

/// Upper bound of the error of the exact values at nodes of a box, in tesla, from the field and
/// from the rounded coordinates of nodes and points.
fn value_rounding_t(direct: &DirectSum, region: &BoundingBox) -> f64 {
    let moved = NODE_ROUNDING * (region.lower.abs().max(region.upper.abs()) + region.half_size()).length();
    let of_tile = |((tile, around), weight)| {
        let distance = region.gap(around).length();
        // The derivative of a dipole's field is at most three times the bound of the field over r.
        (EXACT_BOUND * weight + 3.0 * moved / distance) * tile_field_bound_t(tile, distance)
    };
    direct.tiles().iter().zip(direct.boxes()).zip(direct.error_weights()).map(of_tile).sum()
}

/// The nodes of a box at which the field is evaluated. Nodes on one side of a plane of symmetry are
/// sufficient.
struct NodeSamples {
    region: BoundingBox,
    counts: [usize; 3],
    mirrors: Mirrors,
}

impl NodeSamples {
    fn new(region: BoundingBox, counts: [usize; 3], mirrors: Mirrors) -> NodeSamples {
        NodeSamples { region, counts, mirrors }
    }

    /// Numbers of evaluated nodes along x, y, z, beginning at the first.
    fn own_counts(&self) -> [usize; 3] {
        [0, 1, 2].map(|axis: usize| {
            let count = self.counts[axis];
            if self.mirrors.signs[axis].is_some() { count.div_ceil(2) } else { count }
        })
    }

    /// B at all nodes: for each component, z fastest, with rows of padded length. `None` if a node
    /// has no field.
    fn evaluate(&self, direct: &DirectSum) -> Option<[Vec<f64>; 3]> {
        let (centre, half) = (self.region.centre(), self.region.half_size());
        let [mx, my, mz] = self.own_counts();
        let [x, y, z] = [0, 1, 2].map(|axis: usize| -> Vec<f64> {
            nodes(self.counts[axis]).into_iter().map(|t| centre[axis] + half[axis] * t).collect()
        });
        let mut points = Vec::with_capacity(mx * my * mz);
        for &x in &x[..mx] {
            for &y in &y[..my] {
                points.extend(z[..mz].iter().map(|&z| DVec3::new(x, y, z)));
            }
        }
        let mut field = vec![DVec3::ZERO; points.len()];
        direct.exact_field_into(Quantity::FluxDensity, &points, &mut field).ok()?;
        let [nx, ny, nz] = self.counts;
        let stride = padded(nz);
        Some([0, 1, 2].map(|component: usize| {
            let factor = |axis: usize| self.mirrors.factor(component, axis).unwrap_or(1.0);
            let mut values = vec![0.0; nx * ny * stride];
            for (row, field) in field.chunks_exact(mz).enumerate() {
                let start = (row / my * ny + row % my) * stride;
                let values = &mut values[start..start + nz];
                for (value, b) in values.iter_mut().zip(field) {
                    *value = b[component];
                }
                for k in mz..nz {
                    values[k] = factor(2) * values[nz - 1 - k];
                }
            }
            for i in 0..mx {
                for j in my..ny {
                    let (image, own) = ((i * ny + j) * stride, (i * ny + ny - 1 - j) * stride);
                    for k in 0..nz {
                        values[image + k] = factor(1) * values[own + k];
                    }
                }
            }
            let slab = ny * stride;
            for i in mx..nx {
                for n in 0..slab {
                    values[i * slab + n] = factor(0) * values[(nx - 1 - i) * slab + n];
                }
            }
            values
        }))
    }
}

/// The Chebyshev coefficients of the values at all nodes.
#[inline(always)]
fn all_coefficients<S: Simd>(
    simd: S,
    counts: [usize; 3],
    degrees: [[Degrees; 2]; 3],
    values_t: &[Vec<f64>; 3],
) -> [Vec<f64>; 3] {
    let [nx, ny, nz] = counts;
    let stride = padded(nz);
    let [along_x, along_y, along_z] = counts.map(transform);
    let mut columns_z = vec![0.0; nz * stride];
    for (k, row) in along_z.iter().enumerate() {
        for (i, weight) in row.iter().enumerate() {
            columns_z[i * stride + k] = *weight;
        }
    }
    let mut all = [vec![], vec![], vec![]];
    for ((coefficients, values), [degrees_x, degrees_y]) in all.iter_mut().zip(values_t).zip(degrees) {
        let slab = degrees_y.below(ny).count() * stride;
        let mut along_yz = vec![0.0; nx * slab];
        let mut plane = vec![0.0; ny * stride];
        for (values, sums) in values.chunks_exact(ny * stride).zip(along_yz.chunks_exact_mut(slab)) {
            for (values, sum) in values.chunks_exact(stride).zip(plane.chunks_exact_mut(stride)) {
                weighted_sum(simd, &values[..nz], &columns_z, sum);
            }
            for (degree, sum) in degrees_y.below(ny).zip(sums.chunks_exact_mut(stride)) {
                weighted_sum(simd, &along_y[degree], &plane, sum);
            }
        }
        *coefficients = vec![0.0; degrees_x.below(nx).count() * slab];
        for (degree, sum) in degrees_x.below(nx).zip(coefficients.chunks_exact_mut(slab)) {
            weighted_sum(simd, &along_x[degree], &along_yz, sum);
        }
    }
    all
}
