//! The points of the design grid, and the field there with derivatives.

use std::collections::HashMap;

use glam::{DMat3, DVec3};
use magsplice_field::{FaceDerivatives, PolarizationMap};
use magsplice_layout::Symmetry;
use magsplice_magnet::Grid;

use crate::problem::pattern::Pattern;
use crate::problem::symmetry::SymmetryOperation;

/// Coordinates that differ by less than this fraction of the extent are equal.
const SAME_COORDINATE: f64 = 1e-9;

/// A grid of points. The field is computed at one point of each set of images.
#[derive(Clone, Debug)]
pub(crate) struct Sampling {
    pub(crate) grid: Grid,
    /// The point from which changes are measured. It is the last of the computed points.
    pub(crate) reference: DVec3,
    computed: Vec<DVec3>,
    /// For each point of the grid, the index of a computed point and the operation that maps it
    /// there.
    images: Vec<(usize, SymmetryOperation)>,
    /// The part of B that recoil adds at the computed points, in tesla; zero without recoil.
    pub(crate) recoil_t: Vec<DVec3>,
    operations: Vec<SymmetryOperation>,
}

/// B in tesla at the computed points, and its derivatives with respect to the variables, variable
/// fastest.
#[derive(Clone, Debug)]
pub(crate) struct SampledField {
    pub(crate) flux_density_t: Vec<DVec3>,
    pub(crate) derivatives: Vec<DVec3>,
    pub(crate) variable_count: usize,
}

impl Sampling {
    pub(crate) fn new(grid: Grid, reference: DVec3, symmetry: Symmetry) -> Sampling {
        let operations = SymmetryOperation::all(symmetry);
        let unit = SAME_COORDINATE * grid.lower().abs().max(grid.upper().abs()).max_element().max(f64::MIN_POSITIVE);
        let key = |p: DVec3| (p / unit).round().to_array().map(|c| c as i64);
        let mut computed: Vec<DVec3> = Vec::new();
        let mut indices: HashMap<[i64; 3], usize> = HashMap::new();
        let mut known: HashMap<[i64; 3], (usize, SymmetryOperation)> = HashMap::new();
        let images = grid
            .points()
            .map(|point| {
                *known.entry(key(point)).or_insert_with(|| {
                    let found = operations.iter().find_map(|operation| {
                        let image = operation.inverse().apply(point);
                        indices.get(&key(image)).map(|index| (*index, *operation))
                    });
                    found.unwrap_or_else(|| {
                        computed.push(point);
                        indices.insert(key(point), computed.len() - 1);
                        (computed.len() - 1, SymmetryOperation::IDENTITY)
                    })
                })
            })
            .collect();
        computed.push(reference);
        let recoil_t = vec![DVec3::ZERO; computed.len()];
        Sampling { grid, reference, computed, images, recoil_t, operations }
    }

    pub(crate) fn computed(&self) -> &[DVec3] {
        &self.computed
    }

    /// Weights of the points of the grid with which a sum over it equals a sum over another grid in
    /// the same region. A smooth function is interpolated from this grid to the other.
    pub(crate) fn weights_for(&self, other: &Grid) -> Vec<f64> {
        let along = [0, 1, 2].map(|axis| {
            let nodes: Vec<f64> = (0..self.grid.counts()[axis]).map(|i| self.grid.coordinate(axis, i)).collect();
            let mut weights = vec![0.0; nodes.len()];
            for i in 0..other.counts()[axis] {
                interpolate(&nodes, other.coordinate(axis, i), &mut weights);
            }
            weights
        });
        let weight = |index: usize| {
            let [i, j, k] = self.grid.indices(index);
            along[0][i] * along[1][j] * along[2][k]
        };
        (0..self.grid.len()).map(weight).collect()
    }

    /// For each point of the grid, the index of a computed point and the operation that maps it
    /// there.
    pub(crate) fn images(&self) -> &[(usize, SymmetryOperation)] {
        &self.images
    }

    /// Whether the symmetry operations map the grid and the reference point onto themselves.
    pub(crate) fn is_symmetric(&self) -> bool {
        let (lower, upper) = (self.grid.lower(), self.grid.upper());
        let slack = SAME_COORDINATE * lower.abs().max(upper.abs()).max_element();
        let counts = self.grid.counts();
        self.operations.iter().all(|operation| {
            let [one, other] = [operation.apply(lower), operation.apply(upper)];
            one.min(other).distance(lower) <= slack
                && one.max(other).distance(upper) <= slack
                && operation.apply(self.reference).distance(self.reference) <= slack
                && (!operation.exchange || counts[0] == counts[1])
        })
    }

    /// Whether a symmetry operation exchanges x and y.
    pub(crate) fn exchanges(&self) -> bool {
        self.operations.iter().any(|operation| operation.exchange)
    }

    /// For each residual of a point of the grid along an axis, axis fastest, a number that
    /// residuals share whose derivatives are multiples of each other by symmetry. `None` if the
    /// reference point is off the axis, where its derivatives break the symmetry.
    pub(crate) fn classes(&self) -> Option<Vec<usize>> {
        let on_axis = self.reference.x == 0.0 && self.reference.y == 0.0;
        let class = |&(index, operation): &(usize, SymmetryOperation)| {
            let [x, y] = if operation.exchange { [1, 0] } else { [0, 1] };
            [3 * index + x, 3 * index + y, 3 * index + 2]
        };
        on_axis.then(|| self.images.iter().flat_map(class).collect())
    }

    /// The field of a film, with derivatives on request. `None` where a point lies on an edge of a
    /// tile, or a side of a tile is not positive.
    pub(crate) fn field(&self, pattern: &Pattern, variables: &[f64], with_derivatives: bool) -> Option<SampledField> {
        let variable_count = if with_derivatives { variables.len() } else { 0 };
        let mut flux_density_t = self.recoil_t.clone();
        let mut derivatives = vec![DVec3::ZERO; self.computed.len() * variable_count];
        for variable_tile in &pattern.tiles {
            let tile = variable_tile.tile(variables)?;
            let j = tile.polarization_t();
            let by_angles = variable_tile.polarization_derivatives(variables);
            // The field of an image at a point is the image of the tile's own field at the point
            // mapped back.
            let mapped: Vec<DVec3> = variable_tile
                .orbit
                .images
                .iter()
                .flat_map(|(operation, _)| self.computed.iter().map(|point| operation.inverse().apply(*point)))
                .collect();
            let map = PolarizationMap::new(&[tile], &mapped).ok()?;
            for (image, (operation, _)) in variable_tile.orbit.images.iter().enumerate() {
                for index in 0..self.computed.len() {
                    let row = image * self.computed.len() + index;
                    let by_j = matrix(&map, row);
                    flux_density_t[index] += operation.apply(by_j * j);
                    if !with_derivatives {
                        continue;
                    }
                    let into = &mut derivatives[index * variable_count..][..variable_count];
                    let angles = [&variable_tile.direction, &variable_tile.tilt, &variable_tile.strength];
                    for (number, by) in angles.into_iter().zip(by_angles) {
                        for &(variable, factor) in &number.terms {
                            into[variable] += factor * operation.apply(by_j * by);
                        }
                    }
                    if variable_tile.faces.iter().flatten().all(|face| face.terms.is_empty()) {
                        continue;
                    }
                    let by_faces = FaceDerivatives::new(&tile, mapped[row])?;
                    for (axis, ends) in variable_tile.faces.iter().enumerate() {
                        for (face, by) in ends.iter().zip([&by_faces.lower, &by_faces.upper]) {
                            for &(variable, factor) in &face.terms {
                                into[variable] += factor * operation.apply(by.col(axis));
                            }
                        }
                    }
                }
            }
        }
        Some(SampledField { flux_density_t, derivatives, variable_count })
    }
}

/// Number of nodes that a value is interpolated from. Nine nodes over two fifths of a wavelength
/// along x and y, and five along z, give sums within 2e-5.
const NODES: usize = 9;

/// Adds the weights of Lagrange interpolation at `at` from the nearest nodes.
fn interpolate(nodes: &[f64], at: f64, weights: &mut [f64]) {
    let count = nodes.len().min(NODES);
    let below = nodes.partition_point(|node| *node <= at);
    let first = below.saturating_sub(count.div_ceil(2)).min(nodes.len() - count);
    for i in first..first + count {
        let others = (first..first + count).filter(|&k| k != i);
        weights[i] += others.map(|k| (at - nodes[k]) / (nodes[i] - nodes[k])).product::<f64>();
    }
}

impl SampledField {
    pub(crate) fn derivatives_at(&self, point: usize) -> &[DVec3] {
        &self.derivatives[point * self.variable_count..][..self.variable_count]
    }
}

/// B at a point for unit polarizations along the axes of the tile, by columns.
pub(crate) fn matrix(map: &PolarizationMap, point: usize) -> DMat3 {
    let [x, y, z] = [0, 1, 2].map(|component| DVec3::from_slice(map.row(point, component)));
    DMat3::from_cols(x, y, z).transpose()
}
