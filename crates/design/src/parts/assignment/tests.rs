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
