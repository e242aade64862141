//! Limits on layouts as a whole: files of attackers and of broken scripts are refused at once, with
//! a message of a few lines.

use std::error::Error;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::sync::LazyLock;
use std::time::{Duration, Instant};

use magsplice_layout::Layout;

const TILE: &str = "position_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n";

/// Largest time for a refused file, over the time for a file of valid tiles with as many bytes.
/// Faulty files take at most 3 times as long. With a search for the line of every fault, which is
/// quadratic, they take 16 times as long.
const LINEAR: f64 = 10.0;

/// Number of valid tiles with which the time of refused files is compared.
const VALID_TILES: usize = 5000;

/// The time to read a file with this number of bytes and valid tiles, on this machine and now.
fn time_of_valid(bytes: usize) -> Duration {
    static SECONDS_PER_BYTE: LazyLock<f64> = LazyLock::new(|| {
        let text = (0..VALID_TILES).fold("format = 1\nname = \"test\"\n".to_owned(), |mut text, n| {
            let tile = TILE.replacen("[0, 0, 0]", &format!("[{}, 0, 0]", 2 * n), 1);
            let _ = write!(text, "[[tile]]\n{tile}");
            text
        });
        let start = Instant::now();
        assert_eq!(Layout::parse(&text, "valid.toml").expect("valid").tiles.len(), VALID_TILES);
        start.elapsed().as_secs_f64() / text.len() as f64
    });
    Duration::from_secs_f64(*SECONDS_PER_BYTE * bytes.max(SHORT_BYTES) as f64)
}

/// Number of bytes that a shorter file counts as: a few lines may make the largest number of tiles.
const SHORT_BYTES: usize = 2 << 20;

/// The message with which a layout of these tables is refused.
#[track_caller]
fn refused(body: &str) -> String {
    let text = format!("format = 1\nname = \"test\"\n{body}");
    let limit = time_of_valid(text.len()).mul_f64(LINEAR);
    let start = Instant::now();
    let message = Layout::parse(&text, "test.toml").expect_err("the layout is faulty").to_string();
    assert!(start.elapsed() < limit, "took {:?}, must take less than {limit:?}", start.elapsed());
    assert!(message.lines().count() <= 21 && message.len() < 20_000, "{} bytes: {message:.2000}", message.len());
    let is_printable = |c: char| c == '\n' || !(c.is_control() || c == '\u{2028}' || c == '\u{202e}');
    assert!(message.chars().all(is_printable), "{message:?}");
    message
}

#[track_caller]
fn refused_with(body: &str, expected: &str) {
    let message = refused(body);
    assert!(message.contains(expected), "{expected:?} is not in {message}");
}

fn lattice(x: &str) -> String {
    format!("[[lattice]]\nstart_mm = [0, 0, 0]\nheight_mm = 1\nstrength_t = 1\nx = [{x}]\n")
}

#[test]
fn tiles_of_all_tables_together_are_limited() {
    let grids = |counts: [[usize; 3]; 2]| -> String {
        let table =
            |count: &[usize; 3]| format!("[[tile]]\n{TILE}grid = {{ count = {count:?}, pitch_mm = [2, 2, 2] }}\n");
        counts.iter().map(table).collect()
    };
    refused_with(
        &grids([[100, 1, 1], [1000, 2000, 2]]),
        "tile \"tile-2\": grid.count = [1000, 2000, 2] makes 4000000 tiles, must be at most 4000000 tiles in the whole \
         layout, including the 100 before it",
    );
    // Entries that are too large each do not use up the room of others.
    assert_eq!(refused(&grids([[4001, 1000, 1], [100, 1, 1]])).lines().count(), 1);
    for (repetition, expected) in [
        (
            "grid = { count = [90000, 90000, 1], pitch_mm = [1, 1, 1] }",
            "makes 8100000000 tiles, must be at most 4000000",
        ),
        ("grid = { count = [9000000000, 9000000000, 9], pitch_mm = [1, 1, 1] }", "must be at most 4000000 tiles"),
        (
            "grid = { count = [1000000, 1, 1], pitch_mm = [2, 2, 2] }\nmirror = { axes = [\"x\", \"y\", \"z\"], at_mm = [-1, -1, -1] }",
            "grid and mirror make 8000000 tiles, must be at most 4000000",
        ),
    ] {
        refused_with(&format!("[[tile]]\n{TILE}{repetition}\n"), expected);
    }
}

#[test]
fn cells_of_lattices_are_limited() {
    let long = "{ widths_mm = [1], pattern = [1], times = 4000000 }";
    refused_with(&lattice(&[long; 200].join(", ")), "has 800000000 x 800000000 cells, must be at most 4000000 tiles");
    refused_with(
        &lattice("{ widths_mm = [1], pattern = [1], times = 9000000000000000000 }"),
        "must be at most 4000000",
    );
    // Cells without a tile count too.
    let body = lattice("{ widths_mm = [1, 1], pattern = [1, 0] }, { widths_mm = [1], pattern = [0], times = 1998 }");
    refused_with(
        &format!("[[tile]]\n{TILE}{body}"),
        "has 2000 x 2000 cells, must be at most 4000000 tiles in the whole layout, including the 1 before it",
    );
}

#[test]
fn empty_stretches_of_lattices_are_refused() {
    let body =
        lattice("{ widths_mm = [], pattern = [], times = 9000000000000000000 }, { widths_mm = [1], pattern = [1] }");
    refused_with(&body, "x[0] has no widths_mm, must have at least one interval");
    refused_with(&lattice(""), "x has no sections, must have at least one interval");
    refused_with(&lattice("{ widths_mm = [1], pattern = [1], times = 0 }"), "x[0].times = 0, must be at least 1");
}

#[test]
fn names_are_short_and_fit_on_a_line() {
    let long = "a".repeat(65_536);
    let name = |name: &str| format!("[[tile]]\nname = \"{name}\"\n{TILE}");
    refused_with(&name(&long), "name = \"aaaaaaaaaaaa");
    refused_with(&name(&long), "...\" has 65536 bytes, must have at most 200");
    refused_with(
        &format!("[kind.{long}]\nsize_mm = [1, 1, 1]\n{}", name("a")),
        "has 65536 bytes, must have at most 200",
    );
    refused_with(&lattice("").replace("start_mm", &format!("name = \"{long}\"\nstart_mm")), "has 65536 bytes");
    refused_with(&format!("[[tile]]\nkind = \"{long}\"\nposition_mm = [0, 0, 0]\n"), "kind = \"aaaa");
    for (escape, code) in
        [("\\n", "000A"), ("\\u001b[2J", "001B"), ("\\u0085", "0085"), ("\\u2028", "2028"), ("\\u202e", "202E")]
    {
        let expected = format!("has the character U+{code}, must have no control characters and line breaks");
        refused_with(&name(escape), &expected);
        refused_with(&format!("[kind.\"{escape}\"]\nsize_mm = [1, 1, 1]\n{}", name("a")), &expected);
        refused(&format!("[[tile]]\nkind = \"{escape}\"\nposition_mm = [0, 0, 0]\n"));
        let title = Layout::parse(&format!("format = 1\nname = \"{escape}\"\n[[tile]]\n{TILE}"), "test.toml");
        assert!(title.expect_err("the title is faulty").to_string().contains(&expected));
    }
    // A repetition may make a name too long.
    let edge = "a".repeat(200);
    let text = format!("format = 1\nname = \"{edge}\"\n{}", name(&edge));
    assert_eq!(Layout::parse(&text, "test.toml").expect("names of 200 bytes").tiles[0].name, edge);
    refused_with(&format!("{}mirror = {{ axes = [\"x\"], at_mm = [9, 0, 0] }}\n", name(&edge)), "has 203 bytes");
}

#[test]
fn names_of_all_tiles_together_are_limited() {
    let long = "a".repeat(190);
    let body =
        format!("[[tile]]\nname = \"{long}\"\n{TILE}grid = {{ count = [1000, 1200, 1], pitch_mm = [2, 2, 2] }}\n");
    refused_with(&body, "makes 276000000 bytes of names in the layout, must be at most 268435456: use shorter names");
}

#[test]
fn faults_are_counted_after_the_first_twenty() {
    let mut body = String::new();
    for index in 0..20_000 {
        let _ = writeln!(
            body,
            "[[tile]]\nname = \"t{index}\"\nposition_mm = [nan, nan, nan]\nsize_mm = [0, -1, nan]\npolarization_t = [nan, 0, 0]\nkind = \"k{index}\""
        );
    }
    let message = refused(&body);
    assert!(message.ends_with("\ntest.toml: layout: and 19980 more"), "{message}");
    assert!(message.starts_with("test.toml: line 3: tile \"t0\": kind = \"k0\", must be declared"), "{message}");
    // The list of declared kinds is short too, and searching for kinds that no tile uses is linear.
    for index in 0..20_000 {
        let _ = writeln!(body, "[kind.j{index}]\nsize_mm = [1, 1, 1]\n");
    }
    refused_with(&body, "j0, j1, j10, j100, j1000, j10000, j10001, ");
    refused_with(&body, "j10013, and 19980 more)");
    refused_with(
        &format!("[[tile]]\n{TILE}\n").repeat(2).replace("[[tile]]", "[[tile]]\nname = \"a\"").repeat(20_000),
        "tile \"a\": 40000 tiles have this name",
    );
}

#[test]
fn findings_are_counted_after_the_first_twenty() {
    let mut body = format!("[[tile]]\n{TILE}");
    for index in 0..20_000 {
        let _ = writeln!(body, "[kind.k{index}]\nsize_mm = [1, 1, 1]");
    }
    let findings =
        Layout::parse(&format!("format = 1\nname = \"test\"\n{body}"), "test.toml").expect("a layout").findings;
    assert_eq!(findings.len(), 21);
    assert!(findings[20].message.starts_with("19980 more kinds, such as: kind \"k"), "{}", findings[20].message);
}

#[test]
fn tiles_in_one_place_are_refused_without_examining_every_pair() {
    // Beyond the digits of numbers all images are in one place. The round-off there is no excuse.
    let grid = "grid = { count = [4000, 1, 1], pitch_mm = [2, 2, 2] }\n";
    let body =
        format!("[[tile]]\n{TILE}{}mirror = {{ axes = [\"x\"], at_mm = [1e300, 0, 0] }}\n", grid.replace("4000", "40"));
    refused_with(&body, "overlaps the image mirrored along x of tile");
    // Bars side by side, oblique to the axes, do not overlap, but all of their bounding boxes meet.
    let bars = format!(
        "[[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [1e6, 1, 1]\npolarization_t = [0, 0, 1]\n{grid}\
         rotation = {{ axis = [0, 0, 1], angle_deg = 45 }}\n"
    );
    let error = Layout::parse(&format!("format = 1\nname = \"bars\"\n{bars}"), "bars.toml").expect_err("too many");
    let message = "more than 5064000 pairs of tiles may overlap, too many to examine";
    assert!(error.to_string().contains(message), "{error}");
}

#[test]
fn tiny_volumes_and_steps_are_refused() {
    let volume = |range: &str, step: &str| {
        format!("[volume]\nx_mm = {range}\ny_mm = {range}\nz_mm = {range}\nstep_mm = {step}\n[[tile]]\n{TILE}")
    };
    refused_with(&volume("[0, 1e-200]", "1e-210"), "makes 1.000e30 points");
    let message = refused(&volume("[0, 1e-200]", "1e-210"));
    let least = message.split("a step of at least ").nth(1).expect("a step").split(' ').next().expect("a number");
    assert!((2.1e-203..2.4e-203).contains(&least.parse().expect("a number")), "{least}");
    refused_with(&volume("[0, 1e-300]", "1e-300"), "x_mm = [0e0, 1e-300] is 1e-300 long, must be 0 or at least");
    refused_with(&volume("[0, 5e-324]", "5e-324"), "must be 0 or at least");
    refused_with(&volume("[-1e300, 1e300]", "1e-300"), "makes inf points");
    refused_with(&volume("[0, 1]", "[1e-300, 1, 1]"), "must make at most 1e8: use a step of at least 0.00");
}

#[test]
fn points_of_a_design_are_limited() {
    let body = format!(
        "[ideal]\nwavelength_mm = 10\nthickness_mm = 1\namplitude_t = 0.1\n[volume]\nx_mm = [-2, 2]\ny_mm = [-2, 2]\n\
         z_mm = [-5, -3]\nstep_mm = 1\n[design]\nvary = [\"direction\"]\nstep_mm = 1e-300\n[[tile]]\n{TILE}"
    );
    refused_with(&body, "points in the working volume, must make at most 1e5");
    refused_with(&body.replace("1e-300", "0.05"), "step_mm = 0.05 makes 2.690e5 points");
    let text = format!("format = 1\nname = \"test\"\n{}", body.replace("1e-300", "0.1"));
    Layout::parse(&text, "test.toml").expect("35 301 points are no mistake");
}

#[test]
fn syntax_errors_are_short_and_printable() {
    refused_with("# \u{1b}[2J\u{7}", "TOML parse error");
    refused(&format!("key = {}", "[".repeat(1 << 20)));
    refused(&format!("{} = 1", "k".repeat(1 << 20)));
    refused(&format!("key = \"{}", "x".repeat(1 << 20)));
    refused_with(&"#".repeat(65 << 20), "bytes, must have at most 67108864");
}

#[cfg(unix)]
#[test]
fn reading_a_device_without_end_ends() {
    let error = Layout::read("/dev/zero").expect_err("no layout").to_string();
    assert_eq!(error, "cannot read /dev/zero: it has more than 67108864 bytes, too many for a layout");
}

#[test]
fn files_are_read_up_to_64_mib() {
    let file = tempfile::NamedTempFile::new().expect("a file");
    let mut text = format!("format = 1\nname = \"test\"\n[[tile]]\n{TILE}#");
    text.extend(std::iter::repeat_n(' ', (64 << 20) - text.len()));
    fs::write(file.path(), &text).expect("written");
    assert_eq!(Layout::read(file.path()).expect("valid").tiles.len(), 1);
    text.push(' ');
    fs::write(file.path(), &text).expect("written");
    for refused in [Layout::read(file.path()), Layout::parse(&text, "test.toml")] {
        let message = refused.expect_err("too large").to_string();
        assert!(message.contains("67108864"), "{message}");
    }
}

#[test]
fn error_of_a_missing_file_has_a_source() {
    let error = Layout::read(Path::new("no/such/layout.toml")).expect_err("missing");
    assert!(error.source().is_some_and(|source| source.is::<std::io::Error>()));
}
