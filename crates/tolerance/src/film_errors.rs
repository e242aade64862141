//! The errors of decoupling and displacement of a film.

use std::error::Error;
use std::fmt;

use glam::DVec3;
use magsplice_decouple::{Decoupling, DecouplingError, PerParameter};
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

/// The errors of one film over its working volume.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FilmErrors {
    /// See [`Decoupling::uniformity_rmse`].
    pub uniformity_rmse: PerParameter,
    /// RMSE of the displacement along x, y, z that the parameters give (Dai 2024, Eq. 14), in
    /// millimetres: [`Decoupling::ideal_rmse`] over the wavenumber.
    pub displacement_rmse_mm: [f64; 3],
    /// The factor that brings the field of the ideal film closest to that of the film.
    pub amplitude: f64,
}

/// A figure of a film: one number of its [`FilmErrors`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Figure {
    /// Uniformity RMSE of R_x, R_y or S_z, by axis.
    Uniformity(usize),
    /// Displacement RMSE along an axis, in millimetres.
    Displacement(usize),
    /// Amplitude.
    Amplitude,
}

impl Figure {
    /// All figures.
    pub const ALL: [Figure; 7] = [
        Figure::Uniformity(0),
        Figure::Uniformity(1),
        Figure::Uniformity(2),
        Figure::Displacement(0),
        Figure::Displacement(1),
        Figure::Displacement(2),
        Figure::Amplitude,
    ];
}

impl FilmErrors {
    /// The errors of a field that the sensor reads on the grid, z fastest, and at the reference
    /// point.
    ///
    /// # Errors
    /// If a decoupling parameter does not exist at a point of the volume.
    pub fn from_field(
        field_t: &[DVec3],
        at_reference_t: DVec3,
        volume: &EvaluationGrid,
        ideal: &IdealFilm,
    ) -> Result<FilmErrors, SampleError> {
        let decoupling = Decoupling::from_field(&volume.grid, field_t, (volume.reference, at_reference_t), ideal)
            .map_err(SampleError::Decoupling)?;
        if !decoupling.singular.is_empty() {
            return Err(SampleError::Singular { points: decoupling.singular });
        }
        let (mut product, mut square) = (0.0, 0.0);
        for (point, b_t) in volume.grid.points().zip(field_t) {
            let ideal_t = ideal.flux_density_t(point).ok_or(SampleError::NotBelow { point })?;
            product += ideal_t.dot(*b_t);
            square += ideal_t.length_squared();
        }
        Ok(FilmErrors {
            uniformity_rmse: decoupling.uniformity_rmse,
            displacement_rmse_mm: decoupling.ideal_rmse.as_lengths(ideal.wavenumber()).to_array(),
            amplitude: product / square,
        })
    }

    /// One of its numbers.
    ///
    /// # Panics
    /// If the figure has an axis that is not 0, 1 or 2.
    pub fn get(&self, figure: Figure) -> f64 {
        let PerParameter { r_x, r_y, s_z } = self.uniformity_rmse;
        match figure {
            Figure::Uniformity(axis) => [r_x, r_y, s_z][axis],
            Figure::Displacement(axis) => self.displacement_rmse_mm[axis],
            Figure::Amplitude => self.amplitude,
        }
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
