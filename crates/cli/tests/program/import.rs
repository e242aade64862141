//! `import`: blocks from a table become the tiles of a layout.

use serde_json::Value;

use crate::{RunOutput, Sandbox, rows};

const NO_EULER: &str = "--euler is given, and there are no columns rx_deg, ry_deg, rz_deg or euler_1_deg, euler_2_deg, \
    euler_3_deg (found: x_mm,y_mm,z_mm,size_x_mm";

const HEAD: &str = "name,x_mm,y_mm,z_mm,size_x_mm,size_y_mm,size_z_mm,jx_t,jy_t,jz_t";

fn import(csv: &str, options: &[&str]) -> (Sandbox, RunOutput) {
    let sandbox = Sandbox::new();
    sandbox.write("blocks.csv", csv);
    let said = sandbox.run(&[&["import", "blocks.csv", "-o", "film.toml"], options].concat());
    (sandbox, said)
}

/// The tiles of the layout that `import` writes, as `tiles --format json` prints them.
#[track_caller]
fn tiles(csv: &str, options: &[&str]) -> Vec<Value> {
    let (sandbox, said) = import(csv, options);
    assert_eq!((said.status, said.stdout.as_str()), (0, ""), "{}", said.stderr);
    let said = sandbox.run(&["tiles", "film.toml", "--format", "json"]);
    let json: Value = serde_json::from_str(&said.stdout).expect("JSON");
    json["tile"].as_array().expect("tiles").clone()
}

#[track_caller]
fn refused(csv: &str, options: &[&str], messages: &[&str]) {
    let (sandbox, said) = import(csv, options);
    messages.iter().for_each(|message| said.refuses(message));
    assert_eq!(sandbox.files(), ["blocks.csv"]);
}

#[test]
fn numbers_of_blocks_come_back_to_the_last_digit() {
    let csv = format!("{HEAD}\nleft,0.1,-2,1e-3,3.3,1.7,0.30000000000000004,0.12,-0.0,1e-9\n,9,0,0,1,2,3,0,0,1\n");
    let found = tiles(&csv, &[]);
    assert_eq!(
        found,
        [
            serde_json::json!({ "name": "left", "position_mm": [0.1, -2.0, 1e-3],
                "size_mm": [3.3, 1.7, 0.30000000000000004], "polarization_t": [0.12, -0.0, 1e-9] }),
            serde_json::json!({ "name": "tile-2", "position_mm": [9.0, 0.0, 0.0], "size_mm": [1.0, 2.0, 3.0],
                "polarization_t": [0.0, 0.0, 1.0] }),
        ]
    );
}

#[test]
fn units_are_those_of_the_columns() {
    let csv =
        "x_m;y_m;z_m;size_x [cm];size_y (mm);size_z/um;jx_mT;jy_mT;jz_mT\n0,0033;0;-0,001;0,33;1,7;500;120;-3,5;0\n";
    let tile = &tiles(csv, &[])[0];
    assert_eq!(tile["position_mm"], serde_json::json!([3.3, 0.0, -1.0]));
    assert_eq!(tile["size_mm"], serde_json::json!([3.3, 1.7, 0.5]));
    assert_eq!(tile["polarization_t"], serde_json::json!([0.12, -0.0035, 0.0]));
    for (unit, strength) in [
        ("mx_a_per_m,my_A/m,mz (A/m)", "95492.96"),
        ("mx_ka_per_m,my_kA/m,mz [kA/m]", "95.49296"),
        ("Mx [A m^-1],My (A m-1),Mz_A/m", "95492.96"),
        ("Mx [kA m^-1],My [kA m-1],mz_kA/m", "95.49296"),
    ] {
        let csv = format!("x,y,z,size_x,size_y,size_z,{unit}\n0,0,0,1,1,1,{strength},0,0\n");
        let tile = &tiles(&csv, &["--unit", "m"])[0];
        // mu0 = 1.25663706127e-6 T m/A.
        let j = tile["polarization_t"][0].as_f64().expect("a number");
        assert!((j - 95492.96 * 1.25663706127e-6).abs() < 1e-15, "{j}");
        assert_eq!(tile["size_mm"], serde_json::json!([1000.0, 1000.0, 1000.0]));
    }
}

/// One rotation, 120 degrees about (1, 1, 1), in every form, has one field; no rotation another.
#[test]
fn rotations_in_every_form_are_the_same() {
    let block = "1,2,3,3,2,1,0.1,0.2,0.3";
    let columns = "x_mm,y_mm,z_mm,size_x_mm,size_y_mm,size_z_mm,jx_t,jy_t,jz_t";
    let field = |rotation: &str, cells: &str, options: &[&str]| {
        let (sandbox, said) = import(&format!("{columns}{rotation}\n{block}{cells}\n"), options);
        assert_eq!(said.status, 0, "{}", said.stderr);
        sandbox.write("points.csv", "x_mm,y_mm,z_mm\n5,0,-4\n");
        rows(&sandbox.run(&["field", "film.toml", "--points", "points.csv"]).stdout)[0][3..].to_vec()
    };
    let wanted = field(",qx,qy,qz,qw", ",0.5,0.5,0.5,0.5", &[]);
    let plain = field("", "", &[]);
    let near = |found: &[f64]| found.iter().zip(&wanted).all(|(f, w)| (f - w).abs() < 1e-14 * w.abs());
    assert!(!near(&plain));
    assert_eq!(field(",qx,qy,qz,qw", ",,,,", &[]), plain);
    assert_eq!(field(",angle_deg,axis_x,axis_y,axis_z", ",0,1,2,3", &[]), plain);
    for (rotation, cells, options) in [
        (",qw,qx,qy,qz", ",2,2,2,2", &[][..]),
        (",quat_x,quat_y,quat_z,quat_w", ",-0.5,-0.5,-0.5,-0.5", &[]),
        (",Q_x,Q_y,quaternion_z,quatW", ",1,1,1,1", &[]),
        (",angle_rad,axis_x,axis_y,axis_z", ",2.0943951023931957,7,7,7", &[]),
        (",rx (°),rz (rad)", ",90,1.5707963267948966", &["--euler", "xyz"]),
        (",euler_1_rad,euler_2_deg,euler_3 [°]", ",0,90,90", &["--euler", "zxz"]),
        (",angle_deg,axis_x,axis_y,axis_z", ",120,7,7,7", &[]),
        (",rx_deg,ry_deg,rz_deg", ",90,0,90", &["--euler", "xyz"]),
        (",rx_deg,ry_deg,rz_deg", ",0,90,90", &["--euler", "YZX"]),
        (",euler_1_deg,euler_2_deg,euler_3_deg", ",0,90,90", &["--euler", "zxz"]),
        (",r11,r12,r13,r21,r22,r23,r31,r32,r33", ",0,0,1,1,0,0,0,1,0", &[]),
    ] {
        let found = field(rotation, cells, options);
        assert!(near(&found), "{rotation} {options:?}: {found:?}, not {wanted:?}");
    }
}

#[test]
fn written_layout_keeps_the_form_and_its_source() {
    let csv = format!("{HEAD},qx,qy,qz,qw\na,0,0,0,1,1,1,0,0,1,0.5,0.5,0.5,0.5\nb,5,0,0,1,1,1,0,0,1,0,0,0,1\n");
    let (sandbox, said) = import(&csv, &["--name", "forty blocks"]);
    assert!(said.stderr.contains("wrote film.toml: 2 tiles"), "{}", said.stderr);
    let text = sandbox.read("film.toml");
    let layout: toml::Table = toml::from_str(&text).expect("TOML");
    assert_eq!(layout["name"].as_str(), Some("forty blocks"));
    assert!(layout["history"][0].as_str().expect("a text").starts_with("imported from blocks.csv by magsplice"));
    assert_eq!(layout["tile"][0]["rotation"]["quaternion"].as_array().map(Vec::len), Some(4));
    assert!(layout["tile"][1].get("rotation").is_none(), "{text}");
    assert_eq!(sandbox.run(&["check", "film.toml"]).status, 0);
    let said = sandbox.run(&["import", "blocks.csv"]);
    assert_eq!(said.stdout.replace("name = \"blocks\"", "name = \"forty blocks\""), text);
    assert_eq!(sandbox.run(&["import", "blocks.csv", "-q", "-o", "film.toml"]).stderr, "");
    sandbox.run(&["import", "blocks.csv", "-o", "blocks.csv"]).refuses("it is an input, which would be lost");
}

#[test]
fn every_bad_row_is_named() {
    let csv = format!(
        "{HEAD},qx,qy,qz,qw\na,0,0,0,1,-1,0,0,0,1,0,0,0,1\nb,zero,0,0,1,1,1,0,nan,1,0,0,0,1\nc,9,0,0,1,1,1,0,0,1,0,0,0,0\n\
         d,5,0,0\ne,19,0,0,1,1,1,0,0,1,0,0,,1\n"
    );
    refused(
        &csv,
        &[],
        &[
            "blocks.csv: line 2: size_y_mm = \"-1\", must be greater than 0; size_z_mm = \"0\", must be greater than 0",
            "blocks.csv: line 3: x_mm = \"zero\", must be a finite number; jy_t = \"nan\", must be a finite number",
            "blocks.csv: line 4: quaternion = [0.0, 0.0, 0.0, 0.0], must be finite and not zero",
            "blocks.csv: line 5: has 4 fields, must have 14 like line 1",
            "blocks.csv: line 6: qz = \"\", must be a finite number",
        ],
    );
    let many: String = (0..1000).map(|i| format!("t{i},0,0,0,1,1,-1,0,0,1\n")).collect();
    refused(&format!("{HEAD}\n{many}"), &[], &["line 21: size_z_mm", "blocks.csv: and 980 more"]);
    let matrix = format!("{HEAD},r11,r12,r13,r21,r22,r23,r31,r32,r33\na,0,0,0,1,1,1,0,0,1,1,0,0,0,1,0.01,0,0,1\n");
    refused(&matrix, &[], &["line 2: matrix times its transpose deviates by 1.0e-2 from the unit matrix"]);
}

#[test]
fn blocks_that_overlap_are_named_with_their_lines() {
    let csv = format!("{HEAD}\na,0,0,0,1,1,1,0,0,1\n# a comment\nb,0.75,0,0,1,1,1,0,0,1\n");
    refused(&csv, &[], &["blocks.csv: line 4: tile \"b\": overlaps tile \"a\" before it by 0.25 mm"]);
    let csv = format!("{HEAD}\na,0,0,0,1,1,1,0,0,1\na,5,0,0,1,1,1,0,0,1\n");
    refused(&csv, &[], &["blocks.csv: line 2: tile \"a\": 2 tiles have this name"]);
}

/// Touching blocks of a table with few decimals overlap by its rounding. The message gives an
/// option that is enough.
#[test]
fn overlaps_by_rounded_numbers_are_allowed_on_request() {
    let ring: String = (0..22)
        .map(|block| {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(block) / 22.0).sin_cos();
            let radius = 5.0 / (std::f64::consts::PI / 22.0).tan() + 5.0;
            let deg = 360.0 * f64::from(block) / 22.0;
            format!("m{block},{:.6},{:.6},0,10,10,10,1.3,0,0,{deg:.4}\n", radius * cos, radius * sin)
        })
        .collect();
    let inches: String =
        (0..9).map(|i| format!("b{i},{:.2},0,0,8.47,1,1,0,0,1,0\n", 25.4 / 3.0 * f64::from(i))).collect();
    for rows in [ring, inches] {
        let csv = format!("{HEAD},rz_deg\n{rows}");
        let (sandbox, said) = import(&csv, &[]);
        said.refuses("perhaps because their numbers are rounded");
        let option = said.stderr.split("import --overlap ").nth(1).expect("the option");
        let depth = option.split('`').next().expect("its value").to_owned();
        let said = sandbox.run(&["import", "blocks.csv", "-o", "film.toml", "--overlap", &depth]);
        assert_eq!(said.status, 0, "{}", said.stderr);
        let kept = sandbox.read("film.toml");
        let kept = kept.lines().find_map(|line| line.strip_prefix("overlap_mm = ")).expect("the key");
        assert_eq!(kept.parse::<f64>(), depth.parse());
        assert_eq!(sandbox.run(&["tiles", "film.toml"]).status, 0);
    }
    let csv = format!("{HEAD}\na,0,0,0,1,1,1,0,0,1\n");
    refused(&csv, &["--overlap", "-1um"], &["overlap_mm = -0.001, must be a finite number of at least 0"]);
    import(&csv, &["--overlap", "1kg"]).1.refuses_arguments("has the unit kg, must be a length");
}

/// A ring of computed positions needs no option.
#[test]
fn rings_of_computed_positions_are_taken() {
    for count in [22, 36, 255] {
        let pitch_deg = 360.0 / f64::from(count);
        let radius = 5.0 / (std::f64::consts::PI / f64::from(count)).tan() + 5.0;
        let mut csv = format!("{HEAD},rz_deg\n");
        for block in 0..count {
            let deg = f64::from(block) * pitch_deg;
            let (sin, cos) = deg.to_radians().sin_cos();
            csv += &format!("m{block},{:?},{:?},0,10,10,10,1.3,0,0,{deg:?}\n", radius * cos, radius * sin);
        }
        let (_, said) = import(&csv, &[]);
        assert_eq!(said.status, 0, "{count}: {}", said.stderr);
    }
}

#[test]
fn columns_that_are_missing_or_contradict_are_named() {
    let size = "size_x_mm,size_y_mm,size_z_mm";
    let j = "jx_t,jy_t,jz_t";
    let cases: &[(&str, &[&str], &[&str])] = &[
        (
            &format!("x_mm,y_mm,z_mm,{j}"),
            &[],
            &["line 1: no columns size_x_mm, size_y_mm, size_z_mm of the size (found: "],
        ),
        (
            &format!("x_mm,y_mm,z_mm,{size}"),
            &[],
            &["line 1: no columns jx_t, jy_t, jz_t of the polarization, or columns mx_a_per_m, "],
        ),
        (&format!("x_mm,z_mm,{size},{j}"), &[], &["line 1: no column y_mm of the position (found: x_mm,z_mm,"]),
        (
            &format!("x,y,z,{size},{j}"),
            &[],
            &[
                "the columns x, y, z of the position have no unit: rename, as in x_mm, or give --unit, with one of: mm, cm, m",
            ],
        ),
        (
            &format!("x_mm,y_mm,z_mm,{size},{j}"),
            &["--unit", "m"],
            &[
                "--unit m contradicts the columns x_mm, y_mm, z_mm of the position",
                "size_x_mm, size_y_mm, size_z_mm of the size",
            ],
        ),
        (&format!("x_mm,y_mm,z_mm,{size},jx,jy,jz"), &[], &["the columns jx, jy, jz of the polarization have no unit"]),
        (
            &format!("x_mm,y_mm,z_mm,{size},jx_v,jy_v,jz_v"),
            &[],
            &["the columns jx_v, jy_v, jz_v of the polarization have the unit v, must be one of: T, mT,"],
        ),
        (&format!("x_mm,y_mm,z_mm,{size},{j},mx_A/m,my_A/m,mz_A/m"), &[], &["has more than one of polarization"]),
        (&format!("x_mm,y_mm,z_mm,{size},{j},qx,qy,qz"), &[], &["no column qw of the quaternion"]),
        (
            &format!("x_mm,y_mm,z_mm,{size},{j},rx_deg,ry_deg,rz_deg"),
            &[],
            &["Euler angles have no order: give --euler xyz"],
        ),
        (
            &format!("x_mm,y_mm,z_mm,{size},{j},rx_deg,ry_deg,rz_deg"),
            &["--euler", "zxz"],
            &["fit two rotations about z of the order zxz: name its angles euler_1_deg, euler_2_deg"],
        ),
        (
            &format!("x_mm,y_mm,z_mm,{size},{j},rx_grad,ry_deg,rz_deg"),
            &["--euler", "xyz"],
            &["the column rx_grad of the Euler angles has the unit grad, must be one of: deg, °, rad"],
        ),
        (&format!("x_mm,y_mm,z_mm,{size},{j},angle_deg"), &[], &["angle has no columns axis_x, axis_y, axis_z"]),
        (&format!("x_mm,y_mm,z_mm,{size},{j}"), &["--euler", "xyz"], &[NO_EULER]),
        (
            &format!("x_mm,y_mm,z_mm,{size},{j},euler_1_deg"),
            &["--euler", "xyz"],
            &["no columns euler_2_deg, euler_3_deg of the Euler angles"],
        ),
        (&format!("x_mm,y_mm,z_mm,{size},{j},rx_deg,rz_deg"), &[], &["Euler angles have no order: give --euler xyz"]),
        (
            &format!("x_mm,y_mm,z_mm,{size},{j},qx,qy,qz,qw,axis_x,axis_y,axis_z,angle_deg"),
            &[],
            &["in more than one form"],
        ),
    ];
    for (names, options, messages) in cases {
        refused(&format!("{names}\n1,2,3\n"), options, messages);
    }
    import(HEAD, &["--euler", "xxz"]).1.refuses_arguments("must be three letters");
    refused("", &[], &["blocks.csv: is empty, must begin with the line x_mm,y_mm,z_mm,size_x_mm"]);
    refused(&format!("{HEAD}\n"), &[], &["has no blocks below its names of columns"]);
}

/// tests/readback runs the script with magpylib.
#[test]
fn script_for_magpylib_collections_needs_no_layout() {
    let sandbox = Sandbox::new();
    let printed = sandbox.run(&["export", "--to", "magpylib-import"]);
    assert_eq!((printed.status, printed.stderr.as_str()), (0, ""));
    let version = format!("\nPROGRAM = \"{}\"\n", env!("CARGO_PKG_VERSION"));
    assert!(printed.stdout.contains(&version) && printed.stdout.contains("def write_blocks(collection, path):"));
    assert_eq!(sandbox.run(&["export", "--to", "magpylib-import", "-o", "script.py"]).status, 0);
    assert_eq!(sandbox.read("script.py"), printed.stdout);
    let film = crate::shipped("single-tile");
    sandbox.run(&["export", &film, "--to", "magpylib-import"]).refuses("and takes no layout");
    sandbox.run(&["export", "--to", "magpylib"]).refuses("--to magpylib needs a layout file");
    assert!(
        sandbox.run(&["export", &film, "-o", "film.py"]).status == 0 && sandbox.read("film.py").contains("TILES = [")
    );
}

#[test]
fn columns_that_are_not_read_are_told() {
    let (_, said) = import(&format!("{HEAD},grade,angel_deg\na,0,0,0,1,1,1,0,0,1,N35,30\n"), &[]);
    assert!(
        said.status == 0 && said.stderr.contains("columns that were not read: grade, angel_deg"),
        "{}",
        said.stderr
    );
}

/// Without these columns the blocks would stand unrotated.
#[test]
fn columns_that_look_like_a_rotation_are_read_or_refused() {
    let read = "name a rotation qx, qy, qz, qw (or quat_x, ...; qw is the scalar), axis_x, axis_y, axis_z, angle_deg,";
    for (names, found) in [
        ("q0,q1,q2,q3", "columns q0, q1, q2, q3 look like a rotation and are not read"),
        ("qi,qj,qk,qr", "columns qi, qj, qk, qr look like a rotation and are not read"),
        ("quat_1,quat_2,quat_3,quat_4", "columns quat_1, quat_2, quat_3, quat_4 look like a rotation"),
        ("qx,qy,qz,qw,roll", "column roll looks like a rotation and is not read"),
        ("rotation", "column rotation looks like a rotation and is not read"),
        ("alpha,Beta (deg),gamma", "columns alpha, Beta (deg), gamma look like"),
        ("yaw_deg,pitch_deg", "columns yaw_deg, pitch_deg look like"),
        ("phi,theta,psi", "columns phi, theta, psi look like"),
        ("euler_x,angle_z_deg", "euler_x"),
    ] {
        let cells = ",1".repeat(names.split(',').count());
        let csv = format!("{HEAD},{names}\na,0,0,0,1,1,1,0,0,1{cells}\n");
        refused(&csv, &[], &[found]);
        if !names.contains("angle") {
            refused(&csv, &[], &[read]);
        }
    }
    refused(&format!("{HEAD},qx,qy,qz,qw,quat_w\n"), &[], &["more than one column qw of the quaternion: qw, quat_w"]);
    // Properties that only begin like one.
    let (_, said) = import(&format!("{HEAD},quality,rotor\na,0,0,0,1,1,1,0,0,1,A,2\n"), &[]);
    assert!(said.status == 0 && said.stderr.contains("columns that were not read: quality, rotor"), "{}", said.stderr);
}

/// The angles of the other axes are 0, and the order makes no difference.
#[test]
fn one_euler_angle_needs_no_order() {
    let csv = format!("{HEAD},rz_deg\na,0,0,0,1,1,1,0,0,1,30\nb,5,0,0,1,1,1,0,0,1,\n");
    let found = tiles(&csv, &[]);
    assert_eq!(found[0]["rotation"], serde_json::json!({ "euler_deg": [0.0, 0.0, 30.0], "order": "xyz" }));
    assert!(found[1].get("rotation").is_none(), "{}", found[1]);
    let found = tiles(&csv, &["--euler", "zyx"]);
    assert_eq!(found[0]["rotation"], serde_json::json!({ "euler_deg": [30.0, 0.0, 0.0], "order": "zyx" }));
}

/// A rotation about one axis is the same in every order that has this axis.
#[test]
fn one_euler_angle_goes_with_orders_of_a_repeated_axis() {
    let with =
        |column: &str, order: &str| tiles(&format!("{HEAD},{column}\na,0,0,0,1,1,1,0.1,0,0,30\n"), &["--euler", order]);
    for (column, order, angles) in
        [("rz_deg", "zxz", [30.0, 0.0, 0.0]), ("rz_deg", "ZYZ", [30.0, 0.0, 0.0]), ("rx_deg", "zxz", [0.0, 30.0, 0.0])]
    {
        let rotation = serde_json::json!({ "euler_deg": angles, "order": order });
        assert_eq!(with(column, order)[0]["rotation"], rotation, "{column} {order}");
    }
    let refused = |columns: &str, cells: &str, message: &str| {
        import(&format!("{HEAD},{columns}\na,0,0,0,1,1,1,0.1,0,0,{cells}\n"), &["--euler", "zxz"]).1.refuses(message);
    };
    refused(
        "ry_deg",
        "30",
        "the column ry is a rotation about y, which the order zxz does not have: leave out --euler, or give the angles of \
         zxz as euler_1_deg, euler_2_deg, euler_3_deg",
    );
    refused("rx_deg,rz_deg", "10,30", "the columns rx, rz fit two rotations about z of the order zxz");
}

#[test]
fn euler_angles_by_axis_and_by_turn_are_the_same() {
    let rotation = |columns: &str, cells: &str| {
        let csv = format!("{HEAD},{columns}\na,0,0,0,1,1,1,0,0,1,{cells}\n");
        tiles(&csv, &["--euler", "zyx"])[0]["rotation"].clone()
    };
    let by_axis = rotation("rx_deg,ry_deg,rz_deg", "10,20,30");
    assert_eq!(by_axis, serde_json::json!({ "euler_deg": [30.0, 20.0, 10.0], "order": "zyx" }));
    assert_eq!(by_axis, rotation("euler_1_deg,euler_2_deg,euler_3_deg", "30,20,10"));
}

#[test]
fn help_and_docs_state_the_mu0_of_the_program() {
    let found = tiles("x_mm,y_mm,z_mm,dx_mm,dy_mm,dz_mm,mx_A/m,my_A/m,mz_A/m\n0,0,0,1,1,1,0,0,1\n", &[]);
    let mu0 = format!("{:e}", found[0]["polarization_t"][2].as_f64().expect("a number"));
    let docs = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/file-formats.md");
    for text in [std::fs::read_to_string(docs).expect("docs"), Sandbox::new().run(&["import", "--help"]).stdout] {
        assert!(text.contains(&format!("mu0 = {mu0} T m/A")), "{mu0} is not in {text}");
    }
}

#[test]
fn metres_under_names_in_mm_are_remarked_on() {
    let blocks =
        |head: &str| format!("{head}\na,0,0,0,0.0033,0.001,0.002,0,0,1\nb,0.005,0,0,0.001,0.001,0.001,0,0,1\n");
    let remark = "magsplice: warning: blocks.csv: the largest block measures 0.0033 mm, less than 0.02 mm; \
                  did you mean 3.3 mm, which is 0.0033 m?\n";
    let (_, said) = import(&blocks(HEAD), &[]);
    assert!(said.status == 0 && said.stderr.contains(remark), "{}", said.stderr);
    assert_eq!(import(&blocks(HEAD), &["-q"]).1.stderr, "");
    // Who writes um means it.
    let in_um = "x_um,y_um,z_um,dx_um,dy_um,dz_um,jx_t,jy_t,jz_t\n0,0,0,3,3,3,0,0,1\n".to_owned();
    // In metres these are ordinary blocks, and one ordinary block makes the others small ones.
    let one_large = format!("{}c,9,0,0,1,1,1,0,0,1\n", blocks(HEAD));
    for csv in [blocks(&HEAD.replace("_mm", "_m")), one_large, in_um] {
        let (_, said) = import(&csv, &[]);
        assert!(said.status == 0 && !said.stderr.contains("warning"), "{}", said.stderr);
    }
}

/// A remanence and angles, as cut lists have them, in units of catalogues.
#[test]
fn strength_and_direction_are_a_polarization() {
    let place = "x_in,y_in,z_in,size_x_in,size_y_in,size_z_in";
    let rows = "a,0,0,0,0.1,0.1,0.1,12,90,0\nb,1,0,0,0.1,0.1,0.1,13,0,90\n";
    let found = tiles(&format!("name,{place},strength_kg,direction_deg,tilt_deg\n{rows}"), &["-q"]);
    for (tile, polarization_t) in found.iter().zip([[0.0, 1.2, 0.0], [0.0, 0.0, 1.3]]) {
        let number = |key: &str, axis: usize| tile[key][axis].as_f64().expect("a number");
        for (axis, component) in polarization_t.into_iter().enumerate() {
            assert!((number("polarization_t", axis) - component).abs() < 1e-15, "{tile}");
            assert!((number("size_mm", axis) - 2.54).abs() < 1e-14, "{tile}");
        }
    }
    let without_tilt = format!("{place},Br (T),direction_deg\n0,0,0,1,1,1,1.2,45\n");
    assert_eq!(import(&without_tilt, &["-q"]).1.status, 0);
    let bare = "x,y,z,dx,dy,dz,jx,jy,jz\n0,0,0,1,1,1,0,0,1.2\n";
    assert_eq!(import(bare, &["-q", "--unit", "mm,T"]).1.status, 0);
    refused(
        &format!("{place},strength_t\n0,0,0,1,1,1,1\n"),
        &[],
        &["line 1: no column direction_deg of the direction"],
    );
}

#[test]
fn magnetization_without_a_unit_is_one_fault() {
    let (_, said) = import("x_mm,y_mm,z_mm,dx_mm,dy_mm,dz_mm,Mx,My,Mz\n0,0,0,1,1,1,0,0,1\n", &[]);
    said.refuses("the columns Mx, My, Mz of the magnetization have no unit");
    assert_eq!(said.stderr.lines().count(), 1, "{}", said.stderr);
}
