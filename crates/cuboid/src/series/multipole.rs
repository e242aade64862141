//! Evaluation of the multipole series of one cuboid, in vectors (docs/physics.md, section 2.7).

use std::f64::consts::PI;

use fearless_simd::prelude::*;
use magsplice_simd::differentiated::Differentiated;
use magsplice_simd::lanes::{LanePair, Lanes, Number};
use magsplice_simd::pairwise::Pairwise;

use super::coefficients::{POLYNOMIALS, Series, THIRD};
use crate::block::Block;
use crate::tolerances::HIGHEST_ORDER;
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
        let at = [LanePair([first.sigma, second.sigma]), LanePair([first.u, second.u]), LanePair([first.v, second.v])];
        let polynomials = match order {
            0..=3 => series.polynomials::<3, _>(simd, at),
            4 => series.polynomials::<4, _>(simd, at),
            5 => series.polynomials::<5, _>(simd, at),
            6 => series.polynomials::<6, _>(simd, at),
            _ => series.polynomials::<HIGHEST_ORDER, _>(simd, at),
        };
        let [LanePair(ax), LanePair(ay), LanePair(xy), LanePair(xz), LanePair(yz)] = polynomials;
        [
            first.field([ax[0], ay[0], xy[0], xz[0], yz[0]], tile.moment),
            second.field([ax[1], ay[1], xy[1], xz[1], yz[1]], tile.moment),
        ]
    }
}

impl TruncatedSeries<'_> {
    /// mu0 H in tesla and its derivatives, in the frame of the cuboid.
    #[inline(always)]
    pub fn differentiated<N: Number>(&self, simd: N::Instructions, point: [N; 3]) -> [Differentiated<N>; 3] {
        let [x, y, z] = point;
        let point = [
            Differentiated::coordinate(simd, x, 0),
            Differentiated::coordinate(simd, y, 1),
            Differentiated::coordinate(simd, z, 2),
        ];
        let offset = PointOffset::new(simd, self.tile, point);
        let at = [offset.sigma, offset.u, offset.v];
        offset.field(self.series.differentiated_polynomials(simd, self.order, at), self.tile.moment)
    }
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
}
