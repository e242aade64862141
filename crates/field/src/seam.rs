//! Faces that are meant to be one plane become one.
//!
//! Two touching tiles are given by centres and sizes, and `position + size / 2` of the one need not round to
//! `position - size / 2` of the other. Between the two numbers a point would belong to both tiles or to none. Faces within a
//! few units of round-off of each other are therefore given one coordinate, which moves no face by more than that.

use crate::block::Block;
use crate::two_sum::TwoSum;

struct Face {
    coordinate: TwoSum,
    tolerance: f64,
    block: usize,
    upper: usize,
}

/// Gives faces of `blocks` along each axis that coincide up to `tolerance(block, axis)` one common coordinate.
pub(crate) fn join_faces(blocks: &mut [Block], tolerance: impl Fn(&Block, usize) -> f64) {
    for axis in 0..3 {
        let mut faces: Vec<Face> = Vec::with_capacity(2 * blocks.len());
        for (block, b) in blocks.iter().enumerate() {
            let tolerance = tolerance(b, axis);
            for upper in 0..2 {
                faces.push(Face { coordinate: b.faces[axis][upper], tolerance, block, upper });
            }
        }
        faces.sort_by(|a, b| a.coordinate.value().total_cmp(&b.coordinate.value()));
        let mut start = 0;
        while start < faces.len() {
            let first = &faces[start];
            let length = faces[start..]
                .iter()
                .take_while(|f| f.coordinate.minus(first.coordinate).value() <= f.tolerance.min(first.tolerance))
                .count();
            join(blocks, axis, &faces[start..start + length]);
            start += length;
        }
    }
}

fn join(blocks: &mut [Block], axis: usize, cluster: &[Face]) {
    let first = cluster[0].coordinate;
    let same = cluster.iter().all(|f| f.coordinate == first);
    // A tile thinner than the tolerance keeps its faces apart: its thickness is data.
    let mut owners: Vec<usize> = cluster.iter().map(|f| f.block).collect();
    owners.sort_unstable();
    let both_of_one = owners.windows(2).any(|pair| pair[0] == pair[1]);
    if same || both_of_one {
        return;
    }
    // The one nearest to a binary64 number is most likely what was meant, and points can lie on that number exactly.
    let meant = cluster.iter().map(|f| f.coordinate).min_by(|a, b| a.lo.abs().total_cmp(&b.lo.abs()));
    let common = meant.map_or(first, |face| TwoSum::exact(face.hi));
    for face in cluster {
        let block = &mut blocks[face.block];
        block.faces[axis][face.upper] = common;
        block.size[axis] = block.faces[axis][1].minus(block.faces[axis][0]).value();
    }
}
