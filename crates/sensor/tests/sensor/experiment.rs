//! Experiments: the displacements, and the results of the sensor.

use glam::{DQuat, DVec3};
use magsplice_field::Scene;
use magsplice_layout::Layout;
use magsplice_magnet::{Deformation, Grid, HallSensor};
use magsplice_sensor::{ExperimentSettings, Locator, SensedField, displacements, experiment};

const REFERENCE: DVec3 = DVec3::new(0.0, 0.0, -5.0);

fn film() -> (Layout, Grid, ExperimentSettings) {
    let layout = Layout::read("../../layouts/published-film.toml").unwrap_or_else(|e| panic!("{e}"));
    let wavenumber = Some(layout.ideal.unwrap().wavenumber());
    let grid = layout.volume.expect("a volume").grid;
    (layout, grid, ExperimentSettings { reference: REFERENCE, wavenumber, seed: None })
}

#[test]
fn sensor_stays_in_the_volume() {
    let (_, grid, _) = film();
    let shear: Vec<f64> = displacements(&grid, REFERENCE, 0, 0.5).iter().map(|moved| moved.x).collect();
    assert_eq!(shear, [-2.0, -1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5, 2.0]);
    // The film approaches: it moves downwards.
    let normal: Vec<f64> = displacements(&grid, REFERENCE, 2, 1.0).iter().map(|moved| moved.z).collect();
    assert_eq!(normal, [-2.0, -1.0, 0.0]);
    // Twenty steps of 0.1 mm reach the end, though 20 x 0.1 is not 2 by round-off.
    assert_eq!(displacements(&grid, REFERENCE, 1, 0.1).len(), 41);
}

#[test]
fn field_tells_the_displacement_and_the_closed_form_nearly() {
    let (layout, grid, settings) = film();
    let scene = Scene::new(&layout.bare_tiles());
    let sensor = HallSensor {
        plates: [DVec3::new(0.1, 0.0, 0.0), DVec3::ZERO, DVec3::new(0.0, 0.1, 0.05)],
        rotation: DQuat::from_rotation_z(0.02),
        offset_t: DVec3::new(1e-4, 0.0, -1e-4),
        ..HallSensor::default()
    };
    let sensed = SensedField::new(&scene, sensor, &grid).unwrap();
    let locator = Locator::new(sensed.clone(), grid).unwrap();
    let moved = displacements(&grid, REFERENCE, 0, 0.5);
    let steps = experiment(&sensed, &locator, &moved, &settings).unwrap();
    for (step, moved) in steps.iter().zip(&moved) {
        assert!((step.by_field.unwrap() - *moved).length() < 1e-9, "{step:?}");
        // The error of the published film is 0.25 mm RMS over the volume, and 0.8 mm at the ends of
        // its lowest line.
        assert!((step.by_closed_form.unwrap() - *moved).length() < 0.9, "{step:?}");
        assert!(!step.is_saturated);
    }
    // At rest the closed form is exact by definition.
    assert!(steps[4].by_closed_form.unwrap().length() < 1e-14);
}

/// Each reading has its own noise: another seed gives other noise, with the standard deviation of
/// the sensor.
#[test]
fn noise_and_rounding_are_those_of_the_sensor() {
    let (layout, grid, settings) = film();
    let scene = Scene::new(&layout.bare_tiles());
    let sensor =
        HallSensor { noise_t: DVec3::new(1e-6, 2e-6, 4e-6), count_t: DVec3::splat(1e-8), ..HallSensor::default() };
    let sensed = SensedField::new(&scene, sensor, &grid).unwrap();
    let moved = vec![DVec3::ZERO; 4000];
    let run = |seed| {
        let locator = Locator::new(sensed.clone(), grid).unwrap();
        experiment(&sensed, &locator, &moved, &ExperimentSettings { seed, ..settings }).unwrap()
    };
    let exact = run(None)[0].reading_t;
    let noisy = run(Some(1));
    let squares: DVec3 = noisy.iter().map(|step| (step.reading_t - exact).powf(2.0)).sum();
    // Four standard errors of a deviation from 4000 samples.
    let ratio = (squares / 4000.0).powf(0.5) / sensor.noise_t;
    assert!((ratio - 1.0).abs().max_element() < 0.045, "{ratio}");
    assert_eq!(run(Some(1)), noisy);
    assert_ne!(run(Some(2))[0].reading_t, noisy[0].reading_t);
    let counts = noisy[7].reading_t / 1e-8;
    assert!((counts - counts.round()).abs().max_element() < 1e-6, "{counts}");
}

/// Readings of a tilted film differ. Displacements count from its apparent position at rest.
#[test]
fn another_film_than_the_ordered_one_shifts_the_displacements() {
    let (layout, grid, settings) = film();
    let ordered = Scene::new(&layout.bare_tiles());
    let tilt = Deformation { rotation_rad: DVec3::new(0.0, 0.02, 0.0), ..Deformation::default() };
    let real = Scene::new(&tilt.apply(&layout.bare_tiles()).unwrap());
    let locator = Locator::new(&ordered, grid).unwrap();
    let moved = displacements(&grid, REFERENCE, 2, 0.5);
    let steps = experiment(&SensedField::from(&real), &locator, &moved, &settings).unwrap();
    let errors: Vec<f64> =
        steps.iter().zip(&moved).map(|(step, moved)| (step.by_field.unwrap() - *moved).length()).collect();
    assert!(errors.last().unwrap() < &1e-9, "{errors:?}");
    assert!(errors[0] > 1e-4 && errors[0] < 0.1, "{errors:?}");
    // A shifted film gives the same displacements.
    let elsewhere = Deformation { shift: DVec3::new(0.1, -0.05, 0.2), ..Deformation::default() };
    let real = Scene::new(&elsewhere.apply(&layout.bare_tiles()).unwrap());
    let steps = experiment(&SensedField::from(&real), &locator, &moved, &settings).unwrap();
    for (step, moved) in steps.iter().zip(&moved) {
        assert!((step.by_field.unwrap() - *moved).length() < 1e-9, "{step:?}");
    }
}
