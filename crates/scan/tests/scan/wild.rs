//! Scans with wild, saturated and missing readings, and with exchanged axes: the fit is the fit of
//! the clean scan within its deviations, and no tile of a right film is reported.

use glam::{DQuat, DVec3};
use magsplice_field::Scene;
use magsplice_layout::Layout;
use magsplice_magnet::{HallSensor, Quantity};
use magsplice_scan::{
    Candidate, DiagnosisSettings, ErrorKind, Exclusion, FreeParameters, ScanFit, ScanParameter, ScanParameters,
    SignedAxes, fit_scan,
};
use magsplice_sensor::SensedField;
use rand::seq::index::sample;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::damage::{make_wild, truth};
use crate::diagnosis::{NOISE_T, candidates, changed, film, made_faulty, model, points};
use crate::noisy::{normal, readings};

/// A published film with the points of its volume.
struct Scanned {
    scene: Scene,
    points: Vec<DVec3>,
    centre: DVec3,
}

fn scanned() -> Scanned {
    let layout = Layout::read("../../layouts/published-film.toml").unwrap_or_else(|e| panic!("{e}"));
    let volume = layout.volume.as_ref().expect("a volume");
    let centre = 0.5 * (volume.lower_mm + volume.upper_mm);
    Scanned { scene: Scene::new(&layout.bare_tiles()), points: volume.grid.points().collect(), centre }
}

impl Scanned {
    /// Readings with these parameters and 5 uT of noise.
    fn readings_t(&self, truth: &ScanParameters, random: &mut ChaCha8Rng) -> Vec<DVec3> {
        let places: Vec<DVec3> = self.points.iter().map(|point| *point + truth.start).collect();
        let field_t = self.scene.field_at(Quantity::FluxDensity, &places).unwrap();
        field_t.iter().map(|b| truth.reading_t(*b) + 5e-6 * DVec3::from([(); 3].map(|()| normal(random)))).collect()
    }

    fn fit(&self, points: &[DVec3], readings_t: &[DVec3]) -> ScanFit {
        fit_scan(&self.scene, points, readings_t, FreeParameters::ALL, Some(self.centre)).unwrap()
    }
}

/// Every parameter within five deviations. Of a million normal errors, one is larger.
fn assert_fitted(fit: &ScanFit, truth: &ScanParameters, what: &str) {
    for parameter in ScanParameter::ALL {
        let (found, deviation) = (fit.parameters.get(parameter), fit.deviations.get(parameter));
        assert!(
            (found - truth.get(parameter)).abs() < 5.0 * deviation,
            "{what}: {parameter} is {found} +- {deviation}"
        );
    }
}

#[test]
fn wild_and_missing_readings_leave_the_fit_as_it_is() {
    let scanned = scanned();
    for seed in 0..100 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let truth = truth(&mut random);
        let mut readings_t = scanned.readings_t(&truth, &mut random);
        let count = random.random_range(1..=10);
        let wild = make_wild(&mut readings_t, count, &mut random);
        let missing = random.random_range(0..readings_t.len());
        readings_t[missing].x = f64::NAN;
        let fit = scanned.fit(&scanned.points, &readings_t);
        assert_fitted(&fit, &truth, &format!("scan {seed}"));
        for (index, exclusion) in fit.exclusions.iter().enumerate() {
            let expected = match index {
                index if index == missing => Some(Exclusion::Incomplete),
                index => wild.contains(&index).then_some(Exclusion::Outlier),
            };
            assert_eq!(*exclusion, expected, "scan {seed}, reading {index}");
        }
    }
}

#[test]
fn saturated_readings_are_censored() {
    let Scanned { scene, centre, .. } = scanned();
    let layout = Layout::read("../../layouts/published-film.toml").unwrap_or_else(|e| panic!("{e}"));
    let grid = layout.volume.expect("a volume").grid;
    let points: Vec<DVec3> =
        (0..361).map(|n| DVec3::new(f64::from(n % 19) - 9.0, f64::from(n / 19) - 9.0, -3.0)).collect();
    let range_t = DVec3::new(4e-3, 4e-3, 4e-3);
    let sensor = HallSensor { range_t, noise_t: DVec3::splat(5e-6), ..HallSensor::default() };
    let sensed = SensedField::new(&scene, sensor, &grid).unwrap();
    for seed in 0..20 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let truth = truth(&mut random);
        let places: Vec<DVec3> = points.iter().map(|point| *point + truth.start).collect();
        let field_t = scene.field_at(Quantity::FluxDensity, &places).unwrap();
        let readings_t: Vec<DVec3> = field_t
            .iter()
            .map(|b| {
                sensor.digitized_t(truth.reading_t(*b) + 5e-6 * DVec3::from([(); 3].map(|()| normal(&mut random))))
            })
            .collect();
        let saturated = readings_t.iter().filter(|reading| sensor.is_saturated(**reading)).count();
        assert!(saturated > 20, "{saturated} of scan {seed}");
        let fit = fit_scan(sensed.clone(), &points, &readings_t, FreeParameters::ALL, Some(centre)).unwrap();
        assert_fitted(&fit, &truth, &format!("scan {seed}"));
        let excluded: Vec<Exclusion> = fit.exclusions.iter().copied().flatten().collect();
        assert_eq!(excluded, vec![Exclusion::Saturated; saturated], "scan {seed}");
    }
}

/// Exchanges of the axes of the sensor, every third of the 48, and of the stage are found and
/// reported: as a rotation where it is one.
#[test]
fn exchanged_axes_are_found() {
    let scanned = scanned();
    let mut random = ChaCha8Rng::seed_from_u64(3);
    for (number, axes) in SignedAxes::all().into_iter().step_by(3).enumerate() {
        let truth = truth(&mut random);
        let readings_t = scanned.readings_t(&truth, &mut random);
        let turned: Vec<DVec3> = readings_t.iter().map(|reading| axes.apply(*reading)).collect();
        let fit = scanned.fit(&scanned.points, &turned);
        assert!(fit.noise_t < 5.5e-6, "{axes} of the sensor: {:?} {}", fit.parameters, fit.noise_t);
        assert_eq!(fit.stage_axes, SignedAxes::SAME, "{axes} of the sensor");
        assert_eq!(
            fit.sensor_axes.is_rotation(),
            axes.is_rotation(),
            "{axes} of the sensor: {:?} {:?} {:?}",
            fit.parameters,
            truth,
            fit.sensor_axes
        );
        // The field that is read is the same, whatever names the axes have.
        for (reading, exchanged) in readings_t.iter().zip(&turned).step_by(40) {
            let difference = fit.corrected_t(*exchanged) - truth.corrected_t(*reading);
            assert!(difference.length() < 2e-5, "{axes} of the sensor: {difference}");
        }
        if number % 3 != 0 {
            continue;
        }
        let stage: Vec<DVec3> = scanned.points.iter().map(|point| axes.inverse().apply(*point)).collect();
        let fit = scanned.fit(&stage, &readings_t);
        assert!(fit.noise_t < 5.5e-6, "{axes} of the stage: {:?} {}", fit.parameters, fit.noise_t);
    }
}

/// The stage counts from anywhere, and the sensor is turned.
#[test]
fn scans_in_coordinates_of_a_stage_are_found() {
    let scanned = scanned();
    for seed in 0..4 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let truth = truth(&mut random);
        let readings_t = scanned.readings_t(&truth, &mut random);
        let home = DVec3::from([(); 3].map(|()| random.random_range(-200.0..200.0)));
        let stage: Vec<DVec3> = scanned.points.iter().map(|point| *point + home).collect();
        let half_turn = DQuat::from_rotation_z(std::f64::consts::PI);
        let turned: Vec<DVec3> = readings_t.iter().map(|reading| half_turn * *reading).collect();
        let fit = scanned.fit(&stage, &turned);
        assert!(fit.noise_t < 5.5e-6, "scan {seed}: {:?}", fit.parameters);
        let half_turned = DQuat::from_scaled_axis(truth.rotation_rad) * half_turn.inverse();
        let expected = ScanParameters {
            start: truth.start - home,
            rotation_rad: half_turned.to_scaled_axis(),
            offset_t: half_turn * truth.offset_t,
            ..truth
        };
        // The rotation vectors of almost half a turn may have either sign.
        let signed = ScanParameters { rotation_rad: fit.parameters.rotation_rad, ..expected };
        assert_fitted(&fit, &signed, &format!("scan {seed}"));
        let turn = DQuat::from_scaled_axis(fit.parameters.rotation_rad).angle_between(half_turned);
        assert!(turn < 0.01, "scan {seed}: {turn} rad from {half_turned}");
    }
}

/// A single spike of 2 mT, 200 times the noise, and up to ten wild readings of any size: no tile of
/// the film as ordered is reported in more than 2 of 100 scans.
#[test]
fn wild_readings_are_no_faulty_tiles() {
    let model = model(DiagnosisSettings::default());
    let (mut false_alarms, scans) = (0, 20);
    for seed in 0..scans {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut readings_t = readings(&film(), &points(), NOISE_T, &mut random);
        let count = random.random_range(1..=10);
        let wild = make_wild(&mut readings_t, count, &mut random);
        let found = model.diagnose(&readings_t, |_| {}).unwrap();
        let excluded: Vec<usize> = (0..441).filter(|index| found.exclusions[*index].is_some()).collect();
        assert_eq!(excluded, wild, "scan {seed}");
        assert!(!found.is_residual_too_large(), "scan {seed}");
        false_alarms += usize::from(!found.detected.is_empty());
    }
    assert!(false_alarms as f64 <= 0.05 * scans as f64, "{false_alarms} of {scans}");
}

#[test]
fn faulty_tiles_are_found_beside_wild_readings() {
    let model = model(DiagnosisSettings::default());
    for seed in 0..10 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut tiles = film();
        let mut faulty = made_faulty(&mut tiles, &mut random);
        faulty.sort_by_key(|candidate| (candidate.tile, candidate.kind));
        let mut readings_t = readings(&tiles, &points(), NOISE_T, &mut random);
        let clean = model.diagnose(&readings_t, |_| {}).unwrap();
        let wild = make_wild(&mut readings_t, 5, &mut random);
        let found = model.diagnose(&readings_t, |_| {}).unwrap();
        assert_eq!(candidates(&found), candidates(&clean), "scan {seed}");
        assert!(wild.iter().all(|index| found.exclusions[*index].is_some()), "scan {seed}");
    }
}

/// A wild reading may explain less than the faulty tile beside it: the search is not given up for
/// what the wild readings leave.
#[test]
fn a_reversed_and_a_displaced_tile_are_found_beside_ten_wild_readings() {
    let model = model(DiagnosisSettings { most_errors: 4, ..DiagnosisSettings::default() });
    let mut tiles = film();
    tiles[22] = changed(&tiles[22], 0.0, -1.0, DVec3::ZERO);
    tiles[34] = changed(&tiles[34], 0.0, 1.0, DVec3::new(0.1, 0.0, 0.0));
    let faulty = [(22, ErrorKind::Strength), (34, ErrorKind::Displacement)];
    for seed in 0..10 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut readings_t = readings(&tiles, &points(), NOISE_T, &mut random);
        for index in sample(&mut random, readings_t.len(), 10) {
            let size_t = 10.0_f64.powf(random.random_range(-3.3..-1.5));
            readings_t[index][random.random_range(0..3)] += if random.random() { size_t } else { -size_t };
        }
        let found = model.diagnose(&readings_t, |_| {}).unwrap();
        assert_eq!(candidates(&found), faulty.map(|(tile, kind)| Candidate { tile, kind }), "scan {seed}");
        assert!(!found.is_residual_too_large(), "scan {seed}");
    }
}
