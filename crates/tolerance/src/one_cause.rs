//! The errors of one cause alone.

use magsplice_layout::{CommonErrors, Distribution, FilmTolerance, SensorErrors, TileErrors};
use magsplice_magnet::TileError;

use crate::first_order::Cause;

/// Each cause that has errors, with a tolerance of these alone.
pub(crate) fn each_alone(all: &FilmTolerance) -> Vec<(Cause, FilmTolerance)> {
    let mut of_tiles = TileError::ALL.map(Cause::from).to_vec();
    of_tiles.dedup();
    let mut found = Vec::new();
    for cause in of_tiles {
        let only = |errors: &TileErrors| {
            TileErrors::from_fn(|error| match Cause::from(error) == cause {
                true => errors[error].clone(),
                false => Distribution::NONE,
            })
        };
        let tiles: Vec<TileErrors> = all.tiles.iter().map(only).collect();
        if tiles.iter().any(|errors| *errors != TileErrors::default()) {
            found.push((cause, FilmTolerance { tiles, ..FilmTolerance::default() }));
        }
    }
    for (index, group) in all.groups.iter().enumerate() {
        found.push((Cause::Group(index), FilmTolerance { groups: vec![group.clone()], ..FilmTolerance::default() }));
    }
    let CommonErrors { film, stray_field, neighbour, temperature, sensor } = &all.common;
    let none = CommonErrors::default();
    let no_sensor = SensorErrors::default();
    let of_sensor = |sensor: SensorErrors| CommonErrors { sensor, ..CommonErrors::default() };
    let common = [
        (Cause::FilmPose, CommonErrors { film: film.clone(), ..none.clone() }),
        (Cause::StrayField, CommonErrors { stray_field: stray_field.clone(), ..none.clone() }),
        (Cause::Neighbour, CommonErrors { neighbour: neighbour.clone(), ..none.clone() }),
        (Cause::Temperature, CommonErrors { temperature: temperature.clone(), ..none.clone() }),
        (Cause::SensorOffset, of_sensor(SensorErrors { offset_t: sensor.offset_t.clone(), ..no_sensor.clone() })),
        (
            Cause::SensorRotation,
            of_sensor(SensorErrors { rotation_rad: sensor.rotation_rad.clone(), ..no_sensor.clone() }),
        ),
        (Cause::SensorGain, of_sensor(SensorErrors { gain: sensor.gain.clone(), ..no_sensor.clone() })),
        (Cause::SensorNoise, of_sensor(SensorErrors { noise_t: sensor.noise_t.clone(), ..no_sensor })),
    ];
    for (cause, common) in common {
        if common != none {
            found.push((cause, FilmTolerance { common, ..FilmTolerance::default() }));
        }
    }
    found
}
