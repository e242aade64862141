//! The command line.

/// `--within`: the accuracy of a field.
pub(crate) mod accuracy;
/// Parameters of a scan that can be fitted.
pub(crate) mod fit;
/// Output formats, their names and file endings.
pub(crate) mod formats;
/// `--unit`: units of columns.
pub(crate) mod given_units;
/// Errors of measurements of tiles.
pub(crate) mod measurement;
/// Numbers with units as a person types them.
pub(crate) mod numbers;
/// `--points` and `--unit`: points from a file.
pub(crate) mod points;
/// `--preset`: usual errors of tiles.
pub(crate) mod preset;
/// The noise of readings.
pub(crate) mod readings;
/// `--sorted`: tiles that are measured and sorted.
pub(crate) mod sorting;

use std::ffi::OsString;
use std::fmt::Write;

use clap::{Command, CommandFactory, Parser};
use numbers::whole;

use crate::verbs::{GROUPS, Verb};

const FIRST_STEPS: &str = if cfg!(feature = "report") {
    "Example:\n  magsplice init film.toml\n  magsplice report film.toml -o report\n  magsplice decouple film.toml"
} else {
    "Example:\n  magsplice init film.toml\n  magsplice decouple film.toml"
};

/// Exact simulation of spliced magnet films.
///
/// Reads a layout file (TOML; lengths in mm, polarization in T). Computes the magnetic field of its
/// tiles, compares it with the field of the ideal sinusoidal film, and evaluates how well the film
/// decouples: how far each of R_x, R_y and S_z depends on one coordinate only.
#[derive(Parser)]
#[command(name = "magsplice", version, max_term_width = 100)]
#[command(after_help = FIRST_STEPS)]
pub(crate) struct Args {
    #[command(flatten)]
    pub(crate) common: CommonArgs,
    #[command(subcommand)]
    pub(crate) verb: Verb,
}

/// Options of every verb.
#[derive(clap::Args)]
#[command(next_help_heading = "Options of every command")]
pub(crate) struct CommonArgs {
    /// Number of threads that compute, at most four per processor [default: one per processor, or
    /// RAYON_NUM_THREADS of the environment]; results do not depend on it
    #[arg(long, global = true, value_name = "N", value_parser = |text: &str| whole(text, 1..=MAX_THREADS))]
    pub(crate) threads: Option<usize>,
    /// Print results and errors only: no progress and no remarks; check prints only what fails
    #[arg(short, long, global = true)]
    pub(crate) quiet: bool,
}

/// Largest number of threads: above the number of processors of any machine the program is meant
/// for.
const MAX_THREADS: usize = 1024;

/// The verbs that read a table of a film: `read LAYOUT TABLE`.
const WITH_TABLE: [&str; 3] = ["read", "calibrate", "scan"];

/// The command line, with the layout first. `read TABLE --layout LAYOUT` is the earlier form of
/// `read LAYOUT TABLE`.
pub(crate) fn layout_first(mut words: Vec<OsString>) -> Vec<OsString> {
    let Some(verb) = words.iter().position(|word| WITH_TABLE.iter().any(|verb| word == verb)) else { return words };
    let option = words.iter().enumerate().skip(verb + 1).find_map(|(at, word)| {
        let value = word.to_str()?.strip_prefix("--layout")?;
        // The layout is the next word, or stands behind an equals sign.
        match value.strip_prefix('=') {
            Some(layout) => Some((at..at + 1, OsString::from(layout))),
            None if value.is_empty() => Some((at..at + 2, words.get(at + 1)?.clone())),
            None => None,
        }
    });
    if let Some((option, layout)) = option {
        words.drain(option);
        words.insert(verb + 1, layout);
    }
    words
}

/// The program with its commands in groups.
pub(crate) fn command() -> Command {
    let mut command = Args::command();
    // Adds the command `help`.
    command.build();
    let mut list = String::new();
    let header = *command.get_styles().get_header();
    for (title, verbs) in GROUPS {
        let _ = writeln!(list, "{header}{title}:{header:#}");
        for verb in verbs.concat() {
            let about = command.find_subcommand(verb).and_then(Command::get_about);
            let _ = writeln!(list, "  {verb:<13}{}", about.map(ToString::to_string).unwrap_or_default());
        }
        list.push('\n');
    }
    let verbs: Vec<String> = command.get_subcommands().map(|verb| verb.get_name().to_owned()).collect();
    // The groups list them.
    let hidden = |command: Command, verb: &String| command.mut_subcommand(verb, |verb| verb.hide(true));
    let usage = format!("{} [OPTIONS] <COMMAND>", command.get_name());
    verbs.iter().fold(command, hidden).override_usage(usage).help_template(format!(
        "{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{list}{{all-args}}{{after-help}}"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_is_in_one_group() {
        let mut grouped: Vec<&str> = GROUPS.iter().flat_map(|(_, verbs)| verbs.concat()).collect();
        let mut command = Args::command();
        command.build();
        let mut all: Vec<&str> = command.get_subcommands().map(Command::get_name).collect();
        grouped.sort_unstable();
        all.sort_unstable();
        assert_eq!(grouped, all);
    }

    #[test]
    fn layout_of_the_earlier_form_comes_first() {
        let words = |text: &str| text.split(' ').map(OsString::from).collect::<Vec<_>>();
        for (earlier, now) in [
            ("magsplice read r.csv --layout f.toml --zero 3", "magsplice read f.toml r.csv --zero 3"),
            ("magsplice -q scan --fit start s.csv --layout=f.toml", "magsplice -q scan f.toml --fit start s.csv"),
            ("magsplice calibrate --layout f.toml r.csv", "magsplice calibrate f.toml r.csv"),
            ("magsplice read f.toml r.csv", "magsplice read f.toml r.csv"),
            ("magsplice read r.csv --layout", "magsplice read r.csv --layout"),
            ("magsplice field f.toml --layout f.toml", "magsplice field f.toml --layout f.toml"),
        ] {
            assert_eq!(layout_first(words(earlier)), words(now));
        }
    }
}
