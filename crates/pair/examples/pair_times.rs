//! Time of one pair of tiles, with parallel edges near and far, and turned against each other:
//!
//!     cargo run --release -p magsplice-pair --example pair_times

use std::hint::black_box;
use std::time::Instant;

use glam::{DQuat, DVec3};
use magsplice_magnet::Tile;
use magsplice_pair::{load_in_f64, mean_tensor, pair_loads};

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
        let time = |run: &dyn Fn()| {
            let start = Instant::now();
            (0..repeats).for_each(|_| run());
            1e6 * start.elapsed().as_secs_f64() / f64::from(repeats)
        };
        let (first, second) = (black_box(&first), black_box(&second));
        let loads = time(&|| _ = black_box(pair_loads(first, second, 1e-9)));
        let in_f64 = time(&|| _ = black_box(load_in_f64(first, second, 1e-9)));
        let tensor = time(&|| _ = black_box(mean_tensor(first, second)));
        println!("{name:14} {loads:10.2} us, in f64 {in_f64:10.2} us, mean tensor {tensor:10.2} us");
    }
}
