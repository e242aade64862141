//! The decoupling parameters over a working volume, and their errors.

use std::error::Error;
use std::fmt;

use glam::DVec3;
use magsplice_ideal::IdealFilm;
use magsplice_magnet::Grid;
use ndarray::{Array3, ArrayView2};

use crate::ideal_error::{SquareSums, ideal_error};
use crate::parameters::{Branch, Parameters};
use crate::per_axis::PerAxis;
use crate::per_parameter::{Parameter, PerParameter};

/// The decoupling parameters of a film over a working volume, with their errors.
///
/// ```
/// use glam::DVec3;
/// use magsplice_decouple::Decoupling;
/// use magsplice_ideal::IdealFilm;
/// use magsplice_magnet::Grid;
///
/// let film = IdealFilm::new(10.0, 1.0, 0.12).unwrap(); // millimetres and tesla
/// let [lower, upper] = [DVec3::new(-2.0, -2.0, -5.0), DVec3::new(2.0, 2.0, -3.0)];
/// let grid = Grid::new(lower, upper, [9, 9, 5]).unwrap();
/// let field_t: Vec<DVec3> = grid.points().map(|p| film.flux_density_t(p).unwrap()).collect();
/// let reference = DVec3::new(0.0, 0.0, -5.0);
/// let at_reference = (reference, film.flux_density_t(reference).unwrap());
/// let decoupling = Decoupling::from_field(&grid, &field_t, at_reference, &film).unwrap();
/// assert!(decoupling.uniformity_rmse.r_x.unwrap() < 1e-13); // the ideal film decouples perfectly
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Decoupling {
    /// The parameters at every point of the grid, by index along x, y, z. `None` at singular
    /// points. They are not serialized.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub parameters: Array3<Option<Parameters>>,
    /// The parameters at the reference point.
    pub at_reference: Parameters,
    /// Points where B_z = 0 and the parameters do not exist. These points enter no average.
    #[cfg_attr(feature = "serde", serde(rename = "singular_points_mm"))]
    pub singular: Vec<DVec3>,
    /// Uniformity RMSE: the population standard deviation of a parameter over a plane normal to its
    /// own axis, averaged over the planes. It measures the undesired dependence of the parameter on
    /// the other two coordinates. Planes with one regular point do not count; `None` where no plane
    /// has two.
    pub uniformity_rmse: PerParameter<Option<f64>>,
    /// Root mean square, over all points, of the difference between a parameter's change from the
    /// reference point and the change of the ideal film (-k dx, -k dy, k dz).
    pub ideal_rmse: PerParameter,
    /// The errors as displacements along x, y, z (Dai 2024, Eq. 14): divided by the wavenumber, in
    /// the unit of lengths, which is millimetres in layouts.
    pub displacement_rmse_mm: PerAxis,
}

/// Statistics of a parameter over one plane normal to its own axis, where it should be constant.
/// Values are in radians for R_x and R_y, without unit for S_z.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PlaneStatistics {
    /// Mean over the regular points of the plane.
    pub mean: f64,
    /// Population standard deviation. `None` for one point.
    pub deviation: Option<f64>,
    /// Smallest value.
    pub least: f64,
    /// Largest value.
    pub most: f64,
}

/// The reason why the decoupling parameters of a film cannot be evaluated.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum DecouplingError {
    /// B_z vanishes at the reference point, so there is no branch and no reference value.
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
        /// The largest coordinate.
        reach: f64,
        /// Half the wavelength.
        half_wavelength: f64,
    },
}

impl Decoupling {
    /// Evaluates a field given on `grid`, z fastest, and at a reference point.
    ///
    /// Fields are in tesla, lengths in any one unit. The reference point also fixes the branch, so
    /// it must be near the axis of the film; see [`Branch`].
    ///
    /// # Accuracy
    /// Errors of the parameters as in [`Parameters::from_field`]. The computed errors of a
    /// perfectly decoupled film are below 1e-13 in the published working volume.
    ///
    /// # Errors
    /// * [`DecouplingError::SingularReference`] if B_z vanishes at the reference point;
    /// * [`DecouplingError::AllSingular`] if B_z vanishes at every point of the grid;
    /// * [`DecouplingError::BeyondHalfWave`] if the grid reaches half a wavelength from the axis
    ///   along x or y.
    ///
    /// # Panics
    /// If `field_t` does not have one value per point of the grid.
    pub fn from_field(
        grid: &Grid,
        field_t: &[DVec3],
        (reference, reference_field_t): (DVec3, DVec3),
        ideal: &IdealFilm,
    ) -> Result<Decoupling, DecouplingError> {
        assert_eq!(field_t.len(), grid.len(), "one field value per point of the grid");
        check_reach(grid.lower().abs().max(grid.upper().abs()), ideal)?;
        let (branch, at_reference) = reference_parameters(reference, reference_field_t)?;

        let [nx, ny, nz] = grid.counts();
        let parameters = Array3::from_shape_fn((nx, ny, nz), |(i, j, k)| {
            Parameters::from_field(field_t[(i * ny + j) * nz + k], branch)
        });
        let singular: Vec<DVec3> =
            parameters.iter().zip(grid.points()).filter(|(p, _)| p.is_none()).map(|(_, at)| at).collect();
        if singular.len() == grid.len() {
            return Err(DecouplingError::AllSingular);
        }
        let uniformity = |parameter: Parameter| mean_deviation(&plane_statistics(&parameters, parameter));
        let uniformity_rmse = Parameter::ALL.map(uniformity).into();
        let ideal_rmse = ideal_rmse(&parameters, &at_reference, grid, reference, ideal.wavenumber());
        let displacement_rmse_mm = ideal_rmse.as_lengths(ideal.wavenumber()).into();
        Ok(Decoupling { parameters, at_reference, singular, uniformity_rmse, ideal_rmse, displacement_rmse_mm })
    }

    /// Statistics of a parameter over each plane of the grid normal to the axis of the parameter.
    /// `None` for a plane of singular points. The mean of the deviations is
    /// [`Decoupling::uniformity_rmse`].
    pub fn plane_statistics(&self, parameter: Parameter) -> Vec<Option<PlaneStatistics>> {
        plane_statistics(&self.parameters, parameter)
    }
}

fn plane_statistics(parameters: &Array3<Option<Parameters>>, parameter: Parameter) -> Vec<Option<PlaneStatistics>> {
    parameters
        .axis_iter(ndarray::Axis(parameter.axis().index()))
        .map(|plane| statistics_over(&plane, parameter))
        .collect()
}

/// Mean deviation of the planes with two regular points.
fn mean_deviation(planes: &[Option<PlaneStatistics>]) -> Option<f64> {
    let deviations: Vec<f64> = planes.iter().flatten().filter_map(|plane| plane.deviation).collect();
    (!deviations.is_empty()).then(|| deviations.iter().sum::<f64>() / deviations.len() as f64)
}

/// Statistics over one plane, in two passes, so that a constant plane has no deviation.
fn statistics_over(plane: &ArrayView2<Option<Parameters>>, parameter: Parameter) -> Option<PlaneStatistics> {
    let values: Vec<f64> = plane.iter().flatten().map(|at_point| at_point.get(parameter)).collect();
    if values.is_empty() {
        return None;
    }
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let deviation = (values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / count).sqrt();
    Some(PlaneStatistics {
        mean,
        deviation: (values.len() > 1).then_some(deviation),
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
    let mut squares = SquareSums::default();
    for (p, at) in parameters.iter().zip(grid.points()) {
        let Some(p) = p else { continue };
        squares.add(ideal_error(p, at_reference, at - reference, k));
    }
    squares.rmse()
}

/// Rejects points half a wavelength or more from the axis. `reach` is the largest magnitude of each
/// coordinate.
pub(crate) fn check_reach(reach: DVec3, ideal: &IdealFilm) -> Result<(), DecouplingError> {
    let half_wavelength = 0.5 * ideal.wavelength();
    for axis in 0..2 {
        if reach[axis] >= half_wavelength {
            return Err(DecouplingError::BeyondHalfWave { axis, reach: reach[axis], half_wavelength });
        }
    }
    Ok(())
}

/// The branch and the parameters at the reference point.
pub(crate) fn reference_parameters(at: DVec3, field_t: DVec3) -> Result<(Branch, Parameters), DecouplingError> {
    let singular = DecouplingError::SingularReference { at };
    let branch = Branch::from_axis_field(field_t).ok_or(singular)?;
    let parameters = Parameters::from_field(field_t, branch).ok_or(singular)?;
    Ok((branch, parameters))
}

impl fmt::Display for DecouplingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            DecouplingError::SingularReference { at } => write!(
                f,
                "B_z vanishes at the reference point ({}, {}, {}), where the decoupling parameters do not exist; \
                 choose a reference on the axis of the film",
                at.x, at.y, at.z
            ),
            DecouplingError::AllSingular => write!(
                f,
                "B_z vanishes at every point of the working volume, so no decoupling parameter exists; at least one \
                 tile must be magnetized"
            ),
            DecouplingError::BeyondHalfWave { axis, reach, half_wavelength } => {
                let axis = if *axis == 0 { "x" } else { "y" };
                write!(
                    f,
                    "the working volume reaches |{axis}| = {reach}, must stay below half a wavelength, \
                     {half_wavelength}, where R_{axis} repeats itself"
                )
            }
        }
    }
}

impl Error for DecouplingError {}

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
    fn ideal_film_has_no_error() {
        let d = Decoupling::from_field(&grid(), &ideal_field(&grid()), reference(), &film()).unwrap();
        let uniformity = d.uniformity_rmse.map(Option::unwrap);
        for value in [uniformity.r_x, uniformity.s_z, d.ideal_rmse.r_y, d.ideal_rmse.s_z] {
            // Round-off of the parameters: |B| / |B_z| is below 10 in this volume.
            assert!(value < 1e-13, "{value}");
        }
        assert!(d.singular.is_empty());
    }

    /// An error in one plane of S_z is the standard deviation of that plane over the number of
    /// planes.
    #[test]
    fn error_in_one_plane_is_its_deviation_over_the_number_of_planes() {
        let grid = grid();
        let mut field = ideal_field(&grid);
        let index = 7 * 3 + 1;
        field[index] *= 1.1;
        let d = Decoupling::from_field(&grid, &field, reference(), &film()).unwrap();
        // One of 25 values is raised by e, so the deviation is e sqrt(24) / 25.
        let e = 1.1_f64.ln();
        let uniformity = d.uniformity_rmse.map(Option::unwrap);
        assert_relative_eq!(uniformity.s_z, e * 24.0_f64.sqrt() / 25.0 / 3.0, max_relative = 1e-9);
        assert_relative_eq!(d.ideal_rmse.s_z, e / 75.0_f64.sqrt(), max_relative = 1e-9);
        assert_relative_eq!(d.displacement_rmse_mm.z, e / 75.0_f64.sqrt() / film().wavenumber());
        assert!(uniformity.r_x < 1e-13);
        let plane = d.plane_statistics(Parameter::Sz)[1].unwrap();
        assert_relative_eq!(plane.most - plane.least, e, max_relative = 1e-9);
        assert_relative_eq!(plane.mean - plane.least, e / 25.0, max_relative = 1e-9);
        assert_relative_eq!(plane.deviation.unwrap(), 3.0 * uniformity.s_z, max_relative = 1e-9);
    }

    /// A film displaced after the reference was taken has the same error at every point.
    #[test]
    fn displacement_of_the_film_is_the_ideal_error() {
        let (grid, moved) = (grid(), DVec3::new(0.03, -0.05, 0.02));
        let field: Vec<DVec3> = grid.points().map(|p| film().flux_density_t(p + moved).unwrap()).collect();
        let at = DVec3::new(0.7, -0.4, -4.5);
        let d = Decoupling::from_field(&grid, &field, (at, film().flux_density_t(at).unwrap()), &film()).unwrap();
        let found = DVec3::from(d.displacement_rmse_mm);
        assert!((found - moved.abs()).length() < 1e-12, "{found}");
        assert!(d.uniformity_rmse.map(Option::unwrap).as_lengths(film().wavenumber()).length() < 1e-12);
    }

    #[test]
    fn messages_name_the_axis_and_its_parameter() {
        let wide = |axis| DecouplingError::BeyondHalfWave { axis, reach: 6.0, half_wavelength: 5.0 }.to_string();
        let expected =
            "the working volume reaches |x| = 6, must stay below half a wavelength, 5, where R_x repeats itself";
        assert_eq!(wide(0), expected);
        assert_eq!(wide(1), expected.replace("|x|", "|y|").replace("R_x", "R_y"));
        let at = DVec3::new(1.0, 2.0, -3.0);
        assert!(DecouplingError::SingularReference { at }.to_string().contains("(1, 2, -3)"));
    }

    #[test]
    fn singular_points_are_listed_and_enter_no_average() {
        let grid = grid();
        let mut field = ideal_field(&grid);
        field[4].z = 0.0;
        let d = Decoupling::from_field(&grid, &field, reference(), &film()).unwrap();
        assert_eq!(d.singular, [grid.point(4)]);
        assert!(d.ideal_rmse.r_x < 1e-13 && d.uniformity_rmse.r_x.unwrap() < 1e-13);
    }

    /// Along a line of points in x, the planes normal to x have one point each.
    #[test]
    fn planes_of_one_point_have_no_uniformity() {
        let line = Grid::new(DVec3::new(-1.0, 0.0, -4.0), DVec3::new(1.0, 0.0, -4.0), [3, 1, 1]).expect("a grid");
        let d = Decoupling::from_field(&line, &ideal_field(&line), reference(), &film()).unwrap();
        let PerParameter { r_x, r_y, s_z } = d.uniformity_rmse;
        assert!(r_x.is_none() && r_y.unwrap() < 1e-13 && s_z.unwrap() < 1e-13, "{r_x:?} {r_y:?} {s_z:?}");
    }

    /// A plane with one regular point has no deviation, so it does not count as perfect.
    #[test]
    fn planes_with_one_regular_point_do_not_count() {
        let grid = grid();
        let mut field = ideal_field(&grid);
        let points: Vec<DVec3> = grid.points().collect();
        let regular = [points[grid.len() / 2], points[grid.len() / 2 + 1]];
        for (b, at) in field.iter_mut().zip(&points) {
            if !regular.contains(at) {
                b.z = 0.0;
            }
        }
        let d = Decoupling::from_field(&grid, &field, reference(), &film()).unwrap();
        // Both are in one plane normal to x and y, each in another normal to z.
        assert!(d.uniformity_rmse.r_x.is_some() && d.uniformity_rmse.r_y.is_some());
        assert_eq!(d.uniformity_rmse.s_z, None);
        assert!(d.plane_statistics(Parameter::Sz).iter().flatten().all(|plane| plane.deviation.is_none()));
    }

    #[test]
    fn vanishing_fields_and_wide_volumes_are_errors() {
        let zero = vec![DVec3::ZERO; grid().len()];
        let (at, field) = reference();
        assert_eq!(Decoupling::from_field(&grid(), &zero, (at, field), &film()), Err(DecouplingError::AllSingular));
        let vanishing = Decoupling::from_field(&grid(), &zero, (at, DVec3::X), &film());
        assert_eq!(vanishing, Err(DecouplingError::SingularReference { at }));
        let wide = Grid::new(DVec3::new(-2.0, -5.0, -5.0), grid().upper(), grid().counts()).expect("a grid");
        let error = Decoupling::from_field(&wide, &zero, (at, field), &film()).unwrap_err();
        assert_eq!(error, DecouplingError::BeyondHalfWave { axis: 1, reach: 5.0, half_wavelength: 5.0 });
    }
}
