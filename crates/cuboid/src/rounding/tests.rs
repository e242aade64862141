//! The error analysis behind the stated bounds (docs/accuracy.md): each form in numbers that carry
//! their errors, at the points where the bound of the error is largest.

use std::f64::consts::PI;

use fearless_simd::{Level, Simd, dispatch};
use glam::DVec3;
use magsplice_simd::functions::Functions;

use super::{Rounded, forget_operations};
use crate::block::{Block, LocalPoint};
use crate::closed_form::near_edge::{Interior, NearEdge, NearEdges};
use crate::closed_form::single_tile::ClosedForm;
use crate::closed_form::terms::Form;
use crate::gradient_evaluator::GradientEvaluator;
use crate::method::{Method, MethodRanges};
use crate::scalar::kernel::{FieldKind, cuboid_field, cuboid_gradient};
use crate::series::coefficients::{GradientSeries, Series};
use crate::series::multipole::{Distant, TruncatedGradient, TruncatedSeries};
use crate::shape::Shape;
use crate::tolerances::{EXACT_BOUND, GRADIENT_BOUND};

/// The code that evaluates a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Path {
    Scalar,
    NearCompact,
    NearPositive,
    NearThin,
    ClosedForm,
    Rod,
    SmallElements,
    Series,
}

/// A cuboid with its longest side 1, and a point beside or in it.
#[derive(Clone, Copy, Debug)]
struct Case {
    size: DVec3,
    j: DVec3,
    point: DVec3,
}

/// Coordinates of a case between -1 and 1: two sides, the direction and distance of the point.
type Seed = [f64; 6];

impl Case {
    fn new(seed: Seed, axes: usize) -> Case {
        let [b, c, x, y, z, distance] = seed;
        // Sides from 1e-4 to 1, most of them above 0.1.
        let side = |s: f64| 10_f64.powf(-4.0 * (0.5 + 0.5 * s.abs().min(1.0)).powi(3));
        let sides = [1.0, side(b), side(c)];
        let size = DVec3::from([0, 1, 2].map(|axis: usize| sides[(axis + axes) % 3]));
        let j = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(0.3, -0.5, 0.7)][axes / 3 % 4];
        // Beside the faces by up to 50 longest sides, and inside.
        let gap = 10_f64.powf(-7.0 + 4.35 * (1.0 + distance.clamp(-1.0, 1.0))) - 1e-7;
        let mut point = DVec3::new(x, y, z).clamp(DVec3::NEG_ONE, DVec3::ONE) * (0.5 * size + gap);
        if axes >= 12 {
            point.x = 0.5 * size.x;
        }
        Case { size, j, point }
    }

    fn local(&self) -> LocalPoint {
        LocalPoint { coordinates: self.point.to_array(), roundoff: [0.0; 3] }
    }

    fn block(&self) -> Block {
        Block::new(0, DVec3::ZERO, self.size, self.j, self.size.min_element())
    }
}

/// The path of a case and the bound of its error over the magnitude.
fn field_error<S: Simd>(simd: S, case: &Case) -> Option<(Path, f64)> {
    forget_operations();
    let (block, at) = (case.block(), case.local());
    let placed = block.place(&at)?;
    if placed.on_edge_line() {
        return None;
    }
    let of = |j: DVec3| DVec3::from(cuboid_field(&placed.offsets, j.to_array(), FieldKind::Density));
    let magnitude: f64 = DVec3::AXES.into_iter().map(|axis| of(case.j * axis).length()).sum();
    let ranges = MethodRanges::from_block(&block);
    let form = Shape::new(&block, ranges.scale).form();
    let coordinates = case.point.to_array();
    let method = ranges.method_of_box(coordinates, coordinates, false).map(|index| ranges.method(index));
    let point = coordinates.map(Rounded::<S>::exact);
    let closed_form = ClosedForm::new(&block, ranges.scale, form);
    let (path, field) = match method {
        None => match NearEdges::new(&block, FieldKind::Density).covering(&at) {
            None => {
                let offsets = placed.offsets.each_ref().map(super::rounded_offsets::<S>);
                (Path::Scalar, cuboid_field(&offsets, case.j.to_array(), FieldKind::Density))
            }
            Some(NearEdge::Compact(near)) => (Path::NearCompact, near.field(simd, point)),
            Some(NearEdge::Positive(near)) => (Path::NearPositive, near.field(simd, point)),
            Some(NearEdge::Thin(near)) => (Path::NearThin, near.field(simd, point)),
        },
        Some(Method::SmallElements) => {
            let mut sum = closed_form.field_sum(simd);
            let place = closed_form.place(simd, point);
            closed_form.add_small_elements(simd, &closed_form.ratios(simd, &place), &mut sum);
            (Path::SmallElements, sum.field_t)
        }
        Some(Method::Series { order }) => {
            let (tile, series) = (Distant::new(&block, ranges.scale), Series::new(block.size, order));
            let series = TruncatedSeries { tile: &tile, series: &series, order };
            (Path::Series, series.field(simd, point))
        }
        Some(_) if form == Form::Rod => {
            let mut sum = closed_form.field_sum(simd);
            let place = closed_form.place(simd, point);
            closed_form.add_divided(simd, &closed_form.ratios_of_rod(simd, &place), &mut sum);
            (Path::Rod, sum.field_t)
        }
        Some(_) => {
            let mut sum = closed_form.field_sum(simd);
            let place = closed_form.place(simd, point);
            closed_form.add_elements(simd, &closed_form.ratios(simd, &place), &mut sum);
            (Path::ClosedForm, sum.field_t)
        }
    };
    Some((path, DVec3::from(field.map(Rounded::error)).length() / magnitude))
}

/// [`field_error`] of the gradient.
fn gradient_error<S: Simd>(simd: S, case: &Case) -> Option<(Path, f64)> {
    forget_operations();
    let (block, at) = (case.block(), case.local());
    let placed = block.place(&at)?;
    if placed.on_edge_line() {
        return None;
    }
    let largest = |m: [[f64; 3]; 3]| m.iter().flatten().fold(0.0, |most: f64, value| most.max(value.abs()));
    let of = |j: DVec3| largest(cuboid_gradient(&placed.offsets, j.to_array())) * placed.scale;
    let magnitude: f64 = DVec3::AXES.into_iter().map(|axis| of(case.j * axis)).sum();
    let ranges = MethodRanges::from_block(&block);
    let form = Shape::new(&block, ranges.scale).form();
    let coordinates = case.point.to_array();
    let method = ranges.method_of_box(coordinates, coordinates, false).map(|index| ranges.method(index));
    let point = coordinates.map(Rounded::<S>::exact);
    let (path, components) = match method {
        Some(Method::Series { order }) => {
            let order = (order + 1).min(ranges.highest_order());
            let (tile, series) = (Distant::new(&block, ranges.scale), GradientSeries::new(block.size, order));
            (Path::Series, TruncatedGradient { tile: &tile, series: &series, order }.gradient(simd, point))
        }
        None if !Interior::new(&block).is_off_planes(&at) => return None,
        method => {
            let path = if method.is_none() {
                Path::NearPositive
            } else if form == Form::Rod {
                Path::Rod
            } else {
                Path::ClosedForm
            };
            (path, GradientEvaluator::new(&block, &ranges).gradient(simd, point))
        }
    };
    Some((path, components.into_iter().map(Rounded::error).fold(0.0, f64::max) / magnitude))
}

/// Numbers between 0 and 1 that fill the unit cube evenly.
fn spread(n: u32, dimension: usize) -> f64 {
    // Powers of the root of x^7 = x + 1 (Roberts' sequence).
    const ROOT: f64 = 1.112_775_684_278_706;
    (0.5 + f64::from(n) * ROOT.powi(-1 - dimension as i32)).fract()
}

/// The largest bounds by path, from many cases and climbs from the worst of each path.
fn largest_errors(error: impl Fn(&Case) -> Option<(Path, f64)>) -> Vec<(Path, f64, Case)> {
    const CASES: u32 = 12_000;
    const STARTS: usize = 4;
    const STEPS: u32 = 400;
    let mut found: Vec<(Path, f64, Seed, usize)> = Vec::new();
    for n in 0..CASES {
        let seed = [0, 1, 2, 3, 4, 5].map(|dimension| 2.0 * spread(n, dimension) - 1.0);
        let axes = n as usize % 13 + n as usize % 11;
        if let Some((path, own)) = error(&Case::new(seed, axes)) {
            found.push((path, own, seed, axes));
        }
    }
    found.sort_by(|a, b| a.0.cmp(&b.0).then(b.1.total_cmp(&a.1)));
    let mut worst = Vec::new();
    for of_path in found.chunk_by(|a, b| a.0 == b.0) {
        let mut largest = (of_path[0].0, 0.0, Case::new(of_path[0].2, of_path[0].3));
        for &(path, mut own, mut seed, axes) in of_path.iter().take(STARTS) {
            for step in 0..STEPS {
                let reach = 0.3 * 0.98_f64.powi(step as i32);
                let mut next = seed;
                for (dimension, value) in next.iter_mut().enumerate() {
                    *value += reach * (2.0 * spread(step * 7 + 1, dimension) - 1.0);
                }
                match error(&Case::new(next, axes)) {
                    Some((other, error)) if other == path && error > own => (own, seed) = (error, next),
                    _ => {}
                }
            }
            if own > largest.1 {
                largest = (path, own, Case::new(seed, axes));
            }
        }
        worst.push(largest);
    }
    worst
}

/// `share` of the bound must be reached.
fn check(errors: &[(Path, f64, Case)], bound: f64, share: f64) {
    for (path, error, case) in errors {
        println!("{path:?}: {error:e} at {case:?}");
    }
    for (path, error, case) in errors {
        assert!(*error <= bound, "{path:?}: {error:e} at {case:?}");
    }
    let largest = errors.iter().map(|(_, error, _)| *error).fold(0.0, f64::max);
    assert!(largest > share * bound, "the bound is {} times too large", bound / largest);
}

#[test]
fn rounding_of_the_field_is_within_the_exact_bound() {
    let errors = dispatch!(Level::baseline(), simd => largest_errors(|case| field_error(simd, case)));
    assert_eq!(errors.len(), 8);
    check(&errors, EXACT_BOUND, 0.3);
}

#[test]
fn rounding_of_the_gradient_is_within_its_bound() {
    let errors = dispatch!(Level::baseline(), simd => largest_errors(|case| gradient_error(simd, case)));
    assert_eq!(errors.len(), 4);
    // The bound leaves room for the truncation of expansions.
    check(&errors, GRADIENT_BOUND, 0.2);
}

/// The carried errors bound the rounding of the values.
#[test]
fn carried_errors_bound_the_rounding() {
    dispatch!(Level::baseline(), simd => carried(simd));
}

fn carried<S: Simd>(simd: S) {
    let third = Rounded::<S>::given(1.0 / 3.0);
    let nothing = third + third + third - Rounded::exact(1.0);
    assert!(nothing.value.abs() <= nothing.error() && nothing.error() < 1e-14);
    let angle = Rounded::<S>::angle(simd, Rounded::exact(-1.0), Rounded::exact(1.0)).divided(simd);
    assert!((angle.value - 0.75 * PI).abs() <= angle.error() && angle.error() < 1e-14);
}
