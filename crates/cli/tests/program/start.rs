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

#[test]
fn threads_are_refused_in_words() {
    for wrong in ["0", "-1", "many", "1025", "1.5"] {
        let said = Bench::new().run(&["check", &shipped("single-tile"), &format!("--threads={wrong}")]);
        assert_eq!((said.status, said.stdout.as_str()), (2, ""), "{wrong}");
        assert!(said.stderr.contains("must be a whole number from 1 to 1024"), "{wrong}: {}", said.stderr);
    }
    assert_eq!(Bench::new().run(&["--threads", "2", "check", &shipped("single-tile")]).status, 0);
}

#[test]
fn quiet_is_results_and_errors_only() {
    let bench = Bench::new();
    let said = bench.run(&["init", "--quiet"]);
    assert_eq!((said.status, said.stdout.as_str(), said.stderr.as_str()), (0, "", ""));
    let said = bench.run(&["check", "-q", "film.toml"]);
    assert_eq!((said.status, said.stdout.as_str(), said.stderr.as_str()), (0, "", ""));
    let strict = bench.read("film.toml").replace("s_z = 0.05", "s_z = 0.01");
    bench.write("strict.toml", &format!("{strict}[kind.idle]\nsize_mm = [1, 1, 1]\n"));
    let said = bench.run(&["check", "-q", "film.toml", "strict.toml"]);
    assert_eq!(said.status, 1);
    assert_eq!(said.stdout.lines().count(), 2, "{}", said.stdout);
    assert!(
        said.stdout.starts_with("strict.toml: my film, 56 tiles\n  FAILED  uniformity_rmse.s_z"),
        "{}",
        said.stdout
    );
    assert!(said.stderr.contains("kind \"idle\" is declared"), "findings are results: {}", said.stderr);
    assert!(bench.run(&["field", "-q", "nowhere.toml"]).stderr.contains("cannot read nowhere.toml"));
}

/// The script of bash, in bash.
#[test]
fn completions() {
    let bench = Bench::new();
    let script = bench.run(&["completions", "bash"]).stdout;
    bench.write("magsplice.bash", &script);
    let ask = "source magsplice.bash; COMP_WORDS=(magsplice dec); COMP_CWORD=1; _magsplice magsplice dec magsplice; \
               echo ${COMPREPLY[@]}; COMP_WORDS=(magsplice check --fo); COMP_CWORD=2; _magsplice magsplice --fo check; \
               echo ${COMPREPLY[@]}";
    let output = std::process::Command::new("bash").args(["-c", ask]).current_dir(bench.path("")).output();
    let output = output.expect("bash runs");
    assert_eq!(String::from_utf8_lossy(&output.stdout), "decouple\n--format\n");
    for shell in ["zsh", "fish", "powershell", "elvish"] {
        let said = bench.run(&["completions", shell]);
        assert_eq!(said.status, 0);
        assert!(["decouple", "check", "tiles"].iter().all(|verb| said.stdout.contains(verb)), "{shell}");
    }
    assert_eq!(bench.run(&["completions", "dos"]).status, 2);
}
