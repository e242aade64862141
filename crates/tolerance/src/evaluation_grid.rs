//! The figures of a film over its working volume, and why a sample has none.

use std::error::Error;
use std::fmt;

use glam::DVec3;
use magsplice_decouple::{Decoupling, DecouplingError, Figures};
use magsplice_ideal::IdealFilm;
use magsplice_magnet::{Grid, PointErrors, TileFaults};

/// Where a film is used: the points of its working volume, and the reference point from which
/// displacements count. Lengths in millimetres.
#[derive(Clone, Copy, Debug)]
pub struct EvaluationGrid {
    /// Points over which errors are averaged.
    pub grid: Grid,
    /// A point near the axis of the film.
    pub reference: DVec3,
}

impl EvaluationGrid {
    /// The figures of a field that the sensor reads on the grid, z fastest, and at the reference
    /// point.
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

/// Why a sample of a film has no errors.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum SampleError {
    /// A tile cannot exist, such as one without thickness.
    Tile(TileFaults),
    /// The field does not exist at a point of the volume, such as one on an edge of a tile.
    Field(PointErrors),
    /// The decoupling parameters cannot be evaluated.
    Decoupling(DecouplingError),
    /// B_z vanishes at points of the volume, so that the parameters do not exist there.
    Singular {
        /// These points.
        points: Vec<DVec3>,
    },
    /// A point of the volume is not below the film, where the field of the ideal film is known.
    NotBelow {
        /// The point.
        point: DVec3,
    },
    /// The derivatives of the field of a tile do not exist at a point of the volume.
    NoDerivative {
        /// Index of the tile.
        tile: usize,
        /// The point.
        point: DVec3,
    },
    /// The derivatives by all errors at all points need too much memory.
    TooLarge {
        /// Their size in bytes; `None` if it exceeds the range of `usize`.
        bytes: Option<usize>,
    },
}

impl fmt::Display for SampleError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SampleError::Tile(faults) => write!(f, "a tile cannot exist: {faults}; smaller errors are needed"),
            SampleError::Field(errors) => write!(f, "no field in the working volume: {errors}"),
            SampleError::Decoupling(error) => error.fmt(f),
            SampleError::Singular { points } => write!(
                f,
                "B_z vanishes at {} points of the working volume, where no decoupling parameter exists",
                points.len()
            ),
            SampleError::NotBelow { point } => write!(
                f,
                "the point ({}, {}, {}) mm of the working volume is not below the film, and Eq. 2 of the ideal film \
                 holds only for z < 0",
                point.x, point.y, point.z
            ),
            SampleError::NoDerivative { tile, point } => write!(
                f,
                "the field of tile {tile} has no derivatives at the point ({}, {}, {}) mm of the working volume",
                point.x, point.y, point.z
            ),
            SampleError::TooLarge { bytes } => {
                let size = bytes.map_or("more bytes than can be counted".to_owned(), |bytes| format!("{bytes} bytes"));
                write!(f, "the derivatives by all errors at all points need {size}; take fewer points")
            }
        }
    }
}

impl Error for SampleError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            SampleError::Tile(faults) => Some(faults),
            SampleError::Field(errors) => Some(errors),
            SampleError::Decoupling(error) => Some(error),
            SampleError::Singular { .. }
            | SampleError::NotBelow { .. }
            | SampleError::NoDerivative { .. }
            | SampleError::TooLarge { .. } => None,
        }
    }
}
