//! Hill climbs on the errors of the exact field and of the gradient.
//!
//! A climb changes the sides of a tile and the place of a point, and keeps each change that
//! increases the error. It finds errors that random tiles reach once in millions.

use glam::{DMat3, DVec3};
use magsplice_field::{EXACT_BOUND, GRADIENT_BOUND, InstructionSet, Quantity, Scene, Tile};
use magsplice_tests::oracle::Oracle;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::scene_numbers;

/// Random places among which the best begins a climb.
const FIRST: usize = 8;

/// Steps of a climb.
const STEPS: usize = if cfg!(feature = "all-cases") { 300 } else { 40 };

/// A tile with its longest side 1 and one component of J, and a point.
#[derive(Clone, Copy, Debug)]
struct Place {
    size: DVec3,
    axis: usize,
    point: DVec3,
}

impl Place {
    /// A place with the coordinates of a seed: two sides, direction and distance of the point.
    fn new(seed: [f64; 6], axes: usize) -> Place {
        let side = |s: f64| 10_f64.powf(-2.0 * s.abs().min(1.0));
        let sides = [1.0, side(seed[0]), side(seed[1])];
        let size = DVec3::from([0, 1, 2].map(|axis: usize| sides[(axis + axes) % 3]));
        // From 1e-4 to 30 sides off the faces, and inside.
        let gap = if seed[5] < -0.8 { 0.0 } else { 10_f64.powf(-4.0 + 5.5 * 0.55 * (seed[5].min(1.0) + 0.8)) };
        let direction = DVec3::new(seed[2], seed[3], seed[4]).clamp(DVec3::NEG_ONE, DVec3::ONE);
        Place { size, axis: axes / 3 % 3, point: direction * (0.5 * size + gap) }
    }

    fn tile(&self) -> Tile {
        Tile::new(DVec3::ZERO, self.size, DVec3::AXES[self.axis]).expect("a valid tile")
    }

    /// Largest error of B with any instruction set, over the exact magnitude; 0 on an edge.
    fn field_error(&self, oracle: &mut Oracle) -> f64 {
        let exact = oracle.field(&self.tile(), self.point).flux_density_t;
        let error = |set: InstructionSet| {
            let scene = Scene::new(&[self.tile()]).with_instruction_set(set).expect("available");
            scene.field(Quantity::FluxDensity, self.point).map_or(0.0, |b| (b - exact).length() / exact.length())
        };
        InstructionSet::available().into_iter().map(error).fold(0.0, f64::max)
    }

    /// [`Place::field_error`] of the largest component of the gradient.
    fn gradient_error(&self, oracle: &mut Oracle) -> f64 {
        let exact = oracle.gradient(&self.tile(), self.point);
        let error = |set: InstructionSet| {
            let scene = Scene::new(&[self.tile()]).with_instruction_set(set).expect("available");
            let found = scene.gradient(Quantity::FluxDensity, self.point);
            found.map_or(0.0, |found| largest(found - exact) / largest(exact))
        };
        InstructionSet::available().into_iter().map(error).fold(0.0, f64::max)
    }
}

fn largest(gradient: DMat3) -> f64 {
    gradient.to_cols_array().into_iter().map(f64::abs).fold(0.0, f64::max)
}

/// The largest error of a climb, and its place.
fn climb(number: u64, error: impl Fn(&Place, &mut Oracle) -> f64) -> (f64, Place) {
    let mut random = ChaCha8Rng::seed_from_u64(number);
    let mut oracle = Oracle::for_moderate_scenes();
    let axes = random.random_range(0..9);
    let mut best = (0.0, [0.0; 6]);
    for step in 0..FIRST + STEPS {
        let mut seed = best.1;
        let reach = 0.3 * 1e-3_f64.powf(step.saturating_sub(FIRST) as f64 / STEPS as f64);
        for value in &mut seed {
            let change: f64 = random.random_range(-1.0..1.0);
            *value = if step < FIRST { change } else { *value + reach * change };
        }
        let found = error(&Place::new(seed, axes), &mut oracle);
        if found > best.0 {
            best = (found, seed);
        }
    }
    (best.0, Place::new(best.1, axes))
}

/// Climbs of these numbers keep a bound. The worst is above a two-hundredth of it.
fn check(numbers: std::ops::Range<u64>, bound: f64, error: impl Fn(&Place, &mut Oracle) -> f64 + Sync) {
    let climbs = numbers.into_par_iter().map(|number| climb(number, &error));
    let (worst, place) = climbs.reduce_with(|a, b| if a.0 >= b.0 { a } else { b }).expect("climbs");
    println!("largest error {worst:e} of {bound:e}, {place:?}");
    assert!(worst <= bound, "{worst:e}, {place:?}");
    assert!(worst > 0.005 * bound, "{worst:e}");
}

#[test]
fn climbs_keep_the_bound_of_the_field() {
    let all = cfg!(feature = "all-cases");
    check(0..if all { 10_000 } else { 30 }, EXACT_BOUND, Place::field_error);
}

#[test]
fn climbs_keep_the_bound_of_the_gradient() {
    let all = cfg!(feature = "all-cases");
    check(0..if all { 2_000 } else { 4 }, GRADIENT_BOUND, Place::gradient_error);
}

/// Random tiles and points, as many as `MAGSPLICE_SCENES` asks for.
#[test]
fn random_places_keep_the_bound_of_the_field() {
    let error = |oracle: &mut Oracle, number: u64| {
        let mut random = ChaCha8Rng::seed_from_u64(number);
        let axes = random.random_range(0..9);
        let place = Place::new([(); 6].map(|()| random.random_range(-1.0..1.0)), axes);
        (place.field_error(oracle), place)
    };
    let all = scene_numbers(1000).into_par_iter().map_init(Oracle::for_moderate_scenes, error);
    let (worst, place) = all.reduce_with(|a, b| if a.0 >= b.0 { a } else { b }).expect("places");
    println!("largest error {worst:e} of {EXACT_BOUND:e}, {place:?}");
    assert!(worst <= EXACT_BOUND && worst > 1e-3 * EXACT_BOUND, "{worst:e}, {place:?}");
}

/// Tops of longer climbs.
#[test]
fn tops_of_climbs_keep_the_bound_of_the_field() {
    let mut oracle = Oracle::for_moderate_scenes();
    let place = |size: [f64; 3], axis: usize, point: [f64; 3]| Place { size: size.into(), axis, point: point.into() };
    for place in [
        place([0.0675, 0.979, 0.563], 2, [-0.03932, -0.02229, 0.2831]),
        place(
            [0.6420200754731988, 0.07733627237042373, 0.19739512870439094],
            1,
            [0.0090545904425689, 0.03856244391628222, -2.7712911439454633],
        ),
        place([1.0, 0.1015625, 0.1015625], 0, [0.0009765625, 0.05859375, -0.0439453125]),
    ] {
        let error = place.field_error(&mut oracle);
        assert!(error <= EXACT_BOUND, "{error:e}, {place:?}");
    }
}
