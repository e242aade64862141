//! `report`: figures and the page. tests/browser tests the page in a browser.

use std::fs;

use serde_json::Value;

use crate::{Sandbox, rows, shipped};

pub(crate) const FIGURES: [&str; 8] = [
    "field-highest",
    "field-lowest",
    "field-middle",
    "layout",
    "parameters-along-axes",
    "parameters-level",
    "parameters-upright",
    "vectors",
];

fn files(sandbox: &Sandbox, folder: &str) -> Vec<String> {
    let entries = fs::read_dir(sandbox.path(folder)).expect("a readable folder");
    let mut names: Vec<String> =
        entries.map(|e| e.expect("an entry").file_name().into_string().expect("UTF-8")).collect();
    names.sort();
    names
}

/// The text of the element with this id.
fn element<'a>(page: &'a str, id: &str) -> &'a str {
    let start = page.find(&format!("id=\"{id}\"")).unwrap_or_else(|| panic!("no element {id}"));
    let text = &page[start..][page[start..].find('>').expect("a tag ends") + 1..];
    &text[..text.find("</").expect("an element ends")]
}

#[test]
fn report_writes_every_figure_of_the_published_film() {
    let sandbox = Sandbox::new();
    let said = sandbox.run(&["report", &sandbox.published_with(""), "-o", "out"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    assert!(said.stdout.contains("report.html: 8 figures"), "{}", said.stdout);
    let endings = |name: &&str| ["csv", "png", "svg"].map(|ending| format!("{name}.{ending}"));
    let mut expected: Vec<String> = FIGURES.iter().flat_map(endings).collect();
    expected.extend(["report.html".to_owned(), "files.sha256".to_owned()]);
    expected.sort();
    assert_eq!(files(&sandbox, "out"), expected);
    let page = sandbox.read("out/report.html");
    for name in FIGURES {
        let svg = sandbox.read(&format!("out/{name}.svg"));
        let xml = roxmltree::Document::parse(&svg).unwrap_or_else(|e| panic!("{name}: {e}"));
        // The size in millimetres, and the same in pixels, 96 per inch.
        let side = |name: &str| {
            let text = xml.root_element().attribute(name).expect("a size");
            let mm: f64 = text.strip_suffix("mm").expect("millimetres").parse().expect("a number");
            (mm * 96.0 / 25.4).round()
        };
        let (width, height) = (side("width"), side("height"));
        assert!(width > 600.0 && height > 250.0, "{name}: {width} x {height}");
        // Text is text, in fonts that are everywhere where Roboto is missing.
        let texts: Vec<_> = xml.descendants().filter(|node| node.has_tag_name("text")).collect();
        assert!(texts.len() > 5, "{name}");
        assert!(texts.iter().all(|text| text.attribute("font-family") == Some("Roboto, Arial, Helvetica, sans-serif")));
        let numbers: String = texts.iter().flat_map(|text| text.descendants()).filter_map(|node| node.text()).collect();
        assert!(!numbers.contains("e-") && !numbers.contains("e\u{2212}"), "{name}: {numbers}");
        let letter = |letter: &str| texts.iter().any(|text| text.text().is_some_and(|t| t.trim().starts_with(letter)));
        assert_eq!(letter("(a)"), name != "layout", "{name}");
        let png = fs::read(sandbox.path(&format!("out/{name}.png"))).unwrap();
        assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
        let number = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().unwrap());
        let expected = [width, height].map(|px| (px * 300.0 / 96.0).ceil() as u32);
        assert_eq!([number(16), number(20)], expected, "{name}");
        // 300 dots per inch are 11811 per metre.
        let resolution = png.windows(4).position(|chunk| chunk == b"pHYs").expect("a resolution") + 4;
        assert_eq!((number(resolution), number(resolution + 4), png[resolution + 8]), (11811, 11811, 1), "{name}");
        let csv = sandbox.read(&format!("out/{name}.csv"));
        let (header, body) = csv.split_once('\n').expect("a header");
        let columns = header.split(',').count();
        assert!(columns >= 6 && body.lines().count() > 5, "{name}: {header}");
        assert!(body.lines().all(|line| line.split(',').count() == columns), "{name}");
        for ending in ["svg", "png", "csv"] {
            assert!(page.contains(&format!("<a href=\"{name}.{ending}\">")), "{name}");
        }
        // A tap enlarges the figure: it is the target of its own link.
        let picture = format!("<figure id=\"{name}\"><div class=\"picture\" id=\"{name}-large\">");
        assert!(page.contains(&picture) && page.contains(&format!("href=\"#{name}-large\"")), "{name}");
    }
    assert_links_lead_somewhere(&page);
    // The page loads nothing from elsewhere.
    for outside in ["http://", "https://", "<link rel=\"style", "@import", "<script src"] {
        assert!(!page.contains(outside), "{outside}");
    }
}

/// Each link within the page has its target, and no id is used twice.
pub(crate) fn assert_links_lead_somewhere(page: &str) {
    let quoted = |text: &str| text[..text.find('"').expect("a quote")].to_owned();
    let links: Vec<String> = page.split("href=\"#").skip(1).map(quoted).collect();
    let mut ids: Vec<String> = page.split(" id=\"").skip(1).map(quoted).collect();
    assert!(links.len() > 8, "{links:?}");
    for link in &links {
        assert!(ids.contains(link), "#{link} leads nowhere");
    }
    let all = ids.len();
    ids.sort();
    ids.dedup();
    assert_eq!(ids.len(), all, "an id is used twice: {ids:?}");
}

#[test]
fn page_begins_with_a_verdict() {
    let sandbox = Sandbox::new();
    let text = fs::read_to_string(shipped("published-film")).unwrap();
    let (before, bounds) = text.split_once("\n[expect]").expect("expectations");
    let after = bounds.find("\n[").map_or("", |at| &bounds[at..]);
    let page = |name: &str, expect: &str| {
        sandbox.write(&format!("{name}.toml"), &format!("{before}{expect}{after}"));
        let said = sandbox.run(&["report", &format!("{name}.toml"), "-o", &format!("{name}.html")]);
        assert_eq!(said.status, 0, "{}", said.stderr);
        let page = sandbox.read(&format!("{name}.html"));
        let verdict = page.split_once("id=\"verdict\"").expect("a verdict").1;
        verdict[..verdict.find("</div>").expect("an end")].to_owned()
    };
    let bound = |most: &str| format!("\n[expect]\nuniformity_rmse = {{ r_x = {most} }}\namplitude = {{ min = 0.8 }}\n");
    let kept = page("kept", &bound("0.07"));
    assert!(kept.contains("The film keeps all 2 bounds of [expect].") && kept.contains("as ordered"), "{kept}");
    let broken = page("broken", &bound("0.01"));
    assert!(broken.contains("The film breaks 1 of its 2 bounds: uniformity_rmse.r_x."), "{broken}");
    let open = page("open", "");
    assert!(open.contains("No verdict: the layout states no bounds in [expect]."), "{open}");
    let errors = "\n[tolerance]\npreset = \"workshop\"\nsamples = 40\n";
    let made = page("made", errors);
    assert!(made.contains("Of 40 films as made, 95 % have a displacement RMSE of at most"), "{made}");
}

/// The cells of the row with this name.
pub(crate) fn cells(page: &str, name: &str) -> Vec<String> {
    let (_, row) = page.split_once(&format!("{name}</th>")).unwrap_or_else(|| panic!("no row {name}"));
    let row = &row[..row.find("</tr>").expect("a row ends")];
    row.split("<td role=\"cell\">").skip(1).map(|cell| cell[..cell.find('<').expect("an end")].to_owned()).collect()
}

/// The number in a cell.
pub(crate) fn cell_number(text: &str) -> f64 {
    let text = text.replace('\u{2212}', "-");
    let Some((digits, power)) = text.split_once(" \u{d7} 10") else { return text.parse().expect("a number") };
    let superscripts = "\u{2070}\u{b9}\u{b2}\u{b3}\u{2074}\u{2075}\u{2076}\u{2077}\u{2078}\u{2079}";
    let digit = |c: char| superscripts.chars().position(|s| s == c).map_or("-".to_owned(), |d| d.to_string());
    let power: String = power.chars().map(digit).collect();
    format!("{digits}e{power}").parse::<f64>().expect("a number")
}

#[test]
fn numbers_on_the_page_are_those_of_decouple_and_field() {
    let sandbox = Sandbox::new();
    let layout = sandbox.published_with("");
    for accuracy in [&[][..], &["--within", "1e-6"]] {
        let run = |verb: &[&str]| sandbox.run(&[verb, accuracy].concat());
        assert_eq!(run(&["report", &layout, "-o", "out"]).status, 0);
        let page = sandbox.read("out/report.html");
        let json = |text: &str| serde_json::from_str::<Value>(text).expect("JSON");
        let mut decoupled = json(&run(&["decouple", &layout, "--format", "json"]).stdout);
        let errors = |key: &str| ["r_x", "r_y", "s_z"].map(|of| decoupled[key][of].as_f64().expect("a number"));
        for (name, key) in [("uniformity RMSE", "uniformity_rmse"), ("RMSE against the ideal film", "ideal_rmse")] {
            for (cell, value) in cells(&page, &format!("rowheader\">{name}")).iter().zip(errors(key)) {
                assert!((cell_number(cell) - value).abs() <= 1e-5 * value, "{name}: {cell}, not {value}");
            }
        }
        // The page has the points in its maps instead.
        let whole = decoupled.as_object_mut().expect("an object");
        assert!(whole.remove("columns").is_some() && whole.remove("shape").is_some());
        assert_eq!(json(element(&page, "numbers-json")), decoupled);
        assert_eq!(element(&page, "sha256"), decoupled["sha256"]);
        let exact = page.contains("<dd>exact</dd>");
        assert_eq!((exact, page.contains("<dd>within 1e-6 of |B|</dd>")), (accuracy.is_empty(), !accuracy.is_empty()));
        // The maps, point by point.
        let mut zeros = 0;
        let data = json(element(&page, "data"));
        let field = run(&["field", &layout]).stdout;
        let rows: Vec<Vec<f64>> =
            field.lines().skip(1).map(|l| l.split(',').map(|c| c.parse().unwrap()).collect()).collect();
        for (component, name) in ["B_x", "B_y", "B_z"].into_iter().enumerate() {
            let map = data["maps"].as_array().unwrap().iter().find(|map| map["name"] == name).unwrap();
            let all: Vec<f64> = map["values"].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect();
            // The map is finer than the step of the volume, ends where it ends, and has its points.
            let [xs, ys, zs] = ["x_mm", "y_mm", "z_mm"].map(|axis| {
                let list = data["volume"][axis].as_array().expect("a list");
                list.iter().map(|v| v.as_f64().expect("a number")).collect::<Vec<f64>>()
            });
            assert_eq!((xs[0], xs[xs.len() - 1], ys[0], ys[ys.len() - 1]), (-2.0, 2.0, -2.0, 2.0));
            assert!(xs.len() > 40 && all.len() == xs.len() * ys.len() * zs.len(), "{} points along x", xs.len());
            let index = |of: &[f64], at: f64| of.iter().position(|c| (c - at).abs() < 1e-9).expect("a point");
            let value = |row: &Vec<f64>| {
                all[(index(&xs, row[0]) * ys.len() + index(&ys, row[1])) * zs.len() + index(&zs, row[2])]
            };
            let values: Vec<f64> = rows.iter().map(value).collect();
            for (value, row) in values.iter().zip(&rows) {
                // Equal up to rounding of the last digit when JSON is read. Round-off is 0; to the
                // tolerance of 1e-6 that is whatever is below 1e-6 of |B|.
                let b = row[3 + component];
                let length = row[3..].iter().map(|c| c * c).sum::<f64>().sqrt();
                let round_off = if accuracy.is_empty() { 1e-12 } else { 1.001e-6 } * length;
                let zero = *value == 0.0 && b.abs() <= round_off;
                assert!(zero || (value - b).abs() <= 2.0 * round_off, "{name}: {value}, not {b}");
                zeros += usize::from(zero && b != 0.0);
            }
        }
        // On the planes x = 0 and y = 0 a component vanishes by symmetry, but for round-off.
        assert!(zeros > 10, "{zeros} values of round-off are 0");
        assert_eq!(data["volume"]["z_mm"], serde_json::json!([-5.0, -4.5, -4.0, -3.5, -3.0]));
    }
}

#[test]
fn report_has_a_usual_folder_and_a_page_of_its_own() {
    let sandbox = Sandbox::new();
    let tile = "[[tile]]\nposition_mm = [0, 0, 0.5]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n";
    for name in ["one", "two"] {
        sandbox.write(&format!("{name}.toml"), &format!("format = 1\nname = \"{name}\"\n{tile}"));
    }
    for (args, folder) in [(&["one.toml"][..], "one-report"), (&["one.toml", "two.toml"], "one-and-two-report")] {
        let said = sandbox.run(&[&["report"], args].concat());
        assert_eq!((said.status, said.stderr.as_str()), (0, ""));
        assert!(said.stdout.starts_with(&format!("{folder}/report.html: ")), "{}", said.stdout);
        assert!(sandbox.read(&format!("{folder}/report.html")).contains("layout.svg\">"));
        // Alone, the page links to no file that is missing, and shows the same.
        let page = format!("{folder}.HTML");
        let said = sandbox.run(&[&["report"], args, &["-o", &page]].concat());
        assert_eq!((said.status, said.stderr.as_str()), (0, ""));
        assert!(said.stdout.starts_with(&format!("{page}: ")) && !said.stdout.contains("SVG"), "{}", said.stdout);
        let html = sandbox.read(&page);
        assert!(html.contains("<figure id=") && !html.contains("layout.svg") && !html.contains("Files beside"));
    }
    for name in ["out.svg", "figures.pdf", "one.toml"] {
        let said = sandbox.run(&["report", "one.toml", "-o", name]);
        said.refuses("or the page alone as an .html file");
    }
    fs::create_dir(sandbox.path("folder.html")).unwrap();
    sandbox.run(&["report", "one.toml", "-o", "folder.html"]).refuses("cannot write folder.html");
}

#[test]
fn one_figure_is_printed_at_its_width_with_readable_text() {
    let sandbox = Sandbox::new();
    let film = shipped("published-film");
    let figure = |more: &[&str]| sandbox.run(&[&["report", &film, "--figure"], more].concat());
    let said = figure(&["field-middle", "--component", "z", "--width", "85mm", "-o", "b_z.svg"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    let svg = sandbox.read("b_z.svg");
    let xml = roxmltree::Document::parse(&svg).expect("XML");
    let root = xml.root_element();
    let width_mm: f64 = root.attribute("width").and_then(|w| w.strip_suffix("mm")).expect("mm").parse().unwrap();
    assert!((width_mm - 85.0).abs() < 0.3, "{width_mm} mm");
    let viewed: f64 = root.attribute("viewBox").expect("a view").split(' ').nth(2).unwrap().parse().unwrap();
    let points = |node: roxmltree::Node| {
        let size: f64 = node.attribute("font-size")?.parse().ok()?;
        Some(size * width_mm / viewed * 72.0 / 25.4)
    };
    let sizes: Vec<f64> = xml.descendants().filter_map(points).collect();
    assert!(sizes.len() > 20 && sizes.iter().all(|size| (6.99..=9.01).contains(size)), "{sizes:?}");
    // The maps of one component: of the film, of the ideal film, and their difference.
    assert_eq!(xml.descendants().filter(|node| node.has_tag_name("image")).count(), 6);
    assert_eq!(figure(&["field-middle", "--component", "z", "--width", "85mm"]).status, 0);
    let pdf = fs::read(sandbox.path("field-middle.pdf")).unwrap();
    assert!(pdf.starts_with(b"%PDF-") && pdf.trim_ascii_end().ends_with(b"%%EOF"));
    let text = String::from_utf8_lossy(&pdf);
    assert!(text.contains("/MediaBox [0 0 240.") || text.contains("/MediaBox [0 0 241."), "85 mm are 240.9 pt");
    figure(&["field-middle", "--width", "85mm"]).refuses("has no text of 7 to 9 pt at a width of 85 mm: choose ");
    figure(&["layout", "--component", "x"]).refuses("the figure layout has no maps of components");
    figure(&["fields"]).refuses("there is no figure fields: the figures of this film are layout, vectors,");
}

#[test]
fn report_names_absent_parts() {
    let sandbox = Sandbox::new();
    let said = sandbox.run(&["report", &shipped("single-tile"), "-o", "out"]);
    assert_eq!(said.status, 0, "{}", said.stderr);
    assert!(said.stdout.contains("absent: no comparison and no decoupling: the layout has no [ideal] table"));
    assert_eq!(files(&sandbox, "out").len(), 3 * 5 + 2);
    let page = sandbox.read("out/report.html");
    assert!(page.contains("class=\"absent\"") && cells(&page, "least in the volume, mT").len() == 3);
    let tile = "[[tile]]\nposition_mm = [0, 0, 0.5]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n";
    sandbox.write("tiles.toml", &format!("format = 1\nname = \"</script> & <b>\"\n{tile}"));
    let said = sandbox.run(&["report", "tiles.toml", "-o", "tiles"]);
    assert_eq!(said.status, 0, "{}", said.stderr);
    assert!(said.stdout.contains("report.html: 1 figure, each also"), "{}", said.stdout);
    assert!(said.stdout.contains("absent: no field and no decoupling: the layout has no [volume] table"));
    assert_eq!(files(&sandbox, "tiles"), ["files.sha256", "layout.csv", "layout.png", "layout.svg", "report.html"]);
    let page = sandbox.read("tiles/report.html");
    assert!(page.contains("<title>&lt;/script&gt; &amp; &lt;b&gt;</title>"));
    // The page has three scripts; the name of the layout must not end one of them.
    assert_eq!(page.matches("</script>").count(), 3);
}

#[test]
fn page_states_which_points_its_map_shows() {
    let sandbox = Sandbox::new();
    let text = fs::read_to_string(shipped("single-tile")).unwrap();
    let (before, volume) = text.split_once("[volume]").unwrap();
    let (_, after) = volume.split_once("\n\n").unwrap();
    for (step_mm, shown) in [
        ("0.2", "18491 points</dd>"),
        ("[0.1, 0.2, 0.2]", "36531 points; the map on this page shows one point of 2 along x</dd>"),
        ("[0.02, 0.1, 0.1]", "; the map on this page shows one point of 10 along x, one point of 3 along y</dd>"),
    ] {
        let volume = format!("[volume]\nx_mm = [-4, 4]\ny_mm = [-4, 4]\nz_mm = [-3, -1]\nstep_mm = {step_mm}\n\n");
        sandbox.write("fine.toml", &format!("{before}{volume}{after}"));
        assert_eq!(sandbox.run(&["report", "fine.toml", "-o", "out"]).status, 0);
        assert!(sandbox.read("out/report.html").contains(shown), "{step_mm}: {shown}");
    }
}

#[test]
fn earlier_report_is_replaced_and_other_files_are_kept() {
    let sandbox = Sandbox::new();
    let report = |layout: &str, folder: &str| sandbox.run(&["report", &shipped(layout), "-o", folder]);
    assert_eq!(report("published-film", "out").status, 0);
    // Figures that the single tile does not have are removed with the earlier report.
    assert_eq!(report("single-tile", "out").status, 0);
    assert_eq!(files(&sandbox, "out").len(), 3 * 5 + 2);
    assert_eq!(sandbox.files(), ["out"]);

    fs::create_dir(sandbox.path("mine")).unwrap();
    sandbox.write("mine/notes.txt", "keep");
    sandbox.write("mine/layout.svg", "an older figure");
    report("single-tile", "mine")
        .refuses("it holds layout.svg, which this command did not write and which would be lost");
    sandbox.write("out/notes.txt", "keep");
    report("single-tile", "out").refuses("it holds notes.txt, which this command did not write");
    fs::remove_file(sandbox.path("out/notes.txt")).unwrap();
    fs::create_dir(sandbox.path("out/folder")).unwrap();
    report("single-tile", "out").refuses("it holds folder, which this command did not write");
    fs::remove_dir(sandbox.path("out/folder")).unwrap();
    assert_eq!(files(&sandbox, "mine"), ["layout.svg", "notes.txt"]);
    assert_eq!(
        (sandbox.read("mine/notes.txt"), sandbox.read("mine/layout.svg")),
        ("keep".into(), "an older figure".into())
    );

    sandbox.write("file", "keep");
    report("single-tile", "file").refuses("cannot write file");
    assert_eq!(sandbox.read("file"), "keep");
    report("single-tile", "no/such/folder").refuses("cannot write no/such/folder");
    assert_eq!(sandbox.files(), ["file", "mine", "out"]);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        std::os::unix::fs::symlink(sandbox.path("out"), sandbox.path("link")).unwrap();
        assert_eq!(report("single-tile", "link").status, 0);
        assert!(sandbox.path("link").symlink_metadata().unwrap().is_symlink());
        // The permissions of any new folder.
        fs::create_dir(sandbox.path("plain")).unwrap();
        let mode = |name: &str| fs::metadata(sandbox.path(name)).unwrap().permissions().mode();
        assert_eq!(mode("out"), mode("plain"));
    }
}

#[test]
fn failed_report_leaves_no_folder() {
    let sandbox = Sandbox::new();
    let text = fs::read_to_string(shipped("published-film")).unwrap();
    sandbox.write("inside.toml", &text.replace("z_mm = [-5.0, -3.0]", "z_mm = [-5.0, 3.0]"));
    sandbox.run(&["report", "inside.toml", "-o", "out"]).refuses("not below the film");
    sandbox.write("wide.toml", &text.replace("x_mm = [-2.0, 2.0]", "x_mm = [-6.0, 6.0]"));
    sandbox.run(&["report", "wide.toml", "-o", "out"]).refuses("must stay below half a wavelength");
    assert_eq!(sandbox.files(), ["inside.toml", "wide.toml"]);
}

#[test]
fn outlines_are_independent_of_installed_fonts() {
    let sandbox = Sandbox::new();
    let said = sandbox.run(&["report", &shipped("single-tile"), "-o", "out", "--text", "outlines"]);
    assert_eq!(said.status, 0, "{}", said.stderr);
    let svg = sandbox.read("out/layout.svg");
    let xml = roxmltree::Document::parse(&svg).expect("XML");
    assert!(!xml.descendants().any(|node| node.has_tag_name("text")) && !svg.contains("font-family"));
    assert!(xml.descendants().filter(|node| node.tag_name().name() == "path").count() > 50);
    assert!(xml.root_element().attribute("width").expect("a width").ends_with("mm"));
}

/// The texts of an SVG file.
pub(crate) fn texts(svg: &str) -> Vec<String> {
    let xml = roxmltree::Document::parse(svg).expect("XML");
    let texts = xml.descendants().filter(|node| node.has_tag_name("text"));
    let whole = |text: roxmltree::Node| -> String {
        text.descendants().filter(|node| node.is_text()).filter_map(|node| node.text()).collect()
    };
    texts.map(|text| whole(text).trim().to_owned()).collect()
}

/// B of a bar along x crosses the plane x = 0 at right angles, so that no arrow lies in the plane.
#[test]
fn maps_of_round_off_are_zero_and_say_so() {
    let sandbox = Sandbox::new();
    sandbox.write(
        "bar.toml",
        "format = 1\nname = \"bar\"\n[[tile]]\nposition_mm = [0, 0, 0.5]\nsize_mm = [3.3, 1.7, 1]\n\
         polarization_t = [0.12, 0, 0]\n[volume]\nx_mm = [-1e-9, 1e-9]\ny_mm = [-2, 2]\nz_mm = [-3, -2]\n\
         step_mm = [2e-9, 1, 1]\n",
    );
    let said = sandbox.run(&["report", "bar.toml", "-o", "out"]);
    assert_eq!(said.status, 0, "{}", said.stderr);
    let vectors = texts(&sandbox.read("out/vectors.svg"));
    let remarks = vectors.iter().filter(|text| text.starts_with("no arrows")).count();
    assert_eq!(remarks, 1, "{vectors:?}");
    assert!(
        texts(&sandbox.read("out/field-lowest.svg"))
            .iter()
            .all(|text| !text.contains("-0") && !text.contains("\u{2212}0.0") || text.len() > 4)
    );
    // A film of two opposite tiles has no field at all.
    let tile =
        |j: &str| format!("[[tile]]\nposition_mm = [0, 0, 0.5]\nsize_mm = [2, 2, 1]\npolarization_t = [0, 0, {j}]\n");
    sandbox.write(
        "upright.toml",
        &format!(
            "format = 1\nname = \"upright\"\n{}[volume]\nx_mm = [-1, 1]\ny_mm = [-1e-17, 1e-17]\nz_mm = [-3, -2]\n\
             step_mm = [1, 1e-17, 1]\n",
            tile("0.12")
        ),
    );
    let said = sandbox.run(&["report", "upright.toml", "-o", "upright"]);
    assert_eq!(said.status, 0, "{}", said.stderr);
    let field = texts(&sandbox.read("upright/field-lowest.svg"));
    assert_eq!(field.iter().filter(|text| *text == "0 everywhere,").count(), 1, "{field:?}");
    let csv = sandbox.read("upright/field-lowest.csv");
    assert!(csv.lines().skip(1).all(|line| line.split(',').nth(4) == Some("0")), "B_y in {csv}");
}

#[test]
fn residuals_of_a_designed_film_are_in_micrometres_under_each_parameter() {
    let sandbox = Sandbox::new();
    let said = sandbox.run(&["report", &shipped("designed-displacement"), "-o", "out"]);
    assert_eq!(said.status, 0, "{}", said.stderr);
    let texts = texts(&sandbox.read("out/parameters-along-axes.svg"));
    for axis in ["x", "y", "z"] {
        assert!(texts.contains(&format!("\u{394}{axis} (\u{b5}m)")), "{texts:?}");
    }
    // The residuals, from the parameters that `decouple` writes for the same points.
    let csv = sandbox.read("out/parameters-along-axes.csv");
    let layout = shipped("designed-displacement");
    let points = rows(&sandbox.run(&["decouple", &layout, "--format", "csv"]).stdout);
    let header = sandbox.run(&["decouple", &layout, "--format", "csv"]).stdout;
    let column =
        |name: &str| header.lines().next().unwrap().split(',').position(|c| c.starts_with(name)).expect("a column");
    let reference = points.iter().find(|p| p[..3] == [0.0, 0.0, -5.0]).expect("the reference point");
    let k = std::f64::consts::TAU / 10.0;
    for (axis, name, parameter, sign) in [(0, "R_x", "r_x", -1.0), (2, "S_z", "s_z", 1.0)] {
        let value = column(parameter);
        for line in csv.lines().filter(|line| line.starts_with(name)) {
            let numbers: Vec<f64> = line.split(',').skip(1).map(|n| n.parse().unwrap()).collect();
            let plane: Vec<&Vec<f64>> = points.iter().filter(|p| (p[axis] - numbers[0]).abs() < 1e-9).collect();
            let mean = plane.iter().map(|p| p[value]).sum::<f64>() / plane.len() as f64;
            let shown_mm = sign * (mean - reference[value]) / k;
            let residual_um = 1e3 * (shown_mm - (numbers[0] - reference[axis]));
            assert!((numbers[6] - residual_um).abs() < 1e-6, "{line}: not {residual_um}");
        }
    }
}

/// On planes of constant z the figure shows S_z minus its mean, as a displacement: S_z itself would
/// be one colour.
#[test]
fn level_planes_show_the_residual_of_s_z_in_micrometres() {
    let sandbox = Sandbox::new();
    let said = sandbox.run(&["report", &shipped("published-film"), "-o", "out"]);
    assert_eq!(said.status, 0, "{}", said.stderr);
    let csv = sandbox.read("out/parameters-level.csv");
    let (header, body) = csv.split_once('\n').expect("a header");
    assert_eq!(header, "x_mm,y_mm,z_mm,r_x_rad,r_y_rad,s_z_ln_t,s_z_residual_um");
    let rows: Vec<Vec<f64>> =
        body.lines().map(|line| line.split(',').map(|number| number.parse().expect("a number")).collect()).collect();
    let svg = sandbox.read("out/parameters-level.svg");
    let wavelength_mm = 10.0;
    for z in [-5.0, -4.0, -3.0] {
        let plane: Vec<&Vec<f64>> = rows.iter().filter(|row| row[2] == z).collect();
        assert_eq!(plane.len(), 128 * 128);
        let mean = plane.iter().map(|row| row[5]).sum::<f64>() / plane.len() as f64;
        let um_per_unit = 1e3 * wavelength_mm / std::f64::consts::TAU;
        for row in &plane {
            assert!((row[6] - um_per_unit * (row[5] - mean)).abs() < 1e-3, "{row:?}");
        }
        assert!(plane.iter().any(|row| row[6] > 10.0) && plane.iter().any(|row| row[6] < -10.0));
        let title = format!("mean {mean:.3}").replace('-', "\u{2212}");
        assert!(svg.contains(&title), "no title {title}");
    }
    let caption = "For S_z the maps show the residual";
    assert!(sandbox.read("out/report.html").contains(caption));
    assert!(sandbox.read("out/parameters-upright.csv").starts_with("x_mm,y_mm,z_mm,r_x_rad,r_y_rad,s_z_ln_t\n"));
}
