//! Methods of one cuboid against the scalar kernel, for each instruction set.

use fearless_simd::{Level, Simd, dispatch};
use glam::DVec3;
use magsplice_simd::InstructionSet;
use magsplice_simd::lanes::{Lanes, Number, PAIR};
use magsplice_simd::pairwise::Pairwise;
use magsplice_simd::prefetch::Prefetch;

use crate::block::{Block, LocalPoint};
use crate::closed_form::gradient::COMPONENTS;
use crate::closed_form::near_edge::{Interior, NEAR_FORMS, NearEdges};
use crate::evaluator::Evaluator;
use crate::gradient_evaluator::GradientEvaluator;
use crate::method::{CLOSED_FORM, FIRST_FAR, MOST_FAR, Method, MethodRanges, SMALL_ELEMENTS};
use crate::scalar::kernel::{FieldKind, cuboid_field, cuboid_gradient};
use crate::series::coefficients::{GradientSeries, Series};
use crate::series::multipole::{Distant, TruncatedGradient, TruncatedSeries};
use crate::tolerances::{
    EXACT_BOUND, GRADIENT_BOUND, HIGHEST_ORDER, MAGNITUDE_ROUNDING, MULTIPOLE_ORDERS, SMALL_ANGLE,
};

fn levels() -> Vec<Level> {
    InstructionSet::available().into_iter().map(|set| set.detected().expect("available")).collect()
}

#[inline(always)]
fn one<S: Simd>(simd: S, field: &impl Pairwise<S>, point: DVec3) -> DVec3 {
    let lanes = point.to_array().map(|c| Lanes::<S>::splat(simd, c));
    DVec3::from(field.fields(simd, [lanes, lanes])[0].map(|component| component.lane(0)))
}

/// Round-off of the series, as a fraction of a dipole's smallest field. Some 30 operations have
/// half an epsilon each, relative to the dipole's largest field, which is twice the smallest.
const SERIES_ROUNDING: f64 = 3e-15;

/// For every shape, the error of each order of the series, at the distance where it begins, stays
/// below its truncation error of at most 3e-15 plus round-off, and not far below.
#[test]
fn series_keep_the_error_bound_from_their_first_distance() {
    let shapes = [[1.0; 3], [3.3, 1.7, 1.0], [1.0, 0.05, 0.05], [0.05, 1.0, 0.05], [0.05, 0.05, 1.0], [1.0, 1.0, 0.02]];
    let centre = DVec3::new(0.1, -0.2, 0.3);
    let mut worst = 0.0_f64;
    for size in shapes {
        let series = Series::new(size, HIGHEST_ORDER);
        for axis in 0..3 {
            let block = Block::new(0, centre, DVec3::from(size), DVec3::AXES[axis], 0.1);
            let tile = Distant::new(&block, 1.0);
            let half_diagonal = 0.5 * DVec3::from(size).length();
            for (order, half_diagonals) in MULTIPOLE_ORDERS {
                let what = TruncatedSeries { tile: &tile, series: &series, order };
                for n in 0..50 {
                    let turn = f64::from(n);
                    let direction = if n < 3 {
                        DVec3::AXES[n as usize]
                    } else {
                        DVec3::new((1.3 * turn).sin(), (2.9 * turn).cos(), (0.7 * turn).sin()).normalize()
                    };
                    let point = centre + direction * (half_diagonals * half_diagonal);
                    let at = LocalPoint { coordinates: point.to_array(), roundoff: [0.0; 3] };
                    let placed = block.place(&at).expect("near enough");
                    let exact = cuboid_field(&placed.offsets, block.polarization_t.to_array(), FieldKind::Strength);
                    for level in levels() {
                        let found = dispatch!(level, simd => one(simd, &what, point));
                        let error = (found - DVec3::from(exact)).length();
                        let least = size.iter().product::<f64>()
                            / (4.0 * std::f64::consts::PI * (point - centre).length().powi(3));
                        worst = worst.max(error / least);
                        assert!(
                            error <= (3e-15 + SERIES_ROUNDING) * least,
                            "{size:?}, {order}, {direction}, {level:?}: {:e}",
                            error / least
                        );
                    }
                }
            }
        }
    }
    println!("largest error over a dipole's smallest field: {worst:e}");
    assert!(worst > 1e-15, "{worst:e}");
}

/// The scalar kernel, which takes thirty times as long, evaluates only points close to tiles.
#[test]
fn tiles_of_every_shape_have_a_vector_method_at_every_distance() {
    let shapes = [
        [1.0; 3],
        [3.3, 0.85, 1.0],
        [3.7, 1.0, 1.0],
        [3.9, 1.0, 1.0],
        [10.1, 1.0, 0.3],
        [1000.0, 1.0, 1.0],
        [1e6, 1.0, 0.01],
        [5.0, 5.0, 0.1],
        [1.0, 1.0, 0.001],
    ];
    for size in shapes {
        let ranges = MethodRanges::from_block(&Block::new(0, DVec3::ZERO, DVec3::from(size), DVec3::Z, 0.1));
        let second = size[1].max(size[2]);
        let nearest = 0.5 * size[1] + 0.081 * if size[0] > 3.8 * second { second } else { size[0] };
        for distance in (0..2000).map(|n| nearest * 1.01_f64.powi(n)) {
            let point = [0.0, distance, 0.0];
            assert!(ranges.method_of_box(point, point, false).is_some(), "{size:?} at {distance}");
        }
    }
}

/// The closed form of rods keeps the error bound close to the rod and farther away, beside it and
/// beyond its ends, for every cross-section and length.
#[test]
fn closed_form_of_rods_keeps_the_error_bound() {
    let mut worst = 0.0_f64;
    for (length, thickness) in [(3.9, 1.0), (5.0, 0.3), (10.1, 1.0), (30.0, 1e-3), (1e3, 0.5), (1e6, 1.0)] {
        for axis in 0..3 {
            let mut size = DVec3::splat(1.0);
            (size[axis], size[(axis + 1) % 3]) = (length, thickness);
            for j in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(0.3, -0.5, 0.7)] {
                let block = Block::new(0, DVec3::ZERO, size, j, thickness);
                let ranges = MethodRanges::from_block(&block);
                let (distant, series) = (Distant::new(&block, ranges.scale), Series::new(size.to_array(), 0));
                let evaluator = Evaluator::new(&block, &ranges, &distant, &series);
                let points: Vec<DVec3> = (0..256).map(|n| beside(size, n)).collect();
                let axes = [0, 1, 2].map(|axis: usize| points.iter().map(|point| point[axis]).collect::<Vec<f64>>());
                for level in levels() {
                    let mut fields = [0, 1, 2].map(|_| vec![0.0; points.len()]);
                    let [x, y, z] = &mut fields;
                    let axes = axes.each_ref().map(|axis| &axis[..]);
                    dispatch!(level, simd => evaluator.fields(simd, CLOSED_FORM, axes, [x, y, z], &mut Prefetch::nothing()));
                    for (index, point) in points.iter().enumerate() {
                        let at = LocalPoint { coordinates: point.to_array(), roundoff: [0.0; 3] };
                        let placed = block.place(&at).expect("near enough");
                        let of =
                            |j: DVec3| DVec3::from(cuboid_field(&placed.offsets, j.to_array(), FieldKind::Strength));
                        let magnitude: f64 = DVec3::AXES.into_iter().map(|axis| of(j * axis).length()).sum();
                        let found = DVec3::from(fields.each_ref().map(|field| field[index]));
                        let error = (found - of(j)).length() / magnitude;
                        worst = worst.max(error);
                        assert!(error <= EXACT_BOUND, "{size}, {j}, {level:?}: {error:e} at {point}");
                    }
                }
            }
        }
    }
    println!("largest error over the field: {worst:e}");
    assert!(worst > 1e-15, "{worst:e}");
}

/// The magnitude that the closed form computes with the field bounds the sum of the fields of the
/// single components of J. For one component it equals the sum.
#[test]
fn magnitude_from_the_elements_bounds_the_sum_over_components() {
    let mut excesses = Vec::new();
    for size in [[1.0; 3], [3.3, 1.7, 1.0], [1.0, 0.2, 2.0], [2.0, 0.05, 1.5], [0.5, 10.0, 0.4]] {
        let size = DVec3::from(size);
        let directions = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(0.3, 0.0, -0.7), DVec3::new(0.3, -0.5, 0.7)];
        for j in directions {
            let block = Block::new(0, DVec3::ZERO, size, j, size.min_element());
            let ranges = MethodRanges::from_block(&block);
            let (distant, series) = (Distant::new(&block, ranges.scale), Series::new(size.to_array(), 0));
            let evaluator = Evaluator::new(&block, &ranges, &distant, &series);
            for n in 0..400_u32 {
                let turn = f64::from(n);
                let place = DVec3::new((0.754 * turn).fract(), (0.569 * turn).fract(), (0.311 * turn).fract()) - 0.5;
                let point = place * (size + 8.0 * (0.618 * turn).fract() * size.max_element());
                let Some(method) = ranges.method_of_box(point.to_array(), point.to_array(), false) else { continue };
                if method >= FIRST_FAR {
                    continue;
                }
                let at = LocalPoint { coordinates: point.to_array(), roundoff: [0.0; 3] };
                let placed = block.place(&at).expect("near enough");
                let of = |j: DVec3| DVec3::from(cuboid_field(&placed.offsets, j.to_array(), FieldKind::Strength));
                let magnitude: f64 = DVec3::AXES.into_iter().map(|axis| of(j * axis).length()).sum();
                for level in levels() {
                    let axes = point.to_array().map(|coordinate| [coordinate; PAIR]);
                    let axes = axes.each_ref().map(|axis| &axis[..]);
                    let (mut field, mut alone, mut bounds) = ([[0.0; PAIR]; 3], [[0.0; PAIR]; 3], [0.0; PAIR]);
                    dispatch!(level, simd => {
                        let nothing = &mut Prefetch::nothing();
                        let written = alone.each_mut().map(|values| &mut values[..]);
                        evaluator.fields(simd, method, axes, written, nothing);
                        let written = field.each_mut().map(|values| &mut values[..]);
                        evaluator.fields_and_magnitudes(simd, method, axes, written, &mut bounds, nothing);
                    });
                    assert_eq!(field, alone);
                    let excess = bounds[PAIR - 1] / magnitude;
                    assert!(excess >= 1.0, "{size}, {j}, {level:?}: {excess} at {point}");
                    let is_equal = excess <= 1.0 + 2.0 * MAGNITUDE_ROUNDING;
                    assert!(is_equal || j.element_sum() != 1.0, "{size}, {j}, {level:?}: {excess} at {point}");
                    excesses.push(excess);
                }
            }
        }
    }
    excesses.sort_by(f64::total_cmp);
    let (count, last) = (excesses.len(), excesses[excesses.len() - 1]);
    println!("{count} bounds, at most {last} times the sum");
    assert!(count > 5000 && last < 2.0, "{count} bounds, at most {last} times the sum");
}

/// Points outside cuboids, closer than the start of the closed form, have a method in vectors that
/// keeps the error bound, also where a face fills more than half of the view.
#[test]
fn points_close_to_cuboids_keep_the_error_bound() {
    let mut count = 0;
    let mut worst = 0.0_f64;
    let compact = [[0.9, 0.8], [0.6, 0.3], [0.2, 0.15]];
    let thin = [[1.0, 0.09], [0.5, 0.03], [0.9, 1e-3], [0.1, 1e-3], [1e-2, 1e-3], [1e-3, 1e-6], [1.0, 1e-11]];
    for [width, thickness] in compact.into_iter().chain(thin) {
        for axis in 0..3 {
            let mut size = DVec3::ONE;
            (size[axis], size[(axis + 1) % 3]) = (thickness, width);
            for j in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(0.3, -0.5, 0.7)] {
                let block = Block::new(0, DVec3::ZERO, size, j, thickness);
                let near = NearEdges::new(&block, FieldKind::Density);
                for n in 0..300_u32 {
                    let turn = f64::from(n);
                    let distance = 0.081 * thickness * (1.0 / thickness).powf((0.618 * turn).fract());
                    let place =
                        DVec3::new((0.754 * turn).fract(), (0.569 * turn).fract(), (0.311 * turn).fract()) - 0.5;
                    // Above faces, around the tile, and around its corners.
                    let mut point = match n % 3 {
                        0 => place * size,
                        1 => place * (size + 2.0 * distance),
                        _ => 0.5 * size + place * distance,
                    };
                    let face = n as usize / 3 % 3;
                    point[face] = (0.5 * size[face] + distance).copysign(place[face]);
                    let at = LocalPoint { coordinates: point.to_array(), roundoff: [0.0; 3] };
                    let Some(form) = near.form(&at) else { continue };
                    count += 1;
                    let placed = block.place(&at).expect("near enough");
                    let of = |j: DVec3| DVec3::from(cuboid_field(&placed.offsets, j.to_array(), FieldKind::Density));
                    let magnitude: f64 = DVec3::AXES.into_iter().map(|axis| of(j * axis).length()).sum();
                    for level in levels() {
                        let mut field = [[0.0; PAIR]; 3];
                        let axes = point.to_array().map(|coordinate| [coordinate; PAIR]);
                        let axes = axes.each_ref().map(|axis| &axis[..]);
                        let written = field.each_mut().map(|values| &mut values[..]);
                        dispatch!(level, simd => near.fields(simd, form, axes, written));
                        let error = (DVec3::from(field.map(|values| values[0])) - of(j)).length() / magnitude;
                        worst = worst.max(error);
                        assert!(error <= EXACT_BOUND, "{size}, {j}, {level:?}: {error:e} at {point}");
                    }
                }
            }
        }
    }
    println!("largest error over the field: {worst:e}, {count} points");
    assert!(count > 10_000 && worst > 1e-15, "{count} points, {worst:e}");
}

/// A vector of points has the forms of its points: on both sides of the ends of each form, and with
/// errors of coordinates up to the distances from the faces.
#[test]
fn vectors_of_points_have_the_form_of_each_point() {
    let mut counts = [0; NEAR_FORMS + 1];
    for size in [[1.0, 0.9, 0.8], [1.0, 0.3, 1e-3], [3.0, 0.1, 0.1], [1.0, 1.0, 1e-13]] {
        let size = DVec3::from(size);
        let block = Block::new(0, DVec3::new(0.3, 0.1, 0.2), size, DVec3::ONE, size.min_element());
        let near = NearEdges::new(&block, FieldKind::Density);
        let points = (0..2000_u32).map(|n| {
            let turn = f64::from(n);
            let place = DVec3::new((0.754 * turn).fract(), (0.569 * turn).fract(), (0.311 * turn).fract()) - 0.5;
            let spread = 10_f64.powf(-14.0 * (0.618 * turn).fract());
            let mut point = DVec3::new(0.3, 0.1, 0.2) + place * size;
            let axis = n as usize % 3;
            point[axis] = block.faces[axis][1].hi + if n.is_multiple_of(4) { -spread } else { spread };
            let roundoff = if n.is_multiple_of(5) { 0.0 } else { spread * (0.9 + 0.2 * (0.43 * turn).fract()) };
            LocalPoint { coordinates: point.to_array(), roundoff: [roundoff; 3] }
        });
        let points: Vec<LocalPoint> = points.collect();
        let axes = [0, 1, 2].map(|axis| points.iter().map(|p| p.coordinates[axis]).collect::<Vec<f64>>());
        let roundoff = [0, 1, 2].map(|axis| points.iter().map(|p| p.roundoff[axis]).collect::<Vec<f64>>());
        for level in levels() {
            let mut forms = vec![0.0; points.len()];
            let (axes, roundoff) = (axes.each_ref().map(|a| &a[..]), roundoff.each_ref().map(|a| &a[..]));
            dispatch!(level, simd => near.forms(simd, axes, roundoff, &mut forms));
            for (point, form) in points.iter().zip(forms) {
                let expected = near.form(point).unwrap_or(NEAR_FORMS);
                assert_eq!(form, expected as f64, "{size}, {level:?}, {:?}", point.coordinates);
                counts[expected] += 1;
            }
        }
    }
    assert!(counts.iter().all(|count| *count > 300), "{counts:?}");
}

/// The gradient in vectors keeps the error bound where it is used: inside and close to cuboids,
/// beside them, and by each order of the series.
#[test]
fn gradient_in_vectors_keeps_the_error_bound() {
    let mut counts = [0; 3];
    let mut worst = 0.0_f64;
    for size in [[1.0; 3], [1.0, 3.3, 1.0], [0.4, 0.3, 1.0], [2.0, 2.0, 1e-3], [1.0, 0.2, 8.0], [700.0, 1.0, 0.5]] {
        for j in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(0.3, -0.5, 0.7)] {
            let size = DVec3::from(size);
            let block = Block::new(0, DVec3::ZERO, size, j, size.min_element());
            let ranges = MethodRanges::from_block(&block);
            let series = GradientSeries::new(size.to_array(), ranges.highest_order());
            let distant = Distant::new(&block, ranges.scale);
            let evaluator = GradientEvaluator::new(&block, &ranges);
            for n in 0..600_u32 {
                let turn = f64::from(n);
                let place = DVec3::new((0.754 * turn).fract(), (0.569 * turn).fract(), (0.311 * turn).fract()) - 0.5;
                let spread = if n.is_multiple_of(3) { 0.0 } else { 60.0_f64.powf((0.618 * turn).fract()) - 0.9 };
                let point = place * (size + spread * size.max_element());
                let at = LocalPoint { coordinates: point.to_array(), roundoff: [0.0; 3] };
                let index = ranges.method_of_box(point.to_array(), point.to_array(), false);
                let method = index.map(|index| ranges.method(index));
                let is_far = matches!(method, Some(Method::Series { .. }));
                if method.is_none() && !Interior::new(&block).is_off_planes(&at) {
                    continue;
                }
                counts[if is_far { 2 } else { usize::from(method.is_some()) }] += 1;
                let placed = block.place(&at).expect("near enough");
                let of =
                    |j: DVec3| cuboid_gradient(&placed.offsets, j.to_array()).map(|row| row.map(|s| s * placed.scale));
                let exact = of(j);
                let largest = |m: [[f64; 3]; 3]| m.iter().flatten().fold(0.0, |most: f64, value| most.max(value.abs()));
                let magnitude: f64 = DVec3::AXES.into_iter().map(|axis| largest(of(j * axis))).sum();
                for level in levels() {
                    let mut components = [[0.0; PAIR]; COMPONENTS];
                    let axes = point.to_array().map(|coordinate| [coordinate; PAIR]);
                    let axes = axes.each_ref().map(|axis| &axis[..]);
                    let written = components.each_mut().map(|values| &mut values[..]);
                    if let Some(Method::Series { order }) = method {
                        let order = (order + 1).min(ranges.highest_order());
                        let series = TruncatedGradient { tile: &distant, series: &series, order };
                        dispatch!(level, simd => series.gradients(simd, axes, written));
                    } else {
                        dispatch!(level, simd => evaluator.gradients(simd, axes, written));
                    }
                    let places = [[0, 0], [1, 1], [2, 2], [1, 2], [0, 2], [0, 1]];
                    for ([row, column], values) in places.into_iter().zip(components) {
                        let error = (values[0] - exact[row][column]).abs() / magnitude;
                        worst = worst.max(error);
                        assert!(error <= GRADIENT_BOUND, "{size}, {j}, {level:?}, {method:?}: {error:e} at {point}");
                    }
                }
            }
        }
    }
    println!("largest error over the gradient: {worst:e}");
    assert!(counts.iter().all(|count| *count > 300) && worst > 1e-15, "{counts:?}, {worst:e}");
}

/// A point off the surface of a rod by 0.09 of the second side, which is 1, up to the longest side.
fn beside(size: DVec3, n: u32) -> DVec3 {
    let turn = f64::from(n);
    let distance = 0.09 * (size.max_element() / 0.09).powf((0.618 * turn).fract());
    let place = DVec3::new((0.754 * turn).fract(), (0.569 * turn).fract(), (0.311 * turn).fract()) - 0.5;
    let reach = if n.is_multiple_of(2) { size } else { size + 2.0 * distance };
    let mut point = reach * place;
    let face = n as usize / 2 % 3;
    point[face] = (0.5 * size[face] + distance).copysign(point[face]);
    point
}

/// A box of points has a method only if each of its points has that method. Otherwise the last
/// digits at a point would depend on the other points.
#[test]
fn box_has_the_method_of_each_of_its_points() {
    let mut boxes = [0; FIRST_FAR as usize + MOST_FAR];
    for size in [[3.3, 1.7, 1.0], [1.0; 3], [5.0, 5.0, 0.2], [3.3, 0.85, 1.0]] {
        let ranges = MethodRanges::from_block(&Block::new(0, DVec3::ZERO, DVec3::from(size), DVec3::Z, 0.1));
        for n in 0..5000 {
            let turn = f64::from(n);
            let direction = DVec3::new((1.3 * turn).sin(), (2.9 * turn).cos(), (0.7 * turn).sin()).normalize();
            let centre = direction * 60.0_f64.powf((0.618 * turn).fract());
            let half = DVec3::new((0.31 * turn).fract(), (0.73 * turn).fract(), (0.57 * turn).fract());
            let Some(method) = ranges.method_of_box((centre - half).to_array(), (centre + half).to_array(), false)
            else {
                continue;
            };
            boxes[usize::from(method)] += 1;
            // 27 points, and the last of them five times more.
            let step = |at: u32| DVec3::new(f64::from(at % 3), f64::from(at / 3 % 3), f64::from(at / 9));
            let steps = (0..32).map(|at: u32| step(at.min(26)));
            let points: Vec<DVec3> = steps.map(|step| centre + half * (step - 1.0)).collect();
            let axes = [0, 1, 2].map(|axis: usize| points.iter().map(|point| point[axis]).collect::<Vec<f64>>());
            for level in levels() {
                let mut methods = [0.0; 32];
                dispatch!(level, simd => ranges.methods(simd, axes.each_ref().map(|axis| &axis[..]), false, &mut methods));
                assert!(
                    methods.iter().all(|own| *own == f64::from(method)),
                    "{methods:?}, not {method}, {half} around {centre}"
                );
            }
        }
    }
    assert!(boxes[usize::from(CLOSED_FORM)] > 100 && boxes[usize::from(SMALL_ELEMENTS)] > 100, "{boxes:?}");
}

/// For every tile, elements that count as small are small, and some of them are close to the limit.
#[test]
fn small_elements_method_is_used_only_where_elements_are_small() {
    for size in [[1.0; 3], [3.3, 1.7, 1.0], [3.7, 1.0, 1.0], [8.0, 8.0, 1.0], [4.0, 3.0, 0.2]] {
        let largest_half = |point: [f64; 3]| {
            let mut largest = 0.0_f64;
            for axis in 0..3 {
                let block = Block::new(0, DVec3::ZERO, DVec3::from(size), DVec3::AXES[axis], 0.1);
                let placed = block.place(&LocalPoint { coordinates: point, roundoff: [0.0; 3] }).expect("near enough");
                let column = cuboid_field(&placed.offsets, DVec3::AXES[axis].to_array(), FieldKind::Strength);
                largest =
                    column.into_iter().fold(largest, |most, value| most.max(2.0 * std::f64::consts::PI * value.abs()));
            }
            largest
        };
        let ranges = MethodRanges::from_block(&Block::new(0, DVec3::ZERO, DVec3::from(size), DVec3::Z, 0.1));
        let (mut count, mut largest) = (0, 0.0_f64);
        for n in 0..4000 {
            let turn = f64::from(n);
            let direction = DVec3::new((1.3 * turn).sin(), (2.9 * turn).cos(), (0.7 * turn).sin()).normalize();
            let point = (direction * (1.0 + 9.0 * (0.37 * turn).fract())).to_array();
            if ranges.method_of_box(point, point, false) == Some(SMALL_ELEMENTS) {
                let half = largest_half(point);
                assert!(half <= SMALL_ANGLE, "{half} at {point:?} of {size:?}");
                count += 1;
                largest = largest.max(half);
            }
        }
        assert!(count > 100 && largest > 0.1 * SMALL_ANGLE, "{count} points, {largest} of {size:?}");
    }
}
