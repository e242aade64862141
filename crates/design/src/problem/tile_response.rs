//! Changes of the field of a tile by its manufacturing errors, and their derivatives by the numbers
//! of the tile that a search varies.

use glam::{DMat3, DVec3};
use magsplice_field::{FaceDerivatives, FaceHessian, PolarizationMap};
use magsplice_magnet::{Axis, PerTileError, Reflection, Tile, TileError};
use magsplice_tolerance::direction_normal;

use crate::problem::pattern::VariableTile;
use crate::problem::reading::Reading;
use crate::problem::sampling::matrix;

/// Numbers of a tile: the coordinates of its faces, each at twice its axis plus its side;
/// direction, tilt and strength of its polarization.
pub(crate) const NUMBERS: usize = 9;
const FACES: usize = 6;

/// The terms of the numbers of a tile, in the order of [`TileResponse::derivatives`].
pub(crate) fn numbers(tile: &VariableTile) -> [&[(usize, f64)]; NUMBERS] {
    let [[x0, x1], [y0, y1], [z0, z1]] = &tile.faces;
    [x0, x1, y0, y1, z0, z1, &tile.direction, &tile.tilt, &tile.strength].map(|number| number.terms.as_slice())
}

/// The change of B at a point for a unit of each error of a tile: tesla per millimetre, per radian,
/// or per whole of the strength.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct TileResponse {
    /// The changes.
    pub(crate) by_error: PerTileError<DVec3>,
    /// Their derivatives with respect to the numbers of the tile.
    pub(crate) derivatives: PerTileError<[DVec3; NUMBERS]>,
}

impl TileResponse {
    /// Adds the response at another place, of which `seen` is read.
    fn add(&mut self, at_place: &TileResponse, seen: impl Fn(DVec3) -> DVec3) {
        for (error, change) in self.by_error.iter_mut() {
            *change += seen(at_place.by_error[error]);
        }
        for (error, derivatives) in self.derivatives.iter_mut() {
            let own = derivatives.iter_mut().zip(&at_place.derivatives[error]);
            own.for_each(|(sum, by)| *sum += seen(*by));
        }
    }
}

/// A tile prepared for its responses at many points.
pub(crate) struct RespondingTile<'a> {
    tile: Tile,
    /// None for the tile itself, then one for each of its images in flat iron.
    reflections: &'a [Reflection],
    /// Whether the iron moves and turns with the tile.
    moves_iron: bool,
    /// The tile with a unit of polarization along each of its axes.
    unit_tiles: [Tile; 3],
    /// The axes of the tile, by columns.
    axes: DMat3,
    j: DVec3,
    /// Derivatives of the polarization by direction, tilt and strength.
    by_angles: [DVec3; 3],
    /// Changes of the polarization by a unit of each error of direction.
    turned: [DVec3; 2],
    /// Their derivatives by direction, tilt and strength.
    turned_by_angles: [[DVec3; 3]; 2],
    /// Errors that the tile has.
    active: PerTileError<bool>,
    /// Whether derivatives by faces are needed.
    faces_vary: bool,
    with_derivatives: bool,
}

impl<'a> RespondingTile<'a> {
    /// Prepares a tile. Responses to errors that are not active are left at 0. `None` where a side
    /// of the tile is not positive.
    pub(crate) fn new(
        variable_tile: &VariableTile,
        reflections: &'a [Reflection],
        variables: &[f64],
        active: PerTileError<bool>,
        with_derivatives: bool,
    ) -> Option<RespondingTile<'a>> {
        let tile = variable_tile.tile(variables)?;
        let with_j = |j: DVec3| Tile::new(tile.position(), tile.size(), j).ok()?.rotated(tile.rotation()).ok();
        let by_angles = variable_tile.polarization_derivatives(variables);
        let (unit, strength) = (by_angles[2], variable_tile.strength.eval(variables));
        let (turned, turned_by_angles) = turned(&with_j(unit)?, unit, strength, &by_angles);
        Some(RespondingTile {
            tile,
            reflections,
            moves_iron: false,
            unit_tiles: [with_j(DVec3::X)?, with_j(DVec3::Y)?, with_j(DVec3::Z)?],
            axes: DMat3::from_quat(tile.rotation()),
            j: tile.polarization_t(),
            by_angles,
            turned,
            turned_by_angles,
            active,
            faces_vary: variable_tile.faces.iter().flatten().any(|face| !face.terms.is_empty()),
            with_derivatives,
        })
    }

    /// The same tile, with iron that moves and turns with it.
    pub(crate) fn moving_iron(self, moves_iron: bool) -> RespondingTile<'a> {
        RespondingTile { moves_iron, ..self }
    }

    /// The responses of what is read at points. `None` where a place lies on an edge of the tile.
    pub(crate) fn read(&self, reading: &Reading, points: &[DVec3]) -> Option<Vec<TileResponse>> {
        if reading.is_single() {
            return self.at(points);
        }
        let at_places = self.at(&reading.places(points))?;
        let of_point = |at_sensors: &[TileResponse]| {
            let mut sum = TileResponse::default();
            reading
                .sensors()
                .iter()
                .zip(at_sensors)
                .for_each(|(sensor, response)| sum.add(response, |b_t| sensor.weight * b_t));
            sum
        };
        Some(at_places.chunks_exact(reading.sensors().len()).map(of_point).collect())
    }

    /// The responses of the tile and its images at points. `None` where a place lies on an edge of
    /// the tile.
    fn at(&self, points: &[DVec3]) -> Option<Vec<TileResponse>> {
        let mut sums = vec![TileResponse::default(); points.len()];
        for reflection in self.reflections {
            let places: Vec<DVec3> = points.iter().map(|point| reflection.place(*point)).collect();
            let map = PolarizationMap::new(&[self.tile], &places).ok()?;
            for (row, (sum, place)) in sums.iter_mut().zip(&places).enumerate() {
                let mut response = self.response(*place, matrix(&map, row))?;
                if self.moves_iron {
                    response = self.with_moved_image(&response, reflection);
                }
                sum.add(&response, |b_t| reflection.field(b_t));
            }
        }
        Some(sums)
    }

    /// The response at the place of a reflection, where the image moves and turns as the tile does:
    /// in the reflected frame the tile has the reflected motion, and turns about where its image
    /// is.
    fn with_moved_image(&self, response: &TileResponse, reflection: &Reflection) -> TileResponse {
        let mut moved = *response;
        let centre = self.tile.position();
        let gap = centre - reflection.place(centre);
        for axis in Axis::ALL {
            let along = reflection.motion(axis.unit());
            let turn = reflection.turn(axis.unit());
            let arm = turn.cross(gap);
            let [shifting, turning] = [TileError::Position(axis), TileError::Rotation(axis)];
            moved.by_error[shifting] = DVec3::ZERO;
            moved.by_error[turning] = DVec3::ZERO;
            moved.derivatives[shifting] = [DVec3::ZERO; NUMBERS];
            moved.derivatives[turning] = [DVec3::ZERO; NUMBERS];
            for own in Axis::ALL {
                let k = own.index();
                let [shift, rotation] = [TileError::Position(own), TileError::Rotation(own)];
                moved.by_error[shifting] += along[k] * response.by_error[shift];
                moved.by_error[turning] += turn[k] * response.by_error[rotation] + arm[k] * response.by_error[shift];
                for number in 0..NUMBERS {
                    let by_shift = response.derivatives[shift][number];
                    moved.derivatives[shifting][number] += along[k] * by_shift;
                    moved.derivatives[turning][number] +=
                        turn[k] * response.derivatives[rotation][number] + arm[k] * by_shift;
                }
                // A face moves the centre by half.
                for face in (0..FACES).filter(|_| self.with_derivatives) {
                    let centre = 0.5 * self.axes.col(face / 2);
                    let by_face = turn.cross(centre - reflection.motion(centre));
                    moved.derivatives[turning][face] += by_face[k] * response.by_error[shift];
                }
            }
        }
        moved
    }

    /// The response at a point, where `by_j` is the field of units of polarization.
    fn response(&self, point: DVec3, by_j: DMat3) -> Option<TileResponse> {
        let mut response = TileResponse::default();
        let units = FirstDerivatives::new(&self.unit_tiles, point)?;
        let own = units.of(self.j);
        let second = self.with_derivatives && self.faces_vary;
        let hessian = if second { Some(FaceHessian::new(&self.tile, point)?) } else { None };
        let of_angles = if self.with_derivatives { self.by_angles.map(|by| units.of(by)) } else { [own; 3] };
        let arm = point - self.tile.position();
        let field = by_j * self.j;
        for error in TileError::ALL.into_iter().filter(|error| self.active[*error]) {
            let into = &mut response.derivatives[error];
            match error {
                TileError::Position(axis) | TileError::Rotation(axis) => {
                    // A shift, and for a turn also the turn of the field itself.
                    let is_turn = matches!(error, TileError::Rotation(_));
                    let turn = if is_turn { axis.unit() } else { DVec3::ZERO };
                    let shift = if is_turn { turn.cross(arm) } else { axis.unit() };
                    let along = self.axes.transpose() * shift;
                    response.by_error[error] = own.shifted(along) + turn.cross(field);
                    if !self.with_derivatives {
                        continue;
                    }
                    for (number, by) in self.by_angles.into_iter().enumerate() {
                        into[FACES + number] = of_angles[number].shifted(along) + turn.cross(by_j * by);
                    }
                    let Some(hessian) = &hessian else { continue };
                    for (face, by_face) in into.iter_mut().enumerate().take(FACES) {
                        // The centre, about which the tile turns, moves by half.
                        let centre = -0.5 * (self.axes.transpose() * turn.cross(self.axes.col(face / 2)));
                        *by_face =
                            shifted_by_face(hessian, along, face) + own.shifted(centre) + turn.cross(own.by[face]);
                    }
                }
                TileError::Size(axis) => {
                    let axis = axis.index();
                    response.by_error[error] = own.grown(axis);
                    if !self.with_derivatives {
                        continue;
                    }
                    for (number, of_angle) in of_angles.iter().enumerate() {
                        into[FACES + number] = of_angle.grown(axis);
                    }
                    let Some(hessian) = &hessian else { continue };
                    for (face, by_face) in into.iter_mut().enumerate().take(FACES) {
                        let other = [face / 2, face % 2];
                        *by_face = 0.5 * (hessian.get([axis, 1], other) - hessian.get([axis, 0], other));
                    }
                }
                TileError::Strength | TileError::Direction(_) => {
                    let (j, by_angles) = match error {
                        TileError::Direction(turn) => {
                            (self.turned[turn as usize], &self.turned_by_angles[turn as usize])
                        }
                        _ => (self.j, &self.by_angles),
                    };
                    response.by_error[error] = by_j * j;
                    if !self.with_derivatives {
                        continue;
                    }
                    into[..FACES].copy_from_slice(&units.of(j).by);
                    for (number, by) in by_angles.iter().enumerate() {
                        into[FACES + number] = by_j * *by;
                    }
                }
            }
        }
        Some(response)
    }
}

/// Derivatives of B by the faces of a tile.
#[derive(Clone, Copy)]
struct FaceSlopes {
    by: [DVec3; FACES],
}

impl FaceSlopes {
    /// Change of B if the tile moves by a vector along its own axes.
    fn shifted(&self, along: DVec3) -> DVec3 {
        (0..3).map(|axis| along[axis] * (self.by[2 * axis] + self.by[2 * axis + 1])).sum()
    }

    /// Change of B by a unit of growth along an axis, about the centre.
    fn grown(&self, axis: usize) -> DVec3 {
        0.5 * (self.by[2 * axis + 1] - self.by[2 * axis])
    }
}

/// Derivatives of B by the faces for a unit of polarization along each axis of the tile.
struct FirstDerivatives([FaceSlopes; 3]);

impl FirstDerivatives {
    fn new(unit_tiles: &[Tile; 3], point: DVec3) -> Option<FirstDerivatives> {
        let of = |tile: &Tile| {
            let FaceDerivatives { lower, upper } = FaceDerivatives::new(tile, point)?;
            let by = [0, 1, 2, 3, 4, 5].map(|face: usize| [lower, upper][face % 2].col(face / 2));
            Some(FaceSlopes { by })
        };
        let [x, y, z] = unit_tiles;
        Some(FirstDerivatives([of(x)?, of(y)?, of(z)?]))
    }

    /// The derivatives for a polarization.
    fn of(&self, j: DVec3) -> FaceSlopes {
        let [x, y, z] = &self.0;
        let face = |face: usize| j.x * x.by[face] + j.y * y.by[face] + j.z * z.by[face];
        FaceSlopes { by: [0, 1, 2, 3, 4, 5].map(face) }
    }
}

/// Derivative by a face of the change of B by a shift.
fn shifted_by_face(hessian: &FaceHessian, along: DVec3, face: usize) -> DVec3 {
    let other = [face / 2, face % 2];
    (0..3).map(|axis| along[axis] * (hessian.get([axis, 0], other) + hessian.get([axis, 1], other))).sum()
}

/// Changes of the polarization by a unit of each error of direction, and their derivatives by
/// direction, tilt and strength.
///
/// Let u be the unit vector of the polarization, s its magnitude, and N the vector from which the
/// errors are measured, in most cases the film's normal. The axes of the turns are the parts of N
/// normal to u, and the axis normal to both, so that the changes are s w and s u x w with w the
/// unit vector of N x u.
fn turned(unit_tile: &Tile, unit: DVec3, strength: f64, by_angles: &[DVec3; 3]) -> ([DVec3; 2], [[DVec3; 3]; 2]) {
    let Some(normal) = direction_normal(unit_tile) else { return Default::default() };
    let across = normal.cross(unit);
    let w = across.normalize();
    let level = unit.cross(w);
    let mut derivatives = [[w, w, w], [level, level, level]];
    for number in 0..2 {
        // Of u itself; the derivative of the polarization is s times that.
        let by = if strength == 0.0 { DVec3::ZERO } else { by_angles[number] / strength };
        let turning = normal.cross(by) / across.length();
        let w_by = turning - w * w.dot(turning);
        derivatives[0][number] = strength * w_by;
        derivatives[1][number] = strength * (by.cross(w) + unit.cross(w_by));
    }
    ([strength * w, strength * level], derivatives)
}
