//! `scan` of readings whose units, axes, columns or order are not as stated.

use std::fmt::Write;

use crate::scan::{field, write};
use crate::{Sandbox, rows, shipped};

/// An offset makes up for a film of the same wavelength with other tiles.
#[test]
fn offsets_that_no_sensor_has_are_named() {
    let sandbox = Sandbox::new();
    let other = std::fs::read_to_string(shipped("designed-stock")).expect("readable");
    let other = other.split("\n\n").filter(|part| !part.contains("[sensor]")).collect::<Vec<_>>().join("\n\n");
    sandbox.write("other.toml", &other);
    write(&sandbox, "x_mm,y_mm,z_mm,bx_t,by_t,bz_t", &field(&sandbox));
    let said = sandbox.run(&["scan", "other.toml", "scan.csv"]);
    assert!(said.stderr.contains("the fitted offset is 5"), "{}{}", said.stderr, said.stdout);
    assert!(
        said.stderr.contains(" uT, several times the field of the earth: another magnet is near"),
        "{}",
        said.stderr
    );
}

/// Units of positions of a film made by hand, whose errors look like another strength, and
/// positions that count from a corner of the scan.
#[test]
fn units_of_positions_are_named_for_films_made_by_hand() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("[sensor]\npart = \"MLX90393\"");
    let sample = ["tolerance", "sample", &film, "--preset", "by-hand", "--scan", "made.csv"];
    assert_eq!(sandbox.run(&sample).status, 0);
    let made = rows(&sandbox.read("made.csv"));
    for (unit, length, origin) in [("centimetres", 10.0, 0.0), ("inches", 25.4, 7.0), ("metres", 1e3, 0.0)] {
        let scaled = |row: &Vec<f64>| -> Vec<f64> {
            let (at, b) = row.split_at(3);
            at.iter().map(|x| (x + origin) / length).chain(b.iter().copied()).collect()
        };
        write(&sandbox, "x_mm,y_mm,z_mm,bx_t,by_t,bz_t", &made.iter().map(scaled).collect::<Vec<_>>());
        let said = sandbox.run(&["scan", "scan.csv", "--layout", &film]);
        said.refuses(&format!("times as large: the positions are in {unit}, must be in mm"));
    }
}

/// One plane with z counted downwards is no plane of a sensor with reversed axes. Positions in
/// another unit are an error, in `diagnose` too.
#[test]
fn planes_counted_downwards_and_positions_in_another_unit_are_named() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("");
    let (names, field) = ("x_mm,y_mm,z_mm,bx_t,by_t,bz_t", field(&sandbox));
    let plane = |sign: f64| -> Vec<Vec<f64>> {
        let nearest = field.iter().filter(|row| row[2] == -3.0);
        nearest.map(|row| vec![row[0], row[1], 3.0, row[3], row[4], sign * row[5]]).collect()
    };
    write(&sandbox, names, &plane(1.0));
    let said = sandbox.run(&["scan", "scan.csv", "--layout", &film]);
    assert!(said.stdout.contains("axes of the positions: z is reversed: change their columns"), "{}", said.stdout);
    assert!(!said.stdout.contains("axes of the sensor"), "{}", said.stdout);
    let said = sandbox.run(&["diagnose", &film, "--scan", "scan.csv", "--noise", "1uT"]);
    said.refuses("axes of the positions: z is reversed: change their columns");
    let across: Vec<Vec<f64>> =
        field.iter().map(|row| vec![row[0], row[1], -row[2], row[3], row[4], -row[5]]).collect();
    write(&sandbox, names, &across);
    let said = sandbox.run(&["scan", "scan.csv", "--layout", &film]);
    assert!(
        said.stderr.contains("the sensor was on the other side of the film than [volume]: the film is turned over")
    );
    for (unit, length) in [("inches", 25.4), ("metres", 1e3), ("micrometres", 1e-3)] {
        let scaled =
            |row: &Vec<f64>| row.iter().enumerate().map(|(n, v)| if n < 3 { v / length } else { *v }).collect();
        write(&sandbox, names, &field.iter().map(scaled).collect::<Vec<_>>());
        for verb in [&["scan", &film, "scan.csv"][..], &["diagnose", &film, "--scan", "scan.csv", "--noise", "1uT"]] {
            let said = sandbox.run(verb);
            said.refuses(&format!("times as large: the positions are in {unit}, must be in mm; the unit stands in"));
        }
    }
}

/// The scan of a film that is 3 % stronger, with exchanged axes, a turned sensor, the coordinates
/// of a stage, z counted downwards, and missing cells: the strength is found, and the cause is
/// named.
#[test]
fn axes_and_places_other_than_stated_are_found_and_named() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("");
    type Change = fn(&[f64]) -> Vec<f64>;
    let changes: [(Change, &str); 6] = [
        (
            |row| vec![row[0], row[1], row[2], row[4], row[3], row[5]],
            "axes of the sensor: x and y are exchanged: name the columns of the field by, bx, bz",
        ),
        (
            |row| vec![row[0], row[1], row[2], row[3], row[4], -row[5]],
            "axes of the sensor: z is reversed: set gain = [1, 1, -1] in [sensor]",
        ),
        (|row| vec![row[0], row[1], row[2], -row[3], -row[4], row[5]], "180.0"),
        (
            |row| vec![row[0], row[1], row[2], row[4], row[5], row[3]],
            "its rotation is that of exchanged axes: x, y, z are y, z, x: if it was not mounted so, name the columns of \
             the field by, bz, bx",
        ),
        (|row| vec![row[0] + 102.0, row[1] + 55.0, row[2] + 5.0, row[3], row[4], row[5]], "-102.0"),
        (
            |row| vec![row[0], row[1], 30.0 - row[2], row[3], row[4], row[5]],
            "axes of the positions: z is reversed: change their columns",
        ),
    ];
    let field = field(&sandbox);
    for (change, named) in changes {
        let stronger = |row: &Vec<f64>| -> Vec<f64> {
            let values = row.iter().enumerate().map(|(n, value)| if n < 3 { *value } else { 1.03 * value });
            change(&values.collect::<Vec<f64>>())
        };
        write(&sandbox, "x_mm,y_mm,z_mm,bx_t,by_t,bz_t", &field.iter().map(stronger).collect::<Vec<_>>());
        let said = sandbox.run(&["scan", "scan.csv", "--layout", &film]);
        assert_eq!((said.status, said.stderr.as_str()), (0, ""), "{named}");
        assert!(said.stdout.contains(named), "{named}: {}", said.stdout);
        let row = said.stdout.lines().find(|line| line.contains("strength / strength")).expect("a row");
        assert!(row.ends_with(" 1.030000"), "{named}: {row}");
    }
    // Missing readings: NaN, and empty cells.
    let mut text = "x_mm,y_mm,z_mm,bx_t,by_t,bz_t\n".to_owned();
    for (index, row) in field.iter().enumerate() {
        let cells = match index % 50 {
            0 => "NaN,NaN,NaN".to_owned(),
            1 => format!("{:?},,{:?}", row[3], row[5]),
            _ => format!("{:?},{:?},{:?}", row[3], row[4], row[5]),
        };
        let _ = writeln!(text, "{:?},{:?},{:?},{cells}", row[0], row[1], row[2]);
    }
    sandbox.write("scan.csv", &text);
    let said = sandbox.run(&["scan", "scan.csv", "--layout", &film]);
    assert!(said.stdout.contains("incomplete, excluded                             18"), "{}", said.stdout);
    assert!(
        said.stderr.contains("scan.csv: line 2: excluded as incomplete: a component is missing"),
        "{}",
        said.stderr
    );
}

/// A film of another pattern, and readings in another unit than their columns say.
#[test]
fn fits_that_are_hardly_those_of_the_film_are_named() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("");
    let scaled = |factor: f64| -> Vec<Vec<f64>> {
        let rows = field(&sandbox);
        rows.iter().map(|row| row[..3].iter().copied().chain(row[3..6].iter().map(|b| factor * b)).collect()).collect()
    };
    write(&sandbox, "x_mm,y_mm,z_mm,bx_t,by_t,bz_t", &scaled(3.0));
    let said = sandbox.run(&["scan", "scan.csv", "--layout", &film]);
    let strength = "scan.csv: the fitted strength is 3.000000 times the strength of the layout";
    assert!(said.stderr.contains(strength), "{}", said.stderr);
    write(&sandbox, "x_mm,y_mm,z_mm,bx_mt,by_mt,bz_mt", &scaled(1e4));
    let unit = "scan.csv: the readings times 0.1 fit the film: they have another unit, such as gauss in a column of mT";
    sandbox.run(&["scan", "scan.csv", "--layout", &film]).refuses(unit);
    for options in [&[][..], &["--fit", "--preset", "workshop"]] {
        let diagnose = ["diagnose", &film, "--scan", "scan.csv", "--noise", "5uT"];
        sandbox.run(&[&diagnose, options].concat()).refuses(unit);
    }
    sandbox.published_with("[sensor]\nnoise_ut = 1");
    let lines: Vec<Vec<f64>> = field(&sandbox)
        .iter()
        .enumerate()
        .map(|(n, row)| {
            let error = if n % 2 == 0 { 1e-5 } else { -1e-5 };
            row[..3].iter().copied().chain(row[3..6].iter().map(|b| b + error)).collect()
        })
        .collect();
    write(&sandbox, "x_mm,y_mm,z_mm,bx_t,by_t,bz_t", &lines);
    let said = sandbox.run(&["scan", "scan.csv", "--layout", "film.toml"]);
    assert!(said.stderr.contains("times the noise of the sensor: the film differs from the layout"), "{}", said.stderr);
}

/// The lines of a scan turned by an angle about z, and those of the field.
fn turned(lines: &[Vec<f64>], angle_deg: f64) -> Vec<Vec<f64>> {
    let (sin, cos) = angle_deg.to_radians().sin_cos();
    let turn = |x: f64, y: f64| [cos * x - sin * y, sin * x + cos * y];
    let of = |row: &Vec<f64>| [&turn(row[0], row[1])[..], &[row[2]], &turn(row[3], row[4]), &[row[5]]].concat();
    lines.iter().map(of).collect()
}

/// A film that lies turned on the stage. With errors of every tile the turn leaves their field,
/// more than half of the residual, and the errors that are expected then explain it.
#[test]
fn films_turned_on_the_stage_are_named() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("[sensor]\nnoise_ut = 5");
    let names = "x_mm,y_mm,z_mm,bx_t,by_t,bz_t";
    write(&sandbox, names, &turned(&field(&sandbox), 12.0));
    let named = "if it was turned by 12.0 deg about z against the positions: turn positions and readings by -12.0 deg";
    sandbox.run(&["scan", &film, "scan.csv"]).refuses(named);
    sandbox.run(&["diagnose", &film, "--scan", "scan.csv"]).refuses(named);
    let sample = ["tolerance", "sample", &film, "--preset", "by-hand", "--scan", "made.csv", "-o", "made.toml"];
    assert_eq!(sandbox.run(&sample).status, 0);
    write(&sandbox, names, &turned(&rows(&sandbox.read("made.csv")), 10.0));
    let diagnose = ["diagnose", &film, "--scan", "scan.csv", "--preset", "by-hand"];
    sandbox.run(&diagnose).refuses("deg about z against the positions: turn positions and readings by");
}

/// Two columns with the same values, a stuck axis, and two equal coordinates are causes that the
/// fit does not show. The same columns are no fault where the scan fits.
#[test]
fn columns_that_no_scan_has_are_named() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("");
    let field = field(&sandbox);
    let changed = |change: fn(&mut [f64])| -> Vec<Vec<f64>> {
        let mut lines: Vec<Vec<f64>> = field.iter().step_by(4).cloned().collect();
        lines.iter_mut().for_each(|line| change(line));
        lines
    };
    type Change = fn(&mut [f64]);
    let cases: [(Change, &str); 3] = [
        (|line| line[4] = line[3], "bx and by are equal in all readings"),
        (|line| line[5] = 1e-3, "bz is 1 mT in all readings"),
        (|line| line[1] = line[0], "x and y of all positions are equal"),
    ];
    for (change, cause) in cases {
        write(&sandbox, "x_mm,y_mm,z_mm,bx_t,by_t,bz_t", &changed(change));
        sandbox.run(&["scan", &film, "scan.csv"]).refuses(cause);
    }
    sandbox.run(&["diagnose", &film, "--scan", "scan.csv", "--noise", "10uT"]).refuses("x and y of all positions");
    let mut stuck = changed(|_| ());
    let (half, count) = (stuck.len() / 2, stuck.len());
    let reading_t = stuck[half][4];
    stuck[half..].iter_mut().for_each(|line| line[4] = reading_t);
    write(&sandbox, "x_mm,y_mm,z_mm,bx_t,by_t,bz_t", &stuck);
    let cause = format!("mT in {} successive readings, from reading {} on", count - half, half + 1);
    sandbox.run(&["scan", &film, "scan.csv"]).refuses(&cause);
    sandbox.run(&["diagnose", &film, "--scan", "scan.csv", "--noise", "10uT"]).refuses(&cause);
    let mut still = field.clone();
    let half = still.len() / 2;
    let x_mm = still[half][0];
    still[half..].iter_mut().for_each(|line| line[0] = x_mm);
    let first = still.iter().rposition(|line| line[0] != x_mm).expect("other positions") + 2;
    write(&sandbox, "x_mm,y_mm,z_mm,bx_t,by_t,bz_t", &still);
    let cause = format!("x has one value from reading {first} on: the stage or its log stood still");
    sandbox.run(&["scan", &film, "scan.csv"]).refuses(&cause);
    sandbox.run(&["diagnose", &film, "--scan", "scan.csv", "--noise", "10uT"]).refuses(&cause);
    // On the diagonal bx and by are equal, and the film has no other reading there.
    let diagonal: Vec<Vec<f64>> = field.into_iter().filter(|line| line[0] == line[1]).collect();
    write(&sandbox, "x_mm,y_mm,z_mm,bx_t,by_t,bz_t", &diagonal);
    let said = sandbox.run(&["scan", &film, "scan.csv", "--fit", "strength,offset"]);
    assert_eq!(said.status, 0, "{}", said.stderr);
}

/// Readings that are a row late, a column of positions that is, lines that were scanned to and fro,
/// and a log that was frozen. The axes of the sensor have noise, so that no readings are equal.
#[test]
fn readings_in_another_order_are_named() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("[sensor]\nnoise_ut = 2");
    let sample = ["tolerance", "sample", &film, "--preset", "jig", "--scan", "made.csv"];
    assert_eq!(sandbox.run(&sample).status, 0);
    let made = rows(&sandbox.read("made.csv"));
    let scan = |change: &dyn Fn(&mut [Vec<f64>])| {
        let mut lines = made.clone();
        change(&mut lines);
        write(&sandbox, "x_mm,y_mm,z_mm,bx_t,by_t,bz_t", &lines);
        sandbox.run(&["scan", &film, "scan.csv"])
    };
    assert_eq!(scan(&|_| ()).status, 0);
    let moved = |lines: &mut [Vec<f64>], columns: std::ops::Range<usize>, rows: usize| {
        for row in (rows..lines.len()).rev() {
            let earlier = lines[row - rows][columns.clone()].to_vec();
            lines[row][columns.clone()].copy_from_slice(&earlier);
        }
    };
    scan(&|lines| moved(lines, 3..6, 1))
        .refuses("the readings fit the positions 1 row earlier than their own far better");
    let diagnose = ["diagnose", &film, "--scan", "scan.csv"];
    sandbox.run(&diagnose).refuses("the readings fit the positions 1 row earlier than their own far better");
    scan(&|lines| moved(lines, 0..3, 2))
        .refuses("the readings fit the positions 2 rows later than their own far better");
    scan(&|lines| moved(lines, 2..3, 1)).refuses("the readings fit z of the positions 1 row later than their own");
    // Nine lines along y of five heights each, for each x.
    let to_and_fro = |lines: &mut [Vec<f64>]| {
        lines.chunks_mut(45).skip(1).step_by(2).flatten().for_each(|line| line[1] = -line[1]);
    };
    scan(&to_and_fro).refuses("the readings of every second line of the scan fit y in reversed order far better");
    let frozen = scan(&|lines| {
        let last = lines[300][3..].to_vec();
        lines[300..].iter_mut().for_each(|line| line[3..].copy_from_slice(&last));
    });
    frozen.refuses("rows 301 to 405 are equal in all components of the readings, at different positions: the log was");
    // Columns of different units are named before the fit fails.
    sandbox.write("scan.csv", &sandbox.read("made.csv").replace("z_mm", "z_cm"));
    let said = sandbox.run(&["scan", &film, "scan.csv"]);
    assert!(said.stderr.contains("the coordinates have different units: x_mm, y_mm, z_cm"), "{}", said.stderr);
}

/// Readings clipped below the stated range fit exchanged axes or another place.
#[test]
fn readings_that_share_an_extreme_are_the_cause_of_a_misfit() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("");
    let clipped = |row: &Vec<f64>| -> Vec<f64> { [&row[..5], &[row[5].clamp(-2.5e-3, 2.5e-3)]].concat() };
    write(&sandbox, "x_mm,y_mm,z_mm,bx_t,by_t,bz_t", &field(&sandbox).iter().map(clipped).collect::<Vec<_>>());
    for verb in [&["scan", &film, "scan.csv"][..], &["diagnose", &film, "--scan", "scan.csv", "--noise", "1uT"]] {
        let said = sandbox.run(verb);
        said.refuses("the scan cannot be fitted, and ");
        said.refuses("different readings share the largest bz");
    }
}

/// Magnitudes, and readings in gauss beyond the range of the part.
#[test]
fn magnitudes_and_readings_beyond_the_range_are_named() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("[sensor]\npart = \"MLX90393\"");
    let all = field(&sandbox);
    let names = "x_mm,y_mm,z_mm,bx_t,by_t,bz_t";
    let changed = |of: fn(f64) -> f64| -> Vec<Vec<f64>> {
        all.iter().map(|row| row[..3].iter().copied().chain(row[3..].iter().map(|b| of(*b))).collect()).collect()
    };
    write(&sandbox, names, &changed(f64::abs));
    sandbox
        .run(&["scan", &film, "scan.csv"])
        .refuses("no component of a reading is negative: magnitudes have lost the signs");
    write(&sandbox, names, &changed(|b| 10.0 * b));
    sandbox
        .run(&["scan", &film, "scan.csv"])
        .refuses("the readings times 0.1 fit the film: they have another unit, such as gauss");
}
