//! Heads of several Hall sensors: their sums, gradients, and the films that they see.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};
use magsplice_decouple::{Branch, Decoupling, Parameters};
use magsplice_field::Scene;
use magsplice_head::{Board, HeadElement, SensorHead, least_noise_weights};
use magsplice_ideal::IdealFilm;
use magsplice_layout::Layout;
use magsplice_magnet::{Grid, HallSensor, Quantity};
use magsplice_sensor::{Locator, SensedField};

const WAVELENGTH_MM: f64 = 10.0;

pub(crate) fn film() -> (Scene, Grid) {
    let layout = Layout::read("../../layouts/published-film.toml").unwrap_or_else(|e| panic!("{e}"));
    (Scene::new(&layout.bare_tiles()), layout.volume.expect("a volume").grid)
}

pub(crate) fn head(board: Board, spacing: f64, sensor: HallSensor) -> SensorHead {
    let places = board.places(spacing);
    let weights = least_noise_weights(&places, &vec![1.0; places.len()], TAU / WAVELENGTH_MM).unwrap();
    let element = |(place, weight)| HeadElement { sensor, place, weight: DVec3::splat(weight) };
    SensorHead { elements: places.into_iter().zip(weights).map(element).collect() }
}

const PLACES: [DVec3; 3] = [DVec3::new(0.3, -0.4, -4.0), DVec3::new(-1.7, 1.2, -3.2), DVec3::new(1.9, 1.9, -5.0)];

/// A head reads the weighted sum of B at its sensors, whatever their gain, offset and rotation. The
/// order of sums differs: 1e-15 of the terms, which are below 0.05 T.
#[test]
fn heads_read_weighted_sums_of_the_field() {
    let (scene, grid) = film();
    let turned = HallSensor {
        rotation: DQuat::from_scaled_axis(DVec3::new(0.1, -0.2, 0.3)),
        gain: DVec3::new(1.02, 0.97, -1.1),
        offset_t: DVec3::new(1e-4, -2e-4, 3e-4),
        ..HallSensor::default()
    };
    for sensor in [HallSensor::default(), turned] {
        let head = head(Board::Cross, 5.0, sensor);
        let sensed = SensedField::of_head(&scene, &head, &grid).unwrap();
        let found = sensed.readings_t(&PLACES).unwrap();
        let of_sensors = sensed.readings_of_sensors_t(&PLACES).unwrap();
        for (index, place) in PLACES.into_iter().enumerate() {
            let b = |of: &HeadElement| scene.field(Quantity::FluxDensity, place + of.place).unwrap();
            let expected: DVec3 = head.elements.iter().map(|of| of.weight * b(of)).sum();
            assert!((found[index] - expected).length() < 1e-16, "{place}: {} {expected}", found[index]);
            for (of, readings_t) in head.elements.iter().zip(&of_sensors) {
                let reading_t = sensor.gain * (sensor.rotation.inverse() * b(of)) + sensor.offset_t;
                assert!((readings_t[index] - reading_t).length() < 1e-16, "{place}");
            }
        }
    }
}

/// As for one sensor, the error of differences is 1e-8 k^2 / 6 of the gradient.
#[test]
fn gradients_of_heads_are_differences() {
    let (scene, grid) = film();
    let sensor = HallSensor { active_area: [0.4, 0.2], gain: DVec3::new(1.0, 2.0, 3.0), ..HallSensor::default() };
    let sensed = SensedField::of_head(&scene, &head(Board::PairZ, 1.0, sensor), &grid).unwrap();
    for (place, gradient) in PLACES.into_iter().zip(sensed.gradients(&PLACES).unwrap()) {
        for (axis, unit) in DVec3::AXES.into_iter().enumerate() {
            let ends = sensed.readings_t(&[place + 1e-4 * unit, place - 1e-4 * unit]).unwrap();
            let difference = (ends[0] - ends[1]) / 2e-4;
            assert!((difference - gradient.col(axis)).length() < 1e-9, "{place}, {axis}");
        }
    }
}

/// The field that a finite film lacks is smooth and cancels: RMS of the displacement error of the
/// published film along x and z, in mm, by two independent computations to three decimals.
#[test]
fn heads_see_the_published_film_as_larger() {
    let (scene, grid) = film();
    let ideal = IdealFilm::new(WAVELENGTH_MM, 1.0, 0.12).unwrap();
    let reference = DVec3::new(0.0, 0.0, -5.0);
    let one = SensorHead::from(HallSensor::default());
    let sensor = HallSensor::default();
    for (head, expected_mm) in [
        (one, [0.242, 0.316]),
        (head(Board::PairZ, 1.0, sensor), [0.030, 0.036]),
        (head(Board::PairXy, 5.0, sensor), [0.086, 0.052]),
        (head(Board::Cross, 5.0, sensor), [0.033, 0.031]),
    ] {
        let sensed = SensedField::of_head(&scene, &head, &grid).unwrap();
        let field_t = sensed.readings_t(&grid.points().collect::<Vec<DVec3>>()).unwrap();
        let reference_t = sensed.readings_t(&[reference]).unwrap()[0];
        let found = Decoupling::from_field(&grid, &field_t, (reference, reference_t), &ideal).unwrap();
        let found_mm = [found.ideal_rmse.r_x, found.ideal_rmse.s_z].map(|rmse| rmse / ideal.wavenumber());
        let is_close = found_mm.iter().zip(expected_mm).all(|(found, expected)| (found - expected).abs() < 6e-4);
        assert!(is_close, "{head:?}: {found_mm:?}, not {expected_mm:?}");
    }
}

/// Positions are found from sums as from readings of one sensor, and uniform fields change none:
/// the weights of these heads cancel to a rounding.
#[test]
fn heads_are_located_in_stray_fields() {
    let (scene, grid) = film();
    for board in [Board::PairZ, Board::Cross] {
        let head = head(board, if board == Board::PairZ { 1.0 } else { 5.0 }, HallSensor::default());
        let sensed = SensedField::of_head(&scene, &head, &grid).unwrap();
        let stray_t = DVec3::new(1e-3, -2e-3, 1e-3);
        let of_sensors = sensed.readings_of_sensors_t(&PLACES).unwrap();
        let sums: Vec<DVec3> = (0..PLACES.len())
            .map(|place| head.sum_t(&of_sensors.iter().map(|of| of[place] + stray_t).collect::<Vec<DVec3>>()))
            .collect();
        for (place, found) in PLACES.into_iter().zip(Locator::new(sensed, grid).unwrap().locate(&sums)) {
            let error = (found.unwrap().position - place).length();
            assert!(error < 1e-9, "{board:?}, {place}: {error:e} mm");
        }
    }
}

/// The weights cancel to a rounding, so 1 mT that appears after the reading at the reference point
/// changes the displacement in closed form by a few roundings: of 1 mT over the sum of about 1 mT,
/// times the wavelength over 2 pi, 1e-15 mm.
#[test]
fn uniform_fields_change_no_displacement_in_closed_form() {
    let (scene, grid) = film();
    let wavenumber = TAU / WAVELENGTH_MM;
    let points: Vec<DVec3> = grid.points().collect();
    let sensor = HallSensor::default();
    for head in [head(Board::PairZ, 1.0, sensor), head(Board::PairXy, 5.0, sensor), head(Board::Cross, 5.0, sensor)] {
        let of_sensors = SensedField::of_head(&scene, &head, &grid).unwrap().readings_of_sensors_t(&points).unwrap();
        let sum_t = |point: usize, stray_t: DVec3| {
            head.sum_t(&of_sensors.iter().map(|of| of[point] + stray_t).collect::<Vec<DVec3>>())
        };
        let branch = Branch::from_axis_field(sum_t(points.len() / 2, DVec3::ZERO)).unwrap();
        let displacement = |point: usize, stray_t: DVec3| {
            let [reference, moved] =
                [sum_t(0, DVec3::ZERO), sum_t(point, stray_t)].map(|b_t| Parameters::from_field(b_t, branch).unwrap());
            moved.displacement_from(&reference, wavenumber)
        };
        for (point, stray_t) in (0..points.len()).flat_map(|point| DVec3::AXES.map(|axis| (point, 1e-3 * axis))) {
            let change = (displacement(point, stray_t) - displacement(point, DVec3::ZERO)).length();
            assert!(change < 1e-12, "{:?} at {}: {change:e} mm", stray_t, points[point]);
        }
    }
}
