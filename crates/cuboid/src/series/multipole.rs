//! Evaluation of the multipole series of one cuboid, in vectors (docs/physics.md, section 2.7).

use std::f64::consts::PI;

use fearless_simd::prelude::*;
use magsplice_simd::lanes::{LanePair, Lanes, Number};
use magsplice_simd::pairwise::Pairwise;

use super::coefficients::{GRADIENT_POLYNOMIALS, GradientSeries, POLYNOMIALS, Series, THIRD};
use crate::block::Block;
use crate::closed_form::gradient::COMPONENTS;
use magsplice_simd::compensated_sum::TwoSum;

/// Centre and moment of a cuboid for points far away.
#[derive(Clone, Copy, Debug)]
pub struct Distant {
    centre: [TwoSum; 3],
    scale: f64,
    /// Square of the half diagonal, scaled like the offsets.
    half_diagonal_squared: f64,
    /// V J / 4 pi, scaled.
    moment: [f64; 3],
}

impl Distant {
    /// Prepares a block whose lengths `scale` brings to order one.
    pub fn new(block: &Block, scale: f64) -> Distant {
        let size = block.size.map(|s| s * scale);
        let volume_over_4pi = size[0] * size[1] * size[2] / (4.0 * PI);
        let centre = block.faces.map(|[low, high]| {
            let sum = TwoSum::new(0.5 * low.hi, 0.5 * high.hi);
            TwoSum { hi: sum.hi, lo: sum.lo + (0.5 * low.lo + 0.5 * high.lo) }
        });
        Distant {
            centre,
            scale,
            half_diagonal_squared: 0.25 * size.iter().map(|s| s * s).sum::<f64>(),
            moment: block.polarization_t.to_array().map(|j| j * volume_over_4pi),
        }
    }
}

/// The multipole series of a cuboid up to an order in sigma.
pub struct TruncatedSeries<'a> {
    /// Centre and moment.
    pub tile: &'a Distant,
    /// Coefficients of the shape.
    pub series: &'a Series,
    /// Highest order in sigma.
    pub order: usize,
}

impl<S: Simd> Pairwise<S> for TruncatedSeries<'_> {
    #[inline(always)]
    fn fields(&self, simd: S, points: [[Lanes<S>; 3]; 2]) -> [[Lanes<S>; 3]; 2] {
        let TruncatedSeries { tile, series, order } = *self;
        let (first, second) = (PointOffset::new(simd, tile, points[0]), PointOffset::new(simd, tile, points[1]));
        let [LanePair(ax), LanePair(ay), LanePair(xy), LanePair(xz), LanePair(yz)] =
            series.polynomials(simd, order, side_by_side(&first, &second));
        [
            first.field([ax[0], ay[0], xy[0], xz[0], yz[0]], tile.moment),
            second.field([ax[1], ay[1], xy[1], xz[1], yz[1]], tile.moment),
        ]
    }
}

#[cfg(test)]
impl TruncatedSeries<'_> {
    /// mu0 H in tesla, in the frame of the cuboid.
    pub(crate) fn field<N: Number>(&self, simd: N::Instructions, point: [N; 3]) -> [N; 3] {
        let offset = PointOffset::new(simd, self.tile, point);
        offset.field(self.series.polynomials(simd, self.order, offset.variables()), self.tile.moment)
    }
}

/// The multipole series of the gradient of a cuboid up to an order in sigma.
pub struct TruncatedGradient<'a> {
    /// Centre and moment.
    pub tile: &'a Distant,
    /// Coefficients of the shape.
    pub series: &'a GradientSeries,
    /// Highest order in sigma.
    pub order: usize,
}

impl TruncatedGradient<'_> {
    /// The gradient of B in tesla per length, in the frame of the cuboid, at points given by axis:
    /// xx, yy, zz, yz, xz, xy. The number of points is a multiple of
    /// [`PAIR`](magsplice_simd::lanes::PAIR).
    #[inline(never)]
    pub fn gradients<S: Simd>(&self, simd: S, [x, y, z]: [&[f64]; 3], mut gradients: [&mut [f64]; COMPONENTS]) {
        simd.vectorize(
            #[inline(always)]
            || {
                let len = Lanes::<S>::LEN;
                for start in (0..x.len()).step_by(2 * len) {
                    let (first, second) = (start..start + len, start + len..start + 2 * len);
                    let mut points = [[Lanes::splat(simd, 0.0); 3]; 2];
                    for (axis, coordinates) in [x, y, z].into_iter().enumerate() {
                        points[0][axis] = Lanes::load(simd, &coordinates[first.clone()]);
                        points[1][axis] = Lanes::load(simd, &coordinates[second.clone()]);
                    }
                    let [of_first, of_second] = self.of_pair(simd, points);
                    for (gradients, (one, other)) in gradients.iter_mut().zip(of_first.into_iter().zip(of_second)) {
                        one.store(&mut gradients[first.clone()]);
                        other.store(&mut gradients[second.clone()]);
                    }
                }
            },
        );
    }

    #[inline(always)]
    fn of_pair<S: Simd>(&self, simd: S, points: [[Lanes<S>; 3]; 2]) -> [[Lanes<S>; COMPONENTS]; 2] {
        let TruncatedGradient { tile, series, order } = *self;
        let (first, second) = (PointOffset::new(simd, tile, points[0]), PointOffset::new(simd, tile, points[1]));
        let polynomials = series.polynomials(simd, order, side_by_side(&first, &second));
        let [LanePair(a), LanePair(b), LanePair(c), LanePair(d), LanePair(e), LanePair(f), LanePair(g)] = polynomials;
        [
            first.gradient([a[0], b[0], c[0], d[0], e[0], f[0], g[0]], tile),
            second.gradient([a[1], b[1], c[1], d[1], e[1], f[1], g[1]], tile),
        ]
    }

    /// The same at numbers of any kind.
    #[cfg(test)]
    pub(crate) fn gradient<N: Number>(&self, simd: N::Instructions, point: [N; 3]) -> [N; COMPONENTS] {
        let offset = PointOffset::new(simd, self.tile, point);
        offset.gradient(self.series.polynomials(simd, self.order, offset.variables()), self.tile)
    }
}

#[inline(always)]
fn side_by_side<S: Simd>(first: &PointOffset<Lanes<S>>, second: &PointOffset<Lanes<S>>) -> [LanePair<S>; 3] {
    [LanePair([first.sigma, second.sigma]), LanePair([first.u, second.u]), LanePair([first.v, second.v])]
}

/// Position of points relative to a cuboid.
struct PointOffset<N> {
    offset: [N; 3],
    inverse_square: N,
    /// u - 1/3 and v - 1/3.
    u: N,
    v: N,
    sigma: N,
}

impl<N: Number> PointOffset<N> {
    #[inline(always)]
    fn new(simd: N::Instructions, tile: &Distant, mut point: [N; 3]) -> PointOffset<N> {
        for (coordinate, centre) in point.iter_mut().zip(&tile.centre) {
            *coordinate = ((*coordinate - centre.hi) - centre.lo) * tile.scale;
        }
        let [x, y, z] = point;
        let (x2, y2) = (x * x, y * y);
        let inverse_square = N::splat(simd, 1.0).over(z.mul_add(z, x2 + y2));
        PointOffset {
            offset: point,
            inverse_square,
            u: x2.mul_sub_constant(inverse_square, THIRD),
            v: y2.mul_sub_constant(inverse_square, THIRD),
            sigma: inverse_square * tile.half_diagonal_squared,
        }
    }

    /// The variables of the polynomials: sigma, u - 1/3 and v - 1/3.
    #[cfg(test)]
    fn variables(&self) -> [N; 3] {
        [self.sigma, self.u, self.v]
    }

    /// mu0 H in tesla from the polynomials (Eq. P39).
    #[inline(always)]
    fn field(&self, [ax, ay, xy, xz, yz]: [N; POLYNOMIALS], [jx, jy, jz]: [f64; 3]) -> [N; 3] {
        let [x, y, z] = self.offset;
        let (x_over, y_over, z_over) = (x * self.inverse_square, y * self.inverse_square, z * self.inverse_square);
        let w = z * z_over;
        let xx = (x * x_over).mul_add(xy, w.mul_add(xy - xz, ax));
        let yy = (y * y_over).mul_add(xy, w.mul_add(xy - yz, ay));
        let (xy, xz, yz) = (xy * (x_over * y), xz * (x_over * z), yz * (y_over * z));
        let cube = self.inverse_square * self.inverse_square.sqrt();
        [
            xx.scale_add(jx, xy.scale_add(jy, xz * jz)) * cube,
            xy.scale_add(jx, yy.scale_add(jy, yz * jz)) * cube,
            xz.scale_add(jx, yz.scale_add(jy, (xx + yy) * -jz)) * cube,
        ]
    }
    /// The gradient of B in tesla per length from the polynomials (Eq. P75): xx, yy, zz, yz, xz,
    /// xy.
    #[inline(always)]
    fn gradient(&self, polynomials: [N; GRADIENT_POLYNOMIALS], tile: &Distant) -> [N; COMPONENTS] {
        let [jx, jy, jz] = tile.moment.map(|moment| moment * tile.scale);
        let [xxy, xxz, yyx, yyz, zzx, zzy, mixed] = polynomials;
        let [x, y, z] = self.offset;
        let (x_over, y_over, z_over) = (x * self.inverse_square, y * self.inverse_square, z * self.inverse_square);
        let (u, v, w) = (x * x_over, y * y_over, z * z_over);
        let (xxy, xxz) = (u.mul_add(mixed, xxy) * y, u.mul_add(mixed, xxz) * z);
        let (yyx, yyz) = (v.mul_add(mixed, yyx) * x, v.mul_add(mixed, yyz) * z);
        let (zzx, zzy) = (w.mul_add(mixed, zzx) * x, w.mul_add(mixed, zzy) * y);
        let mixed = mixed * (x_over * y) * z;
        let (xxx, yyy) = (yyx + zzx, xxy + zzy);
        let xx = xxy.scale_add(jy, xxz.scale_add(jz, xxx * -jx));
        let yy = yyx.scale_add(jx, yyz.scale_add(jz, yyy * -jy));
        let yz = mixed.scale_add(jx, yyz.scale_add(jy, zzy * jz));
        let xz = xxz.scale_add(jx, mixed.scale_add(jy, zzx * jz));
        let xy = xxy.scale_add(jx, yyx.scale_add(jy, mixed * jz));
        let fifth = (self.inverse_square * self.inverse_square) * self.inverse_square.sqrt();
        let (xx, yy) = (xx * fifth, yy * fifth);
        // The sum of the diagonal vanishes.
        [xx, yy, (xx + yy) * -1.0, yz * fifth, xz * fifth, xy * fifth]
    }
}
