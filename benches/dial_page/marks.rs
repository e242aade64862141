//! How models are told apart: by colour and by shape.

use plotters::element::{DynElement, IntoDynElement};
use plotters::prelude::*;

use crate::measure::Model;

/// Half the width of a mark.
pub(crate) const RADIUS: i32 = 13;

/// Okabe and Ito's colours, distinct for the colour-blind.
pub(crate) fn colour(model: Model) -> RGBColor {
    match model {
        Model::Exact => BLACK,
        Model::Grid => RGBColor(0, 114, 178),
        Model::List => RGBColor(0, 158, 115),
        Model::LookUps => RGBColor(204, 121, 167),
        Model::Magba => RGBColor(213, 94, 0),
        Model::Magpylib => RGBColor(230, 159, 0),
    }
}

/// The outline of a mark, filled or white.
pub(crate) fn mark<'a>(model: Model, at: (i32, i32), filled: bool) -> DynElement<'a, SVGBackend<'a>, (i32, i32)> {
    let (r, colour) = (RADIUS, colour(model));
    let outline = match model {
        Model::Exact => vec![(0, -r - 5), (r + 5, 0), (0, r + 5), (-r - 5, 0)],
        Model::Grid => {
            let corner = |n: i32| {
                let angle = f64::from(n) * std::f64::consts::TAU / 48.0;
                ((f64::from(r) * angle.cos()).round() as i32, (f64::from(r) * angle.sin()).round() as i32)
            };
            (0..48).map(corner).collect()
        }
        Model::List => vec![(-r + 2, -r + 2), (r - 2, -r + 2), (r - 2, r - 2), (-r + 2, r - 2)],
        Model::LookUps => vec![(0, -r - 3), (r + 2, r - 2), (-r - 2, r - 2)],
        Model::Magba => vec![(0, r + 3), (r + 2, -r + 2), (-r - 2, -r + 2)],
        // A plus, as wide as it is thick.
        Model::Magpylib => {
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
