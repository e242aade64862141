//! Bounds of the sum of magnitudes.

use glam::DVec3;
use magsplice_direct::magnitude::MagnitudeBounds;
use magsplice_magnet::Tile;
use magsplice_simd::InstructionSet;
use magsplice_simd::column::Column;

/// Three groups: cubes, cubes too small for single precision, and one cube alone.
fn tiles() -> Vec<Tile> {
    let mut tiles = Vec::new();
    for (count, x, size) in [(16, 0.0, 1.0), (16, 40.0, 0.01), (1, 80.0, 1.0)] {
        for number in 0..count {
            let position = DVec3::new(x + f64::from(number % 4), f64::from(number / 4), 0.0);
            tiles.push(Tile::new(position, DVec3::splat(size), DVec3::new(0.1, -0.5, 1.0)).expect("valid"));
        }
    }
    tiles
}

#[test]
fn the_bound_at_a_point_depends_on_no_other_point() {
    let bounds = MagnitudeBounds::new(&tiles(), &[1.0; 33]);
    assert!(bounds.in_single_precision().any(|is_single| !is_single));
    let points: Vec<DVec3> = (0..400).map(|i| DVec3::new(0.3 * f64::from(i), 1.1, 0.2 * f64::from(i % 7))).collect();
    for set in InstructionSet::available() {
        let level = set.detected().expect("available");
        let at = |points: &[DVec3]| {
            let mut written = Column::default();
            bounds.write(level, points.iter().copied(), &mut written);
            written[..points.len()].to_vec()
        };
        let together = at(&points);
        for (&point, bound) in points.iter().zip(together) {
            assert_eq!(at(&[point]), [bound], "{point} with {set:?}");
        }
    }
}
