//! Derivatives of B with respect to the positions of the faces of a tile.
//!
//! Moving a face outwards by a small distance adds a thin layer of the tile's polarization
//! (docs/physics.md, section 6). The component of J normal to the layer acts as a current around
//! its rim, the component along it as charges on two of its four edges. Both are integrals over the
//! edges of the tile, which all six faces share.

use std::f64::consts::PI;

use glam::{DMat3, DQuat, DVec3};
use magsplice_magnet::Tile;

/// The derivatives of B at a point with respect to the positions of the faces of a tile.
///
/// Column `axis` of either matrix is the derivative with respect to the coordinate, along the
/// tile's own axis, of the face normal to it. The effect of any change of size or position follows
/// from them. A tile that moves along its axis moves both faces, so `-(lower + upper)` is the
/// gradient of B if the tile is not rotated. A tile that grows about its centre moves each face by
/// half of its growth.
///
/// # Units
/// Tesla per unit of length, in the frame of the scene.
///
/// # Accuracy
/// The error is at most 32 units of round-off of the sum of the contributions of the twelve edges.
/// Far away the edges cancel: at a distance of r sizes the relative error is about r^2 units.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use magsplice_cuboid::FaceDerivatives;
/// use magsplice_magnet::Tile;
///
/// let tile = Tile::new(DVec3::ZERO, DVec3::ONE, DVec3::Z).unwrap();
/// let slopes = FaceDerivatives::new(&tile, DVec3::new(0.0, 0.0, 2.0)).unwrap();
/// // A near pole that comes nearer increases the field; moving both poles moves the point back.
/// assert!(slopes.upper.z_axis.z > 0.0 && slopes.lower.z_axis.z < 0.0);
/// assert!(slopes.upper.z_axis.z + slopes.lower.z_axis.z > 0.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceDerivatives {
    /// Derivatives with respect to the lower faces.
    pub lower: DMat3,
    /// Derivatives with respect to the upper faces.
    pub upper: DMat3,
}

impl FaceDerivatives {
    /// The derivatives at a point; `None` on an edge of the tile, where they are unbounded, and
    /// where they overflow.
    pub fn new(tile: &Tile, point: DVec3) -> Option<FaceDerivatives> {
        let unrotated = tile.rotation() == DQuat::IDENTITY;
        let from_centre = point - tile.position();
        let local = if unrotated { from_centre } else { tile.rotation().inverse() * from_centre };
        // Vectors to the faces in units of the largest, so that no power overflows.
        let half = 0.5 * tile.size();
        let to_faces = [-half - local, half - local];
        let unit = to_faces[0].abs().max_element().max(to_faces[1].abs().max_element());
        let slopes = of_edges(&Edges::between(to_faces.map(|to| to / unit))?, tile.polarization_t());
        let factor = 1.0 / (4.0 * PI * unit);
        let turned = |m: DMat3| if unrotated { m * factor } else { DMat3::from_quat(tile.rotation()) * (m * factor) };
        let [lower, upper] = slopes.map(turned);
        (lower.is_finite() && upper.is_finite()).then_some(FaceDerivatives { lower, upper })
    }
}

/// Contributions of the layers on the lower faces, negated, and on the upper faces.
fn of_edges(edges: &Edges, j: DVec3) -> [DMat3; 2] {
    [0, 1].map(|side| {
        let columns = [0, 1, 2].map(|normal| {
            let (first, second) = ((normal + 1) % 3, (normal + 2) % 3);
            let mut layer = DVec3::ZERO;
            for end in [0, 1] {
                let sign = if end == 0 { -1.0 } else { 1.0 };
                // The rim runs from `first` to `second`: along its edges at the upper end of
                // `first`, against those at the upper end of `second`.
                layer += sign * edges.along(second, [side, end], j[normal], j[first]);
                layer += sign * edges.along(first, [end, side], -j[normal], j[second]);
            }
            if side == 0 { -layer } else { layer }
        });
        DMat3::from_cols(columns[0], columns[1], columns[2])
    })
}

/// Integrals over the twelve edges of a cuboid.
struct Edges {
    /// Vectors from the point to the lower and upper faces.
    to_faces: [DVec3; 2],
    /// Integrals of 1 / r^3 and of t / r^3 along each edge, with t from the foot of the point; by
    /// direction, then by the ends of the next axis and of the axis after it.
    integrals: [[[(f64, f64); 2]; 2]; 3],
}

impl Edges {
    /// The integrals; `None` if the point is on an edge.
    fn between(to_faces: [DVec3; 2]) -> Option<Edges> {
        let squares = to_faces.map(|to| to * to);
        let mut integrals = [[[(0.0, 0.0); 2]; 2]; 3];
        for (axis, of_axis) in integrals.iter_mut().enumerate() {
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            let ends = to_faces.map(|to| to[axis]);
            for (i, of_next) in of_axis.iter_mut().enumerate() {
                for (k, integral) in of_next.iter_mut().enumerate() {
                    *integral = segment(ends, squares[i][next] + squares[k][last])?;
                }
            }
        }
        Some(Edges { to_faces, integrals })
    }

    /// 4 pi times the field of this edge with a current along its axis and a charge per length.
    fn along(&self, axis: usize, [next_end, last_end]: [usize; 2], current: f64, charge: f64) -> DVec3 {
        let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
        let (across, lengthwise) = self.integrals[axis][next_end][last_end];
        let (from_next, from_last) = (-self.to_faces[next_end][next], -self.to_faces[last_end][last]);
        let mut b = DVec3::ZERO;
        b[axis] = -charge * lengthwise;
        b[next] = (charge * from_next - current * from_last) * across;
        b[last] = (charge * from_last + current * from_next) * across;
        b
    }
}

/// The integrals of 1 / r^3 and t / r^3 over t between the ends, r^2 = t^2 + rho^2, without
/// cancellation (Eqs. P32, P33); `None` where they are unbounded.
pub(crate) fn segment([from, to]: [f64; 2], rho_squared: f64) -> Option<(f64, f64)> {
    let [r_from, r_to] = [from, to].map(|t| (t * t + rho_squared).sqrt());
    let squares = (to - from) * (to + from);
    let across = if from * to > 0.0 {
        squares / (r_from * r_to * (to * r_from + from * r_to))
    } else {
        (to / r_to - from / r_from) / rho_squared
    };
    let lengthwise = squares / (r_from * r_to * (r_from + r_to));
    (across.is_finite() && lengthwise.is_finite()).then_some((across, lengthwise))
}
