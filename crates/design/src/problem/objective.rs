//! The objective: residuals whose squares are minimized, with derivatives, for each goal.

use glam::DVec3;
use magsplice_decouple::{Branch, ParameterDerivatives, Parameters};
use magsplice_head::SensorHead;
use magsplice_ideal::IdealFilm;
use magsplice_layout::Goal;

use crate::error::DesignError;
use crate::problem::pattern::half_turn;
use crate::problem::sampling::{SampledField, Sampling};
use crate::problem::symmetry::SymmetryOperation;

/// The goal of a design, with the inputs of its residuals besides the field.
#[derive(Clone, Debug)]
pub(crate) struct Objective {
    pub(crate) goal: Goal,
    /// Weights of R_x, R_y, S_z, or of the displacement along x, y, z.
    pub(crate) weights: [f64; 3],
    pub(crate) ideal: IdealFilm,
    /// B of the ideal film as it is read at the computed points, in tesla.
    pub(crate) ideal_field_t: Vec<DVec3>,
    /// The least amplitude, if any. Where the field is the goal, the target is the ideal field
    /// times this.
    pub(crate) amplitude: Option<f64>,
    /// Weights of the points of the sampling, for each grid over which the amplitude is bounded.
    pub(crate) amplitude_weights: Vec<Vec<f64>>,
}

/// B of an ideal film at points, in tesla, as a head or a single sensor reads it.
///
/// # Errors
/// [`DesignError::NotBelow`] if a place of a sensor is not below the film.
pub(crate) fn ideal_field_t(
    ideal: &IdealFilm,
    head: Option<&SensorHead>,
    points: &[DVec3],
) -> Result<Vec<DVec3>, DesignError> {
    let below = |place: DVec3| ideal.flux_density_t(place).ok_or(DesignError::NotBelow(place));
    points.iter().map(|point| head.map_or_else(|| below(*point), |head| head.seen(*point, below))).collect()
}

/// Residuals of a film. Half the sum of their squares is the loss.
#[derive(Clone, Debug)]
pub(crate) struct Residuals {
    pub(crate) values: Vec<f64>,
    /// Derivatives of the values, variable fastest.
    pub(crate) derivatives: Vec<f64>,
    /// Best-fit amplitudes over the grids of [`Objective::amplitude_weights`], with derivatives.
    pub(crate) amplitudes: Vec<(f64, Vec<f64>)>,
    /// The expected square that errors of the film add.
    pub(crate) expected: Option<ExpectedSquares>,
}

/// Half the expected square that errors add, with its derivatives.
#[derive(Clone, Debug)]
pub(crate) struct ExpectedSquares {
    pub(crate) loss: f64,
    /// Derivatives of the loss.
    pub(crate) gradient: Vec<f64>,
    /// Second derivatives of the loss, without second derivatives of the sensitivities, by rows.
    pub(crate) curvature: Vec<f64>,
}

impl Residuals {
    /// Half the sum of squares.
    pub(crate) fn loss(&self) -> f64 {
        let nominal = 0.5 * self.values.iter().map(|v| v * v).sum::<f64>();
        self.expected.as_ref().map_or(nominal, |expected| nominal + expected.loss)
    }

    /// Adds the derivatives of the loss by the variables.
    pub(crate) fn add_gradient(&self, n: usize, into: &mut [f64]) {
        for (value, row) in self.values.iter().zip(self.derivatives.chunks_exact(n)) {
            for i in 0..n {
                into[i] += value * row[i];
            }
        }
        if let Some(expected) = &self.expected {
            into.iter_mut().zip(&expected.gradient).for_each(|(sum, slope)| *sum += slope);
        }
    }
}

impl Objective {
    /// The residuals of a field. `None` where B_z = 0 at some point, so that decoupling parameters
    /// do not exist.
    pub(crate) fn residuals(&self, sampling: &Sampling, field: &SampledField) -> Option<Residuals> {
        let amplitudes =
            self.amplitude_weights.iter().map(|weights| self.amplitude(weights, sampling, field)).collect();
        let (values, derivatives) = match self.goal {
            Goal::Field => self.field_residuals(sampling, field),
            Goal::Uniformity => self.uniformity_residuals(sampling, field)?,
            Goal::Displacement => self.displacement_residuals(sampling, field)?,
        };
        Some(Residuals { values, derivatives, amplitudes, expected: None })
    }

    /// Best-fit amplitude with derivatives, over the grid of the weights.
    fn amplitude(&self, weights: &[f64], sampling: &Sampling, field: &SampledField) -> (f64, Vec<f64>) {
        let (mut product, mut square) = (0.0, 0.0);
        let mut derivatives = vec![0.0; field.variable_count];
        for (&(index, _), weight) in sampling.images().iter().zip(weights) {
            let ideal = self.ideal_field_t[index];
            product += weight * ideal.dot(field.flux_density_t[index]);
            square += weight * ideal.length_squared();
            for (derivative, by) in derivatives.iter_mut().zip(field.derivatives_at(index)) {
                *derivative += weight * ideal.dot(*by);
            }
        }
        derivatives.iter_mut().for_each(|derivative| *derivative /= square);
        (product / square, derivatives)
    }

    /// Components of B minus the target field, relative to the root mean square of the target.
    fn field_residuals(&self, sampling: &Sampling, field: &SampledField) -> (Vec<f64>, Vec<f64>) {
        let wanted = self.amplitude.unwrap_or(1.0);
        let square: f64 = sampling.images().iter().map(|&(index, _)| self.ideal_field_t[index].length_squared()).sum();
        let factor = 1.0 / (wanted * square.sqrt());
        let (mut values, mut derivatives) = (Vec::new(), Vec::new());
        for &(index, _) in sampling.images() {
            let error = factor * (field.flux_density_t[index] - wanted * self.ideal_field_t[index]);
            for axis in 0..3 {
                values.push(error[axis]);
                derivatives.extend(field.derivatives_at(index).iter().map(|by| factor * by[axis]));
            }
        }
        (values, derivatives)
    }

    /// Differences of each parameter from its mean over each plane normal to its axis.
    fn uniformity_residuals(&self, sampling: &Sampling, field: &SampledField) -> Option<(Vec<f64>, Vec<f64>)> {
        let (grid, n) = (&sampling.grid, field.variable_count);
        let (parameters, derivatives) = self.parameters(sampling, field)?;
        let (parameters, derivatives) = (&parameters[3..], &derivatives[3 * n..]);
        let mut values = vec![0.0; parameters.len()];
        let mut errors = vec![0.0; derivatives.len()];
        for axis in 0..3 {
            let factor = self.weights[axis] / (grid.len() as f64).sqrt();
            let points = (grid.len() / grid.counts()[axis]) as f64;
            for plane in 0..grid.counts()[axis] {
                let rows = || (0..grid.len()).filter(|&i| grid.indices(i)[axis] == plane).map(|i| 3 * i + axis);
                let mean = rows().map(|row| parameters[row]).sum::<f64>() / points;
                let mut mean_derivatives = vec![0.0; n];
                for row in rows() {
                    add(&mut mean_derivatives, 1.0 / points, &derivatives[row * n..][..n]);
                }
                for row in rows() {
                    values[row] = factor * (parameters[row] - mean);
                    let into = &mut errors[row * n..][..n];
                    for ((error, derivative), mean) in
                        into.iter_mut().zip(&derivatives[row * n..][..n]).zip(&mean_derivatives)
                    {
                        *error = factor * (derivative - mean);
                    }
                }
            }
        }
        Some((values, errors))
    }

    /// Changes of the parameters from the reference point minus their changes in the ideal film,
    /// divided by k (Dai 2024, Eq. 14).
    fn displacement_residuals(&self, sampling: &Sampling, field: &SampledField) -> Option<(Vec<f64>, Vec<f64>)> {
        let (grid, n, k) = (&sampling.grid, field.variable_count, self.ideal.wavenumber());
        let (parameters, derivatives) = self.parameters(sampling, field)?;
        let (at_reference, parameters) = parameters.split_at(3);
        let (reference_derivatives, derivatives) = derivatives.split_at(3 * n);
        let mut values = vec![0.0; parameters.len()];
        let mut errors = vec![0.0; derivatives.len()];
        for (index, point) in grid.points().enumerate() {
            let ideal = k * (point - sampling.reference) * DVec3::new(-1.0, -1.0, 1.0);
            for axis in 0..3 {
                let row = 3 * index + axis;
                let factor = self.weights[axis] / (grid.len() as f64).sqrt() / k;
                let change = parameters[row] - at_reference[axis] - ideal[axis];
                values[row] = factor * if axis < 2 { half_turn(change) } else { change };
                let into = &mut errors[row * n..][..n];
                add(into, factor, &derivatives[row * n..][..n]);
                add(into, -factor, &reference_derivatives[axis * n..][..n]);
            }
        }
        Some((values, errors))
    }

    /// R_x, R_y, S_z at the reference point, then at the points of the grid, parameter fastest,
    /// with derivatives.
    fn parameters(&self, sampling: &Sampling, field: &SampledField) -> Option<(Vec<f64>, Vec<f64>)> {
        let last = field.flux_density_t.len() - 1;
        let branch = Branch::from_axis_field(field.flux_density_t[last])?;
        let (mut values, mut derivatives) = (Vec::new(), Vec::new());
        let mut append = |index: usize, operation: SymmetryOperation| {
            let b = operation.apply(field.flux_density_t[index]);
            let (p, ParameterDerivatives { r_x, r_y, s_z }) = Parameters::with_derivatives(b, branch)?;
            values.extend([p.r_x, p.r_y, p.s_z]);
            for by_b in [r_x, r_y, s_z] {
                let back = operation.inverse().apply(by_b);
                derivatives.extend(field.derivatives_at(index).iter().map(|by| back.dot(*by)));
            }
            Some(())
        };
        append(last, SymmetryOperation::IDENTITY)?;
        for &(index, operation) in sampling.images() {
            append(index, operation)?;
        }
        Some((values, derivatives))
    }
}

/// Adds a multiple of a row.
fn add(into: &mut [f64], factor: f64, row: &[f64]) {
    for (sum, value) in into.iter_mut().zip(row) {
        *sum += factor * value;
    }
}
