//! What a tree leaves out against exact fields, for each kind of instructions.

use std::sync::Arc;

use fearless_simd::{Level, dispatch};
use glam::DVec3;

use super::{Degrees, Tree};
use crate::arrangement::Arrangement;
use crate::batch::assignment::{Assigned, Assignment, Near, Nearest, Translated};
use crate::batch::far::Far;
use crate::batch::superposition::Superposition;
use crate::batch::tests::{expanded, levels, one};
use crate::batch::translation::translated;
use crate::kernel::Part;
use crate::tile::Tile;
use crate::tolerances::EXACT_BOUND;
use crate::within::magnitude::Box3;

/// Two small tiles whose dipoles point outwards leave out nearly the most that tiles can: what a node may leave out is a bound, and a close one.
#[test]
fn nodes_leave_out_no_more_than_they_say_and_not_much_less() {
    let level = Level::new();
    let turn = glam::DQuat::from_rotation_arc(DVec3::X, DVec3::new(0.4, -0.5, 0.8).normalize());
    let outwards = [-1.0, 1.0].map(|sign: f64| {
        let tile = Tile::new(turn * DVec3::X * sign, DVec3::splat(0.02), DVec3::X * sign).expect("a valid tile");
        tile.rotated(turn).expect("a rotation")
    });
    let arrangement = Arrangement::of(&outwards);
    let tree = Tree::of(level, &arrangement, &outwards, 15);
    let scene = crate::scene::Scene::new(&outwards);
    let mut seen = [false; 16];
    for distance in [1.3, 1.6, 2.0, 3.0, 8.0, 40.0] {
        let point = turn * DVec3::X * distance;
        let exact = scene.field(crate::quantity::Quantity::FluxDensity, point).expect("outside");
        for exponent in 0..60 {
            let allowed_t = 0.1 * 0.5_f64.powi(exponent);
            let at = Box3 { lower: point, upper: point };
            let Some(nearest) = tree.nearest(0, &at, allowed_t) else { continue };
            let Nearest { degree, left_out_t, .. } = nearest;
            assert!(left_out_t <= allowed_t);
            let field = |degree: usize, point: DVec3| match degree {
                0 => DVec3::ZERO,
                _ => dispatch!(level, simd => expanded(simd, tree.expansion(0), degree, point)),
            };
            let found = field(degree, point);
            let error_t = (found - exact).length();
            let rounding = 1e-13 * exact.length();
            assert!(error_t <= left_out_t + rounding, "degree {degree} at {distance}: {error_t:e} of {left_out_t:e}");
            assert!(
                error_t + rounding >= 0.3 * left_out_t,
                "degree {degree} at {distance}: {error_t:e} of {left_out_t:e}"
            );
            seen[degree] = true;
            // Degrees found from that for points farther away.
            let mut last = degree;
            for times in [1.0, 1.02, 1.1, 1.3, 2.0, 7.0, 1e4, 1e60] {
                let farther = point * times;
                let mut degrees = Degrees::default();
                let [x, y, z] = farther.to_array().map(|coordinate| [coordinate; 16]);
                tree.set_degrees(&nearest, [&x, &y, &z], &mut degrees);
                let (&[own], &[left_out_t]) = (&degrees.highest[..], &degrees.left_out_t[..]) else {
                    panic!("one degree for 16 points: {degrees:?}")
                };
                assert!(own <= last, "{own} after {last}, {times} times as far as {distance}");
                let exact = scene.field(crate::quantity::Quantity::FluxDensity, farther).expect("outside");
                let error_t = (field(own, farther) - exact).length();
                assert!(error_t <= left_out_t + 1e-13 * exact.length(), "degree {own}: {error_t:e} of {left_out_t:e}");
                last = own;
            }
            assert_eq!(last, 0, "nothing is needed there");
        }
    }
    // The parts of odd degree vanish by symmetry, so that none of them is the last that is needed.
    assert_eq!(seen.iter().filter(|seen| **seen).count(), 8, "{seen:?}");
}

/// Tiles in a plane, as many different polarizations, and a tree over them.
fn sheet() -> (Arrangement, Tree) {
    sheet_of(|x, y| DVec3::new((0.6 * x + 0.1 * y).sin(), (0.6 * y + 0.1 * x).sin(), 0.2 + 0.1 * (x * y).sin()))
}

/// 40 x 40 cubes of one unit with this polarization at x and y.
fn sheet_of(polarization_t: impl Fn(f64, f64) -> DVec3) -> (Arrangement, Tree) {
    let tiles: Vec<Tile> = (0..1600)
        .map(|n| {
            let (x, y) = (f64::from(n % 40) - 19.5, f64::from(n / 40) - 19.5);
            Tile::new(DVec3::new(x, y, 0.5), DVec3::ONE, polarization_t(x, y)).expect("a valid tile")
        })
        .collect();
    let arrangement = Arrangement::of(&tiles);
    let tree = Tree::of(Level::new(), &arrangement, &tiles, 30);
    (arrangement, tree)
}

/// Of a node's expansion to a degree, of which nothing else is left out than by the translation.
fn translation(node: usize, degree: usize, (local_degree, local_left_out_t): (usize, f64)) -> Translated {
    Translated { node, distance: 1.0, degree, left_out_t: 0.0, local_degree, local_left_out_t }
}

/// A node's expansion and the same translated differ by at most what the translation is said to leave out, and not by much less everywhere.
#[test]
fn translations_leave_out_no_more_than_they_say() {
    let (_, tree) = sheet();
    let (middle, reach) = (DVec3::new(31.0, 12.0, -4.0), 5.0);
    let directions = (0..40).map(|n| {
        let turn = f64::from(n);
        DVec3::new((1.3 * turn).sin(), (2.1 * turn).cos(), (0.7 * turn).cos()).normalize()
    });
    let points: Vec<DVec3> = directions.map(|direction| middle + reach * direction).collect();
    let mut translations = 0;
    let mut closest = 0.0_f64;
    for node in 0..tree.nodes.len() {
        for exponent in [2, 4, 6, 8, 10] {
            let Some((local_degree, left_out_t)) = tree.local_degree(node, 18, middle, reach, 10_f64.powi(-exponent))
            else {
                continue;
            };
            translations += 1;
            let what = translation(node, 18, (local_degree, left_out_t));
            let toward = middle + reach * (tree.nodes[node].centre - middle).normalize();
            let points = || points.iter().copied().chain([toward]);
            for level in levels() {
                let errors: Vec<f64> = dispatch!(level, simd => {
                    let local = translated(simd, &tree, &[what], middle, reach).expect("one node");
                    let own = |at| expanded(simd, tree.expansion(node), 18, at);
                    points().map(|at| (one(simd, &local, at) - own(at)).length()).collect()
                });
                let error_t = errors.into_iter().fold(0.0, f64::max);
                assert!(error_t <= left_out_t + 1e-14, "{error_t:e}, not {left_out_t:e}, with {local_degree}");
                closest = closest.max(error_t / left_out_t);
            }
        }
    }
    assert!(translations > 100 && closest > 0.1, "{translations} translations, {closest}");
}

/// Many nodes at a time add up to what they are one by one, whatever their degrees.
#[test]
fn nodes_are_translated_together() {
    let (_, tree) = sheet();
    let (middle, reach) = (DVec3::new(36.0, -3.0, -4.0), 2.0);
    let degree = |node: usize| tree.local_degree(node, 6 + node % 9, middle, reach, 1e-9);
    let all = (0..tree.nodes.len()).filter_map(|node| Some(translation(node, 6 + node % 9, degree(node)?)));
    let all: Vec<Translated> = all.collect();
    assert!(all.len() > 20);
    let highest = all.iter().map(|of| of.local_degree).max();
    for level in levels() {
        for at in [middle, middle + 1.1, middle + DVec3::new(-1.0, 1.5, 0.5)] {
            let [together, alone] = dispatch!(level, simd => {
                let together = one(simd, &translated(simd, &tree, &all, middle, reach).expect("nodes"), at);
                let alone = all.iter().map(|of| {
                    let of = Translated { local_degree: highest.expect("nodes"), ..*of };
                    one(simd, &translated(simd, &tree, &[of], middle, reach).expect("one node"), at)
                });
                [together, alone.sum()]
            });
            // Degrees that some do not need are taken of none beyond the highest of those that are translated at the same time.
            assert!((together - alone).length() <= 1e-9 * all.len() as f64, "{together} is not {alone}");
        }
    }
}

/// Points that are near all tiles get the field that the exact mode gives them, but for its rounding: whether tiles share elements, some or all of them, or none.
#[test]
fn near_tiles_have_the_same_field_to_a_tolerance() {
    let points: Vec<DVec3> = (0..64)
        .map(|n| {
            let turn = f64::from(n);
            DVec3::new(3.0 * (1.3 * turn).sin(), 3.0 * (2.1 * turn).cos(), -2.6 - 2.5 * (0.7 * turn).cos())
        })
        .collect();
    // The sum over tiles is about one of each.
    let some_alike = |x: f64, y: f64| DVec3::new((0.6 * x).sin(), 0.3, if y > 0.0 { (y * y + x).sin() } else { 0.0 });
    let all_alike = |x: f64, y: f64| DVec3::new(if x * y > 0.0 { 0.7 } else { -0.7 }, 0.7, 0.0);
    for (arrangement, tree) in [sheet(), sheet_of(some_alike), sheet_of(all_alike)] {
        let assignment = Assignment::of(&tree, None, &Box3::around(&points), points.len(), 0.0);
        assert_eq!(assignment.tiles[0] + assignment.tiles[2], 0);
        for level in levels() {
            let exact = added_up(level, &arrangement, None, &points).0;
            let (near, left_out_t) = added_up(level, &arrangement, Some((&tree, &assignment)), &points);
            for (exact, near) in exact.into_iter().zip(near) {
                assert!((exact - near).length() <= 2e-14, "{near} is not {exact}");
            }
            assert!(left_out_t.iter().all(|left_out_t| *left_out_t == 0.0));
        }
    }
}

/// B at points, and at most what is left out there.
fn added_up(
    level: Level,
    arrangement: &Arrangement,
    assigned: Option<(&Tree, &Assignment)>,
    points: &[DVec3],
) -> (Vec<DVec3>, Vec<f64>) {
    let (mut field, mut left_out_t) = (vec![DVec3::ZERO; points.len()], vec![f64::NAN; points.len()]);
    let assigned = assigned.map(|(tree, assignment)| (tree, Assigned { assignment, left_out_t: &mut left_out_t }));
    Superposition::of_this_thread(|room| {
        room.add_up(level, arrangement, assigned, Part::Density, points, &mut field);
    });
    (field, left_out_t)
}

/// Whole nodes, expansions at all points or beyond a sphere, translated ones, and what is translated for several parts of points, each against the exact field of the same tiles; at points some of which are in a row far
/// away from the others.
#[test]
fn no_more_is_left_out_at_a_point_than_is_said_there() {
    let (arrangement, tree) = sheet();
    // Of both fields, whose tiles add up to about one.
    let rounding_t = 2.0 * EXACT_BOUND;
    let mut closest = [0.0_f64; 5];
    for (middle, spread) in [(DVec3::new(3.0, -8.0, -2.0), 3.0), (DVec3::new(24.0, 21.0, -3.0), 6.0)] {
        let point = |n: usize| {
            let turn = n as f64;
            let near = DVec3::new((1.3 * turn).sin(), (2.1 * turn).cos(), 0.3 * (0.7 * turn).cos());
            middle + if n < 80 { spread * near } else { DVec3::new(0.1, 0.2, -0.4) * (turn - 79.0) }
        };
        let mut points: Vec<DVec3> = (0..101).map(point).collect();
        points[57] = DVec3::splat(f64::NAN);
        let usable: Vec<DVec3> = points.iter().copied().filter(|point| !point.is_nan()).collect();
        let around = Box3::around(&usable);
        for exponent in 1..12 {
            let allowed_t = 10_f64.powi(-exponent);
            let whole = Assignment::of(&tree, None, &around, points.len(), allowed_t);
            let none = || Assignment { middle: whole.middle, reach: whole.reach, ..Assignment::default() };
            let beyond: Vec<Near> = whole.near.iter().copied().filter(|near| near.beyond.is_some()).collect();
            let expanded = Assignment { expanded: whole.expanded.clone(), ..none() };
            let translated = Assignment { translated: whole.translated.clone(), ..none() };
            let of_nodes = |nodes: Vec<usize>| -> Vec<usize> {
                nodes.into_iter().flat_map(|node| tree.nodes[node].items.clone()).collect()
            };
            let far = Arc::new(Far::of(&tree, &around, allowed_t));
            let is_far = |item: &usize| !far.rest.iter().any(|&node| tree.nodes[node].items.contains(item));
            let far_items: Vec<usize> = (0..tree.items.len()).filter(is_far).collect();
            let shared = Assignment { far: Some(far.clone()), ignored_t: far.assignment.ignored_t, ..none() };
            let mut served = [
                (expanded, of_nodes(whole.expanded.iter().map(|of| of.node).collect())),
                (translated, of_nodes(whole.translated.iter().map(|of| of.node).collect())),
                (Assignment { near: beyond.clone(), ..none() }, beyond.iter().map(|near| near.item).collect()),
                (Assignment { ignored_t: whole.ignored_t, ..none() }, Vec::new()),
                (shared, far_items),
            ];
            let is_served = |item: &usize| {
                whole.near.iter().any(|near| near.item == *item)
                    || served[..3].iter().any(|(_, items)| items.contains(item))
            };
            served[3].1 = (0..tree.items.len()).filter(|item| !is_served(item)).collect();
            for (kind, (assignment, mut items)) in served.into_iter().enumerate() {
                items.sort_unstable();
                let near = items.into_iter().map(|item| Near { item, beyond: None }).collect();
                let exactly = Assignment { near, ..none() };
                for level in levels() {
                    let exact = added_up(level, &arrangement, Some((&tree, &exactly)), &points).0;
                    let (field, left_out_t) = added_up(level, &arrangement, Some((&tree, &assignment)), &points);
                    for (index, point) in points.iter().enumerate().filter(|(_, point)| !point.is_nan()) {
                        let (error_t, most_t) = ((field[index] - exact[index]).length(), left_out_t[index]);
                        assert!(error_t <= most_t + rounding_t, "{error_t:e}, not {most_t:e}, at {point}, kind {kind}");
                        closest[kind] = closest[kind].max((error_t - rounding_t) / most_t);
                    }
                }
            }
        }
    }
    assert!(closest.iter().all(|closest| *closest > 0.1), "of what is said {closest:?} are left out");
}

/// Every tile is served once, whatever may be left out.
#[test]
fn assignments_take_every_tile_once() {
    let tiles: Vec<Tile> = (0..300)
        .map(|n| {
            let turn = f64::from(n);
            let at = DVec3::new((1.3 * turn).sin(), (2.1 * turn).sin(), (0.7 * turn).cos()) * 10.0;
            Tile::new(at, DVec3::new(0.5, 1.0, 0.3), DVec3::new(0.1, turn.cos(), 0.2)).expect("a valid tile")
        })
        .collect();
    let arrangement = Arrangement::of(&tiles);
    let tree = Tree::of(Level::new(), &arrangement, &tiles, 20);
    let points = Box3 { lower: DVec3::new(-1.0, 2.0, 3.0), upper: DVec3::new(0.5, 4.0, 5.0) };
    let more_points = Box3 { lower: DVec3::new(-1.5, 1.0, 3.0), upper: DVec3::new(0.5, 4.0, 6.0) };
    let (mut last, mut far_nodes) = (0, 0);
    for exponent in 0..12 {
        let allowed_t = 10_f64.powi(-exponent);
        let assignment = Assignment::of(&tree, None, &points, 1, allowed_t);
        assert_eq!(assignment.tiles.iter().sum::<usize>(), tiles.len());
        let far = Arc::new(Far::of(&tree, &more_points, allowed_t));
        let rest = Assignment::of(&tree, Some(&far), &points, 1, allowed_t);
        assert_eq!(rest.tiles.iter().sum::<usize>(), tiles.len());
        let nodes = rest.expanded.iter().map(|of| of.node).chain(far.assignment.translated.iter().map(|of| of.node));
        let tiles_of_nodes: usize = nodes.map(|node| tree.tiles_of_node(node)).sum();
        assert_eq!(tiles_of_nodes, rest.tiles[0], "nodes and what of them is far do not both count");
        far_nodes += far.assignment.translated.len();
        assert!(assignment.tiles[1] >= last, "the less may be left out, the more tiles are near");
        last = assignment.tiles[1];
    }
    assert!(last > 10 && last < 290, "{last} tiles are near");
    assert!(far_nodes > 20, "{far_nodes} nodes are far");
}
