//! `diagnose`: the tiles that are wrong, and what the scan cannot tell.

use std::collections::BTreeMap;
use std::fmt::Write;

use magsplice::magnet::TileError;

use super::number::{counted, number};
use super::{header, rows};
use crate::args::diagnose::DiagnoseArgs;
use crate::args::sensor::FitArg;
use crate::sensor::diagnosed_film::{DiagnosedFilm, in_words};

/// Tiles, errors and pairs that are listed.
const LISTED: usize = 6;

/// The report of `diagnose`.
pub(crate) fn diagnosis(film: &DiagnosedFilm, args: &DiagnoseArgs) -> String {
    let mut text = header::with_recoil(film.layout, film.recoil.as_ref());
    let noise = film.noise_t * 1e6;
    let readings = counted(film.readings, "reading", "readings");
    let _ = writeln!(text, "scan {}: {readings}, noise {}, {}, {} uT", args.scan.display(), noise.x, noise.y, noise.z);
    let _ = writeln!(
        text,
        "{}, false alarms in {} % of right films",
        if film.has_ordinary {
            "tiles are named beyond their ordinary errors"
        } else {
            "tiles that are not named count as ordered"
        },
        100.0 * film.false_alarm
    );
    text.push('\n');
    named(&mut text, film);
    if !film.diagnosis.is_complete {
        rows::prose(
            &mut text,
            "and more: the film is another one, or give the ordinary errors of its tiles, as by --preset",
        );
    }
    fitted(&mut text, film, args);
    let diagnosis = &film.diagnosis;
    text.push('\n');
    rows::cell(&mut text, "residual of a component, uT", &number(diagnosis.residual_t() * 1e6));
    rows::cell(
        &mut text,
        "chi squared over its expectation",
        &number(diagnosis.chi_squared / diagnosis.freedom as f64),
    );
    if diagnosis.is_residual_too_large() {
        rows::prose(&mut text, "The residual is too large for the noise: errors that are named may be others.");
    }
    unresolved(&mut text, film);
    text
}

/// The errors that are named.
fn named(text: &mut String, film: &DiagnosedFilm) {
    if film.diagnosis.named.is_empty() {
        text.push_str("no tile is wrong\n");
        return;
    }
    let _ = writeln!(text, "{}:", counted(film.diagnosis.named.len(), "error", "errors"));
    for named in &film.diagnosis.named {
        let _ = writeln!(text, "  {}: {}", film.name(named.candidate.tile), in_words(named));
        for estimate in &named.components {
            let label = format!("    {}, {}", estimate.error.name(), estimate.error.unit());
            let value = estimate.error.shown(estimate.value);
            let deviation = estimate.error.shown(estimate.deviation);
            let _ = writeln!(text, "{label:<42}{value:>11.4} +- {deviation:.4}");
        }
        if !named.alternatives.is_empty() {
            let others: Vec<String> =
                named.alternatives.iter().take(LISTED).map(|other| film.candidate(*other)).collect();
            rows::prose(text, &format!("or, nearly as well: {}", others.join(", ")));
        }
    }
}

/// The parameters of the scan that were fitted.
fn fitted(text: &mut String, film: &DiagnosedFilm, args: &DiagnoseArgs) {
    if args.fit.is_empty() {
        return;
    }
    let scan = &film.diagnosis.scan;
    text.push('\n');
    rows::heading(text, "fitted", ["x", "y", "z"]);
    if args.fit.contains(&FitArg::Strength) {
        rows::cell(text, "  strength over that of the layout", &number(scan.strength));
    }
    for (fit, name, value) in [
        (FitArg::Offset, "  offset and stray field, uT", scan.offset_t * 1e6),
        (FitArg::Rotation, "  rotation of the sensor, deg", scan.rotation_rad.map(f64::to_degrees)),
        (FitArg::Start, "  start of the scan, mm", scan.start),
    ] {
        if args.fit.contains(&fit) {
            rows::cells(text, name, value.to_array().map(number));
        }
    }
}

/// What the scan cannot tell.
fn unresolved(text: &mut String, film: &DiagnosedFilm) {
    let assumed = if film.has_ordinary { "ordinary errors" } else { "errors of films made by hand" };
    let mut by_error: BTreeMap<TileError, Vec<&str>> = BTreeMap::new();
    let mut about_j: Vec<&str> = Vec::new();
    for unresolved in film.unresolved() {
        if film.is_about_j(unresolved.tile, unresolved.error) {
            about_j.push(film.name(unresolved.tile));
            continue;
        }
        by_error.entry(unresolved.error).or_default().push(film.name(unresolved.tile));
    }
    let similar = film.similar();
    let _ = writeln!(text, "\nwhat the scan cannot tell, if all tiles have {assumed}:");
    if by_error.is_empty() && about_j.is_empty() && similar.is_empty() {
        text.push_str("  nothing: it narrows every error to less than half\n");
    }
    for (error, tiles) in &by_error {
        let _ = writeln!(text, "  {} of {}", error.name(), counted(tiles.len(), "tile", "tiles"));
        rows::prose(text, &listed(tiles));
    }
    if !about_j.is_empty() {
        let tiles = counted(about_j.len(), "tile", "tiles");
        let _ = writeln!(text, "  rotation about its J of {tiles}, which hardly changes the field");
    }
    if !similar.is_empty() {
        let _ = writeln!(text, "  {} that look alike", counted(similar.len(), "pair of errors", "pairs of errors"));
        for pair in similar.iter().take(LISTED) {
            let [first, second] =
                [pair.first, pair.second].map(|(tile, error)| format!("{} of {}", error.name(), film.name(tile)));
            rows::prose(text, &format!("{first} and {second}: correlation {:.4}", pair.correlation));
        }
    }
}

fn listed(names: &[&str]) -> String {
    let more = if names.len() > LISTED { ", ..." } else { "" };
    names.iter().take(LISTED).copied().collect::<Vec<_>>().join(", ") + more
}
