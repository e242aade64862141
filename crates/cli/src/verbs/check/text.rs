//! What `check` found, one line per expectation.

use std::fmt::Write;

use magsplice::expect::{Bound, Outcome, Place};
use magsplice::layout::Layout;

use super::{Checked, Line, Status};
use crate::text::{number, tile_count};

/// Nothing for a layout that cannot be used: there is only an error to tell.
pub(super) fn of(checked: &Checked) -> String {
    let Ok(layout) = &checked.layout else { return String::new() };
    let expected = if checked.lines.is_empty() { ", nothing expected" } else { "" };
    let mut text = format!("{}: {}, {}{expected}\n", checked.path.display(), layout.name, tile_count(layout));
    let rows: Vec<[String; 5]> = checked.lines.iter().map(|line| row(line, layout)).collect();
    let width = |column: usize| rows.iter().map(|row| row[column].len()).max().unwrap_or(0);
    let widths = [0, 1, 2, 3].map(width);
    for (row, line) in rows.iter().zip(&checked.lines) {
        let mut cells = format!("  {:<6}", word(line.status()));
        for (cell, width) in row.iter().zip(widths) {
            let _ = write!(cells, "  {cell:<width$}");
        }
        let _ = writeln!(text, "{}", format!("{cells}  {}", row[4]).trim_end());
    }
    text
}

fn word(status: Status) -> &'static str {
    match status {
        Status::Fine => "ok",
        Status::Finding => "FAILED",
        Status::Unusable => "ERROR",
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
    match outcome.place {
        None => String::new(),
        Some(Place::Point(p)) => format!("at ({}, {}, {}) mm", p.x, p.y, p.z),
        Some(Place::Tile(tile)) => format!("tile \"{}\"", layout.tiles[tile].name),
    }
}
