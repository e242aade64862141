//! Random edits of point files and baselines: the program uses them or refuses them in words.

use crate::{Sandbox, shipped};

/// Runs of the program with edited files.
const RUNS: u64 = 100;
/// Longest text that the program says about a file.
pub(crate) const LONGEST_MESSAGE: usize = 10_000;

/// Bytes that replace a part of a file.
const PARTS: [&[u8]; 16] = [
    b"",
    b",",
    b"\n",
    b"\r\n",
    b"\"",
    b"nan",
    b"1e999",
    b"-inf",
    b"1e-320",
    b";",
    b"\t",
    b"\0",
    b"\xff\xfe",
    b"x_mm",
    b"1,2,3,4,5\n",
    b"\xef\xbb\xbf",
];

/// A sequence of numbers that looks random (SplitMix64).
pub(crate) struct Sequence(u64);

impl Sequence {
    pub(crate) fn new(seed: u64) -> Sequence {
        Sequence(seed)
    }

    pub(crate) fn below(&mut self, count: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) % count as u64) as usize
    }

    /// The bytes with up to three short parts replaced.
    pub(crate) fn edited(&mut self, bytes: &[u8]) -> Vec<u8> {
        let mut edited = bytes.to_vec();
        for _ in 0..=self.below(3) {
            let start = self.below(edited.len().max(1));
            let end = (start + self.below(6)).min(edited.len());
            edited.splice(start.min(end)..end, PARTS[self.below(PARTS.len())].iter().copied());
        }
        edited
    }
}

/// The same points in each form of a point file, and the options that each needs.
const POINT_FILES: [(&[u8], &[&str]); 5] = [
    (b"x_mm,y_mm,z_mm\n0,0,-4\n1.5,-2,-3\n-1e-3,2e0,5\n0.25,0.125,-4.5\n", &[]),
    (b"x (mm);note;y[m];Z_mm\n0;a;0;-4\n1,5;b;-2;-3\n-1e-3;c;2e0;5\n0,25;d;0,125;-4,5\n", &[]),
    (b"# x y z\n0 0 -4\n1.5 -2 -3\n-1e-3 2e0 5\n0.25 0.125 -4.5\n", &["--unit", "m"]),
    (b"# a comment\nx\ty\tz\n0\t0\t-4\n1.5\t-2\t-3\n# one more\n0.25\t0.125\t-4.5\n", &["--unit", "mm"]),
    (b"x_um y_um z_um\n  0   0 -4000 \n1500\t-2000 -3000\n", &["--unbounded", "nan"]),
];

#[test]
fn edited_point_files_are_used_or_refused_in_words() {
    let mut used = 0;
    for run in 0..RUNS {
        let sandbox = Sandbox::new();
        let (points, options) = POINT_FILES[run as usize % POINT_FILES.len()];
        let edited = Sequence(run).edited(points);
        std::fs::write(sandbox.path("points.csv"), &edited).expect("a writable folder");
        let layout = shipped("single-tile");
        let said = sandbox.run(&[&["field", &layout, "--points", "points.csv", "-o", "out.csv"], options].concat());
        let context = format!("{:?}: {}", String::from_utf8_lossy(&edited), said.stderr);
        assert!([0, 2].contains(&said.status) && said.stderr.len() <= LONGEST_MESSAGE, "{context}");
        assert_eq!(sandbox.files().contains(&"out.csv".to_owned()), said.status == 0, "{context}");
        assert!(!said.stderr.chars().any(|c| c.is_control() && !"\n\t".contains(c)), "{context}");
        used += u64::from(said.status == 0);
    }
    assert!(0 < used && used < RUNS, "{used} of {RUNS} files were used");
}

/// Blocks with each form of a rotation, and the options that each needs.
const BLOCK_FILES: [(&[u8], &[&str]); 3] = [
    (
        b"x_mm,y_mm,z_mm,size_x_mm,size_y_mm,size_z_mm,jx_t,jy_t,jz_t,qx,qy,qz,qw,name\n\
          0,0,0,1,2,1,0,0,1,0.5,0.5,0.5,0.5,a\n5,0,0,1,1,1,0,0.5,0,,,,,b\n",
        &[],
    ),
    (
        b"# blocks\nx;y;z;size_x;size_y;size_z;mx (kA/m);my (kA/m);mz (kA/m);rx_deg;ry_deg;rz_deg\n\
          0,5;0;0;1;2,5;1;0;0;100;10;20;-30,5\n-9;0;1e-3;1;1;1;0;95,5;0;0;0;0\n",
        &["--unit", "mm", "--euler", "XYZ"],
    ),
    (
        b"x_m y_m z_m size_x_m size_y_m size_z_m jx_mT jy_mT jz_mT r11 r12 r13 r21 r22 r23 r31 r32 r33\n\
          0 0 0 1e-3 1e-3 2e-3 0 0 120 0 -1 0 1 0 0 0 0 1\n",
        &[],
    ),
];

#[test]
fn edited_blocks_become_layouts_or_are_refused_in_words() {
    let mut used = 0;
    for run in 0..RUNS {
        let sandbox = Sandbox::new();
        let (blocks, options) = BLOCK_FILES[run as usize % BLOCK_FILES.len()];
        let edited = Sequence(run).edited(blocks);
        std::fs::write(sandbox.path("blocks.csv"), &edited).expect("a writable folder");
        let said = sandbox.run(&[&["import", "blocks.csv", "-o", "film.toml"], options].concat());
        let context = format!("{:?}: {}", String::from_utf8_lossy(&edited), said.stderr);
        assert!([0, 2].contains(&said.status) && said.stderr.len() <= LONGEST_MESSAGE, "{context}");
        assert_eq!(sandbox.files().contains(&"film.toml".to_owned()), said.status == 0, "{context}");
        assert!(!said.stderr.chars().any(|c| c.is_control() && !"\n\t".contains(c)), "{context}");
        if said.status == 0 {
            // What is written is a layout.
            assert_eq!(sandbox.run(&["tiles", "film.toml"]).status, 0, "{context}");
            used += 1;
        }
    }
    assert!(0 < used && used < RUNS, "{used} of {RUNS} files were used");
}

#[test]
fn edited_baselines_are_compared_or_refused_in_words() {
    let layout = std::fs::read_to_string(shipped("published-film")).expect("a layout");
    let baseline = shipped("published-film").replace("published-film.toml", "published.field.csv");
    let baseline = std::fs::read(baseline).expect("a baseline");
    let mut statuses = [0; 3];
    for run in 0..RUNS / 2 {
        let sandbox = Sandbox::new();
        sandbox.write("film.toml", &layout);
        let edited = Sequence(run).edited(&baseline);
        std::fs::write(sandbox.path("published.field.csv"), &edited).expect("a writable folder");
        let said = sandbox.run(&["check", "film.toml"]);
        let context = format!("run {run}: {}{}", said.stdout, said.stderr);
        assert!((0..3).contains(&said.status) && said.stdout.len() <= LONGEST_MESSAGE, "{context}");
        assert_eq!(std::fs::read(sandbox.path("published.field.csv")).expect("a file"), edited, "{context}");
        assert!(!said.stdout.chars().any(|c| c.is_control() && !"\n\t".contains(c)), "{context}");
        statuses[said.status as usize] += 1;
    }
    assert!(statuses[1] + statuses[2] > 0, "no edit was seen");
}
