//! `resolution`: standard deviations of displacements as a table.

use std::fmt::Write;

use magsplice::prelude::DVec3;
use magsplice::sensor::Noise;

use super::number::number;
use super::rows;

/// The deviations at all points: root mean squares, least and largest.
pub(crate) fn resolution(noise: &Noise, points: &[DVec3], exact: &[DVec3], closed: Option<&[DVec3]>) -> String {
    let DVec3 { x, y, z } = noise.deviation_t * 1e6;
    let axes = if x == y && y == z { micro(x) } else { format!("{}, {}, {}", micro(x), micro(y), micro(z)) };
    let mut text = format!("noise of a reading: {axes} uT (standard deviation)\n\n");
    rows::heading(&mut text, "standard deviation, mm", ["x", "y", "z"]);
    summary(&mut text, "by the field of the layout", points, exact);
    if let Some(closed) = closed {
        summary(&mut text, "by the closed form (Eq. 14)", points, closed);
    }
    text
}

/// A flux density in microtesla without the rounding of its unit.
fn micro(value: f64) -> String {
    magsplice_export::twelve_digits(value).to_string()
}

fn summary(text: &mut String, title: &str, points: &[DVec3], deviations: &[DVec3]) {
    let _ = writeln!(text, "{title}");
    let count = deviations.len() as f64;
    let squares: DVec3 = deviations.iter().map(|deviation| deviation * deviation).sum();
    let least = deviations.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let largest = deviations.iter().copied().fold(DVec3::ZERO, DVec3::max);
    for (name, value) in
        [("RMS over the volume", (squares / count).map(f64::sqrt)), ("least", least), ("largest", largest)]
    {
        rows::cells(text, &format!("  {name}"), value.to_array().map(number));
    }
    let worst = (0..points.len()).max_by(|a, b| deviations[*a].length().total_cmp(&deviations[*b].length()));
    if let Some(worst) = worst {
        let DVec3 { x, y, z } = points[worst];
        let _ = writeln!(text, "  largest in all axes together at ({x}, {y}, {z}) mm");
    }
}
