//! The errors of manufactured films, as mean squares: of each tile, of tiles that move together,
//! and of the surroundings and the sensor.

use glam::{DMat3, DVec3};
use magsplice_field::Scene;
use magsplice_layout::{CommonErrors, Distribution, FilmTolerance, SensorErrors, TileErrors};
use magsplice_magnet::{PerTileError, Quantity, Tile};
use magsplice_tolerance::mean_square;

use crate::error::DesignError;
use crate::problem::near_iron::IronImages;
use crate::problem::objective::Objective;
use crate::problem::pattern::{Pattern, VariableTile};
use crate::problem::reading::{Reading, WeightedSensor};
use crate::problem::sampling::{SampledField, Sampling};
use crate::problem::symmetry::SymmetryOperation;

/// Mean squares of the errors of a tile.
pub(crate) type MeanSquares = PerTileError<f64>;

/// The errors of films. An error whose mean is not 0, such as a fixed one, counts with its mean
/// square, as if both signs were equally likely.
#[derive(Clone, Debug)]
pub(crate) struct ErrorModel {
    /// By tile of the layout.
    tiles: Vec<MeanSquares>,
    pub(crate) joint: Vec<JointErrors>,
    pub(crate) common: Vec<CommonError>,
    /// Rotations and gains of the sensors of a head.
    pub(crate) of_sensors: Vec<SensorChange>,
    /// Mean squares of the noise of each reading along x, y, z, in square tesla.
    pub(crate) noise: DVec3,
    /// Iron near the film, at several distances if its distance has errors.
    pub(crate) iron: Vec<IronImages>,
    /// Whether images of a tile have the same sensitivities, apart from the symmetry operation.
    pub(crate) symmetric: bool,
    /// Whether the errors of all sensors of a head together have the same effect at the images of a
    /// point.
    pub(crate) has_symmetric_sensors: bool,
}

/// Errors that several tiles share: a rigid motion, and equal changes of each of them.
#[derive(Clone, Debug)]
pub(crate) struct JointErrors {
    /// Indices of the tiles.
    pub(crate) tiles: Vec<usize>,
    pub(crate) mean_squares: MeanSquares,
    /// The point about which they turn.
    pub(crate) centre: Centre,
    /// The only sensor of a head below which they have the errors. `None` for all.
    pub(crate) sensor: Option<usize>,
}

/// The point about which tiles turn together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Centre {
    /// The mean of their centres.
    Mean,
    /// The centre of their bounding box.
    Box,
}

/// A change of the reading of one sensor of a head, of either sign: a linear function of the film's
/// field at its place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SensorChange {
    pub(crate) sensor: usize,
    pub(crate) by_field: DMat3,
}

/// A change of the field that the sensor reads, of either sign: a field, and a linear function of
/// the film's own field.
#[derive(Clone, Debug)]
pub(crate) struct CommonError {
    /// The field at the points of the grid and at the reference point, in tesla.
    field_t: Vec<DVec3>,
    pub(crate) by_field: DMat3,
    /// Whether the change comes after the reading at the reference point.
    later: bool,
}

impl CommonError {
    /// The change at a point of the grid where the film's own field is `b_t`.
    pub(crate) fn at(&self, point: usize, b_t: DVec3) -> DVec3 {
        self.field_t[point.min(self.field_t.len() - 1)] + self.by_field * b_t
    }

    /// The change at the reference point, and its derivative by the film's own field.
    pub(crate) fn at_reference(&self, b_t: DVec3) -> (DVec3, DMat3) {
        if self.later {
            return (DVec3::ZERO, DMat3::ZERO);
        }
        (self.at(usize::MAX, b_t), self.by_field)
    }
}

/// An image of a tile, and the mean squares of its errors along the axes of the tile.
pub(crate) struct ErrorImage {
    pub(crate) operation: SymmetryOperation,
    pub(crate) mean_squares: MeanSquares,
}

/// The film at which the expected square is taken.
#[derive(Clone, Copy)]
pub(crate) struct RobustFilm<'a> {
    pub(crate) sampling: &'a Sampling,
    pub(crate) objective: &'a Objective,
    pub(crate) pattern: &'a Pattern,
    pub(crate) variables: &'a [f64],
    /// Its field, with derivatives if the derivatives of the square are wanted.
    pub(crate) field: &'a SampledField,
}

impl RobustFilm<'_> {
    pub(crate) fn with_derivatives(&self) -> bool {
        self.field.variable_count > 0
    }
}

impl ErrorModel {
    /// The model of the errors of a layout.
    ///
    /// # Errors
    /// If a neighbouring film has no field at a point of the grid, iron near the film is not
    /// parallel to it.
    pub(crate) fn new(
        tolerance: &FilmTolerance,
        ordered: &[Tile],
        sampling: &Sampling,
        weights: [f64; 3],
    ) -> Result<ErrorModel, DesignError> {
        let mean_squares = |errors: &TileErrors| errors.each_ref().map(mean_square);
        let mut joint: Vec<JointErrors> = (tolerance.groups.iter())
            .map(|group| JointErrors {
                tiles: group.tiles.clone(),
                mean_squares: mean_squares(&group.errors),
                centre: Centre::Mean,
                sensor: None,
            })
            .collect();
        let pose = |position: &[Distribution; 3], rotation: &[Distribution; 3], sensor: Option<usize>| JointErrors {
            tiles: (0..ordered.len()).collect(),
            mean_squares: mean_squares(&TileErrors {
                position: position.clone(),
                rotation: rotation.clone(),
                ..TileErrors::default()
            }),
            centre: Centre::Box,
            sensor,
        };
        let CommonErrors { film, sensor: sensor_errors, .. } = &tolerance.common;
        let reading = &sampling.reading;
        joint.push(pose(&film.position_mm, &film.rotation_rad, None));
        // The film moves the other way past a sensor that is displaced.
        let displaced = |sensor: Option<usize>| pose(&sensor_errors.position_mm, &Default::default(), sensor);
        match reading.is_single() {
            true => joint.push(displaced(None)),
            false => joint.extend((0..reading.sensors().len()).map(|number| displaced(Some(number)))),
        }
        joint.retain(|errors| errors.mean_squares != MeanSquares::default());
        let symmetric = sampling.is_symmetric() && (weights[0] == weights[1] || !sampling.exchanges());
        let of_sensor = [&sensor_errors.position_mm, &sensor_errors.rotation_rad, &sensor_errors.gain].map(vector);
        let exchangeable = of_sensor.iter().all(|squares| squares.x == squares.y);
        Ok(ErrorModel {
            tiles: tolerance.tiles.iter().map(mean_squares).collect(),
            joint,
            common: common_errors(&tolerance.common, sampling)?,
            of_sensors: if reading.is_single() { Vec::new() } else { sensor_changes(sensor_errors, reading) },
            noise: vector(&sensor_errors.noise_t) * reading.mean_squares(),
            iron: match &tolerance.common.iron {
                Some(iron) => IronImages::all(iron, ordered, sampling)?,
                None => Vec::new(),
            },
            symmetric,
            has_symmetric_sensors: symmetric && (exchangeable || !sampling.exchanges()),
        })
    }

    /// The images of a tile to evaluate. Where the errors of images have the same effect apart from
    /// the symmetry operation, the only image is the tile itself, with the sum of all mean squares.
    pub(crate) fn images(&self, tile: &VariableTile) -> Vec<ErrorImage> {
        if self.tiles.is_empty() {
            return Vec::new();
        }
        let image = |&(operation, index): &(SymmetryOperation, usize)| ErrorImage {
            operation,
            mean_squares: along_own_axes(operation, &self.tiles[index]),
        };
        let images = tile.orbit.images.iter().map(image);
        if !self.symmetric {
            return images.collect();
        }
        let mut mean_squares = MeanSquares::default();
        for image in images {
            mean_squares.iter_mut().for_each(|(error, sum)| *sum += image.mean_squares[error]);
        }
        vec![ErrorImage { operation: SymmetryOperation::IDENTITY, mean_squares }]
    }
}

/// Mean squares of the errors of an image along the axes of the tile that it is an image of.
fn along_own_axes(operation: SymmetryOperation, of_image: &MeanSquares) -> MeanSquares {
    let mut squares = *of_image;
    if operation.exchange {
        let MeanSquares { position, rotation, size, .. } = &mut squares;
        [position, rotation, size].into_iter().for_each(|along| along.swap(0, 1));
    }
    squares
}

/// Mean squares along x, y, z.
fn vector(errors: &[Distribution; 3]) -> DVec3 {
    DVec3::from([0, 1, 2].map(|axis| mean_square(&errors[axis])))
}

fn common_errors(common: &CommonErrors, sampling: &Sampling) -> Result<Vec<CommonError>, DesignError> {
    let (reading, mut found) = (&sampling.reading, Vec::new());
    let mut add = |field_t: Vec<DVec3>, by_field: DMat3, later: bool| {
        if by_field != DMat3::ZERO || field_t.iter().any(|field| *field != DVec3::ZERO) {
            found.push(CommonError { field_t, by_field, later });
        }
    };
    let root = |squares: DVec3| squares.to_array().map(f64::sqrt);
    if let Some(stray) = &common.stray_field {
        // A field of any direction has a third of its square along each axis.
        let squares = vector(&stray.field_t) + DVec3::splat(mean_square(&stray.any_direction_t) / 3.0);
        for (axis, field_t) in DVec3::AXES.into_iter().zip(root(squares)) {
            add(vec![field_t * axis * reading.uniform()], DMat3::ZERO, stray.later);
        }
    }
    if let Some(neighbour) = &common.neighbour {
        let points: Vec<DVec3> = sampling.grid.points().chain([sampling.reference]).collect();
        let at_places = Scene::new(&neighbour.tiles).field_at(Quantity::FluxDensity, &reading.places(&points));
        let at_places = at_places.map_err(|_| DesignError::NoField)?;
        let of_point = |values: &[DVec3]| reading.sum(values.iter().copied());
        let field_t = at_places.chunks_exact(reading.sensors().len()).map(of_point).collect();
        add(field_t, DMat3::ZERO, neighbour.later);
    }
    if let Some(temperature) = &common.temperature {
        let change = mean_square(&temperature.change_k).sqrt() * temperature.strength_per_k;
        add(vec![DVec3::ZERO], DMat3::from_diagonal(DVec3::splat(change)), true);
    }
    let offsets_t = root(vector(&common.sensor.offset_t) * reading.mean_squares());
    for (number, turn_and_gain) in turns_and_gains(&common.sensor).into_iter().enumerate() {
        add(vec![offsets_t[number] * DVec3::AXES[number]], DMat3::ZERO, false);
        if reading.is_single() {
            turn_and_gain.into_iter().for_each(|by_field| add(vec![DVec3::ZERO], by_field, false));
        }
    }
    Ok(found)
}

/// The changes of the reading of one sensor by its rotation about each axis, and by its gain along
/// it, as functions of the field.
fn turns_and_gains(sensor: &SensorErrors) -> [[DMat3; 2]; 3] {
    let [turns, gains] = [&sensor.rotation_rad, &sensor.gain].map(|errors| vector(errors).map(f64::sqrt));
    [0, 1, 2].map(|number| {
        let axis = DVec3::AXES[number];
        // The sensor reads the components along its own axes: a field turned backwards.
        let backwards = DVec3::AXES.map(|column| -turns[number] * axis.cross(column));
        let turned = DMat3::from_cols(backwards[0], backwards[1], backwards[2]);
        [turned, DMat3::from_diagonal(gains[number] * axis)]
    })
}

/// The changes of the reading of each sensor of a head by its own rotation and gain.
fn sensor_changes(errors: &SensorErrors, reading: &Reading) -> Vec<SensorChange> {
    let of_sensor = |(sensor, weighted): (usize, &WeightedSensor)| {
        let weight = DMat3::from_diagonal(weighted.weight);
        let all = turns_and_gains(errors).into_iter().flatten();
        all.map(move |by_field| SensorChange { sensor, by_field: weight * by_field })
    };
    let all = reading.sensors().iter().enumerate().flat_map(of_sensor);
    all.filter(|change| change.by_field != DMat3::ZERO).collect()
}
