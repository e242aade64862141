//! Experiments that move a film along an axis and read a sensor (Dai 2024, Fig. 9).

use glam::DVec3;
use magsplice_decouple::{Branch, Parameters};
use magsplice_magnet::{Grid, HallSensor, PointErrors};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::locator::{LocateError, Located, Locator};
use crate::sensed_field::SensedField;

/// Fraction of a step by which a displacement may exceed the volume: the round-off of decimal
/// steps.
const STEP_ROUNDING: f64 = 1e-9;

/// A film at one displacement, with the results of its sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct ExperimentStep {
    /// The displacement of the film.
    pub displacement: DVec3,
    /// The reading of the sensor in tesla: rounded and limited, with noise if requested.
    pub reading_t: DVec3,
    /// R_x, R_y, S_z of the reading (Eq. 15). `None` where B_z is 0.
    pub parameters: Option<Parameters>,
    /// The displacement of the film by the closed form (Eq. 14). `None` without a wavenumber or
    /// where B_z is 0.
    pub by_closed_form: Option<DVec3>,
    /// The displacement of the film by the field of the tiles. `None` for readings without a
    /// position, and if the reading at rest has none.
    pub by_field: Option<DVec3>,
    /// Whether a component of the reading is at the limit of the sensor's range.
    pub is_saturated: bool,
}

/// Settings of an experiment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExperimentSettings {
    /// The position of the sensor below the film at rest, in the frame of the film.
    pub reference: DVec3,
    /// Wavenumber of the ideal film, for the closed form.
    pub wavenumber: Option<f64>,
    /// Seed of the noise of the readings. `None` for readings without noise.
    pub seed: Option<u64>,
}

/// The displacements of a film along an axis, at multiples of a step, for which a sensor at
/// `reference` stays in a volume. The sensor moves in the opposite direction in the frame of the
/// film.
///
/// # Panics
/// If the step is not greater than 0.
pub fn displacements(volume: &Grid, reference: DVec3, axis: usize, step: f64) -> Vec<DVec3> {
    assert!(step > 0.0, "a step must be greater than 0");
    let count = |room: f64| (room / step + STEP_ROUNDING).floor() as i64;
    let (towards_upper, towards_lower) =
        (count(volume.upper()[axis] - reference[axis]), count(reference[axis] - volume.lower()[axis]));
    let moved = |n: i64| {
        let mut moved = DVec3::ZERO;
        moved[axis] = n as f64 * step;
        moved
    };
    (-towards_upper..=towards_lower).map(moved).collect()
}

/// Moves a film and reads its sensor at each displacement.
///
/// `film` is the film as made, and `locator` has the film as ordered. The sensor is first read at
/// rest, without noise. All displacements count from this reading. Displacements by the field count
/// from its position, which differs from the reference point if the films differ.
///
/// # Errors
/// If the sensor is on an edge of a tile at a displacement.
pub fn experiment(
    film: &SensedField,
    locator: &Locator,
    displacements: &[DVec3],
    settings: &ExperimentSettings,
) -> Result<Vec<ExperimentStep>, PointErrors> {
    let sensor = film.sensor();
    let mut places = vec![settings.reference];
    places.extend(displacements.iter().map(|moved| settings.reference - *moved));
    let mut readings_t = film.readings_t(&places)?;
    let at_rest_t = readings_t.remove(0);
    if let Some(seed) = settings.seed {
        for (index, reading) in readings_t.iter_mut().enumerate() {
            *reading += noise_t(sensor, seed, index as u64);
        }
    }
    readings_t.iter_mut().for_each(|reading| *reading = sensor.digitized_t(*reading));
    let position = |found: &Result<Located, LocateError>| Located::of(found).map(|located| located.position);
    let at_rest = position(&locator.locate(&[at_rest_t])[0]);
    let located = locator.locate(&readings_t);
    let field_at_rest_t = film.field_of_reading_t(at_rest_t);
    let branch = Branch::from_axis_field(field_at_rest_t);
    let before = branch.and_then(|branch| Parameters::from_field(field_at_rest_t, branch));
    let step = |((displacement, reading_t), found): ((&DVec3, DVec3), Result<Located, LocateError>)| {
        let parameters = branch.and_then(|branch| Parameters::from_field(film.field_of_reading_t(reading_t), branch));
        let closed = || Some(-parameters?.displacement_from(&before?, settings.wavenumber?));
        let by_field = at_rest.zip(position(&found)).map(|(at_rest, position)| at_rest - position);
        ExperimentStep {
            displacement: *displacement,
            reading_t,
            parameters,
            by_closed_form: closed(),
            by_field,
            is_saturated: sensor.is_saturated(reading_t),
        }
    };
    Ok(displacements.iter().zip(readings_t).zip(located).map(step).collect())
}

/// The noise of one reading, from its own random stream, independent of other readings.
fn noise_t(sensor: &HallSensor, seed: u64, index: u64) -> DVec3 {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(index);
    sensor.noise_t * DVec3::from([(); 3].map(|()| normal(&mut random)))
}

/// A normal deviate of standard deviation 1 (Box and Muller 1958).
fn normal(random: &mut ChaCha8Rng) -> f64 {
    // From above 0 to 1.
    let (radius, turn) = (1.0 - random.random::<f64>(), random.random::<f64>());
    (-2.0 * radius.ln()).sqrt() * (std::f64::consts::TAU * turn).cos()
}
