//! Films with errors of their tiles, against percentiles from an independent computation with 400
//! samples of each case.

use magsplice::decouple::Parameter;
use magsplice::prelude::*;
use magsplice::tolerance::{Estimate, EvaluationGrid, RealFilm, Sampled, TileErrors};

use crate::shipped::layout;

/// Samples of each case, as many as in the independent computation.
const SAMPLES: u64 = 400;

fn sampled(name: &str, errors: TileErrors) -> Sampled {
    let layout = layout(name);
    let (volume, ideal) = (layout.volume.as_ref().expect("stated"), layout.ideal.expect("stated"));
    let volume = EvaluationGrid { grid: volume.grid, reference: volume.reference_mm };
    let tiles = layout.bare_tiles();
    let film = RealFilm::new(&tiles, &vec![errors; tiles.len()]);
    Sampled::new(&film, &volume, &ideal, 1, 0..SAMPLES).expect("every sample has its parameters")
}

/// Whether a known value of as many samples agrees with an estimate: the difference of two estimates
/// has 2^1/2 times the error of one. The interval of 95 % is widened to that of 99.7 %, with the
/// rounding of the known value. Its longer half counts, since the other estimate may lie on the other
/// side.
fn agrees(found: Estimate, known: f64, rounding: f64) -> bool {
    let widened = 2.0_f64.sqrt() * 3.0 / 1.96;
    let half = found.interval.map(|end| (end - found.value).abs()).into_iter().fold(0.0, f64::max);
    (known - found.value).abs() <= widened * half + rounding
}

#[test]
fn published_film_with_misplaced_tiles_has_the_known_mean_uniformity() {
    let errors = TileErrors { position: DVec3::new(0.05, 0.05, 0.0), ..TileErrors::default() };
    let sampled = sampled("published-film", errors);
    for (parameter, mean) in [(Parameter::Rx, 0.0646), (Parameter::Ry, 0.0646), (Parameter::Sz, 0.041)] {
        let found = sampled.uniformity_rmse(parameter).expect("samples").mean;
        let rounding = if parameter == Parameter::Sz { 5e-4 } else { 5e-5 };
        assert!(agrees(found, mean, rounding), "{parameter:?}: {found:?}, not {mean}");
    }
}

/// P95 of the displacement error along x, in mm.
#[test]
fn films_with_each_cause_of_error_have_the_known_displacement_errors() {
    let none = TileErrors::default();
    let causes = [
        TileErrors { position: DVec3::new(0.05, 0.05, 0.0), ..none },
        TileErrors { position: DVec3::new(0.0, 0.0, 0.05), ..none },
        TileErrors { rotation_rad: DVec3::splat(0.5_f64.to_radians()), ..none },
        TileErrors { strength: 0.01, ..none },
        TileErrors { direction_rad: 1.0_f64.to_radians(), ..none },
        TileErrors { size: DVec3::splat(0.02), ..none },
        TileErrors::WORKSHOP_MM,
        TileErrors { direction_rad: 1.0_f64.to_radians(), size: DVec3::splat(0.02), ..TileErrors::WORKSHOP_MM },
    ];
    let known = [
        ("published-film", [0.257, 0.258, 0.256, 0.249, 0.271, 0.262, 0.268, 0.290]),
        ("designed-cuts", [0.018, 0.019, 0.013, 0.010, 0.026, 0.018, 0.0281, 0.0397]),
        ("designed-displacement", [0.019, 0.016, 0.015, 0.008, 0.032, 0.020, 0.0303, 0.0475]),
        ("designed-tilted", [0.017, 0.011, 0.012, 0.006, 0.027, 0.013, 0.0232, 0.0364]),
    ];
    let mut apart = Vec::new();
    for (name, known) in known {
        for (number, (errors, known)) in causes.into_iter().zip(known).enumerate() {
            let p95 = sampled(name, errors).displacement_rmse(0).expect("samples").p95;
            if !agrees(p95, known, 5e-4) {
                apart.push(format!("{name}, cause {number}: {p95:?}, not {known}"));
            }
        }
    }
    assert!(apart.is_empty(), "{apart:#?}");
}

#[test]
fn samples_of_parts_are_those_of_the_whole_for_any_number_of_threads() {
    let layout = layout("designed-tilted");
    let (volume, ideal) = (layout.volume.as_ref().expect("stated"), layout.ideal.expect("stated"));
    let volume = EvaluationGrid { grid: volume.grid, reference: volume.reference_mm };
    let tiles = layout.bare_tiles();
    let film = RealFilm::new(&tiles, &vec![TileErrors::WORKSHOP_MM; tiles.len()]);
    let sampled = |threads: usize, samples: std::ops::Range<u64>| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| Sampled::new(&film, &volume, &ideal, 9, samples)).expect("parameters").errors
    };
    let whole = sampled(1, 0..9);
    let parts = [sampled(3, 0..4), sampled(2, 4..5), sampled(4, 5..9)].concat();
    assert_eq!(whole, parts);
}
