//! Scans of samples of films as made.

use glam::{DQuat, DVec3};
use magsplice_field::Scene;
use magsplice_layout::{Distribution, FilmPose, FilmTolerance, Layout, StrayField, Temperature};
use magsplice_magnet::{HallSensor, Quantity};
use magsplice_scan::{SampleScan, SampleScanError};
use magsplice_tolerance::RealFilm;

fn normal(deviations: [f64; 3]) -> [Distribution; 3] {
    deviations.map(Distribution::normal)
}

/// The stated parameters reproduce the reading of a turned and calibrated sensor above a film that
/// is displaced and turned, in a stray field: R^-1 (strength B(p + start)) + offset, in the axes of
/// the sensor as ordered. Errors of gain are no parameter and are left out. Round-off is that of B,
/// 1e-13 of some mT.
#[test]
fn parameters_reproduce_the_readings() {
    let layout = Layout::read("../../layouts/published-film.toml").unwrap_or_else(|e| panic!("{e}"));
    let tiles = layout.bare_tiles();
    let mut tolerance = FilmTolerance::default();
    tolerance.common.film = FilmPose { position_mm: normal([0.1; 3]), rotation_rad: normal([0.02; 3]) };
    tolerance.common.stray_field = Some(StrayField { field_t: normal([3e-5; 3]), ..StrayField::default() });
    tolerance.common.temperature = Some(Temperature { change_k: Distribution::normal(20.0), strength_per_k: -1e-3 });
    tolerance.common.sensor.offset_t = normal([1e-4; 3]);
    tolerance.common.sensor.rotation_rad = normal([0.03; 3]);
    let ordered = HallSensor {
        rotation: DQuat::from_scaled_axis(DVec3::new(0.4, -0.2, 1.1)),
        gain: DVec3::new(1.2, 0.8, 1.5),
        offset_t: DVec3::new(2e-4, -1e-4, 3e-4),
        ..HallSensor::default()
    };
    let film = RealFilm::new(&tiles, &tolerance);
    for sample in 0..5 {
        let made = film.sample(3, sample).expect("valid");
        let scene = Scene::new(made.tiles());
        for point in [DVec3::new(0.3, -0.4, -4.0), DVec3::new(-1.7, 1.2, -3.2)] {
            let SampleScan { readings_t, parameters } = SampleScan::new(&made, &ordered, &[point]).unwrap();
            let field_t = scene.field(Quantity::FluxDensity, point + parameters.start).unwrap();
            let expected_t = parameters.reading_t(ordered.rotation.inverse() * field_t);
            let calibrated_t = (readings_t[0] - ordered.offset_t) / ordered.gain;
            assert!(calibrated_t.distance(expected_t) < 1e-15, "{sample}: {calibrated_t}, not {expected_t}");
            assert!(parameters.offset_t.length() > 1e-6 && parameters.start.length() > 1e-3, "{parameters:?}");
        }
    }
}

/// A point beyond the range of lengths, which a turned film would move to infinity.
#[test]
fn points_out_of_range_are_refused() {
    let layout = Layout::read("../../layouts/published-film.toml").unwrap_or_else(|e| panic!("{e}"));
    let mut tolerance = FilmTolerance::default();
    tolerance.common.film = FilmPose { position_mm: normal([0.1; 3]), rotation_rad: normal([0.02; 3]) };
    let made = RealFilm::new(&layout.bare_tiles(), &tolerance).sample(3, 0).expect("valid");
    let points = [DVec3::NEG_Z * 4.0, DVec3::new(f64::MAX, f64::MAX, -4.0)];
    let refused = SampleScan::new(&made, &HallSensor::default(), &points);
    let Err(SampleScanError::Points(errors)) = refused else { panic!("{refused:?}") };
    assert_eq!(errors.0.iter().map(|error| error.index).collect::<Vec<_>>(), [1]);
}
