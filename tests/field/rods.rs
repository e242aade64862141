//! Rods, whose longest side is many times the others, alone and among other tiles.

use glam::DVec3;
use magsplice_field::{EXACT_BOUND, MU_0, Quantity, Scene, Tile};
use magsplice_tests::cases;
use magsplice_tests::oracle::Oracle;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Rods on a lattice, some of them of equal J, and a cube at every fifth lattice point.
fn bundle(random: &mut ChaCha8Rng) -> Vec<Tile> {
    let length = 10_f64.powf(random.random_range(0.5..4.0));
    let along = random.random_range(0..3_usize);
    let common = DVec3::new(0.4, -0.3, 0.9);
    let tile = |n: usize| {
        let (row, column) = ((n / 4) as f64, (n % 4) as f64);
        let (mut position, mut size) = (DVec3::ZERO, DVec3::ONE);
        (position[(along + 1) % 3], position[(along + 2) % 3]) = (1.25 * row, 1.25 * column);
        if n % 5 != 4 {
            (size[along], size[(along + 1) % 3]) = (length, random.random_range(0.2..1.0));
        }
        let j = DVec3::from([0, 1, 2].map(|_| random.random_range(-1.0..1.0)));
        Tile::new(position, size, if n.is_multiple_of(3) { common } else { j }).expect("a valid tile")
    };
    (0..12).map(tile).collect()
}

/// The exact field of rods in a cluster keeps its bound near the rods, between them, beyond their
/// ends and far away.
#[test]
fn bundles_of_rods_keep_the_exact_bound() {
    let mut random = ChaCha8Rng::seed_from_u64(24);
    let mut oracle = Oracle::for_moderate_scenes();
    let mut worst = 0.0_f64;
    for _ in 0..cases(300) {
        let tiles = bundle(&mut random);
        let scene = Scene::new(&tiles);
        let points: Vec<DVec3> = (0..8)
            .map(|_| {
                let tile = &tiles[random.random_range(0..tiles.len())];
                let distance = 10_f64.powf(random.random_range(-1.0..2.0));
                let place = DVec3::from([0, 1, 2].map(|_| random.random_range(-0.5..0.5)));
                tile.position() + place * (tile.size() + 2.0 * distance)
            })
            .filter(|point| {
                let gap = |tile: &Tile| ((*point - tile.position()).abs() - 0.5 * tile.size()).max_element();
                tiles.iter().all(|tile| gap(tile) > 1e-3)
            })
            .collect();
        let found = scene.field_at(Quantity::FieldStrength, &points).expect("points off all edges");
        for (point, found) in points.into_iter().zip(found) {
            let (mut exact, mut magnitude_t) = (DVec3::ZERO, 0.0);
            for tile in &tiles {
                exact += oracle.field(tile, point).strength_t;
                for axis in DVec3::AXES {
                    let j_t = tile.polarization_t() * axis;
                    let part = Tile::new(tile.position(), tile.size(), j_t).expect("a valid tile");
                    magnitude_t += oracle.field(&part, point).strength_t.length();
                }
            }
            let error = (found * MU_0 - exact).length() / magnitude_t;
            assert!(error <= EXACT_BOUND, "{error:e} of the sum over tiles at {point} of {tiles:?}");
            worst = worst.max(error);
        }
    }
    assert!(worst > 3e-16, "{worst:e}");
}
