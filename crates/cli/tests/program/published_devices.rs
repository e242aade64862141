//! The layouts of published devices.

use super::{Sandbox, shipped};

/// The number for resolution ranks the checkerboard before the rings, as the experiment of Qian, Li
/// and Guo 2026 did: the tenth percentile of the least singular value of all readings over their
/// noise.
#[test]
fn checkerboard_resolves_more_than_rings() {
    let sandbox = Sandbox::new();
    let of = |name: &str| {
        let said = sandbox.run(&["resolution", &shipped(&format!("published/{name}"))]);
        assert_eq!(said.status, 0, "{}", said.stderr);
        assert!(said.stdout.contains("discs as strips, right to 1.00 % one radius away"), "{}", said.stdout);
        let line = said.stdout.lines().find(|line| line.contains("tenth percentile")).expect("a line");
        line.split_whitespace().last().expect("a number").parse::<f64>().expect("a number")
    };
    let [checkerboard, rings] = ["checkerboard", "rings"].map(of);
    assert!((1.3..1.6).contains(&(checkerboard / rings)), "{checkerboard} and {rings} per mm");
}
