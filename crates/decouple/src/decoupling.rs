//! The errors of the decoupling parameters over a working volume.

use std::fmt;

use glam::DVec3;
use magsplice_field::{Grid, IdealFilm};
use ndarray::{Array3, ArrayView2, Axis};

use crate::parameters::{Branch, Parameters, half_turn};

/// One number for each decoupling parameter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PerParameter {
    /// Of R_x, in radians.
    pub r_x: f64,
    /// Of R_y, in radians.
    pub r_y: f64,
    /// Of S_z, without unit.
    pub s_z: f64,
}

impl PerParameter {
    /// The same errors as displacements along x, y, z: divided by k (Eq. 14), in the unit of 1 / `wavenumber`.
    pub fn as_lengths(&self, wavenumber: f64) -> DVec3 {
        DVec3::new(self.r_x, self.r_y, self.s_z) / wavenumber
    }
}

/// How well a film decouples over a working volume.
#[derive(Clone, Debug, PartialEq)]
pub struct Decoupling {
    /// The parameters at every point of the grid, by index along x, y, z; `None` at singular points.
    pub parameters: Array3<Option<Parameters>>,
    /// The parameters at the reference point.
    pub at_reference: Parameters,
    /// Where B_z = 0 and the parameters do not exist. These points enter no average.
    pub singular: Vec<DVec3>,
    /// For each plane normal to the parameter's own axis the population standard deviation over the plane, averaged over planes:
    /// how much the parameter depends on the two coordinates it should not depend on.
    pub uniformity_rmse: PerParameter,
    /// Root mean square of the error of the parameter's change from the reference point, against the ideal film's.
    pub ideal_rmse: PerParameter,
}

/// A parameter over one plane normal to its own axis, where it should be constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OverPlane {
    /// Its mean.
    pub mean: f64,
    /// Its population standard deviation.
    pub deviation: f64,
    /// Its least value.
    pub least: f64,
    /// Its largest value.
    pub most: f64,
}

/// Why there are no decoupling errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DecouplingError {
    /// B_z vanishes at the reference point: no branch and no reference.
    SingularReference {
        /// The reference point.
        at: DVec3,
    },
    /// B_z vanishes at every point of the volume.
    AllSingular,
    /// The volume reaches half a wavelength from the axis, where R_x or R_y repeats itself.
    BeyondHalfWave {
        /// 0 for x, 1 for y.
        axis: usize,
        /// The coordinate that is too large.
        reach: f64,
        /// Half the wavelength.
        half_wavelength: f64,
    },
}

impl Decoupling {
    /// Evaluates a field given on `grid`, z fastest, and at the `reference` point, which also fixes the branch (see [`Branch`])
    /// and so must lie near the axis. Fields in tesla, lengths in one unit.
    ///
    /// # Errors
    /// See [`DecouplingError`].
    ///
    /// # Panics
    /// If `field_t` does not have one value per point of the grid.
    pub fn of(
        grid: &Grid,
        field_t: &[DVec3],
        (reference, reference_field_t): (DVec3, DVec3),
        ideal: &IdealFilm,
    ) -> Result<Decoupling, DecouplingError> {
        assert_eq!(field_t.len(), grid.len(), "one field value per point of the grid");
        let half_wavelength = 0.5 * ideal.wavelength();
        for axis in 0..2 {
            let reach = grid.lower()[axis].abs().max(grid.upper()[axis].abs());
            if reach >= half_wavelength {
                return Err(DecouplingError::BeyondHalfWave { axis, reach, half_wavelength });
            }
        }
        let singular_reference = DecouplingError::SingularReference { at: reference };
        let branch = Branch::from_axis_field(reference_field_t).ok_or(singular_reference)?;
        let at_reference = Parameters::of(reference_field_t, branch).ok_or(singular_reference)?;

        let [nx, ny, nz] = grid.counts();
        let parameters =
            Array3::from_shape_fn((nx, ny, nz), |(i, j, k)| Parameters::of(field_t[(i * ny + j) * nz + k], branch));
        let singular: Vec<DVec3> =
            parameters.iter().zip(grid.points()).filter(|(p, _)| p.is_none()).map(|(_, at)| at).collect();
        if singular.len() == grid.len() {
            return Err(DecouplingError::AllSingular);
        }
        let [r_x, r_y, s_z] = [0, 1, 2].map(|axis| mean_deviation(&over_planes(&parameters, axis)));
        let uniformity_rmse = PerParameter { r_x, r_y, s_z };
        let ideal_rmse = ideal_rmse(&parameters, &at_reference, grid, reference, ideal.wavenumber());
        Ok(Decoupling { parameters, at_reference, singular, uniformity_rmse, ideal_rmse })
    }

    /// For each plane of the grid normal to `axis` (0, 1, 2 for x, y, z) the parameter that should follow that axis only; `None` where all points
    /// of the plane are singular. The mean of the deviations is [`Decoupling::uniformity_rmse`].
    ///
    /// # Panics
    /// If `axis` is above 2.
    pub fn over_planes(&self, axis: usize) -> Vec<Option<OverPlane>> {
        over_planes(&self.parameters, axis)
    }
}

fn over_planes(parameters: &Array3<Option<Parameters>>, axis: usize) -> Vec<Option<OverPlane>> {
    let of: [fn(&Parameters) -> f64; 3] = [|p| p.r_x, |p| p.r_y, |p| p.s_z];
    parameters.axis_iter(Axis(axis)).map(|plane| over_plane(&plane, of[axis])).collect()
}

/// The deviations averaged over the planes that have any regular point.
fn mean_deviation(planes: &[Option<OverPlane>]) -> f64 {
    let deviations: Vec<f64> = planes.iter().flatten().map(|plane| plane.deviation).collect();
    deviations.iter().sum::<f64>() / deviations.len() as f64
}

/// In two passes, so that a constant plane has no deviation.
fn over_plane(plane: &ArrayView2<Option<Parameters>>, of: fn(&Parameters) -> f64) -> Option<OverPlane> {
    let values: Vec<f64> = plane.iter().flatten().map(of).collect();
    if values.is_empty() {
        return None;
    }
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    Some(OverPlane {
        mean,
        deviation: (values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / count).sqrt(),
        least: values.iter().copied().fold(f64::INFINITY, f64::min),
        most: values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
    })
}

fn ideal_rmse(
    parameters: &Array3<Option<Parameters>>,
    at_reference: &Parameters,
    grid: &Grid,
    reference: DVec3,
    k: f64,
) -> PerParameter {
    let mut squares = PerParameter::default();
    let mut count = 0.0;
    for (p, at) in parameters.iter().zip(grid.points()) {
        let Some(p) = p else { continue };
        let moved = at - reference;
        squares.r_x += half_turn(p.r_x - at_reference.r_x + k * moved.x).powi(2);
        squares.r_y += half_turn(p.r_y - at_reference.r_y + k * moved.y).powi(2);
        squares.s_z += (p.s_z - at_reference.s_z - k * moved.z).powi(2);
        count += 1.0;
    }
    let root = |sum: f64| (sum / count).sqrt();
    PerParameter { r_x: root(squares.r_x), r_y: root(squares.r_y), s_z: root(squares.s_z) }
}

impl fmt::Display for DecouplingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            DecouplingError::SingularReference { at } => write!(
                f,
                "B_z vanishes at the reference point ({}, {}, {}), where the decoupling parameters do not exist: \
                 choose a reference on the axis of the film",
                at.x, at.y, at.z
            ),
            DecouplingError::AllSingular => write!(
                f,
                "B_z vanishes at every point of the working volume, so no decoupling parameter exists: is any tile magnetized?"
            ),
            DecouplingError::BeyondHalfWave { axis, reach, half_wavelength } => write!(
                f,
                "the working volume reaches |{}| = {reach}, must stay below half a wavelength, {half_wavelength}, where R_{} repeats itself",
                ["x", "y"][*axis],
                ["x", "y"][*axis]
            ),
        }
    }
}

impl std::error::Error for DecouplingError {}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn film() -> IdealFilm {
        IdealFilm::new(10.0, 1.0, 0.12).unwrap()
    }

    fn grid() -> Grid {
        Grid::new(DVec3::new(-2.0, -2.0, -5.0), DVec3::new(2.0, 2.0, -3.0), [5, 5, 3]).expect("a grid")
    }

    fn ideal_field(grid: &Grid) -> Vec<DVec3> {
        grid.points().map(|p| film().flux_density_t(p).unwrap()).collect()
    }

    fn reference() -> (DVec3, DVec3) {
        let at = DVec3::new(0.0, 0.0, -5.0);
        (at, film().flux_density_t(at).unwrap())
    }

    #[test]
    fn the_ideal_film_has_no_error() {
        let d = Decoupling::of(&grid(), &ideal_field(&grid()), reference(), &film()).unwrap();
        for value in [d.uniformity_rmse.r_x, d.uniformity_rmse.s_z, d.ideal_rmse.r_y, d.ideal_rmse.s_z] {
            // Round-off of the parameters, |B| / |B_z| below 10 in this volume.
            assert!(value < 1e-13, "{value}");
        }
        assert!(d.singular.is_empty());
    }

    /// An error put into one plane of S_z comes back as the standard deviation of that plane over the number of planes.
    #[test]
    fn an_error_in_one_plane() {
        let grid = grid();
        let mut field = ideal_field(&grid);
        let index = 7 * 3 + 1;
        field[index] *= 1.1;
        let d = Decoupling::of(&grid, &field, reference(), &film()).unwrap();
        // One of 25 values raised by e: deviation e sqrt(24) / 25.
        let e = 1.1_f64.ln();
        assert_relative_eq!(d.uniformity_rmse.s_z, e * 24.0_f64.sqrt() / 25.0 / 3.0, max_relative = 1e-9);
        assert_relative_eq!(d.ideal_rmse.s_z, e / 75.0_f64.sqrt(), max_relative = 1e-9);
        assert_relative_eq!(d.ideal_rmse.as_lengths(film().wavenumber()).z, e / 75.0_f64.sqrt() / film().wavenumber());
        assert!(d.uniformity_rmse.r_x < 1e-13);
        let plane = d.over_planes(2)[1].unwrap();
        assert_relative_eq!(plane.most - plane.least, e, max_relative = 1e-9);
        assert_relative_eq!(plane.mean - plane.least, e / 25.0, max_relative = 1e-9);
        assert_relative_eq!(plane.deviation, 3.0 * d.uniformity_rmse.s_z, max_relative = 1e-9);
    }

    #[test]
    fn singular_points_are_named_and_left_out() {
        let grid = grid();
        let mut field = ideal_field(&grid);
        field[4].z = 0.0;
        let d = Decoupling::of(&grid, &field, reference(), &film()).unwrap();
        assert_eq!(d.singular, [grid.point(4)]);
        assert!(d.ideal_rmse.r_x < 1e-13 && d.uniformity_rmse.r_x < 1e-13);
    }

    #[test]
    fn what_cannot_be_evaluated_is_an_error() {
        let zero = vec![DVec3::ZERO; grid().len()];
        let (at, field) = reference();
        assert_eq!(Decoupling::of(&grid(), &zero, (at, field), &film()), Err(DecouplingError::AllSingular));
        let vanishing = Decoupling::of(&grid(), &zero, (at, DVec3::X), &film());
        assert_eq!(vanishing, Err(DecouplingError::SingularReference { at }));
        let wide = Grid::new(DVec3::new(-2.0, -5.0, -5.0), grid().upper(), grid().counts()).expect("a grid");
        let error = Decoupling::of(&wide, &zero, (at, field), &film()).unwrap_err();
        assert_eq!(error, DecouplingError::BeyondHalfWave { axis: 1, reach: 5.0, half_wavelength: 5.0 });
    }
}
