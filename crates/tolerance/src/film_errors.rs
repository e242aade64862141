//! The errors of decoupling and displacement of a film.

use std::error::Error;
use std::fmt;

use glam::DVec3;
use magsplice_decouple::{Decoupling, DecouplingError, PerParameter};
use magsplice_field::Scene;
use magsplice_ideal::IdealFilm;
use magsplice_magnet::{Grid, PointErrors, Quantity, Tile, TileFaults};

/// Where a film is used: the points of its working volume, and the reference point from which
/// displacements count.
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
    /// RMSE of the displacement along x, y, z that the parameters give (Dai 2024, Eq. 14), in the
    /// unit of lengths: [`Decoupling::ideal_rmse`] over the wavenumber.
    pub displacement_rmse: [f64; 3],
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
}

impl FilmErrors {
    /// Evaluates the exact field of tiles over a working volume.
    ///
    /// # Errors
    /// If the field or a decoupling parameter does not exist at a point of the volume.
    pub fn from_tiles(tiles: &[Tile], volume: &EvaluationGrid, ideal: &IdealFilm) -> Result<FilmErrors, SampleError> {
        let mut points: Vec<DVec3> = volume.grid.points().collect();
        points.push(volume.reference);
        let mut field_t = vec![DVec3::ZERO; points.len()];
        Scene::new(tiles).field_into(Quantity::FluxDensity, &points, &mut field_t).map_err(SampleError::Field)?;
        let (at_reference_t, field_t) = field_t.split_last().expect("at least the reference");
        let decoupling = Decoupling::from_field(&volume.grid, field_t, (volume.reference, *at_reference_t), ideal)
            .map_err(SampleError::Decoupling)?;
        if !decoupling.singular.is_empty() {
            return Err(SampleError::Singular { points: decoupling.singular });
        }
        Ok(FilmErrors {
            uniformity_rmse: decoupling.uniformity_rmse,
            displacement_rmse: decoupling.ideal_rmse.as_lengths(ideal.wavenumber()).to_array(),
        })
    }
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
        }
    }
}

impl Error for SampleError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            SampleError::Tile(faults) => Some(faults),
            SampleError::Field(errors) => Some(errors),
            SampleError::Decoupling(error) => Some(error),
            SampleError::Singular { .. } => None,
        }
    }
}
