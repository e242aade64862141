//! `check`: one line per expectation.

use std::fmt::Write;

use anstyle::{AnsiColor, Style};
use magsplice::decouple::Figure;
use magsplice::expect::{Bound, Expectation, Location, Outcome};
use magsplice::layout::Layout;

use super::header::tile_count;
use super::number::{counted, number};
use super::{recoil, rows};
use crate::checked::{CheckStatus, CheckedExpectation, CheckedLayout};
use crate::failure::escaped;

/// Width of the longest label, `FINDING`.
const LABEL_WIDTH: usize = 7;

/// A layout with its error or its findings and expectations. With `quiet` only what is wrong; empty
/// if nothing is.
pub(crate) fn checked_layout(checked: &CheckedLayout, quiet: bool, colours: bool) -> String {
    let path = escaped(&checked.path.display());
    let labelled = |status: CheckStatus, label: &str, line: &str| {
        let style = if colours { word(status).1 } else { Style::new() };
        format!("  {style}{label:<LABEL_WIDTH$}{style:#}{line}\n")
    };
    let layout = match &checked.layout {
        Ok(layout) => layout,
        Err(message) => {
            let reason = indented(message, LABEL_WIDTH + 4);
            return format!(
                "{path}: cannot be used\n{}",
                labelled(CheckStatus::Unusable, "ERROR", &format!("  {reason}"))
            );
        }
    };
    let is_shown = |expectation: &&CheckedExpectation| !quiet || expectation.status() != CheckStatus::Ok;
    let shown: Vec<&CheckedExpectation> = checked.expectations.iter().filter(is_shown).collect();
    if quiet && shown.is_empty() && layout.findings.is_empty() {
        return String::new();
    }
    let none = if checked.expectations.is_empty() { ", no expectations" } else { "" };
    let mut text = format!("{path}: {}, {}{none}\n", layout.name, tile_count(layout));
    for finding in &layout.findings {
        let message = escaped(&finding.message);
        text += &labelled(CheckStatus::Finding, "FINDING", &format!("  {message}"));
    }
    let mut rows: Vec<[String; 5]> = shown.iter().map(|expectation| row(expectation, layout)).collect();
    // One cause can keep several expectations from being evaluated; it is printed once.
    for i in 1..shown.len() {
        let is_same =
            |earlier: &&&CheckedExpectation| earlier.outcome.as_ref().err() == shown[i].outcome.as_ref().err();
        if shown[i].outcome.is_err()
            && let Some(earlier) = shown[..i].iter().find(is_same)
        {
            rows[i][1] = format!("for the same reason as {}", earlier.expectation);
        }
    }
    for (line, expectation) in in_columns(&rows, &shown).iter().zip(shown) {
        text += &labelled(expectation.status(), word(expectation.status()).0, line);
    }
    if !quiet && !checked.recoil.is_empty() {
        text += "  recoil   what it changes, to first order:\n";
        for estimate in &checked.recoil {
            rows::prose(&mut text, &recoil::estimate(estimate));
        }
    }
    text
}

/// The last line: how many layouts were checked, and with which results.
pub(crate) fn summary(all: &[CheckedLayout], skipped: usize) -> String {
    let count = |status| all.iter().filter(|checked| checked.status() == status).count();
    let mut text = format!("{} checked", counted(all.len(), "layout", "layouts"));
    for (count, word) in [(count(CheckStatus::Finding), "failed"), (count(CheckStatus::Unusable), "with an error")] {
        if count > 0 {
            let _ = write!(text, ", {count} {word}");
        }
    }
    if skipped > 0 {
        let _ = write!(text, ", {} skipped", counted(skipped, "other file", "other files"));
    }
    text + "\n"
}

/// An outcome in words, with every digit.
pub(crate) fn sentence(outcome: &Outcome, layout: &Layout) -> String {
    let (value, margin) = (outcome.value, outcome.margin());
    format!("{value:?}, {}, margin {margin:?} {}", bound(outcome), location(outcome, layout)).trim_end().to_owned()
}

/// A message of which all lines but the first begin after `indent` blanks.
fn indented(message: &str, indent: usize) -> String {
    escaped(&message.trim_end()).replace('\n', &format!("\n{:indent$}", ""))
}

/// The bound with the digits of the layout file.
fn bound(outcome: &Outcome) -> String {
    match outcome.bound {
        Bound::AtMost(most) => format!("at most {most:?}"),
        Bound::AtLeast(least) => format!("at least {least:?}"),
    }
}

/// The point or the tile where the value was found; empty if it is of the whole film. What a
/// negative amplitude means stands in the same place.
fn location(outcome: &Outcome, layout: &Layout) -> String {
    match outcome.location {
        Some(Location::Point(p)) => format!("at ({}, {}, {}) mm", p.x, p.y, p.z),
        Some(Location::Tile(tile)) => format!("tile \"{}\"", layout.tiles[tile].name),
        Some(Location::Percentile { per_cent, value, samples }) => {
            format!("P{per_cent} of {samples} films is {}", number(value))
        }
        _ if outcome.expectation == Expectation::Figure(Figure::Amplitude) && outcome.value < 0.0 => {
            "the film is reversed or shifted by half a wavelength".to_owned()
        }
        _ => String::new(),
    }
}

/// The rows as lines. A reason does not widen the columns of the values.
fn in_columns(rows: &[[String; 5]], shown: &[&CheckedExpectation]) -> Vec<String> {
    let key_width = rows.iter().map(|row| row[0].len()).max().unwrap_or(0);
    let mut values: Vec<[String; 5]> =
        rows.iter().zip(shown).filter(|(_, e)| e.outcome.is_ok()).map(|(row, _)| row.clone()).collect();
    for row in &mut values {
        row[0] = format!("{:<key_width$}", row[0]);
    }
    let mut values = rows::columns(&values).into_iter();
    let mut line = |(row, expectation): (&[String; 5], &&CheckedExpectation)| match expectation.outcome {
        Ok(_) => values.next().unwrap_or_default(),
        // The reason begins in the column of the values, and stays there.
        Err(_) => format!("  {:<key_width$}  {}", row[0], indented(&row[1], LABEL_WIDTH + key_width + 6)),
    };
    rows.iter().zip(shown).map(&mut line).collect()
}

fn word(status: CheckStatus) -> (&'static str, Style) {
    match status {
        CheckStatus::Ok => ("ok", AnsiColor::Green.on_default()),
        CheckStatus::Finding => ("FAILED", AnsiColor::Red.on_default().bold()),
        CheckStatus::Unusable => ("ERROR", AnsiColor::Red.on_default().bold()),
    }
}

fn row(checked: &CheckedExpectation, layout: &Layout) -> [String; 5] {
    let key = checked.expectation.to_string();
    match &checked.outcome {
        Ok(outcome) => {
            let margin = format!("margin {}", number(outcome.margin()));
            [key, number(outcome.value), bound(outcome), margin, location(outcome, layout)]
        }
        Err(reason) => [key, reason.clone(), String::new(), String::new(), String::new()],
    }
}
