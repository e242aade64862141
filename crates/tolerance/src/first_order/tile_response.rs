//! The derivatives of the field of one tile by its errors.

use glam::{DMat3, DVec3};
use magsplice_field::{FaceDerivatives, PolarizationMap, PolarizationMapError};
use magsplice_magnet::{Reflection, Tile, TileError};
use rayon::prelude::*;

use crate::evaluation_grid::SampleError;
use crate::real_film::{RealFilm, direction_axes};

/// Points below which a task is not divided: a point takes about a microsecond.
const POINTS_PER_TASK: usize = 64;

/// How the field of one tile changes at each of several points, in the frame of the scene: the
/// exact derivatives of B by every error of the tile, which its images in flat iron follow.
///
/// # Units
/// Lengths in millimetres, flux densities in tesla, angles in radians; strengths are fractions.
#[derive(Clone, Debug)]
pub struct TileResponse {
    tile: Tile,
    /// The changes at the place of each point by each reflection; the first are at the points.
    at_places: Vec<(Reflection, Vec<AtPoint>)>,
}

/// The changes at one place.
#[derive(Clone, Copy, Debug)]
struct AtPoint {
    point: DVec3,
    /// B of the tile.
    field_t: DVec3,
    /// Derivatives of B by the position of the tile; minus the gradient of B.
    by_position: DMat3,
    /// Derivatives of B by the sides of the tile.
    by_size: DMat3,
    /// Derivatives of B by J in the frame of the tile.
    by_polarization: DMat3,
}

impl TileResponse {
    /// The response of tile number `number`.
    ///
    /// # Errors
    /// If the field or its derivatives do not exist at a point, such as one on an edge of the tile.
    pub fn new(number: usize, tile: &Tile, points: &[DVec3]) -> Result<TileResponse, SampleError> {
        TileResponse::with_images(number, tile, points, &[])
    }

    /// The response of a tile at the place of tile number `number` of a film, with its images in
    /// the iron that moves with the film.
    ///
    /// # Errors
    /// As [`TileResponse::new`].
    pub fn in_film(film: &RealFilm, number: usize, tile: &Tile, points: &[DVec3]) -> Result<TileResponse, SampleError> {
        TileResponse::with_images(number, tile, points, &film.reflections())
    }

    /// The response of tile number `number` with its images by reflections.
    fn with_images(
        number: usize,
        tile: &Tile,
        points: &[DVec3],
        reflections: &[Reflection],
    ) -> Result<TileResponse, SampleError> {
        let of = |reflection: &Reflection| {
            let places: Vec<DVec3> = points.iter().map(|point| reflection.place(*point)).collect();
            Ok((*reflection, TileResponse::at_places(number, tile, &places)?))
        };
        let at_places = std::iter::once(&Reflection::NONE).chain(reflections).map(of).collect::<Result<_, _>>()?;
        Ok(TileResponse { tile: *tile, at_places })
    }

    /// The changes of the field of the tile alone.
    fn at_places(number: usize, tile: &Tile, points: &[DVec3]) -> Result<Vec<AtPoint>, SampleError> {
        let map = PolarizationMap::new(&[*tile], points).map_err(|error| match error {
            PolarizationMapError::Points { errors, .. } => SampleError::Field(errors),
            PolarizationMapError::TooLarge { bytes } => SampleError::TooLarge { bytes },
            // A new kind of error, of which only the tile is known.
            _ => SampleError::NoDerivative { tile: number, point: tile.position() },
        })?;
        let to_tile = DMat3::from_quat(tile.rotation().inverse());
        let at_point = |(index, point): (usize, &DVec3)| {
            let faces =
                FaceDerivatives::new(tile, *point).ok_or(SampleError::NoDerivative { tile: number, point: *point })?;
            let row = |component| DVec3::from_slice(map.row(index, component));
            let by_polarization = DMat3::from_cols(row(0), row(1), row(2)).transpose();
            Ok(AtPoint {
                point: *point,
                field_t: by_polarization * tile.polarization_t(),
                by_position: (faces.lower + faces.upper) * to_tile,
                by_size: (faces.upper - faces.lower) * 0.5,
                by_polarization,
            })
        };
        let at_points = points.par_iter().enumerate().with_min_len(POINTS_PER_TASK).map(at_point);
        at_points.collect()
    }

    /// Adds a change at each point, from that of the field of the tile alone at each place.
    fn add(&self, change_at: impl Fn(&AtPoint) -> DVec3, sum: &mut [DVec3]) {
        for (reflection, at_points) in &self.at_places {
            sum.iter_mut().zip(at_points).for_each(|(sum, at)| *sum += reflection.field(change_at(at)));
        }
    }

    /// Adds the change of B at each point by a change of J in the frame of the tile.
    pub(crate) fn add_polarization_change(&self, change_t: DVec3, sum: &mut [DVec3]) {
        self.add(|at| at.by_polarization * change_t, sum);
    }

    /// Adds the derivative of B at each point by one error of the tile. Turns are about a point.
    pub fn add_derivative(&self, error: TileError, about: DVec3, sum: &mut [DVec3]) {
        let j_t = self.tile.polarization_t();
        // An axis by which J is turned changes it by their product.
        let turned_t = match error {
            TileError::Direction(turn) => {
                direction_axes(&self.tile).map_or(DVec3::ZERO, |axes| axes[turn as usize].cross(j_t))
            }
            _ => DVec3::ZERO,
        };
        let derivative = |at: &AtPoint| match error {
            TileError::Position(axis) => at.by_position.col(axis.index()),
            TileError::Rotation(axis) => {
                let turn = axis.unit();
                turn.cross(at.field_t) + at.by_position * turn.cross(at.point - about)
            }
            TileError::Size(axis) => at.by_size.col(axis.index()),
            TileError::Strength => at.field_t,
            TileError::Direction(_) => at.by_polarization * turned_t,
        };
        self.add(derivative, sum);
    }
}
