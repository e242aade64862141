//! Standard deviations of positions, from those of the readings.

use glam::{DMat3, DVec3};
use magsplice_decouple::ParameterDerivatives;

/// Noise of a three-axis sensor: independent errors of each reading of each axis.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Noise {
    /// Standard deviation along each axis, in tesla.
    pub deviation_t: DVec3,
}

impl Noise {
    /// Standard deviations along x, y, z of the position that a reading gives, where the field has this
    /// gradient (column j is the derivative along x_j). `None` where the gradient is singular, so that
    /// some displacement leaves the reading unchanged.
    ///
    /// No unbiased estimate from one reading has smaller ones, if the noise is normal (the bound of
    /// Cramér and Rao): with b = B(p) + noise, the covariance of p is G^-1 S G^-T.
    pub fn of_position(&self, gradient: DMat3) -> Option<DVec3> {
        let inverse = gradient.inverse();
        self.through(inverse)
    }

    /// Standard deviations along x, y, z of the displacement of Dai 2024, Eq. 14, to first order, where
    /// the parameters have these derivatives. The reading at the reference point is taken as exact.
    pub fn of_parameters(&self, derivatives: &ParameterDerivatives, wavenumber: f64) -> Option<DVec3> {
        let ParameterDerivatives { r_x, r_y, s_z } = derivatives;
        // The sign of a row does not matter for its square.
        self.through(DMat3::from_cols(*r_x, *r_y, *s_z).transpose() * (1.0 / wavenumber))
    }

    /// Root mean squares of the rows of a matrix, weighted by the noise.
    fn through(&self, of_reading: DMat3) -> Option<DVec3> {
        let deviations = DVec3::from([0, 1, 2].map(|axis| (of_reading.row(axis) * self.deviation_t).length()));
        deviations.is_finite().then_some(deviations)
    }
}
