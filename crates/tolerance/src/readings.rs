//! Readings of the sensor: pose of the film, other fields, temperature, and the sensor's own
//! errors.

use glam::{DQuat, DVec3};
use magsplice_layout::CommonErrors;
use magsplice_magnet::HallSensor;

use crate::draws::Draws;

/// A rigid motion: a rotation about a point, then a shift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pose {
    about: DVec3,
    shift: DVec3,
    turn: DQuat,
}

impl Pose {
    /// No motion.
    pub(crate) const NONE: Pose = Pose { about: DVec3::ZERO, shift: DVec3::ZERO, turn: DQuat::IDENTITY };

    pub(crate) fn new(about: DVec3, shift: DVec3, rotation_rad: DVec3) -> Pose {
        Pose { about, shift, turn: DQuat::from_scaled_axis(rotation_rad) }
    }

    pub(crate) fn rotation(&self) -> DQuat {
        self.turn
    }

    /// The place of a point of the body after the motion.
    pub(crate) fn apply(&self, point: DVec3) -> DVec3 {
        if self.turn == DQuat::IDENTITY {
            // Without the rounding of the difference.
            return point + self.shift;
        }
        self.about + self.turn * (point - self.about) + self.shift
    }

    /// The point of the body that the motion brings to `place`.
    pub(crate) fn undo(&self, place: DVec3) -> DVec3 {
        if self.turn == DQuat::IDENTITY {
            return place - self.shift;
        }
        self.about + self.turn.inverse() * (place - self.about - self.shift)
    }
}

/// The common errors of one sample.
#[derive(Clone, Debug)]
pub(crate) struct Surroundings {
    pub(crate) pose: Pose,
    stray_field_t: DVec3,
    stray_field_later: bool,
    neighbour_later: bool,
    /// Relative change of all strengths after the reading at the reference point.
    warming: f64,
    /// Error of the distance of iron near the film.
    pub(crate) iron_error_mm: f64,
    /// Of each sensor of a head, or of one.
    pub(crate) chips: Vec<ChipErrors>,
}

/// The errors of one Hall sensor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChipErrors {
    /// Displacement along the axes of the film.
    pub(crate) shift_mm: DVec3,
    turn: DQuat,
    gain: DVec3,
    offset_t: DVec3,
}

/// First index of each common cause in the random stream.
const FILM_POSITION: usize = 0;
const FILM_ROTATION: usize = 3;
const STRAY_FIELD: usize = 6;
const TEMPERATURE: usize = 12;
const SENSOR_OFFSET: usize = 13;
const SENSOR_ROTATION: usize = 16;
const SENSOR_GAIN: usize = 19;
const SENSOR_POSITION: usize = 22;
const IRON_DISTANCE: usize = 25;

/// First index of the errors of the second sensor of a head, and the distance to those of the next.
const OTHER_SENSORS: usize = 64;
const OF_SENSOR: usize = 16;

impl Surroundings {
    pub(crate) fn draw(common: &CommonErrors, centre: DVec3, chips: usize, draws: &mut Draws) -> Surroundings {
        let CommonErrors { film, stray_field, neighbour, iron, temperature, sensor } = common;
        let mut vector = |cause, errors: &[_; 3]| {
            let [x, y, z] = errors;
            DVec3::from(draws.common(cause, [x, y, z]))
        };
        let pose =
            Pose::new(centre, vector(FILM_POSITION, &film.position_mm), vector(FILM_ROTATION, &film.rotation_rad));
        let chip = |number: usize| {
            let first = if number == 0 { SENSOR_OFFSET } else { OTHER_SENSORS + OF_SENSOR * (number - 1) };
            let mut of = |cause: usize, errors| vector(first + cause - SENSOR_OFFSET, errors);
            ChipErrors {
                shift_mm: of(SENSOR_POSITION, &sensor.position_mm),
                turn: DQuat::from_scaled_axis(of(SENSOR_ROTATION, &sensor.rotation_rad)),
                gain: DVec3::ONE + of(SENSOR_GAIN, &sensor.gain),
                offset_t: of(SENSOR_OFFSET, &sensor.offset_t),
            }
        };
        let chips = (0..chips).map(chip).collect();
        let warming = temperature.as_ref().map_or(0.0, |temperature| {
            let [change_k] = draws.common(TEMPERATURE, [&temperature.change_k]);
            change_k * temperature.strength_per_k
        });
        Surroundings {
            pose,
            stray_field_t: stray_field.as_ref().map_or(DVec3::ZERO, |field| draws.stray_field_t(STRAY_FIELD, field)),
            stray_field_later: stray_field.as_ref().is_some_and(|field| field.later),
            neighbour_later: neighbour.as_ref().is_some_and(|neighbour| neighbour.later),
            warming,
            iron_error_mm: iron
                .as_ref()
                .map_or(0.0, |iron| draws.common::<1>(IRON_DISTANCE, [&iron.distance_error_mm])[0]),
            chips,
        }
    }

    /// The values of the errors: three each of position and rotation of the film, three of the
    /// stray field, the relative change of all strengths, the error of the distance of iron, and
    /// three each of offset, rotation, gain and position of each sensor.
    pub(crate) fn values(&self) -> Vec<f64> {
        let of_film = [self.pose.shift, self.pose.turn.to_scaled_axis(), self.stray_field_t];
        let of_chip =
            |chip: &ChipErrors| [chip.offset_t, chip.turn.to_scaled_axis(), chip.gain - DVec3::ONE, chip.shift_mm];
        let of_film =
            of_film.into_iter().flat_map(|vector| vector.to_array()).chain([self.warming, self.iron_error_mm]);
        of_film.chain(self.chips.iter().flat_map(of_chip).flat_map(|vector| vector.to_array())).collect()
    }

    /// The strength of all tiles after the reading at the reference point, relative to the strength
    /// before.
    pub(crate) fn strength(&self) -> f64 {
        1.0 + self.warming
    }

    /// The uniform field after the reading at the reference point.
    pub(crate) fn stray_field_t(&self) -> DVec3 {
        self.stray_field_t
    }

    /// A sensor with the errors of these readings. It turns about its own axes.
    pub(crate) fn sensor(&self, ordered: &HallSensor) -> HallSensor {
        let chip = &self.chips[0];
        HallSensor {
            rotation: (ordered.rotation * chip.turn).normalize(),
            gain: ordered.gain * chip.gain,
            offset_t: ordered.offset_t + chip.offset_t,
            ..*ordered
        }
    }

    /// The reading of a sensor, in tesla, without noise. `film_t` is the field of the film and
    /// of its images, `neighbour_t` the field of its neighbour. The first reading, at the reference
    /// point, lacks later contributions.
    pub(crate) fn reading_t(&self, chip: &ChipErrors, film_t: DVec3, neighbour_t: DVec3, is_first: bool) -> DVec3 {
        let mut b_t = film_t;
        if !is_first {
            b_t *= self.strength();
        }
        if !(is_first && self.neighbour_later) {
            b_t += neighbour_t;
        }
        if !(is_first && self.stray_field_later) {
            b_t += self.stray_field_t;
        }
        chip.gain * (chip.turn.inverse() * b_t) + chip.offset_t
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pose_is_undone() {
        let pose = Pose::new(DVec3::new(1.0, -2.0, 0.5), DVec3::new(0.1, 0.2, -0.3), DVec3::new(0.2, -0.1, 0.3));
        let point = DVec3::new(3.0, 4.0, -5.0);
        assert!(pose.undo(pose.apply(point)).distance(point) < 1e-14);
        // The point about which it turns is only shifted.
        let centre = DVec3::new(1.0, -2.0, 0.5);
        assert!(pose.apply(centre).distance(centre + DVec3::new(0.1, 0.2, -0.3)) < 1e-15);
    }
}
