//! The linear model against exact evaluations.

use glam::{DQuat, DVec3};
use magsplice_ideal::IdealFilm;
use magsplice_layout::{
    CommonErrors, Distribution, ErrorGroup, FilmPose, FilmTolerance, NearIron, Neighbour, SensorErrors, StrayField,
    Temperature, TileErrors,
};
use magsplice_magnet::{Grid, IronPlanes, Tile, TileError};

use super::displacement::{Displacement, displacement_errors_mm};
use super::sources::sources;
use super::{ErrorSource, FirstOrder, SensorError};
use crate::evaluation_grid::EvaluationGrid;
use crate::real_film::RealFilm;
use crate::sampler::Sampler;

/// The check of the model.
mod check;
/// Heads of several sensors.
mod head;
/// Flat iron.
mod iron;

fn ideal() -> IdealFilm {
    IdealFilm::new(10.0, 1.0, 0.12).expect("a film")
}

fn volume() -> EvaluationGrid {
    let grid = Grid::new(DVec3::new(-1.5, -1.0, -5.0), DVec3::new(1.0, 1.5, -3.0), [3, 4, 2]).expect("a grid");
    EvaluationGrid { grid, reference: DVec3::new(0.1, -0.2, -4.5) }
}

/// A film without any symmetry. Each of its tiles is turned about another axis.
fn tiles() -> Vec<Tile> {
    let turns = [DVec3::ZERO, DVec3::new(0.0, 0.0, 0.4), DVec3::new(0.2, -0.3, 0.1), DVec3::new(0.0, 0.0, 1.2)];
    let centres = [
        DVec3::new(-3.0, -2.0, 0.6),
        DVec3::new(2.6, -2.3, 0.5),
        DVec3::new(-2.4, 2.9, 1.2),
        DVec3::new(2.8, 2.7, 0.7),
    ];
    let j_t = [
        DVec3::new(-0.1, -0.07, 0.0),
        DVec3::new(0.1, -0.05, 0.02),
        DVec3::new(-0.08, 0.1, -0.03),
        DVec3::new(0.02, 0.11, 0.05),
    ];
    let tile = |i: usize| {
        Tile::new(centres[i], DVec3::new(3.6 - 0.1 * i as f64, 4.0, 1.0), j_t[i])
            .and_then(|tile| tile.rotated(DQuat::from_scaled_axis(turns[i])))
            .expect("a tile")
    };
    (0..4).map(tile).collect()
}

/// Errors of every kind, all normal.
fn everything(later: bool) -> FilmTolerance {
    let normal = Distribution::normal;
    let three = |deviation: f64| [normal(deviation), normal(deviation), normal(deviation)];
    let errors = TileErrors {
        position: three(0.02),
        rotation: three(0.004),
        size: three(0.01),
        strength: normal(0.01),
        direction: [normal(0.01), normal(0.02)],
    };
    let neighbour_tile = Tile::new(DVec3::new(4.0, 1.0, -20.0), DVec3::new(9.0, 8.0, 2.0), DVec3::new(0.1, 0.2, 0.3));
    FilmTolerance {
        groups: vec![ErrorGroup { name: "row".to_owned(), tiles: vec![0, 2, 3], errors: errors.clone() }],
        common: CommonErrors {
            film: FilmPose { position_mm: three(0.1), rotation_rad: three(0.01) },
            stray_field: Some(StrayField { field_t: three(5e-6), any_direction_t: normal(3e-6), later }),
            neighbour: Some(Neighbour {
                tiles: vec![neighbour_tile.expect("a tile")],
                layout: "other.toml".to_owned(),
                position_mm: [0.0; 3],
                rotation: None,
                later,
            }),
            iron: None,
            temperature: Some(Temperature { change_k: normal(5.0), strength_per_k: -0.0012 }),
            sensor: SensorErrors {
                position_mm: three(0.05),
                offset_t: three(2e-6),
                rotation_rad: three(0.003),
                gain: three(0.01),
                noise_t: three(1e-6),
            },
        },
        ..FilmTolerance::of_tiles(&errors, 4)
    }
}

/// Only one error, which is the same in every film; the neighbour and the iron remain.
fn only(source: ErrorSource, value: f64, all: &FilmTolerance) -> Option<FilmTolerance> {
    let fixed = Distribution::Fixed(value);
    let mut errors = TileErrors::default();
    let CommonErrors { neighbour, iron, .. } = all.common.clone();
    let iron = iron.map(|iron| NearIron { distance_error_mm: Distribution::NONE, ..iron });
    let mut common = CommonErrors { neighbour, iron, ..CommonErrors::default() };
    let later = all.common.stray_field.as_ref().is_some_and(|field| field.later);
    let mut stray_field = StrayField { later, ..StrayField::default() };
    let (mut tiles, mut groups) = (vec![TileErrors::default(); 4], Vec::new());
    match source {
        ErrorSource::Tile { tile, error } => {
            errors[error] = fixed;
            tiles[tile] = errors;
        }
        ErrorSource::Group { group, error } => {
            errors[error] = fixed;
            groups.push(ErrorGroup { errors, ..all.groups[group].clone() });
        }
        ErrorSource::FilmPosition(axis) => common.film.position_mm[axis] = fixed,
        ErrorSource::FilmRotation(axis) => common.film.rotation_rad[axis] = fixed,
        ErrorSource::StrayField(axis) => {
            stray_field.field_t[axis] = fixed;
            common.stray_field = Some(stray_field);
        }
        ErrorSource::Temperature => common.temperature = Some(Temperature { change_k: fixed, strength_per_k: 1.0 }),
        ErrorSource::IronDistance => common.iron.as_mut()?.distance_error_mm = fixed,
        ErrorSource::Sensor { sensor: 0, error } => match error {
            SensorError::Offset(axis) => common.sensor.offset_t[axis] = fixed,
            SensorError::Rotation(axis) => common.sensor.rotation_rad[axis] = fixed,
            SensorError::Gain(axis) => common.sensor.gain[axis] = fixed,
            SensorError::Position(axis) => common.sensor.position_mm[axis] = fixed,
        },
        // A tolerance cannot state the errors of one sensor of a head alone.
        ErrorSource::Sensor { .. } => return None,
        // Noise at the reference point alone cannot be stated.
        ErrorSource::ReferenceNoise(_) => return None,
    }
    Some(FilmTolerance { tiles, groups, common, ..FilmTolerance::default() })
}

/// Displacement errors at all points.
fn exact(tolerance: &FilmTolerance, iron: &IronPlanes) -> Vec<f64> {
    let (film, ideal) = (RealFilm::new(&tiles(), tolerance).with_iron(iron.clone()), ideal());
    let sampler = Sampler::new(&film, &volume(), &ideal, 1).expect("a field");
    let read_t = sampler.readings_of_t(0).expect("a sample");
    displacement_errors_mm(sampler.points(), &read_t, &ideal).expect("parameters")
}

/// Central differences D of steps h and 2h are wrong by c h^2 and 4 c h^2 and terms of h^4, so that
/// (4 D(h) - D(2h)) / 3 is wrong by the order of h^4, with h in units of the distances, of a radian
/// or of the field: (1e-3)^4 times the fifth derivative over 30, below 1e-10. Round-off of 1e-14
/// over h is below 1e-10 likewise. Both are relative to the largest derivative; a thousand of these
/// are allowed.
fn derivatives_are_exact(all: &FilmTolerance, iron: &IronPlanes) {
    let film = RealFilm::new(&tiles(), all).with_iron(iron.clone());
    let model = FirstOrder::new(&film, &volume(), &ideal()).expect("a model");
    assert_eq!(model.terms().len(), 12 * 4 + 12 + 23 + 3);
    let sensitivities: Vec<Vec<(usize, Vec<f64>)>> =
        (0..3).map(|axis| model.sensitivities_mm(axis).collect()).collect();
    let column = |axis: usize, number: usize| {
        let found = sensitivities[axis].iter().find(|(term, _)| *term == number);
        &found.expect("an error that varies").1
    };
    for (number, term) in model.terms().iter().enumerate() {
        let step = match term.source {
            ErrorSource::Tile { error: TileError::Position(_) | TileError::Size(_), .. }
            | ErrorSource::Group { error: TileError::Position(_) | TileError::Size(_), .. } => 3e-3,
            ErrorSource::FilmPosition(_)
            | ErrorSource::IronDistance
            | ErrorSource::Sensor { error: SensorError::Position(_), .. } => 3e-3,
            ErrorSource::StrayField(_) | ErrorSource::Sensor { error: SensorError::Offset(_), .. } => 1e-6,
            _ => 1e-3,
        };
        let at = |value: f64| only(term.source, value, all).map(|tolerance| exact(&tolerance, iron));
        let [Some(a), Some(b), Some(c), Some(d)] = [2.0, 1.0, -1.0, -2.0].map(|steps| at(steps * step)) else {
            continue;
        };
        if term.deviation == 0.0 {
            continue;
        }
        let found: Vec<f64> =
            (0..3).flat_map(|axis| column(axis, number).iter().map(|value| value / term.deviation)).collect();
        let largest = found.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
        for (index, found) in found.iter().enumerate() {
            let [wide, narrow] = [(a[index] - d[index]) / (4.0 * step), (b[index] - c[index]) / (2.0 * step)];
            let wanted = (4.0 * narrow - wide) / 3.0;
            assert!((found - wanted).abs() < 1e-7 * largest, "{:?}, {index}: {found}, not {wanted}", term.source);
        }
    }
}

#[test]
fn derivatives_are_those_of_the_exact_evaluation() {
    [false, true].iter().for_each(|later| derivatives_are_exact(&everything(*later), &IronPlanes::default()));
}

/// The same noise in every reading is an offset of the sensor.
#[test]
fn noise_that_is_always_the_same_is_an_offset() {
    let fixed = || [3e-6, -2e-6, 5e-6].map(Distribution::Fixed);
    let of_sensor = |sensor| FilmTolerance {
        common: CommonErrors { sensor, ..CommonErrors::default() },
        ..FilmTolerance::default()
    };
    let noise = of_sensor(SensorErrors { noise_t: fixed(), ..SensorErrors::default() });
    let offset = of_sensor(SensorErrors { offset_t: fixed(), ..SensorErrors::default() });
    let [noise, offset] = [noise, offset]
        .map(|tolerance| FirstOrder::new(&RealFilm::new(&tiles(), &tolerance), &volume(), &ideal()).expect("a model"));
    assert_ne!(noise.mean_mm, noise.nominal_mm);
    for (noise, offset) in noise.mean_mm.iter().zip(&offset.mean_mm) {
        assert!((noise - offset).abs() < 1e-14, "{noise}, not {offset}");
    }
}

/// Contributions add up, and halving errors saves what the model without half of them lacks.
#[test]
fn shares_add_up_and_halving_saves_what_is_stated() {
    let mut tolerance = everything(false);
    tolerance.tiles[1].strength = Distribution::Fixed(0.02);
    tolerance.common.sensor.gain[2] = Distribution::Fixed(-0.01);
    let model = |tolerance: &FilmTolerance| {
        FirstOrder::new(&RealFilm::new(&tiles(), tolerance), &volume(), &ideal()).expect("a model")
    };
    let whole = model(&tolerance);
    let mut halved = tolerance.clone();
    halved.tiles[1] = tolerance.tiles[1].each_ref().map(|error| error.scaled(0.5));
    let less = model(&halved);
    for axis in 0..3 {
        let (whole, less) = (whole.axis_errors(axis), less.axis_errors(axis));
        let parts: f64 = whole.shares.iter().map(|share| share.contribution.total_mm2()).sum();
        let allowed = 1e-12 * whole.expected_mm2;
        assert!((whole.nominal_mm2 + parts - whole.expected_mm2).abs() < allowed);
        assert_eq!(whole.shares.len(), 16);
        let saved = whole.expected_mm2 - less.expected_mm2;
        assert!((whole.tiles[1].saved_by_halving_mm2 - saved).abs() < allowed, "{:?}, not {saved}", whole.tiles[1]);
    }
}

/// The mean over n linear samples of the mean square is the expected one within six standard
/// errors: six deviations over n^1/2.
#[test]
fn linear_samples_have_the_expected_mean_square() {
    let mut tolerance = everything(true);
    tolerance.common.stray_field = None;
    let model = FirstOrder::new(&RealFilm::new(&tiles(), &tolerance), &volume(), &ideal()).expect("a model");
    let n = 4000;
    let samples: Vec<Vec<f64>> = (0..n).map(|sample| model.linear_sample_mm(3, sample)).collect();
    for axis in 0..3 {
        let expected_mm2 = model.axis_errors(axis).expected_mm2;
        let mean_square = |sample: &Vec<f64>| {
            let along = model.along(sample, axis);
            along.iter().map(|error| error * error).sum::<f64>() / along.len() as f64
        };
        let squares: Vec<f64> = samples.iter().map(mean_square).collect();
        let mean = squares.iter().sum::<f64>() / n as f64;
        let deviation = (squares.iter().map(|square| (square - mean).powi(2)).sum::<f64>() / n as f64).sqrt();
        assert!((mean - expected_mm2).abs() < 6.0 * deviation / (n as f64).sqrt(), "{mean}, not {expected_mm2}");
    }
}

/// 85 errors at three million points need 12 GB.
#[test]
fn sensitivities_that_do_not_fit_are_refused() {
    let grid = Grid::new(DVec3::new(-1.0, -1.0, -5.0), DVec3::new(1.0, 1.0, -3.0), [1000, 1000, 3]).expect("a grid");
    let volume = EvaluationGrid { grid, reference: DVec3::new(0.0, 0.0, -5.0) };
    let found = FirstOrder::new(&RealFilm::new(&tiles(), &everything(false)), &volume, &ideal());
    let wanted = (4 * 12 + 12 + 22 + 3) * 48 * 3_000_000;
    assert_eq!(found.err(), Some(crate::SampleError::TooLarge { bytes: Some(wanted) }));
}

/// With noise alone, a linear sample is the exact sample of its number: noise of 1e-7 T is 1e-4 of
/// the field, and the square of this is left out.
#[test]
fn linear_samples_have_the_noise_of_exact_samples() {
    let mut tolerance = FilmTolerance::default();
    tolerance.common.sensor.noise_t = [1e-7, 2e-7, 1e-7].map(Distribution::normal);
    let (film, ideal) = (RealFilm::new(&tiles(), &tolerance), ideal());
    let model = FirstOrder::new(&film, &volume(), &ideal).expect("a model");
    let sampler = Sampler::new(&film, &volume(), &ideal, 5).expect("a sampler");
    let exact_mm =
        displacement_errors_mm(sampler.points(), &sampler.readings_of_t(3).expect("readings"), &ideal).expect("errors");
    let linear_mm = model.linear_sample_mm(5, 3);
    let largest = |of: &[f64], from: &[f64]| of.iter().zip(from).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let (left, noise) = (largest(&exact_mm, &linear_mm), largest(&linear_mm, &model.mean_mm));
    assert!(left < 1e-2 * noise, "{left} of {noise}");
}

/// Moments of every common error: a field of any direction has a third of its mean square along
/// each axis, and the warming has mean and deviation times the coefficient.
#[test]
fn sources_have_the_moments_of_the_tolerance() {
    let mut tolerance = FilmTolerance::default();
    let any_direction_t = Distribution::Tabulated([1e-6, 3e-6].into());
    let field_t = [Distribution::normal(1e-6), Distribution::Fixed(2e-6), Distribution::NONE];
    tolerance.common.stray_field = Some(StrayField { field_t, any_direction_t, later: false });
    let change_k = Distribution::Tabulated([2.0, 8.0].into());
    tolerance.common.temperature = Some(Temperature { change_k, strength_per_k: -0.001 });
    let found = sources(&RealFilm::new(&tiles(), &tolerance));
    assert_eq!(found.len(), 4 * 12 + 23 + 3);
    // Uniform between 1 and 3: mean 2, variance 1/3, mean square 13/3. Between 2 and 8: variance 3.
    let third = 13.0 / 9.0 * 1e-12;
    let wanted = [
        (ErrorSource::StrayField(0), 0.0, 1e-12 + third),
        (ErrorSource::StrayField(1), 2e-6, third),
        (ErrorSource::StrayField(2), 0.0, third),
        (ErrorSource::Temperature, -0.005, 3e-6),
    ];
    for (source, moments) in found {
        let (mean, variance) =
            wanted.iter().find(|(of, ..)| *of == source).map_or((0.0, 0.0), |(_, mean, variance)| (*mean, *variance));
        let agrees = (moments.mean - mean).abs() <= 1e-15 && (moments.variance - variance).abs() <= 1e-12 * variance;
        assert!(agrees, "{source:?}: {moments:?}, not {mean} {variance}");
    }
}

/// Points above the film, and points where a derivative or a parameter does not exist.
#[test]
fn volumes_without_a_model_are_refused() {
    let film = RealFilm::new(&tiles(), &FilmTolerance::default());
    let at = |z: f64| {
        let lower = DVec3::new(-1.0, -1.0, z);
        EvaluationGrid {
            grid: Grid::new(lower, lower, [1; 3]).expect("a point"),
            reference: DVec3::new(0.0, 0.0, -4.0),
        }
    };
    let above = FirstOrder::new(&film, &at(0.5), &ideal());
    let point = DVec3::new(-1.0, -1.0, 0.5);
    assert_eq!(above.err(), Some(crate::SampleError::NotBelow { point }));
    assert!(FirstOrder::new(&film, &at(-0.5), &ideal()).is_ok());
    // B_z = 0 at one point, then at the reference point.
    let points = [DVec3::new(1.0, 0.0, -4.0), DVec3::new(-1.0, 0.0, -4.0), DVec3::new(0.0, 0.0, -4.0)];
    let (level, upright) = (DVec3::X, DVec3::Z);
    let singular = crate::SampleError::Singular { points: vec![points[1]] };
    let of = |b_t: [DVec3; 3]| {
        [displacement_errors_mm(&points, &b_t, &ideal()).err(), Displacement::new(&points, &b_t, &ideal()).err()]
    };
    assert_eq!(of([upright, level, upright]), [Some(singular.clone()), Some(singular)]);
    assert!(of([upright, upright, level]).iter().all(Option::is_some));
    assert_eq!(of([upright; 3]), [None, None]);
}
