//! What is to become small, as a sum of squares, with derivatives.

use glam::DVec3;
use magsplice_decouple::{Branch, ParameterSlopes, Parameters};
use magsplice_field::IdealFilm;
use magsplice_layout::Goal;

use crate::pattern::half_turn;
use crate::sampling::{Field, Sampling};
use crate::symmetry::Operation;

/// Errors over the points of a sampling.
#[derive(Clone, Debug)]
pub(crate) struct Objective {
    pub(crate) goal: Goal,
    pub(crate) weights: [f64; 3],
    pub(crate) ideal: IdealFilm,
    /// B of the ideal film at the computed points.
    pub(crate) ideal_field_t: Vec<DVec3>,
    /// What the field is to be of it, where the field is the goal; else the least amplitude there is to be, if any.
    pub(crate) amplitude: Option<f64>,
    /// For each grid on which an amplitude is asked for, how much each point of the sampling counts.
    pub(crate) amplitude_weights: Vec<Vec<f64>>,
}

/// The errors of a film: their squares add up to what is to become small.
#[derive(Clone, Debug)]
pub(crate) struct Errors {
    pub(crate) values: Vec<f64>,
    /// Their derivatives, variable fastest.
    pub(crate) slopes: Vec<f64>,
    /// The best-fit amplitudes over the grids they are asked for on, with their derivatives.
    pub(crate) amplitudes: Vec<(f64, Vec<f64>)>,
}

impl Errors {
    /// Half the sum of squares.
    pub(crate) fn loss(&self) -> f64 {
        0.5 * self.values.iter().map(|v| v * v).sum::<f64>()
    }
}

impl Objective {
    /// `None` where B_z = 0 at some point, so that the parameters do not exist.
    pub(crate) fn errors(&self, sampling: &Sampling, field: &Field) -> Option<Errors> {
        let amplitudes =
            self.amplitude_weights.iter().map(|weights| self.amplitude(weights, sampling, field)).collect();
        let (values, slopes) = match self.goal {
            Goal::Field => self.field_errors(sampling, field),
            Goal::Uniformity => self.uniformity_errors(sampling, field)?,
            Goal::Displacement => self.displacement_errors(sampling, field)?,
        };
        Some(Errors { values, slopes, amplitudes })
    }

    fn amplitude(&self, weights: &[f64], sampling: &Sampling, field: &Field) -> (f64, Vec<f64>) {
        let (mut product, mut square) = (0.0, 0.0);
        let mut slopes = vec![0.0; field.variables];
        for (&(index, _), weight) in sampling.images().iter().zip(weights) {
            let ideal = self.ideal_field_t[index];
            product += weight * ideal.dot(field.flux_density_t[index]);
            square += weight * ideal.length_squared();
            for (slope, by) in slopes.iter_mut().zip(field.slopes_at(index)) {
                *slope += weight * ideal.dot(*by);
            }
        }
        slopes.iter_mut().for_each(|slope| *slope /= square);
        (product / square, slopes)
    }

    /// Each component of B minus that of the ideal film, relative to the root mean square of the latter.
    fn field_errors(&self, sampling: &Sampling, field: &Field) -> (Vec<f64>, Vec<f64>) {
        let wanted = self.amplitude.unwrap_or(1.0);
        let square: f64 = sampling.images().iter().map(|&(index, _)| self.ideal_field_t[index].length_squared()).sum();
        let factor = 1.0 / (wanted * square.sqrt());
        let (mut values, mut slopes) = (Vec::new(), Vec::new());
        for &(index, _) in sampling.images() {
            let error = factor * (field.flux_density_t[index] - wanted * self.ideal_field_t[index]);
            for axis in 0..3 {
                values.push(error[axis]);
                slopes.extend(field.slopes_at(index).iter().map(|by| factor * by[axis]));
            }
        }
        (values, slopes)
    }

    /// For each parameter and each plane normal to its axis, the differences from the mean over the plane.
    fn uniformity_errors(&self, sampling: &Sampling, field: &Field) -> Option<(Vec<f64>, Vec<f64>)> {
        let (parameters, slopes, _) = self.parameters(sampling, field)?;
        let (grid, n) = (&sampling.grid, field.variables);
        let mut values = vec![0.0; parameters.len()];
        let mut errors = vec![0.0; slopes.len()];
        for axis in 0..3 {
            let factor = self.weights[axis] / (grid.len() as f64).sqrt();
            let points = (grid.len() / grid.counts[axis]) as f64;
            for plane in 0..grid.counts[axis] {
                let rows = || (0..grid.len()).filter(|&i| grid.indices(i)[axis] == plane).map(|i| 3 * i + axis);
                let mean = rows().map(|row| parameters[row]).sum::<f64>() / points;
                let mut mean_slopes = vec![0.0; n];
                for row in rows() {
                    add(&mut mean_slopes, 1.0 / points, &slopes[row * n..][..n]);
                }
                for row in rows() {
                    values[row] = factor * (parameters[row] - mean);
                    let into = &mut errors[row * n..][..n];
                    for ((error, slope), mean) in into.iter_mut().zip(&slopes[row * n..][..n]).zip(&mean_slopes) {
                        *error = factor * (slope - mean);
                    }
                }
            }
        }
        Some((values, errors))
    }

    /// The changes of the parameters from the reference point minus those of the ideal film, over k.
    fn displacement_errors(&self, sampling: &Sampling, field: &Field) -> Option<(Vec<f64>, Vec<f64>)> {
        let (parameters, slopes, reference) = self.parameters(sampling, field)?;
        let (grid, n, k) = (&sampling.grid, field.variables, self.ideal.wavenumber());
        let (at_reference, reference_slopes) = reference;
        let mut values = vec![0.0; parameters.len()];
        let mut errors = vec![0.0; slopes.len()];
        for (index, point) in grid.points().enumerate() {
            let ideal = k * (point - sampling.reference) * DVec3::new(-1.0, -1.0, 1.0);
            for axis in 0..3 {
                let row = 3 * index + axis;
                let factor = self.weights[axis] / (grid.len() as f64).sqrt() / k;
                let change = parameters[row] - at_reference[axis] - ideal[axis];
                values[row] = factor * if axis < 2 { half_turn(change) } else { change };
                let into = &mut errors[row * n..][..n];
                add(into, factor, &slopes[row * n..][..n]);
                add(into, -factor, &reference_slopes[axis * n..][..n]);
            }
        }
        Some((values, errors))
    }

    /// R_x, R_y, S_z at the points of the grid, parameter fastest, with derivatives; the same at the reference point.
    #[allow(clippy::type_complexity)]
    fn parameters(&self, sampling: &Sampling, field: &Field) -> Option<(Vec<f64>, Vec<f64>, ([f64; 3], Vec<f64>))> {
        let n = field.variables;
        let last = field.flux_density_t.len() - 1;
        let branch = Branch::from_axis_field(field.flux_density_t[last])?;
        let (mut values, mut slopes) = (Vec::new(), Vec::new());
        let mut append = |index: usize, operation: Operation| {
            let b = operation.of(field.flux_density_t[index]);
            let (p, ParameterSlopes { r_x, r_y, s_z }) = Parameters::with_slopes(b, branch)?;
            values.extend([p.r_x, p.r_y, p.s_z]);
            for by_b in [r_x, r_y, s_z] {
                let back = operation.inverse().of(by_b);
                slopes.extend(field.slopes_at(index).iter().map(|by| back.dot(*by)));
            }
            Some(())
        };
        append(last, Operation::IDENTITY)?;
        for &(index, operation) in sampling.images() {
            append(index, operation)?;
        }
        let reference = [values[0], values[1], values[2]];
        let reference_slopes = slopes[..3 * n].to_vec();
        values.drain(..3);
        slopes.drain(..3 * n);
        Some((values, slopes, (reference, reference_slopes)))
    }
}

fn add(into: &mut [f64], factor: f64, row: &[f64]) {
    for (sum, value) in into.iter_mut().zip(row) {
        *sum += factor * value;
    }
}
