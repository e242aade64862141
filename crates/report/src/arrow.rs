//! Arrows.

use crate::sheet::{Drawn, Sheet};
use plotters::prelude::RGBColor;

/// The largest head, as a fraction of the arrow's length.
const HEAD_LENGTH: f64 = 0.42;

/// An arrow from `tail` to `tip` on the sheet; `width` of its shaft, all in pixels.
pub(crate) fn arrow(sheet: &Sheet, tail: [f64; 2], tip: [f64; 2], width: f64, colour: RGBColor) -> Drawn {
    let along = [tip[0] - tail[0], tip[1] - tail[1]];
    let length = along[0].hypot(along[1]);
    if length < 0.1 {
        return Ok(());
    }
    let along = along.map(|c| c / length);
    let head = (4.2 * width).min(HEAD_LENGTH * length);
    // Short arrows stay in shape.
    let half_shaft = 0.5 * width.min(0.3 * head);
    let half_head = 0.42 * head;
    let at = |forward: f64, aside: f64| {
        [tail[0] + forward * along[0] - aside * along[1], tail[1] + forward * along[1] + aside * along[0]]
    };
    let neck = length - head;
    let corners = [
        at(0.0, half_shaft),
        at(neck, half_shaft),
        at(neck, half_head),
        at(length, 0.0),
        at(neck, -half_head),
        at(neck, -half_shaft),
        at(0.0, -half_shaft),
    ];
    sheet.fill(&corners, colour)
}
