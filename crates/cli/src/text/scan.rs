//! `scan`: what was fitted, and the uniformity of the readings.

use std::fmt::Write;

use magsplice::Film;
use magsplice::prelude::DVec3;

use super::number::{counted, number};
use super::{header, rows};
use crate::args::sensor::{FitArg, ScanArgs};
use crate::sensor::scanned_film::ScannedFilm;

/// Positions that are named.
const NAMED: usize = 3;

/// The report of `scan`.
pub(crate) fn scan(film: &Film, args: &ScanArgs, scanned: &ScannedFilm) -> String {
    let mut text = header::with_recoil(film.layout(), film.recoil());
    let readings = counted(scanned.places_mm.len(), "reading", "readings");
    let _ = writeln!(text, "scan {}: {readings}{}", args.scan.display(), positions(scanned));
    text.push('\n');

    let (found, deviations) = (&scanned.fit.parameters, &scanned.fit.deviations);
    rows::heading(&mut text, "fitted, with standard deviations", ["x", "y", "z"]);
    if args.fit.contains(&FitArg::Strength) {
        rows::cell(&mut text, "  strength over that of the layout", &number(found.strength));
        rows::cell(&mut text, "    +-", &number(deviations.strength));
    }
    for (fit, name, value, deviation) in [
        (FitArg::Offset, "  offset and stray field, uT", found.offset_t * 1e6, deviations.offset_t * 1e6),
        (
            FitArg::Rotation,
            "  rotation of the sensor, deg",
            found.rotation_rad.map(f64::to_degrees),
            deviations.rotation_rad.map(f64::to_degrees),
        ),
        (FitArg::Start, "  start of the scan, mm", found.start, deviations.start),
    ] {
        if args.fit.contains(&fit) {
            cells(&mut text, name, value);
            cells(&mut text, "    +-", deviation);
        }
    }
    rows::cell(&mut text, "residual of a component, uT", &number(scanned.fit.noise_t * 1e6));
    rows::cell(&mut text, "readings left out", &scanned.fit.outliers.len().to_string());

    if let Some(uniformity) = &scanned.uniformity {
        text.push('\n');
        rows::heading(&mut text, "uniformity RMSE (Eq. 15)", ["R_x", "R_y", "S_z"]);
        for (name, values) in [
            ("  readings", uniformity.readings),
            ("  without offset and rotation", uniformity.corrected),
            ("  layout at the same places", uniformity.simulated),
        ] {
            rows::cells(&mut text, name, values.map(|value| value.map_or("none".to_owned(), number)));
        }
        if uniformity.singular > 0 {
            let _ = writeln!(text, "  without parameters, as B_z = 0: {}", uniformity.singular);
        }
    }
    text
}

fn cells(text: &mut String, name: &str, value: DVec3) {
    rows::cells(text, name, value.to_array().map(number));
}

/// What is remarkable about the positions.
fn positions(scanned: &ScannedFilm) -> String {
    let positions = &scanned.positions;
    let mut text = match positions.grid {
        Some([x, y, z]) => format!(" on a grid of {x} x {y} x {z}"),
        None => " at positions that are no grid".to_owned(),
    };
    if !positions.missing.is_empty() {
        let named: Vec<String> =
            positions.missing.iter().take(NAMED).map(|DVec3 { x, y, z }| format!("({x}, {y}, {z})")).collect();
        let _ = write!(text, "; {} missing: {}", positions.missing.len(), named.join(", "));
        text += if positions.missing.len() > NAMED { ", ... mm" } else { " mm" };
    }
    if !positions.repeated.is_empty() {
        let named: Vec<String> =
            positions.repeated.iter().take(NAMED).map(|index| scanned.lines[*index].to_string()).collect();
        let more = if positions.repeated.len() > NAMED { ", ..." } else { "" };
        let _ = write!(text, "; {} repeated: line {}{more}", positions.repeated.len(), named.join(", "));
    }
    text
}
