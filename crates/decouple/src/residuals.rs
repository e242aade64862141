//! What the parameters over a working volume show of a displacement, minus the true displacement.

use glam::DVec3;
use magsplice_magnet::Grid;

use crate::decoupling::{Decoupling, PlaneStatistics};
use crate::parameters::Parameters;
use crate::per_axis::PerAxis;
use crate::per_parameter::Parameter;

/// The residual of a displacement over one plane normal to its axis: the displacement from the
/// reference point by Eq. 14 of Dai 2024, minus the true displacement. The ideal film has none.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct PlaneResidual {
    /// Coordinate of the plane.
    pub at_mm: f64,
    /// Statistics over the regular points of the plane, in the unit of lengths.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub over_mm: PlaneStatistics,
}

impl Decoupling {
    /// The residuals over the planes normal to x, y and z that have a regular point. `grid` and
    /// `reference` are those of [`Decoupling::from_field`].
    pub fn residuals(&self, grid: &Grid, reference: DVec3, wavenumber: f64) -> PerAxis<Vec<PlaneResidual>> {
        let of = |parameter: Parameter| {
            let axis = parameter.axis().index();
            let at_reference = self.at_reference.get(parameter);
            let per_unit = displacement_per_unit(parameter, wavenumber);
            let planes = self.plane_statistics(parameter).into_iter().enumerate();
            let residual = |(index, over): (usize, Option<PlaneStatistics>)| {
                let PlaneStatistics { mean, deviation, least, most } = over?;
                let at_mm = grid.coordinate(axis, index);
                let shown = |value: f64| per_unit * (value - at_reference) - (at_mm - reference[axis]);
                let [one, other] = [shown(least), shown(most)];
                let over_mm = PlaneStatistics {
                    mean: shown(mean),
                    deviation: deviation.map(|deviation| per_unit.abs() * deviation),
                    least: one.min(other),
                    most: one.max(other),
                };
                Some(PlaneResidual { at_mm, over_mm })
            };
            planes.filter_map(residual).collect()
        };
        Parameter::ALL.map(of).into()
    }

    /// The longest error of the displacement from the reference point, and the point of the grid
    /// where it occurs.
    pub fn worst_displacement_error(&self, grid: &Grid, reference: DVec3, wavenumber: f64) -> Option<(DVec3, DVec3)> {
        let error = |(parameters, at): (&Option<Parameters>, DVec3)| {
            let shown = parameters.as_ref()?.displacement_from(&self.at_reference, wavenumber);
            Some((shown - (at - reference), at))
        };
        let errors = self.parameters.iter().zip(grid.points()).filter_map(error);
        errors.max_by(|(one, _), (other, _)| one.length().total_cmp(&other.length()))
    }
}

/// The displacement that a change of a parameter by 1 shows: R_x and R_y fall along their axes, S_z
/// rises.
fn displacement_per_unit(parameter: Parameter, wavenumber: f64) -> f64 {
    if parameter == Parameter::Sz { 1.0 / wavenumber } else { -1.0 / wavenumber }
}

#[cfg(test)]
mod tests {
    use super::*;
    use magsplice_ideal::IdealFilm;

    /// A field that is read at another place shows the displacement of the place, on every plane.
    #[test]
    fn displaced_reading_has_the_displacement_as_its_residual() {
        let film = IdealFilm::new(10.0, 1.0, 0.12).unwrap();
        let grid = Grid::new(DVec3::new(-2.0, -2.0, -5.0), DVec3::new(2.0, 2.0, -3.0), [5, 5, 3]).expect("a grid");
        let (reference, k) = (DVec3::new(0.0, 0.0, -5.0), film.wavenumber());
        let shift = |p: DVec3| DVec3::new(0.01 * p.x, 0.0, 0.02 * (p.z - reference.z));
        let field: Vec<DVec3> = grid.points().map(|p| film.flux_density_t(p + shift(p)).unwrap()).collect();
        let at_reference = (reference, film.flux_density_t(reference).unwrap());
        let decoupling = Decoupling::from_field(&grid, &field, at_reference, &film).unwrap();
        let residuals = decoupling.residuals(&grid, reference, k);
        for PlaneResidual { at_mm, over_mm } in &residuals.x {
            for shown in [over_mm.mean, over_mm.least, over_mm.most] {
                assert!((shown - 0.01 * at_mm).abs() < 1e-12, "{at_mm}: {shown}");
            }
        }
        assert!(residuals.y.iter().all(|plane| plane.over_mm.mean.abs() < 1e-12));
        assert!((residuals.z[2].over_mm.mean - 0.04).abs() < 1e-12);
        let (error, at) = decoupling.worst_displacement_error(&grid, reference, k).unwrap();
        assert!((error - shift(at)).length() < 1e-12);
        assert_eq!((at.x.abs(), at.z), (2.0, -3.0));
    }
}
