//! Random edits of the shipped layouts, and arbitrary text: each is read, or refused with a
//! message.
//!
//! `cargo test --features magsplice-tests/all-cases --test film fuzz -- --nocapture` runs all cases
//! and prints the numbers of edits read and refused.

use std::cell::RefCell;
use std::path::PathBuf;

use magsplice::prelude::*;
use magsplice_tests::cases;
use proptest::prelude::*;
use proptest::sample::Index;
use proptest::test_runner::{Config, TestRunner};

use crate::shipped;

/// Longest message about a layout. It lists at most twenty faults of each sort.
const LONGEST_MESSAGE: usize = 20_000;

/// Values that replace a number. Repetitions of a billion are refused; a thousand would make films
/// of millions of tiles.
const NUMBERS: [&str; 18] = [
    "0",
    "-0.0",
    "-1",
    "1",
    "2",
    "7",
    "0.1",
    "1e-3",
    "1e-12",
    "1e-200",
    "1e-320",
    "1e9",
    "1e300",
    "nan",
    "inf",
    "-inf",
    "9223372036854775807",
    "99999999999999999999",
];

/// Texts that replace a value or are inserted.
const TEXTS: [&str; 12] =
    ["\"\"", "true", "[]", "{}", "[[]]", "[1, 2]", "\"\\u0000\"", "'\u{202e}'", "1979-05-27", "= =", "\u{feff}", "#"];

#[derive(Clone, Copy, Debug)]
enum Edit {
    Number,
    Text,
    RemoveLine,
    RepeatLine,
    MoveLine,
    RenameKey,
    Cut,
    Insert,
}

const EDITS: [Edit; 8] = [
    Edit::Number,
    Edit::Text,
    Edit::RemoveLine,
    Edit::RepeatLine,
    Edit::MoveLine,
    Edit::RenameKey,
    Edit::Cut,
    Edit::Insert,
];

impl Edit {
    /// The text after the edit at the place `at`, with the value `with`.
    fn apply(self, text: &str, at: Index, with: Index) -> String {
        let lines: Vec<&str> = text.lines().collect();
        if lines.is_empty() {
            return text.to_owned();
        }
        let chosen = at.index(lines.len());
        let mut lines: Vec<String> = lines.into_iter().map(str::to_owned).collect();
        match self {
            Edit::Number => return with_number(text, at, NUMBERS[with.index(NUMBERS.len())]),
            Edit::Text => return with_number(text, at, TEXTS[with.index(TEXTS.len())]),
            Edit::RemoveLine => drop(lines.remove(chosen)),
            Edit::RepeatLine => lines.insert(with.index(lines.len()), lines[chosen].clone()),
            Edit::MoveLine => {
                let line = lines.remove(chosen);
                lines.insert(with.index(lines.len() + 1), line);
            }
            Edit::RenameKey => lines[chosen] = lines[chosen].replacen('_', "-", 1),
            Edit::Cut => {
                let line = &mut lines[chosen];
                let end = (0..=with.index(line.len() + 1)).rev().find(|&end| line.is_char_boundary(end)).unwrap_or(0);
                line.truncate(end);
            }
            Edit::Insert => lines[chosen].push_str(TEXTS[with.index(TEXTS.len())]),
        }
        lines.join("\n")
    }
}

/// The text with one of its numbers replaced.
fn with_number(text: &str, at: Index, value: &str) -> String {
    let is_part = |c: char| c.is_ascii_digit() || "+-.".contains(c);
    let starts: Vec<usize> = text
        .char_indices()
        .zip(std::iter::once(' ').chain(text.chars()))
        .filter(|((_, c), before)| is_part(*c) && " [,=".contains(*before))
        .map(|((start, _), _)| start)
        .collect();
    if starts.is_empty() {
        return text.to_owned();
    }
    let start = starts[at.index(starts.len())];
    let end = text[start..].find(|c| !is_part(c)).map_or(text.len(), |end| start + end);
    format!("{}{value}{}", &text[..start], &text[end..])
}

/// Reads a text, then writes a layout and reads it again. A message must be short and safe for a
/// terminal. Returns whether the text was read.
fn read(text: &str) -> Result<bool, TestCaseError> {
    match Layout::parse(text, "fuzz.toml") {
        Ok(layout) => {
            let again = Layout::parse(&layout.to_toml(), "again.toml");
            let again = again.map_err(|e| TestCaseError::fail(format!("what was written is refused: {e}")))?;
            prop_assert_eq!(layout.bare_tiles(), again.bare_tiles());
            Ok(true)
        }
        Err(error) => {
            let message = error.to_string();
            prop_assert!(!message.is_empty() && message.len() <= LONGEST_MESSAGE, "{} bytes", message.len());
            prop_assert!(!message.chars().any(|c| c.is_control() && c != '\n'), "{message:?}");
            Ok(false)
        }
    }
}

#[test]
fn edited_layouts_are_read_or_refused_in_words() {
    let entries = std::fs::read_dir(shipped::folder()).expect("the folder of layouts");
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    paths.sort();
    let mut layouts: Vec<String> = paths.iter().map(|path| std::fs::read_to_string(path).expect("a layout")).collect();
    // As often as all shipped layouts together.
    layouts.extend(vec![shipped::EVERY_KEY.to_owned(); paths.len()]);
    let edit = (0..EDITS.len(), any::<Index>(), any::<Index>());
    let texts = (any::<Index>(), prop::collection::vec(edit, 1..4));
    let counts = RefCell::new([[0_u32; 2]; EDITS.len()]);
    TestRunner::new(Config { cases: cases(20_000), failure_persistence: None, ..Config::default() })
        .run(&texts, |(layout, edits)| {
            let mut text = layouts[layout.index(layouts.len())].clone();
            for &(edit, at, with) in &edits {
                text = EDITS[edit].apply(&text, at, with);
            }
            let is_read = read(&text)?;
            for (edit, ..) in edits {
                counts.borrow_mut()[edit][usize::from(is_read)] += 1;
            }
            Ok(())
        })
        .unwrap_or_else(|e| panic!("{e}"));
    for (edit, [refused, is_read]) in EDITS.iter().zip(counts.into_inner()) {
        println!("{edit:?}: {is_read} read, {refused} refused");
        assert!(refused > 0, "no edit {edit:?} was refused");
    }
}

#[test]
fn arbitrary_text_is_refused_in_words() {
    let texts = prop::collection::vec(any::<u8>(), 0..400);
    TestRunner::new(Config { cases: cases(20_000), failure_persistence: None, ..Config::default() })
        .run(&texts, |bytes| read(&String::from_utf8_lossy(&bytes)).map(|_| ()))
        .unwrap_or_else(|e| panic!("{e}"));
}
