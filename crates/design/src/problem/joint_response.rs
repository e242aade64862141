//! How the field of a film changes with errors that several of its tiles share.

use glam::DVec3;
use magsplice_layout::TileErrors;
use magsplice_magnet::BoundingBox;

use crate::problem::error_model::{Centre, JointErrors};
use crate::problem::pattern::{VariableTile, image};
use crate::problem::robust_film::RobustFilm;
use crate::problem::symmetry::SymmetryOperation;
use crate::problem::tile_response::{RespondingTile, TileResponse, numbers};

/// The change of B by a deviation of one error, with derivatives by all variables.
pub(crate) struct JointResponse {
    /// At the points of the grid, then at the reference point.
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

/// Errors of position and rotation, which are the first.
const POSITION: usize = 0;
const ROTATION: usize = 3;
const SIZE: usize = 6;

/// The responses to each of the joint errors, times their deviations.
pub(crate) fn joint_responses(errors: &JointErrors, film: &RobustFilm) -> Option<Vec<JointResponse>> {
    let n = film.field.variable_count;
    let points: Vec<DVec3> = film.sampling.grid.points().chain([film.sampling.reference]).collect();
    let mut active = errors.mean_squares.map(|square| square > 0.0);
    // A turn about a point is a turn about another one and a shift.
    let turns = active[ROTATION..SIZE].contains(&true);
    (POSITION..ROTATION).for_each(|error| active[error] |= turns);
    let new = |active: bool| active.then(|| JointResponse::new(points.len(), n));
    let mut responses = active.map(new);
    for tile in &film.pattern.tiles {
        let images = || tile.orbit.images.iter().filter(|(_, index)| errors.tiles.contains(index));
        if images().next().is_none() {
            continue;
        }
        let responding = RespondingTile::new(tile, film.variables, all_axes(active), n > 0)?;
        for (operation, _) in images() {
            let mapped: Vec<DVec3> = points.iter().map(|point| operation.inverse().apply(*point)).collect();
            let centre = centre_of(tile, *operation, film);
            for (point, response) in responding.at(&mapped)?.iter().enumerate() {
                let seen = Seen { response, operation: *operation, tile };
                for (error, into) in responses.iter_mut().enumerate() {
                    let Some(into) = into else { continue };
                    let turn = DVec3::AXES[error % 3];
                    let is_turn = (ROTATION..SIZE).contains(&error);
                    let shift = if is_turn { turn.cross(centre.value) } else { DVec3::ZERO };
                    seen.add_to(into, point, error, 1.0);
                    for axis in (0..3).filter(|_| is_turn) {
                        seen.add_to(into, point, POSITION + axis, shift[axis]);
                        let change = seen.change(POSITION + axis);
                        for (sum, by) in into.derivatives[point * n..][..n].iter_mut().zip(&centre.derivatives) {
                            *sum += turn.cross(*by)[axis] * change;
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
    let scaled = |(response, deviation): (Option<JointResponse>, f64)| {
        let mut response = response.filter(|_| deviation > 0.0)?;
        response.changes.iter_mut().chain(&mut response.derivatives).for_each(|change| *change *= deviation);
        Some(response)
    };
    Some(responses.into_iter().zip(deviations).filter_map(scaled).collect())
}

/// Turns about the origin become turns about a point.
fn turn_about(centre: &VariablePoint, responses: &mut [Option<JointResponse>; TileErrors::COUNT]) {
    let (positions, rest) = responses.split_at_mut(ROTATION);
    for (number, turning) in rest.iter_mut().enumerate().take(SIZE - ROTATION) {
        let Some(turning) = turning else { continue };
        let turn = DVec3::AXES[number];
        let back = turn.cross(centre.value);
        let n = centre.derivatives.len();
        for (axis, shifted) in positions.iter().enumerate() {
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
fn all_axes(active: [bool; TileErrors::COUNT]) -> [bool; TileErrors::COUNT] {
    let mut all = active;
    for kind in 0..3 {
        let any = active[3 * kind..3 * kind + 3].contains(&true);
        all[3 * kind..3 * kind + 3].fill(any);
    }
    all
}

/// The response of an image of a tile.
struct Seen<'a> {
    response: &'a TileResponse,
    operation: SymmetryOperation,
    tile: &'a VariableTile,
}

impl Seen<'_> {
    /// The error of the tile that an error of the image is, and its sign.
    fn own_error(&self, error: usize) -> (usize, f64) {
        let SymmetryOperation { exchange, signs: [x, y] } = self.operation;
        let handed = x * y * if exchange { -1.0 } else { 1.0 };
        let (kind, axis) = (error / 3, error % 3);
        let own_axis = if exchange && axis < 2 { 1 - axis } else { axis };
        match kind {
            0 => (own_axis, [x, y, 1.0][axis]),
            1 => (ROTATION + own_axis, handed * [x, y, 1.0][axis]),
            2 => (SIZE + own_axis, 1.0),
            // Turns in the plane of the film change their sign in mirrors.
            _ => (error, if error == TileErrors::COUNT - 2 { handed } else { 1.0 }),
        }
    }

    fn change(&self, error: usize) -> DVec3 {
        let (own, sign) = self.own_error(error);
        sign * self.operation.apply(self.response.by_error[own])
    }

    fn add_to(&self, into: &mut JointResponse, point: usize, error: usize, factor: f64) {
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
