//! First steps: `init`, `tiles`, `schema`, `completions`, and options of every verb.

use serde_json::Value;

use crate::{Sandbox, shipped};

#[test]
fn init_writes_a_layout_that_every_verb_accepts() {
    let sandbox = Sandbox::new();
    let said = sandbox.run(&["init"]);
    assert_eq!((said.status, said.stdout.as_str(), sandbox.files()), (0, "", vec!["film.toml".to_owned()]));
    assert!(said.stderr.starts_with("magsplice: wrote film.toml; "), "{}", said.stderr);
    for verb in ["check", "decouple", "compare", "tiles", "field"] {
        let said = sandbox.run(&[verb, "film.toml"]);
        assert_eq!((said.status, said.stderr.as_str()), (0, ""), "{verb}");
        assert!(!said.stdout.is_empty());
    }
    let text = sandbox.read("film.toml");
    assert_eq!(sandbox.run(&["init", "-"]).stdout, text);
    // The lines that are comments in the layout work too.
    let all = text.replace("# field = ", "field = ");
    let (before, mentioned) = all.split_once("#\n# [[tile]]").unwrap();
    let mentioned = mentioned.replace("\n# ", "\n");
    sandbox.write("all.toml", &format!("{before}[[tile]]{mentioned}"));
    let said = sandbox.run(&["check", "--update", "all.toml"]);
    assert_eq!(said.status, 0, "{}{}", said.stdout, said.stderr);
    assert!(said.stdout.starts_with("all.toml: my film, 62 tiles\n") && said.stdout.contains("  ok       field"));
}

#[test]
fn init_never_overwrites() {
    let sandbox = Sandbox::new();
    sandbox.write("mine.toml", "mine");
    sandbox.run(&["init", "mine.toml"]).refuses("cannot write mine.toml: it exists already, and was not changed");
    assert_eq!((sandbox.read("mine.toml").as_str(), sandbox.files()), ("mine", vec!["mine.toml".to_owned()]));
    sandbox.run(&["init", "nowhere/film.toml"]).refuses("cannot write nowhere/film.toml: ");
    #[cfg(unix)]
    {
        // A link to a file that does not exist is not followed.
        std::os::unix::fs::symlink(sandbox.path("target.toml"), sandbox.path("link.toml")).unwrap();
        sandbox.run(&["init", "link.toml"]).refuses("it exists already");
        assert_eq!(sandbox.files(), ["link.toml", "mine.toml"]);
    }
}

/// The JSON without its parts, converted to TOML, is a layout file.
#[test]
fn tiles_as_json_are_a_layout_with_the_same_field() {
    let sandbox = Sandbox::new();
    for layout in ["published-film", "film-40mm", "single-tile"] {
        let said = sandbox.run(&["tiles", &shipped(layout), "--format", "json"]);
        assert_eq!((said.status, said.stderr.as_str()), (0, ""));
        let mut json: Value = serde_json::from_str(&said.stdout).unwrap();
        assert!(json.as_object_mut().unwrap().remove("parts").is_some());
        sandbox.write("plain.toml", &toml::to_string(&json).unwrap());
        assert_eq!(sandbox.run(&["tiles", "plain.toml", "--format", "json"]).stdout, said.stdout);
        let field = |path: &str| sandbox.run(&["field", path]).stdout;
        assert!(field("plain.toml") == field(&shipped(layout)), "{layout}: another field");
    }
    let json: Value =
        serde_json::from_str(&sandbox.run(&["tiles", &shipped("published-film"), "--format", "json"]).stdout).unwrap();
    assert_eq!(json["tile"].as_array().unwrap().len(), 56);
    assert_eq!(json["tile"][0]["name"], "film-x1-y2");
}

#[test]
fn schema_is_json() {
    let said = Sandbox::new().run(&["schema"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    let json: Value = serde_json::from_str(&said.stdout).unwrap();
    assert_eq!(json["$schema"], "https://json-schema.org/draft/2020-12/schema");
    assert!(json["properties"]["tile"].is_object());
}

#[test]
fn invalid_thread_counts_are_refused() {
    for wrong in ["0", "-1", "many", "1025", "1.5"] {
        let said = Sandbox::new().run(&["check", &shipped("single-tile"), &format!("--threads={wrong}")]);
        assert_eq!((said.status, said.stdout.as_str()), (2, ""), "{wrong}");
        assert!(said.stderr.contains("must be a whole number from 1 to 1024"), "{wrong}: {}", said.stderr);
    }
    assert_eq!(Sandbox::new().run(&["--threads", "2", "check", &shipped("single-tile")]).status, 0);
}

#[test]
fn quiet_prints_results_and_errors_only() {
    let sandbox = Sandbox::new();
    let said = sandbox.run(&["init", "--quiet"]);
    assert_eq!((said.status, said.stdout.as_str(), said.stderr.as_str()), (0, "", ""));
    let said = sandbox.run(&["check", "-q", "film.toml"]);
    assert_eq!((said.status, said.stdout.as_str(), said.stderr.as_str()), (0, "1 layout checked\n", ""));
    let strict = sandbox.read("film.toml").replace("s_z = 0.05", "s_z = 0.01");
    sandbox.write("strict.toml", &format!("{strict}[kind.idle]\nsize_mm = [1, 1, 1]\n"));
    let said = sandbox.run(&["check", "-q", "film.toml", "strict.toml"]);
    assert_eq!(said.status, 1);
    assert_eq!(said.stdout.lines().count(), 4, "{}", said.stdout);
    assert!(
        said.stdout.starts_with("strict.toml: my film, 56 tiles\n  FINDING  kind \"idle\" is declared")
            && said.stdout.contains("\n  FAILED   uniformity_rmse.s_z"),
        "{}",
        said.stdout
    );
    assert!(said.stdout.ends_with("\n2 layouts checked, 1 failed\n"), "{}", said.stdout);
    assert!(sandbox.run(&["field", "-q", "nowhere.toml"]).stderr.contains("cannot read nowhere.toml"));
}

/// Runs the script in bash.
#[test]
fn bash_completes_verbs_and_options() {
    let sandbox = Sandbox::new();
    let script = sandbox.run(&["completions", "bash"]).stdout;
    sandbox.write("magsplice.bash", &script);
    let ask = "source magsplice.bash; COMP_WORDS=(magsplice dec); COMP_CWORD=1; _magsplice magsplice dec magsplice; \
               echo ${COMPREPLY[@]}; COMP_WORDS=(magsplice check --fo); COMP_CWORD=2; _magsplice magsplice --fo check; \
               echo ${COMPREPLY[@]}";
    let output = std::process::Command::new("bash").args(["-c", ask]).current_dir(sandbox.path("")).output();
    let output = output.expect("bash runs");
    assert_eq!(String::from_utf8_lossy(&output.stdout), "decouple\n--format\n");
    for shell in ["zsh", "fish", "powershell", "elvish"] {
        let said = sandbox.run(&["completions", shell]);
        assert_eq!(said.status, 0);
        assert!(["decouple", "check", "tiles"].iter().all(|verb| said.stdout.contains(verb)), "{shell}");
    }
    assert_eq!(sandbox.run(&["completions", "dos"]).status, 2);
}

#[test]
fn tiles_lists_tiles_and_bill_of_the_published_film() {
    let said = Sandbox::new().run(&["tiles", &shipped("published-film")]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    assert_eq!(said.stdout.lines().filter(|l| l.starts_with("  film-x")).count(), 56);
    assert!(said.stdout.contains("  film-x2-y1  3     3.3 x 0.85 x 1"), "{}", said.stdout);
    // Dai 2024, Table 1: 16 squares, 24 strips, 16 strips at the rim.
    let bill = said.stdout.split("bill of materials\n").nth(1).expect("a bill");
    let rows: Vec<String> = bill.lines().skip(1).map(|l| l.split_whitespace().collect::<Vec<_>>().join(" ")).collect();
    let known = [
        "1 16 3.3 x 3.3 x 1 0.12 45 deg film-x2-y2",
        "2 24 3.3 x 1.7 x 1 0.12 0 deg film-x2-y3",
        "3 16 3.3 x 0.85 x 1 0.12 0 deg film-x1-y2",
    ];
    assert_eq!(rows, known);
}

#[test]
fn wrong_arguments_are_refused() {
    let sandbox = Sandbox::new();
    assert_eq!(sandbox.run(&[]).status, 2);
    assert_eq!(sandbox.run(&["field"]).status, 2);
    assert_eq!(sandbox.run(&["field", &shipped("single-tile"), "--quantity", "m"]).status, 2);
    assert_eq!(sandbox.run(&["check"]).status, 2);
    assert_eq!(sandbox.run(&["--version"]).stdout, format!("magsplice {}\n", env!("CARGO_PKG_VERSION")));
}

/// More threads than processors only wait for each other; 100000 of them never ended.
#[cfg(target_os = "linux")]
#[test]
fn threads_are_few_per_processor() {
    let processors = std::thread::available_parallelism().expect("a number").get();
    for asked in ["100000", "99999999999999999999"] {
        let mut program = std::process::Command::new(env!("CARGO_BIN_EXE_magsplice"))
            .args(["field", &shipped("single-tile"), "--points", "-"])
            .env("RAYON_NUM_THREADS", asked)
            .stdin(std::process::Stdio::piped())
            .stdout(std::process::Stdio::null())
            .stderr(std::process::Stdio::null())
            .spawn()
            .expect("the program starts");
        // It waits for points until its input ends. By then its threads have started.
        let tasks = format!("/proc/{}/task", program.id());
        std::thread::sleep(std::time::Duration::from_millis(500));
        let threads = std::fs::read_dir(tasks).expect("a process").count();
        drop(program.stdin.take());
        program.wait().expect("the program ends");
        assert!((2..=4 * processors + 4).contains(&threads), "{threads}");
    }
}
