//! Random edits of every file that a verb reads: the verb uses the file or refuses it in words, and
//! a result is whole, finite and can be read.
//!
//! `MAGSPLICE_FUZZ_RUNS=1000 cargo test --release --test program fuzz_verbs` runs as many edits of
//! each case, and `MAGSPLICE_FUZZ_FIRST=11` begins with case 11.

use std::collections::BTreeMap;
use std::env;
use std::fs::{self, File};
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use crate::fuzz::{LONGEST_MESSAGE, Sequence};
use crate::{RunOutput, Sandbox};

/// Edits of each case in a usual run.
const RUNS: u64 = 3;

/// Time after which a run is ended. An edited number may ask for much work, which is no fault.
const LONGEST: Duration = Duration::from_secs(20);

const FILM: &str = "format = 1
name = \"four squares\"
[ideal]
wavelength_mm = 10
thickness_mm = 1
amplitude_t = 0.12
[volume]
x_mm = [-1, 1]
y_mm = [-1, 1]
z_mm = [-5, -3]
step_mm = 1
reference_mm = [0, 0, -5]
[sensor]
noise_ut = 5
count_ut = 1
gain = 1.01
plates_mm = { z = [0, 0, -0.05] }
[elastomer]
area_mm2 = 400
thickness_mm = 7
youngs_modulus_mpa = 0.1
poisson_ratio = 0.45
[expect]
displacement_rmse_mm = { x = 1 }
amplitude = { min = 0.1 }
field = { file = \"baseline.csv\", within = 1e-9 }
[tolerance]
position_mm = [0.05, { normal = 0.05, within = 0.1 }, { uniform = 0.1 }]
size_mm = { file = \"values.csv\", column = \"size_mm\" }
strength = 0.01
samples = 20
[tolerance.film]
rotation_deg = 0.2
[tolerance.stray_field]
field_ut = [50, 0, 0]
[[tolerance.group]]
name = \"rows\"
tiles = [\"*\"]
rows_along = \"x\"
position_mm = 0.01
[design]
vary = [\"strength\"]
strength_t = { min = 0.05, max = 0.2 }
starts = 1
[kind.square]
size_mm = [3, 3, 1]
strength_t = 0.12
[[tile]]
name = \"a\"
kind = \"square\"
direction_deg = 45
position_mm = [2.5, 2.5, 0.5]
mirror = { axes = [\"x\", \"y\"] }
";

/// Files that a person or another program wrote.
const TABLES: [(&str, &str); 7] = [
    ("film.toml", FILM),
    ("values.csv", "size_mm\n-0.03\n0.02\n0.01\n-0.01\n"),
    ("points.csv", "x_mm,y_mm,z_mm\n0,0,-4\n1.5,-2,-3\n-1e-3,2e0,-5\n"),
    (
        "tiles.csv",
        "tile,part,strength_t,direction_deg\nc1,1,0.118,44\nc2,1,0.121,46\nc3,1,0.12,45\nc4,1,0.119,45\nc5,1,0.12,44\n",
    ),
    ("heights.csv", "x_mm,y_mm,z_mm\n-6,-6,0\n-6,6,0.1\n6,-6,0.1\n6,6,0\n"),
    (
        "blocks.csv",
        "name,x_mm,y_mm,z_mm,size_x_mm,size_y_mm,size_z_mm,jx_t,jy_t,jz_t\na,0,0,0,1,2,1,0,0,1\nb,5,0,0,1,1,1,0,0.5,0\n",
    ),
    ("order.csv", "tile\na\na-mx\na-my\na-mx-my\n"),
];

/// Commands that write the other files from these.
const PREPARATIONS: [&str; 7] = [
    "field film.toml -o baseline.csv",
    "experiment film.toml --step 1mm,1mm,1mm --seed 1 -o moved.csv",
    "tolerance sample film.toml --scan scan.csv -o made.toml",
    "tolerance film.toml --save samples.csv",
    "tolerance film.toml --first 0 --count 10 --save part-1.csv",
    "tolerance film.toml --first 10 --count 10 --save part-2.csv",
    "assign film.toml --measured tiles.csv --starts 1 -o assigned.toml --plan placed.csv",
];

/// Commands, and the file of each that is edited.
const CASES: [(&str, &str); 36] = [
    ("check film.toml --format json", "film.toml"),
    ("check film.toml", "baseline.csv"),
    ("tiles film.toml --format json", "film.toml"),
    ("field film.toml -o out.csv", "film.toml"),
    ("field film.toml --quantity gradient --format json", "film.toml"),
    ("field film.toml --points points.csv -o out.csv", "points.csv"),
    ("compare film.toml --format json", "film.toml"),
    ("compare film.toml --points points.csv --format json", "points.csv"),
    ("decouple film.toml --format json", "film.toml"),
    ("plan film.toml --points points.csv --format json", "points.csv"),
    ("report film.toml --figure field-middle -o out.svg", "film.toml"),
    ("design film.toml -o out.toml", "film.toml"),
    ("tolerance film.toml --format json", "film.toml"),
    ("tolerance film.toml --format json", "values.csv"),
    ("tolerance sample film.toml --scan out.csv -o out.toml", "film.toml"),
    ("tolerance sample film.toml --points points.csv --scan out.csv -o out.toml", "points.csv"),
    ("tolerance merge film.toml part-1.csv part-2.csv --format json", "part-1.csv"),
    ("tolerance film.toml --save out.csv --resume", "out.csv.partial"),
    ("budget film.toml --samples 20 --format json", "film.toml"),
    ("budget film.toml --samples 20", "values.csv"),
    ("forces film.toml --order least --format json", "film.toml"),
    ("forces film.toml --order order.csv", "order.csv"),
    ("assign film.toml --measured tiles.csv --starts 1 -o out.toml --plan out.csv", "tiles.csv"),
    ("assign film.toml --measured tiles.csv --placed placed.csv -o out.toml", "placed.csv"),
    ("assign film.toml --measured tiles.csv --starts 1 -o out.toml", "film.toml"),
    ("diagnose film.toml --scan scan.csv --noise 200uT --format json -o out.toml", "scan.csv"),
    ("diagnose film.toml --scan scan.csv --fit", "film.toml"),
    ("read film.toml moved.csv --format json", "moved.csv"),
    ("read film.toml moved.csv --zero 2 -o out.csv", "film.toml"),
    ("resolution film.toml -o out.csv", "film.toml"),
    ("experiment film.toml --heights heights.csv -o out.csv", "heights.csv"),
    ("experiment film.toml --format json", "film.toml"),
    ("calibrate film.toml moved.csv --format json", "moved.csv"),
    ("calibrate film.toml moved.csv", "moved.csv"),
    ("scan film.toml scan.csv", "scan.csv"),
    ("import blocks.csv -o out.toml", "blocks.csv"),
];

/// The contents of all files before an edit.
fn files() -> BTreeMap<String, Vec<u8>> {
    let sandbox = Sandbox::new();
    for (name, text) in TABLES {
        sandbox.write(name, text);
    }
    for line in PREPARATIONS {
        let said = sandbox.run(&line.split(' ').collect::<Vec<_>>());
        assert_eq!(said.status, 0, "{line}: {}", said.stderr);
    }
    let names = sandbox.files().into_iter();
    let mut files: BTreeMap<String, Vec<u8>> =
        names.map(|name| (name.clone(), fs::read(sandbox.path(&name)).expect("readable"))).collect();
    // A run that was ended after nine samples.
    let samples = String::from_utf8(files["samples.csv"].clone()).expect("text");
    let journal: Vec<&str> = samples.lines().collect();
    files.insert("out.csv.partial".to_owned(), journal[..journal.len().min(12)].join("\n").into_bytes());
    files
}

/// Numbers that replace others.
const NUMBERS: [&str; 20] = [
    "0",
    "-0.0",
    "1",
    "-1",
    "0.5",
    "2",
    "3",
    "100",
    "1e-3",
    "-1e-3",
    "1e-9",
    "1e-300",
    "5e-324",
    "1e9",
    "1e99",
    "-1e100",
    "1e101",
    "1e300",
    "1.7976931348623157e308",
    "9007199254740993",
];

/// The file with up to two of its numbers replaced, or one time in four with random parts replaced.
fn edited(sequence: &mut Sequence, bytes: &[u8]) -> Vec<u8> {
    if sequence.below(4) == 0 {
        return sequence.edited(bytes);
    }
    let mut text = String::from_utf8(bytes.to_vec()).expect("text");
    for _ in 0..=sequence.below(2) {
        let is_part = |c: char| c.is_ascii_digit() || ".eE+-".contains(c);
        let mut numbers: Vec<(usize, usize)> = Vec::new();
        let mut start = 0;
        for (at, c) in text.char_indices().chain([(text.len(), ' ')]) {
            if !is_part(c) {
                if text[start..at].parse::<f64>().is_ok() {
                    numbers.push((start, at));
                }
                start = at + c.len_utf8();
            }
        }
        if numbers.is_empty() {
            return sequence.edited(text.as_bytes());
        }
        let (start, end) = numbers[sequence.below(numbers.len())];
        text.replace_range(start..end, NUMBERS[sequence.below(NUMBERS.len())]);
    }
    text.into_bytes()
}

/// Runs a command of the program. `None` if it takes longer than [`LONGEST`].
fn run(sandbox: &Sandbox, arguments: &[&str]) -> Option<RunOutput> {
    let [out, err] = ["stdout", "stderr"].map(|name| sandbox.path(&format!("../{}-{name}", sandbox.name())));
    let file = |path| File::create(path).expect("a writable folder");
    let mut child = Command::new(env!("CARGO_BIN_EXE_magsplice"))
        .args(arguments)
        .current_dir(sandbox.path("."))
        .stdin(Stdio::null())
        .stdout(file(&out))
        .stderr(file(&err))
        .spawn()
        .expect("the program starts");
    let begun = Instant::now();
    let ended = loop {
        match child.try_wait().expect("a child") {
            Some(status) => break Some(status),
            None if begun.elapsed() > LONGEST => {
                child.kill().expect("a child");
                child.wait().expect("a child");
                break None;
            }
            None => thread::sleep(Duration::from_millis(2)),
        }
    };
    let [stdout, stderr] = [&out, &err].map(|path| {
        let text = String::from_utf8(fs::read(path).expect("readable")).expect("UTF-8 output");
        fs::remove_file(path).expect("a file");
        text
    });
    let status = ended?.code().expect("an exit status");
    Some(RunOutput { status, stdout, stderr, is_check: arguments.first() == Some(&"check") })
}

/// Asserts that a run used its files and that its results are whole, or that it refused them.
fn check(sandbox: &Sandbox, arguments: &[&str], before: &[String], said: &RunOutput, context: &str) {
    let is_obeyed = |c: char| c.is_control() && !"\n\t".contains(c) || ('\u{202a}'..='\u{202e}').contains(&c);
    assert!((0..3).contains(&said.status), "{context}");
    assert!(!said.stderr.contains("panicked") && !said.stderr.contains(is_obeyed), "{context}");
    assert!(said.stderr.len() <= LONGEST_MESSAGE, "{} bytes: {context}", said.stderr.len());
    let mut files = sandbox.files();
    files.retain(|name| !before.contains(name) && !name.ends_with(".partial"));
    if said.status == 2 {
        assert!(files.is_empty(), "{files:?}: {context}");
        // A diagnosis prints why it writes no layout.
        assert!(said.is_check || arguments[0] == "diagnose" || said.stdout.is_empty(), "{context}");
        assert!(said.is_check || said.stderr.starts_with("magsplice: "), "{context}");
        return;
    }
    if arguments.contains(&"json") && !said.stdout.is_empty() {
        assert!(serde_json::from_str::<serde_json::Value>(&said.stdout).is_ok(), "{}{context}", said.stdout);
    }
    let words = said.stdout.split([' ', ',', '\n', '(', ')']);
    let not_finite = words.filter(|word| ["inf", "-inf", "NaN", "nan"].contains(word)).count();
    // Where a sensor resolves nothing, deviations are infinite.
    let may_be_infinite = arguments[0] == "resolution";
    assert!(not_finite == 0 || may_be_infinite, "{}{context}", said.stdout);
    for name in files {
        let text = sandbox.read(&name);
        if name.ends_with(".toml") {
            let again = sandbox.run(&["tiles", &name]);
            assert_eq!(again.status, 0, "{name}: {}{context}", again.stderr);
        } else if name.ends_with(".csv") && !arguments.contains(&"--plan") {
            let mut rows = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(text.as_bytes());
            assert!(rows.records().all(|row| row.is_ok()), "{name}: {text}{context}");
            assert!(!text.contains("inf") || may_be_infinite, "{name}: {text}{context}");
        } else if name.ends_with(".svg") {
            assert!(text.trim_end().ends_with("</svg>"), "{name}: {context}");
        }
    }
}

#[test]
fn edited_files_of_every_verb_are_used_or_refused_in_words() {
    let asked = |name: &str| env::var(name).ok().and_then(|number| number.parse().ok());
    let runs: u64 = asked("MAGSPLICE_FUZZ_RUNS").unwrap_or(RUNS);
    let first = asked("MAGSPLICE_FUZZ_FIRST").unwrap_or(0);
    let files = files();
    for (number, (line, file)) in CASES.into_iter().enumerate().skip(first as usize) {
        let arguments: Vec<&str> = line.split(' ').collect();
        let mut statuses = [0; 4];
        for run_number in 0..runs {
            let sandbox = Sandbox::new();
            let mut sequence = Sequence::new(1_000_003 * number as u64 + run_number);
            let text = edited(&mut sequence, &files[file]);
            for (name, contents) in &files {
                if name != "out.csv.partial" || name == file {
                    let contents = if name == file { &text } else { contents };
                    fs::write(sandbox.path(name), contents).expect("a writable folder");
                }
            }
            let before = sandbox.files();
            match run(&sandbox, &arguments) {
                Some(said) => {
                    let shown = String::from_utf8_lossy(&text);
                    let context = format!("run {run_number} of {line}: {}\n{file}:\n{shown}", said.stderr);
                    check(&sandbox, &arguments, &before, &said, &context);
                    statuses[said.status as usize] += 1;
                }
                None => {
                    assert_eq!(file, "film.toml", "run {run_number} of {line} does not end");
                    statuses[3] += 1;
                }
            }
        }
        println!("| `{line}` | {file} | {} | {} | {} |", statuses[0] + statuses[1], statuses[2], statuses[3]);
    }
}
