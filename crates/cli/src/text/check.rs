//! `check`: one line per expectation.

use std::fmt::Write;

use anstyle::{AnsiColor, Style};
use magsplice::expect::{Bound, Expectation, Location, Outcome};
use magsplice::layout::Layout;

use super::header::tile_count;
use super::number::number;
use super::rows;
use crate::checked::{CheckStatus, CheckedExpectation, CheckedLayout};

/// A layout and its expectations. With `quiet` only the expectations that are not met; empty if
/// none is left, or if the layout cannot be used.
pub(crate) fn checked_layout(checked: &CheckedLayout, quiet: bool, colours: bool) -> String {
    let Ok(layout) = &checked.layout else { return String::new() };
    let is_shown = |expectation: &&CheckedExpectation| !quiet || expectation.status() != CheckStatus::Ok;
    let shown: Vec<&CheckedExpectation> = checked.expectations.iter().filter(is_shown).collect();
    if quiet && shown.is_empty() {
        return String::new();
    }
    let none = if checked.expectations.is_empty() { ", no expectations" } else { "" };
    let mut text = format!("{}: {}, {}{none}\n", checked.path.display(), layout.name, tile_count(layout));
    let rows: Vec<[String; 5]> = shown.iter().map(|expectation| row(expectation, layout)).collect();
    for (line, expectation) in in_columns(&rows, &shown).iter().zip(shown) {
        let (word, style) = word(expectation.status());
        let style = if colours { style } else { Style::new() };
        let _ = writeln!(text, "  {style}{word:<6}{style:#}{line}");
    }
    text
}

/// The bound with the digits of the layout file.
pub(crate) fn bound(outcome: &Outcome) -> String {
    match outcome.bound {
        Bound::AtMost(most) => format!("at most {most:?}"),
        Bound::AtLeast(least) => format!("at least {least:?}"),
    }
}

/// The point or the tile where the value was found; empty if it is of the whole film. What a
/// negative amplitude means stands in the same place.
pub(crate) fn location(outcome: &Outcome, layout: &Layout) -> String {
    match outcome.location {
        Some(Location::Point(p)) => format!("at ({}, {}, {}) mm", p.x, p.y, p.z),
        Some(Location::Tile(tile)) => format!("tile \"{}\"", layout.tiles[tile].name),
        _ if outcome.expectation == Expectation::Amplitude && outcome.value < 0.0 => {
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
        Err(_) => format!("  {:<key_width$}  {}", row[0], row[1]),
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
        // The reason begins in the column of the values.
        Err(reason) => {
            [key, reason.lines().next().unwrap_or_default().to_owned(), String::new(), String::new(), String::new()]
        }
    }
}
