//! Figures of a film as functions of its displacement errors, and their derivatives.
//!
//! Over a plane normal to its own axis, a parameter differs from k times its displacement error by
//! a constant, so that both have the same deviation there.

use glam::DVec3;
use magsplice_decouple::{Figure, Figures, Parameter};
use magsplice_ideal::IdealFilm;
use magsplice_magnet::{Axis, Grid};

use crate::evaluation_grid::SampleError;

/// What turns displacement errors and readings into figures.
#[derive(Clone, Debug)]
pub(crate) struct FigureModel {
    counts: [usize; 3],
    wavenumber: f64,
    /// The field of the ideal film over the sum of its squares: the scalar product with the
    /// readings is the amplitude.
    amplitude_by_field: Vec<DVec3>,
}

impl FigureModel {
    pub(crate) fn new(grid: &Grid, ideal: &IdealFilm) -> Result<FigureModel, SampleError> {
        let at = |point| ideal.flux_density_t(point).ok_or(SampleError::NotBelow { point });
        let mut field: Vec<DVec3> = grid.points().map(at).collect::<Result<_, _>>()?;
        let squares: f64 = field.iter().map(|b| b.length_squared()).sum();
        field.iter_mut().for_each(|b| *b /= squares);
        Ok(FigureModel { counts: grid.counts(), wavenumber: ideal.wavenumber(), amplitude_by_field: field })
    }

    /// The amplitude of readings, or its change by their changes.
    pub(crate) fn amplitude(&self, read_t: &[DVec3]) -> f64 {
        self.amplitude_by_field.iter().zip(read_t).map(|(factor, b_t)| factor.dot(*b_t)).sum()
    }

    /// All figures of displacement errors: x at all points, then y, then z.
    pub(crate) fn of_errors(&self, errors_mm: &[f64], amplitude: f64) -> Figures {
        let count = self.points();
        let uniformity = |parameter: Parameter| {
            let axis = parameter.axis();
            let planes = self.planes(self.along(errors_mm, axis), axis);
            let deviations: f64 = planes.iter().map(|(_, deviation)| deviation).sum();
            (planes.len() < count).then(|| self.wavenumber * deviations / planes.len() as f64)
        };
        let displacement = |axis: Axis| {
            (self.along(errors_mm, axis).iter().map(|error| error * error).sum::<f64>() / count as f64).sqrt()
        };
        Figures {
            uniformity_rmse: Parameter::ALL.map(uniformity).into(),
            displacement_rmse_mm: Axis::ALL.map(displacement).into(),
            amplitude,
        }
    }

    /// The derivatives of a figure by all displacement errors along its axis. `None` if the figure
    /// is not differentiable, or no function of them.
    pub(crate) fn gradient(&self, figure: Figure, errors_mm: &[f64]) -> Option<Vec<f64>> {
        let count = self.points();
        match figure {
            Figure::Displacement(axis) => {
                let along = self.along(errors_mm, axis);
                let squares = along.iter().map(|error| error * error).sum::<f64>();
                let factor = 1.0 / (squares * count as f64).sqrt();
                factor.is_finite().then(|| along.iter().map(|error| error * factor).collect())
            }
            Figure::Uniformity(parameter) => {
                let axis = parameter.axis();
                let along = self.along(errors_mm, axis);
                let planes = self.planes(along, axis);
                let in_plane = (count / planes.len()) as f64;
                let slope = |(index, error): (usize, &f64)| {
                    let (mean, deviation) = planes[self.plane(index, axis)];
                    let slope = self.wavenumber * (error - mean) / (deviation * in_plane * planes.len() as f64);
                    slope.is_finite().then_some(slope)
                };
                along.iter().enumerate().map(slope).collect()
            }
            Figure::Amplitude => None,
        }
    }

    fn along<'a>(&self, errors_mm: &'a [f64], axis: Axis) -> &'a [f64] {
        &errors_mm[axis.index() * self.points()..][..self.points()]
    }

    fn points(&self) -> usize {
        self.amplitude_by_field.len()
    }

    /// The plane normal to an axis in which a point lies. Points are in the order of the grid, z
    /// fastest.
    fn plane(&self, index: usize, axis: Axis) -> usize {
        let [_, ny, nz] = self.counts;
        [index / (ny * nz), index / nz % ny, index % nz][axis.index()]
    }

    /// Mean and deviation over each plane normal to an axis.
    fn planes(&self, along: &[f64], axis: Axis) -> Vec<(f64, f64)> {
        let planes = self.counts[axis.index()];
        let in_plane = (along.len() / planes) as f64;
        let mut found = vec![(0.0, 0.0); planes];
        for (index, value) in along.iter().enumerate() {
            found[self.plane(index, axis)].0 += value / in_plane;
        }
        for (index, value) in along.iter().enumerate() {
            let (mean, square) = &mut found[self.plane(index, axis)];
            *square += (value - *mean).powi(2) / in_plane;
        }
        found.iter_mut().for_each(|(_, square)| *square = square.sqrt());
        found
    }
}
