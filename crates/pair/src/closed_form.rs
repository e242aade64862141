//! Mean tensor, force and torque of two cuboids with parallel edges, in closed form.
//!
//! Mean tensor: Newell, Williams and Dunlop, "A generalization of the demagnetizing tensor for
//! nonuniform magnetization", J. Geophys. Res. 98 (1993) 9551, for boxes of different sizes: second
//! differences become sums over the 64 differences of corners. Forces: Akoun and Yonnet, "3D
//! analytical calculation of the forces exerted between two cuboidal magnets", IEEE Trans. Magn. 20
//! (1984) 1962, and for other polarizations Yonnet and Allag, IEEE Trans. Magn. 45 (2009) 3969.
//! Torques: after Janssen et al., IEEE Trans. Magn. 46 (2010) 1748, with the lever integrated by
//! parts.

use std::f64::consts::PI;

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use glam::DVec3;
use magsplice_magnet::MU_0;
use magsplice_simd::lanes::{LONGEST_VECTOR, Lanes, Number};

use crate::aligned_pair::AlignedPair;
use crate::corner::{CornerDifference, MULTIPLIER};
use crate::load::Load;
use crate::real::Real;
use crate::symmetric_tensor::SymmetricTensor;

/// Number of differences of corners.
const CORNERS: usize = 64;

/// The tensor that maps the polarization of the source to minus the mean of mu0 H over the
/// receiver. `offset` is the vector from the centre of the source to the centre of the receiver.
/// Lengths are at most 1.
pub(crate) fn mean_tensor(receiver: DVec3, source: DVec3, offset: DVec3) -> SymmetricTensor {
    let differences = [0, 1, 2].map(|axis: usize| {
        let (sum, difference) = (0.5 * (receiver + source)[axis], 0.5 * (receiver - source)[axis]);
        // Differences of faces: both lower, both upper, and mixed with the sign -1.
        [offset[axis] - difference, offset[axis] + difference, offset[axis] - sum, offset[axis] + sum]
    });
    let faces = |corner: usize| [corner >> 4, corner >> 2 & 3, corner & 3];
    let along = |axis: usize| std::array::from_fn(|corner| differences[axis][faces(corner)[axis]]);
    let sign = |corner: usize| {
        let mixed = faces(corner).into_iter().filter(|face| *face >= 2).count();
        if mixed.is_multiple_of(2) { 1.0 } else { -1.0 }
    };
    let corners = [along(0), along(1), along(2), std::array::from_fn(sign)];
    let sums = dispatch!(Level::new(), simd => tensor_sums(simd, &corners));
    let total = SymmetricTensor {
        diagonal: DVec3::new(sums[0], sums[1], sums[2]),
        off_diagonal: DVec3::new(sums[3], sums[4], sums[5]),
    };
    total * (1.0 / (MULTIPLIER * 4.0 * PI * receiver.element_product()))
}

/// The sums of the second derivatives xx, yy, zz, yz, zx, xy over the differences of corners, with
/// their signs.
///
/// It has no closures, because the compiler does not always inline them, and calls of vector
/// operations take longer than the operations.
#[inline(always)]
fn tensor_sums<S: Simd>(simd: S, corners: &[[f64; CORNERS]; 4]) -> [f64; 6] {
    let mut sums = [Lanes::<S>::splat(simd, 0.0); 6];
    for start in (0..CORNERS).step_by(Lanes::<S>::LEN) {
        let end = start + Lanes::<S>::LEN;
        let u = [
            Lanes::load(simd, &corners[0][start..end]),
            Lanes::load(simd, &corners[1][start..end]),
            Lanes::load(simd, &corners[2][start..end]),
        ];
        let sign = Lanes::load(simd, &corners[3][start..end]);
        let at = CornerDifference::in_lanes(simd, u);
        let values =
            [at.second(0, 0), at.second(1, 1), at.second(2, 2), at.second(1, 2), at.second(2, 0), at.second(0, 1)];
        for (sum, value) in sums.iter_mut().zip(values) {
            *sum = value.mul_add(sign, *sum);
        }
    }
    let mut totals = [0.0; 6];
    for (total, sum) in totals.iter_mut().zip(sums) {
        let mut lanes = [0.0; LONGEST_VECTOR];
        sum.store(&mut lanes[..Lanes::<S>::LEN]);
        *total = lanes.iter().sum();
    }
    totals
}

/// The load on the first cuboid by the second, in the scaled lengths of the pair.
/// [`load_in_f64`](crate::load_in_f64) gives the error with `f64`.
///
/// Energy, force and moments about the centre of the first are sums over the differences of corners
/// of
///
/// ```text
/// W    =  J_a J'_b G_ab s s' / (4 pi mu0)
/// F_c  = -J_a J'_b G_abc s s' / (4 pi mu0)
/// M_kc = -J_a J'_b (x_k G_abc - [a is not k] integral of G_abc du_k) s s' / (4 pi mu0)
/// ```
///
/// where s and s' are the products of the signs of the corners, x_k is the coordinate of the corner
/// of the first, and M_kc is the sum of x_k times the force along c, which gives the torque.
pub(crate) fn load<N: Real>(pair: &AlignedPair) -> Load {
    let products = Products::<N>::new(pair.polarizations_t);
    let halves = pair.sizes.map(|size| size * 0.5);
    let differences = [0, 1, 2].map(|k| differences::<N>(pair, k));
    let sides = [0, 1, 2].map(|k: usize| pair.offset[k].hi);
    let mut force = [N::ZERO; 3];
    let mut moment = [[N::ZERO; 3]; 3];
    for corner in 0..CORNERS {
        let upper = [0, 1, 2].map(|k: usize| corner >> k & 1 == 1);
        let upper_of_second = [0, 1, 2].map(|k: usize| corner >> (k + 3) & 1 == 1);
        let u = [0, 1, 2].map(|k: usize| differences[k][usize::from(upper[k])][usize::from(upper_of_second[k])]);
        let positive = corner.count_ones() % 2 == 0;
        let difference = CornerDifference::new(u, sides);
        for c in 0..3 {
            let along_c = products.third(&difference, c);
            add(&mut force[c], along_c, positive);
            for k in (0..3).filter(|&k| k != c) {
                let lever = if upper[k] { halves[0][k] } else { -halves[0][k] };
                let whole = along_c.times(lever) - products.third_along(&difference, c, k);
                add(&mut moment[k][c], whole, positive);
            }
        }
    }
    let factor = -1.0 / (MULTIPLIER * 4.0 * PI * MU_0);
    let torque = [0, 1, 2].map(|i: usize| {
        let (k, c) = ((i + 1) % 3, (i + 2) % 3);
        (moment[k][c] - moment[c][k]).to_f64() * factor
    });
    Load { force: DVec3::from_array(force.map(|f| f.to_f64() * factor)), torque: DVec3::from_array(torque) }
}

fn add<N: Real>(sum: &mut N, term: N, positive: bool) {
    *sum += if positive { term } else { -term };
}

/// Differences of the faces across one axis, by the faces of the first and of the second: lower,
/// upper. Faces that penetrate each other by round-off touch.
fn differences<N: Real>(pair: &AlignedPair, axis: usize) -> [[N; 2]; 2] {
    let half = |tile: usize, upper: usize| (upper as f64 - 0.5) * pair.sizes[tile][axis];
    [0, 1].map(|first| {
        [0, 1].map(|second| {
            let between = N::sum(half(0, first), -half(1, second));
            let difference = N::rounded(pair.offset[axis]) + between;
            let touches = difference.to_f64().abs() <= pair.seam && difference.to_f64() * pair.offset[axis].hi <= 0.0;
            if touches { N::ZERO } else { difference }
        })
    })
}

/// The products J_a J'_b of polarizations.
struct Products<N>([[N; 3]; 3]);

impl<N: Real> Products<N> {
    fn new([first, second]: [DVec3; 2]) -> Products<N> {
        Products([0, 1, 2].map(|a: usize| [0, 1, 2].map(|b: usize| N::product(first[a], second[b]))))
    }

    /// The sum over a and b of nonzero J_a J'_b times a function.
    fn sum(&self, function: impl Fn(usize, usize) -> Option<N>) -> N {
        let mut sum = N::ZERO;
        for (a, row) in self.0.iter().enumerate() {
            for (b, product) in row.iter().enumerate().filter(|(_, product)| !product.is_zero()) {
                if let Some(value) = function(a, b) {
                    sum += *product * value;
                }
            }
        }
        sum
    }

    fn third(&self, difference: &CornerDifference<N>, c: usize) -> N {
        self.sum(|a, b| Some(difference.third(a, b, c)))
    }

    fn third_along(&self, difference: &CornerDifference<N>, c: usize, k: usize) -> N {
        self.sum(|a, b| match (a == k, b == k) {
            (true, _) => None,
            (false, true) => Some(difference.second(a, c)),
            (false, false) => Some(difference.third_along([a, b, c], k)),
        })
    }
}

#[cfg(test)]
mod tests {
    use magsplice_magnet::Tile;
    use proptest::prelude::*;

    use super::*;
    use crate::double_double::DoubleDouble;

    /// Error of the force with `f64` in J J' D^2 / (4 pi mu0), and of the torque in D times this
    /// unit.
    const F64_ERROR: f64 = 1e-11;

    proptest! {
        #[test]
        fn numbers_of_16_digits_have_the_stated_error(
            sizes in prop::array::uniform6(0.05_f64..4.0),
            at in prop::array::uniform3(-10.0_f64..10.0),
            j in prop::array::uniform6(-1.0_f64..1.0),
        ) {
            let tile = |at: [f64; 3], of: usize| {
                let of_three = |all: [f64; 6]| DVec3::from_slice(&all[3 * of..]);
                Tile::new(at.into(), of_three(sizes), of_three(j)).unwrap()
            };
            let pair = AlignedPair::new(&tile(at, 0), &tile([0.0; 3], 1)).unwrap();
            let (short, exact) = (load::<f64>(&pair), load::<DoubleDouble>(&pair));
            let distance = DVec3::from(at).length() * pair.scale + 0.5 * (pair.sizes[0] + pair.sizes[1]).length();
            let unit = pair.polarizations_t[0].length() * pair.polarizations_t[1].length() * distance * distance
                / (4.0 * PI * MU_0);
            prop_assert!((short.force - exact.force).length() <= F64_ERROR * unit);
            prop_assert!((short.torque - exact.torque).length() <= F64_ERROR * unit * distance);
        }
    }
}
