//! What was fitted, and the uniformity of the readings.

use std::fmt::Write;
use std::path::Path;

use magsplice::Film;
use magsplice::results::{ExcludedReadings, FilmScan, FittedScan};
use magsplice::scan::FreeParameters;

use crate::text::number::{counted, number, point};
use crate::text::units::in_ut;
use crate::text::{header, rows};

/// Positions that are listed.
const LISTED: usize = 3;

/// The report of `scan` about the file `scan`.
pub(super) fn scan(film: &Film, scan: &Path, found: &FilmScan) -> String {
    let mut text = header::with_recoil(film);
    let readings = counted(found.readings, "reading", "readings");
    let _ = writeln!(text, "scan {}: {readings}{}", scan.display(), positions(found));
    text.push('\n');
    rows::heading(&mut text, "fitted, with standard deviations", ["x", "y", "z"]);
    fitted(&mut text, found.fit, &found.fitted, Some(&found.deviation));
    if found.height_of_strength_mm.is_some() {
        rows::cell(&mut text, "  strength / strength of layout, held", &number(found.fitted.strength));
    }
    rows::cell(&mut text, "residual of a component, uT", &number(in_ut(found.residual_t)));
    excluded(&mut text, &found.excluded);
    for exchanged in found.exchanged_axes() {
        let _ = writeln!(text, "{exchanged}");
    }
    if let Some(uniformity) = &found.uniformity_rmse {
        text.push('\n');
        rows::heading(&mut text, "uniformity RMSE (Eq. 15)", ["R_x", "R_y", "S_z"]);
        for (name, values) in [
            ("  readings", uniformity.readings),
            ("  without offset and rotation", uniformity.corrected),
            ("  layout at the same points", uniformity.simulated),
        ] {
            rows::cells(&mut text, name, values.to_array().map(|value| value.map_or("undefined".to_owned(), number)));
        }
        for reason in uniformity.omitted.to_array().iter().flatten() {
            let _ = writeln!(text, "  undefined: {reason}");
        }
        if uniformity.singular > 0 {
            let _ = writeln!(text, "  without parameters, as B_z = 0: {}", uniformity.singular);
        }
    }
    text
}

/// Appends the numbers of excluded readings. Outliers are always counted.
pub(crate) fn excluded(text: &mut String, excluded: &ExcludedReadings) {
    for (reason, numbers) in excluded.by_reason() {
        if !numbers.is_empty() || reason == "outliers" {
            rows::cell(text, &format!("{reason}, excluded"), &numbers.len().to_string());
        }
    }
}

/// Appends the parameters of a scan that were fitted, with their deviations if they are known.
pub(crate) fn fitted(text: &mut String, fit: FreeParameters, found: &FittedScan, deviation: Option<&FittedScan>) {
    if fit.strength {
        rows::cell(text, "  strength / strength of layout", &number(found.strength));
        if let Some(deviation) = deviation {
            rows::cell(text, "    +-", &number(deviation.strength));
        }
    }
    let vectors = |of: &FittedScan| [in_ut(of.offset_t), of.rotation_deg, of.start_mm];
    let names = [
        (fit.offset, "  offset and stray field, uT"),
        (fit.rotation, "  rotation of the sensor, deg"),
        (fit.start, "  start of the scan, mm"),
    ];
    for (index, (_, name)) in names.into_iter().enumerate().filter(|(_, (is_fitted, _))| *is_fitted) {
        rows::cells(text, name, vectors(found)[index].to_array().map(number));
        if let Some(deviation) = deviation {
            rows::cells(text, "    +-", vectors(deviation)[index].to_array().map(number));
        }
    }
}

/// What is remarkable about the positions.
fn positions(found: &FilmScan) -> String {
    let mut text = match found.grid {
        Some([x, y, z]) => format!(" on a grid of {x} x {y} x {z}"),
        None => " at positions that do not form a grid".to_owned(),
    };
    if !found.missing_mm.is_empty() {
        let listed: Vec<String> = found.missing_mm.iter().take(LISTED).map(|missing| point(*missing)).collect();
        let _ = write!(text, "; {} missing: {}", found.missing_mm.len(), listed.join(", "));
        text += if found.missing_mm.len() > LISTED { ", ... mm" } else { " mm" };
    }
    if !found.repeated.is_empty() {
        let listed: Vec<String> = found.repeated.iter().take(LISTED).map(u64::to_string).collect();
        let more = if found.repeated.len() > LISTED { ", ..." } else { "" };
        let _ = write!(text, "; {} repeated: line {}{more}", found.repeated.len(), listed.join(", "));
    }
    text
}
