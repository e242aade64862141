//! Rotations that share a frame: rotations that are equal up to quarter turns.
//!
//! A cuboid turned by a multiple of 90 degrees is a cuboid with permuted sizes. Tiles whose
//! rotations differ by quarter turns therefore share a frame. Frames with a common axis, such as
//! the frames of tiles turned about z, share the coordinates along it, so that faces of touching
//! tiles can be compared and their seams found.

use glam::{DMat3, DQuat, DVec3};
use rustc_hash::FxHashMap;

use magsplice_magnet::tolerances::SAME_ROTATION;

use crate::tolerances::DIRECTION_CELL;

/// A rotation that maps axes onto axes: own axis `c` points along `sign[c]` times frame axis
/// `axis[c]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuarterTurn {
    axis: [usize; 3],
    sign: [f64; 3],
}

impl QuarterTurn {
    /// A vector of the tile's own frame in the shared frame, without rounding.
    pub fn vector(&self, own: DVec3) -> DVec3 {
        let mut turned = DVec3::ZERO;
        for c in 0..3 {
            turned[self.axis[c]] = self.sign[c] * own[c];
        }
        turned
    }

    /// Side lengths of the tile along the axes of the shared frame.
    pub fn size(&self, own: DVec3) -> DVec3 {
        self.vector(own).abs()
    }
}

/// The directions and frames of a scene.
pub struct Orientations {
    /// Directions of all axes, each towards +x, or +y if its x component is zero, or +z. The first
    /// three are x, y, z.
    pub directions: Vec<DVec3>,
    /// Indices of the three directions of each frame. The first frame is the frame of the scene.
    pub frames: Vec<[usize; 3]>,
    /// Frame of each rotation, and its quarter turn within the frame.
    pub members: Vec<(usize, QuarterTurn)>,
}

impl Orientations {
    /// Finds the frames of rotations.
    pub fn new(rotations: &[DQuat]) -> Orientations {
        let mut directions = Directions::default();
        for axis in DVec3::AXES {
            directions.index_and_sign(axis);
        }
        let mut frames = vec![[0, 1, 2]];
        let mut known = FxHashMap::from_iter([([0, 1, 2], 0)]);
        let mut members = Vec::with_capacity(rotations.len());
        for rotation in rotations {
            let matrix = DMat3::from_quat(*rotation);
            let own = [0, 1, 2].map(|axis| directions.index_and_sign(matrix.col(axis)));
            let mut axes = own.map(|(index, _)| index);
            axes.sort_unstable();
            let frame = *known.entry(axes).or_insert_with(|| {
                frames.push(axes);
                frames.len() - 1
            });
            let place = |index: usize| axes.iter().position(|&axis| axis == index).expect("the frame has this axis");
            let turn = QuarterTurn { axis: own.map(|(index, _)| place(index)), sign: own.map(|(_, sign)| sign) };
            members.push((frame, turn));
        }
        Orientations { directions: directions.found, frames, members }
    }

    /// Matrix from the frame to the scene. Its columns need not be right-handed.
    pub fn matrix(&self, frame: usize) -> DMat3 {
        let [x, y, z] = self.frames[frame].map(|axis| self.directions[axis]);
        DMat3::from_cols(x, y, z)
    }
}

/// Directions found so far, with a lookup by their components.
#[derive(Default)]
struct Directions {
    found: Vec<DVec3>,
    by_cell: FxHashMap<[i64; 3], Vec<usize>>,
}

impl Directions {
    /// Index of a direction or its opposite, and the sign. An unknown direction is added.
    fn index_and_sign(&mut self, axis: DVec3) -> (usize, f64) {
        let leading = axis.to_array().into_iter().find(|c| c.abs() > SAME_ROTATION).unwrap_or(1.0);
        let sign = leading.signum();
        let direction = axis * sign;
        let close = |i: &&usize| (self.found[**i] - direction).abs().max_element() <= SAME_ROTATION;
        // A direction is filed under the cell of its components. A direction equal up to round-off
        // may be in a neighbouring cell.
        let [low, high] = [-SAME_ROTATION, SAME_ROTATION].map(|shift| cell(direction + DVec3::splat(shift)));
        for corner in 0..8_usize {
            let key = [0, 1, 2].map(|axis: usize| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] });
            if let Some(&known) = self.by_cell.get(&key).and_then(|near| near.iter().find(close)) {
                return (known, sign);
            }
        }
        self.found.push(direction);
        self.by_cell.entry(cell(direction)).or_default().push(self.found.len() - 1);
        (self.found.len() - 1, sign)
    }
}

fn cell(direction: DVec3) -> [i64; 3] {
    direction.to_array().map(|c| (c / DIRECTION_CELL).floor() as i64)
}
