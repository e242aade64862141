//! JSON forms of results. Keys carry the units of their values.

/// `assign`: the errors of the film, and the plan.
pub(crate) mod assign;
/// `bench`: pairs per second for each accuracy.
pub(crate) mod bench;
/// `budget`: where the displacement error comes from.
pub(crate) mod budget;
/// `calibrate`.
pub(crate) mod calibrate;
/// `check`: layouts with their expectations.
pub(crate) mod check;
/// `compare`: the comparison with the ideal film.
pub(crate) mod compare;
/// `decouple`: the comparison, the decoupling errors and every point.
pub(crate) mod decouple;
/// `decouple --points`: the comparison, the errors and every point.
pub(crate) mod decouple_points;
/// `design --front`: the films of a front.
pub(crate) mod design;
/// `diagnose`: the tiles that are wrong, and what the scan cannot tell.
pub(crate) mod diagnose;
/// `field`: every point.
pub(crate) mod field;
/// `forces`: loads on tiles, and an order of laying.
pub(crate) mod forces;
/// Lengths along x, y, z as an object.
pub(crate) mod lengths;
/// `plan`: the methods, their truncation errors and costs.
pub(crate) mod plan;
/// `read`.
pub(crate) mod read;
/// What recoil changes in a film.
pub(crate) mod recoil;
/// Values of the library with other names of some keys.
pub(crate) mod renamed;
/// `scan`.
pub(crate) mod scan;
/// Layout, program and accuracy of a result.
pub(crate) mod source;
/// `tiles`: a layout with one entry per tile, and its parts.
pub(crate) mod tiles;
/// `tolerance`: statistics of samples.
pub(crate) mod tolerance;

use serde::Serialize;

/// A value as JSON with one line per entry.
pub(crate) fn pretty(value: &impl Serialize) -> String {
    let mut text = serde_json::to_string_pretty(value).expect("results hold numbers and strings only");
    text.push('\n');
    text
}
