//! The points a film is designed on, and its field there with derivatives.

use std::collections::HashMap;

use glam::{DMat3, DVec3};
use magsplice_field::{FaceDerivatives, Grid, PolarizationMap};
use magsplice_layout::Symmetry;

use crate::pattern::Pattern;
use crate::symmetry::Operation;

/// Coordinates that differ by less than this fraction of the extent are the same.
const SAME_COORDINATE: f64 = 1e-9;

/// A grid of points, only one of each set of images being computed.
#[derive(Clone, Debug)]
pub(crate) struct Sampling {
    pub(crate) grid: Grid,
    /// The point changes are measured from, last of the computed ones.
    pub(crate) reference: DVec3,
    computed: Vec<DVec3>,
    /// For each point of the grid the computed one and what maps it there.
    images: Vec<(usize, Operation)>,
}

/// B at the computed points, and its derivatives by the variables, variable fastest.
#[derive(Clone, Debug)]
pub(crate) struct Field {
    pub(crate) flux_density_t: Vec<DVec3>,
    pub(crate) slopes: Vec<DVec3>,
    pub(crate) variables: usize,
}

impl Sampling {
    pub(crate) fn new(grid: Grid, reference: DVec3, symmetry: Symmetry) -> Sampling {
        let operations = Operation::all(symmetry);
        let unit = SAME_COORDINATE * grid.lower().abs().max(grid.upper().abs()).max_element().max(f64::MIN_POSITIVE);
        let key = |p: DVec3| (p / unit).round().to_array().map(|c| c as i64);
        let mut computed: Vec<DVec3> = Vec::new();
        let mut known: HashMap<[i64; 3], (usize, Operation)> = HashMap::new();
        let images = grid
            .points()
            .map(|point| {
                *known.entry(key(point)).or_insert_with(|| {
                    let found = operations.iter().find_map(|operation| {
                        let at = operation.inverse().of(point);
                        computed.iter().position(|c| key(*c) == key(at)).map(|index| (index, *operation))
                    });
                    found.unwrap_or_else(|| {
                        computed.push(point);
                        (computed.len() - 1, Operation::IDENTITY)
                    })
                })
            })
            .collect();
        computed.push(reference);
        Sampling { grid, reference, computed, images }
    }

    pub(crate) fn computed(&self) -> &[DVec3] {
        &self.computed
    }

    /// How much each point of the grid counts where sums go over the points of another grid in the same region: a smooth function there is interpolated from here.
    pub(crate) fn weights_of(&self, other: &Grid) -> Vec<f64> {
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

    /// For each point of the grid the index of the computed one and what maps it there.
    pub(crate) fn images(&self) -> &[(usize, Operation)] {
        &self.images
    }

    /// The field of a film, with derivatives if they are wanted. `None` where a point lies on an edge of a tile, or a tile has vanished.
    pub(crate) fn field(&self, pattern: &Pattern, at: &[f64], with_slopes: bool) -> Option<Field> {
        let variables = if with_slopes { at.len() } else { 0 };
        let mut flux_density_t = vec![DVec3::ZERO; self.computed.len()];
        let mut slopes = vec![DVec3::ZERO; self.computed.len() * variables];
        for shape in &pattern.shapes {
            let tile = shape.tile(at)?;
            let j = tile.polarization_t();
            let by_angles = shape.polarization_slopes(at);
            // An image's field at a point is the image of the tile's own field at the point mapped back.
            let mapped: Vec<DVec3> = shape
                .orbit
                .images
                .iter()
                .flat_map(|(operation, _)| self.computed.iter().map(|point| operation.inverse().of(*point)))
                .collect();
            let map = PolarizationMap::new(&[tile], &mapped).ok()?;
            for (image, (operation, _)) in shape.orbit.images.iter().enumerate() {
                for index in 0..self.computed.len() {
                    let row = image * self.computed.len() + index;
                    let by_j = matrix(&map, row);
                    flux_density_t[index] += operation.of(by_j * j);
                    if !with_slopes {
                        continue;
                    }
                    let into = &mut slopes[index * variables..][..variables];
                    let angles = [&shape.direction, &shape.tilt, &shape.strength];
                    for (number, by) in angles.into_iter().zip(by_angles) {
                        for &(variable, factor) in &number.terms {
                            into[variable] += factor * operation.of(by_j * by);
                        }
                    }
                    if shape.faces.iter().flatten().all(|face| face.terms.is_empty()) {
                        continue;
                    }
                    let by_faces = FaceDerivatives::new(&tile, mapped[row])?;
                    for (axis, ends) in shape.faces.iter().enumerate() {
                        for (face, by) in ends.iter().zip([&by_faces.lower, &by_faces.upper]) {
                            for &(variable, factor) in &face.terms {
                                into[variable] += factor * operation.of(by.col(axis));
                            }
                        }
                    }
                }
            }
        }
        Some(Field { flux_density_t, slopes, variables })
    }
}

/// Nodes that a value is interpolated from: with nine over two fifths of a wavelength along x and y and five along z sums are right to 2e-5.
const NODES: usize = 9;

/// Adds to the weights of nodes what Lagrange's polynomial through those about `at` gives them there.
fn interpolate(nodes: &[f64], at: f64, weights: &mut [f64]) {
    let count = nodes.len().min(NODES);
    let below = nodes.partition_point(|node| *node <= at);
    let first = below.saturating_sub(count.div_ceil(2)).min(nodes.len() - count);
    for i in first..first + count {
        let others = (first..first + count).filter(|&k| k != i);
        weights[i] += others.map(|k| (at - nodes[k]) / (nodes[i] - nodes[k])).product::<f64>();
    }
}

impl Field {
    pub(crate) fn slopes_at(&self, point: usize) -> &[DVec3] {
        &self.slopes[point * self.variables..][..self.variables]
    }
}

/// B at a point for unit polarizations along the tile's axes.
fn matrix(map: &PolarizationMap, point: usize) -> DMat3 {
    let [x, y, z] = [0, 1, 2].map(|component| DVec3::from_slice(map.row(point, component)));
    DMat3::from_cols(x, y, z).transpose()
}
