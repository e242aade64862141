//! Moments of several groups of sources against the moments of each group alone, for each
//! instruction set.

use glam::DVec3;
use magsplice_simd::InstructionSet;

use crate::moments::Moments;
use crate::source::CuboidSource;

#[test]
fn moments_of_groups_are_bit_identical_to_those_of_each_group() {
    let source = |n: usize| {
        let t = n as f64;
        let turn = glam::DMat3::from_rotation_z(if n % 5 == 4 { 0.3 } else { 0.0 });
        let size = DVec3::new(0.1, 0.2, 0.1 + 0.05 * (n % 3) as f64);
        CuboidSource::new(DVec3::new(t.sin(), t.cos(), 0.1 * t.sin()), size, Some(&turn), DVec3::new(1.0, t.cos(), 0.3))
    };
    let sources: Vec<CuboidSource> = (0..71).map(source).collect();
    let groups = [&sources[..1], &sources[1..40], &sources[40..40], &sources[40..]];
    for set in InstructionSet::available() {
        let level = set.detected().expect("available");
        let all = Moments::from_groups(level, &groups, 11);
        assert_eq!(all.len(), groups.len());
        for (group, moments) in groups.iter().zip(all) {
            let own = Moments::from_sources(level, group, 11);
            assert_eq!(moments.parts(11), own.parts(11), "{} tiles with {set:?}", group.len());
            assert_eq!(moments.truncated(7).parts(7), own.parts(7));
        }
    }
}
