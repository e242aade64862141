//! Lattices, expectations and findings: what a table means, and each rule where it is just broken.

use glam::DVec3;
use magsplice_layout::{Finding, Layout, schema};

const HEAD: &str = "format = 1\nname = \"test\"\n";
const IDEAL: &str = "[ideal]\nwavelength_mm = 10\nthickness_mm = 1\namplitude_t = 0.12\n";
const VOLUME: &str = "[volume]\nx_mm = [-2, 2]\ny_mm = [-2, 2]\nz_mm = [-5, -3]\nstep_mm = 0.5\n";
const TILE: &str = "[[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n";

fn parse(tables: &str) -> Result<Layout, String> {
    Layout::parse(&format!("{HEAD}{tables}"), "test.toml").map_err(|error| error.to_string())
}

/// A lattice of 2 x 3 cells, of which the first has no pattern.
fn lattice(magnitude: &str) -> Result<Layout, String> {
    parse(&format!(
        "[[lattice]]\nstart_mm = [1, -2, 0.5]\nheight_mm = 2\n{magnitude}\n\
         x = [{{ widths_mm = [1, 3], pattern = [0, 3] }}]\n\
         y = [{{ widths_mm = [2], pattern = [0] }}, {{ widths_mm = [0.5], pattern = [4], times = 2 }}]\n"
    ))
}

#[test]
fn a_lattice_has_a_tile_for_each_cell_with_a_pattern() {
    let tiles = lattice("component_t = 0.5").expect("a valid lattice").tiles;
    // By hand: columns from 1 to 2 and 2 to 5, rows from -2 to 0, 0 to 0.5 and 0.5 to 1.
    let wanted = [
        ([1.5, 0.25], [1.0, 0.5], [0.0, 2.0]),
        ([1.5, 0.75], [1.0, 0.5], [0.0, 2.0]),
        ([3.5, -1.0], [3.0, 2.0], [1.5, 0.0]),
        ([3.5, 0.25], [3.0, 0.5], [1.5, 2.0]),
        ([3.5, 0.75], [3.0, 0.5], [1.5, 2.0]),
    ];
    assert_eq!(tiles.len(), wanted.len());
    for (named, ([x, y], [width, depth], [j_x, j_y])) in tiles.iter().zip(wanted) {
        assert_eq!(named.tile.position(), DVec3::new(x, y, 1.5));
        assert_eq!(named.tile.size(), DVec3::new(width, depth, 2.0));
        assert_eq!(named.tile.polarization_t(), DVec3::new(j_x, j_y, 0.0));
    }
    let tiles = lattice("strength_t = 0.5").expect("a valid lattice").tiles;
    for named in &tiles {
        // Three units of rounding in each of the components.
        assert!((named.tile.polarization_t().length() - 0.5).abs() < 3.0 * f64::EPSILON, "{named:?}");
    }
    let direction = tiles[3].tile.polarization_t();
    assert!((direction.y / direction.x - 4.0 / 3.0).abs() < 4.0 * f64::EPSILON, "{direction}");
}

#[test]
fn rules_of_lattices_are_told_together() {
    let message = parse(
        "[[lattice]]\nstart_mm = [inf, 0, 0]\nheight_mm = 0\nstrength_t = 1\n\
         x = [{ widths_mm = [], pattern = [], times = 0 }, { widths_mm = [1], pattern = [1, 0] }]\ny = []\n",
    )
    .expect_err("five rules are broken");
    for rule in [
        "x[0] has no widths_mm",
        "x[0].times = 0, must be at least 1",
        "x[1] has 1 widths_mm and 2 pattern entries",
        "y has no sections",
        "start_mm[0] = inf",
        "height_mm = 0, must be greater than 0",
    ] {
        assert_eq!(message.matches(rule).count(), 1, "{rule} in {message}");
    }
    let empty =
        "[[lattice]]\nstart_mm = [0, 0, 0]\nheight_mm = 1\nstrength_t = 1\nx = [{ widths_mm = [1], pattern = [0] }]\n";
    assert!(parse(empty).expect_err("no tile").contains("has no tiles: pattern is zero everywhere"));
    for both_or_none in ["", "strength_t = 1\ncomponent_t = 1"] {
        assert!(lattice(both_or_none).expect_err("one is wanted").contains("must give one of strength_t"));
    }
}

#[test]
fn expectations_are_read_and_their_limits_are_rules() {
    let expect = |keys: &str| parse(&format!("{IDEAL}{VOLUME}[expect]\n{keys}\n{TILE}"));
    let given = expect(
        "uniformity_rmse = { r_y = 0.25 }\ndisplacement_rmse_mm = { z = 0 }\namplitude = { min = -1 }\n\
         field = { file = \"field.csv\", within = 1e-9 }\nclearance_mm = { min = 0.5 }",
    );
    let given = given.expect("valid expectations").expectations;
    assert_eq!(given.bounds.uniformity_rmse.to_array(), [None, Some(0.25), None]);
    assert_eq!(given.bounds.displacement_rmse_mm.to_array(), [None, None, Some(0.0)]);
    assert_eq!((given.bounds.least_amplitude, given.least_clearance_mm), (Some(-1.0), Some(0.5)));
    let field = given.field.expect("given");
    assert_eq!((field.file.to_str(), field.within), (Some("field.csv"), 1e-9));
    for (keys, rule) in [
        ("uniformity_rmse = { s_z = -1 }", "uniformity_rmse.s_z = -1"),
        ("displacement_rmse_mm = { x = inf }", "displacement_rmse_mm.x = inf"),
        ("amplitude = { min = inf }", "amplitude.min = inf"),
        ("clearance_mm = { min = nan }", "clearance_mm.min = NaN"),
        ("field = { file = \"\", within = 1 }", "field.file is empty"),
        ("field = { file = \"a\", within = 0 }", "field.within = 0"),
        ("field = { file = \"a\", within = inf }", "field.within = inf"),
    ] {
        let message = expect(keys).expect_err("a broken rule");
        assert!(message.contains(rule) && message.lines().count() == 1, "{keys:?}: {message}");
    }
}

#[test]
fn findings_name_tiles_in_the_volume_and_tiles_without_polarization() {
    let volume = "[volume]\nx_mm = [1, 4]\ny_mm = [2, 8]\nz_mm = [-5, -3]\nstep_mm = 0.5\n";
    let tile = |at: [f64; 3], j: f64| {
        format!("[[tile]]\nposition_mm = {at:?}\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, {j}]\n")
    };
    let found = |tiles: &str| {
        let layout = parse(&format!("{volume}{tiles}")).expect("a valid layout");
        layout.findings.iter().map(Finding::to_string).collect::<Vec<String>>()
    };
    // Half a side is 0.5: tiles just outside of each face of the volume, and just inside.
    let centre = DVec3::new(2.5, 5.0, -4.0);
    let half = DVec3::new(1.5, 3.0, 1.0);
    for axis in DVec3::AXES {
        for side in [-1.0, 1.0] {
            let at = |beyond: f64| (centre + side * axis * (half.dot(axis) + beyond)).to_array();
            assert_eq!(found(&tile(at(0.501), 1.0)), [""; 0]);
            let inside = found(&tile(at(0.499), 1.0));
            assert!(inside.len() == 1 && inside[0].ends_with("reaches into the working volume"), "{inside:?}");
        }
    }
    let without = found(&tile([20.0, 0.0, 0.0], 0.0));
    assert!(without.len() == 1 && without[0].ends_with("has no polarization, so no field"), "{without:?}");
}

#[test]
fn the_schema_has_no_null_and_no_broken_lines() {
    fn visit(value: &serde_json::Value, path: &str) {
        match value {
            serde_json::Value::Object(map) => {
                if let Some(description) = map.get("description").and_then(|text| text.as_str()) {
                    assert!(!description.contains('\n'), "{path}: {description}");
                }
                assert_ne!(map.get("type").and_then(|name| name.as_str()), Some("null"), "{path}");
                if let Some(types) = map.get("type").and_then(|types| types.as_array()) {
                    assert!(types.len() > 1 && !types.iter().any(|name| name == "null"), "{path}: {types:?}");
                }
                if let Some(choices) = map.get("anyOf").and_then(|choices| choices.as_array()) {
                    assert!(choices.len() > 1, "{path}: {choices:?}");
                }
                map.iter().for_each(|(key, value)| visit(value, &format!("{path}/{key}")));
            }
            serde_json::Value::Array(list) => list.iter().for_each(|value| visit(value, path)),
            _ => (),
        }
    }
    let schema = schema().to_value();
    // Optional keys keep the type of their value.
    assert!(schema["properties"]["ideal"]["$ref"].is_string(), "{}", schema["properties"]["ideal"]);
    visit(&schema, "");
}

/// A tile at (1, 2, 3) with these further keys.
fn repeated(keys: &str) -> Result<Layout, String> {
    parse(&format!(
        "[[tile]]\nname = \"t\"\nposition_mm = [1, 2, 3]\nsize_mm = [1, 2, 3]\npolarization_t = [0.25, 0.5, 1]\n{keys}\n"
    ))
}

#[test]
fn a_grid_repeats_a_tile_and_alternates_its_polarization() {
    let keys = "grid = { count = [2, 1, 3], pitch_mm = [4, 5, -6], alternate = [\"x\", \"z\"] }";
    let tiles = repeated(keys).expect("a valid grid").tiles;
    let found: Vec<_> = tiles.iter().map(|t| (t.name.as_str(), t.tile.position(), t.tile.polarization_t().z)).collect();
    let at = |x: f64, z: f64| DVec3::new(x, 2.0, z);
    let wanted = [
        ("t-x1-z1", at(1.0, 3.0), 1.0),
        ("t-x1-z2", at(1.0, -3.0), -1.0),
        ("t-x1-z3", at(1.0, -9.0), 1.0),
        ("t-x2-z1", at(5.0, 3.0), -1.0),
        ("t-x2-z2", at(5.0, -3.0), 1.0),
        ("t-x2-z3", at(5.0, -9.0), -1.0),
    ];
    assert_eq!(found, wanted);
    let along_one = "grid = { count = [2, 2, 1], pitch_mm = [4, 5, 0], alternate = [\"x\"] }";
    let signs = repeated(along_one).expect("a valid grid").tiles.into_iter().map(|t| t.tile.polarization_t().y);
    assert_eq!(signs.collect::<Vec<_>>(), [0.5, 0.5, -0.5, -0.5]);
}

#[test]
fn rules_of_repetitions_are_told() {
    for (keys, rule) in [
        ("grid = { count = [2, 0, 1], pitch_mm = [4, 5, 6] }", "grid.count = [2, 0, 1], must be at least 1"),
        ("grid = { count = [2, 1, 1], pitch_mm = [4, nan, 6] }", "grid.pitch_mm"),
        ("grid = { count = [2, 1, 1], pitch_mm = [4, 5, 6], alternate = [\"y\", \"y\"] }", "names \"y\" twice"),
        ("mirror = { axes = [] }", "mirror.axes is empty"),
        ("mirror = { axes = [\"x\", \"z\", \"x\"] }", "mirror.axes names \"x\" twice"),
        ("mirror = { axes = [\"x\"], at_mm = [inf, 0, 0] }", "mirror.at_mm"),
    ] {
        let message = repeated(keys).expect_err("a broken rule");
        assert!(message.contains(rule) && message.lines().count() == 1, "{keys}: {message}");
    }
}

#[test]
fn a_mirror_image_has_the_reflected_arrow_or_keeps_it() {
    let image = |keys: &str| repeated(keys).expect("a valid mirror").tiles.remove(1);
    let turned = "rotation = { axis = [1, 2, 2], angle_deg = 40 }\n";
    for (polarization, arrow) in [
        ("reflect", DVec3::new(-0.25, 0.5, 1.0)),
        ("axial", DVec3::new(0.25, -0.5, -1.0)),
        ("keep", DVec3::new(0.25, 0.5, 1.0)),
    ] {
        let keys = format!("mirror = {{ axes = [\"x\"], at_mm = [-1, 0, 0], polarization = \"{polarization}\" }}\n");
        let plain = image(&keys);
        assert_eq!((plain.name.as_str(), plain.tile.position()), ("t-mx", DVec3::new(-3.0, 2.0, 3.0)));
        assert_eq!((plain.tile.polarization_t(), plain.rotation), (arrow, None), "{polarization}");
        // The written rotation is the tile's, and corners are mirror images of corners.
        let tiles = repeated(&(keys + turned)).expect("a valid mirror").tiles;
        let [original, image] = [0, 1].map(|i| tiles[i].tile);
        let written = tiles[1].rotation.expect("rotated");
        let magsplice_layout::Rotation::AxisAngle { axis, angle_deg } = written else { panic!("{written:?}") };
        let written = glam::DQuat::from_axis_angle(DVec3::from(axis).normalize(), angle_deg.to_radians());
        // Some ten roundings in quaternions and angles of order 1.
        assert!(written.dot(image.rotation()).abs() > 1.0 - 1e-15, "{polarization}");
        let corner =
            |tile: magsplice_magnet::Tile, x: f64| tile.rotation() * (0.5 * tile.size() * DVec3::new(x, 1.0, -1.0));
        let reflected = corner(original, 1.0) * DVec3::new(-1.0, 1.0, 1.0);
        assert!(reflected.distance(corner(image, -1.0)) < 1e-14, "{polarization}");
        let [own, of_image] = [original, image].map(|tile| tile.rotation() * tile.polarization_t());
        let wanted = match polarization {
            "reflect" => own * DVec3::new(-1.0, 1.0, 1.0),
            "axial" => own * DVec3::new(1.0, -1.0, -1.0),
            _ => own,
        };
        assert!(of_image.distance(wanted) < 1e-15 * 4.0, "{polarization}: {of_image}, not {wanted}");
    }
}

#[test]
fn overlaps_name_both_tiles_and_the_way_out() {
    let two = "[[tile]]\nname = \"a\"\nposition_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n\
               [[tile]]\nname = \"b\"\nposition_mm = [0.75, 0, 0]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n";
    let message = parse(two).expect_err("an overlap");
    assert!(message.contains("tile \"b\": overlaps tile \"a\" before it by 0.25 mm"), "{message}");
    assert!(message.contains("move \"b\" that far along +x"), "{message}");
}

#[test]
fn overlaps_of_images_are_told_of_the_tiles_in_the_file() {
    let tile = |keys: &str| format!("[[tile]]\n{keys}\npolarization_t = [0, 0, 1]\n");
    let told = |tiles: &[&str]| {
        let text: String = tiles.iter().map(|keys| tile(keys)).collect();
        parse(&text).expect_err("an overlap").replace("test: ", "")
    };
    // Over its own mirror. The least depth is along y, where a move does not help.
    let own = "position_mm = [1.2, 0, 0.5]\nsize_mm = [3, 0.2, 1]\nmirror = { axes = [\"x\"] }";
    let wanted = "tile \"tile-1\": overlaps its own mirror image by 0.6 mm, must not overlap without overlap_mm: move \"tile-1\" by 0.3 mm \
                  along +x";
    assert!(told(&[own]).ends_with(wanted), "{}", told(&[own]));
    assert!(parse(&tile(&own.replace("1.2", "1.5"))).is_ok());
    let left = own.replace("1.2, 0", "-1.2, 1").replace("[\"x\"]", "[\"y\", \"x\"], at_mm = [0.2, 0, 0]");
    assert!(
        told(&[&left]).ends_with("by 0.2 mm, must not overlap without overlap_mm: move \"tile-1\" by 0.1 mm along -x"),
        "{}",
        told(&[&left])
    );
    // Over both mirrors: one line for each.
    let both = told(&[&own.replace("[\"x\"]", "[\"x\", \"y\"]")]);
    assert_eq!(both.lines().count(), 2, "{both}");
    assert!(both.contains("by 0.1 mm along +y, or leave \"y\" out of mirror.axes"), "{both}");
    // A tile on its mirror to within 1e-9 of half its length is its own image.
    for (x, is_own) in [("5e-9", true), ("5e-8", false)] {
        let long = told(&[&own.replace("1.2, 0", &format!("{x}, 0")).replace("[3, ", "[20, ")]);
        assert_eq!(long.contains("or leave \"x\" out of mirror.axes"), is_own, "{long}");
    }
    // Two mirrored tiles: the tiles of the file, once.
    let mirror = "size_mm = [1, 1, 1]\nmirror = { axes = [\"x\", \"y\"] }";
    let pair = told(&[&format!("position_mm = [2, 2, 0]\n{mirror}"), &format!("position_mm = [2.75, 2, 0]\n{mirror}")]);
    assert_eq!(pair.lines().count(), 1, "{pair}");
    assert!(pair.contains("tile \"tile-2\": overlaps tile \"tile-1\" before it by 0.25 mm"), "{pair}");
    assert!(pair.ends_with("move \"tile-2\" that far along +x"), "{pair}");
    // The image of the second alone: the advice is for the tile of the file.
    let image =
        told(&["position_mm = [-2, 2, 0]\nsize_mm = [1, 1, 1]", &format!("position_mm = [2.75, 2, 0]\n{mirror}")]);
    let wanted = "tile \"tile-2\": its image mirrored along x overlaps tile \"tile-1\" before it by 0.25 mm, must not \
                  overlap without overlap_mm: move \"tile-2\" that far along +x";
    assert!(image.ends_with(wanted), "{image}");
    let moved = format!("position_mm = [3, 2, 0]\n{mirror}");
    assert!(parse(&(tile("position_mm = [-2, 2, 0]\nsize_mm = [1, 1, 1]") + &tile(&moved))).is_ok());
}

/// The largest entry of both patterns, by magnitude, times the component.
#[test]
fn components_of_lattices_are_those_of_a_material() {
    let of = |component_t: f64| {
        parse(&format!(
            "[[lattice]]\nstart_mm = [0, 0, 0]\nheight_mm = 1\ncomponent_t = {component_t}\n\
             x = [{{ widths_mm = [1, 1], pattern = [1, -3] }}]\ny = [{{ widths_mm = [1], pattern = [2] }}]\n"
        ))
    };
    let message = of(1.0).expect_err("too strong");
    assert!(message.contains("component_t = 1 times the pattern is up to "), "{message}");
    assert!(of(0.6).is_ok());
}

#[test]
fn volumes_in_metres_and_round_off_are_told() {
    let film = TILE.replace("[0, 0, 0]\nsize_mm = [1, 1, 1]", "[0, 0, 0.5]\nsize_mm = [8, 8, 1]");
    let found = |volume: &str| -> Vec<String> {
        let layout = parse(&format!("{IDEAL}{volume}{film}")).expect("a valid layout");
        layout.findings.iter().map(ToString::to_string).collect()
    };
    let z = |range: &str, step: &str| VOLUME.replace("[-5, -3]", range).replace("step_mm = 0.5", step);
    assert_eq!(found(VOLUME), [""; 0]);
    assert_eq!(
        found(&z("[-0.003, -0.002]", "step_mm = [1, 1, 0.001]")),
        ["volume: z_mm = [-0.003, -0.002] begins 0.002 mm from the film, nearer than a hundredth of the wavelength, \
          10 mm; did you mean -3 .. -2 mm, which is -0.003 .. -0.002 m?"]
    );
    // One end alone is not in metres, and 0.1 mm is a hundredth of the wavelength.
    assert!(found(&z("[-3.099, -0.099]", "step_mm = 1"))[0].ends_with("wavelength, 10 mm"));
    assert_eq!(found(&z("[-3.1, -0.1]", "step_mm = 1")), [""; 0]);
    let step = |step: &str| parse(&format!("{}{film}", z("[-5, -3]", step))).expect_err("too many points");
    assert!(
        step("step_mm = 0.00025").ends_with("mm along each axis; did you mean 0.25 mm, which is 0.00025 m?"),
        "{}",
        step("step_mm = 0.00025")
    );
    assert!(step("step_mm = 1e-6").ends_with("mm along each axis"));
    let ends = VOLUME.replace("x_mm = [-2, 2]", "x_mm = [0.2, 1]").replace("step_mm = 0.5", "step_mm = [0.3, 1, 1]");
    assert!(found(&ends)[0].ends_with("the last points are at 0.8"), "{:?}", found(&ends));
}

/// The middle of the lower plane, unless the volume names another point.
#[test]
fn displacements_count_from_the_middle_of_the_lower_plane() {
    let volume = "[volume]\nx_mm = [0, 2]\ny_mm = [-1, 3.5]\nz_mm = [-5, -3]\nstep_mm = 0.5\n";
    let reference_mm = |keys: &str| {
        let layout = parse(&format!("{volume}{keys}{TILE}")).expect("a valid layout");
        layout.volume.expect("a volume").reference_mm
    };
    assert_eq!(reference_mm(""), DVec3::new(1.0, 1.25, -5.0));
    assert_eq!(reference_mm("reference_mm = [0, 1, -4]\n"), DVec3::new(0.0, 1.0, -4.0));
}

/// Each key in degrees, with the tile or the place in the stock.
#[test]
fn angles_in_radians_are_told_with_their_place() {
    let tile = |name: &str, x: i32, keys: &str| {
        format!("[[tile]]\n{name}position_mm = [{x}, 0, 0.5]\nsize_mm = [1, 1, 1]\n{keys}\n")
    };
    let directed = "strength_t = 0.1\ndirection_deg = 45\ntilt_deg = 0.5236";
    let rotated = |keys: &str| format!("polarization_t = [0, 0, 1]\nrotation = {{ {keys} }}");
    let design = "[design]\nvary = [\"size\", \"position\", \"direction\"]\n\
                  stock = [{ size_mm = [1, 1], direction_deg = 45 }, { size_mm = [2, 1], direction_deg = 0.7854 }]\n";
    let text = format!("{IDEAL}{VOLUME}{design}")
        + &tile("name = \"a\"\n", -4, &directed.replace("45", "1.5708"))
        + &tile("", 0, &rotated("axis = [0, 0, 1], angle_deg = 3.1416"))
        + &tile("", 4, &rotated("euler_deg = [30, -1.5708, 1.0472], order = \"xyz\""))
        + &tile("", 8, &rotated("axis = [0, 0, 1], angle_deg = 30"));
    let findings = parse(&text).expect("a valid layout").findings.into_iter().map(|finding| finding.message);
    let found: Vec<String> = findings.filter(|message| message.contains("in radians")).collect();
    assert_eq!(
        found,
        [
            "tile \"a\": direction_deg = 1.5708 is pi/2 in radians: did you mean 90 degrees?",
            "tile \"a\": tilt_deg = 0.5236 is pi/6 in radians: did you mean 30 degrees?",
            "tile \"tile-2\": rotation.angle_deg = 3.1416 is pi in radians: did you mean 180 degrees?",
            "tile \"tile-3\": rotation.euler_deg[1] = -1.5708 is -pi/2 in radians: did you mean -90 degrees?",
            "tile \"tile-3\": rotation.euler_deg[2] = 1.0472 is pi/3 in radians: did you mean 60 degrees?",
            "design: stock[1].direction_deg = 0.7854 is pi/4 in radians: did you mean 45 degrees?",
        ]
    );
}
