//! Gains that differ from axis to axis and an offset that drifts are found, and no other.

use glam::DVec3;
use magsplice_field::Scene;
use magsplice_layout::{FilmTolerance, Preset};
use magsplice_magnet::Quantity;
use magsplice_scan::{FreeParameters, ScanParameters, SensorFault, fit_scan};
use magsplice_sensor::SensedField;
use magsplice_tolerance::RealFilm;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::damage::truth;
use crate::diagnosis::{NOISE_T, film};
use crate::noisy::normal;

/// Every millimetre, 3 mm below a film of 20 mm.
fn points() -> Vec<DVec3> {
    (0..441).map(|n| DVec3::new(f64::from(n % 21) - 10.0, f64::from(n / 21) - 10.0, -3.0)).collect()
}

fn readings(scene: &Scene, truth: &ScanParameters, random: &mut ChaCha8Rng) -> Vec<DVec3> {
    let places: Vec<DVec3> = points().iter().map(|point| *point + truth.start).collect();
    let field_t = scene.field_at(Quantity::FluxDensity, &places).unwrap();
    field_t.iter().map(|b| truth.reading_t(*b) + NOISE_T * DVec3::from([(); 3].map(|()| normal(random)))).collect()
}

fn fault(readings_t: &[DVec3]) -> Option<SensorFault> {
    let scene = Scene::new(&film());
    let field = SensedField::from(&scene);
    let free = FreeParameters::HELD_STRENGTH;
    let fit = fit_scan(field.clone(), &points(), readings_t, free, None).unwrap();
    SensorFault::of_scan(&field, &points(), readings_t, &fit, free)
}

#[test]
fn gains_and_drifts_are_found() {
    let scene = Scene::new(&film());
    for seed in 0..5 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let truth = ScanParameters { strength: 1.0, ..truth(&mut random) };
        let readings_t = readings(&scene, &truth, &mut random);
        assert_eq!(fault(&readings_t), None, "scan {seed}");
        let scaled: Vec<DVec3> = readings_t.iter().map(|reading_t| *reading_t * DVec3::new(1.0, 0.95, 1.1)).collect();
        let Some(SensorFault::Gains { gains, residual_t }) = fault(&scaled) else { panic!("scan {seed}: no gains") };
        assert!((gains - DVec3::new(1.0, 0.95, 1.1)).abs().max_element() < 2e-3, "scan {seed}: {gains}");
        assert!(residual_t < 1.1 * 1.1 * NOISE_T, "scan {seed}: {residual_t}");
        let drift_t = DVec3::new(2e-4, -3e-4, 1e-4);
        let drifted: Vec<DVec3> =
            (0..441).zip(&readings_t).map(|(time, reading_t)| *reading_t + f64::from(time) / 440.0 * drift_t).collect();
        let Some(SensorFault::Drift { drift_t: found_t, residual_t }) = fault(&drifted) else {
            panic!("scan {seed}: no drift")
        };
        assert!((found_t - drift_t).abs().max_element() < NOISE_T, "scan {seed}: {found_t}");
        assert!(residual_t < 1.1 * NOISE_T, "scan {seed}: {residual_t}");
    }
}

/// Errors of the tiles of a film made by hand look like neither.
#[test]
fn errors_of_tiles_are_no_faults_of_the_sensor() {
    let expected = FilmTolerance::of_tiles(&Preset::ByHand.errors(), film().len());
    for seed in 0..10 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let truth = ScanParameters { strength: 1.0, ..truth(&mut random) };
        let made = RealFilm::new(&film(), &expected).sample_tiles(seed, 0).unwrap_or_else(|e| panic!("{e}"));
        let readings_t = readings(&Scene::new(&made), &truth, &mut random);
        assert_eq!(fault(&readings_t), None, "film {seed}");
    }
}
