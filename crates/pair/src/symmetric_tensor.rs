//! Symmetric tensors of the second rank.

use std::ops::{Add, AddAssign, Mul};

use glam::{DMat3, DVec3};

/// A symmetric 3x3 tensor: its diagonal xx, yy, zz and the elements yz, zx, xy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SymmetricTensor {
    /// Elements xx, yy, zz.
    pub diagonal: DVec3,
    /// Elements yz, zx, xy: each at the index of its missing axis.
    pub off_diagonal: DVec3,
}

impl SymmetricTensor {
    /// The zero tensor.
    pub const ZERO: SymmetricTensor = SymmetricTensor { diagonal: DVec3::ZERO, off_diagonal: DVec3::ZERO };

    /// The symmetric part of a matrix.
    pub fn from_matrix(m: DMat3) -> SymmetricTensor {
        let off_diagonal = 0.5 * DVec3::new(m.y_axis.z + m.z_axis.y, m.z_axis.x + m.x_axis.z, m.x_axis.y + m.y_axis.x);
        SymmetricTensor { diagonal: DVec3::new(m.x_axis.x, m.y_axis.y, m.z_axis.z), off_diagonal }
    }

    /// The tensor as a matrix.
    pub fn to_matrix(self) -> DMat3 {
        let (d, o) = (self.diagonal, self.off_diagonal);
        DMat3::from_cols(DVec3::new(d.x, o.z, o.y), DVec3::new(o.z, d.y, o.x), DVec3::new(o.y, o.x, d.z))
    }

    /// The tensor in the frame to which `rotation` maps this frame.
    pub fn rotated(self, rotation: DMat3) -> SymmetricTensor {
        SymmetricTensor::from_matrix(rotation * self.to_matrix() * rotation.transpose())
    }

    /// The Frobenius norm.
    pub fn norm(self) -> f64 {
        (self.diagonal.length_squared() + 2.0 * self.off_diagonal.length_squared()).sqrt()
    }

    /// The product with a vector.
    pub fn apply(self, v: DVec3) -> DVec3 {
        let o = self.off_diagonal;
        self.diagonal * v + DVec3::new(o.z * v.y + o.y * v.z, o.z * v.x + o.x * v.z, o.y * v.x + o.x * v.y)
    }
}

impl Add for SymmetricTensor {
    type Output = SymmetricTensor;

    fn add(self, other: SymmetricTensor) -> SymmetricTensor {
        SymmetricTensor {
            diagonal: self.diagonal + other.diagonal,
            off_diagonal: self.off_diagonal + other.off_diagonal,
        }
    }
}

impl AddAssign for SymmetricTensor {
    fn add_assign(&mut self, other: SymmetricTensor) {
        *self = *self + other;
    }
}

impl Mul<f64> for SymmetricTensor {
    type Output = SymmetricTensor;

    fn mul(self, factor: f64) -> SymmetricTensor {
        SymmetricTensor { diagonal: self.diagonal * factor, off_diagonal: self.off_diagonal * factor }
    }
}
