//! Help texts, compared with the files in help/. `UPDATE_EXPECT=1 cargo test -p magsplice-cli help`
//! rewrites these files; read them afterwards.

use std::fs;
use std::path::Path;
use std::process::Command;

use expect_test::expect_file;

fn help(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_magsplice"))
        .args(arguments)
        // The width of the text without a terminal.
        .env_remove("COLUMNS")
        .env_remove("CLICOLOR_FORCE")
        .output()
        .expect("the program starts");
    assert!(output.status.success(), "{arguments:?}");
    String::from_utf8(output.stdout).expect("UTF-8")
}

fn verbs() -> Vec<String> {
    let main = help(&["--help"]);
    let commands = main.split("Commands:\n").nth(1).expect("commands").split("\n\n").next().expect("lines");
    let verbs = commands.lines().filter_map(|line| line.strip_prefix("  ").filter(|l| !l.starts_with(' ')));
    verbs.filter_map(|line| line.split_whitespace().next()).filter(|v| *v != "help").map(str::to_owned).collect()
}

#[test]
fn help_texts_match_the_reviewed_files() {
    expect_file!["help/magsplice.txt"].assert_eq(&help(&["--help"]));
    let verbs = verbs();
    assert!(verbs.len() >= 8, "{verbs:?}");
    for verb in &verbs {
        let text = help(&[verb, "--help"]);
        assert!(text.contains(&format!("\nExample:\n  magsplice {verb}")), "{verb} has no example");
        assert!(text.lines().all(|line| line.chars().count() <= 100), "{verb} is too wide");
        expect_file![format!("help/{verb}.txt")].assert_eq(&text);
    }
    for entry in fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/program/help")).expect("texts") {
        let path = entry.expect("an entry").path();
        let name = path.file_stem().and_then(|s| s.to_str()).expect("UTF-8").to_owned();
        assert!(name == "magsplice" || verbs.contains(&name), "there is no verb {name}");
    }
}
