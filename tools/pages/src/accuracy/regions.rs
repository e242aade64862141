//! Worst and median errors by region, on the reference tables.

use std::collections::BTreeMap;
use std::path::Path;

use glam::DVec3;
use magsplice_tests::reference_tables::{self, ReferenceRow};

use super::peers::{PeerFields, relative_error};

/// Errors of one program over the points of a region.
#[derive(Clone, Copy)]
pub(crate) struct ErrorSummary {
    /// The largest finite error.
    pub(crate) worst: f64,
    pub(crate) median: f64,
    /// Number of points without a finite result.
    pub(crate) without_number: usize,
}

/// Errors of the programs in one region, a line of the page.
pub(crate) struct RegionErrors {
    pub(crate) name: String,
    pub(crate) points: usize,
    /// Errors of magsplice, magba and, if it was run, magpylib.
    pub(crate) summaries: Vec<ErrorSummary>,
}

/// Order and name of the region of a row; `None` without a region.
fn region(table: &str, row: &ReferenceRow) -> Option<(u32, String)> {
    let exponent = |tag: &str| tag.trim_start_matches("1e").parse::<i32>().unwrap_or(0);
    let offset = || -exponent(&row.tag);
    let decades = |order: u32, what: &str| {
        let (band, text) = match offset() {
            _ if row.tag == "0" => (3, "exactly on it"),
            1..=5 => (0, "1e-1 .. 1e-5 of a size"),
            6..=10 => (1, "1e-6 .. 1e-10 of a size"),
            _ => (2, "1e-11 .. 1e-16 of a size"),
        };
        (order + band, format!("{what}, {text}"))
    };
    Some(match (table, row.set.as_str()) {
        ("generic", "a_generic_in") => (0, "inside".to_owned()),
        ("generic", "a_generic_out") => (1, "outside, within three sizes".to_owned()),
        ("generic", _) => (2, "symmetry planes".to_owned()),
        ("far", _) => (10 + exponent(&row.tag) as u32, format!("{} sizes away", row.tag)),
        ("approach", set) if set.starts_with("c_edge_ext") => decades(30, "extension of an edge"),
        ("approach", set) if set.starts_with("c_face_ext") => decades(34, "extension of a face"),
        ("approach", set) if set.starts_with("c_edge") => decades(38, "beside an edge"),
        ("approach", set) if set.starts_with("c_corner") => decades(42, "beside a corner"),
        ("approach", _) => decades(46, "beside a face"),
        ("thin", set) => {
            let (order, what) = if set.contains("plate") { (50, "plate") } else { (60, "needle") };
            let (side, place) = if set.ends_with("in") { (1, "inside") } else { (0, "outside") };
            let thickness: f64 = row.tag.parse().ok()?;
            let place_in_order = order + 2 * (-thickness.log10().round() as u32) / 3 + side;
            (place_in_order, format!("{what} 1 : {thickness:e}, {place}"))
        }
        ("offset", _) => {
            (70 + row.tag.len() as u32 % 8, format!("tile and point both {} sizes from the origin", row.tag))
        }
        ("scale", _) => {
            let scale: f64 = row.tag.parse().ok()?;
            if scale.log10().abs() > 20.0 {
                (81, "all lengths times 2^-300 or 2^300".to_owned())
            } else {
                (80, "all lengths times 1e-9 .. 1e9".to_owned())
            }
        }
        ("face_points", _) => (90, "exactly on a face (limit from the owner's side)".to_owned()),
        _ => return None,
    })
}

/// B of a row; on a face its limit from the side of the tile or volume that owns the face.
///
/// A tile owns its lower faces: the point p is in it where lower <= p < upper along each axis.
fn owners_limit(row: &ReferenceRow) -> DVec3 {
    let from_centre = row.point - row.tile.position();
    let half = 0.5 * row.tile.size();
    let inside = from_centre.cmpge(-half).all() && from_centre.cmplt(half).all();
    row.flux_density_t(usize::from(row.region == "face" && !inside))
}

/// Errors in every region, in the order of the page.
pub(crate) fn measure(python: Option<&Path>) -> Result<Vec<RegionErrors>, String> {
    let mut regions: BTreeMap<(u32, String), Vec<ReferenceRow>> = BTreeMap::new();
    for (table, rows) in [
        ("generic", 1379),
        ("far", 856),
        ("approach", 3016),
        ("thin", 900),
        ("offset", 400),
        ("scale", 1800),
        ("face_points", 36),
    ] {
        for row in reference_tables::read(table, rows) {
            if let Some(key) = region(table, &row) {
                regions.entry(key).or_default().push(row);
            }
        }
    }
    let mut measured = Vec::new();
    for ((_, name), rows) in regions {
        let cases: Vec<_> = rows.iter().map(|row| (vec![row.tile], row.point)).collect();
        let fields = PeerFields::compute(python, &cases)?;
        let exact: Vec<DVec3> = rows.iter().map(owners_limit).collect();
        let summary = |found: &[Option<DVec3>]| {
            summarize(found.iter().zip(&exact).map(|(f, e)| relative_error(*f, *e)).collect())
        };
        let summaries = fields.by_program().map(|found| summary(found)).collect();
        measured.push(RegionErrors { name, points: rows.len(), summaries });
    }
    Ok(measured)
}

fn summarize(mut errors: Vec<f64>) -> ErrorSummary {
    errors.sort_by(f64::total_cmp);
    let without_number = errors.iter().filter(|e| e.is_infinite()).count();
    let finite = &errors[..errors.len() - without_number];
    ErrorSummary { worst: finite.last().copied().unwrap_or(f64::NAN), median: errors[errors.len() / 2], without_number }
}
