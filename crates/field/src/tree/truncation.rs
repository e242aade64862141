//! Truncation errors of a node's expansion, and the degrees that keep an allowed truncation error
//! (docs/physics.md, section 5.2).

use std::sync::LazyLock;

use glam::DVec3;
use magsplice_cuboid::tolerances::FARTHEST;
use magsplice_expansion::tolerances::{HIGHEST_DEGREE, HIGHEST_LOCAL_DEGREE, POINTS_PER_DEGREE};
use magsplice_magnet::BoundingBox;
use magsplice_simd::lanes::LONGEST_VECTOR;

use super::blocks::TreeBlock;
use super::interaction::{ExpandedNode, TranslatedNode};
use super::nodes::{Tree, TreeNode};
use crate::tolerances::{CORNER_MEAN_TILES, DISTANCE_BISECTIONS, MIN_NODE_DISTANCE, SPHERE_GAPS};
use magsplice_direct::far_field::DegreesByPoints;

/// By degree P of a local expansion: (P + 2)^1/2, the factor of the next degree in Eq. P37, and the
/// largest ratio of two successive factors after it.
static NEXT_DEGREE_FACTORS: LazyLock<Vec<[f64; 2]>> = LazyLock::new(|| {
    let next = (0..=HIGHEST_LOCAL_DEGREE).map(|degree| (degree + 2) as f64);
    next.map(|next| [next.sqrt(), (1.0 + 1.0 / next).sqrt()]).collect()
});

impl Tree {
    /// A node with the lowest degree whose truncation error is at most `allowed_t` at all points of
    /// a box. The degree is 0 if the whole field of the node is within `allowed_t`. `None` if the
    /// box is too near, or too far.
    pub(super) fn expanded_node(&self, node: usize, points: &BoundingBox, allowed_t: f64) -> Option<ExpandedNode> {
        let of = &self.nodes[node];
        let distance = of.distance(points);
        if distance < MIN_NODE_DISTANCE * of.radius * of.scale || distance * distance > FARTHEST {
            return None;
        }
        let mut term = DegreePower::new(of.degree, distance);
        let remainder_t = self.remainder_bound_t(node, &term);
        if remainder_t > allowed_t {
            return None;
        }
        let bounds_t = &self.node_expansion(node).field_bounds_t;
        let (mut degree, mut truncation_error_t) = (of.degree, remainder_t);
        // From the highest degree down, because most degrees are needed.
        while degree > 0 && truncation_error_t + bounds_t[degree] * term.power <= allowed_t {
            truncation_error_t += bounds_t[degree] * term.power;
            degree -= 1;
            term.lower_degree();
        }
        Some(ExpandedNode { node, distance, degree, truncation_error_t })
    }

    /// Sets the degree for each [`POINTS_PER_DEGREE`] points, given by axis, and the bound of the
    /// truncation error there.
    pub(super) fn set_degrees(&self, expanded: &ExpandedNode, points: [&[f64]; 3], degrees: &mut DegreesByPoints) {
        let errors_t = self.truncation_errors_t(expanded);
        degrees.clear();
        self.for_point_groups(expanded.node, expanded.distance, expanded.degree, points, |ratio, mut power| {
            let mut degree = expanded.degree;
            let mut own_t = errors_t[degree] * power;
            while degree > 0 {
                power = lower_power(power, ratio, degree + 2);
                let lower_t = errors_t[degree - 1] * power;
                if lower_t > expanded.truncation_error_t {
                    break;
                }
                (degree, own_t) = (degree - 1, lower_t);
            }
            degrees.degree.push(degree);
            degrees.truncation_error_t.push(own_t);
        });
    }

    /// Adds the bound of a translated node's truncation error, in tesla, at points given by axis.
    pub(super) fn add_truncation_error(&self, of: &TranslatedNode, points: [&[f64]; 3], errors_t: &mut [f64]) {
        let mut groups = errors_t.chunks_mut(POINTS_PER_DEGREE);
        self.for_point_groups(of.node, of.distance, of.degree, points, |_, power| {
            let own_t = of.truncation_error_t * power + of.local_truncation_error_t;
            groups.next().into_iter().flatten().for_each(|sum_t| *sum_t += own_t);
        });
    }

    /// Calls `each` for each [`POINTS_PER_DEGREE`] points, given by axis, with the ratio of the
    /// smallest distance from a node's centre to `distance`, and with ratio^-(degree + 3), by which
    /// the field of higher degrees decreases.
    fn for_point_groups(
        &self,
        node: usize,
        distance: f64,
        degree: usize,
        [x, y, z]: [&[f64]; 3],
        mut each: impl FnMut(f64, f64),
    ) {
        let of = &self.nodes[node];
        let to_ratio = of.scale / distance;
        let chunk = POINTS_PER_DEGREE * LONGEST_VECTOR;
        for ((x, y), z) in x.chunks(chunk).zip(y.chunks(chunk)).zip(z.chunks(chunk)) {
            let mut ratios = [1.0; LONGEST_VECTOR];
            let groups = x.chunks(POINTS_PER_DEGREE).zip(y.chunks(POINTS_PER_DEGREE)).zip(z.chunks(POINTS_PER_DEGREE));
            for (ratio, ((x, y), z)) in ratios.iter_mut().zip(groups) {
                *ratio = least_squared_distance(of.centre, [x, y, z]).sqrt() * to_ratio;
            }
            let powers = integer_powers(ratios.map(|ratio| 1.0 / ratio), degree + 3);
            let count = x.len().div_ceil(POINTS_PER_DEGREE);
            ratios.iter().zip(powers).take(count).for_each(|(ratio, power)| each(*ratio, power));
        }
    }

    /// Bound of the truncation error of each degree of a node at the nearest points, in tesla. At n
    /// times the distance it is smaller by at least n^(degree + 3).
    fn truncation_errors_t(&self, expanded: &ExpandedNode) -> [f64; HIGHEST_DEGREE + 1] {
        let bounds_t = &self.node_expansion(expanded.node).field_bounds_t;
        let mut errors_t = [0.0; HIGHEST_DEGREE + 1];
        let highest = self.nodes[expanded.node].degree;
        let mut term = DegreePower::new(highest, expanded.distance);
        errors_t[highest] = self.remainder_bound_t(expanded.node, &term);
        for degree in (0..highest).rev() {
            errors_t[degree] = errors_t[degree + 1] + bounds_t[degree + 1] * term.power;
            term.lower_degree();
        }
        errors_t
    }

    /// The lowest degree of a node's local expansion whose truncation error is at most `allowed_t`
    /// within `radius` of `centre` (Eq. P37), and the bound of that error in tesla.
    ///
    /// The error is relative to the node's expansion of degree `degree`. `None` if the degree would
    /// exceed [`HIGHEST_LOCAL_DEGREE`].
    pub(super) fn local_degree(
        &self,
        node: usize,
        degree: usize,
        centre: DVec3,
        radius: f64,
        allowed_t: f64,
    ) -> Option<(usize, f64)> {
        let of = &self.nodes[node];
        let (distance, radius, node_radius) =
            ((centre - of.centre).length() * of.scale, radius * of.scale, of.radius * of.scale);
        if distance * distance > FARTHEST {
            return None;
        }
        let gaps = SPHERE_GAPS.map(|gap| gap * node_radius);
        let overs = gaps.map(|gap| 1.0 / gap);
        let mut means_t = [0.0; SPHERE_GAPS.len()];
        for mean in self.node_expansion(node).mean_field_bounds_t[1..=degree].iter().rev() {
            for (sum, over) in means_t.iter_mut().zip(overs) {
                *sum = (*sum + mean) * over;
            }
        }
        let ratios = gaps.map(|gap| radius / (distance - gap));
        // The degree after the highest.
        let last_powers = integer_powers(ratios, HIGHEST_LOCAL_DEGREE + 1);
        let [root, growth] = NEXT_DEGREE_FACTORS[HIGHEST_LOCAL_DEGREE];
        let mut best = None;
        for (index, ratio) in ratios.into_iter().enumerate() {
            let sphere = distance - gaps[index];
            // Upper bound of the root mean square of the field on the sphere.
            let mut power = means_t[index] * overs[index] / (2.0 * (distance * sphere).sqrt());
            if sphere <= radius || power * last_powers[index] * root > allowed_t * (1.0 - ratio * growth) {
                continue;
            }
            let highest = best.map_or(HIGHEST_LOCAL_DEGREE, |(degree, _)| degree);
            for (local_degree, [root, growth]) in NEXT_DEGREE_FACTORS[..=highest].iter().enumerate() {
                // The next degree, and the geometric series that bounds all further degrees.
                power *= ratio;
                let rest = 1.0 - ratio * growth;
                if rest > 0.0 && power * root <= allowed_t * rest {
                    let error_t = power * root / rest;
                    if best.is_none_or(|(degree, least_t)| local_degree < degree || error_t < least_t) {
                        best = Some((local_degree, error_t));
                    }
                    break;
                }
            }
        }
        best
    }

    /// Smallest distance from a node's centre, to within a bisection, at which the truncation error
    /// of its expansion is at most `allowed_t`. `None` if all points of a box are nearer.
    pub(super) fn expansion_distance(
        &self,
        node: usize,
        points: &BoundingBox,
        allowed_t: f64,
    ) -> Option<(f64, ExpandedNode)> {
        let of = &self.nodes[node];
        let centre = of.centre;
        let farthest = (points.upper - centre).abs().max((points.lower - centre).abs()).length() * of.scale;
        let (mut short, mut enough) = (of.distance(points).max(MIN_NODE_DISTANCE * of.radius * of.scale), farthest);
        let remainder_t = |distance: f64| self.remainder_bound_t(node, &DegreePower::new(of.degree, distance));
        if farthest * farthest > FARTHEST || short >= enough || remainder_t(farthest) > allowed_t {
            return None;
        }
        for _ in 0..DISTANCE_BISECTIONS {
            let middle = 0.5 * (short + enough);
            if remainder_t(middle) <= allowed_t {
                enough = middle;
            } else {
                short = middle;
            }
        }
        let nearest = ExpandedNode { node, distance: enough, degree: of.degree, truncation_error_t: allowed_t };
        Some((enough / of.scale, nearest))
    }

    /// Upper bound of the field of all degrees beyond a node's own, in tesla (Eq. P29). A geometric
    /// series bounds the sum of the fields of dipoles over the degrees.
    fn remainder_bound_t(&self, node: usize, own: &DegreePower) -> f64 {
        let of = &self.nodes[node];
        let l = (of.degree + 1) as f64;
        let over = 1.0 / own.distance;
        let next = self.absolute_moment_t(of) * l * (l + 1.0) * own.power * over;
        let ratio = of.radius * of.scale * over * (1.0 + 2.0 / l);
        if ratio < 1.0 { next / (1.0 - ratio) } else { f64::INFINITY }
    }

    fn absolute_moment_t(&self, node: &TreeNode) -> f64 {
        let power = node.degree as i32;
        *node.absolute_moment_t.get_or_init(|| {
            let blocks = &self.blocks[node.blocks.clone()];
            let moment_t = |block: &TreeBlock| {
                let mean = if blocks.len() <= CORNER_MEAN_TILES {
                    block.mean_power(self.rotations[block.frame].as_ref(), node.centre, node.scale, power)
                } else {
                    (((block.centre - node.centre).length() + block.half_diagonal) * node.scale).powi(power)
                };
                block.strength_t(node.scale) * mean
            };
            blocks.iter().map(moment_t).sum()
        })
    }
}

/// The power of the distance that governs the field of a degree, distance^-(degree + 2).
struct DegreePower {
    degree: usize,
    distance: f64,
    power: f64,
}

impl DegreePower {
    fn new(degree: usize, distance: f64) -> DegreePower {
        let [power] = integer_powers([1.0 / distance], degree + 2);
        DegreePower { degree, distance, power }
    }

    fn lower_degree(&mut self) {
        self.degree -= 1;
        self.power = lower_power(self.power, self.distance, self.degree + 2);
    }
}

/// distance^-exponent, from distance^-(exponent + 1). Where the higher power underflows the lower
/// power may not, and is computed anew.
fn lower_power(power: f64, distance: f64, exponent: usize) -> f64 {
    if power.is_normal() { power * distance } else { inverse_power(distance, exponent) }
}

/// distance^-exponent. Not inlined, because otherwise the compiler computes it for all points.
#[cold]
#[inline(never)]
fn inverse_power(distance: f64, exponent: usize) -> f64 {
    distance.powi(-(exponent as i32))
}

/// Smallest squared distance of points from a centre. Points that are NaN are ignored.
fn least_squared_distance(centre: DVec3, [x, y, z]: [&[f64]; 3]) -> f64 {
    // Four independent minima.
    let mut least = [f64::INFINITY; 4];
    for ((x, y), z) in x.chunks(least.len()).zip(y.chunks(least.len())).zip(z.chunks(least.len())) {
        for (least, ((x, y), z)) in least.iter_mut().zip(x.iter().zip(y).zip(z)) {
            let [x, y, z] = [x - centre.x, y - centre.y, z - centre.z];
            let square = x * x + y * y + z * z;
            *least = if square < *least { square } else { *least };
        }
    }
    least.into_iter().fold(f64::INFINITY, f64::min)
}

/// An integer power of each number.
fn integer_powers<const N: usize>(mut numbers: [f64; N], mut exponent: usize) -> [f64; N] {
    let mut powers = [1.0; N];
    while exponent > 0 {
        for (power, number) in powers.iter_mut().zip(&mut numbers) {
            *power *= if exponent % 2 == 1 { *number } else { 1.0 };
            *number *= *number;
        }
        exponent /= 2;
    }
    powers
}
