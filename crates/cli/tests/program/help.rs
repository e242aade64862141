//! Help texts, compared with help.txt. `UPDATE_EXPECT=1 cargo test -p magsplice-cli help` rewrites
//! the file; read the change afterwards.

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
    let (_, commands) = main.split_once("<COMMAND>\n").expect("the usage");
    let (commands, _) = commands.split_once("\nOptions:\n").expect("options");
    let verbs = commands.lines().filter_map(|line| line.strip_prefix("  ").filter(|l| !l.starts_with(' ')));
    verbs.filter_map(|line| line.split_whitespace().next()).filter(|v| *v != "help").map(str::to_owned).collect()
}

#[test]
fn help_texts_match_the_reviewed_file() {
    let mut all = format!("$ magsplice --help\n{}", help(&["--help"]));
    for group in ["Layouts:\n  init ", "Evaluate a film:\n  decouple ", "Design a film:\n  splice "] {
        assert!(all.contains(group), "{group:?} is not in {all}");
    }
    let verbs = verbs();
    assert!(verbs.len() >= 8, "{verbs:?}");
    for verb in &verbs {
        let text = help(&[verb, "--help"]);
        assert!(text.contains(&format!("\nExample:\n  magsplice {verb}")), "{verb} has no example");
        assert!(text.lines().all(|line| line.chars().count() <= 100), "{verb} is too wide");
        all += &format!("\n$ magsplice {verb} --help\n{text}");
    }
    expect_file!["help.txt"].assert_eq(&all);
}
