//! Marks that several figures share: arrows, corner brackets, and the dot and the cross for vectors
//! out of the plane.

use plotters::prelude::RGBColor;

use crate::sheet::{DrawResult, INK, Sheet, rectangle};

/// Components of J below this fraction of the largest |J| are not drawn.
pub(crate) const VANISHING: f64 = 1e-6;

/// Maximum length of the head, as a fraction of the length of the arrow.
const HEAD_LENGTH: f64 = 0.42;

/// Width of the arms of corner brackets with their white margin, in pixels.
pub(crate) const BRACKET_WIDTH_PX: f64 = 3.6;

/// Width of the shaft of a hollow arrow over that of a filled one.
const HOLLOW_WIDTH: f64 = 1.4;

/// Length of the head of an arrow, in pixels.
fn head_length(length: f64, width: f64) -> f64 {
    (4.2 * width).min(HEAD_LENGTH * length)
}

/// Width of the head of an arrow whose shaft is `width` wide, in pixels.
pub(crate) fn head_width(length: f64, width: f64) -> f64 {
    0.84 * head_length(length, width)
}

/// Draws an arrow from `tail` to `tip` whose shaft is `width` wide, all in pixels.
pub(crate) fn arrow(sheet: &Sheet, tail: [f64; 2], tip: [f64; 2], width: f64, colour: RGBColor) -> DrawResult {
    arrow_corners(tail, tip, width).map_or(Ok(()), |corners| sheet.fill(&corners, colour))
}

/// Draws the outline of an arrow that is filled with white.
pub(crate) fn hollow_arrow(sheet: &Sheet, tail: [f64; 2], tip: [f64; 2], width: f64, colour: RGBColor) -> DrawResult {
    let Some(corners) = arrow_corners(tail, tip, HOLLOW_WIDTH * width) else { return Ok(()) };
    sheet.fill(&corners, RGBColor(255, 255, 255))?;
    sheet.outline(&corners, colour, (0.5 * width).max(0.4))
}

/// The corners of an arrow. `None` if it is too short to be seen.
fn arrow_corners(tail: [f64; 2], tip: [f64; 2], width: f64) -> Option<[[f64; 2]; 7]> {
    let along = [tip[0] - tail[0], tip[1] - tail[1]];
    let length = along[0].hypot(along[1]);
    if length < 0.1 {
        return None;
    }
    let along = along.map(|c| c / length);
    let head = head_length(length, width);
    // A short arrow gets a narrower shaft, so that its head remains visible.
    let half_shaft = 0.5 * width.min(0.3 * head);
    let half_head = 0.5 * head_width(length, width);
    let at = |forward: f64, aside: f64| {
        [tail[0] + forward * along[0] - aside * along[1], tail[1] + forward * along[1] + aside * along[0]]
    };
    let neck = length - head;
    Some([
        at(0.0, half_shaft),
        at(neck, half_shaft),
        at(neck, half_head),
        at(length, 0.0),
        at(neck, -half_head),
        at(neck, -half_shaft),
        at(0.0, -half_shaft),
    ])
}

/// Draws brackets at the corners of a rectangle. They hide less of the figure than its sides would.
/// `most_px` is the maximum length of a bracket's arm.
pub(crate) fn corner_brackets(sheet: &Sheet, upper_left: [f64; 2], lower_right: [f64; 2], most_px: f64) -> DrawResult {
    for bracket in bracket_arms(upper_left, lower_right, most_px).chunks(2) {
        let mark = [bracket[0][1], bracket[0][0], bracket[1][1]];
        sheet.line(&mark, RGBColor(255, 255, 255), BRACKET_WIDTH_PX)?;
        sheet.line(&mark, INK, 2.2)?;
    }
    Ok(())
}

/// The arms of the brackets at the corners of a rectangle, two per corner: from the corner to the
/// end of the arm.
pub(crate) fn bracket_arms([left, top]: [f64; 2], [right, bottom]: [f64; 2], most_px: f64) -> [[[f64; 2]; 2]; 8] {
    let length = most_px.min(0.4 * (right - left)).min(0.4 * (bottom - top));
    let corners = [
        (left, length, top, length),
        (left, length, bottom, -length),
        (right, -length, top, length),
        (right, -length, bottom, -length),
    ];
    let arms = corners.map(|(x, inwards, y, down)| [[[x, y], [x + inwards, y]], [[x, y], [x, y + down]]]);
    std::array::from_fn(|i| arms[i / 2][i % 2])
}

/// Half the side of the mark of a sensor, in pixels.
pub(crate) const SENSOR_PX: f64 = 5.0;

/// Draws the mark for a sensor: a chip with a dot where it reads.
pub(crate) fn sensor_mark(sheet: &Sheet, [x, y]: [f64; 2]) -> DrawResult {
    let corners = rectangle([x - SENSOR_PX, y - SENSOR_PX], [x + SENSOR_PX, y + SENSOR_PX]);
    sheet.shape(&corners, RGBColor(255, 255, 255), INK, 1.6)?;
    sheet.disc([x, y], 0.3 * SENSOR_PX, INK)
}

/// Draws the mark for a vector out of the plane: a dot in a circle if it points `up`, towards the
/// viewer, a cross in a circle if it points down.
pub(crate) fn out_of_plane_mark(sheet: &Sheet, at: [f64; 2], radius: f64, up: bool) -> DrawResult {
    sheet.disc(at, radius, RGBColor(255, 255, 255))?;
    sheet.ring(at, radius, INK, (0.16 * radius).max(0.4))?;
    if up {
        return sheet.disc(at, 0.36 * radius, INK);
    }
    let r = radius * std::f64::consts::FRAC_1_SQRT_2;
    for [dx, dy] in [[r, r], [r, -r]] {
        sheet.line(&[[at[0] - dx, at[1] - dy], [at[0] + dx, at[1] + dy]], INK, (0.16 * radius).max(0.4))?;
    }
    Ok(())
}
