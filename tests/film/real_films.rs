//! Films with errors of their tiles, against percentiles from an independent computation with 400
//! samples of each case.

use std::ops::Range;

use magsplice::decouple::Figures;
use magsplice::layout::{
    CommonErrors, Distribution, FilmPose, FilmTolerance, Preset, SensorErrors, StrayField, Temperature, TileErrors,
};
use magsplice::tolerance::{Estimate, EvaluationGrid, RealFilm, Sampler, statistics};

use crate::shipped::layout;

/// Samples of each case, as many as in the independent computation.
const SAMPLES: u64 = 400;

/// A shipped film with errors, and the errors of samples of it.
fn sampled(name: &str, tolerance: impl Fn(usize) -> FilmTolerance, samples: Range<u64>) -> Vec<Figures> {
    let layout = layout(name);
    let (volume, ideal) = (layout.volume.as_ref().expect("stated"), layout.ideal.expect("stated"));
    let volume = EvaluationGrid { grid: volume.grid, reference: volume.reference_mm };
    let tiles = layout.bare_tiles();
    let film = RealFilm::new(&tiles, &tolerance(tiles.len()));
    let sampler = Sampler::new(&film, &volume, &ideal, 1).expect("no neighbour");
    sampler.errors_of_range(samples, || {}).expect("every sample has its parameters")
}

fn normal(deviations: [f64; 3]) -> [Distribution; 3] {
    deviations.map(Distribution::normal)
}

/// Whether a known value of as many samples agrees with an estimate: the difference of two
/// estimates has 2^1/2 times the error of one. The interval of 95 % is widened to 99.7 %, plus the
/// rounding of the known value. Its longer half counts, because the other estimate may be on either
/// side.
fn agrees(found: Estimate, known: f64, rounding: f64) -> bool {
    let widened = 2.0_f64.sqrt() * 3.0 / 1.96;
    let half = found.interval.map(|end| (end - found.value).abs()).into_iter().fold(0.0, f64::max);
    (known - found.value).abs() <= widened * half + rounding
}

#[test]
fn published_film_with_misplaced_tiles_has_the_known_mean_uniformity() {
    let errors = TileErrors { position: normal([0.05, 0.05, 0.0]), ..TileErrors::default() };
    let sampled = sampled("published-film", |tiles| FilmTolerance::of_tiles(&errors, tiles), 0..SAMPLES);
    for (axis, mean) in [0.0646, 0.0646, 0.041].into_iter().enumerate() {
        let found = statistics(&sampled).expect("samples").uniformity_rmse.to_array()[axis].expect("defined").mean;
        let rounding = if axis == 2 { 5e-4 } else { 5e-5 };
        assert!(agrees(found, mean, rounding), "axis {axis}: {found:?}, not {mean}");
    }
}

/// P95 of the displacement error along x, in mm.
#[test]
fn films_with_each_cause_of_error_have_the_known_displacement_errors() {
    let none = TileErrors::default();
    let degree = || Distribution::normal(1.0_f64.to_radians());
    let (direction, size) = ([degree(), degree()], normal([0.02; 3]));
    let causes = [
        TileErrors { position: normal([0.05, 0.05, 0.0]), ..none.clone() },
        TileErrors { position: normal([0.0, 0.0, 0.05]), ..none.clone() },
        TileErrors { rotation: normal([0.5_f64.to_radians(); 3]), ..none.clone() },
        TileErrors { strength: Distribution::normal(0.01), ..none.clone() },
        TileErrors { direction: direction.clone(), ..none.clone() },
        TileErrors { size: size.clone(), ..none.clone() },
        Preset::Workshop.errors(),
        TileErrors { direction, size, ..Preset::Workshop.errors() },
    ];
    let known = [
        ("published-film", [0.257, 0.258, 0.256, 0.249, 0.271, 0.262, 0.268, 0.290]),
        ("designed-cuts", [0.018, 0.019, 0.013, 0.010, 0.026, 0.018, 0.0281, 0.0397]),
        ("designed-displacement", [0.019, 0.016, 0.015, 0.008, 0.032, 0.020, 0.0303, 0.0475]),
        ("designed-tilted", [0.017, 0.011, 0.012, 0.006, 0.027, 0.013, 0.0232, 0.0364]),
    ];
    let mut apart = Vec::new();
    for (name, known) in known {
        for (number, (errors, known)) in causes.iter().zip(known).enumerate() {
            let sampled = sampled(name, |tiles| FilmTolerance::of_tiles(errors, tiles), 0..SAMPLES);
            let p95 = statistics(&sampled).expect("samples").displacement_rmse_mm.x.p95;
            if !agrees(p95, known, 5e-4) {
                apart.push(format!("{name}, cause {number}: {p95:?}, not {known}"));
            }
        }
    }
    assert!(apart.is_empty(), "{apart:#?}");
}

/// Displacement errors along x and z, in mm, of designed-displacement with one cause outside its
/// tiles, from an independent computation, to its last digit.
#[test]
fn causes_outside_the_tiles_have_the_known_displacement_errors() {
    let fixed = |values: [f64; 3]| values.map(Distribution::Fixed);
    let half_degree = 0.5_f64.to_radians();
    let stray_field = |later| StrayField { field_t: fixed([50e-6, 0.0, 0.0]), later, ..StrayField::default() };
    let none = CommonErrors::default();
    let sensor = SensorErrors::default();
    let warm = Temperature { change_k: Distribution::Fixed(10.0), strength_per_k: -0.0012 };
    let cases = [
        (CommonErrors { stray_field: Some(stray_field(false)), ..none.clone() }, [0.043_797, 0.023_639], 1e-6),
        (CommonErrors { stray_field: Some(stray_field(true)), ..none.clone() }, [0.067_111, 0.023_639], 1e-6),
        (
            CommonErrors {
                sensor: SensorErrors { rotation_rad: fixed([0.0, 0.0, half_degree]), ..sensor.clone() },
                ..none.clone()
            },
            [0.016_400, 0.001_703],
            1e-6,
        ),
        (
            CommonErrors { sensor: SensorErrors { gain: fixed([0.0, 0.0, 0.01]), ..sensor.clone() }, ..none.clone() },
            [0.007_864, 0.008_967],
            1e-6,
        ),
        (
            CommonErrors {
                film: FilmPose { rotation_rad: fixed([half_degree, 0.0, 0.0]), ..FilmPose::default() },
                ..none.clone()
            },
            [0.003_202, 0.007_520],
            1e-6,
        ),
        (
            CommonErrors {
                film: FilmPose { position_mm: fixed([0.2, 0.0, 0.0]), ..FilmPose::default() },
                ..none.clone()
            },
            [0.000_063, 0.000_056],
            1e-6,
        ),
        (CommonErrors { temperature: Some(warm), ..none.clone() }, [0.000_056, 0.019_194], 1e-6),
        // The mean over samples varies with the noise of the one reading at the reference point.
        (
            CommonErrors { sensor: SensorErrors { noise_t: normal([5e-6; 3]), ..sensor }, ..none },
            [0.0115, 0.0056],
            4e-4,
        ),
    ];
    for (common, known, allowed) in cases {
        let tolerance = |_| FilmTolerance { common: common.clone(), ..FilmTolerance::default() };
        let samples = if allowed > 1e-5 { SAMPLES } else { 1 };
        let sampled = sampled("designed-displacement", tolerance, 0..samples);
        for (axis, known) in [0, 2].into_iter().zip(known) {
            let found = statistics(&sampled).expect("samples").displacement_rmse_mm.to_array()[axis].mean.value;
            assert!((found - known).abs() < allowed, "{common:?}, axis {axis}: {found}, not {known}");
        }
    }
}

#[test]
fn samples_of_parts_are_those_of_the_whole_for_any_number_of_threads() {
    let sampled = |threads: usize, samples: Range<u64>| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let tolerance = |tiles| FilmTolerance::of_tiles(&Preset::Workshop.errors(), tiles);
        pool.install(|| sampled("designed-tilted", tolerance, samples))
    };
    let whole = sampled(1, 0..9);
    let parts = [sampled(3, 0..4), sampled(2, 4..5), sampled(4, 5..9)].concat();
    assert_eq!(whole, parts);
}
