//! Metrics of a film: how well it decouples over a grid.

use glam::DVec3;
use magsplice_decouple::{Decoupling, Figures, PerParameter};
use magsplice_field::Scene;
use magsplice_head::SensorHead;
use magsplice_ideal::{Comparison, IdealFilm};
use magsplice_magnet::{Grid, IronPlanes, Quantity, Tile};

use crate::error::DesignError;
use crate::problem::objective::ideal_field_t;
use crate::problem::reading::Reading;

/// Errors of a film over a grid, from its exact field.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Metrics {
    /// Number of points of the grid.
    pub points: usize,
    /// The figures of the film.
    #[serde(flatten)]
    pub figures: Figures,
    /// RMSE of each parameter's change from the reference point against the ideal film; see
    /// [`Decoupling::ideal_rmse`].
    pub ideal_rmse: PerParameter,
    /// RMSE of B against the ideal film times the amplitude, relative to the latter. `None` if the
    /// amplitude is zero.
    pub scaled_relative_rmse: Option<f64>,
}

impl Metrics {
    /// Evaluates tiles before flat iron over a grid, as a head or a single sensor reads them.
    /// Lengths in millimetres. Parameters change from those at `reference`, which lies near the
    /// axis of the film.
    ///
    /// # Errors
    /// * [`DesignError::NotBelow`] if a point of the grid is not below the film;
    /// * [`DesignError::InIron`] if a tile reaches into the iron;
    /// * [`DesignError::NoField`] if a point lies on an edge of a tile;
    /// * [`DesignError::Decoupling`] or [`DesignError::Singular`] if decoupling parameters do not
    ///   exist;
    /// * [`DesignError::Comparison`] if the field cannot be compared with the ideal one.
    pub fn from_tiles(
        tiles: &[Tile],
        iron: &IronPlanes,
        head: Option<&SensorHead>,
        grid: &Grid,
        reference: DVec3,
        ideal: &IdealFilm,
    ) -> Result<Metrics, DesignError> {
        let points: Vec<DVec3> = grid.points().collect();
        let ideal_field = ideal_field_t(ideal, head, &points)?;
        let scene = Scene::new(tiles).with_planes(iron).map_err(DesignError::InIron)?;
        let reading = Reading::new(head);
        let at_places = scene.field_at(Quantity::FluxDensity, &reading.places(&points));
        let at_places = at_places.map_err(|_| DesignError::NoField)?;
        let of_point = |values: &[DVec3]| reading.sum(values.iter().copied());
        let field: Vec<DVec3> = at_places.chunks_exact(reading.sensors().len()).map(of_point).collect();
        let of_place = |place: DVec3| scene.field(Quantity::FluxDensity, place).map_err(|_| DesignError::NoField);
        let at_reference = reading.places(&[reference]).into_iter().map(of_place).collect::<Result<Vec<_>, _>>()?;
        let at_reference = of_point(&at_reference);
        let decoupling =
            Decoupling::from_field(grid, &field, (reference, at_reference), ideal).map_err(DesignError::Decoupling)?;
        if !decoupling.singular.is_empty() {
            return Err(DesignError::Singular);
        }
        let comparison = Comparison::new(&points, &field, &ideal_field).map_err(DesignError::Comparison)?;
        Ok(Metrics {
            points: points.len(),
            figures: Figures::new(&decoupling, comparison.amplitude),
            ideal_rmse: decoupling.ideal_rmse,
            scaled_relative_rmse: comparison.scaled_relative_rmse,
        })
    }
}
