//! Readings of a Hall sensor with plates, errors and limits, and positions from them.

use glam::{DQuat, DVec3};
use magsplice_field::Scene;
use magsplice_layout::Layout;
use magsplice_magnet::{Grid, HallSensor, Quantity};
use magsplice_sensor::{LocateError, Locator, SensedField, SensedFieldError};

fn film() -> (Scene, Grid) {
    let layout = Layout::read("../../layouts/published-film.toml").unwrap_or_else(|e| panic!("{e}"));
    (Scene::new(&layout.bare_tiles()), layout.volume.expect("a volume").grid)
}

fn sensor() -> HallSensor {
    HallSensor {
        plates: [DVec3::new(0.1, 0.0, -0.05), DVec3::new(-0.1, 0.05, 0.0), DVec3::new(0.0, 0.0, 0.1)],
        active_area: [0.4, 0.2],
        rotation: DQuat::from_scaled_axis(DVec3::new(0.1, -0.2, 0.3)),
        gain: DVec3::new(1.02, 0.97, 1.1),
        offset_t: DVec3::new(1e-4, -2e-4, 3e-4),
        ..HallSensor::default()
    }
}

const PLACES: [DVec3; 3] = [DVec3::new(0.3, -0.4, -4.0), DVec3::new(-1.7, 1.2, -3.2), DVec3::new(1.9, 1.9, -5.0)];

/// Simpson's rule on 24 x 24 intervals: its error is (side / 24)^4 / 180 times the fourth
/// derivative, k^4 times the field, so below 1e-10 of the field.
fn reading_by_simpson(scene: &Scene, sensor: &HallSensor, position: DVec3) -> DVec3 {
    const INTERVALS: usize = 24;
    let weight = |index: usize| match index {
        0 | INTERVALS => 1.0,
        odd if odd % 2 == 1 => 4.0,
        _ => 2.0,
    };
    let coordinate = |side: f64, index: usize| side * (index as f64 / INTERVALS as f64 - 0.5);
    DVec3::from([0, 1, 2].map(|axis| {
        let (mut sum, mut weights) = (DVec3::ZERO, 0.0);
        for i in 0..=INTERVALS {
            for j in 0..=INTERVALS {
                let [width, height] = sensor.active_area;
                let within = DVec3::new(coordinate(width, i), coordinate(height, j), 0.0);
                let place = position + sensor.rotation * (sensor.plates[axis] + within);
                let w = weight(i) * weight(j);
                sum += w * scene.field(Quantity::FluxDensity, place).unwrap();
                weights += w;
            }
        }
        let along = sensor.rotation.inverse() * (sum / weights);
        sensor.gain[axis] * along[axis] + sensor.offset_t[axis]
    }))
}

#[test]
fn readings_are_means_over_the_plates() {
    let (scene, grid) = film();
    let sensed = SensedField::new(&scene, sensor(), &grid).unwrap();
    assert!(sensed.averaging_error_t() < 1e-10 && sensed.nodes_per_side() > 1, "{}", sensed.averaging_error_t());
    let found = sensed.readings_t(&PLACES).unwrap();
    for (place, reading) in PLACES.into_iter().zip(found) {
        let error = (reading - reading_by_simpson(&scene, &sensor(), place)).abs().max_element();
        assert!(error < 1.1 * sensed.averaging_error_t() + 1e-12, "{place}: {error:e} T");
    }
    // The reading of a point at the centre differs by more than noise.
    let point = HallSensor { active_area: [0.0; 2], ..sensor() };
    let of_point = SensedField::new(&scene, point, &grid).unwrap().readings_t(&PLACES).unwrap();
    let changes = of_point
        .iter()
        .zip(PLACES)
        .map(|(reading, place)| (*reading - reading_by_simpson(&scene, &sensor(), place)).length());
    assert!(changes.fold(0.0, f64::max) > 1e-6);
}

/// The error of differences over 1e-4 mm is the third derivative, 1e-8 k^2 / 6 of the gradient,
/// plus the round-off of B, 1e-16 / 1e-4 T/mm.
#[test]
fn gradients_are_differences_of_readings() {
    let (scene, grid) = film();
    let sensed = SensedField::new(&scene, sensor(), &grid).unwrap();
    let gradients = sensed.gradients(&PLACES).unwrap();
    let (_, both) = sensed.readings_and_gradients(&PLACES);
    assert_eq!(gradients, both);
    for (place, gradient) in PLACES.into_iter().zip(gradients) {
        for (axis, unit) in DVec3::AXES.into_iter().enumerate() {
            let ends = sensed.readings_t(&[place + 1e-4 * unit, place - 1e-4 * unit]).unwrap();
            let difference = (ends[0] - ends[1]) / 2e-4;
            assert!((difference - gradient.col(axis)).length() < 1e-10, "{place}, {axis}");
        }
    }
}

#[test]
fn perfect_sensor_reads_the_flux_density() {
    let (scene, grid) = film();
    let field_t = scene.field_at(Quantity::FluxDensity, &PLACES).unwrap();
    for sensed in [SensedField::from(&scene), SensedField::new(&scene, HallSensor::default(), &grid).unwrap()] {
        assert_eq!(sensed.readings_t(&PLACES).unwrap(), field_t);
    }
    let sensed = SensedField::new(&scene, sensor(), &grid).unwrap();
    let reading = sensor().gain * (sensor().rotation.inverse() * field_t[0]) + sensor().offset_t;
    assert!((sensed.field_of_reading_t(reading) - field_t[0]).length() < 1e-17);
}

/// Positions are exact as for a perfect sensor, because readings and searches use the same model of
/// the sensor.
#[test]
fn positions_are_found_from_readings_of_any_sensor() {
    let (scene, grid) = film();
    let sensed = SensedField::new(&scene, sensor(), &grid).unwrap();
    let points: Vec<DVec3> = grid.points().filter(|point| point.abs().max_element() < 4.6).collect();
    let constant_t = DVec3::new(3e-5, -2e-5, 4e-5);
    let readings: Vec<DVec3> = sensed.readings_t(&points).unwrap().into_iter().map(|b| b + constant_t).collect();
    let locator = Locator::new(sensed, grid).unwrap().with_constant_reading(constant_t);
    for (point, found) in points.iter().zip(locator.locate(&readings)) {
        let error = found.unwrap_or_else(|e| panic!("{point}: {e}")).position.distance(*point);
        assert!(error < 1e-9, "{point}: {error:e} mm");
    }
}

#[test]
fn saturated_readings_have_no_position() {
    let (scene, grid) = film();
    let weak = HallSensor { range_t: DVec3::splat(2e-3), count_t: DVec3::splat(1e-6), ..HallSensor::default() };
    let sensed = SensedField::new(&scene, weak, &grid).unwrap();
    let readings = sensed.readings_t(&[DVec3::new(0.5, 0.5, -3.0), DVec3::new(2.0, 2.0, -5.0)]).unwrap();
    let digitized: Vec<DVec3> = readings.iter().map(|reading| weak.digitized_t(*reading)).collect();
    assert!(readings[0].abs().max_element() > 2e-3 && readings[1].abs().max_element() < 2e-3);
    let found = Locator::new(sensed, grid).unwrap().locate(&digitized);
    assert_eq!(found[0], Err(LocateError::Saturated));
    // Half a count over the gradient, 5e-7 T over 1e-4 T/mm.
    assert!(found[1].as_ref().unwrap().position.distance(DVec3::new(2.0, 2.0, -5.0)) < 0.01);
}

#[test]
fn areas_over_which_the_field_changes_too_much_are_refused() {
    let (scene, grid) = film();
    let wide = HallSensor { active_area: [30.0, 30.0], ..HallSensor::default() };
    let Err(SensedFieldError::ActiveArea { difference_t }) = SensedField::new(&scene, wide, &grid) else {
        panic!("30 mm are three wavelengths");
    };
    assert!(difference_t > 1e-7, "{difference_t}");
}
