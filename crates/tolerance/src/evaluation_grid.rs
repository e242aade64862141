//! The figures of a film over its working volume, and reasons why a sample has none.

use glam::DVec3;
use magsplice_decouple::{Decoupling, DecouplingError, Figures};
use magsplice_ideal::IdealFilm;
use magsplice_magnet::{Grid, PointErrors, TileFaults};
use thiserror::Error;

/// The points of the working volume of a film, and the reference point from which displacements
/// count. Lengths in millimetres.
#[derive(Clone, Copy, Debug)]
pub struct EvaluationGrid {
    /// Points over which errors are averaged.
    pub grid: Grid,
    /// A point near the axis of the film.
    pub reference: DVec3,
}

impl EvaluationGrid {
    /// The figures of the field on the grid, z fastest, and at the reference point.
    ///
    /// # Errors
    /// If a decoupling parameter does not exist at a point of the volume.
    pub fn figures(&self, field_t: &[DVec3], at_reference_t: DVec3, ideal: &IdealFilm) -> Result<Figures, SampleError> {
        self.figures_against(field_t, at_reference_t, ideal, &self.ideal_field_t(ideal, &[(DVec3::ZERO, DVec3::ONE)])?)
    }

    /// The weighted sum of the ideal field at each point, of sensors with these places and weights.
    pub(crate) fn ideal_field_t(
        &self,
        ideal: &IdealFilm,
        sensors: &[(DVec3, DVec3)],
    ) -> Result<Vec<DVec3>, SampleError> {
        let below = |point: DVec3| ideal.flux_density_t(point).ok_or(SampleError::NotBelow { point });
        let seen = |point: DVec3| {
            sensors.iter().try_fold(DVec3::ZERO, |sum, (place, weight)| Ok(sum + *weight * below(point + *place)?))
        };
        self.grid.points().map(seen).collect()
    }

    /// The figures of readings whose amplitude is that against these readings of the ideal film.
    pub(crate) fn figures_against(
        &self,
        field_t: &[DVec3],
        at_reference_t: DVec3,
        ideal: &IdealFilm,
        ideal_t: &[DVec3],
    ) -> Result<Figures, SampleError> {
        let decoupling = Decoupling::from_field(&self.grid, field_t, (self.reference, at_reference_t), ideal)
            .map_err(SampleError::Decoupling)?;
        if !decoupling.singular.is_empty() {
            return Err(SampleError::Singular { points: decoupling.singular });
        }
        let (mut product, mut square) = (0.0, 0.0);
        for (ideal_t, b_t) in ideal_t.iter().zip(field_t) {
            product += ideal_t.dot(*b_t);
            square += ideal_t.length_squared();
        }
        Ok(Figures::new(&decoupling, product / square))
    }
}

/// The reason why the errors of a sample cannot be computed.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SampleError {
    /// A tile cannot exist, such as one without thickness.
    #[error("a tile with these errors is invalid: {0}; specify smaller errors")]
    Tile(#[source] TileFaults),
    /// The field does not exist at a point of the volume, such as one on an edge of a tile.
    #[error("no field in the working volume: {0}")]
    Field(#[source] PointErrors),
    /// The decoupling parameters cannot be evaluated.
    #[error("{0}")]
    Decoupling(#[source] DecouplingError),
    /// B_z vanishes at points of the volume, so that the parameters do not exist there.
    #[error("B_z vanishes at {} points of the working volume, where no decoupling parameter exists", points.len())]
    Singular {
        /// These points.
        points: Vec<DVec3>,
    },
    /// A point of the volume is not below the film, where the field of the ideal film is known.
    #[error(
        "the point ({}, {}, {}) mm of the working volume is not below the film, and Eq. 2 of the ideal film holds \
         only for z < 0", point.x, point.y, point.z
    )]
    NotBelow {
        /// The point.
        point: DVec3,
    },
    /// The film of a sample reaches into the iron near it.
    #[error(
        "the film reaches {depth_mm:.3} mm into the iron of [tolerance.iron]; specify a larger distance_mm or smaller errors"
    )]
    InIron {
        /// How far it reaches.
        depth_mm: f64,
    },
    /// The derivatives of the field of a tile do not exist at a point of the volume.
    #[error(
        "the field of tile {tile} has no derivatives at the point ({}, {}, {}) mm of the working volume",
        point.x, point.y, point.z
    )]
    NoDerivative {
        /// Index of the tile.
        tile: usize,
        /// The point.
        point: DVec3,
    },
    /// The derivatives by all errors at all points need too much memory.
    #[error(
        "the derivatives by all errors at all points need {}; take fewer points",
        bytes.map_or("more bytes than can be counted".to_owned(), |bytes| format!("{bytes} bytes"))
    )]
    TooLarge {
        /// Their size in bytes; `None` if it exceeds the range of `usize`.
        bytes: Option<usize>,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The amplitude is the factor of the ideal field with the least squares, here with a uniform
    /// field besides. The ideal film itself has no errors.
    #[test]
    fn amplitude_is_the_fitted_factor_of_the_ideal_field() {
        let ideal = IdealFilm::new(10.0, 1.0, 0.12).unwrap();
        let grid = Grid::new(DVec3::new(-1.5, -1.0, -5.0), DVec3::new(1.0, 1.5, -3.0), [3, 4, 2]).unwrap();
        let volume = EvaluationGrid { grid, reference: DVec3::new(0.0, 0.0, -4.5) };
        let ideal_t: Vec<DVec3> = grid.points().map(|point| ideal.flux_density_t(point).unwrap()).collect();
        let at_reference_t = ideal.flux_density_t(volume.reference).unwrap();
        let scaled: Vec<DVec3> = ideal_t.iter().map(|b_t| 0.9 * *b_t).collect();
        let found = volume.figures(&scaled, 0.9 * at_reference_t, &ideal).unwrap();
        assert!((found.amplitude - 0.9).abs() < 1e-15, "{found:?}");
        assert!(found.displacement_rmse_mm.to_array().iter().all(|error| *error < 1e-12), "{found:?}");

        let other_t = DVec3::new(1e-3, 2e-3, -3e-3);
        let with: Vec<DVec3> = scaled.iter().map(|b_t| *b_t + other_t).collect();
        let squares = |amplitude: f64| -> f64 {
            with.iter().zip(&ideal_t).map(|(b_t, ideal_t)| (*b_t - amplitude * *ideal_t).length_squared()).sum()
        };
        let amplitude = volume.figures(&with, 0.9 * at_reference_t, &ideal).unwrap().amplitude;
        assert!(squares(amplitude) < squares(amplitude - 1e-4).min(squares(amplitude + 1e-4)));
        assert!(squares(amplitude) < squares(0.9));
    }

    #[test]
    fn fields_without_parameters_are_errors() {
        let ideal = IdealFilm::new(10.0, 1.0, 0.12).unwrap();
        let at = |z: f64| {
            let (lower, upper) = (DVec3::new(-0.5, 0.0, z), DVec3::new(0.5, 0.0, z));
            EvaluationGrid { grid: Grid::new(lower, upper, [2, 1, 1]).unwrap(), reference: DVec3::new(0.0, 0.0, -4.5) }
        };
        let found = at(-4.0).figures(&[DVec3::Z, DVec3::X], DVec3::Z, &ideal);
        assert_eq!(found, Err(SampleError::Singular { points: vec![DVec3::new(0.5, 0.0, -4.0)] }));
        assert!(at(-4.0).figures(&[DVec3::Z; 2], DVec3::X, &ideal).is_err());
        assert!(at(4.0).figures(&[DVec3::Z; 2], DVec3::Z, &ideal).is_err());
        let bytes = |bytes| SampleError::TooLarge { bytes }.to_string();
        assert!(bytes(Some(12)).contains("need 12 bytes;") && bytes(None).contains("need more bytes than"));
    }
}
