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
    let common: [(Cause, CopyOne); 10] = [
        (Cause::FilmPose, |all, alone| alone.film = all.film.clone()),
        (Cause::StrayField, |all, alone| alone.stray_field = all.stray_field.clone()),
        (Cause::Neighbour, |all, alone| alone.neighbour = all.neighbour.clone()),
        (Cause::Iron, |all, alone| alone.iron = all.iron.clone()),
        (Cause::Temperature, |all, alone| alone.temperature = all.temperature.clone()),
        (Cause::SensorOffset, |all, alone| alone.sensor.offset_t = all.sensor.offset_t.clone()),
        (Cause::SensorRotation, |all, alone| alone.sensor.rotation_rad = all.sensor.rotation_rad.clone()),
        (Cause::SensorGain, |all, alone| alone.sensor.gain = all.sensor.gain.clone()),
        (Cause::SensorPosition, |all, alone| alone.sensor.position_mm = all.sensor.position_mm.clone()),
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

#[cfg(test)]
mod tests {
    use magsplice_layout::ErrorGroup;
    use magsplice_magnet::Axis;

    use super::*;

    /// Errors of tiles, of a group and of the sensor: each cause keeps its own, for all tiles, and
    /// has no others.
    #[test]
    fn each_cause_has_its_errors_alone() {
        let position = TileErrors { position: [0.1, 0.2, 0.0].map(Distribution::normal), ..TileErrors::default() };
        let strength = TileErrors { strength: Distribution::normal(0.02), ..TileErrors::default() };
        let both = TileErrors { strength: strength.strength.clone(), ..position.clone() };
        let group = ErrorGroup { name: "row".to_owned(), tiles: vec![0], errors: position.clone() };
        let mut all = FilmTolerance { groups: vec![group.clone()], ..FilmTolerance::of_tiles(&both, 2) };
        all.common.sensor.noise_t = [1e-6; 3].map(Distribution::normal);
        let noise = FilmTolerance { common: all.common.clone(), ..FilmTolerance::default() };
        let expected = [
            (Cause::from(TileError::Position(Axis::X)), FilmTolerance::of_tiles(&position, 2)),
            (Cause::from(TileError::Strength), FilmTolerance::of_tiles(&strength, 2)),
            (Cause::Group(0), FilmTolerance { groups: vec![group], ..FilmTolerance::default() }),
            (Cause::SensorNoise, noise),
        ];
        assert_eq!(each_alone(&all), expected);
    }
}
