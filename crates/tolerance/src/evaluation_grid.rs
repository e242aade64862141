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
    /// The figures of readings on the grid, z fastest, and at the reference point.
    ///
    /// # Errors
    /// If a decoupling parameter does not exist at a point of the volume.
    pub fn figures(&self, field_t: &[DVec3], at_reference_t: DVec3, ideal: &IdealFilm) -> Result<Figures, SampleError> {
        let decoupling = Decoupling::from_field(&self.grid, field_t, (self.reference, at_reference_t), ideal)
            .map_err(SampleError::Decoupling)?;
        if !decoupling.singular.is_empty() {
            return Err(SampleError::Singular { points: decoupling.singular });
        }
        let (mut product, mut square) = (0.0, 0.0);
        for (point, b_t) in self.grid.points().zip(field_t) {
            let ideal_t = ideal.flux_density_t(point).ok_or(SampleError::NotBelow { point })?;
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
