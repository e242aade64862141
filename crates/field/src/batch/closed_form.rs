//! The closed form for points neither beside a tile nor many sizes away, in the lanes of a vector (docs/physics.md, section 2.6).
//!
//! As in [`kernel`](crate::kernel) differences are taken before the logarithm and the arctangent, but only as far as that needs no division.
//! What remains loses the factor distance / size of the tile's second side. Each element is a number of a split-complex or a complex
//! plane, whose products add logarithms or angles: tiles with one strength share a division and a series. What has a strength of its own is
//! multiplied onto nothing; to a tolerance it shares the division with what else the tile has of that kind.

use std::any::Any;

use fearless_simd::prelude::*;

use super::alone::{add_elements, add_small_elements, common_inverse};
use super::cluster::Cluster;
use super::functions::{angle, artanh_of_ratio, short_odd_series};
use super::lanes::{Lanes, Number};
use super::terms::{AA, AB, AC, BB, BC, CC, Group, NO_GROUP, OWN, TileTerms};
use crate::tolerances::{MOST_CORNERS, MOST_GROUPS, MOST_PLANES};

/// Room for the [`Tables`] of the instruction set last used.
#[derive(Default)]
pub(super) struct KeptTables(Option<Box<dyn Any + Send>>);

impl KeptTables {
    /// mu0 H of the tiles of `cluster`, in their frame, at points outside them, given by axis in whole vectors; perhaps so far that all elements are
    /// `small`.
    #[inline(never)]
    pub(super) fn fields<S: Simd>(
        &mut self,
        simd: S,
        cluster: &Cluster,
        small: bool,
        [x, y, z]: [&[f64]; 3],
        [fx, fy, fz]: [&mut [f64]; 3],
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                let kept = self.0.take().and_then(|tables| tables.downcast::<Tables<S>>().ok());
                let mut tables = kept.unwrap_or_else(|| Box::new(Tables::new(simd)));
                tables.start(cluster, load(simd, [x, y, z], 0));
                for start in (0..x.len()).step_by(Lanes::<S>::LEN) {
                    let end = start + Lanes::<S>::LEN;
                    // After the last points the first again, to have something to prepare.
                    let next = if end < x.len() { end } else { 0 };
                    let field = tables.field(simd, cluster, load(simd, [x, y, z], next), small);
                    field[0].store(&mut fx[start..end]);
                    field[1].store(&mut fy[start..end]);
                    field[2].store(&mut fz[start..end]);
                }
                self.0 = Some(tables);
            },
        );
    }
}

#[inline(always)]
fn load<S: Simd>(simd: S, points: [&[f64]; 3], start: usize) -> [Lanes<S>; 3] {
    let [x, y, z] = points.map(|axis| &axis[start..start + Lanes::<S>::LEN]);
    [Lanes::load(simd, x), Lanes::load(simd, y), Lanes::load(simd, z)]
}

/// Tables of vectors, kept between calls. Their length is fixed, so that an index masked to it needs no check.
struct Tables<S: Simd> {
    /// Of the points at work and of those after them, which are made at the same time: square roots and products then overlap.
    places: Box<[Places<S>; 2]>,
    /// Which of the two is that of the points after them.
    next: usize,
    products: Products<S>,
}

/// The product so far of each group.
struct Products<S: Simd>(Box<[[Lanes<S>; 2]; MOST_GROUPS]>);

/// Where points lie relative to a cluster, in its scale.
struct Places<S: Simd> {
    /// Offsets from the planes.
    offsets: [Lanes<S>; MOST_PLANES],
    squares: [Lanes<S>; MOST_PLANES],
    /// Distances from the corners.
    distances: [Lanes<S>; MOST_CORNERS],
    /// Puts the same corner of the two places half a page apart with the longest vectors: a processor that compares the low twelve bits of addresses
    /// would wait for the one that is written before it reads the other.
    _apart: [Lanes<S>; APART],
}

const APART: usize = 32;

#[inline(always)]
fn corner(index: u16) -> usize {
    usize::from(index) & (MOST_CORNERS - 1)
}

#[inline(always)]
fn plane(index: u16) -> usize {
    usize::from(index) & (MOST_PLANES - 1)
}

#[inline(always)]
fn group(index: u16) -> usize {
    usize::from(index) & (MOST_GROUPS - 1)
}

impl<S: Simd> Places<S> {
    #[inline(always)]
    fn new(simd: S) -> Places<S> {
        let zero = Lanes::<S>::splat(simd, 0.0);
        Places {
            offsets: [zero; MOST_PLANES],
            squares: [zero; MOST_PLANES],
            distances: [zero; MOST_CORNERS],
            _apart: [zero; APART],
        }
    }

    #[inline(always)]
    fn set_offsets(&mut self, cluster: &Cluster, point: [Lanes<S>; 3]) {
        for (index, (axis, coordinate)) in (0..).zip(&cluster.planes) {
            let offset = ((point[*axis] - coordinate.hi) - coordinate.lo) * cluster.scale;
            self.offsets[plane(index)] = offset;
            self.squares[plane(index)] = offset * offset;
        }
    }

    /// Distances from two corners, of which the first has this index.
    #[inline(always)]
    fn set_distances(&mut self, index: u16, [first, second]: &[[u16; 3]; 2]) {
        self.distances[corner(index)] = self.square(first).sqrt();
        self.distances[corner(index + 1)] = self.square(second).sqrt();
    }

    #[inline(always)]
    fn square(&self, [x, y, z]: &[u16; 3]) -> Lanes<S> {
        self.squares[plane(*x)] + self.squares[plane(*y)] + self.squares[plane(*z)]
    }
}

impl<S: Simd> Tables<S> {
    #[inline(always)]
    fn new(simd: S) -> Tables<S> {
        let zero = Lanes::<S>::splat(simd, 0.0);
        Tables {
            places: Box::new([Places::new(simd), Places::new(simd)]),
            next: 0,
            products: Products(Box::new([[zero; 2]; MOST_GROUPS])),
        }
    }

    /// Begins with the first points.
    #[inline(always)]
    fn start(&mut self, cluster: &Cluster, first: [Lanes<S>; 3]) {
        let next = &mut self.places[self.next];
        next.set_offsets(cluster, first);
        for (index, planes) in (0..).step_by(2).zip(&cluster.corners) {
            next.set_distances(index, planes);
        }
    }

    /// mu0 H of the tiles of `cluster`, in their frame, at the points given as `next` before (or to [`Tables::start`]), which are outside them; perhaps so far
    /// that all elements are `small`.
    #[inline(always)]
    fn field(&mut self, simd: S, cluster: &Cluster, next: [Lanes<S>; 3], small: bool) -> [Lanes<S>; 3] {
        let [even, odd] = &mut *self.places;
        let (current, upcoming) = if self.next == 0 { (even, odd) } else { (odd, even) };
        self.next = 1 - self.next;
        upcoming.set_offsets(cluster, next);
        let (zero, one) = (Lanes::<S>::splat(simd, 0.0), Lanes::<S>::splat(simd, 1.0));
        for product in &mut self.products.0[..cluster.groups.len()] {
            *product = [one, zero];
        }
        let mut upcoming =
            Upcoming { places: upcoming, corners: &cluster.corners, step: cluster.corner_pairs_per_step, known: 0 };
        let mut sum = [zero; 3];
        for tile in &cluster.tiles {
            if !tile.has_own {
                multiply::<S, false>(simd, tile, current, &mut upcoming, &mut self.products);
                continue;
            }
            let own = multiply::<S, true>(simd, tile, current, &mut upcoming, &mut self.products);
            let is_own = tile.groups.map(|number| number == OWN);
            if small {
                let inverse = common_inverse(simd, is_own, &own);
                add_small_elements(simd, is_own, &own, inverse, short_odd_series, &tile.coefficients, &mut sum);
            } else {
                add_elements(simd, is_own, &own, &tile.coefficients, &mut sum);
            }
        }
        if small {
            self.products.add_small(simd, &cluster.groups, &mut sum);
            return sum;
        }
        for (group, [a, b]) in cluster.groups.iter().zip(&self.products.0[..]) {
            let half = if group.diagonal { angle(simd, *a, *b) } else { artanh_of_ratio(simd, *b, *a) };
            for (sum, coefficient) in sum.iter_mut().zip(group.coefficient) {
                *sum = half.scale_add(coefficient, *sum);
            }
        }
        sum
    }
}

/// The places of the next points while they are made.
struct Upcoming<'a, S: Simd> {
    places: &'a mut Places<S>,
    corners: &'a [[[u16; 3]; 2]],
    step: usize,
    known: u16,
}

impl<S: Simd> Upcoming<'_, S> {
    /// The distances from a few more corners; twice for each tile, so that the processor foresees how many.
    #[inline(always)]
    fn advance(&mut self) {
        for _ in 0..self.step {
            if let Some(planes) = self.corners.get(usize::from(self.known / 2)) {
                self.places.set_distances(self.known, planes);
                self.known += 2;
            }
        }
    }
}

/// Multiplies the terms of one tile onto the products of their groups. What has no group, if there is such a term, is given back: numerators and denominators
/// by element.
#[inline(always)]
fn multiply<S: Simd, const HAS_OWN: bool>(
    simd: S,
    tile: &TileTerms,
    places: &Places<S>,
    upcoming: &mut Upcoming<S>,
    products: &mut Products<S>,
) -> [[Lanes<S>; 2]; 6] {
    let mut own = [[Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0)]; 6];
    let [a, b, c, d, e, f, g, h] = tile.corners;
    let r = &places.distances;
    // Bits 2, 1, 0: low or high along a, b, c.
    let low = [r[corner(a)], r[corner(b)], r[corner(c)], r[corner(d)]];
    let high = [r[corner(e)], r[corner(f)], r[corner(g)], r[corner(h)]];
    let r = [low[0], low[1], low[2], low[3], high[0], high[1], high[2], high[3]];
    let [a0, a1, b0, b1, c0, c1] = tile.planes;
    let (a0, a1, b0, b1, c0, c1) = (plane(a0), plane(a1), plane(b0), plane(b1), plane(c0), plane(c1));
    let (offset, square) = (&places.offsets, &places.squares);
    let (a0, a1) = ([offset[a0], square[a0]], [offset[a1], square[a1]]);
    let (b0, b1) = ([offset[b0], square[b0]], [offset[b1], square[b1]]);
    let (c0, c1) = ([offset[c0], square[c0]], [offset[c1], square[c1]]);
    // Sums over the ends of edges. Along b, bits low or high along a, c; along c, bits along a, b.
    let along_b = [r[0] + r[2], r[1] + r[3], r[4] + r[6], r[5] + r[7]];
    let along_c = [r[0] + r[1], r[2] + r[3], r[4] + r[5], r[6] + r[7]];
    if tile.groups[AB] != NO_GROUP {
        let step = (b0[0] + b1[0]) * tile.factors[AB];
        let low = edge_pair([along_b[0], along_b[1]], [along_c[0], along_c[1]], tile.squares[2]);
        let high = edge_pair([along_b[2], along_b[3]], [along_c[2], along_c[3]], tile.squares[2]);
        place::<S, HAS_OWN>(tile, AB, ratio_of_edges(step, low, high), products, &mut own);
    }
    if tile.groups[AC] != NO_GROUP {
        let step = (c0[0] + c1[0]) * tile.factors[AC];
        let low = edge_pair([along_c[0], along_c[1]], [along_b[0], along_b[1]], tile.squares[1]);
        let high = edge_pair([along_c[2], along_c[3]], [along_b[2], along_b[3]], tile.squares[1]);
        place::<S, HAS_OWN>(tile, AC, ratio_of_edges(step, low, high), products, &mut own);
    }
    if tile.groups[BC] != NO_GROUP {
        // Bits along b, c.
        let along_a = [r[0] + r[4], r[1] + r[5], r[2] + r[6], r[3] + r[7]];
        let step = (c0[0] + c1[0]) * tile.factors[BC];
        let low = edge_pair([along_c[0], along_c[2]], [along_a[0], along_a[1]], tile.squares[0]);
        let high = edge_pair([along_c[1], along_c[3]], [along_a[2], along_a[3]], tile.squares[0]);
        place::<S, HAS_OWN>(tile, BC, ratio_of_edges(step, low, high), products, &mut own);
    }
    upcoming.advance();
    if tile.groups[AA] != NO_GROUP {
        let across = across(b0, b1, c0, c1);
        let low = face([r[0], r[1], r[2], r[3]], a0, across, tile.factors[AA]);
        let high = face([r[4], r[5], r[6], r[7]], a1, across, tile.factors[AA]);
        place::<S, HAS_OWN>(tile, AA, angle_of_faces(low, high), products, &mut own);
    }
    if tile.groups[BB] != NO_GROUP {
        let across = across(c0, c1, a0, a1);
        let low = face([r[0], r[4], r[1], r[5]], b0, across, tile.factors[BB]);
        let high = face([r[2], r[6], r[3], r[7]], b1, across, tile.factors[BB]);
        place::<S, HAS_OWN>(tile, BB, angle_of_faces(low, high), products, &mut own);
    }
    if tile.groups[CC] != NO_GROUP {
        let across = across(a0, a1, b0, b1);
        let low = face([r[0], r[2], r[4], r[6]], c0, across, tile.factors[CC]);
        let high = face([r[1], r[3], r[5], r[7]], c1, across, tile.factors[CC]);
        place::<S, HAS_OWN>(tile, CC, angle_of_faces(low, high), products, &mut own);
    }
    upcoming.advance();
    own
}

/// Onto the product of its group, or into `own`.
#[inline(always)]
fn place<S: Simd, const HAS_OWN: bool>(
    tile: &TileTerms,
    element: usize,
    ratio: [Lanes<S>; 2],
    products: &mut Products<S>,
    own: &mut [[Lanes<S>; 2]; 6],
) {
    let number = tile.groups[element];
    if HAS_OWN && number == OWN {
        own[element] = ratio;
    } else if element < AA {
        products.add_logarithm(number, ratio);
    } else {
        products.add_angle(number, ratio);
    }
}

impl<S: Simd> Products<S> {
    /// What all groups add where none has a half angle beyond [`SMALLER_ANGLE`](crate::tolerances::SMALLER_ANGLE): four of them share a division.
    #[inline(always)]
    fn add_small(&mut self, simd: S, groups: &[Group], sum: &mut [Lanes<S>; 3]) {
        let (zero, one) = (Lanes::<S>::splat(simd, 0.0), Lanes::<S>::splat(simd, 1.0));
        for (groups, products) in groups.chunks(4).zip(self.0.chunks_exact_mut(4)) {
            products[groups.len()..].fill([one, zero]);
            let [[a, n], [b, p], [c, q], [d, r]] = [products[0], products[1], products[2], products[3]];
            let (ab, cd) = (a * b, c * d);
            let inverse = one.over(ab * cd);
            let (over_ab, over_cd) = (inverse * cd, inverse * ab);
            let ratios = [n * (over_ab * b), p * (over_ab * a), q * (over_cd * d), r * (over_cd * c)];
            for (group, ratio) in groups.iter().zip(ratios) {
                let half = short_odd_series(simd, ratio, group.diagonal);
                for (sum, coefficient) in sum.iter_mut().zip(group.coefficient) {
                    *sum = half.scale_add(coefficient, *sum);
                }
            }
        }
    }

    #[inline(always)]
    fn add_logarithm(&mut self, number: u16, [n, m]: [Lanes<S>; 2]) {
        let [a, b] = self.0[group(number)];
        self.0[group(number)] = [a.mul_add(m, b * n), a.mul_add(n, b * m)];
    }

    #[inline(always)]
    fn add_angle(&mut self, number: u16, [im, re]: [Lanes<S>; 2]) {
        let [a, b] = self.0[group(number)];
        self.0[group(number)] = [a.mul_sub(re, b * im), a.mul_add(im, b * re)];
    }
}

/// Numerator and denominator of tanh(2 pi T_ij) of a tile, from the edges on its low and its high side along j (Eq. P18).
#[inline(always)]
pub(super) fn ratio_of_edges<N: Number>(step: N, (p_low, e_low): (N, N), (p_high, e_high): (N, N)) -> [N; 2] {
    let (low, high) = (step * p_low, step * p_high);
    [high.mul_sub(e_low, low * e_high), e_low.mul_sub(e_high, low * high)]
}

/// Numerator and denominator of tan(2 pi T_ii) of a tile: the angle of the high face less that of the low one (Eq. P19).
#[inline(always)]
pub(super) fn angle_of_faces<N: Number>((re_low, im_low): (N, N), (re_high, im_high): (N, N)) -> [N; 2] {
    [re_low.mul_sub(im_high, im_low * re_high), re_low.mul_add(re_high, im_low * im_high)]
}

/// P and Q B of Eq. P18 of the two edges on one side along j, from the sums across i at both ends and along k at both sides.
#[inline(always)]
pub(super) fn edge_pair<N: Number>(across: [N; 2], along: [N; 2], length_squared: f64) -> (N, N) {
    (across[0] + across[1], (across[0] * across[1]) * along[0].mul_sub_constant(along[1], length_squared))
}

/// Products of the vectors to the corners of a face, without the square of its distance: 00.11, then 00.01 and 01.11, then 00.10 and 10.11.
/// Planes as offset and square.
#[inline(always)]
pub(super) fn across<N: Number>(y0: [N; 2], y1: [N; 2], z0: [N; 2], z1: [N; 2]) -> [N; 5] {
    let (yy, zz) = (y0[0] * y1[0], z0[0] * z1[0]);
    [yy + zz, y0[1] + zz, yy + z1[1], yy + z0[1], y1[1] + zz]
}

/// A complex number whose angle is half the solid angle of a face: the product of those of its two triangles (Eq. P19).
#[inline(always)]
pub(super) fn face<N: Number>(
    [r00, r01, r10, r11]: [N; 4],
    [offset, square]: [N; 2],
    across: [N; 5],
    area: f64,
) -> (N, N) {
    let diagonal = r00.mul_add(r11, square + across[0]);
    let common = square * (r00 + r11);
    let a = r01.mul_add(diagonal, across[1].mul_add(r11, across[2].mul_add(r00, common)));
    let b = r10.mul_add(diagonal, across[3].mul_add(r11, across[4].mul_add(r00, common)));
    let n = offset * area;
    (a.mul_sub(b, n * n), n * (a + b))
}
