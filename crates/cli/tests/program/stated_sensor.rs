//! Layouts with `[sensor]` and `[elastomer]`: `experiment`, `read`, `resolution` and the C header.

use crate::{Sandbox, rows};

const LAYER: &str = "[elastomer]\narea_mm2 = 400\nthickness_mm = 7\nyoungs_modulus_mpa = 0.1\npoisson_ratio = 0.4\n";

/// A table by the names of its columns.
struct Columns {
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Columns {
    fn new(text: &str) -> Columns {
        let names = text.lines().next().expect("a line of names").split(',').map(str::to_owned).collect();
        Columns { names, rows: rows(text) }
    }

    fn of(&self, name: &str) -> Vec<f64> {
        let index = self.names.iter().position(|known| known == name).unwrap_or_else(|| panic!("no column {name}"));
        self.rows.iter().map(|row| row[index]).collect()
    }
}

fn experiment(sandbox: &Sandbox, options: &[&str]) -> Columns {
    let said = sandbox.run(&[&["experiment", "film.toml"], options].concat());
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    Columns::new(&said.stdout)
}

/// A sensor whose plates, axes and gains are all off: what it reads tells the displacement all the
/// same.
const CROOKED: &str = "[sensor]\nplates_mm = { x = [0.1, 0, 0], z = [0, 0.1, -0.05] }\nactive_area_mm = [0.2, 0.1]\n\
                       rotation = { axis = [1, 2, 3], angle_deg = 3 }\ngain = [1.02, 0.98, 1.05]\noffset_ut = [100, -50, 30]\n";

#[test]
fn experiments_tell_displacements_and_forces() {
    let sandbox = Sandbox::new();
    sandbox.published_with(&format!("{CROOKED}{LAYER}"));
    let found = experiment(&sandbox, &[]);
    // 9 steps along x and y, 3 towards the sensor.
    assert_eq!(found.rows.len(), 21);
    let stiffness = [400.0 * 0.1 / 7.0 / 2.8, 400.0 * 0.1 / 7.0 / 2.8, 400.0 * 0.1 / 7.0];
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let film = found.of(&format!("film_d{name}_mm"));
        let told = found.of(&format!("found_d{name}_mm"));
        let force = found.of(&format!("f{name}_n"));
        for ((film, told), force) in film.iter().zip(told).zip(force) {
            assert!((film - told).abs() < 1e-9, "{name}: {film}, {told}");
            assert!((force - stiffness[axis] * film).abs() < 1e-12, "{name}: {film}, {force}");
        }
    }
    assert_eq!(found.of("film_dz_mm")[18..], [-2.0, -1.0, 0.0]);
    // `calibrate` reads the table, and finds the layer that it was computed with.
    let said = sandbox.run(&["experiment", "film.toml", "-o", "moved.csv"]);
    assert_eq!(said.status, 0);
    let said = sandbox.run(&["calibrate", "moved.csv", "--layout", "film.toml", "--format", "json", "--quiet"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    let json: serde_json::Value = serde_json::from_str(&said.stdout).expect("JSON");
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let fitted = json["by_field"][name]["stiffness_n_per_mm"].as_f64().expect("a number");
        assert!((fitted - stiffness[axis]).abs() < 1e-7, "{name}: {fitted}");
        assert_eq!(json["hooke_n_per_mm"][axis].as_f64().map(|n| (n - stiffness[axis]).abs() < 1e-12), Some(true));
    }
    let text = sandbox.run(&["calibrate", "moved.csv", "--layout", "film.toml", "--quiet"]).stdout;
    assert!(text.contains("over Hooke's law of [elastomer]        1.000000     1.000000     1.000000"), "{text}");
    // `read` tells the force as well.
    let read = Columns::new(&sandbox.run(&["read", "moved.csv", "--layout", "film.toml", "--quiet"]).stdout);
    for (read, moved) in read.of("fx_n").into_iter().zip(found.of("fx_n")) {
        assert!((read - moved).abs() < 1e-8, "{read}, {moved}");
    }
}

#[test]
fn noise_is_that_of_the_sensor_and_of_the_seed() {
    let sandbox = Sandbox::new();
    sandbox.published_with("[sensor]\npart = \"MLX90393\"");
    let run = |options: &[&str]| sandbox.run(&[&["experiment", "film.toml"], options].concat()).stdout;
    let (exact, one, two) = (run(&[]), run(&["--seed", "1"]), run(&["--seed", "2"]));
    assert_eq!(one, run(&["--seed", "1"]));
    assert!(one != two && one != exact);
    let squares: f64 = (Columns::new(&exact).of("bz_t").iter().zip(Columns::new(&one).of("bz_t")))
        .map(|(exact, noisy)| (noisy - exact) * (noisy - exact))
        .sum();
    // Chi-squared of 21 readings is between 6.4 and 46.8 in 998 of 1000 cases; the noise is 2.4 uT.
    let chi_squared = squares / (2.4e-6 * 2.4e-6);
    assert!((6.4..46.8).contains(&chi_squared), "{chi_squared}");
    // A reading at the border is outside by its noise, and named only if it is by more.
    sandbox.write("moved.csv", &one);
    let said = sandbox.run(&["read", "moved.csv", "--layout", "film.toml"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    let read = Columns::new(&said.stdout);
    assert!(read.of("status").iter().all(|status| *status == 0.0));
    assert!(read.of("deviation_x_mm").iter().all(|deviation| (3e-4..0.01).contains(deviation)));
    // sqrt(1.5^2 + 0.15^2 / 12) uT
    let said = sandbox.run(&["resolution", "film.toml"]);
    assert!(
        said.stdout.contains("noise of a reading: 1.501, 1.501, 2.401 uT (standard deviation)\n"),
        "{}",
        said.stdout
    );
    assert!(said.stdout.contains("readings a second: 100; the mean of n has 1/sqrt(n)"), "{}", said.stdout);
    sandbox.published_with("[sensor]\nrange_mt = 10");
    sandbox.run(&["resolution", "film.toml"]).refuses("film.toml: the layout has no noise: give --noise, such as 5uT");
    sandbox.run(&["experiment", "film.toml", "--seed", "1"]).refuses("film.toml: the layout has no noise for --seed");
}

/// The flux density of the film exceeds 1.6 mT, the range of this part, near the film.
#[test]
fn readings_beyond_the_range_are_named() {
    let sandbox = Sandbox::new();
    sandbox.published_with("[sensor]\npart = \"LIS3MDL\"");
    let said = sandbox.run(&["experiment", "film.toml", "-o", "moved.csv"]);
    let named = "film.toml: at 9 steps the flux density exceeds the range of the sensor";
    assert!(said.status == 0 && said.stderr.contains(named), "{}", said.stderr);
    let moved = Columns::new(&sandbox.read("moved.csv"));
    let said = sandbox.run(&["read", "moved.csv", "--layout", "film.toml"]);
    assert!(said.stderr.contains("line 5: the reading is at the limit of the sensor's range"), "{}", said.stderr);
    let read = Columns::new(&said.stdout);
    for ((saturated, status), dx) in moved.of("saturated").iter().zip(read.of("status")).zip(read.of("dx_mm")) {
        assert_eq!((*saturated == 1.0, status == 4.0), (status == 4.0, dx.is_nan()));
    }
    let said = sandbox.run(&["resolution", "film.toml", "-o", "r.csv"]);
    let named = "out of range: the flux density exceeds the range of the sensor at 285 of 405 points";
    assert!(said.stdout.contains(named), "{}", said.stdout);
    let lost = Columns::new(&sandbox.read("r.csv")).of("deviation_x_mm").iter().filter(|d| d.is_infinite()).count();
    assert_eq!(lost, 285);
}

#[test]
fn films_that_are_bent_and_turned_tell_other_displacements() {
    let sandbox = Sandbox::new();
    sandbox.published_with("");
    let worst = |options: &[&str]| -> f64 {
        let found = experiment(&sandbox, options);
        let mut worst: f64 = 0.0;
        for name in ["x", "y", "z"] {
            let pairs = found.of(&format!("film_d{name}_mm")).into_iter().zip(found.of(&format!("found_d{name}_mm")));
            worst = pairs.fold(worst, |worst, (film, told)| worst.max((film - told).abs()));
        }
        worst
    };
    assert!(worst(&[]) < 1e-9);
    assert!(worst(&["--shift", "0,0,0", "--rotate=0,0,0"]) < 1e-9);
    let (slight, strong) = (worst(&["--bend-radius", "1000mm"]), worst(&["--bend-radius", "100mm"]));
    assert!(slight > 1e-4 && strong > 5.0 * slight && strong < 1.0, "{slight}, {strong}");
    assert!((worst(&["--bend-radius", "100mm", "--bend-along", "y"]) - strong).abs() < 1e-9);
    assert!(worst(&["--rotate", "0,1deg,0"]) > 1e-4);
    // A film that is only elsewhere tells its displacements, from where it is at rest.
    assert!(worst(&["--shift", "0.1mm,0,-0.2mm"]) < 1e-9);
    let said = sandbox.run(&["experiment", "film.toml", "--shift", "0.1mm,0,-0.2mm", "-o", "moved.csv"]);
    assert_eq!(said.status, 0);
    let moved = sandbox.read("moved.csv");
    let mut lines: Vec<&str> = moved.lines().collect();
    // The fifth step is at rest.
    lines.insert(1, lines[5]);
    sandbox.write("moved.csv", &lines.join("\n"));
    let read = |option: &str| {
        let said = sandbox.run(&["read", "moved.csv", "--layout", "film.toml", option, "1", "--quiet"]);
        Columns::new(&said.stdout).of("dx_mm")[1..].to_vec()
    };
    let film = Columns::new(&moved).of("film_dx_mm");
    let worst_read = |found: &[f64]| film.iter().zip(found).map(|(film, dx)| (film + dx).abs()).fold(0.0, f64::max);
    assert!(worst_read(&read("--rest")) < 1e-9, "{:?}", read("--rest"));
    assert!(worst_read(&read("--zero")) > 1e-2, "{:?}", read("--zero"));
    sandbox
        .run(&["read", "moved.csv", "--layout", "film.toml", "--rest", "99"])
        .refuses("moved.csv: has 22 readings, fewer than the 99 of --rest");
    // Heights x^2 / (2 R) are nearly the cylinder of radius R.
    let mut heights = "x_mm,y_mm,z_mm\n".to_owned();
    for x in -11..=11 {
        for y in [-11, 11] {
            heights += &format!("{x},{y},{}\n", f64::from(x * x) / 2000.0);
        }
    }
    sandbox.write("heights.csv", &heights);
    let by_heights = experiment(&sandbox, &["--heights", "heights.csv"]).of("bz_t");
    let by_radius = experiment(&sandbox, &["--bend-radius", "1000mm"]).of("bz_t");
    let flat = experiment(&sandbox, &[]).of("bz_t");
    for ((by_heights, by_radius), flat) in by_heights.iter().zip(&by_radius).zip(&flat) {
        assert!(
            (by_heights - by_radius).abs() < 0.1 * (by_radius - flat).abs() + 1e-7,
            "{by_heights}, {by_radius}, {flat}"
        );
    }
    let refused = |options: &[&str]| sandbox.run(&[&["experiment", "film.toml"], options].concat());
    refused(&["--bend-radius", "0.3mm"])
        .refuses("this bend or shift of the film is impossible (lengths in mm): the radius must be");
    sandbox.write("few.csv", "x_mm,y_mm,z_mm\n-1,-1,0\n1,-1,0\n-1,1,0\n1,1,0\n");
    refused(&["--heights", "few.csv"]).refuses("the centre of tile number 1 is beyond the heights");
    sandbox.write("gap.csv", "x_mm,y_mm,z_mm\n-1,-1,0\n1,-1,0\n-1,1,0\n");
    refused(&["--heights", "gap.csv"]).refuses("gap.csv: has 3 heights at 2 x and 2 y, must have one for each pair");
    sandbox.write("twice.csv", "x_mm,y_mm,z_mm\n-1,-1,0\n1,-1,0\n-1,1,0\n-1,1,2\n");
    refused(&["--heights", "twice.csv"]).refuses("twice.csv: line 5: has the x and y of an earlier line");
    refused(&["--step", "0mm"]).refuses_arguments("each step must be above 0");
    refused(&["--step", "1e-7mm"]).refuses("each must be above 0 and give at most 100000 steps in the working volume");
    let far = sandbox.read("film.toml").replace("reference_mm = [0.0,", "reference_mm = [1e300,");
    sandbox.write("far.toml", &far);
    sandbox
        .run(&["experiment", "far.toml"])
        .refuses("at most 100000 steps in the working volume and from the reference");
    refused(&["--shift", "1mm"]).refuses_arguments("must be three lengths, such as 0.1mm,0,0");
    refused(&["--rotate", "0,1rad,0"]).refuses_arguments("has the unit rad, must be an angle in deg");
    refused(&["-o", "moved.vtp"]).refuses("steps have no place in VTK");
}

/// The compiled header takes raw readings of the sensor.
#[cfg(unix)]
#[test]
fn headers_know_the_sensor() {
    let sandbox = Sandbox::new();
    sandbox.published_with(CROOKED);
    let said = sandbox.run(&["export", "film.toml", "--to", "c-header", "--error", "0.02mm", "-o", "film.h"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    super::c_header::compiled(&sandbox);
    let moved = experiment(&sandbox, &[]);
    let readings: Vec<Vec<f64>> = ["bx_t", "by_t", "bz_t"].map(|name| moved.of(name)).into();
    let lines: String =
        (0..21).map(|n| format!("{:?},{:?},{:?}\n", readings[0][n], readings[1][n], readings[2][n])).collect();
    let film: Vec<Vec<f64>> = ["film_dx_mm", "film_dy_mm", "film_dz_mm"].map(|name| moved.of(name)).into();
    for (n, found) in super::c_header::answers(&sandbox, &lines).iter().enumerate() {
        // The film moves by the opposite of the sensor.
        let error = (0..3).map(|axis| (found[1 + axis] + film[axis][n]).abs()).fold(0.0, f64::max);
        assert!(error < 0.02 + 1e-4, "step {n}: {found:?}");
    }
}

#[test]
fn active_areas_that_are_too_large_are_refused() {
    let sandbox = Sandbox::new();
    sandbox.published_with("[sensor]\nactive_area_mm = [30, 30]\nnoise_ut = 5");
    sandbox.run(&["resolution", "film.toml"]).refuses("the field changes too much over the active area of the sensor");
}

#[cfg(feature = "report")]
#[test]
fn figures_of_the_sensor_are_drawn() {
    let sandbox = Sandbox::new();
    sandbox.published_with(&format!("[sensor]\npart = \"MLX90393\"\n{LAYER}"));
    assert_eq!(sandbox.run(&["experiment", "film.toml", "-o", "m.csv", "--figure", "moved.svg"]).status, 0);
    let svg = sandbox.read("moved.svg");
    assert!(svg.contains("closed form") && svg.contains("displacement of the film along"), "{}", svg.len());
    assert_eq!(sandbox.run(&["report", "film.toml", "-o", "report"]).status, 0);
    let page = sandbox.read("report/report.html");
    for part in ["<figure id=\"resolution\">", "<figure id=\"experiment\">"] {
        assert!(page.contains(part), "{part}");
    }
    assert!(crate::report::cells(&page, "noise of a reading, \u{b5}T")[0].starts_with("1.50"));
    let csv = sandbox.read("report/resolution.csv");
    assert_eq!(csv.lines().count(), 1 + 3 * 48 * 48);
}
