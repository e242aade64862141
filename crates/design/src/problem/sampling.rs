//! The points of the design grid, and the field there with derivatives.

use std::collections::HashMap;

use glam::{DMat3, DVec3};
use magsplice_field::{FaceDerivatives, PolarizationMap};
use magsplice_layout::Symmetry;
use magsplice_magnet::{Grid, Reflection};

use crate::problem::pattern::Pattern;
use crate::problem::reading::Reading;
use crate::problem::symmetry::SymmetryOperation;

/// Coordinates that differ by less than this fraction of the extent are equal.
const SAME_COORDINATE: f64 = 1e-9;

/// A grid of points. The reading is computed at one point of each set of images.
#[derive(Clone, Debug)]
pub(crate) struct Sampling {
    pub(crate) grid: Grid,
    /// The point from which changes are measured. It is the last of the computed points.
    pub(crate) reference: DVec3,
    computed: Vec<DVec3>,
    /// For each point of the grid, the index of a computed point and the operation that maps it
    /// there.
    images: Vec<(usize, SymmetryOperation)>,
    /// What is read at each point.
    pub(crate) reading: Reading,
    /// The places of the sensors at the computed points, sensor fastest.
    places: Vec<DVec3>,
    /// None for the film itself, then one for each of its images in flat iron.
    pub(crate) reflections: Vec<Reflection>,
    /// The part of B that recoil adds at the places, in tesla; zero without recoil.
    pub(crate) recoil_t: Vec<DVec3>,
    operations: Vec<SymmetryOperation>,
    pub(crate) symmetry: Symmetry,
}

/// B in tesla as read at the computed points, and its derivatives with respect to the variables,
/// variable fastest.
#[derive(Clone, Debug)]
pub(crate) struct SampledField {
    pub(crate) flux_density_t: Vec<DVec3>,
    pub(crate) derivatives: Vec<DVec3>,
    pub(crate) variable_count: usize,
    /// The same at the places of each sensor of a head; `None` for a single sensor.
    at_places: Option<PlaceFields>,
}

/// B and its derivatives at places, variable fastest.
#[derive(Clone, Debug)]
struct PlaceFields {
    flux_density_t: Vec<DVec3>,
    derivatives: Vec<DVec3>,
}

impl Sampling {
    /// `images` are the reflections by flat iron, which the symmetry keeps.
    pub(crate) fn new(
        grid: Grid,
        reference: DVec3,
        symmetry: Symmetry,
        reading: Reading,
        images: &[Reflection],
    ) -> Sampling {
        let reflections = [&[Reflection::NONE], images].concat();
        let operations = SymmetryOperation::all(symmetry);
        // The reading at the image of a point is the image of the reading if the board is its own.
        let keeping: Vec<SymmetryOperation> =
            operations.iter().copied().filter(|operation| reading.is_kept_by(*operation)).collect();
        let unit = SAME_COORDINATE * grid.lower().abs().max(grid.upper().abs()).max_element().max(f64::MIN_POSITIVE);
        let key = |p: DVec3| (p / unit).round().to_array().map(|c| c as i64);
        let mut computed: Vec<DVec3> = Vec::new();
        let mut indices: HashMap<[i64; 3], usize> = HashMap::new();
        let mut known: HashMap<[i64; 3], (usize, SymmetryOperation)> = HashMap::new();
        let images = grid
            .points()
            .map(|point| {
                *known.entry(key(point)).or_insert_with(|| {
                    let found = keeping.iter().find_map(|operation| {
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
        let places = reading.places(&computed);
        let recoil_t = vec![DVec3::ZERO; places.len()];
        Sampling { grid, reference, computed, images, reading, places, reflections, recoil_t, operations, symmetry }
    }

    pub(crate) fn computed(&self) -> &[DVec3] {
        &self.computed
    }

    /// The places of the sensors at the computed points, sensor fastest.
    pub(crate) fn places(&self) -> &[DVec3] {
        &self.places
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

    /// Whether the symmetry operations map the grid, the reference point and the board onto
    /// themselves.
    pub(crate) fn is_symmetric(&self) -> bool {
        let (lower, upper) = (self.grid.lower(), self.grid.upper());
        let slack = SAME_COORDINATE * lower.abs().max(upper.abs()).max_element();
        let counts = self.grid.counts();
        self.operations.iter().all(|operation| {
            let [one, other] = [operation.apply(lower), operation.apply(upper)];
            one.min(other).distance(lower) <= slack
                && one.max(other).distance(upper) <= slack
                && operation.apply(self.reference).distance(self.reference) <= slack
                && self.reading.is_kept_by(*operation)
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

    /// The field of a film as it is read, with derivatives on request. `None` where a place lies on
    /// an edge of a tile, or a side of a tile is not positive.
    pub(crate) fn field(&self, pattern: &Pattern, variables: &[f64], with_derivatives: bool) -> Option<SampledField> {
        let variable_count = if with_derivatives { variables.len() } else { 0 };
        let at_places = self.at_places(pattern, variables, variable_count)?;
        if self.reading.is_single() {
            let PlaceFields { flux_density_t, derivatives } = at_places;
            return Some(SampledField { flux_density_t, derivatives, variable_count, at_places: None });
        }
        let sensors = self.reading.sensors().len();
        let of_points = at_places.flux_density_t.chunks_exact(sensors);
        let flux_density_t = of_points.map(|values| self.reading.sum(values.iter().copied())).collect();
        let derivative = |first: usize, variable: usize| {
            let of_sensor = |sensor| at_places.derivatives[(first + sensor) * variable_count + variable];
            self.reading.sum((0..sensors).map(of_sensor))
        };
        let firsts = (0..self.places.len()).step_by(sensors);
        let derivatives = firsts
            .flat_map(|first| (0..variable_count).map(move |variable| (first, variable)))
            .map(|(first, variable)| derivative(first, variable))
            .collect();
        Some(SampledField { flux_density_t, derivatives, variable_count, at_places: Some(at_places) })
    }

    /// The field of a film and its images at the places of the sensors, with derivatives by
    /// variables.
    fn at_places(&self, pattern: &Pattern, variables: &[f64], variable_count: usize) -> Option<PlaceFields> {
        let with_derivatives = variable_count > 0;
        let mut flux_density_t = self.recoil_t.clone();
        let mut derivatives = vec![DVec3::ZERO; self.places.len() * variable_count];
        for variable_tile in &pattern.tiles {
            let tile = variable_tile.tile(variables)?;
            let j = tile.polarization_t();
            let by_angles = variable_tile.polarization_derivatives(variables);
            // The field of an image at a point is the image of the tile's own field at the point
            // mapped back.
            let images = variable_tile.orbit.images.iter();
            let images: Vec<(SymmetryOperation, &Reflection)> =
                images.flat_map(|(operation, _)| self.reflections.iter().map(|of| (*operation, of))).collect();
            let mapped_back = |(operation, reflection): (SymmetryOperation, &Reflection)| -> Vec<DVec3> {
                self.places.iter().map(|place| operation.inverse().apply(reflection.place(*place))).collect()
            };
            let mapped: Vec<DVec3> = images.iter().flat_map(|image| mapped_back(*image)).collect();
            let map = PolarizationMap::new(&[tile], &mapped).ok()?;
            for (image, (operation, reflection)) in images.into_iter().enumerate() {
                let seen = |b_t: DVec3| reflection.field(operation.apply(b_t));
                for index in 0..self.places.len() {
                    let row = image * self.places.len() + index;
                    let by_j = matrix(&map, row);
                    flux_density_t[index] += seen(by_j * j);
                    if !with_derivatives {
                        continue;
                    }
                    let into = &mut derivatives[index * variable_count..][..variable_count];
                    let angles = [&variable_tile.direction, &variable_tile.tilt, &variable_tile.strength];
                    for (number, by) in angles.into_iter().zip(by_angles) {
                        for &(variable, factor) in &number.terms {
                            into[variable] += factor * seen(by_j * by);
                        }
                    }
                    if variable_tile.faces.iter().flatten().all(|face| face.terms.is_empty()) {
                        continue;
                    }
                    let by_faces = FaceDerivatives::new(&tile, mapped[row])?;
                    for (axis, ends) in variable_tile.faces.iter().enumerate() {
                        for (face, by) in ends.iter().zip([&by_faces.lower, &by_faces.upper]) {
                            for &(variable, factor) in &face.terms {
                                into[variable] += factor * seen(by.col(axis));
                            }
                        }
                    }
                }
            }
        }
        Some(PlaceFields { flux_density_t, derivatives })
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

    /// The field at one of the places, with its derivatives. `None` for a single sensor.
    pub(crate) fn at_place(&self, place: usize) -> Option<(DVec3, &[DVec3])> {
        let PlaceFields { flux_density_t, derivatives } = self.at_places.as_ref()?;
        Some((flux_density_t[place], &derivatives[place * self.variable_count..][..self.variable_count]))
    }
}

/// B at a point for unit polarizations along the axes of the tile, by columns.
pub(crate) fn matrix(map: &PolarizationMap, point: usize) -> DMat3 {
    let [x, y, z] = [0, 1, 2].map(|component| DVec3::from_slice(map.row(point, component)));
    DMat3::from_cols(x, y, z).transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sampling(lower: [f64; 3], upper: [f64; 3], counts: [usize; 3], reference: [f64; 3]) -> [Sampling; 3] {
        let grid = Grid::new(lower.into(), upper.into(), counts).unwrap();
        [Symmetry::None, Symmetry::Mirror, Symmetry::FourFold]
            .map(|symmetry| Sampling::new(grid, reference.into(), symmetry, Reading::new(None), &[]))
    }

    /// Whether the operations of no symmetry, of the mirrors and of all four folds map grid and
    /// reference onto themselves.
    #[test]
    fn symmetric_grids_are_known() {
        let of = |lower, upper, counts, reference| {
            sampling(lower, upper, counts, reference).map(|sampling| sampling.is_symmetric())
        };
        let (lower, upper, on_axis) = ([-2.0, -2.0, -5.0], [2.0, 2.0, -3.0], [0.0, 0.0, -5.0]);
        assert_eq!(of(lower, upper, [5, 5, 2], on_axis), [true; 3]);
        assert_eq!(of(lower, upper, [5, 3, 2], on_axis), [true, true, false]);
        assert_eq!(of(lower, [2.0, 2.5, -3.0], [5, 5, 2], on_axis), [true, false, false]);
        assert_eq!(of([-2.5, -2.0, -5.0], upper, [5, 5, 2], on_axis), [true, false, false]);
        assert_eq!(of([-2.0, -1.0, -5.0], [2.0, 1.0, -3.0], [5, 5, 2], on_axis), [true, true, false]);
        assert_eq!(of(lower, upper, [5, 5, 2], [0.5, 0.5, -5.0]), [true, false, false]);
        // Round-off of coordinates is none of a grid.
        assert_eq!(of([-2.0, -2.0, -5.0], [2.0 + 1e-12, 2.0, -3.0], [5, 5, 2], on_axis), [true; 3]);
        assert_eq!(
            sampling(lower, upper, [5, 5, 2], on_axis).map(|sampling| sampling.exchanges()),
            [false, false, true]
        );
    }

    /// Each point is the image of a computed one, and no computed point is an image of another.
    #[test]
    fn points_are_images_of_few_computed_points() {
        let all = sampling([-2.0, -2.0, -5.0], [2.0, 2.0, -3.0], [5, 5, 2], [0.0, 0.0, -5.0]);
        // Of 5 x 5 points in a plane: all, a quarter with its borders, an eighth with its borders.
        for (sampling, computed) in all.iter().zip([25, 9, 6]) {
            assert_eq!(sampling.computed().len(), 2 * computed + 1);
            assert_eq!(sampling.computed().last(), Some(&sampling.reference));
            for (point, &(index, operation)) in sampling.grid.points().zip(sampling.images()) {
                assert!(operation.apply(sampling.computed()[index]).distance(point) < 1e-12);
            }
            assert_eq!(sampling.recoil_t.len(), sampling.computed().len());
        }
    }

    /// Residuals share a number if their points share a computed point, and their axes are mapped
    /// onto each other.
    #[test]
    fn classes_are_the_axes_of_computed_points() {
        let [_, _, four_fold] = sampling([-2.0, -2.0, -5.0], [2.0, 2.0, -3.0], [3, 3, 1], [0.0, 0.0, -5.0]);
        let classes = four_fold.classes().expect("on the axis");
        for (point, &(index, operation)) in four_fold.images().iter().enumerate() {
            let found = &classes[3 * point..][..3];
            let axis = |axis: usize| 3 * index + axis;
            let known = if operation.exchange { [axis(1), axis(0), axis(2)] } else { [axis(0), axis(1), axis(2)] };
            assert_eq!(found, known);
        }
        assert!(four_fold.images().iter().any(|(_, operation)| operation.exchange));
        for reference in [[0.1, 0.0, -5.0], [0.0, 0.1, -5.0]] {
            let [beside, ..] = sampling([-2.0, -2.0, -5.0], [2.0, 2.0, -3.0], [3, 3, 1], reference);
            assert_eq!(beside.classes(), None);
        }
    }

    /// Polynomials of as many terms as the grid has points along an axis are summed exactly.
    #[test]
    fn weights_sum_over_another_grid() {
        let [sampling, ..] = sampling([-2.0, -1.0, -5.0], [2.0, 1.5, -3.0], [5, 4, 3], [0.0, 0.0, -5.0]);
        let other = Grid::new(sampling.grid.lower(), sampling.grid.upper(), [9, 10, 6]).unwrap();
        let weights = sampling.weights_for(&other);
        for (i, j, k) in [(0, 0, 0), (4, 3, 2), (1, 2, 0), (3, 0, 1)] {
            let f = |p: DVec3| p.x.powi(i) * p.y.powi(j) * p.z.powi(k);
            let known: f64 = other.points().map(f).sum();
            let found: f64 = sampling.grid.points().zip(&weights).map(|(p, weight)| weight * f(p)).sum();
            assert!((found - known).abs() < 1e-9 * (1.0 + known.abs()), "{i} {j} {k}: {found}, not {known}");
        }
    }
}
