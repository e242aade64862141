//! Positions, stray fields and rotations from all readings of a head.

use glam::{DMat3, DQuat, DVec3};
use magsplice_field::Scene;
use magsplice_head::{Board, SensorHead};
use magsplice_magnet::{Grid, HallSensor, Quantity};
use magsplice_sensor::{HeadFit, HeadLocator, HeadLocatorError, HeadUnknowns, LocateError, SensedField};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use statrs::distribution::{ContinuousCDF, Normal};

use crate::heads::{film, head};

/// Noise along the axes of every sensor.
const NOISE_T: DVec3 = DVec3::new(1.5e-6, 1.5e-6, 2.4e-6);

/// A place in the volume of the published film.
fn place(random: &mut ChaCha8Rng) -> DVec3 {
    DVec3::new(random.random_range(-2.0..2.0), random.random_range(-2.0..2.0), random.random_range(-5.0..-3.0))
}

/// A vector with components of at most `most`.
fn vector(random: &mut ChaCha8Rng, most: f64) -> DVec3 {
    DVec3::from([(); 3].map(|()| random.random_range(-most..most)))
}

fn noise(random: &mut ChaCha8Rng) -> DVec3 {
    NOISE_T * DVec3::from([(); 3].map(|()| Normal::standard().inverse_cdf(random.random())))
}

/// The readings of perfect sensors of a head, turned against the film, in a stray field.
fn readings_t(scene: &Scene, head: &SensorHead, at: DVec3, stray_t: DVec3, rotation: DQuat) -> Vec<DVec3> {
    let back = DMat3::from_quat(rotation.inverse());
    let reading = |of: &magsplice_head::HeadElement| {
        let b = scene.field(Quantity::FluxDensity, at + rotation * of.place).unwrap();
        of.sensor.rotation.inverse() * (back * b + stray_t)
    };
    head.elements.iter().map(reading).collect()
}

fn locator<'a>(scene: &'a Scene, head: &SensorHead, grid: &Grid, unknowns: HeadUnknowns) -> HeadLocator<'a> {
    HeadLocator::new(SensedField::of_head(scene, head, grid).unwrap(), *grid, unknowns).unwrap()
}

fn heads(sensor: HallSensor) -> [SensorHead; 3] {
    [head(Board::PairZ, 1.0, sensor), head(Board::PairXy, 5.0, sensor), head(Board::Cross, 5.0, sensor)]
}

/// The error is the bound of the exact field, 1e-14 of 0.1 T, over its gradient, 1e-3 T / mm, times
/// the condition of the unknowns, about 10.
#[test]
fn readings_without_noise_are_inverted() {
    let (scene, grid) = film();
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let sensor = HallSensor { rotation: DQuat::from_rotation_x(0.1), ..HallSensor::default() };
    for head in heads(sensor) {
        let locator = locator(&scene, &head, &grid, HeadUnknowns::StrayField);
        for _ in 0..100 {
            let (at, stray_t) = (place(&mut random), vector(&mut random, 1e-4));
            let readings_t = readings_t(&scene, &head, at, stray_t, DQuat::IDENTITY);
            let fit = locator.locate(&readings_t).remove(0).unwrap_or_else(|error| panic!("{at}: {error}"));
            assert!((fit.position - at).length() < 1e-9, "{at}: {fit:?}");
            assert!((fit.stray_t - stray_t).length() < 1e-12, "{stray_t}: {fit:?}");
            assert!(fit.is_within && fit.rotation_rad == DVec3::ZERO);
        }
        // The search begins at the answer, but for the stray field.
        let at = DVec3::new(0.0, 0.5, -4.0);
        let readings_t = readings_t(&scene, &head, at, DVec3::splat(1e-5), DQuat::IDENTITY);
        let fit = locator.with_deviation(NOISE_T).locate(&readings_t).remove(0).unwrap();
        assert!((fit.position - at).length() < 1e-9 && fit.chi_squared < 1e-9, "{fit:?}");
    }
}

/// Five sensors give position, rotation and stray field: 15 numbers for 9.
#[test]
fn tilts_and_turns_are_inverted() {
    let (scene, grid) = film();
    let mut random = ChaCha8Rng::seed_from_u64(2);
    let head = head(Board::Cross, 5.0, HallSensor::default());
    let locator = locator(&scene, &head, &grid, HeadUnknowns::Pose);
    for _ in 0..100 {
        let (at, stray_t, turn) = (place(&mut random), vector(&mut random, 1e-4), vector(&mut random, 0.05));
        let readings_t = readings_t(&scene, &head, at, stray_t, DQuat::from_scaled_axis(turn));
        let fit = locator.locate(&readings_t).remove(0).unwrap_or_else(|error| panic!("{at}: {error}"));
        assert!((fit.position - at).length() < 1e-8, "{at}: {fit:?}");
        assert!((fit.rotation_rad - turn).length() < 1e-9, "{turn}: {fit:?}");
        assert!((fit.stray_t - stray_t).length() < 1e-11, "{stray_t}: {fit:?}");
    }
}

/// Fits of readings with normal noise at one place, over `count` readings.
fn noisy(head: &SensorHead, unknowns: HeadUnknowns, count: usize, at: DVec3, seed: u64) -> Vec<HeadFit> {
    let (scene, grid) = film();
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let locator = locator(&scene, head, &grid, unknowns).with_deviation(NOISE_T);
    let exact_t = readings_t(&scene, head, at, DVec3::new(3e-5, -2e-5, 4e-5), DQuat::IDENTITY);
    let read_t: Vec<DVec3> = (0..count).flat_map(|_| exact_t.clone()).map(|b| b + noise(&mut random)).collect();
    locator.locate(&read_t).into_iter().map(Result::unwrap).collect()
}

/// The scatter of 2000 fits is known to 1.6 %, so that 5 % are three deviations. Chi squared has
/// its mean and variance: the mean of 2000 is known to sqrt(2 / (2000 f)).
#[test]
fn scatter_is_that_of_the_fisher_information() {
    let at = DVec3::new(0.7, -0.4, -4.1);
    for (head, unknowns) in heads(HallSensor::default())
        .iter()
        .map(|head| (head, HeadUnknowns::StrayField))
        .chain([(&head(Board::Cross, 5.0, HallSensor::default()), HeadUnknowns::Pose)])
    {
        let fits = noisy(head, unknowns, 2000, at, 3);
        let scatter = |of: &dyn Fn(&HeadFit) -> DVec3| {
            let mean = fits.iter().map(of).sum::<DVec3>() / fits.len() as f64;
            let squares: DVec3 = fits.iter().map(|fit| (of(fit) - mean) * (of(fit) - mean)).sum();
            (squares / (fits.len() - 1) as f64).map(f64::sqrt)
        };
        let ratio = scatter(&|fit| fit.position) / fits[0].position_deviation;
        assert!((ratio - 1.0).abs().max_element() < 0.05, "{ratio}");
        let ratio = scatter(&|fit| fit.stray_t) / fits[0].stray_deviation_t;
        assert!((ratio - 1.0).abs().max_element() < 0.05, "{ratio}");
        let freedom = fits[0].degrees_of_freedom;
        assert_eq!(freedom, 3 * head.elements.len() - unknowns.count());
        let mean = fits.iter().map(|fit| fit.chi_squared).sum::<f64>() / fits.len() as f64;
        let known = (2.0 * freedom as f64 / 2000.0).sqrt();
        assert!((mean - freedom as f64).abs() <= 4.0 * known + 1e-12, "{mean}, {freedom}");
    }
}

/// Of 2000 right readings, 20 +- 4.5 have a probability below 0.01.
#[test]
fn false_alarms_are_as_rare_as_stated() {
    let cross = head(Board::Cross, 5.0, HallSensor::default());
    let fits = noisy(&cross, HeadUnknowns::StrayField, 2000, DVec3::new(-1.2, 0.3, -3.6), 4);
    let alarms = fits.iter().filter(|fit| fit.probability().is_some_and(|of| of < 0.01)).count();
    assert!((6..=34).contains(&alarms), "{alarms}");
    let pair = &noisy(&heads(HallSensor::default())[0], HeadUnknowns::StrayField, 1, DVec3::new(0.1, 0.2, -4.0), 5)[0];
    assert_eq!((pair.degrees_of_freedom, pair.probability()), (0, None));
}

/// A chip with an offset of 100 uT contradicts the others, and so does one whose axes are reversed
/// or which is stuck. Of two exchanged chips, neither is at fault alone, and of right readings
/// none.
#[test]
fn contradicting_sensors_are_named() {
    let (scene, grid) = film();
    let head = head(Board::Cross, 5.0, HallSensor::default());
    let locator = locator(&scene, &head, &grid, HeadUnknowns::StrayField).with_deviation(NOISE_T);
    let mut random = ChaCha8Rng::seed_from_u64(6);
    let mut changed = |change: &dyn Fn(&mut [DVec3])| -> Vec<DVec3> {
        let mut row = |_| {
            let mut readings_t = readings_t(&scene, &head, place(&mut random), DVec3::splat(3e-5), DQuat::IDENTITY);
            readings_t.iter_mut().for_each(|b| *b += noise(&mut random));
            change(&mut readings_t);
            readings_t
        };
        (0..3).flat_map(&mut row).collect()
    };
    let mut named = |change: &dyn Fn(&mut [DVec3])| locator.contradicting_sensor(&changed(change), 1e-3);
    for wrong in 0..5 {
        assert_eq!(named(&|row| row[wrong] += DVec3::new(1e-4, 0.0, -5e-5)), Some(wrong));
        assert_eq!(named(&|row| row[wrong] *= DVec3::new(1.0, 1.0, -1.0)), Some(wrong));
        assert_eq!(named(&|row| row[wrong] = DVec3::new(1e-3, 2e-3, -1e-3)), Some(wrong));
    }
    assert_eq!(named(&|row| row.swap(1, 2)), None);
    assert_eq!(named(&|_| ()), None);
}

/// Two sensors at one place do not tell a displacement from a stray field.
#[test]
fn undetermined_numbers_are_refused() {
    let (scene, grid) = film();
    let mut twice = heads(HallSensor::default())[0].clone();
    twice.elements[1].place = DVec3::ZERO;
    twice.elements.iter_mut().for_each(|of| of.weight = DVec3::splat(0.5));
    let at = DVec3::new(0.3, 0.4, -4.2);
    let readings_t = readings_t(&scene, &twice, at, DVec3::ZERO, DQuat::IDENTITY);
    let found = locator(&scene, &twice, &grid, HeadUnknowns::StrayField).locate(&readings_t);
    assert!(matches!(found[0], Err(LocateError::Undetermined | LocateError::NoPosition)), "{found:?}");
    let fit = locator(&scene, &twice, &grid, HeadUnknowns::Position).locate(&readings_t).remove(0).unwrap();
    assert!((fit.position - at).length() < 1e-9);
    let pair = SensedField::of_head(&scene, &twice, &grid).unwrap();
    let error = HeadLocator::new(pair, grid, HeadUnknowns::Pose).unwrap_err();
    assert_eq!(error, HeadLocatorError::TooFew { sensors: 2, unknowns: 9 });
    assert_eq!(error.to_string(), "2 sensors give 6 numbers, fewer than the 9 that are fitted: fit less");
}

/// Missing and saturated readings of one sensor, a place outside the volume, and a constant part.
#[test]
fn other_readings_are_told_apart() {
    let (scene, grid) = film();
    let limited = HallSensor { range_t: DVec3::splat(2e-2), ..HallSensor::default() };
    let head = head(Board::Cross, 5.0, limited);
    let constants_t: Vec<DVec3> = (0..5).map(|of| 1e-5 * DVec3::new(f64::from(of), 1.0, -2.0)).collect();
    let locator = locator(&scene, &head, &grid, HeadUnknowns::StrayField).with_constant_readings(&constants_t);
    let at = |place: DVec3| -> Vec<DVec3> {
        let field_t = readings_t(&scene, &head, place, DVec3::ZERO, DQuat::IDENTITY);
        field_t.into_iter().zip(&constants_t).map(|(b, constant_t)| b + *constant_t).collect()
    };
    let (inside, outside) = (DVec3::new(0.5, -1.5, -3.1), DVec3::new(2.3, 0.1, -4.0));
    let mut rows = [at(inside), at(outside), at(inside), at(inside)].concat();
    rows[10].y = f64::NAN;
    rows[17].z = 2e-2;
    let found = locator.locate(&rows);
    assert!((found[0].clone().unwrap().position - inside).length() < 1e-9);
    let fit = found[1].clone().unwrap();
    assert!(!fit.is_within && (fit.position - outside).length() < 1e-9, "{fit:?}");
    assert_eq!(found[2..], [Err(LocateError::NotFinite), Err(LocateError::Saturated)]);
}
