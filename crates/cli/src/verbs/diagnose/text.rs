//! The faulty tiles, and what the scan does not resolve.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use magsplice::Film;
use magsplice::magnet::TileError;
use magsplice::results::{FilmDiagnosis, Suspect};
use magsplice::scan::FreeParameters;

use crate::text::number::{counted, number};
use crate::text::units::{in_per_cent, in_ut};
use crate::text::{header, rows};
use crate::verbs::scan::text::{excluded, fitted};

/// Tiles, errors and pairs that are listed.
const LISTED: usize = 6;

/// The report of `diagnose` about the file `scan`, of which `fit` was fitted.
pub(super) fn diagnosis(film: &Film, scan: &Path, fit: FreeParameters, found: &FilmDiagnosis) -> String {
    let mut text = header::with_recoil(film);
    let [x, y, z] = in_ut(found.noise_t).to_array().map(number);
    let readings = counted(found.readings, "reading", "readings");
    let _ = writeln!(text, "scan {}: {readings}, noise {x}, {y}, {z} uT", scan.display());
    let _ = writeln!(
        text,
        "{}, false alarms in {} % of fault-free films",
        if found.has_expected_errors {
            "errors beyond the expected errors are reported"
        } else {
            "other tiles count as ordered"
        },
        in_per_cent(found.false_alarm)
    );
    text.push('\n');
    faulty_tiles(&mut text, found);
    if !found.is_complete && !found.is_rejected {
        rows::prose(
            &mut text,
            "and more: use the layout of this film, or give the expected errors of its tiles, as by --preset",
        );
    }
    // What a rejected model has fitted is not what the scan had.
    if fit != FreeParameters::NONE && !found.is_rejected {
        text.push('\n');
        rows::heading(&mut text, "fitted, with standard deviations", ["x", "y", "z"]);
        fitted(&mut text, fit, &found.scan, Some(&found.scan_deviation));
    }
    text.push('\n');
    if found.is_rejected {
        text.push_str("of the rejected errors\n");
    }
    rows::cell(&mut text, "residual of a component, uT", &number(in_ut(found.residual_t)));
    excluded(&mut text, &found.excluded);
    rows::cell(&mut text, "chi squared over its expectation", &number(found.reduced_chi_squared()));
    unresolved(&mut text, found);
    text
}

/// The faulty tiles with their errors.
fn faulty_tiles(text: &mut String, found: &FilmDiagnosis) {
    if found.is_rejected {
        text.push_str(match (found.made_as, &found.explained_by) {
            (Some(_), _) => {
                "errors of every tile explain the scan as well as errors of single tiles: no tile is reported\n"
            }
            (None, Some(_)) => "the scan was rather taken otherwise than stated, so no tile is reported\n",
            (None, None) => "errors of tiles do not explain the scan, so no tile is reported\n",
        });
        if let Some(preset) = found.made_as {
            let _ = writeln!(text, "    they are expected with --preset {}", preset.name());
        }
        return;
    }
    let (used, all) = (found.readings - found.excluded.count(), found.readings);
    let by = if used == all { String::new() } else { format!(", by {used} of {all} readings") };
    if found.faulty.is_empty() {
        let _ = writeln!(text, "no faulty tile{by}");
        return;
    }
    let _ = writeln!(text, "{}{by}:", counted(found.faulty.len(), "error", "errors"));
    for faulty in &found.faulty {
        let _ = writeln!(text, "  {}: {}", faulty.tile, faulty.words);
        for (error, [value, deviation]) in &faulty.components {
            let label = format!("    {}, {}", error.name(), error.unit());
            let _ = writeln!(text, "{label:<42}{value:>11.4} +- {deviation:.4}");
        }
        if !faulty.alternatives.is_empty() {
            let other = |Suspect { tile, kind }: &Suspect| format!("{} of {tile}", kind.name());
            let others: Vec<String> = faulty.alternatives.iter().take(LISTED).map(other).collect();
            rows::prose(text, &format!("or, nearly as well: {}", others.join(", ")));
        }
    }
}

/// What the scan does not resolve.
fn unresolved(text: &mut String, found: &FilmDiagnosis) {
    let assumed = if found.has_expected_errors { "expected errors" } else { "errors of films made by hand" };
    let mut by_error: BTreeMap<TileError, Vec<&str>> = BTreeMap::new();
    for of in found.unresolved.iter().filter(|of| !of.is_about_j) {
        by_error.entry(of.error).or_default().push(&of.tile);
    }
    let about_j = found.unresolved.iter().filter(|of| of.is_about_j).count();
    let _ = writeln!(text, "\nunresolved by the scan, if all tiles have {assumed}:");
    if by_error.is_empty() && about_j == 0 && found.similar.is_empty() {
        text.push_str("  nothing: the scan reduces every error to less than half\n");
    }
    for (error, tiles) in &by_error {
        let _ = writeln!(text, "  {} of {}", error.name(), counted(tiles.len(), "tile", "tiles"));
        rows::prose(text, &listed(tiles));
    }
    if about_j > 0 {
        let tiles = counted(about_j, "tile", "tiles");
        let _ = writeln!(text, "  rotation about its J of {tiles}, which hardly changes the field");
    }
    if !found.similar.is_empty() {
        let pairs = counted(found.similar.len(), "pair of errors", "pairs of errors");
        let _ = writeln!(text, "  {pairs} that look alike");
        for pair in found.similar.iter().take(LISTED) {
            let [first, second] = [0, 1].map(|n| format!("{} of {}", pair.errors[n].name(), pair.tiles[n]));
            rows::prose(text, &format!("{first} and {second}: correlation {:.4}", pair.correlation));
        }
    }
}

fn listed(names: &[&str]) -> String {
    let more = if names.len() > LISTED { ", ..." } else { "" };
    names.iter().take(LISTED).copied().collect::<Vec<_>>().join(", ") + more
}
