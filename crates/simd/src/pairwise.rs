//! Fields at many points, two vectors of them at a time.

use fearless_simd::prelude::*;

use crate::lanes::Lanes;
use crate::prefetch::Ahead;

/// What has a field, mu0 H in its own frame, and computes it at two vectors of points at a time: operations on one then fill the time that
/// those on the other wait.
pub trait Pairwise<S: Simd> {
    fn fields(&self, simd: S, points: [[Lanes<S>; 3]; 2]) -> [[Lanes<S>; 3]; 2];
}

/// The field at points given by axis: as many values as there are points, a multiple of [`PAIR`](crate::lanes::PAIR). Each pair of vectors asks for
/// memory `ahead`.
///
/// Compiled once for each kind and instruction set: what is expanded where it is called takes the compiler minutes.
#[inline(never)]
pub fn fields_of<S: Simd, P: Pairwise<S>>(
    simd: S,
    what: &P,
    points: [&[f64]; 3],
    fields: [&mut [f64]; 3],
    ahead: &mut Ahead,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            each_pair(
                simd,
                #[inline(always)]
                |_, pair| {
                    ahead.ask();
                    what.fields(simd, pair)
                },
                points,
                fields,
            );
        },
    );
}

/// The same of a function of the index of the first point of both vectors and of the two vectors.
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
