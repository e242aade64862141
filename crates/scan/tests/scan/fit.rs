//! Scans with known parameters: the fit recovers them to the reported accuracy.

use glam::{DQuat, DVec3};
use magsplice_field::Scene;
use magsplice_layout::{FilmTolerance, Layout, Preset};
use magsplice_magnet::{HallSensor, Quantity};
use magsplice_scan::{FreeParameters, ScanError, ScanParameter, ScanParameters, fit_determined, fit_scan};
use magsplice_sensor::SensedField;
use magsplice_tolerance::RealFilm;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::noisy::{normal, readings};

fn film() -> (Scene, Vec<DVec3>) {
    let layout = Layout::read("../../layouts/published-film.toml").unwrap_or_else(|e| panic!("{e}"));
    (Scene::new(&layout.bare_tiles()), layout.volume.expect("a volume").grid.points().collect())
}

const TRUTH: ScanParameters = ScanParameters {
    strength: 1.07,
    offset_t: DVec3::new(3e-5, -2e-5, 4e-5),
    rotation_rad: DVec3::new(0.02, -0.03, 0.05),
    start: DVec3::new(0.4, -0.3, 0.25),
};

/// A scan with these parameters and this noise.
fn scan(scene: &Scene, points: &[DVec3], noise_t: f64, seed: u64) -> Vec<DVec3> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let places: Vec<DVec3> = points.iter().map(|point| *point + TRUTH.start).collect();
    let field_t = scene.field_at(Quantity::FluxDensity, &places).unwrap();
    let noisy =
        |field_t: DVec3| TRUTH.reading_t(field_t) + noise_t * DVec3::from([(); 3].map(|()| normal(&mut random)));
    field_t.into_iter().map(noisy).collect()
}

fn numbers(parameters: &ScanParameters) -> Vec<f64> {
    ScanParameter::ALL.map(|parameter| parameters.get(parameter)).to_vec()
}

#[test]
fn scan_without_noise_gives_its_parameters() {
    let (scene, points) = film();
    let fit = fit_scan(&scene, &points, &scan(&scene, &points, 0.0, 1), FreeParameters::ALL, None).unwrap();
    for (found, truth) in numbers(&fit.parameters).into_iter().zip(numbers(&TRUTH)) {
        assert!((found - truth).abs() < 1e-9 * (1.0 + truth.abs()), "{found}, not {truth}");
    }
    assert!(fit.exclusions.iter().all(Option::is_none), "{:?}", fit.exclusions);
    assert!(fit.noise_t < 1e-12, "{}", fit.noise_t);
}

/// Errors over their reported deviations are normal with deviation 1: over 100 scans of 10
/// parameters their mean square is 1 within 4 sqrt(2 / 1000) = 0.18. Parameters of one scan are
/// correlated, which widens this range by less than a factor of two.
#[test]
fn parameters_scatter_as_stated() {
    let (scene, points) = film();
    let (mut squares, mut count, mut within) = (0.0, 0.0, 0.0);
    for seed in 0..100 {
        let fit = fit_scan(&scene, &points, &scan(&scene, &points, 5e-6, seed), FreeParameters::ALL, None).unwrap();
        assert!((fit.noise_t / 5e-6 - 1.0).abs() < 0.1, "{}", fit.noise_t);
        let errors = numbers(&fit.parameters).into_iter().zip(numbers(&TRUTH)).zip(numbers(&fit.deviations));
        for ((found, truth), deviation) in errors {
            let ratio = (found - truth) / deviation;
            squares += ratio * ratio;
            within += f64::from(u8::from(ratio.abs() < 1.96));
            count += 1.0;
        }
    }
    assert!((squares / count - 1.0_f64).abs() < 0.36, "{}", squares / count);
    assert!((0.9..0.99).contains(&(within / count)), "{}", within / count);
}

#[test]
fn outliers_are_excluded_and_listed() {
    let (scene, points) = film();
    let mut readings = scan(&scene, &points, 5e-6, 7);
    readings[17].y += 5e-4;
    readings[300] = DVec3::new(0.0, 0.0, 0.01);
    let fit = fit_scan(&scene, &points, &readings, FreeParameters::ALL, None).unwrap();
    let excluded: Vec<usize> = (0..points.len()).filter(|index| fit.exclusions[*index].is_some()).collect();
    assert_eq!(excluded, [17, 300]);
    for ((found, truth), deviation) in
        numbers(&fit.parameters).into_iter().zip(numbers(&TRUTH)).zip(numbers(&fit.deviations))
    {
        assert!((found - truth).abs() < 5.0 * deviation, "{found}, not {truth}");
    }
}

#[test]
fn scans_that_tell_too_little_are_refused() {
    let (scene, points) = film();
    let readings = scan(&scene, &points, 0.0, 1);
    let few = fit_scan(&scene, &points[..4], &readings[..4], FreeParameters::ALL, None).unwrap_err();
    assert_eq!(few.to_string(), "too few readings for the parameters: 4, must be at least 5");
    // One point again and again.
    let same = vec![points[100]; 20];
    let error = fit_scan(&scene, &same, &vec![readings[100]; 20], FreeParameters::ALL, None).unwrap_err();
    let ScanError::Undetermined(names) = &error else { panic!("{error}") };
    // Each parameter once, although many combinations are undetermined.
    assert!(!names.is_empty() && (1..names.len()).all(|n| !names[..n].contains(&names[n])), "{error}");
    // Readings that no pose of the sensor has.
    let other: Vec<DVec3> = readings.iter().rev().map(|reading| *reading * DVec3::new(3.0, -1.0, 0.2)).collect();
    let error = fit_scan(&scene, &points, &other, FreeParameters::ALL, None);
    assert!(error.is_err(), "{:?}", error.map(|fit| fit.parameters));
}

/// Parameters are reported up to a residual of a fifth of the readings. Normal deviates of this
/// part have no outliers.
#[test]
fn residuals_of_more_than_a_fifth_of_the_readings_are_a_misfit() {
    let (scene, points) = film();
    let exact = scan(&scene, &points, 0.0, 1);
    let squares = exact.iter().map(|reading| (*reading - TRUTH.offset_t).length_squared()).sum::<f64>();
    let rms_t = (squares / (3 * exact.len()) as f64).sqrt();
    let fit =
        |share: f64| fit_scan(&scene, &points, &scan(&scene, &points, share * rms_t, 1), FreeParameters::ALL, None);
    assert!(fit(0.15).is_ok());
    match fit(0.23) {
        // The readings contain the residual, so the ratio is 0.23 / (1 + 0.23^2)^1/2 = 0.224.
        Err(ScanError::Misfit { residual_t, reading_t }) => {
            assert!((0.21..0.24).contains(&(residual_t / reading_t)), "{residual_t} of {reading_t}");
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn parameters_that_are_not_free_stay() {
    let (scene, points) = film();
    let free = FreeParameters { strength: true, offset: true, rotation: false, start: false };
    let fit = fit_scan(&scene, &points, &scan(&scene, &points, 0.0, 1), free, None).unwrap();
    assert_eq!((fit.parameters.rotation_rad, fit.parameters.start), (DVec3::ZERO, DVec3::ZERO));
    assert_eq!((fit.deviations.rotation_rad, fit.deviations.start), (DVec3::ZERO, DVec3::ZERO));
    // The strength compensates for the fixed rotation and start. This is no noise of the sensor.
    assert!(fit.noise_t > 1e-4 && (fit.parameters.strength - 1.07).abs() < 0.3, "{:?}", fit.parameters);
}

#[test]
fn scans_by_any_sensor_give_their_parameters() {
    let layout = Layout::read("../../layouts/published-film.toml").unwrap_or_else(|e| panic!("{e}"));
    let (scene, grid) = (Scene::new(&layout.bare_tiles()), layout.volume.expect("a volume").grid);
    let sensor = HallSensor {
        plates: [DVec3::new(0.1, 0.0, -0.05), DVec3::new(-0.1, 0.05, 0.0), DVec3::new(0.0, 0.0, 0.1)],
        active_area: [0.4, 0.2],
        rotation: DQuat::from_scaled_axis(DVec3::new(0.1, -0.2, 0.3)),
        gain: DVec3::new(1.02, 0.97, 1.1),
        offset_t: DVec3::new(1e-4, -2e-4, 3e-4),
        ..HallSensor::default()
    };
    let (gain, offset_t) = (sensor.gain, sensor.offset_t);
    let sensed = SensedField::new(&scene, sensor, &grid).unwrap();
    let points: Vec<DVec3> = grid.points().collect();
    let places: Vec<DVec3> = points.iter().map(|point| *point + TRUTH.start).collect();
    let unscaled = sensed.without_gain_and_offset().readings_t(&places).unwrap();
    let readings: Vec<DVec3> = unscaled.into_iter().map(|b| gain * TRUTH.reading_t(b) + offset_t).collect();
    let fit = fit_scan(sensed, &points, &readings, FreeParameters::ALL, None).unwrap();
    assert!((fit.parameters.strength - TRUTH.strength).abs() < 1e-9);
    assert!((fit.parameters.start - TRUTH.start).length() < 1e-9, "{:?}", fit.parameters);
    assert!((fit.parameters.rotation_rad - TRUTH.rotation_rad).length() < 1e-9, "{:?}", fit.parameters);
}

/// A film as ordered tells another strength from another height, films by hand do not: their scans
/// are fitted with the strength of the layout. Twice the expected displacement of one tile is more
/// than all 56 move the film.
#[test]
fn strength_is_held_where_errors_of_tiles_look_like_it() {
    let layout = Layout::read("../../layouts/published-film.toml").unwrap_or_else(|e| panic!("{e}"));
    let volume = layout.volume.as_ref().expect("a volume");
    let centre = Some(0.5 * (volume.lower_mm + volume.upper_mm));
    let points: Vec<DVec3> = volume.grid.points().collect();
    let ordered = layout.bare_tiles();
    let scene = Scene::new(&ordered);
    let weak: Vec<DVec3> = scan(&scene, &points, 5e-6, 1);
    let (fit, free) = fit_determined(&scene, &points, &weak, centre).unwrap();
    assert_eq!(free, FreeParameters::ALL);
    assert_eq!(fit, fit_scan(&scene, &points, &weak, FreeParameters::ALL, centre).unwrap());
    let expected = FilmTolerance::of_tiles(&Preset::ByHand.errors(), ordered.len());
    for index in 0..4 {
        let made = RealFilm::new(&ordered, &expected).sample_tiles(1, index).unwrap();
        let mut random = ChaCha8Rng::seed_from_u64(index);
        let readings_t = readings(&made, &points, 5e-6, &mut random);
        let (fit, free) = fit_determined(&scene, &points, &readings_t, centre).unwrap();
        let ScanParameters { strength, start, rotation_rad, .. } = fit.parameters;
        assert_eq!((free, strength), (FreeParameters::HELD_STRENGTH, 1.0), "film {index}");
        assert!(start.length() < 0.3 && rotation_rad.length() < 0.1, "film {index}: {start} {rotation_rad}");
        // In gauss, where millitesla are stated.
        if index > 0 {
            continue;
        }
        let gauss: Vec<DVec3> = readings_t.iter().map(|reading_t| 10.0 * *reading_t).collect();
        let refused = fit_determined(&scene, &points, &gauss, centre);
        assert!(matches!(refused, Err(ScanError::ReadingUnit { unit: 0.1, .. })), "film {index}: {refused:?}");
    }
}

/// Gain and offset of a sensor change neither what is fitted nor its values. The offset is several
/// times the field, and the noise far below the residual of the film, whatever the gain.
#[test]
fn gain_and_offset_of_the_sensor_do_not_change_what_is_fitted() {
    let layout = Layout::read("../../layouts/published-film.toml").unwrap_or_else(|e| panic!("{e}"));
    let (ordered, grid) = (layout.bare_tiles(), layout.volume.expect("a volume").grid);
    let (scene, points) = (Scene::new(&ordered), grid.points().collect::<Vec<DVec3>>());
    let expected = FilmTolerance::of_tiles(&Preset::ByHand.errors(), ordered.len());
    let made = RealFilm::new(&ordered, &expected).sample_tiles(1, 0).unwrap();
    let field_t = Scene::new(&made).field_at(Quantity::FluxDensity, &points).unwrap();
    let (fit, free) = fit_determined(&scene, &points, &field_t, None).unwrap();
    assert_eq!(free, FreeParameters::HELD_STRENGTH);
    for (gain, offset_t, noise_t) in [(1.5, 0.02, 0.0), (1e-3, 0.0, 0.0), (100.0, 0.0, 5e-4)] {
        let sensor = HallSensor {
            gain: DVec3::splat(gain),
            offset_t: DVec3::splat(offset_t),
            noise_t: DVec3::splat(noise_t),
            ..HallSensor::default()
        };
        let readings_t: Vec<DVec3> = field_t.iter().map(|b| sensor.gain * *b + sensor.offset_t).collect();
        let sensed = SensedField::new(&scene, sensor, &grid).unwrap();
        let (found, found_free) = fit_determined(sensed, &points, &readings_t, None).unwrap();
        assert_eq!(found_free, free, "gain {gain}, offset {offset_t} T");
        for (found, fit) in numbers(&found.parameters).into_iter().zip(numbers(&fit.parameters)) {
            assert!((found - fit).abs() < 1e-9, "{found}, not {fit}");
        }
    }
}

/// Scans of planes 1 mm from the film, where the field changes within a millimetre: with the origin
/// at the film's corner or far away, and of the side above the film, with any origin.
#[test]
fn planes_near_the_film_are_found_from_any_origin() {
    let (scene, grid) = film();
    let lower = grid.iter().copied().reduce(DVec3::min).expect("points");
    let upper = grid.iter().copied().reduce(DVec3::max).expect("points");
    let centre = Some(0.5 * (lower + upper));
    let below: Vec<DVec3> =
        (0..361).map(|n| DVec3::new(f64::from(n % 19) - 9.0, f64::from(n / 19) - 9.0, -1.0)).collect();
    let above: Vec<DVec3> = below.iter().map(|point| *point + DVec3::new(0.0, 0.0, 3.0)).collect();
    for (points, origin) in
        [(&below, DVec3::new(10.0, 10.0, 0.0)), (&below, DVec3::new(60.0, 40.0, 12.0)), (&above, DVec3::ZERO)]
    {
        let readings_t = scan(&scene, points, 1e-5, 4);
        let moved: Vec<DVec3> = points.iter().map(|point| *point + origin).collect();
        let (fit, free) = fit_determined(&scene, &moved, &readings_t, centre).unwrap();
        assert_eq!(free, FreeParameters::ALL, "{origin}");
        let ScanParameters { strength, start, .. } = fit.parameters;
        let off = (start + origin - TRUTH.start).length();
        assert!((strength - TRUTH.strength).abs() < 1e-3 && off < 0.01, "{origin}: {strength}, {start}");
        assert!(fit.noise_t < 1.2e-5, "{origin}: {}", fit.noise_t);
    }
}
