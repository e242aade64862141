//! Heads of several sensors.

use magsplice_head::{HeadElement, SensorHead};
use magsplice_layout::{
    CommonErrors, Distribution, ErrorGroup, FilmPose, FilmTolerance, SensorErrors, StrayField, Temperature, TileErrors,
};
use magsplice_magnet::HallSensor;

use super::{everything, ideal, tiles, volume};
use crate::first_order::FirstOrder;
use crate::first_order::displacement::displacement_errors_mm;
use crate::real_film::RealFilm;
use crate::sampler::Sampler;

/// A head without symmetry, with a weight for each axis.
fn head() -> SensorHead {
    let element = |place: [f64; 3], weight: [f64; 3]| HeadElement {
        sensor: HallSensor::default(),
        place: place.into(),
        weight: weight.into(),
    };
    let elements = vec![
        element([0.2, -0.1, 0.0], [1.4, 1.5, 1.6]),
        element([-0.3, 0.4, -2.0], [-0.7, -0.9, -0.8]),
        element([1.5, 0.5, -1.0], [0.3, -0.2, 0.4]),
    ];
    SensorHead { elements }
}

/// These errors times a factor.
fn scaled(tolerance: &FilmTolerance, factor: f64) -> FilmTolerance {
    let three = |errors: &[Distribution; 3]| errors.each_ref().map(|error| error.scaled(factor));
    let of_tile = |errors: &TileErrors| errors.each_ref().map(|error| error.scaled(factor));
    let CommonErrors { film, stray_field, temperature, sensor, .. } = &tolerance.common;
    let stray_field = stray_field.as_ref().map(|field| StrayField {
        field_t: three(&field.field_t),
        any_direction_t: field.any_direction_t.scaled(factor),
        ..field.clone()
    });
    let temperature = temperature
        .as_ref()
        .map(|temperature| Temperature { change_k: temperature.change_k.scaled(factor), ..temperature.clone() });
    let common = CommonErrors {
        film: FilmPose { position_mm: three(&film.position_mm), rotation_rad: three(&film.rotation_rad) },
        stray_field,
        temperature,
        sensor: SensorErrors {
            position_mm: three(&sensor.position_mm),
            offset_t: three(&sensor.offset_t),
            rotation_rad: three(&sensor.rotation_rad),
            gain: three(&sensor.gain),
            noise_t: three(&sensor.noise_t),
        },
        ..tolerance.common.clone()
    };
    let group = |group: &ErrorGroup| ErrorGroup { errors: of_tile(&group.errors), ..group.clone() };
    FilmTolerance {
        tiles: tolerance.tiles.iter().map(of_tile).collect(),
        groups: tolerance.groups.iter().map(group).collect(),
        common,
        ..tolerance.clone()
    }
}

/// The linear samples of a head against exact ones, with errors of every kind. Second derivatives
/// are of the order of the first ones over millimetres or radians. Errors of a ten-thousandth of
/// `everything` are at most 1e-6 of either, so that a sample is wrong by about 1e-5 of its errors,
/// as the basis of the varying errors is (`OMITTED` is 1e-4).
#[test]
fn linear_samples_of_a_head_are_exact_for_small_errors() {
    for later in [false, true] {
        let film = RealFilm::new(&tiles(), &scaled(&everything(later), 1e-4)).with_head(Some(head()));
        let (volume, ideal) = (volume(), ideal());
        let model = FirstOrder::new(&film, &volume, &ideal).expect("a model");
        assert_eq!(model.terms().len(), 12 * 4 + 12 + 11 + 12 * 3 + 3);
        let sampler = Sampler::new(&film, &volume, &ideal, 5).expect("a sampler");
        for sample in 0..20 {
            let read_t = sampler.readings_of_t(sample).expect("readings");
            let exact_mm = displacement_errors_mm(sampler.points(), &read_t, &ideal).expect("errors");
            let linear_mm = model.linear_sample_mm(5, sample);
            let largest =
                |of: &[f64], from: &[f64]| of.iter().zip(from).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            let (left, all) = (largest(&exact_mm, &linear_mm), largest(&linear_mm, &model.mean_mm));
            assert!(left < 1e-3 * all, "{left} of {all}");
        }
    }
}
