//! What `check` found, one line per expectation.

use std::fmt::Write;

use anstyle::{AnsiColor, Style};
use magsplice::expect::{Bound, Location, Outcome};
use magsplice::layout::Layout;

use super::{Checked, Line, Status};
use crate::text::{number, tile_count};

/// Nothing for a layout that cannot be used: there is only an error to tell. If `quiet`, nothing of what is as it should be.
pub(super) fn of(checked: &Checked, quiet: bool, colours: bool) -> String {
    let Ok(layout) = &checked.layout else { return String::new() };
    let shown: Vec<&Line> = checked.lines.iter().filter(|line| !quiet || line.status() != Status::Fine).collect();
    if quiet && shown.is_empty() {
        return String::new();
    }
    let expected = if checked.lines.is_empty() { ", nothing expected" } else { "" };
    let mut text = format!("{}: {}, {}{expected}\n", checked.path.display(), layout.name, tile_count(layout));
    let rows: Vec<[String; 5]> = shown.iter().map(|line| row(line, layout)).collect();
    let width = |column: usize| rows.iter().map(|row| row[column].len()).max().unwrap_or(0);
    let widths = [0, 1, 2, 3].map(width);
    for (row, line) in rows.iter().zip(shown) {
        let (word, style) = word(line.status());
        let style = if colours { style } else { Style::new() };
        let mut cells = String::new();
        for (cell, width) in row.iter().zip(widths) {
            let _ = write!(cells, "  {cell:<width$}");
        }
        let cells = format!("{cells}  {}", row[4]);
        let _ = writeln!(text, "  {style}{word:<6}{style:#}{}", cells.trim_end());
    }
    text
}

fn word(status: Status) -> (&'static str, Style) {
    match status {
        Status::Fine => ("ok", AnsiColor::Green.on_default()),
        Status::Finding => ("FAILED", AnsiColor::Red.on_default().bold()),
        Status::Unusable => ("ERROR", AnsiColor::Red.on_default().bold()),
    }
}

fn row(line: &Line, layout: &Layout) -> [String; 5] {
    let key = line.expectation.to_string();
    match &line.outcome {
        Ok(outcome) => {
            let margin = format!("margin {}", number(outcome.margin()));
            [key, number(outcome.value), bound(outcome), margin, place(outcome, layout)]
        }
        Err(_) => [key, String::new(), String::new(), String::new(), "cannot be evaluated".to_owned()],
    }
}

/// The bound with the digits of the layout file.
pub(super) fn bound(outcome: &Outcome) -> String {
    match outcome.bound {
        Bound::AtMost(most) => format!("at most {most:?}"),
        Bound::AtLeast(least) => format!("at least {least:?}"),
    }
}

pub(super) fn place(outcome: &Outcome, layout: &Layout) -> String {
    match outcome.location {
        None => String::new(),
        Some(Location::Point(p)) => format!("at ({}, {}, {}) mm", p.x, p.y, p.z),
        Some(Location::Tile(tile)) => format!("tile \"{}\"", layout.tiles[tile].name),
        Some(_) => String::new(),
    }
}
