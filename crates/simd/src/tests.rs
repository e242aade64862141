//! Vector functions against the standard library, for each instruction set.

use fearless_simd::{Level, Simd, dispatch};

use crate::functions::{angle, artanh_of_ratio, short_odd_series};
use crate::instruction_set::InstructionSet;
use crate::lanes::{Lanes, Number};

/// The largest argument of the short series: tan(0.04).
const LARGEST_SHORT_ANGLE: f64 = 0.04;

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

fn levels() -> Vec<Level> {
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
                let s = LARGEST_SHORT_ANGLE.tan() * f64::from(n) / 1000.0;
                (at(level, function, s, 1.0) / exact(s) - 1.0).abs()
            });
            let worst = worst.fold(0.0, f64::max);
            // The error of the polynomial and three roundings.
            assert!(worst <= 7.5e-15, "{level:?}: {worst:e}");
        }
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
