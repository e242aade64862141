//! Cells of a box: the Chebyshev fit of the whole box, restricted to each cell and projected onto
//! gradients of harmonic potentials (docs/physics.md, section 5.1).

use fearless_simd::Level;
use glam::DVec3;
use rayon::prelude::*;

use super::chebyshev::{nodes, polynomials, transform};
use super::fit::ChebyshevFit;
use super::harmonic_potential::{CELL_COEFFICIENTS, HarmonicPotential, harmonics};
use super::truncation_bound::lebesgue_bound;
use super::weighted_sums::{padded, weighted_sum_at};
use crate::scalar_product::scalar_product;
use crate::tolerances::CELL_DEGREE;

/// Number of nodes of a cell along each axis, even. With fewer nodes the gradients of the
/// potentials would be dependent.
const CELL_NODES: usize = if CELL_DEGREE % 2 == 1 { CELL_DEGREE + 1 } else { CELL_DEGREE + 2 };
/// Number of nodes on one side of the centre. It also equals the number of even degrees, and of odd
/// degrees.
const HALF_NODES: usize = CELL_NODES / 2;
/// Number of coefficients of a component with given parities along the three axes.
const PARITY_COEFFICIENTS: usize = HALF_NODES * HALF_NODES * HALF_NODES;
/// Number of coefficients of one component.
const COMPONENT_COEFFICIENTS: usize = 8 * PARITY_COEFFICIENTS;

/// Smallest component of a gradient orthogonal to the gradients before it, relative to the
/// gradient, for which it counts as independent. It is far above round-off; gradients are dependent
/// only in cells thousands of times longer than wide.
const MIN_ORTHOGONAL_PART: f64 = 1e-10;

/// Harmonic potentials of all cells of a box. All cells have the same shape.
pub(super) struct HarmonicCells {
    /// [`CELL_COEFFICIENTS`] numbers for each cell.
    pub(super) coefficients: Vec<f64>,
    /// Upper bound of the difference from the fit of the box in any cell, in tesla.
    pub(super) error_t: f64,
}

impl HarmonicCells {
    /// The potentials of `counts` cells along x, y, z. Lengths are multiplied by `scale`.
    pub(super) fn new(level: Level, fit: &ChebyshevFit, counts: [usize; 3], scale: f64) -> HarmonicCells {
        let half = fit.region.half_size() * scale / DVec3::from(counts.map(|count| count as f64));
        let projection = CellProjection::new(half);
        let along = [0, 1, 2].map(|axis| AxisRestriction::new(fit.counts[axis], counts[axis]));
        let dense = [0, 1, 2].map(|component| fit.dense_coefficients(component));
        let stride = padded(fit.counts[2]);
        let slab = fit.counts[1] * stride;
        let in_row = counts[1] * counts[2];
        let mut harmonic = vec![0.0; counts[0] * in_row * CELL_COEFFICIENTS];
        let rows = harmonic.par_chunks_mut(in_row * CELL_COEFFICIENTS).enumerate();
        let errors_t = rows.map(|(i, harmonic)| {
            let (mut plane, mut line) = (vec![0.0; slab], vec![0.0; stride]);
            let mut along_z = vec![0.0; padded(CELL_NODES * counts[2])];
            // Chebyshev coefficients by cell, then by component, then by parity along x, y, z.
            let mut coefficients = vec![0.0; in_row * 3 * COMPONENT_COEFFICIENTS];
            for (component, dense) in dense.iter().enumerate() {
                for a in 0..CELL_NODES {
                    weighted_sum_at(level, along[0].row(i * CELL_NODES + a), dense, &mut plane);
                    for jb in 0..counts[1] * CELL_NODES {
                        let (j, b) = (jb / CELL_NODES, jb % CELL_NODES);
                        weighted_sum_at(level, along[1].row(jb), &plane, &mut line);
                        weighted_sum_at(level, &line[..fit.counts[2]], &along[2].columns, &mut along_z);
                        for (k, along_z) in along_z.chunks_exact(CELL_NODES).take(counts[2]).enumerate() {
                            let start = ((j * counts[2] + k) * 3 + component) * COMPONENT_COEFFICIENTS;
                            for (c, value) in along_z.iter().enumerate() {
                                coefficients[start + coefficient_index([a, b, c])] = *value;
                            }
                        }
                    }
                }
            }
            let cells =
                coefficients.chunks_exact(3 * COMPONENT_COEFFICIENTS).zip(harmonic.chunks_exact_mut(CELL_COEFFICIENTS));
            cells.map(|(coefficients, harmonic)| projection.project(level, coefficients, harmonic)).fold(0.0, f64::max)
        });
        let error_t = errors_t.reduce(|| 0.0, f64::max) + truncation_error_t(fit, &dense, &along);
        HarmonicCells { coefficients: harmonic, error_t }
    }
}

/// Index of the coefficient of these degrees. Coefficients with the same parities along the axes
/// are contiguous.
fn coefficient_index([a, b, c]: [usize; 3]) -> usize {
    let parities = (a % 2) * 4 + (b % 2) * 2 + c % 2;
    parities * PARITY_COEFFICIENTS + ((a / 2) * HALF_NODES + b / 2) * HALF_NODES + c / 2
}

/// Upper bound of the error of interpolating the fit of a box in its cells, in tesla. The axes are
/// interpolated in turn.
fn truncation_error_t(fit: &ChebyshevFit, dense: &[Vec<f64>; 3], along: &[AxisRestriction; 3]) -> f64 {
    let mut growth = 1.0;
    let by_axis = along.iter().zip(magnitudes_by_degree_t(fit, dense)).map(|(axis, magnitudes_t)| {
        let error_t: f64 = axis.truncation_errors.iter().zip(magnitudes_t).map(|(error, sum_t)| error * sum_t).sum();
        let grown_t = growth * error_t;
        growth *= lebesgue_bound(CELL_NODES);
        grown_t
    });
    by_axis.sum()
}

/// For each degree along each axis, an upper bound of the length of the field of the coefficients
/// of that degree, in tesla.
fn magnitudes_by_degree_t(fit: &ChebyshevFit, dense: &[Vec<f64>; 3]) -> [Vec<f64>; 3] {
    let [_, ny, nz] = fit.counts;
    let stride = padded(nz);
    let mut sums = fit.counts.map(|count| vec![DVec3::ZERO; count]);
    for (component, coefficients) in dense.iter().enumerate() {
        for (row, coefficients) in coefficients.chunks_exact(stride).enumerate() {
            let mut on_row = 0.0;
            for (sum, coefficient) in sums[2].iter_mut().zip(coefficients) {
                sum[component] += coefficient.abs();
                on_row += coefficient.abs();
            }
            sums[0][row / ny][component] += on_row;
            sums[1][row % ny][component] += on_row;
        }
    }
    sums.map(|sums| sums.iter().map(|sum| sum.length()).collect())
}

/// Restriction of Chebyshev polynomials of a box to its cells, along one axis.
struct AxisRestriction {
    count: usize,
    /// For each polynomial of the box, an upper bound of the error of its interpolation in any
    /// cell.
    truncation_errors: Vec<f64>,
    /// For each coefficient of each cell, the factors of the coefficients of the box.
    rows: Vec<f64>,
    /// The transpose of `rows`.
    columns: Vec<f64>,
}

impl AxisRestriction {
    fn new(count: usize, cells: usize) -> AxisRestriction {
        let transform = transform(CELL_NODES);
        let (mut rows, stride) = (vec![0.0; cells * CELL_NODES * count], padded(cells * CELL_NODES));
        let mut columns = vec![0.0; count * stride];
        for cell in 0..cells {
            let mut at_nodes = vec![vec![0.0; count]; CELL_NODES];
            for (node, values) in nodes(CELL_NODES).into_iter().zip(&mut at_nodes) {
                polynomials((2.0 * cell as f64 + 1.0 + node) / cells as f64 - 1.0, values);
            }
            for (degree, weights) in transform.iter().enumerate() {
                for of_box in 0..count {
                    let sum = weights.iter().zip(&at_nodes).map(|(w, values)| w * values[of_box]).sum();
                    rows[(cell * CELL_NODES + degree) * count + of_box] = sum;
                    columns[of_box * stride + cell * CELL_NODES + degree] = sum;
                }
            }
        }
        let truncation_errors = (0..count).map(|of_box| truncation_error_of_polynomial(of_box, cells)).collect();
        AxisRestriction { count, truncation_errors, rows, columns }
    }

    fn row(&self, index: usize) -> &[f64] {
        &self.rows[index * self.count..(index + 1) * self.count]
    }
}

/// Upper bound of the error of interpolating T_`degree` of a box at the nodes of its cells: twice
/// the sum of its coefficients in a cell beyond the last node, in the worst cell.
fn truncation_error_of_polynomial(degree: usize, cells: usize) -> f64 {
    if degree < CELL_NODES {
        return 0.0;
    }
    let (nodes, transform) = (nodes(degree + 1), transform(degree + 1));
    let mut values = vec![0.0; degree + 1];
    // The cells on both sides of the middle mirror each other.
    let of_cell = |cell: usize| {
        let at_node = |node: &f64| {
            polynomials((2.0 * cell as f64 + 1.0 + node) / cells as f64 - 1.0, &mut values);
            values[degree]
        };
        let at_nodes: Vec<f64> = nodes.iter().map(at_node).collect();
        let coefficient = |row: &Vec<f64>| row.iter().zip(&at_nodes).map(|(w, v)| w * v).sum::<f64>().abs();
        2.0 * transform[CELL_NODES..].iter().map(coefficient).sum::<f64>()
    };
    (0..cells.div_ceil(2)).map(of_cell).fold(0.0, f64::max)
}

/// Least-squares projection of a cell's field onto gradients of harmonic potentials. It is the same
/// for all cells of a shape.
struct CellProjection {
    classes: Vec<ParityClass>,
}

/// Potentials with the same parities along the axes. Only coefficients with matching parities
/// contribute to their gradients.
struct ParityClass {
    odd: [bool; 3],
    /// The gradient of each potential in terms of a cell's coefficients: index and factor.
    gradient_terms: Vec<Vec<(usize, f64)>>,
    /// For each Chebyshev coefficient, its contribution to the least-squares factor of each
    /// potential.
    least_squares: Vec<f64>,
    /// Chebyshev coefficients of the gradient of each potential.
    gradients: Vec<f64>,
}

/// Padded number of the coefficients of a class.
fn class_stride() -> usize {
    padded(3 * PARITY_COEFFICIENTS)
}

impl CellProjection {
    /// The projection in a cell with the half sides `half`.
    fn new(half: DVec3) -> CellProjection {
        // All harmonics at the nodes of one octant; the parities give the others.
        let (nodes, transform) = (nodes(CELL_NODES), transform(CELL_NODES));
        let octant: Vec<_> = (0..PARITY_COEFFICIENTS)
            .map(|n| {
                let [i, j, k] = [n / (HALF_NODES * HALF_NODES), n / HALF_NODES % HALF_NODES, n % HALF_NODES];
                harmonics(CELL_DEGREE, half * DVec3::new(nodes[i], nodes[j], nodes[k]))
            })
            .collect();
        let class = |number: usize| {
            let odd = [number & 4 != 0, number & 2 != 0, number & 1 != 0];
            let potentials: Vec<HarmonicPotential> =
                HarmonicPotential::all().filter(|potential| potential.odd() == odd).collect();
            let mut gradients = vec![0.0; potentials.len() * class_stride()];
            for (potential, coefficients) in potentials.iter().zip(gradients.chunks_exact_mut(class_stride())) {
                let values: Vec<DVec3> = octant.iter().map(|harmonics| potential.gradient(harmonics)).collect();
                for component in 0..3 {
                    let mut values: Vec<f64> = values.iter().map(|b| b[component]).collect();
                    // The transform runs along z, then y, then x. The transformed axis becomes the
                    // slowest, and the next axis the fastest.
                    for axis in [2, 1, 0] {
                        let odd = usize::from(odd[axis] != (component == axis));
                        let mut transformed = vec![0.0; PARITY_COEFFICIENTS];
                        for (n, values) in values.chunks_exact(HALF_NODES).enumerate() {
                            for degree in 0..HALF_NODES {
                                let row = &transform[2 * degree + odd][..HALF_NODES];
                                let sum: f64 = row.iter().zip(values).map(|(w, v)| w * v).sum();
                                transformed[degree * HALF_NODES * HALF_NODES + n] = 2.0 * sum;
                            }
                        }
                        values = transformed;
                    }
                    coefficients[component * PARITY_COEFFICIENTS..(component + 1) * PARITY_COEFFICIENTS]
                        .copy_from_slice(&values);
                }
            }
            let least_squares = least_squares(&gradients, potentials.len());
            let gradient_terms = potentials.iter().map(HarmonicPotential::gradient_terms).collect();
            ParityClass { odd, gradient_terms, least_squares, gradients }
        };
        CellProjection { classes: (0..8).map(class).collect() }
    }

    /// Adds the harmonic coefficients of a cell from its Chebyshev coefficients. Returns an upper
    /// bound of the error, in tesla.
    fn project(&self, level: Level, coefficients: &[f64], harmonic: &mut [f64]) -> f64 {
        let (mut own, mut found) = (vec![0.0; class_stride()], vec![0.0; class_stride()]);
        let mut residual_t = DVec3::ZERO;
        for class in &self.classes {
            for (component, own) in own.chunks_exact_mut(PARITY_COEFFICIENTS).take(3).enumerate() {
                own.copy_from_slice(class.coefficients(coefficients, component));
            }
            let count = class.gradient_terms.len();
            let mut amounts = vec![0.0; padded(count)];
            weighted_sum_at(level, &own, &class.least_squares, &mut amounts);
            let amounts = &amounts[..count];
            weighted_sum_at(level, amounts, &class.gradients, &mut found);
            for (component, (own, found)) in
                own.chunks_exact(PARITY_COEFFICIENTS).zip(found.chunks_exact(PARITY_COEFFICIENTS)).take(3).enumerate()
            {
                residual_t[component] += own.iter().zip(found).map(|(own, found)| (own - found).abs()).sum::<f64>();
            }
            for (terms, amount) in class.gradient_terms.iter().zip(amounts) {
                for &(index, factor) in terms {
                    harmonic[index] += amount * factor;
                }
            }
        }
        residual_t.length()
    }
}

impl ParityClass {
    /// Coefficients of a component with the parities of the potentials' gradients.
    fn coefficients<'a>(&self, all: &'a [f64], component: usize) -> &'a [f64] {
        let odd = [0, 1, 2].map(|axis: usize| usize::from(self.odd[axis] != (axis == component)));
        let start = component * COMPONENT_COEFFICIENTS + (odd[0] * 4 + odd[1] * 2 + odd[2]) * PARITY_COEFFICIENTS;
        &all[start..start + PARITY_COEFFICIENTS]
    }
}

/// The pseudoinverse of independent rows: for each entry of a vector, its contribution to the
/// factor of each row in the sum of rows closest to the vector. Entries are `padded(count)` apart.
///
/// Each row is orthogonalized twice by the method of Gram and Schmidt.
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
        // A dependent row has no direction of its own, and its factor is zero.
        let (size, over) = if size > MIN_ORTHOGONAL_PART * whole { (size, 1.0 / size) } else { (1.0, 0.0) };
        factors[directions.len()] = size;
        rest.iter_mut().for_each(|r| *r *= over);
        directions.push(rest);
    }
    // The factors solve triangle^T factors = directions . vector. They are found from the last
    // factor backwards, for all entries at a time.
    for i in (0..count).rev() {
        let (upper, lower) = directions.split_at_mut(i + 1);
        let own = &mut upper[i];
        for (below, row) in lower.iter().zip(&triangle[i + 1..]) {
            own.iter_mut().zip(below).for_each(|(own, below)| *own -= row[i] * below);
        }
        own.iter_mut().for_each(|own| *own /= triangle[i][i]);
    }
    let stride = padded(count);
    let mut by_entry = vec![0.0; length * stride];
    for (row, factors) in directions.iter().enumerate() {
        for (entry, factor) in factors.iter().enumerate() {
            by_entry[entry * stride + row] = *factor;
        }
    }
    by_entry
}
