//! Time of one pair of tiles: with parallel edges near and far, and turned against each other.

use std::hint::black_box;
use std::time::Instant;

use glam::{DQuat, DVec3};
use magsplice_force::pair_loads;
use magsplice_magnet::Tile;

fn main() {
    let tile =
        |x: f64| Tile::new(DVec3::new(x, 0.5, 0.25), DVec3::new(3.3, 1.7, 1.0), DVec3::new(0.12, 0.0, 0.05)).unwrap();
    let first = Tile::new(DVec3::ZERO, DVec3::splat(2.0), DVec3::new(0.0, 0.12, 0.1)).unwrap();
    let turned = |x: f64| tile(x).rotated(DQuat::from_rotation_z(0.3)).unwrap();
    for (name, second, repeats) in [
        ("in contact", tile(2.65), 1000),
        ("near", tile(8.0), 1000),
        ("far", tile(300.0), 10_000),
        ("turned, near", turned(3.5), 20),
        ("turned, far", turned(30.0), 100),
    ] {
        let start = Instant::now();
        for _ in 0..repeats {
            let _ = black_box(pair_loads(black_box(&first), black_box(&second), 1e-9));
        }
        println!("{name:14} {:10.2} us", 1e6 * start.elapsed().as_secs_f64() / f64::from(repeats));
    }
}
