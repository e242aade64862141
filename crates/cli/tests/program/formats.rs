//! Results as files of other tools: the choice of the format, and failures. `.ci/readback` reads
//! the files with these tools.

use std::fs;

use serde_json::Value;

use crate::{Sandbox, shipped};

#[test]
fn file_ending_chooses_the_format() {
    let sandbox = Sandbox::new();
    let layout = shipped("published-film");
    let beginnings: [(&str, &[u8]); 6] = [
        ("csv", b"x_mm,y_mm,z_mm,bx_t,by_t,bz_t"),
        ("json", b"{\n  \"layout\": \"published film\",\n"),
        ("npy", b"\x93NUMPY"),
        ("npz", b"PK\x03\x04"),
        ("vti", b"<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\""),
        ("NPZ", b"PK\x03\x04"),
    ];
    for verb in ["field", "decouple"] {
        for (ending, beginning) in beginnings {
            let name = format!("out.{ending}");
            let said = sandbox.run(&[verb, &layout, "-o", &name]);
            assert_eq!((said.status, said.stdout.as_str(), said.stderr.as_str()), (0, "", ""), "{verb} {name}");
            assert!(fs::read(sandbox.path(&name)).unwrap().starts_with(beginning), "{verb} {name}");
        }
        assert_eq!(sandbox.files(), ["out.NPZ", "out.csv", "out.json", "out.npy", "out.npz", "out.vti"]);
        // Without an ending --format chooses, and the file is the same.
        let said = sandbox.run(&[verb, &layout, "-o", "plain", "--format", "npz"]);
        assert_eq!(said.status, 0, "{}", said.stderr);
        assert_eq!(fs::read(sandbox.path("plain")).unwrap(), fs::read(sandbox.path("out.npz")).unwrap());
        fs::remove_file(sandbox.path("plain")).unwrap();
    }
    assert_eq!(sandbox.run(&["decouple", &layout, "-o", "report.txt"]).status, 0);
    assert_eq!(sandbox.read("report.txt"), sandbox.run(&["decouple", &layout]).stdout);
}

#[test]
fn contradicting_and_unknown_formats_are_refused() {
    let sandbox = Sandbox::new();
    sandbox.write("points.csv", "x_mm,y_mm,z_mm\n0,0,-4\n");
    let layout = shipped("published-film");
    let cases: [(&[&str], &str); 14] = [
        (&["field", "--format", "npz", "-o", "out.npy"], "the ending means npy, which contradicts --format npz"),
        (&["decouple", "--format", "text", "-o", "out.json"], "the ending means json, which contradicts --format text"),
        (&["decouple", "-o", "out.xlsx"], "no format has the ending .xlsx: use one of .txt, .json, .csv, .npy, .npz,"),
        (&["field", "-o", "out.txt"], "no format has the ending .txt: use one of .csv, .json, .npy, .npz, .vti, .vtp,"),
        (
            &["field", "-o", "out.vtp"],
            "out.vtp: the working volume is image data, which programs recognize by the ending",
        ),
        (&["decouple", "-o", "out.vtp"], "use .vti"),
        (&["field", "--points", "points.csv", "-o", "out.vti"], "points of a file are poly data"),
        (
            &["field", "--format", "vtk", "-o", "out.vtk"],
            "out.vtk: the legacy format of VTK is not written: write .vti (grid) or .vtp (points)",
        ),
        (&["decouple", "-o", "OUT.VTK"], "write .vti (grid) or .vtp (points)"),
        (&["export", "-o", "out.vtk"], "the legacy format of VTK is not written: write .vtp\n"),
        (&["field", "--format", "vtk", "-o", "out.xml"], ".xml is another format: use .vti, .vtp"),
        (&["export", "--to", "vtk", "-o", "out.py"], "the ending means magpylib, which contradicts --to vtk"),
        (&["export", "-o", "out"], "out: without an ending it has no format: give --to"),
        (&["export", "-o", "out.vti"], "no format has the ending .vti: use one of .py, .vtp, .dxf, .stl, .h, or give"),
    ];
    for (arguments, message) in cases {
        sandbox.run(&[&arguments[..1], &[&layout], &arguments[1..]].concat()).refuses(message);
    }
    assert_eq!(sandbox.files(), ["points.csv"]);
    assert_eq!(sandbox.run(&["export", &layout]).status, 2);
}

#[cfg(not(feature = "parquet"))]
#[test]
fn parquet_without_its_feature_is_refused() {
    let sandbox = Sandbox::new();
    for arguments in [["field", "-o", "out.parquet"], ["decouple", "--format", "parquet"]] {
        let said = sandbox.run(&[&arguments[..1], &[&shipped("published-film")], &arguments[1..]].concat());
        said.refuses("parquet is not built into this program: build it with its default features");
    }
    assert_eq!(sandbox.files(), [""; 0]);
}

/// Formats that are written at the end, of a field that fails before.
#[test]
fn failure_keeps_the_earlier_file() {
    let sandbox = Sandbox::new();
    sandbox.write("points.csv", "x_mm,y_mm,z_mm\n0,0,-4\n0,0,oops\n");
    for name in ["out.npz", "out.npy", "out.vtp", "out.json"] {
        sandbox.write(name, "before");
        let said = sandbox.run(&["field", &shipped("published-film"), "--points", "points.csv", "-o", name]);
        said.refuses("points.csv: line 3: z_mm = \"oops\", must be a finite number");
        assert_eq!(sandbox.read(name), "before");
    }
    assert_eq!(sandbox.files().len(), 5);
    let layout = fs::read_to_string(shipped("published-film")).unwrap();
    sandbox.write("film.py", &layout);
    sandbox.run(&["export", "film.py", "-o", "film.py"]).refuses("it is an input, which would be lost");
    sandbox.run(&["decouple", "film.py", "--format", "npz", "-o", "film.py"]).refuses("it is an input");
    assert_eq!(sandbox.read("film.py"), layout);
}

#[test]
fn json_has_the_numbers_of_csv() {
    let sandbox = Sandbox::new();
    let layout = shipped("published-film");
    for verb in ["field", "decouple"] {
        let csv = sandbox.run(&[verb, &layout, "--format", "csv"]).stdout;
        let json: Value = serde_json::from_str(&sandbox.run(&[verb, &layout, "--format", "json"]).stdout).unwrap();
        let names: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
        assert_eq!(json["columns"].as_object().unwrap().len(), names.len());
        assert_eq!(json["shape"], serde_json::json!([9, 9, 5]));
        for (i, name) in names.iter().enumerate() {
            let column: Vec<f64> = csv.lines().skip(1).map(|l| l.split(',').nth(i).unwrap().parse().unwrap()).collect();
            assert_eq!(json["columns"][name], serde_json::json!(column), "{verb} {name}");
        }
        assert_eq!((&json["accuracy"], &json["layout"]), (&Value::from("exact"), &Value::from("published film")));
    }
    // J is always exact, and the file says so.
    let said = sandbox.run(&["field", &layout, "--quantity", "j", "--within", "1e-3", "--format", "json"]);
    assert_eq!(serde_json::from_str::<Value>(&said.stdout).unwrap()["accuracy"], "exact");
    let said = sandbox.run(&["field", &layout, "--within", "1e-3", "--format", "json"]);
    assert_eq!(
        serde_json::from_str::<Value>(&said.stdout).unwrap()["accuracy"],
        serde_json::json!({ "relative": 1e-3 })
    );
}

#[test]
fn singular_points_are_nan_in_csv_and_null_in_json() {
    let sandbox = Sandbox::new();
    let layout = "../../tests/readback/singular.toml";
    let layout = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(layout);
    let layout = layout.to_str().unwrap();
    let said = sandbox.run(&["decouple", layout, "--format", "csv"]);
    assert_eq!(said.stdout.lines().filter(|l| l.ends_with(",NaN,NaN,NaN")).count(), 6);
    let remark = "magsplice: 6 singular points have B_z = 0: their R_x, R_y, S_z are written as NaN\n";
    assert!(said.stderr.ends_with(remark), "{}", said.stderr);
    assert_eq!(sandbox.run(&["decouple", layout, "--format", "csv", "--quiet"]).stderr, "");
    let json: Value = serde_json::from_str(&sandbox.run(&["decouple", layout, "--format", "json"]).stdout).unwrap();
    let null = json["columns"]["s_z"].as_array().unwrap().iter().filter(|v| v.is_null()).count();
    assert_eq!((null, json["singular_points_mm"].as_array().unwrap().len()), (6, 6));
}

#[test]
fn magpylib_script_has_every_tile() {
    let said = Sandbox::new().run(&["export", &shipped("published-film"), "--to", "magpylib"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    assert_eq!(said.stdout.lines().filter(|l| l.starts_with("    (\"film-x")).count(), 56);
    let tile = "(\"film-x2-y1\", (-7.5, -9.575, 0.5), (3.3, 0.85, 1.0), (0.12, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)),";
    assert!(said.stdout.contains(tile) && said.stdout.contains("\nREFERENCE_MM = (0.0, 0.0, -5.0)\n"));
    // Without a working volume there is no reference point.
    let sandbox = Sandbox::new();
    let tile = "[[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n";
    sandbox.write("bare.toml", &format!("format = 1\nname = \"bare\"\n{tile}"));
    let said = sandbox.run(&["export", "bare.toml", "-o", "bare.py"]);
    assert_eq!((said.status, said.stdout.as_str()), (0, ""));
    assert!(sandbox.read("bare.py").contains("\nREFERENCE_MM = None\n"));
}

/// Also for an archive that is not complete when the disk is full.
#[cfg(target_os = "linux")]
#[test]
fn full_disk_prints_one_message() {
    for format in ["csv", "json", "npy", "npz", "vtk"] {
        let said = Sandbox::new().run(&["field", &shipped("single-tile"), "--format", format, "-o", "/dev/full"]);
        said.refuses("cannot write /dev/full: No space left on device");
        assert_eq!(said.stderr.lines().count(), 1, "{format}: {}", said.stderr);
    }
}
