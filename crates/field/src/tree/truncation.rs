//! Which degree of a node's expansion is enough where, and what it leaves out there (docs/physics.md, section 5.2).

use std::sync::LazyLock;

use glam::DVec3;
use magsplice_cuboid::tolerances::FARTHEST;
use magsplice_expansion::tolerances::{HIGHEST_DEGREE, HIGHEST_LOCAL_DEGREE, POINTS_PER_DEGREE};
use magsplice_magnet::BoundingBox;
use magsplice_simd::lanes::LONGEST_VECTOR;

use super::interaction::{ExpandedNode, TranslatedNode};
use super::nodes::{Body, Node, Tree};
use crate::direct::far_field::DegreesByPoints;
use crate::tolerances::{CORNERED_TILES, DISTANCE_BISECTIONS, NEAREST_NODE, SPHERE_GAPS};

/// Of the degree after each, n + 1 under the root, and the factor by which that grows from there on at most.
static NEXT_DEGREES: LazyLock<Vec<[f64; 2]>> = LazyLock::new(|| {
    let next = (0..=HIGHEST_LOCAL_DEGREE).map(|degree| (degree + 2) as f64);
    next.map(|next| [next.sqrt(), (1.0 + 1.0 / next).sqrt()]).collect()
});

impl Tree {
    /// The lowest degree, and the most it leaves out in tesla, that leaves out no more than `allowed_t` of a node's field at all points of a box; 0 if all
    /// of it may be left out.
    pub(super) fn expanded(&self, node: usize, points: &BoundingBox, allowed_t: f64) -> Option<ExpandedNode> {
        let of = &self.nodes[node];
        let distance = of.distance(points);
        if distance < NEAREST_NODE * of.radius * of.scale || distance * distance > FARTHEST {
            return None;
        }
        let mut term = Falling::from(of.degree, distance);
        let beyond_t = self.beyond_t(node, &term);
        if beyond_t > allowed_t {
            return None;
        }
        let powers = &self.outside(node).powers;
        let (mut degree, mut left_out_t) = (of.degree, beyond_t);
        // From the highest degree down, as most are kept.
        while degree > 0 && left_out_t + powers[degree] * term.power <= allowed_t {
            left_out_t += powers[degree] * term.power;
            degree -= 1;
            term.lower();
        }
        Some(ExpandedNode { node, distance, degree, truncation_error_t: left_out_t })
    }

    /// The degree for each [`POINTS_PER_DEGREE`] points, given by axis, and the most it leaves out there.
    pub(super) fn set_degrees(&self, what: &ExpandedNode, points: [&[f64]; 3], degrees: &mut DegreesByPoints) {
        let left_out_t = self.truncation_errors_from(what);
        degrees.clear();
        self.for_neighbours(what.node, what.distance, what.degree, points, |times, mut power| {
            let mut degree = what.degree;
            let mut own_t = left_out_t[degree] * power;
            while degree > 0 {
                power = lower(power, times, degree + 2);
                let lower_t = left_out_t[degree - 1] * power;
                if lower_t > what.truncation_error_t {
                    break;
                }
                (degree, own_t) = (degree - 1, lower_t);
            }
            degrees.degree.push(degree);
            degrees.truncation_error_t.push(own_t);
        });
    }

    /// Adds what a translated node leaves out at most, in tesla, at points given by axis.
    pub(super) fn add_truncation_error(&self, of: &TranslatedNode, points: [&[f64]; 3], left_out_t: &mut [f64]) {
        let mut neighbours = left_out_t.chunks_mut(POINTS_PER_DEGREE);
        self.for_neighbours(of.node, of.distance, of.degree, points, |_, power| {
            let own_t = of.truncation_error_t * power + of.local_truncation_error_t;
            neighbours.next().into_iter().flatten().for_each(|sum_t| *sum_t += own_t);
        });
    }

    /// For each [`POINTS_PER_DEGREE`] points: how many times as far as `distance` from a node's centre the nearest of them is, to which power of that, inverse, degrees
    /// beyond one fall.
    fn for_neighbours(
        &self,
        node: usize,
        distance: f64,
        degree: usize,
        [x, y, z]: [&[f64]; 3],
        mut each: impl FnMut(f64, f64),
    ) {
        let of = &self.nodes[node];
        let to_times = of.scale / distance;
        let together = POINTS_PER_DEGREE * LONGEST_VECTOR;
        for ((x, y), z) in x.chunks(together).zip(y.chunks(together)).zip(z.chunks(together)) {
            let mut times = [1.0; LONGEST_VECTOR];
            let neighbours =
                x.chunks(POINTS_PER_DEGREE).zip(y.chunks(POINTS_PER_DEGREE)).zip(z.chunks(POINTS_PER_DEGREE));
            for (times, ((x, y), z)) in times.iter_mut().zip(neighbours) {
                *times = least_square(of.centre, [x, y, z]).sqrt() * to_times;
            }
            let powers = powers(times.map(|times| 1.0 / times), degree + 3);
            let count = x.len().div_ceil(POINTS_PER_DEGREE);
            times.iter().zip(powers).take(count).for_each(|(times, power)| each(*times, power));
        }
    }

    /// What each degree of a node's expansion leaves out at the nearest points, at most, in tesla; n times farther it is less by n^(degree + 3) at least.
    fn truncation_errors_from(&self, what: &ExpandedNode) -> [f64; HIGHEST_DEGREE + 1] {
        let powers = &self.outside(what.node).powers;
        let mut left_out_t = [0.0; HIGHEST_DEGREE + 1];
        let highest = self.nodes[what.node].degree;
        let mut terms_t = Falling::from(highest, what.distance);
        left_out_t[highest] = self.beyond_t(what.node, &terms_t);
        for degree in (0..highest).rev() {
            left_out_t[degree] = left_out_t[degree + 1] + powers[degree + 1] * terms_t.power;
            terms_t.lower();
        }
        left_out_t
    }

    /// The lowest degree of the field around `middle`, and the most it leaves out in tesla, that within `reach` of it leaves out no more than `allowed_t` of a
    /// node's expansion of this degree; `None` if it were too high.
    pub(super) fn local_degree(
        &self,
        node: usize,
        degree: usize,
        middle: DVec3,
        reach: f64,
        allowed_t: f64,
    ) -> Option<(usize, f64)> {
        let of = &self.nodes[node];
        let (distance, reach, radius) =
            ((middle - of.centre).length() * of.scale, reach * of.scale, of.radius * of.scale);
        if distance * distance > FARTHEST {
            return None;
        }
        let gaps = SPHERE_GAPS.map(|gap| gap * radius);
        let overs = gaps.map(|gap| 1.0 / gap);
        let mut means_t = [0.0; SPHERE_GAPS.len()];
        for mean in self.outside(node).means[1..=degree].iter().rev() {
            for (sum, over) in means_t.iter_mut().zip(overs) {
                *sum = (*sum + mean) * over;
            }
        }
        let ratios = gaps.map(|gap| reach / (distance - gap));
        // Of the degree after the highest.
        let falls = powers(ratios, HIGHEST_LOCAL_DEGREE + 1);
        let [root, growth] = NEXT_DEGREES[HIGHEST_LOCAL_DEGREE];
        let mut best = None;
        for (index, ratio) in ratios.into_iter().enumerate() {
            let sphere = distance - gaps[index];
            // The root of the mean square of the field on the sphere, at most.
            let mut power = means_t[index] * overs[index] / (2.0 * (distance * sphere).sqrt());
            if sphere <= reach || power * falls[index] * root > allowed_t * (1.0 - ratio * growth) {
                continue;
            }
            let most = best.map_or(HIGHEST_LOCAL_DEGREE, |(degree, _)| degree);
            for (local_degree, [root, growth]) in NEXT_DEGREES[..=most].iter().enumerate() {
                // The degree that comes next, and what follows it.
                power *= ratio;
                let rest = 1.0 - ratio * growth;
                if rest > 0.0 && power * root <= allowed_t * rest {
                    let left_out_t = power * root / rest;
                    if best.is_none_or(|(degree, least_t)| local_degree < degree || left_out_t < least_t) {
                        best = Some((local_degree, left_out_t));
                    }
                    break;
                }
            }
        }
        best
    }

    /// The distance from a node's centre from which its expansion leaves out no more than `allowed_t`; `None` if all points of a box are nearer.
    pub(super) fn least_distance(
        &self,
        node: usize,
        points: &BoundingBox,
        allowed_t: f64,
    ) -> Option<(f64, ExpandedNode)> {
        let of = &self.nodes[node];
        let centre = of.centre;
        let farthest = (points.upper - centre).abs().max((points.lower - centre).abs()).length() * of.scale;
        let (mut short, mut enough) = (of.distance(points).max(NEAREST_NODE * of.radius * of.scale), farthest);
        let beyond_t = |distance: f64| self.beyond_t(node, &Falling::from(of.degree, distance));
        if farthest * farthest > FARTHEST || short >= enough || beyond_t(farthest) > allowed_t {
            return None;
        }
        for _ in 0..DISTANCE_BISECTIONS {
            let middle = 0.5 * (short + enough);
            if beyond_t(middle) <= allowed_t {
                enough = middle;
            } else {
                short = middle;
            }
        }
        let nearest = ExpandedNode { node, distance: enough, degree: of.degree, truncation_error_t: allowed_t };
        Some((enough / of.scale, nearest))
    }

    /// At most the field in tesla of all degrees beyond a node's own, whose field falls like this: the magnitudes of dipoles' fields by degree, summed as the geometric
    /// series they stay below.
    fn beyond_t(&self, node: usize, own: &Falling) -> f64 {
        let of = &self.nodes[node];
        let l = (of.degree + 1) as f64;
        let over = 1.0 / own.distance;
        let next = self.reach_t(of) * l * (l + 1.0) * own.power * over;
        let fall = of.radius * of.scale * over * (1.0 + 2.0 / l);
        if fall < 1.0 { next / (1.0 - fall) } else { f64::INFINITY }
    }

    fn reach_t(&self, node: &Node) -> f64 {
        let power = node.degree as i32;
        *node.reach_t.get_or_init(|| {
            let bodies = &self.bodies[node.bodies.clone()];
            let reach = |body: &Body| {
                let mean = if bodies.len() <= CORNERED_TILES {
                    body.mean_power(self.rotations[body.frame].as_ref(), node.centre, node.scale, power)
                } else {
                    (((body.centre - node.centre).length() + body.half_diagonal) * node.scale).powi(power)
                };
                body.strength_t(node.scale) * mean
            };
            bodies.iter().map(reach).sum()
        })
    }
}

/// The powers of an inverse distance with which the field of each degree falls, from a degree down.
struct Falling {
    degree: usize,
    distance: f64,
    /// distance^-(degree + 2)
    power: f64,
}

impl Falling {
    fn from(degree: usize, distance: f64) -> Falling {
        let [power] = powers([1.0 / distance], degree + 2);
        Falling { degree, distance, power }
    }

    fn lower(&mut self) {
        self.degree -= 1;
        self.power = lower(self.power, self.distance, self.degree + 2);
    }
}

/// distance^-exponent from the power before. So far away that this vanishes a lower one may not.
fn lower(power: f64, distance: f64, exponent: usize) -> f64 {
    if power.is_normal() { power * distance } else { power_of_far(distance, exponent) }
}

/// Not taken where it is not needed: the compiler would compute it everywhere.
#[cold]
#[inline(never)]
fn power_of_far(distance: f64, exponent: usize) -> f64 {
    distance.powi(-(exponent as i32))
}

/// Of the distances of points from a centre; those that are no numbers do not count.
fn least_square(centre: DVec3, [x, y, z]: [&[f64]; 3]) -> f64 {
    // Several at a time.
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

/// Of several numbers at a time.
fn powers<const N: usize>(mut numbers: [f64; N], mut exponent: usize) -> [f64; N] {
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
