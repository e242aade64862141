//! A cuboid prepared for evaluation in a frame shared with its neighbours.

use glam::DVec3;
use magsplice_simd::compensated_sum::TwoSum;
use magsplice_simd::power_of_two::power_of_two_reciprocal;

use crate::scalar::offsets::Offsets;
use crate::tolerances::{
    EXACT_BOUND, FACE_NUDGE, MOVED_FACE_ERROR, RESOLVED_THICKNESS, SMALLEST_NUDGE, VANISHING_SIZE,
};

/// A cuboid aligned with its frame.
#[derive(Clone, Debug)]
pub struct Block {
    /// Index of the tile in the scene.
    pub tile: usize,
    /// Lower and upper face along each axis.
    pub faces: [[TwoSum; 2]; 3],
    /// Side lengths.
    pub size: [f64; 3],
    /// Distance of each face from where its tile puts it, by joining with other faces.
    pub moved: [[f64; 2]; 3],
    /// Polarization in the shared frame, in tesla.
    pub polarization_t: DVec3,
    /// Smallest distance of a point from a face.
    nudge: f64,
}

/// A point in the frame of a block.
pub struct LocalPoint {
    /// Coordinates in the frame.
    pub coordinates: [f64; 3],
    /// Bound of the error of each coordinate. A point within that distance of a face is on the
    /// face.
    pub roundoff: [f64; 3],
}

/// Position of a point relative to a block.
pub struct PlacedPoint {
    /// Offsets from the faces along each axis, scaled.
    pub offsets: [Offsets<f64>; 3],
    /// The power-of-two factor in `offsets`.
    pub scale: f64,
}

impl PlacedPoint {
    /// Whether the point is on an edge or on the extension of an edge.
    pub fn on_edge_line(&self) -> bool {
        self.offsets.iter().filter(|o| o.on_face).count() >= 2
    }

    /// Whether the point is inside the block.
    pub fn inside(&self) -> bool {
        self.offsets.iter().all(Offsets::within)
    }
}

impl Block {
    /// A block around `centre`. `smallest_size` is the smallest size in the scene.
    pub fn new(tile: usize, centre: DVec3, size: DVec3, polarization_t: DVec3, smallest_size: f64) -> Block {
        let faces = [0, 1, 2].map(|axis| {
            let half = 0.5 * size[axis];
            [TwoSum::new(centre[axis], -half), TwoSum::new(centre[axis], half)]
        });
        let nudge = (FACE_NUDGE * smallest_size).max(SMALLEST_NUDGE * size.max_element());
        Block { tile, faces, size: size.to_array(), moved: [[0.0; 2]; 3], polarization_t, nudge }
    }

    /// Error bound of the field over [`EXACT_BOUND`]: 1, and more where faces were moved.
    pub fn error_weight(&self) -> f64 {
        let moved = self.moved.iter().flatten().sum::<f64>();
        let least = self.size.into_iter().fold(f64::INFINITY, f64::min);
        1.0 + MOVED_FACE_ERROR * moved / least / EXACT_BOUND
    }

    /// Position of a point, scaled by a power of two so that the largest offset is between 1 and 2;
    /// `None` if the field of the block vanishes at that distance.
    pub fn place(&self, point: &LocalPoint) -> Option<PlacedPoint> {
        let offsets = [0, 1, 2].map(|axis| self.offsets(axis, point.coordinates[axis], point.roundoff[axis]));
        let farthest = offsets.iter().map(|o| o.far).fold(0.0, f64::max);
        let scale = power_of_two_reciprocal(farthest);
        let largest = self.size.iter().copied().fold(0.0, f64::max);
        (largest * scale >= VANISHING_SIZE).then(|| PlacedPoint { offsets: offsets.map(|o| o.scaled(scale)), scale })
    }

    /// Distance of a point from the block; zero inside.
    pub fn gap(&self, point: &LocalPoint) -> f64 {
        let along = [0, 1, 2].map(|axis: usize| {
            let ([low, high], at) = (self.faces[axis], point.coordinates[axis]);
            (low.hi - at).max(at - high.hi).max(0.0)
        });
        DVec3::from(along).length()
    }

    fn offsets(&self, axis: usize, coordinate: f64, roundoff: f64) -> Offsets<f64> {
        let point = TwoSum::exact(coordinate);
        let from_low = point.minus(self.faces[axis][0]);
        let from_high = point.minus(self.faces[axis][1]);
        let sum = (from_low.hi + from_high.hi) + (from_low.lo + from_high.lo);
        let mirrored = sum < 0.0;
        let (near, far) =
            if mirrored { (-from_low.value(), -from_high.value()) } else { (from_high.value(), from_low.value()) };
        let (size, sum) = (self.size[axis], sum.abs());
        let on_face = near == 0.0 || (near.abs() <= roundoff && roundoff * RESOLVED_THICKNESS <= size);
        // The lower face belongs to the block, the upper face does not.
        let inside = if on_face { mirrored } else { near < 0.0 };
        if !on_face && near.abs() >= self.nudge {
            return Offsets { near, far, sum, size, mirrored, on_face };
        }
        let near = if inside { -self.nudge } else { self.nudge };
        let far = near + size;
        Offsets { near, far, sum: near + far, size, mirrored, on_face }
    }
}

impl Offsets<f64> {
    fn scaled(self, scale: f64) -> Offsets<f64> {
        Offsets {
            near: self.near * scale,
            far: self.far * scale,
            sum: self.sum * scale,
            size: self.size * scale,
            ..self
        }
    }
}
