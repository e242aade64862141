//! The layouts of published devices.

use super::{Sandbox, rows, shipped};

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

/// The fit of the eFlesh pad leaves what its header states, with the order and the orientation of
/// the chips that fit best.
#[test]
fn eflesh_pad_leaves_the_stated_residual() {
    let sandbox = Sandbox::new();
    let places = ["7.594,7.594", "-7.594,7.594", "-7.594,-7.594", "7.594,-7.594", "0,1.406"];
    let readings_ut = [
        [1243.0, -1870.0, 10_110.0],
        [1569.0, -3458.0, 9765.0],
        [-662.0, 830.0, 7647.0],
        [-917.0, 836.0, 8673.0],
        [214.0, -605.0, 7306.0],
    ];
    let layout = shipped("published/eflesh-pad");
    let field =
        |place: &str| rows(&sandbox.run(&["field", &layout, &format!("--at={place},-17.66")]).stdout)[0].clone();
    let errors_mt: Vec<f64> = (places.iter().zip(readings_ut))
        .flat_map(|(place, read_ut)| {
            let b = field(place);
            (0..3).map(move |axis| 1e-3 * read_ut[axis] - 1e3 * b[3 + axis])
        })
        .collect();
    let rms = (errors_mt.iter().map(|error| error * error).sum::<f64>() / 15.0).sqrt();
    let largest = errors_mt.iter().fold(0.0_f64, |largest, error| largest.max(error.abs()));
    assert!((1.09..1.15).contains(&rms) && (2.35..2.45).contains(&largest), "{rms} {largest} mT");
}

/// A preset gives every disc its errors as a whole. Errors of its size are refused.
#[test]
fn presets_are_errors_of_whole_discs() {
    let sandbox = Sandbox::new();
    let film = "format = 1\nname = \"disc\"\n[ideal]\nwavelength_mm = 10\nthickness_mm = 1\namplitude_t = 0.12\n[volume]\n\
                x_mm = [-1, 1]\ny_mm = [-1, 1]\nz_mm = [-5, -3]\nstep_mm = 1\n[[tile]]\nname = \"d\"\nshape = \"disc\"\n\
                diameter_mm = 4\nheight_mm = 1\nposition_mm = [0, 0, 0.5]\npolarization_t = [0, 0, 1]\n";
    sandbox.write("disc.toml", film);
    let group = "[[tolerance.group]]\nname = \"d\"\ntiles = [\"d-s*\"]\nposition_mm = 0.05\nrotation_deg = 0.5\nstrength = 0.01\n";
    sandbox.write("group.toml", &format!("{film}{group}"));
    for verb in ["tolerance", "budget"] {
        let by_preset = sandbox.run(&[verb, "disc.toml", "--preset", "workshop"]);
        assert_eq!(by_preset.status, 0, "{}", by_preset.stderr);
        let by_group = sandbox.run(&[verb, "group.toml"]);
        let of = |said: &str| said.lines().skip(1).map(str::to_owned).collect::<Vec<_>>();
        let lines = of(&by_preset.stdout);
        assert!(lines.len() > 8 && lines == of(&by_group.stdout), "{verb}: {lines:?}");
        sandbox.run(&[verb, "disc.toml", "--preset", "by-hand"]).refuses("\"d\" has errors of size_mm");
    }
}
