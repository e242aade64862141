//! Tiles stay as they are where their parts are mirror images, and parts keep what symmetry
//! demands.

use magsplice_layout::Layout;
use magsplice_magnet::Tile;

use super::*;
use crate::problem::design_problem::DesignProblem;

/// A layout with `stock` in its brief and one tile for each centre, size and direction.
fn layout(symmetry: &str, stock: &str, tiles: &[([f64; 2], [f64; 2], f64)]) -> Layout {
    let mut text = format!(
        "format = 1\nname = \"film\"\n[ideal]\nwavelength_mm = 10.0\nthickness_mm = 1.0\namplitude_t = 0.12\n\
         [volume]\nx_mm = [-2.0, 2.0]\ny_mm = [-2.0, 2.0]\nz_mm = [-5.0, -3.0]\nstep_mm = 0.5\n\
         [design]\nvary = [\"size\", \"position\", \"direction\"]\nsymmetry = \"{symmetry}\"\n\
         stock = [{stock}]\n"
    );
    for ([x, y], [width, depth], direction_deg) in tiles {
        text += &format!(
            "[[tile]]\nposition_mm = [{x:?}, {y:?}, 0.5]\nsize_mm = [{width:?}, {depth:?}, 1.0]\n\
             strength_t = 0.12\ndirection_deg = {direction_deg:?}\n"
        );
    }
    Layout::parse(&text, "film").unwrap_or_else(|e| panic!("{e}"))
}

fn problem(layout: &Layout) -> DesignProblem<'_> {
    DesignProblem::new(layout).unwrap_or_else(|e| panic!("{e}"))
}

fn assignment(problem: &DesignProblem) -> PartAssignment {
    let start = problem.pattern.start.clone();
    let candidate = problem.least_squares.candidate_at(&problem.pattern, start).expect("a field");
    PartAssignment::new(&problem.brief, &problem.pattern, &candidate)
}

/// The tiles that the parts of an assignment make.
fn made(assignment: &PartAssignment, problem: &DesignProblem) -> Vec<Tile> {
    let pattern = assignment.pattern(&problem.brief, &problem.pattern);
    pattern.all_tiles(&pattern.start).expect("sides above 0")
}

fn assert_same(made: &[Tile], wanted: &[Tile]) {
    assert_eq!(made.len(), wanted.len());
    for (made, wanted) in made.iter().zip(wanted) {
        // Sums and rotations of numbers of a few units.
        assert!((made.size() - wanted.size()).length() < 1e-12, "{made:?}, {wanted:?}");
        assert!((made.position() - wanted.position()).length() < 1e-12, "{made:?}, {wanted:?}");
        assert!((made.polarization_t() - wanted.polarization_t()).length() < 1e-12, "{made:?}, {wanted:?}");
    }
}

/// A square polarized at 30 degrees, turned over its diagonal, is one at 60 degrees.
#[test]
fn mirror_images_become_one_part_and_stay_as_they_are() {
    let layout = layout("none", "", &[([-3.0, 1.0], [3.0, 3.0], 60.0), ([3.0, 0.0], [3.0, 3.0], 30.0)]);
    let problem = problem(&layout);
    let exchanged = assignment(&problem).with_merged(0, 1, true, true).expect("no demand forbids it");
    assert_eq!((exchanged.assignment.free(), exchanged.distance), (1, 0.0));
    assert_same(&made(&exchanged.assignment, &problem), &layout.bare_tiles());
    // Without the exchange both get the mean direction.
    let plain = assignment(&problem).with_merged(0, 1, false, true).expect("no demand forbids it");
    let diagonal = DVec3::new(0.5_f64.sqrt(), 0.5_f64.sqrt(), 0.0);
    for tile in made(&plain.assignment, &problem) {
        assert!((tile.polarization_t().normalize() - diagonal).length() < 1e-12, "{tile:?}");
    }
}

/// A tile of 3 x 2 mm polarized at 60 degrees is a quarter turn and a turning over away from a part
/// of 2 x 3 mm at 30 degrees.
#[test]
fn tile_is_made_of_a_part_in_stock_with_exchanged_sides() {
    let stock = "{ size_mm = [2.0, 3.0], direction_deg = 30.0 }";
    let layout = layout("none", stock, &[([-3.0, 1.0], [3.0, 2.0], 60.0)]);
    let problem = problem(&layout);
    let nearest = assignment(&problem).merged(true).into_iter().min_by(|a, b| a.distance.total_cmp(&b.distance));
    let nearest = nearest.expect("the part in stock");
    assert_eq!((nearest.assignment.free(), nearest.distance), (0, 0.0));
    assert_same(&made(&nearest.assignment, &problem), &layout.bare_tiles());
}

/// A tile on a mirror binds the part that it shares. A tile beside the mirrors is still free to
/// become the diagonal part of another tile.
#[test]
fn exchanged_tile_takes_its_own_demands_along() {
    let tiles = [
        // On the mirror y = 0.
        ([4.0, 0.0], [2.0, 2.0], 0.0),
        ([-4.0, 0.0], [2.0, 2.0], 180.0),
        ([0.0, 4.0], [2.0, 2.0], 90.0),
        ([0.0, -4.0], [2.0, 2.0], 270.0),
        // On the diagonals.
        ([7.0, 7.0], [2.0, 2.0], 45.0),
        ([-7.0, 7.0], [2.0, 2.0], 135.0),
        ([7.0, -7.0], [2.0, 2.0], 315.0),
        ([-7.0, -7.0], [2.0, 2.0], 225.0),
        // On none.
        ([7.0, 3.0], [2.0, 2.0], 20.0),
        ([7.0, -3.0], [2.0, 2.0], 340.0),
        ([-7.0, 3.0], [2.0, 2.0], 160.0),
        ([-7.0, -3.0], [2.0, 2.0], 200.0),
        ([3.0, 7.0], [2.0, 2.0], 70.0),
        ([-3.0, 7.0], [2.0, 2.0], 110.0),
        ([3.0, -7.0], [2.0, 2.0], 290.0),
        ([-3.0, -7.0], [2.0, 2.0], 250.0),
    ];
    let layout = layout("four-fold", "", &tiles);
    let problem = problem(&layout);
    let apart = assignment(&problem);
    let of = |class: SymmetryClass| apart.placed.iter().position(|placed| placed.class == class).expect("one each");
    let [free, axis, diagonal] = [SymmetryClass::Free, SymmetryClass::Axis, SymmetryClass::Diagonal].map(of);
    let shared = apart.with_merged(free, axis, false, true).expect("a free part").assignment;
    assert_eq!(shared.parts[shared.placed[free].part].class, SymmetryClass::Axis);
    let moved = shared.with_one_exchanged(true);
    let all_ways: Vec<usize> = moved.iter().map(|assignment| assignment.placed[free].part).collect();
    assert!(all_ways.contains(&diagonal), "{all_ways:?}");
}

/// Parts in stock count as exactly along a side or a diagonal if they are so to six digits. Each is
/// described with its polarization within the first right angle.
#[test]
fn parts_in_stock_are_recognized_by_their_symmetry() {
    let part = |size_mm: [f64; 2], direction_deg: f64| part_in_stock(&StockPart { size_mm, direction_deg }, 0.12);
    let cases = [
        // A direction of 1e-6 degrees is 2e-8 radians.
        ([2.0, 3.0], 1e-6, SymmetryClass::Axis, [2.0, 3.0], 0.0),
        ([2.0, 3.0], 180.0 - 1e-6, SymmetryClass::Axis, [2.0, 3.0], 0.0),
        // Along the second side, which becomes the first.
        ([2.0, 3.0], 90.0 - 1e-6, SymmetryClass::Axis, [3.0, 2.0], 0.0),
        ([2.0, 3.0], -90.0, SymmetryClass::Axis, [3.0, 2.0], 0.0),
        ([3.0, 3.0], 45.0 + 1e-6, SymmetryClass::Diagonal, [3.0, 3.0], FRAC_PI_4),
        ([3.0, 3.0], 225.0, SymmetryClass::Diagonal, [3.0, 3.0], FRAC_PI_4),
    ];
    for (size_mm, direction_deg, class, size, angle) in cases {
        let found = part(size_mm, direction_deg);
        assert_eq!((found.class, found.size, found.angle), (class, size, angle), "{direction_deg} degrees");
        assert!(found.in_stock && found.strength == 0.12);
    }
    // No square, so that its diagonal is no symmetry; and no special direction.
    for (size_mm, direction_deg, angle_deg) in [([2.0, 3.0], 45.0, 45.0_f64), ([3.0, 3.0], 150.0, 30.0)] {
        let found = part(size_mm, direction_deg);
        assert_eq!((found.class, found.size), (SymmetryClass::Free, size_mm), "{direction_deg} degrees");
        assert!((found.angle - angle_deg.to_radians()).abs() < 1e-15, "{}", found.angle);
    }
}

/// The parts of a changed film make its tiles, and a part in stock stays as it is, to the last
/// digit.
#[test]
fn parts_follow_the_film_except_parts_in_stock() {
    let stock = "{ size_mm = [2.0, 3.0], direction_deg = 30.0 }";
    let layout = layout("none", stock, &[([-3.0, 1.0], [3.0, 2.0], 60.0), ([3.0, 1.0], [2.5, 1.5], 150.0)]);
    let problem = problem(&layout);
    let nearest = assignment(&problem).merged(true).into_iter().min_by(|a, b| a.distance.total_cmp(&b.distance));
    let of_stock = nearest.expect("the part in stock").assignment;
    let of_stock_pattern = of_stock.pattern(&problem.brief, &problem.pattern);
    for (assignment, pattern) in [(assignment(&problem), &problem.pattern), (of_stock, &of_stock_pattern)] {
        let changed =
            pattern.start.iter().enumerate().map(|(number, value)| value + 0.01 * (1.0 + number as f64).sin());
        let candidate = problem.least_squares.candidate_at(pattern, changed.collect()).expect("a field");
        let in_stock = |parts: &PartAssignment| -> Vec<([f64; 2], f64, f64)> {
            let whole = parts.parts.iter().filter(|part| part.in_stock);
            whole.map(|part| (part.size, part.angle, part.strength)).collect()
        };
        let before = in_stock(&assignment);
        let updated = assignment.updated(pattern, &candidate);
        assert_eq!(in_stock(&updated), before);
        let tiles = pattern.all_tiles(&candidate.variables).expect("sides above 0");
        assert!(tiles.iter().zip(layout.bare_tiles()).all(|(tile, start)| tile.position() != start.position()));
        assert_same(&made(&updated, &problem), &tiles);
    }
}

/// Rectangles in all eight orientations are one part, with its long side first and its polarization
/// within the first right angle, and the part makes them again.
#[test]
fn tiles_in_all_orientations_are_equal_parts() {
    let mut tiles = Vec::new();
    for (n, turned_deg) in [20.0, 160.0, 200.0, 340.0].into_iter().enumerate() {
        tiles.push(([4.0 * n as f64, 0.0], [3.0, 2.0], turned_deg));
        // Exchanged, a direction of 20 degrees is one of 70.
        tiles.push(([4.0 * n as f64, 5.0], [2.0, 3.0], 90.0 - turned_deg));
    }
    let layout = layout("none", "", &tiles);
    let problem = problem(&layout);
    let found = assignment(&problem);
    for part in &found.parts {
        let known = ([3.0, 2.0], 20.0_f64.to_radians(), 0.12);
        assert!((part.size[0] - known.0[0]).abs() < 1e-12 && (part.size[1] - known.0[1]).abs() < 1e-12, "{part:?}");
        assert!((part.angle - known.1).abs() < 1e-12 && (part.strength - known.2).abs() < 1e-15, "{part:?}");
        assert!(part.class == SymmetryClass::Free && !part.in_stock);
    }
    assert_same(&made(&found, &problem), &layout.bare_tiles());
    for operation in SymmetryOperation::all(magsplice_layout::Symmetry::FourFold) {
        let angle = operation.apply_to_angle(&Affine::constant(0.3)).constant;
        let arrow = operation.apply(DVec3::new(0.3_f64.cos(), 0.3_f64.sin(), 0.0));
        assert!(arrow.distance(DVec3::new(angle.cos(), angle.sin(), 0.0)) < 1e-15, "{operation:?}");
        let exchanged = operation.after_exchange().apply(DVec3::new(0.3_f64.sin(), 0.3_f64.cos(), 0.0));
        assert!(arrow.distance(exchanged) < 1e-15, "{operation:?}");
    }
}

/// Merged parts have the mean of their tiles, each counted once. The nearest sizes are merged
/// first, with exchanged sides if that is nearer.
#[test]
fn merged_parts_are_the_mean_of_their_tiles() {
    let tiles = [
        ([0.0, 0.0], [3.0, 2.0], 20.0),
        ([5.0, 0.0], [3.3, 2.6], 26.0),
        ([10.0, 0.0], [2.2, 4.0], 110.0),
        ([0.0, 5.0], [3.0, 2.9], 40.0),
    ];
    let layout = layout("none", "", &tiles);
    let problem = problem(&layout);
    let all = assignment(&problem);
    // Long sides first: 3.0 x 2.0, 3.3 x 2.6, 4.0 x 2.2 at 20 degrees, and 3.0 x 2.9.
    let is_part = |part: &DistinctPart, size: [f64; 2], angle_deg: f64| {
        let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
        near(part.size[0], size[0]) && near(part.size[1], size[1]) && near(part.angle, angle_deg.to_radians())
    };
    let two = all.with_merged(0, 1, false, true).expect("free");
    assert!((two.distance - 0.3_f64.hypot(0.6)).abs() < 1e-12);
    assert!(is_part(&two.assignment.parts[1], [3.15, 2.3], 23.0), "{:?}", two.assignment.parts[1]);
    assert_eq!((two.assignment.used(), two.assignment.free()), (vec![1, 2, 3], 3));
    // One tile joins two others.
    let three = two.assignment.with_merged(2, 1, false, true).expect("free").assignment;
    let mean = |one: f64, pair: f64| one / 3.0 + 2.0 * pair / 3.0;
    assert!(is_part(&three.parts[1], [mean(4.0, 3.15), mean(2.2, 2.3)], mean(20.0, 23.0)), "{:?}", three.parts[1]);
    // Where directions stay, the second part keeps its own.
    let fixed = all.with_merged(0, 1, false, false).expect("free").assignment;
    assert!(is_part(&fixed.parts[1], [3.15, 2.3], 26.0), "{:?}", fixed.parts[1]);
    assert_eq!(all.pairs(), [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]);
    assert_eq!(all.merged(true).len(), 12);
    // 3.3 x 2.6 and 3.0 x 2.9 are the nearest, by 0.42; with exchanged sides they are 0.57 apart.
    let nearest = all.nearest_merged(true).expect("free");
    assert_eq!(nearest.used(), [0, 2, 3]);
    assert!(is_part(&nearest.parts[3], [3.15, 2.75], 33.0), "{:?}", nearest.parts[3]);
}

/// Parts in stock absorb others, and are absorbed by none. Parts whose demands contradict each
/// other are not merged.
#[test]
fn parts_merge_only_where_stock_and_symmetry_allow() {
    let stock = "{ size_mm = [2.0, 3.0], direction_deg = 30.0 }, { size_mm = [2.0, 2.0], direction_deg = 45.0 }";
    let layout = layout("none", stock, &[([-3.0, 1.0], [3.0, 2.0], 60.0), ([3.0, 1.0], [2.5, 1.5], 150.0)]);
    let problem = problem(&layout);
    let all = assignment(&problem);
    assert_eq!(all.pairs(), [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3)]);
    assert_eq!((all.used(), all.free()), (vec![0, 1], 2));
    let absorbed = all.with_merged(0, 2, false, true).expect("free").assignment;
    assert_eq!((absorbed.parts[2].size, absorbed.free(), absorbed.used()), ([2.0, 3.0], 1, vec![1, 2]));
    assert_eq!(absorbed.pairs(), [(1, 2), (1, 3)]);
    let (free, axis, diagonal) = (SymmetryClass::Free, SymmetryClass::Axis, SymmetryClass::Diagonal);
    for (one, other, both) in [
        (free, free, Some(free)),
        (free, axis, Some(axis)),
        (diagonal, free, Some(diagonal)),
        (axis, axis, Some(axis)),
        (axis, diagonal, None),
        (diagonal, axis, None),
    ] {
        assert_eq!(one.and(other), both, "{one:?} {other:?}");
    }
    // A diagonal part in stock cannot be one along an axis, and a free one cannot become one.
    let mut demanding = all.clone();
    demanding.parts[0].class = axis;
    assert!(demanding.with_merged(0, 3, false, true).is_none() && demanding.with_merged(0, 2, false, true).is_none());
    assert!(demanding.with_merged(0, 1, true, true).is_some());
    demanding.parts[1].class = axis;
    assert!(demanding.with_merged(0, 1, true, true).is_none() && demanding.with_merged(0, 1, false, true).is_some());
    // Means along an axis and of a square.
    let axes = demanding.with_merged(0, 1, false, true).expect("both along an axis").assignment.parts[1];
    assert_eq!((axes.class, axes.angle), (axis, 0.0));
    demanding.parts[0].class = diagonal;
    demanding.parts[1].class = free;
    let square = demanding.with_merged(0, 1, false, true).expect("one is free").assignment.parts[1];
    assert_eq!((square.class, square.angle, square.size), (diagonal, FRAC_PI_4, [2.25; 2]));
}
