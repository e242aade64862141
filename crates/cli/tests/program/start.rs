//! The first steps: a layout to start from, its tiles, its schema.

use serde_json::Value;

use crate::{Bench, shipped};

#[test]
fn a_first_layout_can_be_used_at_once() {
    let bench = Bench::new();
    let said = bench.run(&["init"]);
    assert_eq!((said.status, said.stdout.as_str(), bench.files()), (0, "", vec!["film.toml".to_owned()]));
    assert!(said.stderr.starts_with("magsplice: wrote film.toml; "), "{}", said.stderr);
    for verb in ["check", "decouple", "compare", "tiles", "field"] {
        let said = bench.run(&[verb, "film.toml"]);
        assert_eq!((said.status, said.stderr.as_str()), (0, ""), "{verb}");
        assert!(!said.stdout.is_empty());
    }
    let text = bench.read("film.toml");
    assert_eq!(bench.run(&["init", "-"]).stdout, text);
    // What it only mentions works too.
    let all = text.replace("# field = ", "field = ");
    let (before, mentioned) = all.split_once("#\n# [[tile]]").unwrap();
    let mentioned = mentioned.replace("\n# ", "\n");
    bench.write("all.toml", &format!("{before}[[tile]]{mentioned}"));
    let said = bench.run(&["check", "--update", "all.toml"]);
    assert_eq!(said.status, 0, "{}{}", said.stdout, said.stderr);
    assert!(said.stdout.starts_with("all.toml: my film, 62 tiles\n") && said.stdout.contains("  ok      field"));
}

#[test]
fn init_never_overwrites() {
    let bench = Bench::new();
    bench.write("mine.toml", "mine");
    bench.run(&["init", "mine.toml"]).refuses("cannot write mine.toml: it is there already, and is left as it is");
    assert_eq!((bench.read("mine.toml").as_str(), bench.files()), ("mine", vec!["mine.toml".to_owned()]));
    bench.run(&["init", "nowhere/film.toml"]).refuses("cannot write nowhere/film.toml: ");
    #[cfg(unix)]
    {
        // Nor through a link to nothing.
        std::os::unix::fs::symlink(bench.path("target.toml"), bench.path("link.toml")).unwrap();
        bench.run(&["init", "link.toml"]).refuses("it is there already");
        assert_eq!(bench.files(), ["link.toml", "mine.toml"]);
    }
}

/// JSON to TOML by any converter gives a layout file with the same tiles.
#[test]
fn tiles_as_json_read_back() {
    let bench = Bench::new();
    for layout in ["published-film", "film-40mm", "single-tile"] {
        let said = bench.run(&["tiles", &shipped(layout), "--format", "json"]);
        assert_eq!((said.status, said.stderr.as_str()), (0, ""));
        let json: Value = serde_json::from_str(&said.stdout).unwrap();
        bench.write("plain.toml", &toml::to_string(&json).unwrap());
        assert_eq!(bench.run(&["tiles", "plain.toml", "--format", "json"]).stdout, said.stdout);
        let field = |path: &str| bench.run(&["field", path]).stdout;
        assert!(field("plain.toml") == field(&shipped(layout)), "{layout}: another field");
    }
    let json: Value =
        serde_json::from_str(&bench.run(&["tiles", &shipped("published-film"), "--format", "json"]).stdout).unwrap();
    assert_eq!(json["tile"].as_array().unwrap().len(), 56);
    assert_eq!(json["tile"][0]["name"], "film-x1-y2");
}

#[test]
fn schema_is_json() {
    let said = Bench::new().run(&["schema"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    let json: Value = serde_json::from_str(&said.stdout).unwrap();
    assert_eq!(json["$schema"], "https://json-schema.org/draft/2020-12/schema");
    assert!(json["properties"]["tile"].is_object());
}
