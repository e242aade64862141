//! The cells of a box: the harmonic potentials in them, from the expansion of the whole box, and what they leave out.

use fearless_simd::Level;
use glam::DVec3;
use rayon::prelude::*;

use super::chebyshev::{nodes, polynomials, transform};
use super::fit::{Fit, tail_of};
use super::harmonic_potential::{CELL, Potential, harmonics};
use super::weighted_sums::{combine, padded};
use crate::scalar_product::scalar_product;
use crate::tolerances::CELL_DEGREE;

/// Nodes of a cell along each axis: no fewer, or the gradients of the potentials are not told from each other.
const NODES: usize = if CELL_DEGREE % 2 == 1 { CELL_DEGREE + 1 } else { CELL_DEGREE + 2 };
/// Of them on one side of the middle, as many as there are even degrees, or odd ones.
const HALF: usize = NODES / 2;
/// Coefficients that are even or odd along the axes alike.
const ALIKE: usize = HALF * HALF * HALF;
/// Coefficients of one component.
const COMPONENT: usize = 8 * ALIKE;

/// Of a gradient what is left beside those before, as a fraction of it, below which it is none of its own: far above round-off. Only in cells that are
/// thousands of times longer than wide are there such.
const OF_ITS_OWN: f64 = 1e-10;

/// All cells of a box, one shape.
pub(super) struct Cells {
    /// [`CELL`] numbers for each.
    pub(super) numbers: Vec<f64>,
    /// At most what any of them leaves out of the expansion of the box, in tesla.
    pub(super) left_out_t: f64,
}

impl Cells {
    /// The box of a fit divided. Lengths are multiplied by `scale`.
    pub(super) fn new(level: Level, fit: &Fit, counts: [usize; 3], scale: f64) -> Cells {
        let half = fit.region.half_size() * scale / DVec3::from(counts.map(|count| count as f64));
        let shape = Shape::new(half);
        let along = [0, 1, 2].map(|axis| AlongAxis::new(fit.counts[axis], counts[axis]));
        let (slab, room) = (Fit::slab(fit.counts), padded(fit.counts[2]));
        let in_row = counts[1] * counts[2];
        let mut numbers = vec![0.0; counts[0] * in_row * CELL];
        let rows = numbers.par_chunks_mut(in_row * CELL).enumerate();
        let left_out = rows.map(|(i, numbers)| {
            let (mut plane, mut line) = (vec![0.0; slab], vec![0.0; room]);
            let mut along_z = vec![0.0; padded(NODES * counts[2])];
            // Cell by cell, then component, then coefficients by whether they are even or odd along x, y, z.
            let mut coefficients = vec![0.0; in_row * 3 * COMPONENT];
            for component in 0..3 {
                for a in 0..NODES {
                    combine(level, along[0].row(i * NODES + a), &fit.coefficients[component], &mut plane);
                    for jb in 0..counts[1] * NODES {
                        let (j, b) = (jb / NODES, jb % NODES);
                        combine(level, along[1].row(jb), &plane, &mut line);
                        combine(level, &line[..fit.counts[2]], &along[2].columns, &mut along_z);
                        for (k, along_z) in along_z.chunks_exact(NODES).take(counts[2]).enumerate() {
                            let start = ((j * counts[2] + k) * 3 + component) * COMPONENT;
                            for (c, value) in along_z.iter().enumerate() {
                                coefficients[start + place([a, b, c])] = *value;
                            }
                        }
                    }
                }
            }
            let cells = coefficients.chunks_exact(3 * COMPONENT).zip(numbers.chunks_exact_mut(CELL));
            cells.map(|(coefficients, numbers)| shape.divide(level, coefficients, numbers)).fold(0.0, f64::max)
        });
        let left_out_t = left_out.reduce(|| 0.0, f64::max);
        Cells { numbers, left_out_t }
    }
}

/// Where a coefficient of these degrees is: even and odd degrees apart.
fn place([a, b, c]: [usize; 3]) -> usize {
    let alike = (a % 2) * 4 + (b % 2) * 2 + c % 2;
    alike * ALIKE + ((a / 2) * HALF + b / 2) * HALF + c / 2
}

/// What each coefficient of a box adds to those of its cells along an axis.
struct AlongAxis {
    count: usize,
    /// For each coefficient of each cell one number for each of the box.
    rows: Vec<f64>,
    /// The same the other way round.
    columns: Vec<f64>,
}

impl AlongAxis {
    fn new(count: usize, cells: usize) -> AlongAxis {
        let transform = transform(NODES);
        let (mut rows, room) = (vec![0.0; cells * NODES * count], padded(cells * NODES));
        let mut columns = vec![0.0; count * room];
        for cell in 0..cells {
            let mut at_nodes = vec![vec![0.0; count]; NODES];
            for (node, values) in nodes(NODES).into_iter().zip(&mut at_nodes) {
                polynomials((2.0 * cell as f64 + 1.0 + node) / cells as f64 - 1.0, values);
            }
            for (degree, weights) in transform.iter().enumerate() {
                for of_box in 0..count {
                    let sum = weights.iter().zip(&at_nodes).map(|(w, values)| w * values[of_box]).sum();
                    rows[(cell * NODES + degree) * count + of_box] = sum;
                    columns[of_box * room + cell * NODES + degree] = sum;
                }
            }
        }
        AlongAxis { count, rows, columns }
    }

    fn row(&self, index: usize) -> &[f64] {
        &self.rows[index * self.count..(index + 1) * self.count]
    }
}

/// What is the same for all cells of a shape: their potentials, those that are even or odd along the axes alike together.
struct Shape {
    classes: Vec<Class>,
}

/// Potentials that are even or odd along the axes alike. Their gradients need only coefficients that are so too.
struct Class {
    odd: [bool; 3],
    /// Of each potential the numbers that its gradient is made of.
    parts: Vec<Vec<(usize, f64)>>,
    /// For each coefficient what it adds to each potential: those that leave the least sum of squares.
    amounts: Vec<f64>,
    /// For each potential the coefficients of its gradient.
    gradients: Vec<f64>,
}

/// Room for the coefficients of a class.
fn room() -> usize {
    padded(3 * ALIKE)
}

impl Shape {
    /// With the half sides `half`.
    fn new(half: DVec3) -> Shape {
        // All harmonics at the nodes of one octant, and from values there to coefficients.
        let (nodes, transform) = (nodes(NODES), transform(NODES));
        let octant: Vec<_> = (0..ALIKE)
            .map(|n| {
                let [i, j, k] = [n / (HALF * HALF), n / HALF % HALF, n % HALF];
                harmonics(CELL_DEGREE, half * DVec3::new(nodes[i], nodes[j], nodes[k]))
            })
            .collect();
        let class = |number: usize| {
            let odd = [number & 4 != 0, number & 2 != 0, number & 1 != 0];
            let potentials: Vec<Potential> = Potential::all().filter(|potential| potential.odd() == odd).collect();
            let mut gradients = vec![0.0; potentials.len() * room()];
            for (potential, coefficients) in potentials.iter().zip(gradients.chunks_exact_mut(room())) {
                let values: Vec<DVec3> = octant.iter().map(|harmonics| potential.gradient(harmonics)).collect();
                for component in 0..3 {
                    let mut values: Vec<f64> = values.iter().map(|b| b[component]).collect();
                    // AlongAxis z, then y, then x: the axis that is done comes first, and all others move up.
                    for axis in [2, 1, 0] {
                        let odd = usize::from(odd[axis] != (component == axis));
                        let mut turned = vec![0.0; ALIKE];
                        for (n, values) in values.chunks_exact(HALF).enumerate() {
                            for degree in 0..HALF {
                                let row = &transform[2 * degree + odd][..HALF];
                                let sum: f64 = row.iter().zip(values).map(|(w, v)| w * v).sum();
                                turned[degree * HALF * HALF + n] = 2.0 * sum;
                            }
                        }
                        values = turned;
                    }
                    coefficients[component * ALIKE..(component + 1) * ALIKE].copy_from_slice(&values);
                }
            }
            let amounts = least_squares(&gradients, potentials.len());
            Class { odd, parts: potentials.iter().map(Potential::parts).collect(), amounts, gradients }
        };
        Shape { classes: (0..8).map(class).collect() }
    }

    /// The numbers of a cell from its coefficients; at most what they leave out, in tesla.
    fn divide(&self, level: Level, coefficients: &[f64], numbers: &mut [f64]) -> f64 {
        let (mut own, mut found) = (vec![0.0; room()], vec![0.0; room()]);
        let mut left_out = DVec3::ZERO;
        for class in &self.classes {
            for (component, own) in own.chunks_exact_mut(ALIKE).take(3).enumerate() {
                own.copy_from_slice(class.coefficients(coefficients, component));
            }
            let mut amounts = vec![0.0; padded(class.parts.len())];
            combine(level, &own, &class.amounts, &mut amounts);
            let amounts = &amounts[..class.parts.len()];
            combine(level, amounts, &class.gradients, &mut found);
            for (component, (own, found)) in own.chunks_exact(ALIKE).zip(found.chunks_exact(ALIKE)).take(3).enumerate()
            {
                left_out[component] += own.iter().zip(found).map(|(own, found)| (own - found).abs()).sum::<f64>();
            }
            for (parts, amount) in class.parts.iter().zip(amounts) {
                for &(place, factor) in parts {
                    numbers[place] += amount * factor;
                }
            }
        }
        left_out.length() + tails_t(coefficients)
    }
}

impl Class {
    /// A component's coefficients that are odd where the gradients of these potentials are.
    fn coefficients<'a>(&self, all: &'a [f64], component: usize) -> &'a [f64] {
        let odd = [0, 1, 2].map(|axis: usize| usize::from(self.odd[axis] != (axis == component)));
        let start = component * COMPONENT + (odd[0] * 4 + odd[1] * 2 + odd[2]) * ALIKE;
        &all[start..start + ALIKE]
    }
}

/// At most what the nodes of a cell do not tell, as [`Fit`] estimates it.
fn tails_t(coefficients: &[f64]) -> f64 {
    let mut sums = [[DVec3::ZERO; NODES]; 3];
    for (component, coefficients) in coefficients.chunks_exact(COMPONENT).enumerate() {
        for (alike, coefficients) in coefficients.chunks_exact(ALIKE).enumerate() {
            let [x, y, z] = [alike / 4, alike / 2 % 2, alike % 2];
            for (i, plane) in coefficients.chunks_exact(HALF * HALF).enumerate() {
                for (j, line) in plane.chunks_exact(HALF).enumerate() {
                    let mut on_line = 0.0;
                    for (k, coefficient) in line.iter().enumerate() {
                        on_line += coefficient.abs();
                        sums[2][2 * k + z][component] += coefficient.abs();
                    }
                    sums[0][2 * i + x][component] += on_line;
                    sums[1][2 * j + y][component] += on_line;
                }
            }
        }
    }
    sums.iter().map(|sums| tail_of(&sums.map(|s| s.length())).sum_t).sum()
}

/// For rows that are not alike, what each entry of a vector adds to the factors with which their sum comes closest to it: room for all rows for each entry.
///
/// By orthogonal directions (Gram and Schmidt, twice each).
fn least_squares(rows: &[f64], count: usize) -> Vec<f64> {
    let length = rows.len() / count;
    let mut directions: Vec<Vec<f64>> = Vec::with_capacity(count);
    // Row j is the sum over i <= j of triangle[j][i] times direction i.
    let mut triangle = vec![vec![0.0; count]; count];
    for (row, factors) in rows.chunks_exact(length).zip(&mut triangle) {
        let mut rest = row.to_vec();
        for _ in 0..2 {
            for (direction, factor) in directions.iter().zip(&mut *factors) {
                let along = scalar_product(direction, &rest);
                *factor += along;
                rest.iter_mut().zip(direction).for_each(|(rest, d)| *rest -= along * d);
            }
        }
        let [whole, size] = [row, &rest].map(|row| scalar_product(row, row).sqrt());
        // Without a direction it gets nothing.
        let (size, over) = if size > OF_ITS_OWN * whole { (size, 1.0 / size) } else { (1.0, 0.0) };
        factors[directions.len()] = size;
        rest.iter_mut().for_each(|r| *r *= over);
        directions.push(rest);
    }
    // The factors solve triangle^T factors = directions . vector, from the last on, for all entries at a time.
    for i in (0..count).rev() {
        let (upper, lower) = directions.split_at_mut(i + 1);
        let own = &mut upper[i];
        for (below, row) in lower.iter().zip(&triangle[i + 1..]) {
            own.iter_mut().zip(below).for_each(|(own, below)| *own -= row[i] * below);
        }
        own.iter_mut().for_each(|own| *own /= triangle[i][i]);
    }
    let room = padded(count);
    let mut by_entry = vec![0.0; length * room];
    for (row, factors) in directions.iter().enumerate() {
        for (entry, factor) in factors.iter().enumerate() {
            by_entry[entry * room + row] = *factor;
        }
    }
    by_entry
}
