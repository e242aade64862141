//! Merging of tiles of one polarization that form a cuboid.
//!
//! A uniform body has no seam in its field, but the terms of two blocks grow without bound on their
//! seam and cancel. A merged block avoids these terms: its gradient is exact on the former seam,
//! and its evaluation is faster.

use magsplice_cuboid::block::Block;
use magsplice_simd::compensated_sum::TwoSum;
use rustc_hash::FxHashMap;

/// The properties that two blocks in contact along an axis must share to be merged: plane, outline
/// and polarization, bit by bit.
#[derive(PartialEq, Eq, Hash)]
struct Contact {
    plane: [u64; 2],
    outline: [[[u64; 2]; 2]; 2],
    polarization: [u64; 3],
}

/// Merges blocks until no two of them form a cuboid.
pub fn merged(blocks: &[Block]) -> Vec<Block> {
    let mut blocks: Vec<Option<Block>> = blocks.iter().cloned().map(Some).collect();
    loop {
        let before = blocks.len();
        for axis in 0..3 {
            merge_along(&mut blocks, axis);
            blocks.retain(Option::is_some);
        }
        if blocks.len() == before {
            return blocks.into_iter().flatten().collect();
        }
    }
}

fn merge_along(blocks: &mut [Option<Block>], axis: usize) {
    let mut by_lower: FxHashMap<Contact, usize> = FxHashMap::default();
    for (index, block) in blocks.iter().enumerate() {
        by_lower.insert(contact(block.as_ref().expect("only whole blocks are kept"), axis, 0), index);
    }
    for index in 0..blocks.len() {
        // A block absorbs its upper neighbours one after the other. An absorbed block cannot be
        // found again, because no other block touches its lower face.
        while let Some(block) = &blocks[index] {
            let Some(other) = by_lower.remove(&contact(block, axis, 1)).filter(|&other| other != index) else { break };
            let Some(upper) = blocks[other].take() else { break };
            let block = blocks[index].as_mut().expect("the block that grows");
            block.faces[axis][1] = upper.faces[axis][1];
            block.moved[axis][1] = upper.moved[axis][1];
            for across in [(axis + 1) % 3, (axis + 2) % 3] {
                for (own, other) in block.moved[across].iter_mut().zip(upper.moved[across]) {
                    *own = own.max(other);
                }
            }
            block.size[axis] = block.faces[axis][1].minus(block.faces[axis][0]).value();
            block.tile = block.tile.min(upper.tile);
        }
    }
}

fn contact(block: &Block, axis: usize, face: usize) -> Contact {
    let bits = |t: TwoSum| [t.hi, t.lo].map(|part| (part + 0.0).to_bits());
    let outline = [(axis + 1) % 3, (axis + 2) % 3].map(|across| block.faces[across].map(bits));
    let polarization = block.polarization_t.to_array().map(|j| (j + 0.0).to_bits());
    Contact { plane: bits(block.faces[axis][face]), outline, polarization }
}
