//! The series of the bound of the magnitude in single precision, for points near a group of tiles.

use fearless_simd::prelude::*;

use crate::magnitude_bound::{MagnitudeBound, TANGENT};
use crate::tolerances::{SERIES_BOUND_FROM, SINGLE_PRECISION, SMALLEST_IN_SINGLE_PRECISION};

/// This constant minus half the bits of x gives the bits of about 1 / sqrt(x) (Lomont).
const RECIPROCAL_ROOT: f32 = f32::from_bits(0x5f37_59df);

/// Eq. P45 of a cuboid in single precision. Lengths are in radii of a sphere around a group of
/// tiles, from the centre of the group; bounds are over the strength of the group.
#[derive(Clone, Debug)]
pub struct FarMagnitude {
    centre: [f32; 3],
    /// Smallest squared distance from the centre at which the bound holds.
    from: f32,
    /// The coefficient of q^3.
    dipole: f32,
    /// The coefficients of q^5, a quadratic form of the offset plus a constant: xx, yy, zz, and
    /// twice yz, zx, xy if the cuboid is rotated.
    squares: [f32; 3],
    mixed: Option<[f32; 3]>,
    constant: f32,
    /// The coefficient of q^7.
    quartic: f32,
}

impl MagnitudeBound {
    /// The series in single precision, with lengths times `scale` from `origin` and bounds over
    /// `strength_t`. `None` if the cuboid is too small a part of the group.
    pub fn in_single_precision(&self, origin: [f64; 3], scale: f64, strength_t: f64) -> Option<FarMagnitude> {
        let h = self.half_diagonal() * scale;
        let offset = |axis: usize| ((self.centre()[axis] - origin[axis]) * scale) as f32;
        let dipole = SINGLE_PRECISION * 0.5 * self.dipole_t() / strength_t * h.powi(3);
        let of_shares = |share: f64| (dipole * TANGENT * share) as f32;
        let far = || FarMagnitude {
            centre: [0, 1, 2].map(offset),
            from: (SINGLE_PRECISION * h * SERIES_BOUND_FROM).powi(2) as f32,
            dipole: (dipole * TANGENT) as f32,
            squares: self.shares.map(of_shares),
            mixed: self.mixed_shares.map(|mixed| mixed.map(of_shares)),
            constant: (dipole * self.quadratic * h.powi(2)) as f32,
            quartic: (dipole * self.quartic * h.powi(4)) as f32,
        };
        (h >= SMALLEST_IN_SINGLE_PRECISION).then(far)
    }
}

impl FarMagnitude {
    /// Upper bounds at a vector of points at most 10 radii from the centre of the group, and a mask
    /// of the points where they hold.
    #[inline(always)]
    pub fn at<S: Simd>(&self, simd: S, [x, y, z]: [S::f32s; 3]) -> (S::f32s, S::mask32s) {
        let [x, y, z] = [x - self.centre[0], y - self.centre[1], z - self.centre[2]];
        let (xx, yy, zz) = (x * x, y * y, z * z);
        let square = xx + yy + zz;
        let q = reciprocal_root_bound(simd, square);
        let q_squared = q * q;
        let mut form =
            zz.mul_add(self.squares[2], yy.mul_add(self.squares[1], xx.mul_add(self.squares[0], self.constant)));
        if let Some([yz, zx, xy]) = self.mixed {
            form = (y * z).mul_add(yz, (z * x).mul_add(zx, (x * y).mul_add(xy, form)));
        }
        let form = q_squared.mul_add(self.quartic, form);
        (q_squared * q * q_squared.mul_add(form, self.dipole), square.simd_ge(self.from))
    }
}

/// An upper bound of 1 / sqrt(x) for x between 2^-100 and 2^100, at most 0.4 % above it: the
/// estimate and Newton's step of [`magsplice_simd::lanes::Lanes::reciprocal_root_bound`].
#[inline(always)]
fn reciprocal_root_bound<S: Simd>(simd: S, x: S::f32s) -> S::f32s {
    const ABOVE: f32 = 1.002;
    let estimate = S::f32s::from_bits(S::f32s::splat(simd, RECIPROCAL_ROOT).to_bits() - (x.to_bits() >> 1));
    let square = x * estimate * estimate;
    estimate * square.mul_add(-0.5 * ABOVE, 1.5 * ABOVE)
}
