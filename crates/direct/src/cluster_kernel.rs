//! The closed form of the tiles of a cluster, in vectors, for points outside the tiles and at most
//! a few sizes away (docs/physics.md, section 2.6).
//!
//! As in the [scalar kernel](magsplice_cuboid::scalar), differences are taken before the logarithm
//! and the arctangent, but only without divisions. The remaining cancellation loses a factor of
//! distance over the second side of a tile. Each element is represented by a split-complex or a
//! complex number. Products of such numbers add logarithms or angles, so tiles of equal strength
//! share a division and a series. An element whose strength occurs once skips the products; within
//! a tolerance it shares its division with the other such elements of its tile.

use std::any::Any;

use fearless_simd::prelude::*;

use magsplice_cuboid::closed_form::elements::{
    CornerGeometry, FieldSum, add_elements, add_small_elements, common_inverse,
};
use magsplice_cuboid::closed_form::rod::ratios_of_rod;
use magsplice_cuboid::closed_form::terms::{AA, AB, AC, BB, BC, CC, Form, Group};
use magsplice_simd::functions::{angle, artanh_of_ratio, short_odd_series};
use magsplice_simd::lanes::{Lanes, Number};

use crate::prepare::corner_tables::CornerTables;
use crate::prepare::tile_terms::{NO_GROUP, OWN, TileTerms};
use crate::tolerances::{MOST_CORNERS, MOST_GROUPS, MOST_PLANES};

/// Buffer for the [`Tables`] of the instruction set last used.
#[derive(Default)]
pub(super) struct KeptTables(Option<Box<dyn Any + Send>>);

impl KeptTables {
    /// mu0 H of the tiles of `cluster` in tesla, in their frame, at points outside them, given by
    /// axis in whole vectors. `small` means that all elements are small at these points.
    pub(super) fn fields<S: Simd>(
        &mut self,
        simd: S,
        cluster: &CornerTables,
        small: bool,
        points: [&[f64]; 3],
        fields: [&mut [f64]; 3],
    ) {
        if cluster.has_rods {
            self.fields_of::<S, true>(simd, cluster, small, points, fields);
        } else {
            self.fields_of::<S, false>(simd, cluster, small, points, fields);
        }
    }

    #[inline(never)]
    fn fields_of<S: Simd, const HAS_RODS: bool>(
        &mut self,
        simd: S,
        cluster: &CornerTables,
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
                    // After the last points the first are prepared again, which avoids a branch in
                    // the loop.
                    let next = if end < x.len() { end } else { 0 };
                    let next = load(simd, [x, y, z], next);
                    let field = tables.field::<HAS_RODS>(simd, cluster, next, small);
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
pub(super) fn load<S: Simd>(simd: S, points: [&[f64]; 3], start: usize) -> [Lanes<S>; 3] {
    let [x, y, z] = points.map(|axis| &axis[start..start + Lanes::<S>::LEN]);
    [Lanes::load(simd, x), Lanes::load(simd, y), Lanes::load(simd, z)]
}

/// Tables of vectors, kept between calls. Their length is fixed, so a masked index needs no bounds
/// check.
struct Tables<S: Simd> {
    /// Tables of the current points and of the next points. The second is filled during the
    /// evaluation of the first, so square roots and products overlap.
    places: Box<[Places<S>; 2]>,
    /// Index of the table of the next points.
    next: usize,
    products: Products<S>,
}

/// The running product of each group.
struct Products<S: Simd>(Box<[[Lanes<S>; 2]; MOST_GROUPS]>);

/// Position of the points relative to a cluster, in its scale.
pub(super) struct Places<S: Simd> {
    /// Offsets from the planes.
    offsets: [Lanes<S>; MOST_PLANES],
    squares: [Lanes<S>; MOST_PLANES],
    /// Distances from the corners.
    distances: [Lanes<S>; MOST_CORNERS],
    /// Padding that puts the same corner in the two tables half a page apart with the longest
    /// vectors. Otherwise a processor that compares the low twelve bits of addresses would delay
    /// reading one until the other is written.
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
    pub(super) fn new(simd: S) -> Places<S> {
        let zero = Lanes::<S>::splat(simd, 0.0);
        Places {
            offsets: [zero; MOST_PLANES],
            squares: [zero; MOST_PLANES],
            distances: [zero; MOST_CORNERS],
            _apart: [zero; APART],
        }
    }

    #[inline(always)]
    fn set_offsets(&mut self, cluster: &CornerTables, point: [Lanes<S>; 3]) {
        for (index, (axis, coordinate)) in (0..).zip(&cluster.planes) {
            let offset = ((point[*axis] - coordinate.hi) - coordinate.lo) * cluster.scale;
            self.offsets[plane(index)] = offset;
            self.squares[plane(index)] = offset * offset;
        }
    }

    /// Fills the tables.
    #[inline(always)]
    pub(super) fn set(&mut self, cluster: &CornerTables, point: [Lanes<S>; 3]) {
        self.set_offsets(cluster, point);
        for (index, planes) in (0..).step_by(2).zip(&cluster.corners) {
            self.set_distances(index, planes);
        }
    }

    /// Writes the distances from two corners, the first of which has this index.
    #[inline(always)]
    fn set_distances(&mut self, index: u16, [first, second]: &[[u16; 3]; 2]) {
        self.distances[corner(index)] = self.square(first).sqrt();
        self.distances[corner(index + 1)] = self.square(second).sqrt();
    }

    /// Position of the points relative to a tile.
    #[inline(always)]
    pub(super) fn of(&self, tile: &TileTerms) -> CornerGeometry<Lanes<S>> {
        let plane = |index: u16| [self.offsets[plane(index)], self.squares[plane(index)]];
        let [a0, a1, b0, b1, c0, c1] = tile.planes;
        CornerGeometry {
            planes: [[plane(a0), plane(a1)], [plane(b0), plane(b1)], [plane(c0), plane(c1)]],
            distances: tile.corners.map(|index| self.distances[corner(index)]),
        }
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

    /// Fills the table of the first points.
    #[inline(always)]
    fn start(&mut self, cluster: &CornerTables, first: [Lanes<S>; 3]) {
        self.places[self.next].set(cluster, first);
    }

    /// mu0 H of the tiles of `cluster` in tesla, in their frame, at the `next` points of the
    /// previous call (or of [`Tables::start`]).
    #[inline(always)]
    fn field<const HAS_RODS: bool>(
        &mut self,
        simd: S,
        cluster: &CornerTables,
        next: [Lanes<S>; 3],
        small: bool,
    ) -> [Lanes<S>; 3] {
        let (current, mut upcoming) = Upcoming::of(&mut self.places, &mut self.next, cluster, next);
        let (zero, one) = (Lanes::<S>::splat(simd, 0.0), Lanes::<S>::splat(simd, 1.0));
        for product in &mut self.products.0[..cluster.groups.len()] {
            *product = [one, zero];
        }
        let mut sum = [zero; 3];
        for tile in &cluster.tiles {
            if !tile.has_own {
                multiply::<S, false, HAS_RODS>(simd, tile, current, &mut upcoming, &mut self.products);
                continue;
            }
            let own = multiply::<S, true, HAS_RODS>(simd, tile, current, &mut upcoming, &mut self.products);
            let is_own = tile.groups.map(|number| number == OWN);
            let mut total = FieldSum { field_t: sum, coefficients: &tile.coefficients };
            if small {
                let inverse = common_inverse(simd, is_own, &own);
                add_small_elements(simd, is_own, &own, inverse, true, &mut total);
            } else {
                add_elements(simd, is_own, &own, &mut total);
            }
            sum = total.field_t;
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

/// The table of the next points during its filling.
struct Upcoming<'a, S: Simd> {
    places: &'a mut Places<S>,
    corners: &'a [[[u16; 3]; 2]],
    step: usize,
    known: u16,
}

impl<'a, S: Simd> Upcoming<'a, S> {
    /// The table of the current points, and the table of the next `points`, which replaces the
    /// previous table.
    #[inline(always)]
    fn of(
        [even, odd]: &'a mut [Places<S>; 2],
        next: &mut usize,
        cluster: &'a CornerTables,
        points: [Lanes<S>; 3],
    ) -> (&'a Places<S>, Upcoming<'a, S>) {
        let (current, upcoming) = if *next == 0 { (even, odd) } else { (odd, even) };
        *next = 1 - *next;
        upcoming.set_offsets(cluster, points);
        let (corners, step) = (&cluster.corners, cluster.corner_pairs_per_step);
        (current, Upcoming { places: upcoming, corners, step, known: 0 })
    }

    /// Fills in the distances of a few more corners. It is called twice for each tile, so the
    /// branch is predictable.
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

/// Multiplies the terms of one tile onto the products of their groups. Returns numerators and
/// denominators of the elements without a group.
#[inline(always)]
fn multiply<S: Simd, const HAS_OWN: bool, const HAS_RODS: bool>(
    simd: S,
    tile: &TileTerms,
    places: &Places<S>,
    upcoming: &mut Upcoming<S>,
    products: &mut Products<S>,
) -> [[Lanes<S>; 2]; 6] {
    let mut own = [[Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0)]; 6];
    let place = places.of(tile);
    let (factors, squares) = (&tile.factors, &tile.squares);
    if tile.groups[AB] != NO_GROUP {
        put::<S, HAS_OWN>(tile, AB, place.ratio::<AB>(factors, squares), products, &mut own);
    }
    if tile.groups[AC] != NO_GROUP {
        put::<S, HAS_OWN>(tile, AC, place.ratio::<AC>(factors, squares), products, &mut own);
    }
    let is_rod = HAS_RODS && tile.form == Form::Rod;
    if is_rod {
        let ratios = ratios_of_rod(simd, &place, factors, squares);
        for (element, ratio) in [BC, BB].into_iter().zip(ratios) {
            if tile.groups[element] != NO_GROUP {
                put::<S, HAS_OWN>(tile, element, ratio, products, &mut own);
            }
        }
    } else if tile.groups[BC] != NO_GROUP {
        put::<S, HAS_OWN>(tile, BC, place.ratio::<BC>(factors, squares), products, &mut own);
    }
    upcoming.advance();
    if tile.groups[AA] != NO_GROUP {
        put::<S, HAS_OWN>(tile, AA, place.ratio::<AA>(factors, squares), products, &mut own);
    }
    if !is_rod && tile.groups[BB] != NO_GROUP {
        put::<S, HAS_OWN>(tile, BB, place.ratio::<BB>(factors, squares), products, &mut own);
    }
    if tile.groups[CC] != NO_GROUP {
        put::<S, HAS_OWN>(tile, CC, place.ratio::<CC>(factors, squares), products, &mut own);
    }
    upcoming.advance();
    own
}

/// Multiplies a term onto the product of its group, or writes it to `own`.
#[inline(always)]
fn put<S: Simd, const HAS_OWN: bool>(
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
    /// Adds all groups, with one division for four groups. Half angles must be at most
    /// [`SMALLER_ANGLE`](magsplice_cuboid::tolerances::SMALLER_ANGLE).
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
