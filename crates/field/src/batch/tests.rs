//! Vector functions against the standard library's, expansions against the kernel of one point, for each kind of instructions.

use fearless_simd::{Level, Simd, dispatch};

use super::cluster::Cluster;
use super::expansion::Expansion;
use super::functions::{angle, artanh_of_ratio, short_odd_series};
use super::harmonics::{Moments, Source};
use super::instruction_set::InstructionSet;
use super::lanes::{Lanes, Number};
use super::multipole::{Distant, Distributed};
use super::pairwise::Pairwise;
use super::range::{FORMS, MIDDLE, OUTER, Range};
use super::series::Series;
use crate::block::{Block, Local};
use crate::kernel::{Part, cuboid_field};
use crate::tolerances::{
    EXPANSION_DEGREES, HIGHEST_ORDER, MULTIPOLE_ORDERS, SINGLE_PRECISION_BOUND, SMALL_ANGLE, SMALLER_ANGLE,
};
use glam::DVec3;

#[derive(Clone, Copy)]
enum Function {
    Artanh,
    Angle,
    Root,
    ShortArtanh,
    ShortArctan,
}

/// The function of a and b in every lane; the first is returned.
#[inline(always)]
fn apply<S: Simd>(simd: S, function: Function, a: f64, b: f64) -> f64 {
    let (a, b) = (Lanes::<S>::splat(simd, a), Lanes::<S>::splat(simd, b));
    let result = match function {
        Function::Artanh => artanh_of_ratio(simd, a, b),
        Function::Angle => angle(simd, a, b),
        Function::Root => a.root(simd),
        Function::ShortArtanh => short_odd_series(simd, a, false),
        Function::ShortArctan => short_odd_series(simd, a, true),
    };
    result.lane(0)
}

pub(super) fn levels() -> Vec<Level> {
    InstructionSet::available().into_iter().map(|set| set.detected().expect("available")).collect()
}

fn at(level: Level, function: Function, a: f64, b: f64) -> f64 {
    dispatch!(level, simd => apply(simd, function, a, b))
}

/// Ratios on both sides of every reduction, from tiny to nearly one.
fn ratios() -> impl Iterator<Item = f64> {
    let even = (1..2000).map(|n| f64::from(n) / 2000.0);
    let tiny = (1..40).map(|n| 10_f64.powi(-n) * 0.7);
    even.chain(tiny).chain([0.0])
}

#[test]
fn artanh_has_its_accuracy() {
    for level in levels() {
        for ratio in ratios() {
            for m in [1.0, 0.3, 7e80] {
                let n = ratio * m;
                let exact = (n / m).atanh();
                let allowed = 6e-16 * exact.abs() + 2.3e-16 * ratio / (1.0 - ratio * ratio);
                for sign in [1.0, -1.0] {
                    let found = at(level, Function::Artanh, sign * n, m);
                    assert!((found - sign * exact).abs() <= allowed, "{level:?}: artanh({ratio}) is not {found}");
                }
            }
        }
    }
}

#[test]
fn angle_has_its_accuracy_all_around() {
    for level in levels() {
        for ratio in ratios() {
            for (re, im) in [
                (1.0, ratio),
                (ratio, 1.0),
                (-ratio, 1.0),
                (-1.0, ratio),
                (-1.0, -ratio),
                (-ratio, -1.0),
                (1.0, -ratio),
            ] {
                for length in [1.0, 3e-90] {
                    let exact = f64::atan2(im, re);
                    let found = at(level, Function::Angle, re * length, im * length);
                    assert!((found - exact).abs() <= 1e-15 * exact.abs(), "{level:?}: not {found} but {exact}");
                }
            }
        }
    }
}

#[test]
fn short_series_have_their_accuracy() {
    for level in levels() {
        for (function, exact) in
            [(Function::ShortArtanh, f64::atanh as fn(f64) -> f64), (Function::ShortArctan, f64::atan)]
        {
            let worst = (1..=1000).map(|n| {
                let s = SMALLER_ANGLE.tan() * f64::from(n) / 1000.0;
                (at(level, function, s, 1.0) / exact(s) - 1.0).abs()
            });
            let worst = worst.fold(0.0, f64::max);
            // That of the polynomial and three roundings.
            assert!(worst <= 7.5e-15, "{level:?}: {worst:e}");
        }
    }
}

/// The loop for tiles that share no element is taken only where all of them have five of their own.
#[test]
fn clusters_know_whether_each_tile_has_five_elements_of_its_own() {
    let has_five_own = |j: [[f64; 3]; 3]| {
        let block = |n: usize| Block::new(n, DVec3::X * n as f64, DVec3::ONE, DVec3::from(j[n]), 0.1);
        Cluster::of(&[0, 1, 2].map(block), 0.5).expect("few tiles").has_five_own
    };
    let (general, other, third) = ([0.7, 0.5, 0.3], [0.6, 0.2, 0.4], [0.1, 0.9, 0.8]);
    assert!(has_five_own([general, other, third]));
    assert!(!has_five_own([general, other, other]));
    assert!(!has_five_own([general, other, [0.1, 0.0, 0.0]]));
}

/// Where each order of the series begins, whatever the tile, its error is below what left-out orders and single precision may add up to, and not far below. How many
/// orders are in single precision depends on the shape.
#[test]
fn series_are_right_from_where_they_begin() {
    let shapes = [[1.0; 3], [3.3, 1.7, 1.0], [1.0, 0.05, 0.05], [0.05, 1.0, 0.05], [0.05, 0.05, 1.0], [1.0, 1.0, 0.02]];
    let centre = DVec3::new(0.1, -0.2, 0.3);
    let (mut worst, mut fewest, mut most) = (0.0_f64, usize::MAX, 0);
    for size in shapes {
        let series = Series::of(size, HIGHEST_ORDER);
        for axis in 0..3 {
            let block = Block::new(0, centre, DVec3::from(size), DVec3::AXES[axis], 0.1);
            let tile = Distant::of(&block, 1.0);
            let half_diagonal = 0.5 * DVec3::from(size).length();
            for (order, half_diagonals) in MULTIPOLE_ORDERS {
                let singles = order + 1 - series.first_single_of(order);
                (fewest, most) = (fewest.min(singles), most.max(singles));
                let what = Distributed { tile: &tile, series: &series, order };
                for n in 0..50 {
                    let turn = f64::from(n);
                    let direction = if n < 3 {
                        DVec3::AXES[n as usize]
                    } else {
                        DVec3::new((1.3 * turn).sin(), (2.9 * turn).cos(), (0.7 * turn).sin()).normalize()
                    };
                    let point = centre + direction * (half_diagonals * half_diagonal);
                    let at = Local { coordinates: point.to_array(), roundoff: [0.0; 3] };
                    let placed = block.place(&at).expect("near enough");
                    let exact = cuboid_field(&placed.offsets, block.polarization_t.to_array(), Part::Strength);
                    for level in levels() {
                        let found = dispatch!(level, simd => one(simd, &what, point));
                        let error = (found - DVec3::from(exact)).length();
                        let least = size.iter().product::<f64>()
                            / (4.0 * std::f64::consts::PI * (point - centre).length().powi(3));
                        worst = worst.max(error / least);
                        assert!(
                            error <= (3e-15 + SINGLE_PRECISION_BOUND) * least,
                            "{size:?}, {order}, {direction}, {level:?}: {:e}",
                            error / least
                        );
                    }
                }
            }
        }
    }
    assert!(worst > 1e-15, "{worst:e}");
    assert!((fewest, most) == (0, 2), "{fewest} to {most} orders are in single precision");
}

/// Between the closed form and the series there is no gap, but for needles: the kernel of one point, which takes thirty times as long, serves points beside tiles
/// only.
#[test]
fn tiles_that_are_no_needles_have_a_form_in_vectors_at_every_distance() {
    for (size, has_gap) in [
        ([1.0; 3], false),
        ([3.3, 0.85, 1.0], false),
        ([3.7, 1.0, 1.0], false),
        ([5.0, 5.0, 0.1], false),
        ([6.0, 1.0, 1.0], true),
    ] {
        let range = Range::of_tile(&Block::new(0, DVec3::ZERO, DVec3::from(size), DVec3::Z, 0.1));
        let distances = (0..600).map(|n| 6.0 * 1.01_f64.powi(n));
        let mut forms = distances.map(|distance| range.form_of_box([0.0, distance, 0.0], [0.0, distance, 0.0], false));
        assert_eq!(forms.any(|form| form.is_none()), has_gap, "{size:?}");
    }
}

/// A form is given to a box of points only if each of them by itself has it, or the last digits at a point would depend on the others.
#[test]
fn boxes_have_the_form_that_all_their_points_have() {
    let mut boxes = [0; FORMS];
    for size in [[3.3, 1.7, 1.0], [1.0; 3], [5.0, 5.0, 0.2], [3.3, 0.85, 1.0]] {
        let range = Range::of_tile(&Block::new(0, DVec3::ZERO, DVec3::from(size), DVec3::Z, 0.1));
        for n in 0..5000 {
            let turn = f64::from(n);
            let direction = DVec3::new((1.3 * turn).sin(), (2.9 * turn).cos(), (0.7 * turn).sin()).normalize();
            let centre = direction * 60.0_f64.powf((0.618 * turn).fract());
            let half = DVec3::new((0.31 * turn).fract(), (0.73 * turn).fract(), (0.57 * turn).fract());
            let Some(form) = range.form_of_box((centre - half).to_array(), (centre + half).to_array(), false) else {
                continue;
            };
            boxes[usize::from(form)] += 1;
            // 27 points, and the last of them five times more.
            let step = |at: u32| DVec3::new(f64::from(at % 3), f64::from(at / 3 % 3), f64::from(at / 9));
            let steps = (0..32).map(|at: u32| step(at.min(26)));
            let points: Vec<DVec3> = steps.map(|step| centre + half * (step - 1.0)).collect();
            let axes = [0, 1, 2].map(|axis: usize| points.iter().map(|point| point[axis]).collect::<Vec<f64>>());
            for level in levels() {
                let mut forms = [0.0; 32];
                dispatch!(level, simd => range.forms(simd, axes.each_ref().map(|axis| &axis[..]), false, &mut forms));
                assert!(
                    forms.iter().all(|own| *own == f64::from(form)),
                    "{forms:?}, not {form}, {half} around {centre}"
                );
            }
        }
    }
    assert!(boxes[usize::from(MIDDLE)] > 100 && boxes[usize::from(OUTER)] > 100, "{boxes:?}");
}

/// Where elements count as small they are, and not all far smaller, whatever the tile.
#[test]
fn elements_are_small_where_they_count_as_small() {
    for size in [[1.0; 3], [3.3, 1.7, 1.0], [5.0, 1.0, 1.0], [8.0, 8.0, 1.0], [4.0, 3.0, 0.2]] {
        let largest_half = |point: [f64; 3]| {
            let mut largest = 0.0_f64;
            for axis in 0..3 {
                let block = Block::new(0, DVec3::ZERO, DVec3::from(size), DVec3::AXES[axis], 0.1);
                let placed = block.place(&Local { coordinates: point, roundoff: [0.0; 3] }).expect("near enough");
                let column = cuboid_field(&placed.offsets, DVec3::AXES[axis].to_array(), Part::Strength);
                largest =
                    column.into_iter().fold(largest, |most, value| most.max(2.0 * std::f64::consts::PI * value.abs()));
            }
            largest
        };
        let range = Range::of_tile(&Block::new(0, DVec3::ZERO, DVec3::from(size), DVec3::Z, 0.1));
        let (mut count, mut largest) = (0, 0.0_f64);
        for n in 0..4000 {
            let turn = f64::from(n);
            let direction = DVec3::new((1.3 * turn).sin(), (2.9 * turn).cos(), (0.7 * turn).sin()).normalize();
            let point = (direction * (1.0 + 9.0 * (0.37 * turn).fract())).to_array();
            if range.form_of_box(point, point, false) == Some(OUTER) {
                let half = largest_half(point);
                assert!(half <= SMALL_ANGLE, "{half} at {point:?} of {size:?}");
                count += 1;
                largest = largest.max(half);
            }
        }
        assert!(count > 100 && largest > 0.1 * SMALL_ANGLE, "{count} points, {largest} of {size:?}");
    }
}

#[test]
fn roots_are_right_to_the_last_place() {
    for level in levels() {
        for n in 0..20_000 {
            let square = 1e-6 * 1.0017_f64.powi(n) * (1.0 + 1e-3 * f64::from(n).sin());
            let (exact, found) = (square.sqrt(), at(level, Function::Root, square, 2.0));
            assert!((found - exact).abs() <= f64::EPSILON * exact, "{level:?}: root of {square} is not {found}");
        }
    }
}

#[inline(always)]
pub(super) fn one<S: Simd>(simd: S, what: &impl Pairwise<S>, point: DVec3) -> DVec3 {
    let lanes = point.to_array().map(|c| Lanes::<S>::splat(simd, c));
    DVec3::from(what.fields(simd, [lanes, lanes])[0].map(|component| component.lane(0)))
}

#[inline(always)]
pub(super) fn expanded<S: Simd>(simd: S, expansion: &Expansion, degree: usize, point: DVec3) -> DVec3 {
    let lanes = point.to_array().map(|c| Lanes::<S>::splat(simd, c));
    let [first, second] = expansion.fields_of_pair(simd, degree, [lanes, lanes]);
    for axis in 0..3 {
        assert_eq!(first[axis].lane(0), second[axis].lane(Lanes::<S>::LEN - 1));
    }
    DVec3::new(first[0].lane(0), first[1].lane(0), first[2].lane(0))
}

/// Each degree of the expansion, at the distance from which it is taken, has its share of the promised accuracy; and it does not have it much
/// nearer, or the degrees would be higher than they need be.
#[test]
fn expansions_are_as_accurate_as_their_degrees() {
    let blocks: Vec<Block> = (0..40)
        .map(|n| {
            let turn = n as f64;
            let centre = DVec3::new(3.0 * (1.7 * turn).sin(), 2.0 * (2.9 * turn).cos(), 2.0 * (0.7 * turn).sin());
            let size = if n % 2 == 0 { DVec3::new(1.2, 0.4, 0.9) } else { DVec3::new(0.3, 0.5, 2.0) + 0.01 * turn };
            let j = DVec3::new((0.3 * turn).cos(), (0.5 * turn).sin(), 0.4 * (0.2 * turn).cos());
            Block::new(n, centre + DVec3::new(10.0, -20.0, 5.0), size, j, 0.1)
        })
        .collect();
    let centre = [10.0, -20.0, 5.0];
    let radius = super::expansion::radius(&blocks, centre);
    let error = |level: Level, expansion: &Expansion, degree: usize, distance: f64| {
        let mut worst = 0.0_f64;
        for n in 0..60 {
            let turn = f64::from(n);
            let z = (2.3 * turn).sin();
            let direction = DVec3::new(turn.cos() * (1.0 - z * z).sqrt(), turn.sin() * (1.0 - z * z).sqrt(), z);
            let direction = if n == 0 {
                DVec3::Z
            } else if n == 1 {
                DVec3::X
            } else {
                direction
            };
            let point = DVec3::from(centre) + direction * distance * radius;
            let (mut exact, mut magnitude) = (DVec3::ZERO, 0.0);
            for block in &blocks {
                let at = Local { coordinates: point.to_array(), roundoff: [0.0; 3] };
                let placed = block.place(&at).expect("near enough");
                let own = cuboid_field(&placed.offsets, block.polarization_t.to_array(), Part::Density);
                exact += DVec3::from(own);
                magnitude += DVec3::from(own).length();
            }
            let found = dispatch!(level, simd => expanded(simd, expansion, degree, point));
            worst = worst.max((found - exact).length() / magnitude);
        }
        worst
    };
    for level in levels() {
        let expansion = Expansion::of(level, &blocks, centre, 0.25);
        for (degree, distance) in EXPANSION_DEGREES {
            let own = error(level, &expansion, degree, distance);
            assert!(own <= 5e-15, "{level:?}: degree {degree} is off by {own:e} from {distance} radii on");
        }
    }
    let (level, (degree, distance)) = (Level::new(), EXPANSION_DEGREES[2]);
    let nearer = error(level, &Expansion::of(level, &blocks, centre, 0.25), degree, 0.4 * distance);
    assert!(nearer > 5e-15, "degree {degree} is good for {nearer:e} much nearer than {distance} radii");
}

#[test]
fn moments_of_groups_together_have_the_digits_of_each() {
    let source = |n: usize| {
        let t = n as f64;
        let turn = glam::DMat3::from_rotation_z(if n % 5 == 4 { 0.3 } else { 0.0 });
        let size = DVec3::new(0.1, 0.2, 0.1 + 0.05 * (n % 3) as f64);
        Source::new(DVec3::new(t.sin(), t.cos(), 0.1 * t.sin()), size, Some(&turn), DVec3::new(1.0, t.cos(), 0.3))
    };
    let sources: Vec<Source> = (0..71).map(source).collect();
    let groups = [&sources[..1], &sources[1..40], &sources[40..40], &sources[40..]];
    for set in InstructionSet::available() {
        let level = set.detected().expect("available");
        let together = Moments::of_each(level, &groups, 11);
        assert_eq!(together.len(), groups.len());
        for (group, together) in groups.iter().zip(together) {
            let own = Moments::of(level, group, 11);
            assert_eq!(together.parts(11), own.parts(11), "{} tiles with {set:?}", group.len());
            assert_eq!(together.up_to(7).parts(7), own.parts(7));
        }
    }
}
