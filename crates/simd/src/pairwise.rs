//! Fields at many points, two vectors of them at a time.

use fearless_simd::prelude::*;

use crate::lanes::Lanes;
use crate::prefetch::Prefetch;

/// A source with a field, evaluated at two vectors of points at a time. The operations on one
/// vector fill the latency of the operations on the other.
pub trait Pairwise<S: Simd> {
    /// The field at two vectors of points, in the frame of the source.
    fn fields(&self, simd: S, points: [[Lanes<S>; 3]; 2]) -> [[Lanes<S>; 3]; 2];
}

/// Writes the field at points given by axis. `fields` has as many values as there are points, a
/// multiple of [`PAIR`](crate::lanes::PAIR). Each pair of vectors requests memory `ahead`.
///
/// It is compiled once for each source and instruction set; inlining it would take minutes to
/// compile.
#[inline(never)]
pub fn fields_of<S: Simd, P: Pairwise<S>>(
    simd: S,
    what: &P,
    points: [&[f64]; 3],
    fields: [&mut [f64]; 3],
    ahead: &mut Prefetch,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            each_pair(
                simd,
                #[inline(always)]
                |_, pair| {
                    ahead.request();
                    what.fields(simd, pair)
                },
                points,
                fields,
            );
        },
    );
}

/// Calls `field` with each pair of vectors and the index of its first point, and writes the
/// results.
#[inline(always)]
pub fn each_pair<S: Simd>(
    simd: S,
    mut field: impl FnMut(usize, [[Lanes<S>; 3]; 2]) -> [[Lanes<S>; 3]; 2],
    [x, y, z]: [&[f64]; 3],
    [fx, fy, fz]: [&mut [f64]; 3],
) {
    let len = Lanes::<S>::LEN;
    let points = x.chunks_exact(2 * len).zip(y.chunks_exact(2 * len)).zip(z.chunks_exact(2 * len));
    let fields = fx.chunks_exact_mut(2 * len).zip(fy.chunks_exact_mut(2 * len)).zip(fz.chunks_exact_mut(2 * len));
    for (number, (((x, y), z), ((fx, fy), fz))) in points.zip(fields).enumerate() {
        let first = [Lanes::load(simd, &x[..len]), Lanes::load(simd, &y[..len]), Lanes::load(simd, &z[..len])];
        let second = [Lanes::load(simd, &x[len..]), Lanes::load(simd, &y[len..]), Lanes::load(simd, &z[len..])];
        let [first, second] = field(number * 2 * len, [first, second]);
        first[0].store(&mut fx[..len]);
        first[1].store(&mut fy[..len]);
        first[2].store(&mut fz[..len]);
        second[0].store(&mut fx[len..]);
        second[1].store(&mut fy[len..]);
        second[2].store(&mut fz[len..]);
    }
}
