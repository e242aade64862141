//! The part of the expected squared displacement error caused by errors of the film, with
//! derivatives.
//!
//! An error of mean square m changes the displacement residual e at a point by its sensitivity: the
//! change of B there and at the reference point, times the derivatives of the parameters. The
//! expected square is the sum over all errors of m times the squared sensitivity (docs/physics.md,
//! section 6.3). It is a sum of squares, so Gauss-Newton steps suit it like the nominal error.
//!
//! A sensitivity depends on a variable in two ways: through the field of the whole film, on which
//! the derivatives of the parameters depend, and through the tile that has the error. The first is
//! the same for all errors, so the rows are never formed: their products with vectors of three
//! components are summed instead.

use glam::{DMat3, DVec3};
use magsplice_decouple::{Branch, ParameterDerivatives, ParameterSecondDerivatives, Parameters};
use magsplice_magnet::TileError;
use rayon::prelude::*;

use crate::problem::error_model::{ErrorImage, ErrorModel, RobustFilm};
use crate::problem::joint_response::{JointResponse, iron_response, joint_responses, sensor_response};
use crate::problem::objective::ExpectedSquares;
use crate::problem::pattern::VariableTile;
use crate::problem::symmetry::SymmetryOperation;
use crate::problem::tile_response::{RespondingTile, TileResponse, numbers};

/// Derivatives of the three weighted displacements by B at a point, in the frame of the film.
struct Sensitivity {
    first: [DVec3; 3],
    second: [DMat3; 3],
}

impl RobustFilm<'_> {
    /// Derivatives at a computed point, seen through an operation.
    fn sensitivity(&self, index: usize, operation: SymmetryOperation, branch: Branch) -> Option<Sensitivity> {
        let b = operation.apply(self.field.flux_density_t[index]);
        let (_, ParameterDerivatives { r_x, r_y, s_z }) = Parameters::with_derivatives(b, branch)?;
        let factor = |axis: usize| {
            let per_point = 1.0 / (self.sampling.grid.len() as f64).sqrt();
            self.objective.weights[axis] * per_point / self.objective.ideal.wavenumber()
        };
        let first = [factor(0) * r_x, factor(1) * r_y, factor(2) * s_z];
        let mut second = [DMat3::ZERO; 3];
        if self.with_derivatives() {
            let ParameterSecondDerivatives { r_x, r_y, s_z } = Parameters::second_derivatives(b, branch)?;
            second = [factor(0) * r_x, factor(1) * r_y, factor(2) * s_z];
        }
        Some(Sensitivity { first, second })
    }
}

impl ErrorModel {
    /// The expected square at a film. `None` where a point lies on an edge of a tile or has no
    /// parameters.
    pub(crate) fn expected_squares(&self, film: &RobustFilm) -> Option<ExpectedSquares> {
        let last = film.field.flux_density_t.len() - 1;
        let branch = Branch::from_axis_field(film.field.flux_density_t[last])?;
        let reference = film.sensitivity(last, SymmetryOperation::IDENTITY, branch)?;
        let at_points = (film.sampling.images().iter())
            .map(|&(index, operation)| film.sensitivity(index, operation, branch))
            .collect::<Option<Vec<_>>>()?;
        let rows = Rows { film, at_points, reference };
        let tiles = (film.pattern.tiles.par_iter())
            .map(|tile| rows.of_tile(tile, self.images(tile)))
            .collect::<Option<Vec<TileSums>>>()?;
        let mut sums = Sums::new(last);
        rows.add_common(self, &mut sums);
        tiles.iter().for_each(|tile| sums.add(&tile.sums));
        let mut squares = rows.assembled(&sums, &tiles);
        rows.add_joint(self, &mut squares)?;
        Some(squares)
    }
}

/// Sums over rows of products with the derivatives of the field: a row is u times the derivatives
/// at a computed point, plus v times those at the reference point, plus a part of its own.
#[derive(Clone, Debug)]
struct Sums {
    loss: f64,
    at_points: Vec<PointSums>,
    /// v v^T.
    at_reference: DMat3,
    /// Value times v.
    reference_gradient: DVec3,
}

#[derive(Clone, Copy, Debug, Default)]
struct PointSums {
    /// u u^T.
    square: DMat3,
    /// u v^T.
    with_reference: DMat3,
    /// Value times u.
    gradient: DVec3,
}

impl Sums {
    fn new(points: usize) -> Sums {
        let none = PointSums { square: DMat3::ZERO, with_reference: DMat3::ZERO, gradient: DVec3::ZERO };
        Sums { loss: 0.0, at_points: vec![none; points], at_reference: DMat3::ZERO, reference_gradient: DVec3::ZERO }
    }

    fn add(&mut self, other: &Sums) {
        self.loss += other.loss;
        for (sum, other) in self.at_points.iter_mut().zip(&other.at_points) {
            sum.square += other.square;
            sum.with_reference += other.with_reference;
            sum.gradient += other.gradient;
        }
        self.at_reference += other.at_reference;
        self.reference_gradient += other.reference_gradient;
    }

    fn add_row(&mut self, index: usize, value: f64, u: DVec3, v: DVec3) {
        let sums = &mut self.at_points[index];
        sums.square += outer(u, u);
        sums.with_reference += outer(u, v);
        sums.gradient += value * u;
        self.at_reference += outer(v, v);
        self.reference_gradient += value * v;
    }
}

/// The sums of the errors of one tile, and the products with derivatives by its own variables.
struct TileSums {
    sums: Sums,
    /// Variables that the numbers of the tile depend on.
    own: Vec<usize>,
    /// For each computed point, then the reference point, u or v times each own part.
    cross: Vec<DVec3>,
    /// Products of own parts.
    square: Vec<f64>,
    /// Value times the own part.
    gradient: Vec<f64>,
}

struct Rows<'a> {
    film: &'a RobustFilm<'a>,
    at_points: Vec<Sensitivity>,
    reference: Sensitivity,
}

impl Rows<'_> {
    /// The rows of the errors of a tile and of its images.
    fn of_tile(&self, tile: &VariableTile, images: Vec<ErrorImage>) -> Option<TileSums> {
        let film = self.film;
        let reference_index = film.field.flux_density_t.len() - 1;
        let numbers = numbers(tile);
        let mut own: Vec<usize> = Vec::new();
        if film.with_derivatives() {
            own = numbers.iter().flat_map(|number| number.iter().map(|term| term.0)).collect();
            own.sort_unstable();
            own.dedup();
        }
        let m = own.len();
        // Each number's share in the own variables.
        let mut shares = Vec::new();
        for (number, terms) in numbers.iter().enumerate() {
            for &(variable, factor) in terms.iter().filter(|_| m > 0) {
                shares.push((number, own.binary_search(&variable).expect("an own variable"), factor));
            }
        }
        let mut found = TileSums {
            sums: Sums::new(reference_index),
            cross: vec![DVec3::ZERO; (reference_index + 1) * m],
            square: vec![0.0; m * m],
            gradient: vec![0.0; m],
            own,
        };
        let points: Vec<DVec3> = film.sampling.grid.points().chain([film.sampling.reference]).collect();
        let mut own_at_reference = vec![DVec3::ZERO; TileError::ALL.len() * m];
        let (mut own_at_point, mut part) = (own_at_reference.clone(), vec![0.0; m]);
        for ErrorImage { operation, mean_squares } in images {
            let active = mean_squares.map(|square| square > 0.0);
            if !active.values().any(|active| *active) {
                continue;
            }
            let deviations = mean_squares.map(f64::sqrt);
            let responding =
                RespondingTile::new(tile, &film.sampling.reflections, film.variables, active, film.with_derivatives())?;
            let mapped: Vec<DVec3> = points.iter().map(|point| operation.inverse().apply(*point)).collect();
            let mut responses = responding.read(&film.sampling.reading.seen_by(operation), &mapped)?;
            let at_reference = responses.pop()?;
            let of_own = |response: &TileResponse, into: &mut [DVec3]| {
                into.fill(DVec3::ZERO);
                for error in TileError::ALL.into_iter().filter(|error| active[*error] && m > 0) {
                    for &(number, share, factor) in &shares {
                        into[error.index() * m + share] +=
                            deviations[error] * factor * operation.apply(response.derivatives[error][number]);
                    }
                }
            };
            of_own(&at_reference, &mut own_at_reference);
            for ((response, sensitivity), &(index, to_point)) in
                responses.iter().zip(&self.at_points).zip(film.sampling.images())
            {
                of_own(response, &mut own_at_point);
                for error in TileError::ALL.into_iter().filter(|error| active[*error]) {
                    let change =
                        |response: &TileResponse| deviations[error] * operation.apply(response.by_error[error]);
                    let (here, there) = (change(response), change(&at_reference));
                    let [own_here, own_there] =
                        [&own_at_point, &own_at_reference].map(|own| &own[error.index() * m..][..m]);
                    for axis in 0..3 {
                        let (first, from) = (sensitivity.first[axis], self.reference.first[axis]);
                        let value = first.dot(here) - from.dot(there);
                        found.sums.loss += 0.5 * value * value;
                        if !film.with_derivatives() {
                            continue;
                        }
                        let u = to_point.inverse().apply(sensitivity.second[axis] * here);
                        let v = -(self.reference.second[axis] * there);
                        found.sums.add_row(index, value, u, v);
                        for (part, (here, there)) in part.iter_mut().zip(own_here.iter().zip(own_there)) {
                            *part = first.dot(*here) - from.dot(*there);
                        }
                        for i in 0..m {
                            found.gradient[i] += value * part[i];
                            found.cross[index * m + i] += part[i] * u;
                            found.cross[reference_index * m + i] += part[i] * v;
                            for k in 0..m {
                                found.square[i * m + k] += part[i] * part[k];
                            }
                        }
                    }
                }
            }
        }
        Some(found)
    }

    /// Adds the rows of noise and of common errors, whose change of the field is a function of the
    /// field.
    fn add_common(&self, model: &ErrorModel, sums: &mut Sums) {
        let film = self.film;
        let b_reference = film.field.flux_density_t[film.field.flux_density_t.len() - 1];
        let noise = model.noise.to_array().map(f64::sqrt);
        let noisy = || DVec3::AXES.into_iter().zip(noise).filter(|(_, deviation)| *deviation > 0.0);
        for (point, (sensitivity, &(index, operation))) in self.at_points.iter().zip(film.sampling.images()).enumerate()
        {
            let b = operation.apply(film.field.flux_density_t[index]);
            for axis in 0..3 {
                let (first, from) = (sensitivity.first[axis], self.reference.first[axis]);
                let (second, second_from) = (sensitivity.second[axis], self.reference.second[axis]);
                let mut add = |here: DVec3, there: DVec3, by_here: DVec3, by_there: DVec3| {
                    let value = first.dot(here) - from.dot(there);
                    sums.loss += 0.5 * value * value;
                    let u = operation.inverse().apply(second * here + by_here);
                    sums.add_row(index, value, u, -(second_from * there + by_there));
                };
                for error in &model.common {
                    let (there, by_reference) = error.at_reference(b_reference);
                    let by_here = error.by_field.transpose() * first;
                    add(error.at(point, b), there, by_here, by_reference.transpose() * from);
                }
                for (unit, deviation) in noisy() {
                    add(deviation * unit, DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
                    add(DVec3::ZERO, deviation * unit, DVec3::ZERO, DVec3::ZERO);
                }
            }
        }
    }

    /// The square and its derivatives from sums over rows.
    fn assembled(&self, sums: &Sums, tiles: &[TileSums]) -> ExpectedSquares {
        let n = self.film.field.variable_count;
        let (mut gradient, mut curvature) = (vec![0.0; n], vec![0.0; n * n]);
        let field = self.film.field;
        let reference_index = field.flux_density_t.len() - 1;
        let at_reference = if n > 0 { field.derivatives_at(reference_index) } else { &[] };
        // Derivatives at the points times the products with the reference point.
        let mut mixed = vec![DVec3::ZERO; n];
        for (index, of_point) in sums.at_points.iter().enumerate().take(if n > 0 { reference_index } else { 0 }) {
            let here = field.derivatives_at(index);
            for i in 0..n {
                gradient[i] += of_point.gradient.dot(here[i]);
                mixed[i] += of_point.with_reference.transpose() * here[i];
                let row = of_point.square * here[i];
                (i..n).for_each(|k| curvature[i * n + k] += row.dot(here[k]));
            }
        }
        for i in 0..n {
            gradient[i] += sums.reference_gradient.dot(at_reference[i]);
            let row = sums.at_reference * at_reference[i] + mixed[i];
            (i..n).for_each(|k| curvature[i * n + k] += row.dot(at_reference[k]) + mixed[k].dot(at_reference[i]));
        }
        // Both halves of the matrix get the products with own parts.
        for i in 0..n {
            (0..i).for_each(|k| curvature[i * n + k] = curvature[k * n + i]);
        }
        for tile in tiles {
            let m = tile.own.len();
            for (i, &variable) in tile.own.iter().enumerate() {
                gradient[variable] += tile.gradient[i];
                for (k, &other) in tile.own.iter().enumerate() {
                    curvature[variable * n + other] += tile.square[i * m + k];
                }
                for index in 0..=reference_index {
                    let cross = tile.cross[index * m + i];
                    for (k, by) in field.derivatives_at(index).iter().enumerate() {
                        let product = cross.dot(*by);
                        curvature[variable * n + k] += product;
                        curvature[k * n + variable] += product;
                    }
                }
            }
        }
        ExpectedSquares { loss: sums.loss, gradient, curvature }
    }

    /// Adds the rows of errors that several tiles share, and of those of the sensors of a head.
    fn add_joint(&self, model: &ErrorModel, squares: &mut ExpectedSquares) -> Option<()> {
        let all: Vec<CountedPoint> =
            (0..self.at_points.len()).map(|point| CountedPoint { point, count: 1.0 }).collect();
        let distinct = if model.has_symmetric_sensors { self.distinct_points() } else { all.clone() };
        for errors in &model.joint {
            let points = if errors.sensor.is_some() { &distinct } else { &all };
            for response in joint_responses(errors, &numbers_of(points), self.film)? {
                self.add_response(&response, points, squares);
            }
        }
        for change in &model.of_sensors {
            let response = sensor_response(change, &numbers_of(&distinct), self.film)?;
            self.add_response(&response, &distinct, squares);
        }
        let points = if model.symmetric { self.distinct_points() } else { all };
        for iron in &model.iron {
            let response = iron_response(iron, &numbers_of(&points), self.film)?;
            self.add_response(&response, &points, squares);
        }
        Some(())
    }

    /// One point of the grid for each set of images.
    fn distinct_points(&self) -> Vec<CountedPoint> {
        let sampling = self.film.sampling;
        let mut found = vec![CountedPoint { point: 0, count: 0.0 }; sampling.computed().len() - 1];
        for (point, (index, operation)) in sampling.images().iter().enumerate() {
            found[*index].count += 1.0;
            if *operation == SymmetryOperation::IDENTITY {
                found[*index].point = point;
            }
        }
        found
    }

    /// Adds the rows of one error at points of the grid.
    fn add_response(&self, response: &JointResponse, points: &[CountedPoint], squares: &mut ExpectedSquares) {
        let field = self.film.field;
        let (n, reference_index) = (field.variable_count, field.flux_density_t.len() - 1);
        let (there, own_there) = response.at(points.len());
        for (at, &CountedPoint { point, count }) in points.iter().enumerate() {
            let (sensitivity, (index, operation)) = (&self.at_points[point], self.film.sampling.images()[point]);
            let (here, own_here) = response.at(at);
            for axis in 0..3 {
                let (first, from) = (sensitivity.first[axis], self.reference.first[axis]);
                let value = first.dot(here) - from.dot(there);
                squares.loss += 0.5 * count * value * value;
                if n == 0 {
                    continue;
                }
                let u = operation.inverse().apply(sensitivity.second[axis] * here);
                let v = self.reference.second[axis] * there;
                let by_field = field.derivatives_at(index).iter().map(|by| u.dot(*by));
                let by_reference = field.derivatives_at(reference_index).iter().map(|by| v.dot(*by));
                let own = own_here.iter().zip(own_there).map(|(here, there)| first.dot(*here) - from.dot(*there));
                let row: Vec<f64> =
                    by_field.zip(by_reference).zip(own).map(|((here, there), own)| here - there + own).collect();
                for (i, (slope, curvature)) in
                    squares.gradient.iter_mut().zip(squares.curvature.chunks_exact_mut(n)).enumerate()
                {
                    *slope += count * value * row[i];
                    let of_row = count * row[i];
                    curvature.iter_mut().zip(&row).for_each(|(sum, other)| *sum += of_row * other);
                }
            }
        }
    }
}

/// A point of the grid, and how many points it stands for.
#[derive(Clone, Copy)]
struct CountedPoint {
    point: usize,
    count: f64,
}

fn numbers_of(points: &[CountedPoint]) -> Vec<usize> {
    points.iter().map(|counted| counted.point).collect()
}

/// a b^T.
fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}
