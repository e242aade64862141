//! Errors of films against what they cost, on a logarithmic scale.

use plotters::coord::ranged1d::Ranged;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::RGBColor;

use crate::colours::{BLUE, INK_LINE, VERMILION};
use crate::front::{Axis, Front, FrontFilm};
use crate::panel::{BELOW_PX, Panel};
use crate::sheet::{Drawn, INK, LETTERS, Lettering, Sheet, sheet};
use crate::typeset;

const WIDTH_PX: f64 = 430.0;
const HEIGHT_PX: f64 = 300.0;
const LEFT_PX: f64 = 78.0;
const TOP_PX: f64 = 66.0;
const RIGHT_PX: f64 = 24.0;
const TICK_PX: f64 = 4.0;
const NUMBERS: f64 = 12.0;
const RADIUS_PX: f64 = 3.6;
/// Numbers on the axis below, at most.
const MOST_NUMBERS: usize = 9;

/// One of the four errors of a film.
struct Series {
    name: &'static str,
    colour: RGBColor,
    filled: bool,
    of: fn(&FrontFilm) -> f64,
}

const SERIES: [Series; 4] = [
    Series { name: "displacement, shear", colour: BLUE, filled: true, of: |film| shear(film.displacement_rmse_mm) },
    Series { name: "displacement, normal", colour: VERMILION, filled: true, of: |film| film.displacement_rmse_mm[2] },
    Series { name: "uniformity, shear", colour: BLUE, filled: false, of: |film| shear(film.uniformity_rmse_mm) },
    Series { name: "uniformity, normal", colour: VERMILION, filled: false, of: |film| film.uniformity_rmse_mm[2] },
];

fn shear([x, y, _]: [f64; 3]) -> f64 {
    x.max(y)
}

pub(crate) fn draw(front: &Front) -> Result<String, String> {
    let errors = || {
        let films = front.films.iter().chain(&front.before);
        films.flat_map(|film| SERIES.iter().map(move |series| (series.of)(film))).filter(|error| *error > 0.0)
    };
    let (low, high) = errors().fold((f64::INFINITY, 0.0_f64), |(l, h), e| (l.min(e), h.max(e)));
    if low > high {
        return Err("no film has an error above 0".to_owned());
    }
    let at = || front.films.iter().chain(&front.before).map(|film| film.at);
    let (first, last) = at().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
    let margin = if front.axis == Axis::Parts { 0.6 } else { 0.05 * (last - first).max(0.1) };
    let panel = Panel {
        left: LEFT_PX,
        top: TOP_PX,
        width: WIDTH_PX,
        height: HEIGHT_PX,
        x: [first - margin, last + margin],
        // Room for a word above the film before.
        y: [low.log10() - 0.15, high.log10() + if front.before.is_some() { 0.4 } else { 0.15 }],
    };
    sheet([LEFT_PX + WIDTH_PX + RIGHT_PX, TOP_PX + HEIGHT_PX + BELOW_PX + 8.0], |sheet| {
        decades(sheet, &panel)?;
        for series in &SERIES {
            let points: Vec<[f64; 2]> =
                front.films.iter().map(|film| panel.at(film.at, (series.of)(film).max(low).log10())).collect();
            sheet.line(&points, series.colour, if series.filled { 1.4 } else { 0.8 })?;
            for point in points {
                mark(sheet, series, point)?;
            }
        }
        if let Some(film) = &front.before {
            let errors = SERIES.each_ref().map(|series| (series.of)(film).max(low).log10());
            for (series, error) in SERIES.iter().zip(errors) {
                mark(sheet, series, panel.at(film.at, error))?;
            }
            let top = errors.into_iter().fold(f64::NEG_INFINITY, f64::max);
            let [x, y] = panel.at(film.at, top);
            sheet.text([x, y - 14.0], "before", LETTERS.centred())?;
        }
        frame(sheet, &panel, front.axis)?;
        for (index, series) in SERIES.iter().enumerate() {
            let (column, row) = (index / 2, index % 2);
            let key = [LEFT_PX + 6.0 + 210.0 * column as f64, 16.0 + 20.0 * row as f64];
            sheet.line(
                &[[key[0], key[1]], [key[0] + 24.0, key[1]]],
                series.colour,
                if series.filled { 1.4 } else { 0.8 },
            )?;
            mark(sheet, series, [key[0] + 12.0, key[1]])?;
            sheet.text([key[0] + 32.0, key[1]], series.name, LETTERS)?;
        }
        Ok(())
    })
}

fn mark(sheet: &Sheet, series: &Series, at: [f64; 2]) -> Drawn {
    if series.filled {
        return sheet.disc(at, RADIUS_PX, series.colour);
    }
    sheet.disc(at, RADIUS_PX, RGBColor(255, 255, 255))?;
    sheet.ring(at, RADIUS_PX, series.colour, 1.2)
}

/// Faint lines at the powers of ten, with numbers beside them.
fn decades(sheet: &Sheet, panel: &Panel) -> Drawn {
    const FAINT: RGBColor = RGBColor(222, 222, 222);
    for decade in panel.y[0].ceil() as i32..=panel.y[1].floor() as i32 {
        let [left, y] = panel.at(panel.x[0], f64::from(decade));
        sheet.line(&[[left, y], [panel.right(), y]], FAINT, 0.8)?;
        let letters = Lettering { across: plotters::style::text_anchor::HPos::Right, ..LETTERS.sized(NUMBERS) };
        sheet.text([left - 2.0 * TICK_PX, y], &typeset::number(10_f64.powi(decade)), letters)?;
        for digit in 1..10 {
            let value = (f64::from(digit) * 10_f64.powi(decade)).log10();
            if value <= panel.y[1] {
                let [left, y] = panel.at(panel.x[0], value);
                let length = if digit == 1 { TICK_PX } else { 0.5 * TICK_PX };
                sheet.line(&[[left - length, y], [left, y]], INK, INK_LINE)?;
            }
        }
    }
    Ok(())
}

fn frame(sheet: &Sheet, panel: &Panel, axis: Axis) -> Drawn {
    let values: Vec<f64> = match axis {
        Axis::Parts => (panel.x[0].ceil() as i64..=panel.x[1].floor() as i64).map(|n| n as f64).collect(),
        Axis::Amplitude => RangedCoordf64::from(panel.x[0]..panel.x[1]).key_points(MOST_NUMBERS),
    };
    for &value in &values {
        let [x, bottom] = panel.at(value, panel.y[0]);
        sheet.line(&[[x, bottom], [x, bottom + TICK_PX]], INK, INK_LINE)?;
        sheet.text([x, bottom + 14.0], &typeset::on_axis(value, panel.x), LETTERS.sized(NUMBERS).centred())?;
    }
    let name = match axis {
        Axis::Parts => "distinct parts",
        Axis::Amplitude => "amplitude, of the ideal film",
    };
    sheet.text([panel.left + 0.5 * panel.width, panel.bottom() + 32.0], name, LETTERS.centred())?;
    let upright = Lettering { upright: true, ..LETTERS.centred() };
    sheet.text([16.0, panel.top + 0.5 * panel.height], "RMSE (mm)", upright)?;
    let (right, bottom) = (panel.right(), panel.bottom());
    sheet.outline(&[[panel.left, panel.top], [right, panel.top], [right, bottom], [panel.left, bottom]], INK, INK_LINE)
}
