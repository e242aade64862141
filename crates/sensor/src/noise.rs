//! Standard deviations of positions, from standard deviations of the readings.

use glam::{DMat3, DVec3};
use magsplice_decouple::ParameterDerivatives;
use magsplice_magnet::HallSensor;

/// Noise of a three-axis sensor: independent errors of each reading of each axis.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Noise {
    /// Standard deviation along each axis, in tesla.
    pub deviation_t: DVec3,
}

impl Noise {
    /// The noise of a sensor's readings, including rounding to counts. `None` if the sensor has
    /// neither.
    pub fn of_sensor(sensor: &HallSensor) -> Option<Noise> {
        let deviation_t = sensor.deviation_t();
        (deviation_t != DVec3::ZERO).then_some(Noise { deviation_t })
    }

    /// Standard deviations along x, y, z of the position of a reading, for this gradient of the
    /// field (column j is the derivative along x_j). `None` where the gradient is singular: some
    /// displacement does not change the reading.
    ///
    /// For normal noise this is the bound of Cramér and Rao for unbiased estimates from one
    /// reading: with b = B(p) + noise, the covariance of p is G^-1 S G^-T.
    pub fn of_position(&self, gradient: DMat3) -> Option<DVec3> {
        let inverse = gradient.inverse();
        self.through(inverse)
    }

    /// Standard deviations along x, y, z of the displacement of Dai 2024, Eq. 14, to first order,
    /// for these derivatives of the parameters by the flux density. The flux density is computed
    /// from the readings of `sensor`. The reading at the reference point counts as exact.
    pub fn of_parameters(
        &self,
        derivatives: &ParameterDerivatives,
        wavenumber: f64,
        sensor: &HallSensor,
    ) -> Option<DVec3> {
        let ParameterDerivatives { r_x, r_y, s_z } = derivatives;
        let by_reading = [r_x, r_y, s_z].map(|by_field| sensor.rotation.inverse() * *by_field / sensor.gain);
        // The sign of a row does not matter for its square.
        self.through(DMat3::from_cols_array_2d(&by_reading.map(|row| row.to_array())).transpose() * (1.0 / wavenumber))
    }

    /// Root mean squares of the rows of a matrix, weighted by the noise.
    fn through(&self, of_reading: DMat3) -> Option<DVec3> {
        let deviations = DVec3::from([0, 1, 2].map(|axis| (of_reading.row(axis) * self.deviation_t).length()));
        deviations.is_finite().then_some(deviations)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A symmetric gradient, as of a field without sources, would hide on which side the noise
    /// acts.
    #[test]
    fn noise_of_each_axis_acts_through_its_own_derivatives() {
        let noise = Noise { deviation_t: DVec3::new(1.0, 2.0, 3.0) };
        let derivatives = ParameterDerivatives {
            r_x: DVec3::new(1.0, 2.0, 0.0),
            r_y: DVec3::new(0.0, 0.0, 4.0),
            s_z: DVec3::new(2.0, 0.0, 1.0),
        };
        let deviations = noise.of_parameters(&derivatives, 0.5, &HallSensor::default()).unwrap();
        assert!((deviations / 2.0 - DVec3::new(17.0_f64.sqrt(), 12.0, 13.0_f64.sqrt())).length() < 1e-14);
        // B_x = x + 2 y, B_y = y, B_z = z / 2: x = B_x - 2 B_y, y = B_y, z = 2 B_z.
        let gradient = DMat3::from_cols(DVec3::X, DVec3::new(2.0, 1.0, 0.0), 0.5 * DVec3::Z);
        let deviations = noise.of_position(gradient).unwrap();
        assert!((deviations - DVec3::new(17.0_f64.sqrt(), 2.0, 6.0)).length() < 1e-14, "{deviations}");
        assert_eq!(noise.of_position(DMat3::ZERO), None);
    }
}
