//! Tiles that form a cuboid.

use glam::DVec3;
use magsplice_cuboid::block::Block;
use magsplice_direct::prepare::merge::merged;
use magsplice_simd::compensated_sum::TwoSum;

fn block(tile: usize, low: [f64; 3], high: [f64; 3], j: f64) -> Block {
    let (low, high) = (DVec3::from(low), DVec3::from(high));
    Block::new(tile, 0.5 * (low + high), high - low, DVec3::new(0.0, 0.0, j), 1.0)
}

#[test]
fn a_divided_block_becomes_whole() {
    let mut parts = Vec::new();
    for i in 0..4 {
        for j in 0..3 {
            let (x, y) = (f64::from(3 - i), f64::from(j));
            parts.push(block(parts.len(), [x, y, 0.0], [x + 1.0, y + 1.0, 2.0], 1.0));
        }
    }
    let whole = merged(&parts);
    assert_eq!(whole.len(), 1);
    assert_eq!(whole[0].faces.map(|f| f.map(TwoSum::value)), [[0.0, 4.0], [0.0, 3.0], [0.0, 2.0]]);
    assert_eq!((whole[0].size, whole[0].tile), ([4.0, 3.0, 2.0], 0));
}

#[test]
fn other_polarizations_outlines_and_gaps_stay_apart() {
    let parts = [
        block(0, [0.0; 3], [1.0; 3], 1.0),
        block(1, [1.0, 0.0, 0.0], [2.0, 1.0, 1.0], -1.0),
        block(2, [0.0, 1.0, 0.0], [1.0, 2.0, 1.5], 1.0),
        block(3, [0.0, 0.0, 1.25], [1.0, 1.0, 2.0], 1.0),
    ];
    assert_eq!(merged(&parts).len(), 4);
}
