//! Truncation errors of a tree against exact fields, for each instruction set.

use fearless_simd::{Level, Simd, dispatch};
use glam::{DQuat, DVec3};
use magsplice_cuboid::scalar::kernel::FieldKind;
use magsplice_cuboid::tolerances::EXACT_BOUND;
use magsplice_expansion::local::LocalExpansion;
use magsplice_expansion::moments::Parity;
use magsplice_expansion::multipole::MultipoleExpansion;
use magsplice_magnet::{BoundingBox, Quantity, Tile};
use magsplice_simd::InstructionSet;
use magsplice_simd::lanes::{Lanes, Number};
use magsplice_simd::pairwise::Pairwise;

use super::interaction::{DirectItem, ExpandedNode, TranslatedNode};
use super::interaction_list::InteractionList;
use super::nodes::Tree;
use super::sum::{local_expansion, sum_list};
use crate::scene::Scene;
use magsplice_direct::direct_sum::DirectSum;
use magsplice_direct::far_field::DegreesByPoints;
use magsplice_direct::sum::Sum;

fn levels() -> Vec<Level> {
    InstructionSet::available().into_iter().map(|set| set.detected().expect("available")).collect()
}

#[inline(always)]
fn expanded<S: Simd>(simd: S, expansion: &MultipoleExpansion, degree: usize, point: DVec3) -> DVec3 {
    let lanes = point.to_array().map(|c| Lanes::<S>::splat(simd, c));
    DVec3::from(expansion.fields_of_pair(simd, degree, [lanes, lanes])[0].map(|component| component.lane(0)))
}

#[inline(always)]
fn one<S: Simd>(simd: S, field: &impl Pairwise<S>, point: DVec3) -> DVec3 {
    let lanes = point.to_array().map(|c| Lanes::<S>::splat(simd, c));
    DVec3::from(field.fields(simd, [lanes, lanes])[0].map(|component| component.lane(0)))
}

/// Two small tiles whose dipoles point outwards have nearly the largest possible truncation error.
#[test]
fn truncation_error_of_a_node_is_within_its_bound_and_close_to_it() {
    let level = Level::new();
    let turn = glam::DQuat::from_rotation_arc(DVec3::X, DVec3::new(0.4, -0.5, 0.8).normalize());
    let outwards = [-1.0, 1.0].map(|sign: f64| {
        let tile = Tile::new(turn * DVec3::X * sign, DVec3::splat(0.02), DVec3::X * sign).expect("a valid tile");
        tile.rotated(turn).expect("a rotation")
    });
    let tree = Tree::new(&DirectSum::new(&outwards, level), 15);
    let scene = Scene::new(&outwards);
    let mut seen = [false; 16];
    for distance in [1.3, 1.6, 2.0, 3.0, 8.0, 40.0] {
        let point = turn * DVec3::X * distance;
        let exact = scene.field(Quantity::FluxDensity, point).expect("outside");
        for exponent in 0..60 {
            let allowed_t = 0.1 * 0.5_f64.powi(exponent);
            let at = BoundingBox { lower: point, upper: point };
            let Some(nearest) = tree.expanded_node(0, &at, allowed_t) else { continue };
            let ExpandedNode { degree, truncation_error_t: bound_t, .. } = nearest;
            assert!(bound_t <= allowed_t);
            let field = |degree: usize, point: DVec3| match degree {
                0 => DVec3::ZERO,
                _ => dispatch!(level, simd => expanded(simd, tree.multipole_expansion(0), degree, point)),
            };
            let found = field(degree, point);
            let error_t = (found - exact).length();
            let rounding = 1e-13 * exact.length();
            assert!(error_t <= bound_t + rounding, "degree {degree} at {distance}: {error_t:e} of {bound_t:e}");
            assert!(error_t + rounding >= 0.3 * bound_t, "degree {degree} at {distance}: {error_t:e} of {bound_t:e}");
            seen[degree] = true;
            // Degrees at points farther away.
            let mut last = degree;
            for times in [1.0, 1.02, 1.1, 1.3, 2.0, 7.0, 1e4, 1e60] {
                let farther = point * times;
                let mut degrees = DegreesByPoints::default();
                let [x, y, z] = farther.to_array().map(|coordinate| [coordinate; 16]);
                tree.set_degrees(&nearest, [&x, &y, &z], &mut degrees);
                let (&[own], &[bound_t]) = (&degrees.degree[..], &degrees.truncation_error_t[..]) else {
                    panic!("one degree for 16 points: {degrees:?}")
                };
                assert!(own <= last, "{own} after {last}, {times} times as far as {distance}");
                let exact = scene.field(Quantity::FluxDensity, farther).expect("outside");
                let error_t = (field(own, farther) - exact).length();
                assert!(error_t <= bound_t + 1e-13 * exact.length(), "degree {own}: {error_t:e} of {bound_t:e}");
                last = own;
            }
            assert_eq!(last, 0, "the whole field is within the allowed error there");
        }
    }
    // Parts of odd degree vanish by symmetry, so the lowest sufficient degree is even.
    assert_eq!(seen.iter().filter(|seen| **seen).count(), 8, "{seen:?}");
}

/// Tiles in a plane, each with its own polarization, and a tree over them.
fn sheet() -> (DirectSum, Tree) {
    sheet_of(|x, y| DVec3::new((0.6 * x + 0.1 * y).sin(), (0.6 * y + 0.1 * x).sin(), 0.2 + 0.1 * (x * y).sin()))
}

/// 40 x 40 cubes of one unit with this polarization at x and y.
fn sheet_of(polarization_t: impl Fn(f64, f64) -> DVec3) -> (DirectSum, Tree) {
    let tiles: Vec<Tile> = (0..1600)
        .map(|n| {
            let (x, y) = (f64::from(n % 40) - 19.5, f64::from(n / 40) - 19.5);
            Tile::new(DVec3::new(x, y, 0.5), DVec3::ONE, polarization_t(x, y)).expect("a valid tile")
        })
        .collect();
    let direct = DirectSum::new(&tiles, Level::new());
    let tree = Tree::new(&direct, 30);
    (direct, tree)
}

/// A translated node whose only truncation error comes from the local expansion.
fn translation(node: usize, degree: usize, (local_degree, local_truncation_error_t): (usize, f64)) -> TranslatedNode {
    let distance = 1.0;
    TranslatedNode { node, distance, degree, truncation_error_t: 0.0, local_degree, local_truncation_error_t }
}

/// The local expansion of nodes around `centre`.
fn translated(level: Level, tree: &Tree, nodes: &[TranslatedNode], centre: DVec3, radius: f64) -> LocalExpansion {
    let list = InteractionList { translated: nodes.to_vec(), centre, radius, ..InteractionList::default() };
    local_expansion(level, tree, &list).expect("nodes")
}

/// A node's multipole expansion and its local expansion differ by at most the bound of the
/// truncation error, and somewhere by a tenth of it.
#[test]
fn truncation_error_of_a_translation_is_within_its_bound() {
    let (_, tree) = sheet();
    let (middle, radius) = (DVec3::new(31.0, 12.0, -4.0), 5.0);
    let directions = (0..40).map(|n| {
        let turn = f64::from(n);
        DVec3::new((1.3 * turn).sin(), (2.1 * turn).cos(), (0.7 * turn).cos()).normalize()
    });
    let points: Vec<DVec3> = directions.map(|direction| middle + radius * direction).collect();
    let mut translations = 0;
    let mut closest = 0.0_f64;
    for node in 0..tree.nodes.len() {
        for exponent in [2, 4, 6, 8, 10] {
            let Some((local_degree, bound_t)) = tree.local_degree(node, 18, middle, radius, 10_f64.powi(-exponent))
            else {
                continue;
            };
            translations += 1;
            let input = translation(node, 18, (local_degree, bound_t));
            let toward = middle + radius * (tree.nodes[node].centre - middle).normalize();
            let points = || points.iter().copied().chain([toward]);
            for level in levels() {
                let errors: Vec<f64> = dispatch!(level, simd => {
                    let local = translated(level, &tree, &[input], middle, radius);
                    let own = |at| expanded(simd, tree.multipole_expansion(node), 18, at);
                    points().map(|at| (one(simd, &local, at) - own(at)).length()).collect()
                });
                let error_t = errors.into_iter().fold(0.0, f64::max);
                assert!(error_t <= bound_t + 1e-14, "{error_t:e}, not {bound_t:e}, with {local_degree}");
                closest = closest.max(error_t / bound_t);
            }
        }
    }
    assert!(translations > 100 && closest > 0.1, "{translations} translations, {closest}");
}

/// The local expansion of many nodes is the sum of the local expansions of each, for any degrees.
#[test]
fn local_expansion_of_many_nodes_is_the_sum_of_each() {
    let (_, tree) = sheet();
    let (middle, radius) = (DVec3::new(36.0, -3.0, -4.0), 2.0);
    let degree = |node: usize| tree.local_degree(node, 6 + node % 9, middle, radius, 1e-9);
    let all = (0..tree.nodes.len()).filter_map(|node| Some(translation(node, 6 + node % 9, degree(node)?)));
    let all: Vec<TranslatedNode> = all.collect();
    assert!(all.len() > 20);
    let highest = all.iter().map(|of| of.local_degree).max();
    for level in levels() {
        for at in [middle, middle + 1.1, middle + DVec3::new(-1.0, 1.5, 0.5)] {
            let [all_at_once, sum] = dispatch!(level, simd => {
                let all_at_once = one(simd, &translated(level, &tree, &all, middle, radius), at);
                let each = all.iter().map(|of| {
                    let of = TranslatedNode { local_degree: highest.expect("nodes"), ..*of };
                    one(simd, &translated(level, &tree, &[of], middle, radius), at)
                });
                [all_at_once, each.sum()]
            });
            // A node translated together with others may have a higher degree than alone.
            let error_t = (all_at_once - sum).length();
            assert!(error_t <= 1e-9 * all.len() as f64, "{all_at_once} is not {sum}");
        }
    }
}

/// At points near all tiles the tree gives the exact field up to rounding, whether tiles share all
/// elements, some or none.
#[test]
fn near_tiles_have_the_exact_field_within_a_tolerance() {
    let points: Vec<DVec3> = (0..64)
        .map(|n| {
            let turn = f64::from(n);
            DVec3::new(3.0 * (1.3 * turn).sin(), 3.0 * (2.1 * turn).cos(), -2.6 - 2.5 * (0.7 * turn).cos())
        })
        .collect();
    // Each sum over tiles is about one.
    let some_alike = |x: f64, y: f64| DVec3::new((0.6 * x).sin(), 0.3, if y > 0.0 { (y * y + x).sin() } else { 0.0 });
    let all_alike = |x: f64, y: f64| DVec3::new(if x * y > 0.0 { 0.7 } else { -0.7 }, 0.7, 0.0);
    for (direct, tree) in [sheet(), sheet_of(some_alike), sheet_of(all_alike)] {
        let list = InteractionList::new(&tree, &BoundingBox::from_points(&points), points.len(), 0.0);
        assert_eq!(list.tiles.expanded + list.tiles.ignored, 0);
        for level in levels() {
            let direct = direct.clone().with_level(level);
            let mut exact = vec![DVec3::ZERO; points.len()];
            Sum::with_buffers(|sum| {
                sum.sum_all(level, direct.frames(), FieldKind::Density, &points, &mut exact, None);
            });
            let (near, truncation_error_t) = summed(&direct, &tree, &list, &points);
            for (exact, near) in exact.into_iter().zip(near) {
                assert!((exact - near).length() <= 2e-14, "{near} is not {exact}");
            }
            assert!(truncation_error_t.iter().all(|error_t| *error_t == 0.0));
        }
    }
}

/// B at points, and the bound of the truncation error there.
fn summed(direct: &DirectSum, tree: &Tree, list: &InteractionList, points: &[DVec3]) -> (Vec<DVec3>, Vec<f64>) {
    let mut field = vec![DVec3::ZERO; points.len()];
    let truncation_error_t = Sum::with_buffers(|sum| {
        sum_list(sum, direct, tree, list, FieldKind::Density, points, &mut field);
        sum.points_and_truncation_error_t().1[..points.len()].to_vec()
    });
    (field, truncation_error_t)
}

/// Ignored nodes, expansions at all points or beyond a sphere, and translated nodes, each compared
/// with the exact field of the same tiles. Some of the points are in a row far away from the
/// others.
#[test]
fn truncation_error_at_each_point_is_within_its_bound() {
    let (direct, tree) = sheet();
    // The rounding of both fields; the sum over tiles is about one.
    let rounding_t = 2.0 * EXACT_BOUND;
    let mut closest = [0.0_f64; 4];
    for (middle, spread) in [(DVec3::new(3.0, -8.0, -2.0), 3.0), (DVec3::new(24.0, 21.0, -3.0), 6.0)] {
        let point = |n: usize| {
            let turn = n as f64;
            let near = DVec3::new((1.3 * turn).sin(), (2.1 * turn).cos(), 0.3 * (0.7 * turn).cos());
            middle + if n < 80 { spread * near } else { DVec3::new(0.1, 0.2, -0.4) * (turn - 79.0) }
        };
        let mut points: Vec<DVec3> = (0..101).map(point).collect();
        points[57] = DVec3::splat(f64::NAN);
        let usable: Vec<DVec3> = points.iter().copied().filter(|point| !point.is_nan()).collect();
        let around = BoundingBox::from_points(&usable);
        for exponent in 1..12 {
            let allowed_t = 10_f64.powi(-exponent);
            let whole = InteractionList::new(&tree, &around, points.len(), allowed_t);
            let none = || InteractionList { centre: whole.centre, radius: whole.radius, ..InteractionList::default() };
            let beyond: Vec<DirectItem> = whole.direct.iter().copied().filter(|item| item.beyond.is_some()).collect();
            let expanded = InteractionList { expanded: whole.expanded.clone(), ..none() };
            let translated = InteractionList { translated: whole.translated.clone(), ..none() };
            let items_of_nodes = |nodes: Vec<usize>| -> Vec<usize> {
                nodes.into_iter().flat_map(|node| tree.nodes[node].items.clone()).collect()
            };
            let mut kinds = [
                (expanded, items_of_nodes(whole.expanded.iter().map(|of| of.node).collect())),
                (translated, items_of_nodes(whole.translated.iter().map(|of| of.node).collect())),
                (InteractionList { direct: beyond.clone(), ..none() }, beyond.iter().map(|of| of.item).collect()),
                (InteractionList { ignored_t: whole.ignored_t, ..none() }, Vec::new()),
            ];
            let is_summed = |item: &usize| {
                whole.direct.iter().any(|direct| direct.item == *item)
                    || kinds[..3].iter().any(|(_, items)| items.contains(item))
            };
            kinds[3].1 = (0..tree.items.len()).filter(|item| !is_summed(item)).collect();
            for (kind, (list, mut items)) in kinds.into_iter().enumerate() {
                items.sort_unstable();
                let items = items.into_iter().map(|item| DirectItem { item, beyond: None }).collect();
                let exactly = InteractionList { direct: items, ..none() };
                for level in levels() {
                    let direct = direct.clone().with_level(level);
                    let exact = summed(&direct, &tree, &exactly, &points).0;
                    let (field, truncation_error_t) = summed(&direct, &tree, &list, &points);
                    for (index, point) in points.iter().enumerate().filter(|(_, point)| !point.is_nan()) {
                        let (error_t, bound_t) = ((field[index] - exact[index]).length(), truncation_error_t[index]);
                        assert!(
                            error_t <= bound_t + rounding_t,
                            "{error_t:e}, not {bound_t:e}, at {point}, kind {kind}"
                        );
                        closest[kind] = closest[kind].max((error_t - rounding_t) / bound_t);
                    }
                }
            }
        }
    }
    assert!(closest.iter().all(|closest| *closest > 0.1), "largest errors over their bounds: {closest:?}");
}

#[test]
fn interaction_list_has_every_tile_once() {
    let tiles: Vec<Tile> = (0..300)
        .map(|n| {
            let turn = f64::from(n);
            let at = DVec3::new((1.3 * turn).sin(), (2.1 * turn).sin(), (0.7 * turn).cos()) * 10.0;
            Tile::new(at, DVec3::new(0.5, 1.0, 0.3), DVec3::new(0.1, turn.cos(), 0.2)).expect("a valid tile")
        })
        .collect();
    let tree = Tree::new(&DirectSum::new(&tiles, Level::new()), 20);
    let points = BoundingBox { lower: DVec3::new(-1.0, 2.0, 3.0), upper: DVec3::new(0.5, 4.0, 5.0) };
    let mut last = 0;
    for exponent in 0..12 {
        for count in [1, 100] {
            let list = InteractionList::new(&tree, &points, count, 10_f64.powi(-exponent));
            let counts = list.tiles;
            assert_eq!(counts.expanded + counts.direct + counts.ignored, tiles.len());
            assert!(counts.direct >= last, "more tiles are near for a smaller truncation error");
            last = counts.direct;
        }
    }
    assert!(last > 10 && last < 290, "{last} tiles are near");
}

/// Tiles of one thickness between the same planes, half of them turned in these planes, with
/// components of J in the planes and normal to them.
fn flat_film(in_plane: f64, across: f64) -> Tree {
    let tile = |n: usize| {
        let (x, y, n) = ((n % 12) as f64, (n / 12) as f64, n as f64);
        let j = DVec3::new(in_plane * (0.6 * x).sin(), in_plane * (0.7 * y).cos(), across * (0.3 * n).cos());
        let size = DVec3::new(0.9, 0.6, 0.85);
        let tile = Tile::new(DVec3::new(1.1 * x, 1.1 * y, -0.37), size, j + 0.1 * DVec3::new(in_plane, 0.0, across));
        let turn = if n < 70.0 { DQuat::IDENTITY } else { DQuat::from_rotation_z(0.01 * n) };
        tile.expect("a valid tile").rotated(turn).expect("a rotation")
    };
    let tiles: Vec<Tile> = (0..144).map(tile).collect();
    Tree::new(&DirectSum::new(&tiles, Level::new()), 20)
}

#[test]
fn expansions_of_flat_films_have_a_parity_that_changes_no_digit() {
    let points = [0, 1, 2].map(|axis| -> Vec<f64> {
        (0..32).map(|n| [0.9, -1.3, 1.7][axis] * (f64::from(n) + 3.0) + 40.0 * [1.0, 1.0, 0.0][axis]).collect()
    });
    let views = || points.each_ref().map(|axis| &axis[..]);
    for (in_plane, across, parity) in [(0.3, 0.0, Parity::Even), (0.0, 0.3, Parity::Odd), (0.3, 0.2, Parity::Neither)] {
        let tree = flat_film(in_plane, across);
        for node in 0..tree.nodes.len() {
            let expansion = tree.multipole_expansion(node);
            assert_eq!(expansion.parity(), parity, "node {node}");
            let all = expansion.clone().without_parity();
            for level in levels() {
                let field = |expansion: &MultipoleExpansion| {
                    let mut fields = [const { [f64::NAN; 32] }; 3];
                    let degrees = [expansion.degree(), expansion.degree().div_ceil(2)];
                    let buffers = fields.each_mut().map(|values| &mut values[..]);
                    dispatch!(level, simd => expansion.fields(simd, &degrees, views(), buffers));
                    fields
                };
                assert_eq!(field(expansion), field(&all), "node {node} with {level:?}");
            }
        }
    }
}
