//! Colours and shapes of contenders.

use plotters::element::{DynElement, IntoDynElement};
use plotters::prelude::*;

use super::measure::Contender;

/// Half the width of a mark in pixels.
pub(crate) const RADIUS: i32 = 13;

/// The colour of a contender, by Okabe and Ito, which colour-blind readers can distinguish.
pub(crate) fn colour(contender: Contender) -> RGBColor {
    match contender {
        Contender::Exact => BLACK,
        Contender::Grid => RGBColor(0, 114, 178),
        Contender::List => RGBColor(0, 158, 115),
        Contender::LookUps => RGBColor(204, 121, 167),
        Contender::Magba => RGBColor(213, 94, 0),
        Contender::Magpylib => RGBColor(230, 159, 0),
    }
}

/// A mark with the outline of a contender, filled with its colour or white.
pub(crate) fn mark<'a>(
    contender: Contender,
    at: (i32, i32),
    filled: bool,
) -> DynElement<'a, SVGBackend<'a>, (i32, i32)> {
    let (r, colour) = (RADIUS, colour(contender));
    let outline = match contender {
        Contender::Exact => vec![(0, -r - 5), (r + 5, 0), (0, r + 5), (-r - 5, 0)],
        Contender::Grid => {
            let corner = |n: i32| {
                let angle = f64::from(n) * std::f64::consts::TAU / 48.0;
                ((f64::from(r) * angle.cos()).round() as i32, (f64::from(r) * angle.sin()).round() as i32)
            };
            (0..48).map(corner).collect()
        }
        Contender::List => vec![(-r + 2, -r + 2), (r - 2, -r + 2), (r - 2, r - 2), (-r + 2, r - 2)],
        Contender::LookUps => vec![(0, -r - 3), (r + 2, r - 2), (-r - 2, r - 2)],
        Contender::Magba => vec![(0, r + 3), (r + 2, -r + 2), (-r - 2, -r + 2)],
        // A plus with thick arms.
        Contender::Magpylib => {
            let (far, near) = (r + 2, 5);
            let quarter = [(near, -near), (far, -near), (far, near)];
            let turned = |turn: usize| quarter.map(|(x, y)| (0..turn).fold((x, y), |(x, y), _| (-y, x)));
            (0..4).flat_map(turned).collect()
        }
    };
    let closed: Vec<(i32, i32)> = outline.iter().copied().chain([outline[0]]).collect();
    let inside = if filled { colour.filled() } else { WHITE.filled() };
    let mark = EmptyElement::at(at) + Polygon::new(outline, inside) + PathElement::new(closed, colour.stroke_width(4));
    mark.into_dyn()
}
