//! Positions from readings: exact without noise, and otherwise as exact as the noise allows.

use glam::DVec3;
use magsplice_decouple::{Branch, Parameters};
use magsplice_field::Scene;
use magsplice_layout::Layout;
use magsplice_magnet::{Grid, HallSensor, Quantity, Tile};
use magsplice_sensor::{LocateError, Locator, Noise};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

fn shipped(name: &str) -> (Scene, Grid, Layout) {
    let layout = Layout::read(format!("../../layouts/{name}.toml")).unwrap_or_else(|e| panic!("{e}"));
    (Scene::new(&layout.bare_tiles()), layout.volume.expect("a volume").grid, layout)
}

fn points_within(grid: &Grid, count: usize, random: &mut ChaCha8Rng) -> Vec<DVec3> {
    let (lower, upper) = (grid.lower(), grid.upper());
    (0..count).map(|_| lower + (upper - lower) * DVec3::from([(); 3].map(|()| random.random::<f64>()))).collect()
}

/// A normal deviate of standard deviation 1 by Box and Muller.
fn normal(random: &mut ChaCha8Rng) -> f64 {
    let (radius, turn) = (1.0 - random.random::<f64>(), random.random::<f64>());
    (-2.0 * radius.ln()).sqrt() * (std::f64::consts::TAU * turn).cos()
}

/// The error of the field is far below its bound, at most 1e-14 T here, and the
/// gradient at least 1e-5 T/mm. The error of positions is therefore below 1e-9 mm, apart from the
/// square of the shortest step.
#[test]
fn readings_without_noise_give_their_positions() {
    for name in ["published-film", "designed-displacement", "robust-tilted"] {
        let (scene, grid, _) = shipped(name);
        let locator = Locator::new(&scene, grid).unwrap();
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let mut points = points_within(&grid, 3000, &mut random);
        points.extend(grid.points());
        let readings = scene.field_at(Quantity::FluxDensity, &points).unwrap();
        for (point, found) in points.iter().zip(locator.locate(&readings)) {
            let error = found.unwrap_or_else(|e| panic!("{name}, {point}: {e}")).position.distance(*point);
            assert!(error < 1e-9, "{name}, {point}: {error:e} mm");
        }
    }
}

/// A standard deviation from n samples has a relative standard error of 1 / sqrt(2 n): four of them
/// are 4.5 % for 4000. The steps are nearly linear over the noise, so the bound is reached.
#[test]
fn noise_moves_positions_as_far_as_the_bound_says() {
    let (scene, grid, layout) = shipped("published-film");
    let locator = Locator::new(&scene, grid).unwrap();
    let noise = Noise { deviation_t: DVec3::new(1e-6, 2e-6, 3e-6) };
    let mut random = ChaCha8Rng::seed_from_u64(2);
    let wavenumber = layout.ideal.unwrap().wavenumber();
    for point in [DVec3::new(0.1, 0.2, -4.0), DVec3::new(1.2, -0.9, -3.6), DVec3::new(-1.5, 1.5, -4.5)] {
        let b_t = scene.field(Quantity::FluxDensity, point).unwrap();
        let branch = Branch::from_axis_field(scene.field(Quantity::FluxDensity, DVec3::new(0.0, 0.0, -5.0)).unwrap());
        let (exact, derivatives) = Parameters::with_derivatives(b_t, branch.unwrap()).unwrap();
        let readings: Vec<DVec3> =
            (0..4000).map(|_| b_t + noise.deviation_t * DVec3::from([(); 3].map(|()| normal(&mut random)))).collect();
        let found: Vec<DVec3> = locator.locate(&readings).into_iter().map(|found| found.unwrap().position).collect();
        let closed: Vec<DVec3> = readings
            .iter()
            .map(|reading| {
                Parameters::from_field(*reading, branch.unwrap()).unwrap().displacement_from(&exact, wavenumber)
            })
            .collect();
        let gradient = scene.gradient(Quantity::FluxDensity, point).unwrap();
        let bound = noise.of_position(gradient).unwrap();
        let of_closed_form = noise.of_parameters(&derivatives, wavenumber, &HallSensor::default()).unwrap();
        for (values, centre, expected) in [(found, point, bound), (closed, DVec3::ZERO, of_closed_form)] {
            let squares: DVec3 = values.iter().map(|value| (value - centre).powf(2.0)).sum();
            let deviation = (squares / values.len() as f64).powf(0.5);
            let ratio = deviation / expected;
            assert!((ratio - 1.0).abs().max_element() < 0.045, "{point}: {deviation}, expected {expected}");
        }
    }
}

/// A position farther outside than half the extent of the volume is not searched for; every nearer
/// one is found, or another one with the same reading.
#[test]
fn every_position_within_half_the_extent_of_the_volume_is_found() {
    for name in ["published-film", "designed-displacement", "robust-tilted"] {
        let (scene, grid, _) = shipped(name);
        let locator = Locator::new(&scene, grid).unwrap();
        let reach = 0.5 * (grid.upper() - grid.lower());
        let around = Grid::new(grid.lower() - reach, grid.upper() + reach, [2; 3]).unwrap();
        let points = points_within(&around, 1500, &mut ChaCha8Rng::seed_from_u64(5));
        let readings = scene.field_at(Quantity::FluxDensity, &points).unwrap();
        let mut missed = 0;
        for ((point, reading), found) in points.iter().zip(&readings).zip(locator.locate(&readings)) {
            let positions = match found {
                Ok(located) | Err(LocateError::Outside(located)) => vec![located.position],
                Err(LocateError::Ambiguous(both)) => both.to_vec(),
                Err(error) => {
                    println!("{name}, {point}: {error}");
                    missed += 1;
                    continue;
                }
            };
            for position in positions {
                let there = scene.field(Quantity::FluxDensity, position).unwrap();
                assert!((there - *reading).length() < 1e-9 * reading.length(), "{name}, {point}: {position}");
            }
        }
        assert_eq!(missed, 0, "{name}");
    }
}

#[test]
fn readings_that_fit_elsewhere_twice_or_nowhere_say_so() {
    let (scene, grid, _) = shipped("published-film");
    let locator = Locator::new(&scene, grid).unwrap();
    let reading = |point: DVec3| scene.field(Quantity::FluxDensity, point).unwrap();
    let outside = DVec3::new(2.3, 0.4, -4.0);
    match locator.locate(&[reading(outside)]).remove(0) {
        Err(LocateError::Outside(located)) => assert!(located.position.distance(outside) < 1e-9),
        other => panic!("{other:?}"),
    }
    let far = [DVec3::new(0.0, 0.0, -30.0), DVec3::new(0.0, 0.0, 9.0)].map(reading);
    assert_eq!(locator.locate(&far), [Err(LocateError::NoPosition), Err(LocateError::NoPosition)]);
    assert_eq!(locator.locate(&[DVec3::NAN]), [Err(LocateError::NotFinite)]);

    // A film of eight wavelengths repeats its field after one.
    let (scene, ..) = shipped("film-80mm");
    let wide = Grid::new(DVec3::new(-7.0, -2.0, -5.0), DVec3::new(7.0, 2.0, -3.0), [29, 9, 5]).unwrap();
    let locator = Locator::new(&scene, wide).unwrap();
    let reading = scene.field(Quantity::FluxDensity, DVec3::new(-5.5, 0.5, -4.0)).unwrap();
    match locator.locate(&[reading]).remove(0) {
        Err(LocateError::Ambiguous(both)) => {
            let mut x = both.map(|position| position.x);
            x.sort_by(f64::total_cmp);
            // Near its rim the film is weaker, so the second position is not exactly a wavelength
            // away.
            assert!((x[0] + 5.5).abs() < 1e-9 && (x[1] - 4.5).abs() < 0.3, "{x:?}");
            for position in both {
                let there = scene.field(Quantity::FluxDensity, position).unwrap();
                assert!((there - reading).length() < 1e-12, "{position}");
            }
        }
        other => panic!("{other:?}"),
    }
}

/// The number of readings exceeds a batch.
#[test]
fn readings_do_not_depend_on_each_other() {
    let (scene, grid, _) = shipped("published-film");
    let locator = Locator::new(&scene, grid).unwrap();
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let readings = scene.field_at(Quantity::FluxDensity, &points_within(&grid, 20_000, &mut random)).unwrap();
    let together = locator.locate(&readings);
    for index in [0, 1, 16_383, 16_384, 19_999] {
        assert_eq!(locator.locate(&readings[index..=index]), together[index..=index]);
    }
}

/// Steps and distances count relative to the volume: tiles and volume in metres have the positions
/// in metres. The positions in both units are exact to 1e-9 of the volume.
#[test]
fn positions_scale_with_the_unit_of_length() {
    let (_, grid, layout) = shipped("published-film");
    let points = points_within(&grid, 200, &mut ChaCha8Rng::seed_from_u64(6));
    for unit in [1e-3, 1e3] {
        let scaled = |tile: &Tile| {
            Tile::new(unit * tile.position(), unit * tile.size(), tile.polarization_t())
                .and_then(|new| new.rotated(tile.rotation()))
                .unwrap()
        };
        let scene = Scene::new(&layout.bare_tiles().iter().map(scaled).collect::<Vec<Tile>>());
        let locator = Locator::new(&scene, Grid::new(unit * grid.lower(), unit * grid.upper(), grid.counts()).unwrap());
        let scaled_points: Vec<DVec3> = points.iter().map(|point| unit * *point).collect();
        let readings = scene.field_at(Quantity::FluxDensity, &scaled_points).unwrap();
        for (point, found) in scaled_points.iter().zip(locator.unwrap().locate(&readings)) {
            let error = found.unwrap_or_else(|e| panic!("{point}: {e}")).position.distance(*point);
            assert!(error < 1e-9 * unit * (grid.upper() - grid.lower()).length(), "{point}: {error:e}");
        }
    }
}
