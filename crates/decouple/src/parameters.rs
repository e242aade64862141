//! The decoupling parameters of one field value, and displacement from their change (Dai 2024, Eqs.
//! 13 to 15).

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use crate::per_parameter::Parameter;

/// Fraction of the largest component below which |B_z| counts as zero. The error of a film's B is
/// about 1e-13 of the sum of its tiles' fields, so a smaller B_z has neither a known sign nor a
/// known digit.
const VANISHING_BZ: f64 = 1e-12;

/// The decoupling parameters of a field value (Dai 2024, Eqs. 13 and 15): R_x and R_y in radians,
/// S_z the natural logarithm of a flux density in tesla.
///
/// For the ideal film R_x = -k x, R_y = -k y and S_z = ln |K| + k z, so each depends on one
/// coordinate only.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Parameters {
    /// arctan(B_x / C_x), in (-pi, pi].
    pub r_x: f64,
    /// arctan(B_y / C_y), in (-pi, pi].
    pub r_y: f64,
    /// ln sqrt(C_y^2 + B_y^2).
    pub s_z: f64,
}

/// Derivatives of the decoupling parameters with respect to the components of B, per tesla.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ParameterDerivatives {
    /// Derivatives of R_x.
    pub r_x: DVec3,
    /// Derivatives of R_y.
    pub r_y: DVec3,
    /// Derivatives of S_z.
    pub s_z: DVec3,
}

/// The branch of the arctangents of R_x and R_y: the sign of B_z on the axis x = y = 0.
///
/// The quotient B_x / C_x loses the sign of C_x, and with it half a turn. C_x changes sign at a
/// quarter of a wavelength, and working volumes extend nearly that far. With s the sign of this
/// branch, arctan2(s B_x, s C_x) is continuous there, and R_x is 0 on the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Branch(f64);

impl Branch {
    /// The branch of a film whose B at a point of the axis is `on_axis_t`, in tesla. `None` if B_z
    /// vanishes there.
    pub fn from_axis_field(on_axis_t: DVec3) -> Option<Branch> {
        (!vanishes(on_axis_t)).then(|| Branch(on_axis_t.z.signum()))
    }
}

fn vanishes(b: DVec3) -> bool {
    !b.is_finite() || b.z.abs() <= VANISHING_BZ * b.abs().max_element()
}

impl Parameters {
    /// The parameters of a flux density in tesla. `None` where B_z = 0, a true singularity of Eq.
    /// 15, or B is not finite.
    ///
    /// # Accuracy
    /// Round-off is about `1e-15 |B| / |B_z|`. The error of the field comes in addition.
    pub fn from_field(b_t: DVec3, Branch(sign): Branch) -> Option<Parameters> {
        if vanishes(b_t) {
            return None;
        }
        // Scaled so that squares neither overflow nor underflow.
        let largest = b_t.abs().max_element();
        let b = b_t / largest;
        let shear = (b.y - b.x) * (b.y + b.x);
        let c_x = (b.z * b.z + shear) / (2.0 * b.z);
        let c_y = (b.z * b.z - shear) / (2.0 * b.z);
        Some(Parameters {
            // Adding zero turns -0 into 0, so the angle is pi instead of -pi.
            r_x: (sign * b.x + 0.0).atan2(sign * c_x),
            r_y: (sign * b.y + 0.0).atan2(sign * c_y),
            s_z: c_y.hypot(b.y).ln() + largest.ln(),
        })
    }

    /// The parameters of a flux density in tesla, with their derivatives with respect to its
    /// components. `None` as for [`Parameters::from_field`].
    pub fn with_derivatives(b_t: DVec3, branch: Branch) -> Option<(Parameters, ParameterDerivatives)> {
        let parameters = Parameters::from_field(b_t, branch)?;
        let largest = b_t.abs().max_element();
        let b = b_t / largest;
        let shear = (b.y - b.x) * (b.y + b.x);
        let c_x = (b.z * b.z + shear) / (2.0 * b.z);
        let c_y = (b.z * b.z - shear) / (2.0 * b.z);
        let (by_x, by_y) = (b.x / b.z, b.y / b.z);
        let c_x_derivative = DVec3::new(-by_x, by_y, 1.0 - c_x / b.z);
        let c_y_derivative = DVec3::new(by_x, -by_y, 1.0 - c_y / b.z);
        let (x_square, y_square) = (c_x * c_x + b.x * b.x, c_y * c_y + b.y * b.y);
        let derivatives = ParameterDerivatives {
            r_x: (c_x * DVec3::X - b.x * c_x_derivative) / x_square / largest,
            r_y: (c_y * DVec3::Y - b.y * c_y_derivative) / y_square / largest,
            s_z: (c_y * c_y_derivative + b.y * DVec3::Y) / y_square / largest,
        };
        Some((parameters, derivatives))
    }

    /// The value of one parameter.
    pub const fn get(&self, parameter: Parameter) -> f64 {
        match parameter {
            Parameter::Rx => self.r_x,
            Parameter::Ry => self.r_y,
            Parameter::Sz => self.s_z,
        }
    }

    /// The displacement of the sensor from `before` to these parameters: dx = -dR_x / k, dy = -dR_y
    /// / k, dz = dS_z / k (Dai 2024, Eq. 14).
    ///
    /// It is in the frame of the film, in the unit of 1 / `wavenumber`. Changes of R_x and R_y are
    /// reduced to half a turn, so shear is unambiguous up to half a wavelength.
    pub fn displacement_from(&self, before: &Parameters, wavenumber: f64) -> DVec3 {
        let dr_x = half_turn(self.r_x - before.r_x);
        let dr_y = half_turn(self.r_y - before.r_y);
        DVec3::new(-dr_x, -dr_y, self.s_z - before.s_z) / wavenumber
    }
}

/// The same angle within half a turn of zero.
pub(crate) fn half_turn(angle: f64) -> f64 {
    if angle.abs() <= PI { angle } else { angle - TAU * (angle / TAU).round() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;
    use magsplice_ideal::IdealFilm;
    use proptest::prelude::*;

    proptest! {
        /// Eq. 15 applied to Eq. 2 gives one coordinate each, for both signs of K and past a
        /// quarter of a wavelength.
        #[test]
        fn ideal_film_decouples(
            x in -4.9..4.9_f64, y in -4.9..4.9_f64, z in -30.0..-0.1_f64, reversed in any::<bool>(),
        ) {
            let film = IdealFilm::new(10.0, 1.0, if reversed { -0.12 } else { 0.12 }).unwrap();
            let k = film.wavenumber();
            let branch = Branch::from_axis_field(film.flux_density_t(DVec3::new(0.0, 0.0, z)).unwrap()).unwrap();
            let b = film.flux_density_t(DVec3::new(x, y, z)).unwrap();
            // Near B_z = 0 the parameters approach 0 / 0, which amplifies the round-off of B by
            // |B| / |B_z|.
            let allowed = 4e-15 * (1.0 + b.length() / b.z.abs());
            prop_assume!(allowed < 1e-9);
            let p = Parameters::from_field(b, branch).unwrap();
            prop_assert!(half_turn(p.r_x + k * x).abs() <= allowed, "R_x {} at {x}", p.r_x);
            prop_assert!(half_turn(p.r_y + k * y).abs() <= allowed, "R_y {} at {y}", p.r_y);
            let s_z = film.surface_amplitude_t().abs().ln() + k * z;
            prop_assert!((p.s_z - s_z).abs() <= allowed + 1e-14 * s_z.abs(), "S_z {} at {z}", p.s_z);
        }
    }

    #[test]
    fn displacement_by_eq_14_is_the_true_one() {
        let film = IdealFilm::new(10.0, 1.0, 0.12).unwrap();
        let at = |p| Parameters::from_field(film.flux_density_t(p).unwrap(), Branch(1.0)).unwrap();
        let (from, to) = (DVec3::new(-2.2, 0.3, -5.0), DVec3::new(2.4, -1.0, -3.5));
        let found = at(to).displacement_from(&at(from), film.wavenumber());
        assert_abs_diff_eq!(found.distance(to - from), 0.0, epsilon = 1e-13);
    }

    proptest! {
        /// The error of central differences is of the order h^2 and round-off / h. Here both are
        /// below 1e-9 of the derivatives. Any component of B may be the largest.
        #[test]
        fn derivatives_agree_with_central_differences(x in -2.0..2.0_f64, y in -2.0..2.0_f64, size in -6..6_i32, reversed in any::<bool>()) {
            let sign = if reversed { -1.0 } else { 1.0 };
            let unit = 10_f64.powi(size);
            let b = DVec3::new(x, y, sign) * unit;
            let branch = Branch(sign);
            let (p, derivatives) = Parameters::with_derivatives(b, branch).unwrap();
            prop_assert_eq!(Some(p), Parameters::from_field(b, branch));
            let h = 1e-5 * unit;
            for axis in 0..3 {
                let step = h * DVec3::AXES[axis];
                let [above, below] = [b + step, b - step].map(|b| Parameters::from_field(b, branch).unwrap());
                let differences =
                    [half_turn(above.r_x - below.r_x), half_turn(above.r_y - below.r_y), above.s_z - below.s_z];
                for (difference, derivative) in differences.into_iter().zip([derivatives.r_x, derivatives.r_y, derivatives.s_z]) {
                    prop_assert!((difference / (2.0 * h) - derivative[axis]).abs() * unit < 1e-7);
                }
            }
        }
    }

    #[test]
    fn angles_are_reduced_to_half_a_turn() {
        let turns = [(0.75, -0.25), (-0.75, 0.25), (1.0, 0.0), (0.5, 0.5), (-0.5, -0.5), (0.3, 0.3)];
        for (turns, reduced) in turns {
            assert_abs_diff_eq!(half_turn(turns * TAU), reduced * TAU, epsilon = 1e-15);
        }
    }

    #[test]
    fn half_a_turn_is_positive_for_both_zeros() {
        for zero in [0.0, -0.0] {
            // C_x and C_y are negative on this branch.
            let p = Parameters::from_field(DVec3::new(zero, zero, -1.0), Branch(1.0)).unwrap();
            assert_eq!((p.r_x, p.r_y), (PI, PI));
        }
    }

    #[test]
    fn vanishing_normal_field_is_singular() {
        assert_eq!(Parameters::from_field(DVec3::new(1e-3, 0.0, 0.0), Branch(1.0)), None);
        assert_eq!(Parameters::from_field(DVec3::new(1e-3, 0.0, 1e-16), Branch(1.0)), None);
        assert_eq!(Parameters::from_field(DVec3::ZERO, Branch(1.0)), None);
        assert_eq!(Branch::from_axis_field(DVec3::X), None);
        assert!(Parameters::from_field(DVec3::new(1e-3, 0.0, 1e-13), Branch(1.0)).is_some());
        assert_eq!(Parameters::from_field(DVec3::new(f64::NAN, 1.0, 1.0), Branch(1.0)), None);
        assert!(Parameters::from_field(DVec3::new(0.0, 0.0, 1e-300), Branch(1.0)).unwrap().s_z.is_finite());
    }
}
