//! Second derivatives of the decoupling parameters.

use glam::{DMat3, DVec3};

use crate::parameters::{Branch, Parameters};

/// Second derivatives of the decoupling parameters with respect to the components of B, per square
/// tesla. The matrices are symmetric.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ParameterSecondDerivatives {
    /// Second derivatives of R_x.
    pub r_x: DMat3,
    /// Second derivatives of R_y.
    pub r_y: DMat3,
    /// Second derivatives of S_z.
    pub s_z: DMat3,
}

impl Parameters {
    /// The second derivatives of the parameters with respect to the components of a flux density in
    /// tesla. `None` as for [`Parameters::from_field`].
    ///
    /// They follow from S_z + i R_y = ln (C_y + i B_y) and its counterpart for x: the second
    /// derivative of ln w is w'' / w - (w' / w)^2.
    pub fn second_derivatives(b_t: DVec3, branch: Branch) -> Option<ParameterSecondDerivatives> {
        Parameters::from_field(b_t, branch)?;
        // Scaled so that squares neither overflow nor underflow.
        let largest = b_t.abs().max_element();
        let b = b_t / largest;
        let [_, r_x] = of_logarithm(b, 0);
        let [s_z, r_y] = of_logarithm(b, 1);
        let [r_x, r_y, s_z] = [r_x, r_y, s_z].map(|second| second * largest.powi(-2));
        Some(ParameterSecondDerivatives { r_x, r_y, s_z })
    }
}

/// Second derivatives of the real and the imaginary part of ln (C + i B) along an axis, 0 or 1.
fn of_logarithm(b: DVec3, axis: usize) -> [DMat3; 2] {
    // C = (B_z + (other^2 - own^2) / B_z) / 2.
    let (own, other) = (DVec3::AXES[axis], DVec3::AXES[1 - axis]);
    let (by_own, by_other) = (b.dot(own) / b.z, b.dot(other) / b.z);
    let shear = (by_other - by_own) * (by_other + by_own);
    let c = 0.5 * b.z * (1.0 + shear);
    let c_slope = by_other * other - by_own * own + 0.5 * (1.0 - shear) * DVec3::Z;
    let outer = |a: DVec3, b: DVec3| DMat3::from_cols(a * b.x, a * b.y, a * b.z);
    let toward = |slope: DVec3, along: DVec3| outer(slope, along) + outer(along, slope);
    let c_second = (outer(other, other) - outer(own, own) - toward(by_other * other - by_own * own, DVec3::Z)
        + shear * outer(DVec3::Z, DVec3::Z))
        * (1.0 / b.z);
    // Division by C + i B is multiplication by (C - i B) / (C^2 + B^2).
    let imaginary = b.dot(own);
    let square = c * c + imaginary * imaginary;
    let (inverse_re, inverse_im) = (c / square, -imaginary / square);
    let re = inverse_re * c_slope - inverse_im * own;
    let im = inverse_im * c_slope + inverse_re * own;
    [c_second * inverse_re - (outer(re, re) - outer(im, im)), c_second * inverse_im - toward(re, im)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::ParameterDerivatives;
    use proptest::prelude::*;

    proptest! {
        /// Central differences of the first derivatives have errors of h^2 and of round-off over h,
        /// both below 1e-9 of the derivatives, which are below 100 in units of B.
        #[test]
        fn second_derivatives_agree_with_differences_of_the_first(
            x in -2.0..2.0_f64, y in -2.0..2.0_f64, size in -6..6_i32, reversed in any::<bool>(),
        ) {
            let unit = 10_f64.powi(size);
            let b = DVec3::new(x, y, if reversed { -1.0 } else { 1.0 }) * unit;
            let branch = Branch::from_axis_field(b).expect("regular");
            let ParameterSecondDerivatives { r_x, r_y, s_z } =
                Parameters::second_derivatives(b, branch).expect("regular");
            let h = 1e-5 * unit;
            for axis in 0..3 {
                let step = h * DVec3::AXES[axis];
                let first = |b: DVec3| Parameters::with_derivatives(b, branch).expect("regular").1;
                let (above, below): (ParameterDerivatives, ParameterDerivatives) = (first(b + step), first(b - step));
                let differences = [above.r_x - below.r_x, above.r_y - below.r_y, above.s_z - below.s_z];
                for (difference, second) in differences.into_iter().zip([r_x, r_y, s_z]) {
                    let error = (difference / (2.0 * h) - second.col(axis)).length() * unit * unit;
                    let largest = second.to_cols_array().into_iter().fold(1.0 / unit / unit, |m, v| v.abs().max(m));
                    prop_assert!(error < 1e-7 * largest * unit * unit, "{} by {axis}", error);
                }
            }
        }
    }

    #[test]
    fn there_are_none_where_the_normal_field_vanishes() {
        let branch = Branch::from_axis_field(DVec3::Z).expect("regular");
        assert_eq!(Parameters::second_derivatives(DVec3::X, branch), None);
    }
}
