//! One number for each decoupling parameter.

use glam::DVec3;

/// The name of a decoupling parameter (Dai 2024, Eq. 15).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Parameter {
    /// R_x, which follows x.
    #[cfg_attr(feature = "serde", serde(rename = "r_x"))]
    Rx,
    /// R_y, which follows y.
    #[cfg_attr(feature = "serde", serde(rename = "r_y"))]
    Ry,
    /// S_z, which follows z.
    #[cfg_attr(feature = "serde", serde(rename = "s_z"))]
    Sz,
}

impl Parameter {
    /// All parameters, in the order of the axes that they follow.
    pub const ALL: [Parameter; 3] = [Parameter::Rx, Parameter::Ry, Parameter::Sz];

    /// The axis that the parameter follows: 0, 1, 2 for x, y, z.
    pub const fn axis(self) -> usize {
        match self {
            Parameter::Rx => 0,
            Parameter::Ry => 1,
            Parameter::Sz => 2,
        }
    }
}

/// One number for each decoupling parameter, such as an error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PerParameter {
    /// The number for R_x, in radians.
    pub r_x: f64,
    /// The number for R_y, in radians.
    pub r_y: f64,
    /// The number for S_z, without unit.
    pub s_z: f64,
}

impl PerParameter {
    /// The number for one parameter.
    pub const fn get(&self, parameter: Parameter) -> f64 {
        match parameter {
            Parameter::Rx => self.r_x,
            Parameter::Ry => self.r_y,
            Parameter::Sz => self.s_z,
        }
    }

    /// The numbers for R_x, R_y, S_z, in the order of [`Parameter::ALL`].
    pub const fn to_array(&self) -> [f64; 3] {
        [self.r_x, self.r_y, self.s_z]
    }

    /// The same errors as displacements along x, y, z: divided by k (Dai 2024, Eq. 14), in the unit
    /// of 1 / `wavenumber`.
    pub fn as_lengths(&self, wavenumber: f64) -> DVec3 {
        DVec3::new(self.r_x, self.r_y, self.s_z) / wavenumber
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_in_the_order_of_the_axes() {
        let numbers = PerParameter { r_x: 2.0, r_y: 3.0, s_z: 5.0 };
        assert_eq!(numbers.to_array(), [2.0, 3.0, 5.0]);
        assert_eq!(Parameter::ALL.map(|parameter| numbers.get(parameter)), numbers.to_array());
        assert_eq!(Parameter::ALL.map(Parameter::axis), [0, 1, 2]);
        assert_eq!(numbers.as_lengths(2.0), DVec3::new(1.0, 1.5, 2.5));
    }
}
