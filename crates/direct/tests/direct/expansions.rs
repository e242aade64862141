//! Tables and expansions of clusters against the scalar kernel, for each instruction set.

use fearless_simd::{Level, Simd, dispatch};
use glam::DVec3;
use magsplice_cuboid::block::{Block, LocalPoint};
use magsplice_cuboid::scalar::kernel::{FieldKind, cuboid_field};
use magsplice_direct::prepare::cluster_methods::farthest_corner;
use magsplice_direct::prepare::clusters::expansion_of;
use magsplice_expansion::multipole::MultipoleExpansion;
use magsplice_expansion::tolerances::EXPANSION_DEGREES;
use magsplice_simd::InstructionSet;
use magsplice_simd::lanes::{Lanes, Number};

fn levels() -> Vec<Level> {
    InstructionSet::available().into_iter().map(|set| set.detected().expect("available")).collect()
}

#[inline(always)]
fn expanded<S: Simd>(simd: S, expansion: &MultipoleExpansion, degree: usize, point: DVec3) -> DVec3 {
    let lanes = point.to_array().map(|c| Lanes::<S>::splat(simd, c));
    let [first, second] = expansion.fields_of_pair(simd, degree, [lanes, lanes]);
    for axis in 0..3 {
        assert_eq!(first[axis].lane(0), second[axis].lane(Lanes::<S>::LEN - 1));
    }
    DVec3::new(first[0].lane(0), first[1].lane(0), first[2].lane(0))
}

/// Each degree of the expansion keeps the error bound from its distance on, but not from a much
/// smaller distance, at which the degrees would be too high.
#[test]
fn expansion_of_each_degree_keeps_the_error_bound_from_its_distance() {
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
    let radius = farthest_corner(&blocks, centre);
    let error = |level: Level, expansion: &MultipoleExpansion, degree: usize, distance: f64| {
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
                let at = LocalPoint { coordinates: point.to_array(), roundoff: [0.0; 3] };
                let placed = block.place(&at).expect("near enough");
                let own = cuboid_field(&placed.offsets, block.polarization_t.to_array(), FieldKind::Density);
                exact += DVec3::from(own);
                magnitude += DVec3::from(own).length();
            }
            let found = dispatch!(level, simd => expanded(simd, expansion, degree, point));
            worst = worst.max((found - exact).length() / magnitude);
        }
        worst
    };
    for level in levels() {
        let expansion = expansion_of(level, &blocks, centre, 0.25);
        for (degree, distance) in EXPANSION_DEGREES {
            let own = error(level, &expansion, degree, distance);
            assert!(own <= 5e-15, "{level:?}: degree {degree} is off by {own:e} from {distance} radii on");
        }
    }
    let (level, (degree, distance)) = (Level::new(), EXPANSION_DEGREES[2]);
    let nearer = error(level, &expansion_of(level, &blocks, centre, 0.25), degree, 0.4 * distance);
    assert!(nearer > 5e-15, "degree {degree} is good for {nearer:e} much nearer than {distance} radii");
}
