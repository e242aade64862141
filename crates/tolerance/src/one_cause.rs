//! The errors of one cause alone.

use magsplice_layout::{CommonErrors, Distribution, FilmTolerance, TileErrors};
use magsplice_magnet::TileError;

use crate::first_order::Cause;

/// Copies the errors of one cause.
type CopyOne = fn(&CommonErrors, &mut CommonErrors);

/// Each cause that has errors, with a tolerance that contains only these errors.
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
    let common: [(Cause, CopyOne); 8] = [
        (Cause::FilmPose, |all, alone| alone.film = all.film.clone()),
        (Cause::StrayField, |all, alone| alone.stray_field = all.stray_field.clone()),
        (Cause::Neighbour, |all, alone| alone.neighbour = all.neighbour.clone()),
        (Cause::Temperature, |all, alone| alone.temperature = all.temperature.clone()),
        (Cause::SensorOffset, |all, alone| alone.sensor.offset_t = all.sensor.offset_t.clone()),
        (Cause::SensorRotation, |all, alone| alone.sensor.rotation_rad = all.sensor.rotation_rad.clone()),
        (Cause::SensorGain, |all, alone| alone.sensor.gain = all.sensor.gain.clone()),
        (Cause::SensorNoise, |all, alone| alone.sensor.noise_t = all.sensor.noise_t.clone()),
    ];
    for (cause, take) in common {
        let mut alone = FilmTolerance::default();
        take(&all.common, &mut alone.common);
        if alone.common != CommonErrors::default() {
            found.push((cause, alone));
        }
    }
    found
}
