//! Marks that several figures share: arrows, corner brackets, and the dot and the cross for vectors
//! out of the plane.

use plotters::prelude::RGBColor;

use crate::sheet::{DrawResult, INK, Sheet};

/// Components of J below this fraction of the largest |J| are not drawn.
pub(crate) const VANISHING: f64 = 1e-6;

/// Maximum length of the head, as a fraction of the length of the arrow.
const HEAD_LENGTH: f64 = 0.42;

/// Draws an arrow from `tail` to `tip` whose shaft is `width` wide, all in pixels.
pub(crate) fn arrow(sheet: &Sheet, tail: [f64; 2], tip: [f64; 2], width: f64, colour: RGBColor) -> DrawResult {
    let along = [tip[0] - tail[0], tip[1] - tail[1]];
    let length = along[0].hypot(along[1]);
    if length < 0.1 {
        return Ok(());
    }
    let along = along.map(|c| c / length);
    let head = (4.2 * width).min(HEAD_LENGTH * length);
    // A short arrow gets a narrower shaft, so that its head remains visible.
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

/// Draws brackets at the corners of a rectangle. They hide less of the figure than its sides would.
/// `most_px` is the maximum length of a bracket's arm.
pub(crate) fn corner_brackets(
    sheet: &Sheet,
    [left, top]: [f64; 2],
    [right, bottom]: [f64; 2],
    most_px: f64,
) -> DrawResult {
    let length = most_px.min(0.4 * (right - left)).min(0.4 * (bottom - top));
    for (x, inwards) in [(left, length), (right, -length)] {
        for (y, down) in [(top, length), (bottom, -length)] {
            let mark = [[x + inwards, y], [x, y], [x, y + down]];
            sheet.line(&mark, RGBColor(255, 255, 255), 3.6)?;
            sheet.line(&mark, INK, 2.2)?;
        }
    }
    Ok(())
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
