//! Flat iron: planes that move with the film, and iron near it.

use glam::DVec3;
use magsplice_layout::{Distribution, FilmTolerance, NearIron};
use magsplice_magnet::{Axis, IronPlane, IronPlanes};

use super::{derivatives_are_exact, everything, ideal, tiles, volume};
use crate::first_order::{Cause, FirstOrder};
use crate::real_film::RealFilm;
use crate::sampler::Sampler;

/// Errors of every kind beside oblique iron.
fn near(later: bool) -> FilmTolerance {
    let mut all = everything(later);
    all.common.neighbour = None;
    all.common.iron = Some(NearIron {
        normal: DVec3::new(0.1, -0.2, -1.0).normalize(),
        distance_mm: 0.7,
        distance_error_mm: Distribution::Uniform { half_width: 0.2 },
        relative_permeability: 5.0,
        later,
    });
    all
}

/// A back plate, or two plates at an angle to the film.
fn plates() -> [IronPlanes; 2] {
    let plane = |point: [f64; 3], normal: [f64; 3], mu_r: f64| {
        IronPlane::new(point.into(), normal.into(), mu_r).expect("a plane")
    };
    let above = plane([0.0, 0.0, 2.5], [0.0, 0.0, -1.0], f64::INFINITY);
    let tilted = [plane([0.0, 0.0, 3.0], [0.1, 0.0, -1.0], 3.0), plane([0.0, 0.0, -9.0], [-0.1, 0.0, 1.0], 9.0)];
    [vec![above], tilted.to_vec()].map(|planes| IronPlanes::new(planes).expect("parallel planes"))
}

#[test]
fn derivatives_near_iron_are_those_of_the_exact_evaluation() {
    [false, true].iter().for_each(|later| derivatives_are_exact(&near(*later), &IronPlanes::default()));
}

#[test]
fn derivatives_of_films_on_iron_are_those_of_the_exact_evaluation() {
    plates().iter().for_each(|plates| derivatives_are_exact(&everything(false), plates));
}

/// Iron that comes later changes the displacements of a film without other errors by what it adds
/// to all readings but the first.
#[test]
fn iron_is_a_cause_of_its_own() {
    let iron = near(true).common.iron.map(|iron| NearIron { distance_error_mm: Distribution::NONE, ..iron });
    let mut tolerance = FilmTolerance::default();
    tolerance.common.iron = iron.clone();
    let (film, volume, ideal) = (RealFilm::new(&tiles(), &tolerance), volume(), ideal());
    let model = FirstOrder::new(&film, &volume, &ideal).expect("a model");
    let sampled = Sampler::new(&film, &volume, &ideal, 1).expect("a sampler").errors_of(0).expect("a sample");
    for axis in Axis::ALL {
        let errors = model.axis_errors(axis.index());
        assert_eq!(errors.shares.iter().map(|share| share.cause).collect::<Vec<_>>(), [Cause::Iron]);
        let sampled_mm2 = sampled.displacement_rmse_mm[axis].powi(2);
        assert!((errors.expected_mm2 - sampled_mm2).abs() < 1e-12 * sampled_mm2, "{errors:?}, not {sampled_mm2}");
        assert!((errors.expected_mm2 - errors.nominal_mm2).abs() > 1e-3, "{errors:?}");
    }
    // Iron that is there at all readings is another film.
    tolerance.common.iron = iron.map(|iron| NearIron { later: false, ..iron });
    let film = RealFilm::new(&tiles(), &tolerance);
    let before = Sampler::new(&film, &volume, &ideal, 1).expect("a sampler").errors_of(0).expect("a sample");
    assert!((before.displacement_rmse_mm.z - sampled.displacement_rmse_mm.z).abs() > 1e-3, "{before:?}");
}

/// A film that moves into the iron has no field there.
#[test]
fn films_in_iron_are_refused() {
    let mut tolerance = near(true);
    tolerance.common.film.position_mm[2] = Distribution::Fixed(1.5);
    let (film, volume, ideal) = (RealFilm::new(&tiles(), &tolerance), volume(), ideal());
    let found = Sampler::new(&film, &volume, &ideal, 1).expect("a sampler").errors_of(0);
    assert!(matches!(found, Err(crate::SampleError::InIron { depth_mm }) if depth_mm > 0.3), "{found:?}");
}
