//! Flat iron near the film: the reading of its images.

use glam::DVec3;
use magsplice_layout::NearIron;
use magsplice_magnet::{Grid, Tile};
use magsplice_tolerance::nodes;

use crate::error::DesignError;
use crate::problem::pattern::Pattern;
use crate::problem::sampling::Sampling;
use crate::problem::symmetry::SymmetryOperation;

/// Component of the normal along x or y from which on iron is not parallel to the film. Normals
/// from angles have round-off.
pub(crate) const TILTED: f64 = 1e-12;

/// Iron above or below the film, whose images have the field of the film at mirrored points.
#[derive(Clone, Debug)]
pub(crate) struct IronImages {
    /// The mirrored points of the grid, then the mirrored reference point.
    sampling: Sampling,
    /// The field of the images over that of the film at the mirrored point, times the root of the
    /// weight of the distance.
    factor: DVec3,
    /// Whether the iron comes after the reading at the reference point.
    pub(crate) later: bool,
}

/// The reading of the images at a point, with its derivatives by all variables.
pub(crate) struct ImageField {
    pub(crate) value: DVec3,
    pub(crate) derivatives: Vec<DVec3>,
}

impl IronImages {
    /// The images of a film of these tiles, whose heights do not change, in iron at several
    /// distances, each times the root of its weight: the sum of their squares is the mean square
    /// over the errors of the distance.
    ///
    /// # Errors
    /// If the iron is not parallel to the film.
    pub(crate) fn all(iron: &NearIron, tiles: &[Tile], sampling: &Sampling) -> Result<Vec<IronImages>, DesignError> {
        let at = |(error_mm, weight): (f64, f64)| IronImages::new(iron, error_mm, weight.sqrt(), tiles, sampling);
        nodes(&iron.distance_error_mm).into_iter().map(at).collect()
    }

    fn new(
        iron: &NearIron,
        error_mm: f64,
        root_of_weight: f64,
        tiles: &[Tile],
        sampling: &Sampling,
    ) -> Result<IronImages, DesignError> {
        let plane = iron.plane(tiles, error_mm).map_err(|_| DesignError::NearIron)?;
        let normal = plane.normal();
        if iron.distance_mm + error_mm < 0.0 || normal.x.abs().max(normal.y.abs()) > TILTED {
            return Err(DesignError::NearIron);
        }
        let is_before = |place: &DVec3| plane.distance(*place) > 0.0;
        if !sampling.places().iter().all(is_before) {
            return Err(DesignError::NearIron);
        }
        let [one, other] = [sampling.grid.lower(), sampling.grid.upper()].map(|point| plane.mirrored(point));
        let grid =
            Grid::new(one.min(other), one.max(other), sampling.grid.counts()).map_err(|_| DesignError::NearIron)?;
        let reference = plane.mirrored(sampling.reference);
        Ok(IronImages {
            sampling: Sampling::new(grid, reference, sampling.symmetry, sampling.reading.upside_down(), &[]),
            factor: -root_of_weight * plane.image_factor() * DVec3::new(1.0, 1.0, -1.0),
            later: iron.later,
        })
    }

    /// The reading of the images at these points of the grid, then at the reference point. `None`
    /// where a mirrored place lies on an edge of a tile.
    pub(crate) fn read(
        &self,
        pattern: &Pattern,
        variables: &[f64],
        points: &[usize],
        with_derivatives: bool,
    ) -> Option<Vec<ImageField>> {
        let field = self.sampling.field(pattern, variables, with_derivatives)?;
        let last = self.sampling.computed().len() - 1;
        let planes = self.sampling.grid.counts()[2];
        let mirrored = |point: usize| {
            let [_, _, plane] = self.sampling.grid.indices(point);
            self.sampling.images()[point - plane + (planes - 1 - plane)]
        };
        let all = points.iter().map(|point| mirrored(*point)).chain([(last, SymmetryOperation::IDENTITY)]);
        let seen = |(index, operation): (usize, SymmetryOperation)| ImageField {
            value: self.factor * operation.apply(field.flux_density_t[index]),
            derivatives: field.derivatives_at(index).iter().map(|by| self.factor * operation.apply(*by)).collect(),
        };
        Some(all.map(seen).collect())
    }
}
