//! `resolution`: standard deviations of displacements as a table.

use std::fmt::Write;

use magsplice::prelude::DVec3;

use super::number::number;
use super::rows;
use super::units::in_ut;
use crate::sensor::film_resolution::FilmResolution;

/// The deviations at all points: root mean squares, least and largest.
pub(crate) fn resolution(resolution: &FilmResolution) -> String {
    let DVec3 { x, y, z } = in_ut(resolution.noise.deviation_t);
    let axes = if x == y && y == z { micro(x) } else { format!("{}, {}, {}", micro(x), micro(y), micro(z)) };
    let mut text = format!("noise of a reading: {axes} uT (standard deviation)\n");
    if let Some(rate_hz) = resolution.rate_hz {
        let _ = writeln!(text, "readings a second: {rate_hz}; the mean of n has 1/sqrt(n) of the deviations below");
    }
    let saturated = resolution.saturated.iter().filter(|is_saturated| **is_saturated).count();
    if saturated > 0 {
        let all = resolution.points_mm.len();
        let _ = writeln!(
            text,
            "out of range: the flux density exceeds the range of the sensor at {saturated} of {all} points, which are \
             left out below"
        );
    }
    text += "\n";
    rows::heading(&mut text, "standard deviation, mm", ["x", "y", "z"]);
    summary(&mut text, "by the field of the layout", resolution, &resolution.by_field_mm);
    if let Some(closed) = &resolution.by_closed_form_mm {
        summary(&mut text, "by the closed form (Eq. 14)", resolution, closed);
    }
    text
}

/// A flux density in microtesla without the rounding of its unit, or with three decimals if it has
/// many.
fn micro(value: f64) -> String {
    let typed = magsplice::results::twelve_digits(value).to_string();
    if typed.len() <= 6 { typed } else { format!("{value:.3}") }
}

fn summary(text: &mut String, title: &str, resolution: &FilmResolution, deviations: &[DVec3]) {
    let _ = writeln!(text, "{title}");
    let within: Vec<(DVec3, DVec3)> = (0..deviations.len())
        .filter(|index| !resolution.saturated[*index])
        .map(|index| (resolution.points_mm[index], deviations[index]))
        .collect();
    if within.is_empty() {
        let _ = writeln!(text, "  nothing is seen");
        return;
    }
    let squares: DVec3 = within.iter().map(|(_, deviation)| deviation * deviation).sum();
    let least = within.iter().fold(DVec3::INFINITY, |least, (_, deviation)| least.min(*deviation));
    let largest = within.iter().fold(DVec3::ZERO, |largest, (_, deviation)| largest.max(*deviation));
    let root_mean = (squares / within.len() as f64).map(f64::sqrt);
    for (name, value) in [("RMS over the volume", root_mean), ("least", least), ("largest", largest)] {
        rows::cells(text, &format!("  {name}"), value.to_array().map(number));
    }
    let worst = within.iter().max_by(|(_, a), (_, b)| a.length().total_cmp(&b.length()));
    if let Some((DVec3 { x, y, z }, _)) = worst {
        let _ = writeln!(text, "  largest in all axes together at ({x}, {y}, {z}) mm");
    }
}
