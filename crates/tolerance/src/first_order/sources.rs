//! The errors of a film as one list, with their means, variances and values in samples.

use glam::DVec3;
use magsplice_layout::Distribution;
use magsplice_magnet::{Axis, PerTileError, TileError};

use crate::draws::Draws;
use crate::quantile::{mean, variance};
use crate::real_film::RealFilm;

/// One error of a film, a number. Axes are 0, 1, 2 for x, y, z.
///
/// # Units
/// Lengths in millimetres, angles in radians, flux densities in tesla; strengths, gains and the
/// change by temperature are fractions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum ErrorSource {
    /// An error of one tile.
    Tile {
        /// Index of the tile.
        tile: usize,
        /// The error.
        error: TileError,
    },
    /// An error of a group of tiles.
    Group {
        /// Index of the group.
        group: usize,
        /// The error.
        error: TileError,
    },
    /// Position of the film along an axis.
    FilmPosition(usize),
    /// Component of the rotation vector of the film.
    FilmRotation(usize),
    /// Component of the stray field.
    StrayField(usize),
    /// Relative change of the strength of all tiles after the reading at the reference point.
    Temperature,
    /// Distance of iron near the film.
    IronDistance,
    /// An error of the sensor, or of one sensor of a head.
    Sensor {
        /// Index of the sensor.
        sensor: usize,
        /// The error.
        error: SensorError,
    },
    /// Noise of the reading at the reference point along an axis; of a head, of the weighted sum.
    ReferenceNoise(usize),
}

/// An error of one sensor. Axes are 0, 1, 2 for x, y, z.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SensorError {
    /// Offset along an axis.
    Offset(usize),
    /// Component of the rotation vector.
    Rotation(usize),
    /// Error of the gain along an axis.
    Gain(usize),
    /// Displacement along an axis.
    Position(usize),
}

impl SensorError {
    /// All errors, in the order of [`Surroundings::values`](crate::readings::Surroundings::values).
    fn all() -> impl Iterator<Item = SensorError> {
        let kinds = [SensorError::Offset, SensorError::Rotation, SensorError::Gain, SensorError::Position];
        kinds.into_iter().flat_map(|kind| [0, 1, 2].map(kind))
    }
}

/// The cause of errors: one number of a tolerance, for all its tiles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Cause {
    /// Positions of tiles along x and y.
    PositionInPlane,
    /// Positions of tiles along z.
    PositionZ,
    /// Rotations of tiles.
    Rotation,
    /// Sizes of tiles.
    Size,
    /// Strengths of tiles.
    Strength,
    /// Directions in which tiles are magnetized.
    Direction,
    /// All errors of a group, by its index.
    Group(usize),
    /// Pose of the film against the sensor.
    FilmPose,
    /// Uniform stray field.
    StrayField,
    /// The neighbouring film.
    Neighbour,
    /// Change of temperature.
    Temperature,
    /// Iron near the film.
    Iron,
    /// Offset of the sensor.
    SensorOffset,
    /// Rotation of the sensor.
    SensorRotation,
    /// Gain of the sensor.
    SensorGain,
    /// Place of the sensor.
    SensorPosition,
    /// Noise of all readings.
    SensorNoise,
}

impl From<TileError> for Cause {
    /// The cause of an error of single tiles.
    fn from(error: TileError) -> Cause {
        match error {
            TileError::Position(Axis::X | Axis::Y) => Cause::PositionInPlane,
            TileError::Position(Axis::Z) => Cause::PositionZ,
            TileError::Rotation(_) => Cause::Rotation,
            TileError::Size(_) => Cause::Size,
            TileError::Strength => Cause::Strength,
            TileError::Direction(_) => Cause::Direction,
        }
    }
}

impl ErrorSource {
    /// The cause of the error.
    pub fn cause(self) -> Cause {
        match self {
            ErrorSource::Tile { error, .. } => Cause::from(error),
            ErrorSource::Group { group, .. } => Cause::Group(group),
            ErrorSource::FilmPosition(_) | ErrorSource::FilmRotation(_) => Cause::FilmPose,
            ErrorSource::StrayField(_) => Cause::StrayField,
            ErrorSource::Temperature => Cause::Temperature,
            ErrorSource::IronDistance => Cause::Iron,
            ErrorSource::Sensor { error: SensorError::Offset(_), .. } => Cause::SensorOffset,
            ErrorSource::Sensor { error: SensorError::Rotation(_), .. } => Cause::SensorRotation,
            ErrorSource::Sensor { error: SensorError::Gain(_), .. } => Cause::SensorGain,
            ErrorSource::Sensor { error: SensorError::Position(_), .. } => Cause::SensorPosition,
            ErrorSource::ReferenceNoise(_) => Cause::SensorNoise,
        }
    }

    /// The errors that all tiles share, in the order of
    /// [`Surroundings::values`](crate::readings::Surroundings::values), with those of each of
    /// several sensors.
    pub(crate) fn common(sensors: usize) -> impl Iterator<Item = ErrorSource> {
        let kinds = [ErrorSource::FilmPosition, ErrorSource::FilmRotation, ErrorSource::StrayField];
        let of_film = kinds
            .into_iter()
            .flat_map(|kind| [0, 1, 2].map(kind))
            .chain([ErrorSource::Temperature, ErrorSource::IronDistance]);
        let of_sensor = |sensor: usize| SensorError::all().map(move |error| ErrorSource::Sensor { sensor, error });
        of_film.chain((0..sensors).flat_map(of_sensor))
    }
}

/// Mean and variance of an error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Moments {
    pub(crate) mean: f64,
    pub(crate) variance: f64,
}

impl Moments {
    pub(crate) fn new(distribution: &Distribution) -> Moments {
        Moments { mean: mean(distribution), variance: variance(distribution) }
    }

    fn scaled(self, factor: f64) -> Moments {
        Moments { mean: factor * self.mean, variance: factor * factor * self.variance }
    }
}

/// All errors of a film with their moments: of each tile, of each group, in common, and the noise
/// of the reading at the reference point.
pub(crate) fn sources(film: &RealFilm) -> Vec<(ErrorSource, Moments)> {
    let tolerance = film.tolerance();
    let mut all = Vec::new();
    for tile in 0..film.tiles().len() {
        for error in TileError::ALL {
            let of_tile = tolerance.tiles.get(tile).map(|errors| Moments::new(&errors[error]));
            all.push((ErrorSource::Tile { tile, error }, of_tile.unwrap_or_default()));
        }
    }
    for (group, errors) in tolerance.groups.iter().enumerate() {
        let of_group = errors.errors.iter();
        all.extend(of_group.map(|(error, errors)| (ErrorSource::Group { group, error }, Moments::new(errors))));
    }
    let common = &tolerance.common;
    let stray_field = |axis: usize| {
        let Some(field) = &common.stray_field else { return Moments::default() };
        let along = Moments::new(&field.field_t[axis]);
        // A vector of any direction has a third of its square along each axis, and no correlations.
        let any = Moments::new(&field.any_direction_t);
        Moments { variance: along.variance + (any.variance + any.mean * any.mean) / 3.0, ..along }
    };
    let chips = film.chips();
    all.extend(ErrorSource::common(chips.len()).map(|source| {
        let moments = match source {
            ErrorSource::FilmPosition(axis) => Moments::new(&common.film.position_mm[axis]),
            ErrorSource::FilmRotation(axis) => Moments::new(&common.film.rotation_rad[axis]),
            ErrorSource::StrayField(axis) => stray_field(axis),
            ErrorSource::Sensor { error, .. } => Moments::new(match error {
                SensorError::Offset(axis) => &common.sensor.offset_t[axis],
                SensorError::Rotation(axis) => &common.sensor.rotation_rad[axis],
                SensorError::Gain(axis) => &common.sensor.gain[axis],
                SensorError::Position(axis) => &common.sensor.position_mm[axis],
            }),
            ErrorSource::IronDistance => {
                common.iron.as_ref().map_or(Moments::default(), |iron| Moments::new(&iron.distance_error_mm))
            }
            // The temperature; the others are not common.
            _ => common.temperature.as_ref().map_or(Moments::default(), |temperature| {
                Moments::new(&temperature.change_k).scaled(temperature.strength_per_k)
            }),
        };
        (source, moments)
    }));
    let noise = noise_moments(film);
    all.extend([0, 1, 2].map(|axis| (ErrorSource::ReferenceNoise(axis), noise[axis])));
    all
}

/// Moments of the noise of a reading along each axis: of a head, of the weighted sum.
pub(crate) fn noise_moments(film: &RealFilm) -> [Moments; 3] {
    let weights = || film.chips().into_iter().map(|(_, weight)| weight);
    let (sum, squares): (DVec3, DVec3) = (weights().sum(), weights().map(|weight| weight * weight).sum());
    [0, 1, 2].map(|axis| {
        let Moments { mean, variance } = Moments::new(&film.tolerance().common.sensor.noise_t[axis]);
        Moments { mean: sum[axis] * mean, variance: squares[axis] * variance }
    })
}

/// The values of all errors of [`sources`] in a sample. `reference` is the number of the reading at
/// the reference point.
pub(crate) fn drawn_values(film: &RealFilm, draws: &mut Draws, reference: usize) -> Vec<f64> {
    let errors = film.draw_errors(draws);
    let mut values: Vec<f64> = errors.iter().flatten().flat_map(PerTileError::values).copied().collect();
    values.extend(film.draw_surroundings(draws).values());
    values.extend(film.draw_noise_t(draws, reference).to_array());
    values
}
