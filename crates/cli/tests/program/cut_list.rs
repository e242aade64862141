//! The cut list of `tiles`, the drawing and the bodies of `export`, and what `splice` rounds to.

use crate::{Sandbox, shipped};

#[test]
fn cut_list_has_sides_strength_and_angles_of_each_part() {
    let said = Sandbox::new().run(&["tiles", &shipped("published-film"), "--format", "csv"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    // Each line up to the second tile of the part.
    let lines: Vec<&str> =
        said.stdout.lines().map(|line| line.split_once(';').map_or(line, |(first, _)| first)).collect();
    let known = [
        "part,count,a_mm,b_mm,c_mm,strength_t,direction_deg,tilt_deg,tiles,turned_over",
        "1,16,3.3,3.3,1,0.12,45,0,film-x2-y2",
        "2,24,3.3,1.7,1,0.12,0,0,film-x2-y3",
        "3,16,3.3,0.85,1,0.12,0,0,film-x1-y2",
    ];
    assert_eq!(lines, known);
    // Angles out of the plane, and a part without polarization.
    let sandbox = Sandbox::new();
    let tile = |x: f64, j: &str| format!("[[tile]]\nposition_mm = [{x}, 0, 0]\nsize_mm = [3, 2, 1]\n{j}\n");
    let tiles =
        tile(0.0, "strength_t = 0.1\ndirection_deg = 39\ntilt_deg = 12.5") + &tile(9.0, "polarization_t = [0, 0, 0]");
    sandbox.write("film.toml", &format!("format = 1\nname = \"film\"\n{tiles}"));
    let said = sandbox.run(&["tiles", "film.toml", "--format", "csv"]);
    assert!(said.stdout.contains("1,1,3,2,1,0.1,39,12.5,tile-1,\n2,1,3,2,1,0,,,tile-2,\n"), "{}", said.stdout);
    let bill = sandbox.run(&["tiles", "film.toml"]).stdout;
    assert!(bill.contains("39 deg, 12.5 deg out of plane") && bill.contains("not polarized"), "{bill}");
}

/// The numbers and tiles of parts are the same in the list of tiles, the bill, the cut list, JSON
/// and the layers of the drawing.
#[test]
fn every_tile_has_the_same_part_everywhere() {
    let sandbox = Sandbox::new();
    let mut text = std::fs::read_to_string(shipped("published-film")).expect("a shipped layout");
    // A name that DXF cannot write as it is.
    text += "[[tile]]\nname = \"Stück %%d\"\nposition_mm = [20, 0, 0.5]\nsize_mm = [2, 1, 1]\nstrength_t = 0.1\ndirection_deg = 0\n";
    sandbox.write("film.toml", &text.replace("field = {", "# field = {"));
    let part_of = |names: &str, part: &str| -> Vec<(String, String)> {
        names.split(';').map(|name| (name.to_owned(), part.to_owned())).collect()
    };
    let csv = sandbox.run(&["tiles", "film.toml", "--format", "csv"]).stdout;
    let mut listed: Vec<(String, String)> = Vec::new();
    for line in csv.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let own = part_of(cells[8], cells[0]);
        assert_eq!(own.len().to_string(), cells[1]);
        listed.extend(own);
    }
    listed.sort();
    assert_eq!(listed.len(), 57);
    let printed = sandbox.run(&["tiles", "film.toml", "--quiet"]).stdout;
    let (tiles, bill) = printed.split_once("bill of materials\n").expect("a bill");
    let rows = tiles.lines().skip(2).filter(|line| !line.is_empty());
    let cells = rows.map(|line| line.trim().split("  ").map(str::trim).filter(|c| !c.is_empty()).collect::<Vec<_>>());
    let mut shown: Vec<(String, String)> = cells.map(|c| (c[0].to_owned(), c[1].to_owned())).collect();
    shown.sort();
    assert_eq!(shown, listed);
    let counts = |text: &str, separator: &str| -> Vec<[String; 2]> {
        let first_two = |line: &str| {
            let mut cells = line.split(separator).map(str::trim).filter(|cell| !cell.is_empty());
            [cells.next().expect("a part").to_owned(), cells.next().expect("a count").to_owned()]
        };
        text.lines().skip(1).map(first_two).collect()
    };
    assert_eq!(counts(bill, "  "), counts(&csv, ","));
    let json = sandbox.run(&["tiles", "film.toml", "--format", "json"]).stdout;
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    let parts = json["parts"].as_array().expect("parts");
    let names = |part: &serde_json::Value| {
        let number = part["part"].to_string();
        let tiles = part["tiles"].as_array().expect("tiles").clone();
        tiles.into_iter().map(move |name| (name.as_str().expect("a name").to_owned(), number.clone()))
    };
    let mut in_json: Vec<(String, String)> = parts.iter().flat_map(names).collect();
    in_json.sort();
    assert_eq!(in_json, listed);
    let drawing = sandbox.run(&["export", "film.toml", "--to", "dxf"]).stdout;
    let texts = drawing.split("0\nTEXT\n8\nPART-").skip(1).map(|entity| {
        let (_, name) = entity.split_once("\n1\n").expect("a text");
        let name = name.lines().next().expect("a line").replace("\\U+00FC", "ü").replace("%%%%%%", "%%");
        (name, entity.lines().next().expect("a layer").to_owned())
    });
    let mut drawn: Vec<(String, String)> = texts.collect();
    drawn.sort();
    assert_eq!(drawn, listed);
}

#[test]
fn kerf_adds_the_material() {
    let sandbox = Sandbox::new();
    let layout = shipped("published-film");
    let said = sandbox.run(&["tiles", &layout, "--format", "csv", "--kerf", "0.2mm"]);
    let numbers = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        [cells[9], cells[10]].map(|cell| cell.parse::<f64>().expect("a number"))
    };
    let found: Vec<[f64; 2]> = said.stdout.lines().skip(1).map(numbers).collect();
    let known = [[16.0 * 3.5 * 3.5, 16.0 * 3.5], [24.0 * 3.5 * 1.9, 24.0 * 3.5], [16.0 * 3.5 * 1.05, 16.0 * 3.5]];
    assert!(found.as_flattened().iter().zip(known.as_flattened()).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?}");
    let text = sandbox.run(&["tiles", &layout, "--kerf-mm", "0.2"]).stdout;
    assert!(text.contains("material with a kerf of 0.2 mm") && text.contains("84 of 1.7 x 1 mm"), "{text}");
    assert!(text.contains("sheet of 1 mm: 414.4 mm2 in all"), "{text}");
    sandbox
        .run(&["tiles", &layout, "--kerf", "-1"])
        .refuses_arguments("must be a length from 0 to 100 mm, such as 0.2mm");
    let said = sandbox.run(&["tiles", &layout, "--kerf", "0.2", "--format", "json"]);
    let json: serde_json::Value = serde_json::from_str(&said.stdout).expect("JSON");
    let of_json = |key: &str| json["parts"][0][key].as_f64().expect(key);
    assert!(
        (of_json("sheet_area_mm2") - known[0][0]).abs() < 1e-9 && (of_json("bar_length_mm") - known[0][1]).abs() < 1e-9
    );
}

#[test]
fn drawing_has_outlines_and_arrows_on_a_layer_for_each_part() {
    let sandbox = Sandbox::new();
    assert_eq!(sandbox.run(&["export", &shipped("published-film"), "-o", "film.dxf"]).status, 0);
    let drawing = sandbox.read("film.dxf");
    assert!(drawing.contains("9\n$INSUNITS\n70\n4\n") && drawing.ends_with("0\nEOF\n"));
    for (layer, count) in [("PART-1", 16), ("PART-2", 24), ("PART-3", 16)] {
        assert_eq!(drawing.matches(&format!("0\nPOLYLINE\n8\n{layer}\n")).count(), count);
        assert_eq!(drawing.matches(&format!("0\nVERTEX\n8\n{layer}\n")).count(), 4 * count);
        assert_eq!(drawing.matches(&format!("0\nLINE\n8\n{layer}\n")).count(), 3 * count);
    }
    // A corner of the first tile.
    assert!(drawing.contains("0\nVERTEX\n8\nPART-3\n10\n-10.0\n20\n-9.15\n30\n0.0\n"), "{}", &drawing[..2000]);
}

#[test]
fn cut_list_and_drawing_have_the_digits_that_a_person_would_write() {
    let sandbox = Sandbox::new();
    // (2.1 + 0.1) (1.1 + 0.1) is 2.6400000000000006 in binary numbers, and 4.1 - 0.1 is
    // 3.9999999999999996.
    let tile = |x: f64, size: &str| {
        format!("[[tile]]\nposition_mm = [{x}, 0, 0.5]\nsize_mm = {size}\nstrength_t = 0.1\ndirection_deg = 90\n")
    };
    let tiles = tile(0.0, "[2.1, 1.1, 1]") + &tile(4.1, "[0.2, 1, 1]");
    sandbox.write("film.toml", &format!("format = 1\nname = \"film\"\n{tiles}"));
    let csv = sandbox.run(&["tiles", "film.toml", "--format", "csv", "--kerf-mm", "0.1"]).stdout;
    assert!(csv.contains(",2.64,2.2,\n"), "{csv}");
    let drawing = sandbox.run(&["export", "film.toml", "--to", "dxf"]).stdout;
    assert!(drawing.contains("\n10\n4.0\n"), "{drawing}");
    for number in csv.split(['\n', ',']).chain(drawing.lines()).filter(|cell| cell.parse::<f64>().is_ok()) {
        let digits = number.chars().filter(char::is_ascii_digit).count();
        assert!(digits <= 13 && !number.contains('e'), "{number}");
    }
}

#[test]
fn tiles_that_almost_touch_are_counted() {
    let sandbox = Sandbox::new();
    let film = |ends: [f64; 3]| {
        let tile = |x: f64| {
            format!("[[tile]]\nposition_mm = [{x}, 0, 0.5]\nsize_mm = [2, 1, 1]\nstrength_t = 0.1\ndirection_deg = 0\n")
        };
        sandbox.write("film.toml", &format!("format = 1\nname = \"film\"\n{}", ends.map(tile).concat()));
        sandbox.run(&["tiles", "film.toml"]).stdout
    };
    let said = film([0.0, 2.0005, 4.0045]);
    let both = "\n2 pairs of tiles are less than 0.01 mm apart and do not touch; the smallest gap is 0.0005 mm\n";
    assert!(said.contains(both), "{said}");
    let said = film([0.0, 2.0, 4.004]);
    let one = "\n1 pair of tiles is less than 0.01 mm apart and does not touch; the smallest gap is 0.004 mm\n";
    assert!(said.contains(one), "{said}");
    for ends in [[0.0, 2.0, 4.0], [0.0, 2.01, 4.02]] {
        let said = film(ends);
        assert!(!said.contains("apart"), "{said}");
    }
}

#[test]
fn bodies_have_twelve_triangles_with_outward_normals() {
    let sandbox = Sandbox::new();
    assert_eq!(sandbox.run(&["export", &shipped("published-film"), "--to", "stl", "-o", "film.stl"]).status, 0);
    let bytes = std::fs::read(sandbox.path("film.stl")).expect("a file");
    assert_eq!(bytes.len(), 84 + 50 * 12 * 56);
    assert_eq!(u32::from_le_bytes(bytes[80..84].try_into().expect("four bytes")), 12 * 56);
    let mut volume = 0.0;
    for triangle in bytes[84..].chunks_exact(50) {
        let numbers: Vec<f64> =
            triangle[..48].chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().expect("four")).into()).collect();
        let [n, a, b, c] = [0, 3, 6, 9].map(|at| [numbers[at], numbers[at + 1], numbers[at + 2]]);
        let cross = |u: [f64; 3], v: [f64; 3]| {
            [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
        };
        let minus = |u: [f64; 3], v: [f64; 3]| [u[0] - v[0], u[1] - v[1], u[2] - v[2]];
        let dot = |u: [f64; 3], v: [f64; 3]| u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
        let normal = cross(minus(b, a), minus(c, a));
        assert!((dot(normal, n) - dot(normal, normal).sqrt()).abs() < 1e-5);
        volume += dot(a, cross(b, c)) / 6.0;
    }
    // 16 squares, 24 strips, 16 strips at the rim, 1 mm thick.
    let known = 16.0 * 3.3 * 3.3 + 24.0 * 3.3 * 1.7 + 16.0 * 3.3 * 0.85;
    assert!((volume - known).abs() < 1e-4, "{volume}, {known}");
}

#[test]
fn splice_rounds_to_the_resolution_asked_for() {
    let sandbox = Sandbox::new();
    let common = ["splice", "--wavelength", "10", "--film", "20x20", "--starts", "1", "--range", "3x3"];
    let coarse = [&common[..], &["--resolution", "0.05", "--resolution-deg", "1", "-o", "film.toml"]].concat();
    let said = sandbox.run(&coarse);
    assert_eq!(said.status, 0, "{}{}", said.stdout, said.stderr);
    let text = sandbox.read("film.toml");
    assert!(text.contains("resolution_mm = 0.05\nresolution_deg = 1.0\n"), "{text}");
    assert!(text.contains("x_mm = [-1.5, 1.5]\ny_mm = [-1.5, 1.5]\n"), "{text}");
    let tiles = sandbox.run(&["tiles", "film.toml", "--format", "csv"]).stdout;
    for line in tiles.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        for (cell, step) in [(cells[2], 0.05), (cells[3], 0.05), (cells[6], 1.0)] {
            let steps = cell.parse::<f64>().expect("a number") / step;
            assert!((steps - steps.round()).abs() < 1e-6, "{line}");
        }
    }
    sandbox
        .run(&[&common[..], &["--resolution", "0", "--resolution-deg", "-1"]].concat())
        .refuses("resolution: 0 mm, must be a finite number greater than 0");
}

/// Two pieces of one part with J at 45 and -45 degrees: one lies upside down.
#[test]
fn pieces_that_lie_upside_down_are_listed() {
    let sandbox = Sandbox::new();
    let tile = |name: &str, x: i32, y: &str| {
        format!(
            "[[tile]]\nname = \"{name}\"\nposition_mm = [{x}, 0, 0.6]\nsize_mm = [4, 2, 1.2]\npolarization_t = [0.1, {y}, 0]\n"
        )
    };
    let tiles = tile("a", 0, "0.1") + &tile("b", 5, "-0.1") + &tile("c", 10, "0.1");
    sandbox.write("film.toml", &format!("format = 1\nname = \"three\"\n{tiles}"));
    let said = sandbox.run(&["tiles", "film.toml"]);
    assert!(said.stdout.contains("part 1: 1 of 3 pieces lie upside down: b"), "{}", said.stdout);
    let csv = sandbox.run(&["tiles", "film.toml", "--format", "csv"]).stdout;
    assert!(csv.lines().nth(1).expect("a part").ends_with(",a;b;c,b"), "{csv}");
}
