//! The closed-form field of one cuboid in its own frame, free of cancellation (docs/physics.md,
//! section 2).
//!
//! One path is valid at every point. The only branches depend on the foot of the point and on the
//! size of a logarithm.

use super::edge::edge_logarithm;
use super::face::face_angles;
use super::number::Scalar;
use super::offsets::Offsets;

const INV_4PI: f64 = 0.25 * std::f64::consts::FRAC_1_PI;

/// The field to sum: mu0 H or B.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum FieldKind {
    /// mu0 H in tesla: the tensor applied to J.
    Strength,
    /// B in tesla: mu0 H, plus J inside.
    Density,
}

/// mu0 H or B of a cuboid of polarization `j` in tesla, in its own frame. Zero components of `j`
/// take no time.
///
/// The offsets must be scaled so that the largest is of order one.
pub fn cuboid_field<S: Scalar>(offsets: &[Offsets<S>; 3], j: [f64; 3], part: FieldKind) -> [S; 3] {
    let radius = corner_distances(offsets);
    let inside = offsets.iter().all(Offsets::within);
    let mut field = [S::constant(0.0); 3];

    for edges in 0..3 {
        let (a, b) = ((edges + 1) % 3, (edges + 2) % 3);
        if j[a] == 0.0 && j[b] == 0.0 {
            continue;
        }
        let sign = offsets[a].sign() * offsets[b].sign();
        let element = edge_logarithm(offsets, &radius, [a, b, edges]).scale(sign);
        field[a] = field[a] + element.scale(j[b]);
        field[b] = field[b] + element.scale(j[a]);
    }

    // Inside a plate J + mu0 H would nearly cancel; 1 + T_xx = -(T_yy + T_zz) adds two numbers of
    // one sign.
    let by_trace = inside && part == FieldKind::Density;
    let mut diagonal = [None; 3];
    for (axis, slot) in diagonal.iter_mut().enumerate() {
        let needed = if by_trace { (0..3).any(|m| m != axis && j[m] != 0.0) } else { j[axis] != 0.0 };
        if needed {
            *slot = Some(face_angles(offsets, [axis, (axis + 1) % 3, (axis + 2) % 3]));
        }
    }
    for axis in 0..3 {
        let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
        let element = match (by_trace, diagonal[axis], diagonal[next], diagonal[last]) {
            _ if j[axis] == 0.0 => continue,
            (false, Some(own), _, _) => own,
            (true, _, Some(one), Some(other)) => -(one + other),
            _ => unreachable!("every element a component of J needs has been computed"),
        };
        field[axis] = field[axis] + element.scale(j[axis]);
    }
    field.map(|component| component.scale(INV_4PI))
}

/// The gradient of B (and of mu0 H) of a cuboid of polarization `j` in tesla per scaled length, in
/// its own frame; a symmetric matrix.
///
/// The third derivatives T_ijk of the potential are symmetric in all indices and T_iii = -(T_ijj +
/// T_ikk), inside and outside, so the slopes of the off-diagonal elements give all of them
/// (docs/physics.md, section 2.4). The slopes of the solid angles would nearly cancel in a thin
/// plate, for the two parts of a face cut at the foot of the point.
pub fn cuboid_gradient(offsets: &[Offsets<f64>; 3], j: [f64; 3]) -> [[f64; 3]; 3] {
    let offsets = [0, 1, 2].map(|axis: usize| offsets[axis].differentiated(axis));
    let radius = corner_distances(&offsets);
    let mut third = ThirdDerivatives::default();
    let mut mixed_from = f64::INFINITY;
    for edges in 0..3 {
        let (a, b) = ((edges + 1) % 3, (edges + 2) % 3);
        if j[a] != 0.0 || j[b] != 0.0 {
            let element = edge_logarithm(&offsets, &radius, [a, b, edges]);
            let sign = INV_4PI * offsets[a].sign() * offsets[b].sign();
            third.twice[a][b] = sign * element.slope[a];
            third.twice[b][a] = sign * element.slope[b];
            // The slope along a long edge is the small difference of its ends.
            if offsets[edges].size <= mixed_from {
                mixed_from = offsets[edges].size;
                third.mixed = sign * element.slope[edges];
            }
        }
    }
    let mut gradient = [[0.0; 3]; 3];
    for (a, row) in gradient.iter_mut().enumerate() {
        for (b, slope) in row.iter_mut().enumerate() {
            *slope = (0..3).filter(|&c| j[c] != 0.0).map(|c| third.component([a, b, c]) * j[c]).sum();
        }
    }
    gradient
}

/// T_ijk = (1 / 4 pi) times the third derivatives of the integral of 1 / R over the cuboid.
#[derive(Default)]
struct ThirdDerivatives {
    /// T_aab by [a][b], a and b different.
    twice: [[f64; 3]; 3],
    /// T_xyz.
    mixed: f64,
}

impl ThirdDerivatives {
    fn component(&self, [a, b, c]: [usize; 3]) -> f64 {
        if a == b && b == c {
            let (next, last) = ((a + 1) % 3, (a + 2) % 3);
            -(self.twice[next][a] + self.twice[last][a])
        } else if a == b {
            self.twice[a][c]
        } else if a == c {
            self.twice[a][b]
        } else if b == c {
            self.twice[b][a]
        } else {
            self.mixed
        }
    }
}

/// Distances to the eight corners; the bit of an axis is set for its far face.
fn corner_distances<S: Scalar>(offsets: &[Offsets<S>; 3]) -> [S; 8] {
    let squares: [[S; 2]; 3] = [0, 1, 2].map(|axis: usize| [0, 1].map(|bit| offsets[axis].face(bit).square()));
    [0, 1, 2, 3, 4, 5, 6, 7]
        .map(|corner: usize| (squares[0][corner & 1] + squares[1][corner >> 1 & 1] + squares[2][corner >> 2]).sqrt())
}
