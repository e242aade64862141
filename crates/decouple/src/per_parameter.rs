//! One value for each decoupling parameter.

use std::ops::Index;

use glam::DVec3;
use magsplice_magnet::Axis;

/// The name of a decoupling parameter (Dai 2024, Eq. 15).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Parameter {
    /// R_x, which depends on x.
    #[cfg_attr(feature = "serde", serde(rename = "r_x"))]
    Rx,
    /// R_y, which depends on y.
    #[cfg_attr(feature = "serde", serde(rename = "r_y"))]
    Ry,
    /// S_z, which depends on z.
    #[cfg_attr(feature = "serde", serde(rename = "s_z"))]
    Sz,
}

impl Parameter {
    /// All parameters, in the order of their axes.
    pub const ALL: [Parameter; 3] = [Parameter::Rx, Parameter::Ry, Parameter::Sz];

    /// The axis on whose coordinate the parameter depends.
    pub const fn axis(self) -> Axis {
        match self {
            Parameter::Rx => Axis::X,
            Parameter::Ry => Axis::Y,
            Parameter::Sz => Axis::Z,
        }
    }
}

/// One value for each decoupling parameter, such as an error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct PerParameter<T = f64> {
    /// The value for R_x; numbers are in radians.
    pub r_x: T,
    /// The value for R_y; numbers are in radians.
    pub r_y: T,
    /// The value for S_z; numbers are without unit.
    pub s_z: T,
}

impl<T> PerParameter<T> {
    /// The values for R_x, R_y, S_z, in the order of [`Parameter::ALL`].
    pub fn to_array(self) -> [T; 3] {
        [self.r_x, self.r_y, self.s_z]
    }

    /// Applies a function to each value.
    pub fn map<U>(self, f: impl FnMut(T) -> U) -> PerParameter<U> {
        self.to_array().map(f).into()
    }
}

impl PerParameter {
    /// The errors as displacements along x, y, z: divided by k (Dai 2024, Eq. 14), in the unit of 1
    /// / `wavenumber`.
    pub fn as_lengths(&self, wavenumber: f64) -> DVec3 {
        DVec3::new(self.r_x, self.r_y, self.s_z) / wavenumber
    }
}

impl<T> From<[T; 3]> for PerParameter<T> {
    fn from([r_x, r_y, s_z]: [T; 3]) -> PerParameter<T> {
        PerParameter { r_x, r_y, s_z }
    }
}

impl<T> Index<Parameter> for PerParameter<T> {
    type Output = T;

    fn index(&self, parameter: Parameter) -> &T {
        match parameter {
            Parameter::Rx => &self.r_x,
            Parameter::Ry => &self.r_y,
            Parameter::Sz => &self.s_z,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::per_axis::PerAxis;

    #[test]
    fn values_are_in_the_order_of_the_axes() {
        let numbers = PerParameter { r_x: 2.0, r_y: 3.0, s_z: 5.0 };
        assert_eq!(numbers.to_array(), [2.0, 3.0, 5.0]);
        assert_eq!(PerParameter::from(numbers.to_array()), numbers);
        assert_eq!(Parameter::ALL.map(|parameter| numbers[parameter]), numbers.to_array());
        assert_eq!(Parameter::ALL.map(Parameter::axis), Axis::ALL);
        assert_eq!(numbers.as_lengths(2.0), DVec3::new(1.0, 1.5, 2.5));
        let lengths = PerAxis::from(numbers.as_lengths(2.0));
        assert_eq!(Axis::ALL.map(|axis| lengths[axis]), lengths.to_array());
        assert_eq!(lengths.map(|length| 2.0 * length).to_array(), numbers.map(|number| number).to_array());
    }
}
