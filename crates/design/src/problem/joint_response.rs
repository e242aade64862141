//! Changes of the field of a film by errors that several of its tiles share.

use glam::DVec3;
use magsplice_magnet::{Axis, BoundingBox, DirectionError, PerTileError, TileError};

use crate::problem::error_model::{Centre, JointErrors, RobustFilm, SensorChange};
use crate::problem::near_iron::IronImages;
use crate::problem::pattern::{VariableTile, image};
use crate::problem::symmetry::SymmetryOperation;
use crate::problem::tile_response::{RespondingTile, TileResponse, numbers};

/// The change of the reading by a deviation of one error, with derivatives by all variables.
pub(crate) struct JointResponse {
    /// At points of the grid, then at the reference point.
    changes: Vec<DVec3>,
    /// Variable fastest.
    derivatives: Vec<DVec3>,
}

impl JointResponse {
    fn new(points: usize, variable_count: usize) -> JointResponse {
        JointResponse { changes: vec![DVec3::ZERO; points], derivatives: vec![DVec3::ZERO; points * variable_count] }
    }

    pub(crate) fn at(&self, point: usize) -> (DVec3, &[DVec3]) {
        let n = self.derivatives.len() / self.changes.len();
        (self.changes[point], &self.derivatives[point * n..][..n])
    }
}

/// A point that depends on variables: its value, and its derivatives by all of them.
struct VariablePoint {
    value: DVec3,
    derivatives: Vec<DVec3>,
}

/// The response to the rotation or the gain of one sensor of a head, at these points of the grid.
pub(crate) fn sensor_response(change: &SensorChange, points: &[usize], film: &RobustFilm) -> Option<JointResponse> {
    let (n, sampling) = (film.field.variable_count, film.sampling);
    let (sensors, reference) = (sampling.reading.sensors().len(), sampling.computed().len() - 1);
    let of_points = points.iter().map(|&point| sampling.images()[point]);
    let mut response = JointResponse::new(points.len() + 1, n);
    for (at, (index, operation)) in of_points.chain([(reference, SymmetryOperation::IDENTITY)]).enumerate() {
        // The sensor at the computed point whose image the sensor is.
        let sensor = sampling.reading.image(change.sensor, operation.inverse())?;
        let (b_t, derivatives) = film.field.at_place(index * sensors + sensor)?;
        response.changes[at] = change.by_field * operation.apply(b_t);
        let into = response.derivatives[at * n..][..n].iter_mut();
        into.zip(derivatives).for_each(|(into, by)| *into = change.by_field * operation.apply(*by));
    }
    Some(response)
}

/// The response to iron near the film at these points of the grid: the reading of its images.
pub(crate) fn iron_response(iron: &IronImages, points: &[usize], film: &RobustFilm) -> Option<JointResponse> {
    let n = film.field.variable_count;
    let read = iron.read(film.pattern, film.variables, points, n > 0)?;
    let mut response = JointResponse::new(points.len() + 1, n);
    let is_there = |at: usize| at < points.len() || !iron.later;
    for (at, of_images) in read.into_iter().enumerate().filter(|(at, _)| is_there(*at)) {
        response.changes[at] = of_images.value;
        response.derivatives[at * n..][..n].copy_from_slice(&of_images.derivatives);
    }
    Some(response)
}

/// The responses to each of the joint errors, times their deviations, at these points of the grid.
pub(crate) fn joint_responses(errors: &JointErrors, points: &[usize], film: &RobustFilm) -> Option<Vec<JointResponse>> {
    let n = film.field.variable_count;
    let of_grid = |&point: &usize| film.sampling.grid.point(point);
    let points: Vec<DVec3> = points.iter().map(of_grid).chain([film.sampling.reference]).collect();
    let reading = match errors.sensor {
        Some(sensor) => film.sampling.reading.alone(sensor),
        None => film.sampling.reading.clone(),
    };
    let mut active = errors.mean_squares.map(|square| square > 0.0);
    // A turn about a point is a turn about another one and a shift.
    let turns = active.rotation.contains(&true);
    active.position.iter_mut().for_each(|active| *active |= turns);
    let new = |active: bool| active.then(|| JointResponse::new(points.len(), n));
    let mut responses = active.map(new);
    for tile in &film.pattern.tiles {
        let images = || tile.orbit.images.iter().filter(|(_, index)| errors.tiles.contains(index));
        if images().next().is_none() {
            continue;
        }
        let responding =
            RespondingTile::new(tile, &film.sampling.reflections, film.variables, all_axes(active), n > 0)?;
        // The whole film moves with its iron.
        let responding = responding.moving_iron(errors.centre == Centre::Box);
        for (operation, _) in images() {
            let mapped: Vec<DVec3> = points.iter().map(|point| operation.inverse().apply(*point)).collect();
            let centre = centre_of(tile, *operation, film);
            let responses_of_tile = responding.read(&reading.seen_by(*operation), &mapped)?;
            for (point, response) in responses_of_tile.iter().enumerate() {
                let seen = Seen { response, operation: *operation, tile };
                for (error, into) in responses.iter_mut() {
                    let Some(into) = into else { continue };
                    seen.add_to(into, point, error, 1.0);
                    let TileError::Rotation(about) = error else { continue };
                    let turn = about.unit();
                    let shift = turn.cross(centre.value);
                    for axis in Axis::ALL {
                        seen.add_to(into, point, TileError::Position(axis), shift[axis.index()]);
                        let change = seen.change(TileError::Position(axis));
                        for (sum, by) in into.derivatives[point * n..][..n].iter_mut().zip(&centre.derivatives) {
                            *sum += turn.cross(*by)[axis.index()] * change;
                        }
                    }
                }
            }
        }
    }
    if turns {
        let centre = joint_centre(errors, film)?;
        turn_about(&centre, &mut responses);
    }
    let deviations = errors.mean_squares.map(f64::sqrt);
    let scaled = |(error, response): (TileError, &mut Option<JointResponse>)| {
        let deviation = deviations[error];
        let mut response = response.take().filter(|_| deviation > 0.0)?;
        response.changes.iter_mut().chain(&mut response.derivatives).for_each(|change| *change *= deviation);
        Some(response)
    };
    Some(responses.iter_mut().filter_map(scaled).collect())
}

/// Turns about the origin become turns about a point.
fn turn_about(centre: &VariablePoint, responses: &mut PerTileError<Option<JointResponse>>) {
    for (number, turning) in responses.rotation.iter_mut().enumerate() {
        let Some(turning) = turning else { continue };
        let turn = DVec3::AXES[number];
        let back = turn.cross(centre.value);
        let n = centre.derivatives.len();
        for (axis, shifted) in responses.position.iter().enumerate() {
            let Some(shifted) = shifted else { continue };
            for (point, change) in shifted.changes.iter().enumerate() {
                turning.changes[point] -= back[axis] * *change;
                let own = &shifted.derivatives[point * n..][..n];
                for ((sum, by), by_centre) in
                    turning.derivatives[point * n..][..n].iter_mut().zip(own).zip(&centre.derivatives)
                {
                    *sum -= back[axis] * *by + turn.cross(*by_centre)[axis] * *change;
                }
            }
        }
    }
}

/// Errors of a tile along all axes of each kind, because images may exchange the axes.
fn all_axes(active: PerTileError<bool>) -> PerTileError<bool> {
    let PerTileError { position, rotation, size, strength, direction } = active;
    let [position, rotation, size] = [position, rotation, size].map(|along| [along.contains(&true); 3]);
    PerTileError { position, rotation, size, strength, direction }
}

/// The response of an image of a tile.
struct Seen<'a> {
    response: &'a TileResponse,
    operation: SymmetryOperation,
    tile: &'a VariableTile,
}

impl Seen<'_> {
    /// The error of the tile that an error of the image is, and its sign.
    fn own_error(&self, error: TileError) -> (TileError, f64) {
        let SymmetryOperation { exchange, signs: [x, y] } = self.operation;
        let handed = x * y * if exchange { -1.0 } else { 1.0 };
        let own = |axis: Axis| match axis {
            Axis::X if exchange => Axis::Y,
            Axis::Y if exchange => Axis::X,
            _ => axis,
        };
        let sign = |axis: Axis| [x, y, 1.0][axis.index()];
        match error {
            TileError::Position(axis) => (TileError::Position(own(axis)), sign(axis)),
            TileError::Rotation(axis) => (TileError::Rotation(own(axis)), handed * sign(axis)),
            TileError::Size(axis) => (TileError::Size(own(axis)), 1.0),
            // Turns in the plane of the film change their sign in mirrors.
            TileError::Direction(DirectionError::InPlane) => (error, handed),
            TileError::Strength | TileError::Direction(DirectionError::OutOfPlane) => (error, 1.0),
        }
    }

    fn change(&self, error: TileError) -> DVec3 {
        let (own, sign) = self.own_error(error);
        sign * self.operation.apply(self.response.by_error[own])
    }

    fn add_to(&self, into: &mut JointResponse, point: usize, error: TileError, factor: f64) {
        let (own, sign) = self.own_error(error);
        into.changes[point] += factor * self.change(error);
        let n = into.derivatives.len() / into.changes.len();
        if n == 0 {
            return;
        }
        let derivatives = &mut into.derivatives[point * n..][..n];
        for (terms, by) in numbers(self.tile).into_iter().zip(self.response.derivatives[own]) {
            for &(variable, of_term) in terms {
                derivatives[variable] += factor * of_term * sign * self.operation.apply(by);
            }
        }
    }
}

/// The centre of an image of a tile.
fn centre_of(tile: &VariableTile, operation: SymmetryOperation, film: &RobustFilm) -> VariablePoint {
    let [lower, upper] = tile.corners(film.variables);
    let mut derivatives = vec![DVec3::ZERO; film.field.variable_count];
    if !derivatives.is_empty() {
        for (axis, ends) in tile.faces.iter().enumerate() {
            for &(variable, factor) in ends.iter().flat_map(|end| &end.terms) {
                derivatives[variable] += operation.apply(0.5 * factor * DVec3::AXES[axis]);
            }
        }
    }
    VariablePoint { value: operation.apply(0.5 * (lower + upper)), derivatives }
}

/// The point about which tiles turn together.
fn joint_centre(errors: &JointErrors, film: &RobustFilm) -> Option<VariablePoint> {
    let mut sum = VariablePoint { value: DVec3::ZERO, derivatives: vec![DVec3::ZERO; film.field.variable_count] };
    let mut add = |factor: f64, value: DVec3, derivatives: &[DVec3]| {
        sum.value += factor * value;
        sum.derivatives.iter_mut().zip(derivatives).for_each(|(sum, by)| *sum += factor * *by);
    };
    let tiles = || {
        let images = |tile: &'_ VariableTile| tile.orbit.images.clone();
        let all =
            film.pattern.tiles.iter().flat_map(move |tile| images(tile).into_iter().map(move |image| (tile, image)));
        all.filter(|(_, (_, index))| errors.tiles.contains(index))
    };
    match errors.centre {
        Centre::Mean => {
            let share = 1.0 / errors.tiles.len() as f64;
            for (tile, (operation, _)) in tiles() {
                let VariablePoint { value, derivatives } = centre_of(tile, operation, film);
                add(share, value, &derivatives);
            }
        }
        Centre::Box => {
            for (axis, side) in (0..3).flat_map(|axis| [(axis, 0), (axis, 1)]) {
                let mut outermost: Option<(f64, Vec<DVec3>)> = None;
                for (tile, (operation, _)) in tiles() {
                    let bounds = BoundingBox::from_tile(&image(&tile.tile(film.variables)?, operation)?);
                    let end = [bounds.lower, bounds.upper][side][axis];
                    let is_outer = |known: f64| if side == 0 { end < known } else { end > known };
                    if outermost.as_ref().is_some_and(|(known, _)| !is_outer(*known)) {
                        continue;
                    }
                    let face = match axis {
                        2 => tile.faces[2][side].clone(),
                        _ => tile.image_faces(operation)[axis][side].clone(),
                    };
                    let mut derivatives = vec![DVec3::ZERO; film.field.variable_count];
                    for &(variable, factor) in face.terms.iter().filter(|_| film.field.variable_count > 0) {
                        derivatives[variable] += factor * DVec3::AXES[axis];
                    }
                    outermost = Some((end, derivatives));
                }
                let (end, derivatives) = outermost?;
                add(0.5, end * DVec3::AXES[axis], &derivatives);
            }
        }
    }
    Some(sum)
}
