//! Points of several tiles whose field may be too weak for a tolerance, and the bounds that decide
//! them.

use fearless_simd::{Level, dispatch};
use glam::DVec3;
use magsplice_cuboid::tolerances::EXACT_BOUND;
use magsplice_direct::least_field::LeastField;
use magsplice_direct::magnitude::MagnitudeBounds;
use magsplice_direct::open_points::OpenPoints;
use magsplice_magnet::{BoundingBox, Tile, Tolerance};
use magsplice_simd::column::Column;

#[test]
fn ends_are_those_of_the_numbers() {
    let field = [DVec3::NAN, DVec3::X * 2.0, DVec3::new(0.0, 3.0, 4.0)];
    let points = [DVec3::splat(f64::NAN), DVec3::new(1.0, -2.0, 7.0), DVec3::new(-4.0, 5.0, 6.0)];
    OpenPoints::with_buffers(|open| {
        dispatch!(Level::new(), simd => {
            // In a unit of half a tesla.
            assert_eq!(open.set_fields(simd, &field, 2.0), 1.0);
            let around = open.set_points(simd, &points);
            assert_eq!(around, BoundingBox::from_points(&points[1..]));
        });
    });
}

#[test]
fn points_are_kept_as_their_bounds_say() {
    let least = LeastField::new(Tolerance::relative(1e-11).expect("a tolerance"));
    for share in [1, 2, 3, 7, 100] {
        let field: Vec<DVec3> = (0..131).map(|n| DVec3::X * if n % share == 0 { 0.9 } else { 1.1 }).collect();
        OpenPoints::with_buffers(|open| {
            let kept = dispatch!(Level::new(), simd => {
                open.set_fields(simd, &field, 1.0);
                open.set_points(simd, &field);
                // A magnitude of 100 T has an error of 1e-11 T.
                open.points_and_magnitudes_t().1.fill(100.0);
                open.keep_weak(simd, least);
                let first: Vec<usize> = open.bounds().map(|(index, _)| index).collect();
                // A second, larger bound does not reopen the points that were decided.
                open.points_and_magnitudes_t().1.fill(1e4);
                open.keep_weak(simd, least);
                assert!(open.bounds().map(|(index, _)| index).eq(first.iter().copied()), "every {share}");
                first
            });
            assert!(kept.iter().copied().eq((0..131).step_by(share)), "every {share}: {kept:?}");
        });
    }
}

/// Two by two unit cubes around the origin.
fn square() -> (Vec<BoundingBox>, MagnitudeBounds) {
    let place = |n: u32| DVec3::new(f64::from(n % 2) - 0.5, f64::from(n / 2) - 0.5, 0.0);
    let tiles = [0, 1, 2, 3].map(|n| Tile::new(place(n), DVec3::ONE, DVec3::Z).expect("a valid tile"));
    (tiles.iter().map(BoundingBox::from_tile).collect(), MagnitudeBounds::new(&tiles, &[1.0; 4]))
}

/// Points that a bound leaves open, of a field of 1 T at the first `strong` of `points`, and of
/// half the field that the closest bound requires at the others.
fn left(points: &[DVec3], strong: usize, tolerance: Tolerance) -> Vec<usize> {
    let (boxes, bounds) = square();
    let level = Level::new();
    let mut required = Column::default();
    bounds.write(level, points.iter().copied(), &mut required);
    let least = LeastField::new(tolerance);
    let field = |n: usize| if n < strong { DVec3::X } else { DVec3::Y * (0.5 * least.at_t(EXACT_BOUND * required[n])) };
    let field: Vec<DVec3> = (0..points.len()).map(field).collect();
    OpenPoints::with_buffers(|open| {
        bounds.find_weak(level, least, (points, &field, 1.0), &boxes, open);
        for (index, own_t) in open.bounds() {
            assert_eq!(own_t, required[index], "the closest bound at {index}");
        }
        open.bounds().map(|(index, _)| index).collect()
    })
}

#[test]
fn weak_points_are_left_at_every_distance_and_share() {
    let tolerance = Tolerance::relative(1e-11).expect("a tolerance");
    for distance in [0.0, 0.7, 1.5, 4.0, 30.0, 1e4] {
        for count in [1, 15, 16, 17, 100, 512] {
            let place = |n: usize| DVec3::new(0.1 + distance, 0.17, 0.0013 * (n as f64 + 0.3));
            let points: Vec<DVec3> = (0..count).map(place).collect();
            for strong in [0, 1, count / 3, count - 1, count] {
                let expected: Vec<usize> = (strong..count).collect();
                assert_eq!(left(&points, strong, tolerance), expected, "{strong} of {count} at {distance}");
            }
        }
    }
}

#[test]
fn a_tolerance_in_tesla_depends_on_distances_alone() {
    let points: Vec<DVec3> = (0..100).map(|n| DVec3::Z * (0.6 + 0.1 * f64::from(n))).collect();
    let (boxes, bounds) = square();
    let mut own_t = Column::default();
    bounds.write(Level::new(), points.iter().copied(), &mut own_t);
    // Between the bounds at the points 9 and 10.
    let tolerance = Tolerance::absolute_t(EXACT_BOUND * 0.5 * (own_t[9] + own_t[10])).expect("a tolerance");
    OpenPoints::with_buffers(|open| {
        let of = (&points[..], &vec![DVec3::ZERO; points.len()][..], 1.0);
        bounds.find_weak(Level::new(), LeastField::new(tolerance), of, &boxes, open);
        assert!(open.bounds().map(|(index, _)| index).eq(0..10));
    });
}

#[test]
fn rough_bounds_are_for_points_near_few_tiles() {
    let (_, bounds) = square();
    let at = |x: f64| BoundingBox::from_points(&[DVec3::X * x]);
    // The sphere around the tiles has a radius of 0.5^1/2 + 0.75^1/2.
    assert!(bounds.has_rough_bounds(&at(2.3)) && !bounds.has_rough_bounds(&at(2.4)));
    let tiles: Vec<Tile> =
        (0..17).map(|n| Tile::new(DVec3::X * f64::from(2 * n), DVec3::ONE, DVec3::Z).expect("a valid tile")).collect();
    assert!(!MagnitudeBounds::new(&tiles, &[1.0; 17]).has_rough_bounds(&at(2.3)));
}

#[test]
fn distances_decide_fields_of_dipoles_from_few_radii_on() {
    let (_, bounds) = square();
    let points: Vec<DVec3> = (0..64).map(|n| DVec3::new(3.0 + 0.5 * f64::from(n), 0.4, 0.3)).collect();
    // A field like that of dipoles, within 1e-10, keeps 1000 times the magnitude.
    let field: Vec<DVec3> = points.iter().map(|p| DVec3::Z / (4.0 * p.length().powi(3))).collect();
    let least = LeastField::new(Tolerance::relative(1e-10).expect("a tolerance"));
    let open_by_distance = |field: &[DVec3]| {
        OpenPoints::with_buffers(|open| {
            dispatch!(Level::new(), simd => {
                open.set_fields(simd, field, 1.0);
                open.set_points(simd, &points);
                bounds.keep_weak_by_distance(simd, least, open);
            });
            open.bounds().count()
        })
    };
    assert_eq!(open_by_distance(&field), 0);
    let weaker: Vec<DVec3> = field.iter().map(|b| *b * 1e-4).collect();
    assert_eq!(open_by_distance(&weaker), points.len());
}
