//! How good a film is.

use glam::DVec3;
use magsplice_decouple::{Decoupling, PerParameter};
use magsplice_field::{Comparison, Grid, IdealFilm, Quantity, Scene, Tile};

use crate::error::DesignError;

/// What a film reaches over its working volume, evaluated exactly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figures {
    /// Deviations of the parameters over planes where they should be constant.
    pub uniformity_rmse: PerParameter,
    /// Errors of the parameters' changes against the ideal film; over k they are errors of displacement.
    pub ideal_rmse: PerParameter,
    /// Best fit against the ideal film.
    pub amplitude: f64,
    /// RMSE of B against the ideal film times that amplitude, relative.
    pub scaled_relative_rmse: Option<f64>,
    /// On how many points.
    pub points: usize,
}

impl Figures {
    /// Of tiles over a grid, by their exact field.
    ///
    /// # Errors
    /// If there is no field or are no parameters.
    pub fn of(tiles: &[Tile], grid: &Grid, reference: DVec3, ideal: &IdealFilm) -> Result<Figures, DesignError> {
        let points: Vec<DVec3> = grid.points().collect();
        let of_ideal = |p: &DVec3| ideal.flux_density_t(*p).ok_or(DesignError::NotBelow(*p));
        let ideal_field = points.iter().map(of_ideal).collect::<Result<Vec<DVec3>, _>>()?;
        let scene = Scene::new(tiles);
        let mut field = vec![DVec3::ZERO; points.len()];
        scene.field_into(Quantity::FluxDensity, &points, &mut field).map_err(|_| DesignError::NoField)?;
        let at_reference = scene.field(Quantity::FluxDensity, reference).map_err(|_| DesignError::NoField)?;
        let decoupling =
            Decoupling::of(grid, &field, (reference, at_reference), ideal).map_err(DesignError::Decoupling)?;
        if !decoupling.singular.is_empty() {
            return Err(DesignError::Singular);
        }
        let comparison = Comparison::new(&points, &field, &ideal_field).map_err(|_| DesignError::Singular)?;
        Ok(Figures {
            uniformity_rmse: decoupling.uniformity_rmse,
            ideal_rmse: decoupling.ideal_rmse,
            amplitude: comparison.amplitude,
            scaled_relative_rmse: comparison.scaled_relative_rmse,
            points: points.len(),
        })
    }
}
