//! The decoupling parameters at given points, and their errors.

use glam::DVec3;
use magsplice_ideal::IdealFilm;

use crate::decoupling::{DecouplingError, check_reach, reference_parameters};
use crate::ideal_error::{SquareSums, ideal_error};
use crate::parameters::Parameters;
use crate::per_axis::PerAxis;
use crate::per_parameter::PerParameter;

/// The decoupling parameters of a film at given points, with their errors against the ideal film. A
/// uniformity RMSE would need the planes of a grid.
///
/// ```
/// use glam::DVec3;
/// use magsplice_decouple::PointDecoupling;
/// use magsplice_ideal::IdealFilm;
///
/// let film = IdealFilm::new(10.0, 1.0, 0.12).unwrap(); // millimetres and tesla
/// let points = [DVec3::new(0.3, -1.7, -4.0), DVec3::new(2.0, 0.0, -3.5)];
/// let field_t = points.map(|p| film.flux_density_t(p).unwrap());
/// let reference = DVec3::new(0.0, 0.0, -5.0);
/// let at_reference = (reference, film.flux_density_t(reference).unwrap());
/// let decoupling = PointDecoupling::from_field(&points, &field_t, at_reference, &film).unwrap();
/// assert!(decoupling.displacement_error(0, film.wavenumber()).unwrap().length() < 1e-12);
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct PointDecoupling {
    /// The parameters at each point. `None` at singular points. They are not serialized.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub parameters: Vec<Option<Parameters>>,
    /// The parameters at the reference point.
    pub at_reference: Parameters,
    /// Each parameter's change from the reference point minus the change of the ideal film (-k dx,
    /// -k dy, k dz). `None` at singular points. They are not serialized.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub errors: Vec<Option<PerParameter>>,
    /// Points where B_z = 0 and the parameters do not exist. These points enter no average.
    #[cfg_attr(feature = "serde", serde(rename = "singular_points_mm"))]
    pub singular: Vec<DVec3>,
    /// Root mean square of the errors over all points.
    pub ideal_rmse: PerParameter,
    /// The errors as displacements along x, y, z (Dai 2024, Eq. 14): divided by the wavenumber, in
    /// the unit of lengths, which is millimetres in layouts.
    pub displacement_rmse_mm: PerAxis,
}

impl PointDecoupling {
    /// Evaluates a field given at points and at a reference point.
    ///
    /// Fields are in tesla, lengths in any one unit. The reference point also fixes the branch, so
    /// it must be near the axis of the film; see [`Branch`](crate::Branch).
    ///
    /// # Accuracy
    /// Errors of the parameters as in [`Parameters::from_field`].
    ///
    /// # Errors
    /// The errors of [`Decoupling::from_field`](crate::Decoupling::from_field), for the points
    /// instead of the grid.
    ///
    /// # Panics
    /// If `field_t` does not have one value per point.
    pub fn from_field(
        points: &[DVec3],
        field_t: &[DVec3],
        (reference, reference_field_t): (DVec3, DVec3),
        ideal: &IdealFilm,
    ) -> Result<PointDecoupling, DecouplingError> {
        assert_eq!(field_t.len(), points.len(), "one field value per point");
        let reach = points.iter().fold(DVec3::ZERO, |reach, point| reach.max(point.abs()));
        check_reach(reach, ideal)?;
        let (branch, at_reference) = reference_parameters(reference, reference_field_t)?;
        let parameters: Vec<Option<Parameters>> = field_t.iter().map(|b| Parameters::from_field(*b, branch)).collect();
        let k = ideal.wavenumber();
        let error = |(p, at): (&Option<Parameters>, &DVec3)| {
            p.as_ref().map(|p| ideal_error(p, &at_reference, *at - reference, k))
        };
        let errors: Vec<Option<PerParameter>> = parameters.iter().zip(points).map(error).collect();
        let singular: Vec<DVec3> =
            parameters.iter().zip(points).filter(|(p, _)| p.is_none()).map(|(_, at)| *at).collect();
        if singular.len() == points.len() {
            return Err(DecouplingError::AllSingular);
        }
        let mut squares = SquareSums::default();
        errors.iter().flatten().for_each(|error| squares.add(*error));
        let ideal_rmse = squares.rmse();
        let displacement_rmse_mm = ideal_rmse.as_lengths(k).into();
        Ok(PointDecoupling { parameters, at_reference, errors, singular, ideal_rmse, displacement_rmse_mm })
    }

    /// The displacement from the reference to a point by Eq. 14 of Dai 2024, minus the true
    /// displacement, in the unit of 1 / `wavenumber`. `None` at a singular point.
    ///
    /// # Panics
    /// If there is no such point.
    pub fn displacement_error(&self, index: usize, wavenumber: f64) -> Option<DVec3> {
        self.errors[index].map(|error| DVec3::new(-error.r_x, -error.r_y, error.s_z) / wavenumber)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Decoupling;
    use magsplice_magnet::Grid;

    fn film() -> IdealFilm {
        IdealFilm::new(10.0, 1.0, 0.12).unwrap()
    }

    /// The field of the film at displaced points, for which the errors are known.
    #[test]
    fn displaced_field_has_the_displacement_as_its_error() {
        let moved = DVec3::new(0.03, -0.05, 0.02);
        let points = [DVec3::new(0.3, -1.7, -4.0), DVec3::new(2.0, 0.4, -3.5)];
        let field = points.map(|p| film().flux_density_t(p + moved).unwrap());
        let at = DVec3::new(0.7, -0.4, -4.5);
        let reference = (at, film().flux_density_t(at).unwrap());
        let d = PointDecoupling::from_field(&points, &field, reference, &film()).unwrap();
        for index in 0..2 {
            let error = d.displacement_error(index, film().wavenumber()).unwrap();
            assert!((error - moved).length() < 1e-12, "{error}");
        }
        assert!((DVec3::from(d.displacement_rmse_mm) - moved.abs()).length() < 1e-12);
    }

    #[test]
    fn points_of_a_grid_have_the_errors_of_the_grid() {
        let grid = Grid::new(DVec3::new(-2.0, -2.0, -5.0), DVec3::new(2.0, 2.0, -3.0), [5, 5, 3]).expect("a grid");
        let points: Vec<DVec3> = grid.points().collect();
        let mut field: Vec<DVec3> = points.iter().map(|p| film().flux_density_t(0.9 * *p).unwrap()).collect();
        field[4].z = 0.0;
        let at = DVec3::new(0.0, 0.0, -5.0);
        let reference = (at, film().flux_density_t(at).unwrap());
        let of_grid = Decoupling::from_field(&grid, &field, reference, &film()).unwrap();
        let of_points = PointDecoupling::from_field(&points, &field, reference, &film()).unwrap();
        assert_eq!(of_points.ideal_rmse, of_grid.ideal_rmse);
        assert_eq!((of_points.singular.as_slice(), of_points.errors[4]), (&[points[4]][..], None));
        assert!(of_grid.parameters.iter().eq(of_points.parameters.iter()));
    }

    #[test]
    fn points_beyond_half_a_wavelength_are_refused() {
        let points = [DVec3::new(0.0, -5.0, -4.0)];
        let error = PointDecoupling::from_field(&points, &[DVec3::Z], (points[0], DVec3::Z), &film()).unwrap_err();
        assert_eq!(error, DecouplingError::BeyondHalfWave { axis: 1, reach: 5.0, half_wavelength: 5.0 });
    }
}
