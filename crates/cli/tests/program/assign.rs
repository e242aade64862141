//! `assign`: measured tiles in their places; `tolerance --sorted`.

use std::collections::HashSet;
use std::f64::consts::PI;
use std::fmt::Write;

use serde_json::Value;

use crate::{Sandbox, shipped};

/// A tile of the box: its name, its part, and its polarization along the sides of the part.
struct Cut {
    name: String,
    part: String,
    size_mm: [f64; 3],
    j_t: [f64; 3],
}

/// A number between -1 and 1 that differs from tile to tile.
fn scatter(number: usize) -> f64 {
    (12.9898 * number as f64 + 0.5).sin()
}

/// A box of the tiles of a film and `spares` more of each part, with errors of up to 4 % and 2
/// degrees.
fn boxed(sandbox: &Sandbox, film: &str, spares: usize) -> Vec<Cut> {
    let said = sandbox.run(&["tiles", film, "--format", "csv"]);
    let mut cut = Vec::new();
    for line in said.stdout.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let value = |column: usize| -> f64 { cells[column].parse().expect("a number") };
        for number in 0..value(1) as usize + spares {
            let wrong = |n: usize| scatter(3 * cut.len() + n);
            let (strength_t, direction, tilt) = (
                value(5) * (1.0 + 0.04 * wrong(0)),
                (value(6) + 2.0 * wrong(1)) * PI / 180.0,
                (value(7) + 2.0 * wrong(2)) * PI / 180.0,
            );
            let j_t = [
                strength_t * tilt.cos() * direction.cos(),
                strength_t * tilt.cos() * direction.sin(),
                strength_t * tilt.sin(),
            ];
            let name = format!("{}-{}", cells[0], number + 1);
            cut.push(Cut { name, part: cells[0].to_owned(), size_mm: [value(2), value(3), value(4)], j_t });
        }
    }
    cut
}

fn write_box(sandbox: &Sandbox, cut: &[Cut]) {
    let mut text = "tile,part,jx_t,jy_t,jz_t\n".to_owned();
    for Cut { name, part, j_t: [x, y, z], .. } in cut {
        let _ = writeln!(text, "{name},{part},{x:?},{y:?},{z:?}");
    }
    sandbox.write("tiles.csv", &text);
}

/// The JSON of `assign`, which writes assigned.toml and plan.csv.
fn assigned(sandbox: &Sandbox, film: &str, options: &[&str]) -> Value {
    let usual = ["--measured", "tiles.csv", "-o", "assigned.toml", "--plan", "plan.csv", "--format", "json", "-q"];
    let said = sandbox.run(&[&["assign", film], &usual[..], &["--starts", "2"], options].concat());
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    serde_json::from_str(&said.stdout).expect("JSON")
}

/// The root mean square over the axes of the displacement RMSE that `decouple` finds.
fn decoupled_rms_mm(sandbox: &Sandbox, film: &str) -> f64 {
    let said = sandbox.run(&["decouple", film, "--format", "json", "-q"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    let found: Value = serde_json::from_str(&said.stdout).expect("JSON");
    let of_axes = found["displacement_rmse_mm"].as_object().expect("an object").values();
    (of_axes.map(|axis| axis.as_f64().expect("a number").powi(2)).sum::<f64>() / 3.0).sqrt()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// J in the film of a tile whose side `up` is up and whose mark points at an angle.
fn turned(j_t: [f64; 3], up: &str, mark_deg: f64) -> [f64; 3] {
    let [x, y, z] = j_t;
    let [x, y, z] = match up {
        "+z" => [x, y, z],
        // Over its x axis, along which the mark lies.
        "-z" => [x, -y, -z],
        other => panic!("{other}: the tile stands on another side"),
    };
    let (sine, cosine) = (mark_deg * PI / 180.0).sin_cos();
    [x * cosine - y * sine, x * sine + y * cosine, z]
}

/// Each place has one tile, turned as the plan says; the layout's errors are those that the summary
/// states.
#[test]
fn plan_is_the_film_that_is_written() {
    let sandbox = Sandbox::new();
    for name in ["published-film", "designed-stock"] {
        let film = shipped(name);
        let cut = boxed(&sandbox, &film, 2);
        write_box(&sandbox, &cut);
        let found = assigned(&sandbox, &film, &[]);
        let rms = |key: &str| number(&found[key]);
        assert!(rms("rms_mm") < 0.7 * rms("in_order_rms_mm"), "{found}");
        let decoupled = decoupled_rms_mm(&sandbox, "assigned.toml");
        assert!((decoupled / rms("rms_mm") - 1.0).abs() < 1e-6, "{decoupled} and {found}");
        let ordered = decoupled_rms_mm(&sandbox, &film);
        assert!((ordered - rms("ordered_rms_mm")).abs() < 1e-4 * rms("in_order_rms_mm"), "{ordered} and {found}");

        let tiles: Value =
            serde_json::from_str(&sandbox.run(&["tiles", "assigned.toml", "--format", "json"]).stdout).expect("JSON");
        let tiles = tiles["tile"].as_array().expect("tiles");
        let plan = found["plan"].as_array().expect("a plan");
        assert_eq!((plan.len(), tiles.len()), (56, 56));
        let mut used = HashSet::new();
        for row in plan {
            assert!(used.insert(row["tile"].to_string()), "{row} is placed twice");
            let tile = tiles.iter().find(|tile| tile["name"] == row["place"]).expect("the tile of the place");
            let cut = cut.iter().find(|cut| row["tile"] == cut.name.as_str()).expect("a tile of the box");
            let j_t = turned(cut.j_t, row["up"].as_str().expect("a side"), number(&row["mark_deg"]));
            for (axis, wanted) in j_t.into_iter().enumerate() {
                assert!((number(&tile["polarization_t"][axis]) - wanted).abs() < 1e-9, "{row} {tile}");
            }
        }
        assert_eq!(sandbox.read("plan.csv").lines().count(), 57);
    }
}

/// Tiles that lie keep their places, positions and angles; the rest makes up for them; a shim
/// helps.
#[test]
fn tiles_that_lie_stay() {
    let sandbox = Sandbox::new();
    let film = shipped("designed-stock");
    write_box(&sandbox, &boxed(&sandbox, &film, 1));
    let before = assigned(&sandbox, &film, &[]);
    // The first ten tiles lie up to 0.2 mm and 2 degrees from their places, apart from each other.
    let mut lines: Vec<String> = sandbox.read("plan.csv").lines().map(str::to_owned).collect();
    for (number, line) in lines.iter_mut().enumerate().skip(1).take(10) {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        let z: f64 = cells[4].parse().expect("a number");
        cells[4] = (z + 0.02 * number as f64).to_string();
        let mark: f64 = cells[7].parse().expect("a number");
        cells[7] = (mark + 1e-6 * number as f64).to_string();
        cells[8] = "yes".to_owned();
        *line = cells.join(",");
    }
    sandbox.write("placed.csv", &lines.join("\n"));
    let after = assigned(&sandbox, &film, &["--placed", "placed.csv"]);
    let plan = after["plan"].as_array().expect("a plan");
    for line in &lines[1..11] {
        let cells: Vec<&str> = line.split(',').collect();
        let row = plan.iter().find(|row| row["place"] == cells[0]).expect("a row for each place");
        assert_eq!(row["is_placed"], Value::Bool(true));
        assert_eq!((row["place"].as_str(), row["tile"].as_str()), (Some(cells[0]), Some(cells[1])));
        for (axis, cell) in cells[2..5].iter().enumerate() {
            assert!((number(&row["centre_mm"][axis]) - cell.parse::<f64>().expect("a number")).abs() < 1e-12);
        }
        assert!((number(&row["mark_deg"]) - cells[7].parse::<f64>().expect("a number")).abs() < 2e-6, "{row} {line}");
    }
    assert_eq!(plan.iter().filter(|row| row["is_placed"] == Value::Bool(true)).count(), 10);
    // They come first in the plan that people follow.
    let placed: Vec<bool> = sandbox.read("plan.csv").lines().skip(1).map(|line| line.ends_with(",yes")).collect();
    assert!(placed[..10].iter().all(|is_placed| *is_placed) && placed[10..].iter().all(|is_placed| !is_placed));
    let rms = |found: &Value| number(&found["rms_mm"]);
    assert!((decoupled_rms_mm(&sandbox, "assigned.toml") / rms(&after) - 1.0).abs() < 1e-6);
    assert!(rms(&after) > rms(&before), "{after}");

    let free = |index: &usize| plan[*index]["is_placed"] == Value::Bool(false);
    let shim = (30..plan.len()).find(free).expect("a place");
    let place = before["plan"][shim]["place"].as_str().expect("a place").to_owned();
    let shimmed = assigned(&sandbox, &film, &["--placed", "placed.csv", "--shim", &place]);
    assert_eq!(shimmed["shims"][0]["place"], place.as_str());
    assert_eq!(shimmed["plan"][shim]["tile"], "shim");
    assert!((decoupled_rms_mm(&sandbox, "assigned.toml") / rms(&shimmed) - 1.0).abs() < 1e-6);
    let tiles = sandbox.run(&["tiles", "assigned.toml", "--format", "json"]).stdout;
    let tiles: Value = serde_json::from_str(&tiles).expect("JSON");
    let shim = tiles["tile"].as_array().expect("tiles").iter().find(|tile| tile["name"] == place.as_str());
    let j_t = &shim.expect("the shim")["polarization_t"];
    let strength: f64 = (0..3).map(|axis| number(&j_t[axis]).powi(2)).sum();
    assert!((strength.sqrt() - number(&shimmed["shims"][0]["strength_t"]).abs()).abs() < 1e-9);
}

#[test]
fn film_whose_tiles_are_all_placed_is_evaluated() {
    let sandbox = Sandbox::new();
    let film = shipped("designed-stock");
    write_box(&sandbox, &boxed(&sandbox, &film, 1));
    let before = assigned(&sandbox, &film, &[]);
    sandbox.write("placed.csv", &sandbox.read("plan.csv").replace(",no\n", ",yes\n"));
    let after = assigned(&sandbox, &film, &["--placed", "placed.csv"]);
    assert!(after["plan"].as_array().expect("a plan").iter().all(|row| row["is_placed"] == Value::Bool(true)));
    // The plan has positions and angles to twelve digits.
    let rms = |found: &Value| number(&found["rms_mm"]);
    assert!((rms(&after) / rms(&before) - 1.0).abs() < 1e-6, "{after} instead of {before}");
}

/// A column that is not read may decide which tiles are placed.
#[test]
fn columns_of_a_plan_that_are_not_read_are_named() {
    let sandbox = Sandbox::new();
    let film = shipped("designed-stock");
    write_box(&sandbox, &boxed(&sandbox, &film, 1));
    assigned(&sandbox, &film, &[]);
    let plan = sandbox.read("plan.csv");
    let said_of = |names: &str| {
        sandbox.write("placed.csv", &plan.replacen(",placed\n", names, 1).replace(",no\n", ",no,2\n"));
        let said = sandbox.run(
            &[
                &["assign", &film, "--measured", "tiles.csv", "--placed", "placed.csv", "--starts", "1"][..],
                &["-o", "assigned.toml", "--format", "json"],
            ]
            .concat(),
        );
        assert_eq!(said.status, 0, "{}", said.stderr);
        let found: Value = serde_json::from_str(&said.stdout).expect("JSON");
        let placed =
            found["plan"].as_array().expect("a plan").iter().filter(|row| row["is_placed"] == Value::Bool(true));
        (placed.count(), said.stderr)
    };
    let (placed, said) = said_of(",placed,glued\n");
    assert!(placed == 0 && said.contains("placed.csv: columns that were not read: glued\n"), "{placed}: {said}");
    // Of earlier versions.
    let (placed, said) = said_of(",laid,placed_on\n");
    assert!(placed == 0 && said.contains("columns that were not read: placed_on\n"), "{placed}: {said}");
    let (placed, said) = said_of(",fixed,glued\n");
    assert!(placed == 56 && said.contains("columns that were not read: fixed, glued\n"), "{placed}: {said}");
}

/// Tiles that are larger than ordered are written as measured; the layout allows their overlap.
#[test]
fn measured_sides_are_those_of_the_film() {
    let sandbox = Sandbox::new();
    let film = shipped("published-film");
    let mut text = "tile,part,strength_mt,size_x_mm,size_y_mm,size_z_mm\n".to_owned();
    for (number, Cut { name, part, size_mm: [x, y, z], .. }) in boxed(&sandbox, &film, 0).iter().enumerate() {
        // The last side was not measured of half of the tiles, so that their sides are those
        // ordered.
        let sides = if number % 2 == 0 { format!("{:?},{:?},{z:?}", x + 0.02, y + 0.01) } else { ",,".to_owned() };
        let _ = writeln!(text, "{name},{part},120,{sides}");
    }
    sandbox.write("tiles.csv", &text);
    let found = assigned(&sandbox, &film, &[]);
    assert!((decoupled_rms_mm(&sandbox, "assigned.toml") / number(&found["rms_mm"]) - 1.0).abs() < 1e-6);
    let layout = sandbox.read("assigned.toml");
    assert!(layout.contains("overlap_mm = 0.0"), "{}", &layout[..600]);
    let tiles: Value =
        serde_json::from_str(&sandbox.run(&["tiles", "assigned.toml", "--format", "json"]).stdout).expect("JSON");
    let ordered: Value =
        serde_json::from_str(&sandbox.run(&["tiles", &film, "--format", "json"]).stdout).expect("JSON");
    let area = |tiles: &Value| -> f64 {
        let tiles = tiles["tile"].as_array().expect("tiles").iter();
        tiles.map(|tile| number(&tile["size_mm"][0]) + number(&tile["size_mm"][1])).sum()
    };
    // Half of the tiles have sides that are longer by 0.03 mm together.
    assert!((area(&tiles) - area(&ordered) - 28.0 * 0.03).abs() < 1e-9, "{}", area(&tiles) - area(&ordered));
    sandbox.write("tiles.csv", &text.replacen("1.02", "10.2", 1).replacen("3.32", "33.2", 1));
    let refused = sandbox.run(&["assign", &film, "--measured", "tiles.csv"]);
    refused.refuses("side is 33.2 mm, must be within 0.5 to 2 times the 3.3 mm of part 1");
}

/// The written [tolerance] has the errors of placement and of measurement; no side is turned over
/// if none may be.
#[test]
fn tolerance_of_the_film_has_placement_and_measurement_errors() {
    let sandbox = Sandbox::new();
    let ordered = std::fs::read_to_string(shipped("published-film")).expect("a layout");
    let errors = "\n[tolerance]\nposition_mm = 0.05\nstrength = 0.03\ndirection_deg = 1\n";
    sandbox.write("film.toml", &(ordered + errors));
    write_box(&sandbox, &boxed(&sandbox, "film.toml", 0));
    let found =
        assigned(&sandbox, "film.toml", &["--keep-side-up", "--strength-error", "0.5%", "--direction-error", "0.3deg"]);
    assert!(found["plan"].as_array().expect("a plan").iter().all(|row| row["up"] == "+z"), "{found}");
    let layout = sandbox.read("assigned.toml");
    for written in ["position_mm = 0.05", "strength = 0.005", "direction_deg = 0.3"] {
        assert!(layout.contains(written), "{written} is not in {}", &layout[..900]);
    }
    assert!(!layout.contains("[expect"), "{layout}");
}

/// The picture and the page name every tile of the plan.
#[cfg(feature = "report")]
#[test]
fn picture_and_page_name_every_tile() {
    let sandbox = Sandbox::new();
    let film = shipped("published-film");
    write_box(&sandbox, &boxed(&sandbox, &film, 0));
    let found = assigned(&sandbox, &film, &["--figure", "plan.svg", "--page", "plan.html"]);
    let (picture, page) = (sandbox.read("plan.svg"), sandbox.read("plan.html"));
    for row in found["plan"].as_array().expect("a plan") {
        let [place, tile] = ["place", "tile"].map(|key| row[key].as_str().expect("a name"));
        assert!(picture.contains(tile), "{tile}");
        assert!(page.contains(&format!("<td>{place}</td><td>{tile}</td>")), "{place} {tile}");
    }
    let said = sandbox.run(&["tiles", &film, "--kerf-mm", "0.2", "--page", "bill.html"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    let bill = sandbox.read("bill.html");
    assert!(bill.contains("<th>sheet, mm2</th><th>or bar, mm</th>") && bill.contains("Bill of materials"), "{bill}");
    assert!(bill.contains("The numbers in the drawing are the numbers of the parts."), "{bill}");
    sandbox.run(&["tiles", &film, "--page", &film]).refuses("no format has the ending .toml: use one of .html");
}

/// Moments, magnetizations and strengths with angles are the same tiles.
#[test]
fn every_form_of_the_magnetization_is_read() {
    let sandbox = Sandbox::new();
    let film = shipped("published-film");
    let cut = boxed(&sandbox, &film, 0);
    write_box(&sandbox, &cut);
    let as_polarization = assigned(&sandbox, &film, &[]);
    const MU_0: f64 = 1.256_637_061_27e-6;
    let mut forms = [
        "tile,part,moment_x (mA m2),moment_y (mA m2),moment_z (mA m2)\n".to_owned(),
        "name,part,mx_kA_per_m,my_kA_per_m,mz_kA_per_m\n".to_owned(),
        "tile,part,strength_mt,direction_deg,tilt_deg,note\n".to_owned(),
    ];
    for Cut { name, part, size_mm, j_t } in &cut {
        let volume_m3 = 1e-9 * size_mm.iter().product::<f64>();
        let [x, y, z] = j_t.map(|j_t| 1e3 * j_t / MU_0 * volume_m3);
        let _ = writeln!(forms[0], "{name},{part},{x:?},{y:?},{z:?}");
        let [x, y, z] = j_t.map(|j_t| 1e-3 * j_t / MU_0);
        let _ = writeln!(forms[1], "{name},{part},{x:?},{y:?},{z:?}");
        let [x, y, z] = *j_t;
        let (flat, degrees) = (x.hypot(y), 180.0 / PI);
        let _ = writeln!(
            forms[2],
            "{name},{part},{:?},{:?},{:?},ok",
            1e3 * flat.hypot(z),
            y.atan2(x) * degrees,
            z.atan2(flat) * degrees
        );
    }
    for form in forms {
        sandbox.write("tiles.csv", &form);
        let found = assigned(&sandbox, &film, &[]);
        assert_eq!(found["plan"], as_polarization["plan"], "{}", form.lines().next().unwrap());
    }
}

#[test]
fn wrong_tables_are_refused_by_line() {
    let sandbox = Sandbox::new();
    let film = shipped("published-film");
    let cut = boxed(&sandbox, &film, 0);
    write_box(&sandbox, &cut);
    let run = |options: &[&str]| sandbox.run(&[&["assign", &film, "--measured", "tiles.csv"], options].concat());
    let good = sandbox.read("tiles.csv");
    let lines: Vec<&str> = good.lines().collect();
    let with = |line: usize, text: &str| {
        let mut changed: Vec<&str> = lines.clone();
        changed[line - 1] = text;
        sandbox.write("tiles.csv", &changed.join("\n"));
    };
    for (text, message) in [
        ("1-1,1,0.1", "line 2: has 3 fields, must have 5"),
        ("1-1,9,0.1,0,0", "line 2: part = \"9\", must be a number from 1 to 3, as `magsplice tiles` lists the parts"),
        ("1-1,,0.1,0,0", "line 2: has no part, must have the number of one in a column part, 1 to 3, or sizes"),
        ("1-1,1,weak,0,0", "line 2: jx_t = \"weak\", must be a finite number"),
        ("1-1,1,,0,0", "line 2: left out: the magnetization of tile \"1-1\" is missing"),
        ("1-1,1,120,0,0", "line 2: its polarization is 120 T, must be within 0.5 to 2 times"),
        (",1,0.1,0,0", "line 2: has no name in the column of tiles"),
    ] {
        with(2, text);
        run(&[]).refuses(message);
    }
    let without: Vec<String> = lines
        .iter()
        .map(|line| line.split(',').enumerate().filter(|(n, _)| *n != 1))
        .map(|cells| cells.map(|(_, cell)| cell).collect::<Vec<_>>().join(","))
        .collect();
    sandbox.write("tiles.csv", &without.join("\n"));
    let said = run(&[]);
    said.refuses(
        "line 1: no column part with the part of each tile, 1 to 3 as `magsplice tiles` lists them, or columns",
    );
    assert_eq!(said.stderr.lines().count(), 1, "{}", said.stderr);
    with(3, lines[1]);
    run(&[]).refuses("line 3: tile \"1-1\" is in line 2 already");
    let [x, y, z] = cut[0].j_t;
    with(2, &format!("1-1,1,{:?},{:?},{:?}", -x, -y, -z));
    run(&[]).refuses(" deg from the polarization of part 1, must be less than 45 deg: turn the axes");
    sandbox.write("tiles.csv", &lines[..lines.len() - 1].join("\n"));
    run(&[]).refuses("places) has");
    sandbox.write("tiles.csv", "tile,part,jx,jy,jz\na,1,1,2,3\n");
    run(&[]).refuses(
        "line 1: the columns jx, jy, jz of the polarization have no unit: rename, as in jx_t, with one of: T, mT",
    );
    sandbox.write("tiles.csv", &good);
    run(&["--shim", "nowhere"]).refuses("--shim nowhere: must be the name of a tile of the layout");
    run(&["-o", "tiles.csv"]).refuses("it is an input, which would be lost");
    let refused = run(&["--strength-error", "80%"]);
    assert!(refused.status == 2 && refused.stderr.contains("must be from 0 to 50%"), "{}", refused.stderr);

    let said = run(&["-o", "assigned.toml", "--plan", "plan.csv", "--starts", "1"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    assert!(
        said.stdout.contains("tiles as assigned") && said.stdout.contains("wrote assigned.toml"),
        "{}",
        said.stdout
    );
    let plan = sandbox.read("plan.csv").replace(",no", ",yes");
    let rows: Vec<&str> = plan.lines().collect();
    let placed = |changed: &str| {
        sandbox.write("placed.csv", &format!("{}\n{changed}\n", rows[0]));
        run(&["--placed", "placed.csv", "--starts", "1"])
    };
    let cells: Vec<&str> = rows[1].split(',').collect();
    let row = |place: &str, tile: &str, mark_deg: &str, placed: &str| {
        let [x, y, z, up] = [2, 3, 4, 5].map(|column| cells[column]);
        format!("{place},{tile},{x},{y},{z},{up},+x,{mark_deg},{placed}")
    };
    let [place, tile, mark] = [cells[0], cells[1], cells[7]];
    placed(&row("x", tile, mark, "yes")).refuses("line 2: place = \"x\", must be the name of a tile of the layout");
    placed(&row(place, "x", mark, "yes")).refuses("line 2: tile = \"x\", must be one of the measured tiles");
    placed(&row(place, tile, mark, "maybe")).refuses("line 2: placed = \"maybe\", must be yes or no");
    let turned = (mark.parse::<f64>().unwrap() + 90.0).to_string();
    placed(&row(place, tile, &turned, "yes"))
        .refuses("its polarization does not fit the place; its orientation must be near:");
    placed(&format!("{0}\n{0}", rows[1])).refuses("line 3: place");
}

/// Every part that lacks tiles is named, not the first one only.
#[test]
fn all_parts_that_lack_tiles_are_named() {
    let sandbox = Sandbox::new();
    let film = shipped("designed-stock");
    let cut = boxed(&sandbox, &film, 0);
    let mut parts: Vec<&str> = cut.iter().map(|tile| tile.part.as_str()).collect();
    parts.dedup();
    let last = |part: &str| cut.iter().rposition(|tile| tile.part == part).expect("a tile of the part");
    let lost = [last(parts[0]), last(parts[2])];
    let kept = |index: usize| !lost.contains(&index);
    write_box(
        &sandbox,
        &cut.into_iter().enumerate().filter(|(i, _)| kept(*i)).map(|(_, tile)| tile).collect::<Vec<_>>(),
    );
    let said = sandbox.run(&["assign", &film, "--measured", "tiles.csv", "--starts", "1"]);
    said.refuses("tiles.csv: ");
    assert_eq!(said.stderr.matches("of the measured tiles").count(), 2, "{}", said.stderr);
    assert!(said.stderr.contains("part 1 (") && said.stderr.contains("part 3 ("), "{}", said.stderr);
    assert_eq!(said.stderr.matches("measure more, or give the tiles already placed (--placed)").count(), 1);
}

/// Samples of sorted tiles are better than those of unsorted ones, and parts of them join.
#[test]
fn samples_of_sorted_tiles() {
    let sandbox = Sandbox::new();
    let film = shipped("designed-stock");
    let usual = ["tolerance", &film, "--preset", "jig", "--samples", "6", "--format", "json", "-q"];
    let p50 = |options: &[&str]| {
        let said = sandbox.run(&[&usual[..], options].concat());
        assert_eq!((said.status, said.stderr.as_str()), (0, ""));
        let found: Value = serde_json::from_str(&said.stdout).expect("JSON");
        number(&found["displacement_rmse_mm"]["x"]["p50"]["value"])
    };
    let sorted = ["--sorted", "--spares", "14", "--strength-error", "0.5%", "--direction-error", "0.3deg"];
    let (with, without) = (p50(&sorted), p50(&[]));
    assert!(with < 0.8 * without, "{with} of {without}");
    let parts =
        [["--first", "0", "--count", "4", "--save", "a.csv"], ["--first", "4", "--count", "2", "--save", "b.csv"]];
    for part in parts {
        p50(&[&sorted[..], &part].concat());
    }
    let merge = ["tolerance", "merge", &film, "b.csv", "a.csv", "--preset", "jig"];
    let joined = sandbox.run(&[&merge[..], &sorted, &["--format", "json"]].concat());
    let joined: Value = serde_json::from_str(&joined.stdout).expect("JSON");
    assert_eq!(number(&joined["displacement_rmse_mm"]["x"]["p50"]["value"]), with);
    assert_eq!(joined["sorting"]["spares"], 14);
    sandbox.run(&merge).refuses("other errors or other options of --sorted than");
    sandbox.run(&[&usual[..], &["--strength-error", "1%"]].concat()).refuses("measurement errors need --sorted");
    let text = sandbox.run(&["tolerance", &film, "--preset", "jig", "--samples", "2", "--sorted", "-q"]).stdout;
    assert!(text.contains("tiles are measured and sorted before they are placed: 0 spare tiles;"), "{text}");
}

/// The film that is written has the errors that were stated but for what recoil is neglected, and
/// smaller ones than if its tiles had been assigned as rigid ones.
#[test]
fn tiles_with_recoil_are_assigned_with_what_it_adds() {
    let sandbox = Sandbox::new();
    let rigid = std::fs::read_to_string(shipped("designed-tilted")).expect("a shipped film");
    let material = "\n[material]\nrecoil_permeability = 1.05\n";
    sandbox.write("rigid.toml", &rigid);
    sandbox.write("film.toml", &(rigid + material));
    write_box(&sandbox, &boxed(&sandbox, "rigid.toml", 2));
    let found = assigned(&sandbox, "film.toml", &[]);
    assert!(number(&found["recoil"]["change_t"]) > 0.0, "{found}");
    let (stated, in_order) = (number(&found["rms_mm"]), number(&found["in_order_rms_mm"]));
    let decoupled = decoupled_rms_mm(&sandbox, "assigned.toml");
    // The effect of a faulty tile on others is neglected: a fifth of the susceptibility of its
    // error.
    assert!((decoupled - stated).abs() < 0.2 * 0.05 * in_order, "{decoupled} and {found}");
    assigned(&sandbox, "rigid.toml", &[]);
    let as_rigid = sandbox.read("assigned.toml") + material;
    sandbox.write("assigned.toml", &as_rigid);
    let as_rigid = decoupled_rms_mm(&sandbox, "assigned.toml");
    assert!(decoupled < as_rigid, "{decoupled} {as_rigid}");

    let sorted = ["--sorted", "--preset", "jig", "--samples", "3", "--format", "json", "-q"];
    let said = sandbox.run(&[&["tolerance", "film.toml"], &sorted[..]].concat());
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    let said: Value = serde_json::from_str(&said.stdout).expect("JSON");
    let nominal = number(&said["displacement_rmse_mm"]["x"]["nominal"]);
    let film: Value =
        serde_json::from_str(&sandbox.run(&["decouple", "film.toml", "--format", "json"]).stdout).expect("JSON");
    let known = number(&film["displacement_rmse_mm"]["x"]);
    assert!((nominal - known).abs() < 1e-9, "{nominal} {known}");
}
