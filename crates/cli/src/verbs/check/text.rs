//! `check`: one line per expectation.

use std::fmt::Write;

use anstyle::{AnsiColor, Style};
use magsplice::decouple::Figure;
use magsplice::expect::{Bound, Expectation};
use magsplice::results::{Check, CheckStatus, CheckedExpectation, CheckedLayout, CheckedPercentile, rounded_beside};

use crate::failure::escaped;
use crate::text::number::{counted, number, point};
use crate::text::{recoil, rows};

/// Width of the longest label, `FINDING`.
const LABEL_WIDTH: usize = 7;

/// A layout with its error or its findings and expectations. With `quiet` only what is wrong; empty
/// if nothing is.
pub(super) fn checked_layout(checked: &CheckedLayout, quiet: bool, colours: bool) -> String {
    let path = escaped(&checked.file);
    let labelled = |status: CheckStatus, label: &str, line: &str| {
        let style = if colours { word(status).1 } else { Style::new() };
        format!("  {style}{label:<LABEL_WIDTH$}{style:#}{line}\n")
    };
    let (Some(layout), Some(tiles)) = (&checked.layout, checked.tiles) else {
        let reason = indented(checked.error.as_deref().unwrap_or_default(), LABEL_WIDTH + 4);
        let error = labelled(CheckStatus::Unusable, "ERROR", &format!("  {reason}"));
        return format!("{path}: cannot be used\n{error}");
    };
    let is_shown = |expectation: &&CheckedExpectation| !quiet || expectation.status != CheckStatus::Ok;
    let shown: Vec<&CheckedExpectation> = checked.expectations.iter().filter(is_shown).collect();
    if quiet && shown.is_empty() && checked.findings.is_empty() {
        return String::new();
    }
    let none = if checked.expectations.is_empty() { ", no expectations" } else { "" };
    let mut text = format!("{path}: {layout}, {}{none}\n", counted(tiles, "tile", "tiles"));
    for finding in &checked.findings {
        let message = escaped(finding);
        text += &labelled(CheckStatus::Finding, "FINDING", &format!("  {message}"));
    }
    let mut rows: Vec<[String; 5]> = shown.iter().map(|expectation| row(expectation)).collect();
    // One cause can keep several expectations from being evaluated; it is printed once.
    for i in 1..shown.len() {
        let is_same = |earlier: &&&CheckedExpectation| earlier.error == shown[i].error;
        if shown[i].error.is_some()
            && let Some(earlier) = shown[..i].iter().find(is_same)
        {
            rows[i][1] = format!("for the same reason as {}", earlier.expectation);
        }
    }
    for (line, expectation) in in_columns(&rows, &shown).iter().zip(shown) {
        text += &labelled(expectation.status, word(expectation.status).0, line);
    }
    if !quiet && !checked.recoil_estimates.is_empty() {
        text += "  recoil   its effect, to first order:\n";
        for estimate in &checked.recoil_estimates {
            rows::prose(&mut text, &recoil::estimate(estimate));
        }
    }
    text
}

/// The last line: how many layouts were checked, and with which results.
pub(super) fn summary(check: &Check) -> String {
    let count = |status| check.layouts.iter().filter(|checked| checked.status == status).count();
    let mut text = format!("{} checked", counted(check.layouts.len(), "layout", "layouts"));
    for (count, word) in [(count(CheckStatus::Finding), "failed"), (count(CheckStatus::Unusable), "with an error")] {
        if count > 0 {
            let _ = write!(text, ", {count} {word}");
        }
    }
    if !check.skipped.is_empty() {
        let _ = write!(text, ", {} skipped", counted(check.skipped.len(), "other file", "other files"));
    }
    text + "\n"
}

/// An outcome in words, with every digit; empty if there is none.
pub(super) fn sentence(checked: &CheckedExpectation) -> String {
    let (Some(value), Some(margin)) = (checked.value, checked.margin) else { return String::new() };
    // The difference of two numbers has the digits of the numbers.
    let margin = rounded_beside(margin, value);
    format!("{value:?}, {}, margin {margin:?} {}", bound(checked), location(checked)).trim_end().to_owned()
}

/// A message of which all lines but the first begin after `indent` blanks.
fn indented(message: &str, indent: usize) -> String {
    escaped(&message.trim_end()).replace('\n', &format!("\n{:indent$}", ""))
}

/// The bound with the digits of the layout file.
fn bound(checked: &CheckedExpectation) -> String {
    match checked.bound {
        Some(Bound::AtMost(most)) => format!("at most {most:?}"),
        Some(Bound::AtLeast(least)) => format!("at least {least:?}"),
        None => String::new(),
    }
}

/// The point or the tile where the value was found; empty if it is of the whole film. What a
/// negative amplitude means stands in the same place.
fn location(checked: &CheckedExpectation) -> String {
    if let Some(p) = checked.at_mm {
        return format!("at {} mm", point(p));
    }
    if let Some(tile) = &checked.tile {
        return format!("tile \"{tile}\"");
    }
    if let Some(CheckedPercentile { per_cent, value, samples }) = checked.percentile {
        return format!("P{per_cent} of {samples} films is {}; the value is its confidence limit", number(value));
    }
    if checked.expectation == Expectation::Figure(Figure::Amplitude)
        && checked.value.is_some_and(|amplitude| amplitude < 0.0)
    {
        return "the film is reversed or shifted by half a wavelength".to_owned();
    }
    String::new()
}

/// The rows as lines. A reason does not widen the columns of the values.
fn in_columns(rows: &[[String; 5]], shown: &[&CheckedExpectation]) -> Vec<String> {
    let key_width = rows.iter().map(|row| row[0].len()).max().unwrap_or(0);
    let mut values: Vec<[String; 5]> =
        rows.iter().zip(shown).filter(|(_, e)| e.error.is_none()).map(|(row, _)| row.clone()).collect();
    for row in &mut values {
        row[0] = format!("{:<key_width$}", row[0]);
    }
    let mut values = rows::columns(&values).into_iter();
    let mut line = |(row, expectation): (&[String; 5], &&CheckedExpectation)| match expectation.error {
        None => values.next().unwrap_or_default(),
        // The reason begins in the column of the values, and stays there.
        Some(_) => format!("  {:<key_width$}  {}", row[0], indented(&row[1], LABEL_WIDTH + key_width + 6)),
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

fn row(checked: &CheckedExpectation) -> [String; 5] {
    let key = checked.expectation.to_string();
    match (checked.value, checked.margin) {
        (Some(value), Some(margin)) => {
            [key, number(value), bound(checked), format!("margin {}", number(margin)), location(checked)]
        }
        _ => [key, checked.error.clone().unwrap_or_default(), String::new(), String::new(), String::new()],
    }
}
