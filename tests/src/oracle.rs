//! The field of a cuboid by the textbook formula in numbers of many digits.
//!
//! The textbook formula (eight corners, a logarithm or an arctangent each; docs/physics.md, P1)
//! loses up to 3 digits per decade of distance and per axis of thinness. With 448 bits, which are
//! 130 digits, enough remain for any binary64 input used here. The oracle shares no code and no
//! rearrangement with the library.

use astro_float_num::{BigFloat, Consts, RoundingMode};
use glam::{DMat3, DQuat, DVec3};
use magsplice_field::Tile;

/// Working precision in bits.
const BITS: usize = 448;

/// Working precision in bits of [`Oracle::for_moderate_scenes`], 57 digits.
const MODERATE_BITS: usize = 192;
const ROUND: RoundingMode = RoundingMode::ToEven;

/// Displacement of a point on a face, upwards, as a power of two of the distance to the nearest
/// other face. It implements the library's rule that a tile owns its lower faces.
const NUDGE_EXPONENT: i32 = -120;

/// Step of central differences, as a power of two of the distance to the nearest face. Their
/// relative error is about 2^-120.
const STEP_EXPONENT: i32 = -60;

/// Computes fields to 130 digits.
pub struct Oracle {
    arithmetic: Arithmetic,
    consts: Consts,
}

/// B and mu0 H at a point, each component rounded once.
#[derive(Clone, Copy, Debug)]
pub struct OracleField {
    /// B in tesla.
    pub flux_density_t: DVec3,
    /// mu0 H in tesla.
    pub strength_t: DVec3,
}

impl Default for Oracle {
    fn default() -> Oracle {
        Oracle::new()
    }
}

impl Oracle {
    /// An oracle with its constants computed.
    ///
    /// # Panics
    /// If there is no memory for its constants.
    pub fn new() -> Oracle {
        Oracle::with_bits(BITS)
    }

    /// An oracle of 57 digits, several times faster.
    ///
    /// It serves points at up to 1e4 sizes from tiles whose sides differ by up to 1e5, where the
    /// formula loses at most 12 digits by distance and 10 by thinness.
    ///
    /// # Panics
    /// If there is no memory for its constants.
    pub fn for_moderate_scenes() -> Oracle {
        Oracle::with_bits(MODERATE_BITS)
    }

    fn with_bits(bits: usize) -> Oracle {
        Oracle { arithmetic: Arithmetic { bits }, consts: Consts::new().expect("memory for constants") }
    }

    /// The field of a tile; on its faces the limit from the side that owns the face.
    ///
    /// The frame of a rotated tile adds no rounding, and its quaternion may have any norm.
    pub fn field(&mut self, tile: &Tile, point: DVec3) -> OracleField {
        let num = self.arithmetic;
        let offsets = num.offsets(tile, point);
        let (strength, inside) = self.strength(&offsets, tile.polarization_t());
        let j = tile.polarization_t();
        let density = [0, 1, 2]
            .map(|axis| if inside { num.add(&strength[axis], &num.big(j[axis])) } else { strength[axis].clone() });
        let [density, strength] = [density, strength].map(|own| num.rotated(own, tile.rotation()));
        OracleField { flux_density_t: rounded(&density), strength_t: rounded(&strength) }
    }

    /// The gradient of B of an unrotated tile, by central differences. Column j is dB/dx_j, in
    /// tesla per unit of length.
    pub fn gradient(&mut self, tile: &Tile, point: DVec3) -> DMat3 {
        let num = self.arithmetic;
        let centred = num.offsets(tile, point);
        let nearest = smallest(centred.iter().flatten());
        let step = num.mul(&nearest, &num.power_of_two(STEP_EXPONENT));
        let columns = [0, 1, 2].map(|axis| {
            let [above, below] = [&step, &step.neg()].map(|h| {
                let mut moved = centred.clone();
                moved[axis] = moved[axis].each_ref().map(|offset| num.add(offset, h));
                self.strength(&moved, tile.polarization_t()).0
            });
            let twice = num.add(&step, &step);
            rounded(&[0, 1, 2].map(|i| num.div(&num.sub(&above[i], &below[i]), &twice)))
        });
        DMat3::from_cols(columns[0], columns[1], columns[2])
    }

    /// The derivatives of B of an unrotated tile by the coordinates of its lower and of its upper
    /// faces, by central differences. Columns are by axis.
    pub fn face_derivatives(&mut self, tile: &Tile, point: DVec3) -> [DMat3; 2] {
        let num = self.arithmetic;
        let there = num.offsets(tile, point);
        let nearest = smallest(there.iter().flatten());
        let step = num.mul(&nearest, &num.power_of_two(STEP_EXPONENT));
        let twice = num.add(&step, &step);
        // Index 0 of the offsets is the upper face.
        [1, 0].map(|end: usize| {
            let columns = [0, 1, 2].map(|axis: usize| {
                let [above, below] = [&step, &step.neg()].map(|h| {
                    let mut moved = there.clone();
                    // Moving a face up decreases the offset from it.
                    moved[axis][end] = num.sub(&moved[axis][end], h);
                    self.strength(&moved, tile.polarization_t()).0
                });
                rounded(&[0, 1, 2].map(|i| num.div(&num.sub(&above[i], &below[i]), &twice)))
            });
            DMat3::from_cols(columns[0], columns[1], columns[2])
        })
    }

    /// mu0 H, and whether the point is inside. `offsets` are the offsets of the point from the
    /// faces at +a and at -a, along each axis.
    fn strength(&mut self, offsets: &[[BigFloat; 2]; 3], j: DVec3) -> ([BigFloat; 3], bool) {
        let num = self.arithmetic;
        let distance = |i: usize, k: usize, l: usize| {
            let squares = [&offsets[0][i], &offsets[1][k], &offsets[2][l]].map(|o| num.mul(o, o));
            num.add(&num.add(&squares[0], &squares[1]), &squares[2]).sqrt(num.bits, ROUND)
        };
        let r = [0, 1].map(|i| [0, 1].map(|k| [0, 1].map(|l| distance(i, k, l))));
        let at = |corner: [usize; 3]| &r[corner[0]][corner[1]][corner[2]];
        let mut total = [num.big(0.0), num.big(0.0), num.big(0.0)];
        for own in 0..3 {
            let (next, last) = ((own + 1) % 3, (own + 2) % 3);
            if j[own] != 0.0 {
                let element = self.solid_angles(offsets, at, [own, next, last]);
                total[own] = num.add(&total[own], &num.mul(&element, &num.big(j[own])));
            }
            if j[next] != 0.0 || j[last] != 0.0 {
                let element = self.logarithms(offsets, at, [next, last, own]);
                total[next] = num.add(&total[next], &num.mul(&element, &num.big(j[last])));
                total[last] = num.add(&total[last], &num.mul(&element, &num.big(j[next])));
            }
        }
        let four_pi = num.mul(&self.consts.pi(num.bits, ROUND), &num.big(4.0));
        let inside = offsets.iter().all(|[upper, lower]| upper.is_negative() && lower.is_positive());
        (total.map(|t| num.div(&t, &four_pi)), inside)
    }

    /// Sum over the corners of s_x s_y s_z arctan(Y Z / (X R)).
    fn solid_angles<'a>(
        &mut self,
        offsets: &[[BigFloat; 2]; 3],
        distance: impl Fn([usize; 3]) -> &'a BigFloat,
        [x, y, z]: [usize; 3],
    ) -> BigFloat {
        let num = self.arithmetic;
        let mut total = num.big(0.0);
        for bits in 0..8_usize {
            let corner = [bits & 1, bits >> 1 & 1, bits >> 2];
            let above = num.mul(&offsets[y][corner[y]], &offsets[z][corner[z]]);
            let below = num.mul(&offsets[x][corner[x]], distance(corner));
            let angle = num.div(&above, &below).atan(num.bits, ROUND, &mut self.consts);
            total = if bits.count_ones() % 2 == 0 { num.add(&total, &angle) } else { num.sub(&total, &angle) };
        }
        total
    }

    /// Sum over the four edges along z of s_x s_y times the integral of 1 / R.
    fn logarithms<'a>(
        &mut self,
        offsets: &[[BigFloat; 2]; 3],
        distance: impl Fn([usize; 3]) -> &'a BigFloat,
        [x, y, z]: [usize; 3],
    ) -> BigFloat {
        let num = self.arithmetic;
        let mut ratio = num.big(1.0);
        for (i, k) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let rho_squared =
                num.add(&num.mul(&offsets[x][i], &offsets[x][i]), &num.mul(&offsets[y][k], &offsets[y][k]));
            // R + Z; for Z < 0 it is computed as rho^2 / (R - Z).
            let [near, far] = [0, 1].map(|l| {
                let mut corner = [0; 3];
                (corner[x], corner[y], corner[z]) = (i, k, l);
                let (r, offset) = (distance(corner), &offsets[z][l]);
                if offset.is_negative() { num.div(&rho_squared, &num.sub(r, offset)) } else { num.add(r, offset) }
            });
            let edge = num.div(&far, &near);
            ratio = if i == k { num.mul(&ratio, &edge) } else { num.div(&ratio, &edge) };
        }
        ratio.ln(num.bits, ROUND, &mut self.consts)
    }
}

/// Rounded arithmetic with a number of bits.
#[derive(Clone, Copy)]
struct Arithmetic {
    bits: usize,
}

impl Arithmetic {
    /// Offsets of the point from the faces at +a and at -a, along each axis; zeros are replaced by
    /// a small displacement.
    fn offsets(self, tile: &Tile, point: DVec3) -> [[BigFloat; 2]; 3] {
        let from_centre =
            [0, 1, 2].map(|axis: usize| self.sub(&self.big(point[axis]), &self.big(tile.position()[axis])));
        let from_centre = self.rotated(from_centre, tile.rotation().conjugate());
        let exact = [0, 1, 2].map(|axis: usize| {
            let half = self.big(0.5 * tile.size()[axis]);
            [self.sub(&from_centre[axis], &half), self.add(&from_centre[axis], &half)]
        });
        let nudge =
            self.mul(&smallest(exact.iter().flatten().filter(|o| !o.is_zero())), &self.power_of_two(NUDGE_EXPONENT));
        exact.map(|faces| faces.map(|o| if o.is_zero() { nudge.clone() } else { o }))
    }

    /// v + 2 (w u x v + u x (u x v)) / (w^2 + u^2) for the quaternion (u, w).
    fn rotated(self, v: [BigFloat; 3], rotation: DQuat) -> [BigFloat; 3] {
        if rotation == DQuat::IDENTITY {
            return v;
        }
        let [x, y, z, w] = rotation.to_array().map(|component| self.big(component));
        let square = [&x, &y, &z, &w].map(|c| self.mul(c, c)).into_iter().reduce(|a, b| self.add(&a, &b));
        let twice = self.div(&self.big(2.0), &square.expect("four components"));
        let u = [x, y, z];
        let cross = |v: &[BigFloat; 3]| {
            [(1, 2), (2, 0), (0, 1)].map(|(a, b)| self.sub(&self.mul(&u[a], &v[b]), &self.mul(&u[b], &v[a])))
        };
        let once = cross(&v);
        let again = cross(&once);
        [0, 1, 2].map(|axis: usize| {
            let sum = self.add(&self.mul(&w, &once[axis]), &again[axis]);
            self.add(&v[axis], &self.mul(&twice, &sum))
        })
    }

    fn big(self, value: f64) -> BigFloat {
        BigFloat::from_f64(value, self.bits)
    }

    fn power_of_two(self, exponent: i32) -> BigFloat {
        self.big(2.0_f64.powi(exponent))
    }

    fn add(self, a: &BigFloat, b: &BigFloat) -> BigFloat {
        a.add(b, self.bits, ROUND)
    }

    fn sub(self, a: &BigFloat, b: &BigFloat) -> BigFloat {
        a.sub(b, self.bits, ROUND)
    }

    fn mul(self, a: &BigFloat, b: &BigFloat) -> BigFloat {
        a.mul(b, self.bits, ROUND)
    }

    fn div(self, a: &BigFloat, b: &BigFloat) -> BigFloat {
        a.div(b, self.bits, ROUND)
    }
}

fn smallest<'a>(offsets: impl Iterator<Item = &'a BigFloat>) -> BigFloat {
    offsets.map(BigFloat::abs).reduce(|a, b| if a < b { a } else { b }).expect("a tile has two faces")
}

fn rounded(v: &[BigFloat; 3]) -> DVec3 {
    DVec3::from_array(v.each_ref().map(to_f64))
}

/// The nearest f64, through decimal digits.
fn to_f64(value: &BigFloat) -> f64 {
    let mut rounded = value.clone();
    // About 38 digits suffice to round to 17, and are faster to print.
    rounded.set_precision(128, ROUND).expect("a valid precision");
    rounded.to_string().parse().expect("a printed number")
}
