//! Errors of the films of a Pareto front against what better films cost.

use magsplice::decouple::{Figures, PerAxis};
use magsplice::ideal::IdealFilm;
use plotters::coord::ranged1d::Ranged;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::RGBColor;

use crate::colours::{BLUE, VERMILION};
use crate::drawing::{Drawing, SvgText};
use crate::error::{DrawError, ReportError};
use crate::panel::{BELOW_PX, Panel};
use crate::sheet::{DrawResult, FRAME_PX, INK, LETTERS, Lettering, Sheet, sheet};
use crate::typeset::{self, AXIS_NAMES, AxisNumbers};

const WIDTH_PX: f64 = 430.0;
const HEIGHT_PX: f64 = 300.0;
const LEFT_PX: f64 = 78.0;
const TOP_PX: f64 = 66.0;
const RIGHT_PX: f64 = 24.0;
const TICK_PX: f64 = 4.0;
/// Font size of numbers on axes, in pixels.
const NUMBERS_PX: f64 = 12.0;
const RADIUS_PX: f64 = 3.6;
/// Maximum count of numbers on the horizontal axis.
const MAX_NUMBERS: usize = 9;

/// The figure of a Pareto front: four errors of each film against what better films cost.
///
/// The four errors are displacement and uniformity RMSE, each for shear (the larger one of x and y)
/// and for the normal direction z, in millimetres on a logarithmic scale. Where all films have
/// errors as made, these are drawn, and the displacement RMSE of the films as ordered.
#[derive(Clone, Debug)]
pub struct FrontFigure {
    /// What the horizontal axis shows.
    pub axis: FrontAxis,
    /// The films of the front, in ascending or descending order of [`FrontFilm::at`].
    pub films: Vec<FrontFilm>,
    /// The film that the design started from, if the figure shows it.
    pub before: Option<FrontFilm>,
}

/// What better films cost: the horizontal axis of a [`FrontFigure`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FrontAxis {
    /// Best-fit amplitude relative to the ideal film, without unit.
    Amplitude,
    /// The number of distinct parts.
    Parts,
}

/// A film of a front.
#[derive(Clone, Copy, Debug)]
pub struct FrontFilm {
    /// Its position on the horizontal axis.
    pub at: f64,
    /// RMSE of the displacement found from B against the true one, along x, y, z, in millimetres.
    pub displacement_rmse_mm: [f64; 3],
    /// Uniformity RMSE of R_x, R_y, S_z divided by k, in millimetres.
    pub uniformity_rmse_mm: [f64; 3],
    /// 95th percentile of the displacement RMSE of the films that are made, in millimetres.
    pub made_p95_mm: Option<[f64; 3]>,
}

impl FrontFilm {
    /// A film with these figures; an undefined uniformity counts as no error.
    pub fn new(at: f64, figures: &Figures, made_p95_mm: Option<PerAxis>, ideal: &IdealFilm) -> FrontFilm {
        let uniformity = figures.uniformity_rmse.map(Option::unwrap_or_default);
        FrontFilm {
            at,
            displacement_rmse_mm: figures.displacement_rmse_mm.to_array(),
            uniformity_rmse_mm: uniformity.as_lengths(ideal.wavenumber()).to_array(),
            made_p95_mm: made_p95_mm.map(PerAxis::to_array),
        }
    }
}

impl FrontFigure {
    /// The figure, named `front-amplitude` or `front-parts`.
    ///
    /// # Errors
    /// [`ReportError::Drawing`] if no film has an error above 0, which the logarithmic scale needs.
    pub fn draw(&self) -> Result<Drawing, ReportError> {
        let (name, cost) = match self.axis {
            FrontAxis::Amplitude => ("front-amplitude", "its best-fit amplitude relative to the ideal film"),
            FrontAxis::Parts => ("front-parts", "its number of distinct parts"),
        };
        let made = "Discs: RMSE of displacement that 95 % of the films that are made do not exceed. ";
        let caption = format!(
            "RMSE of each film of the front against {cost}. {}Shear is the larger RMSE of x and y.",
            if self.is_made() { made } else { "" }
        );
        let drawn = svg(self)
            .and_then(|svg| Drawing::new(name, caption, &svg, self.csv(), SvgText::Outlines, &typeset::options()));
        drawn.map_err(|source| ReportError::Drawing { figure: name, source })
    }
}

impl FrontFigure {
    /// Whether all films have errors as made.
    fn is_made(&self) -> bool {
        self.films.iter().chain(&self.before).all(|film| film.made_p95_mm.is_some())
    }

    fn series(&self) -> [ErrorSeries; 4] {
        let shear_and_normal = |filled: bool, names: [&'static str; 2], errors: [fn(&FrontFilm) -> f64; 2]| {
            [0, 1].map(|n| ErrorSeries { name: names[n], colour: [BLUE, VERMILION][n], filled, error: errors[n] })
        };
        let displacement: [fn(&FrontFilm) -> f64; 2] =
            [|film| shear(film.displacement_rmse_mm), |film| film.displacement_rmse_mm[2]];
        let ([a, b], [c, d]) = if self.is_made() {
            let made: [fn(&FrontFilm) -> f64; 2] =
                [|film| film.made_p95_mm.map_or(0.0, shear), |film| film.made_p95_mm.map_or(0.0, |errors| errors[2])];
            (
                shear_and_normal(true, ["95 % of films made, shear", "95 % of films made, normal"], made),
                shear_and_normal(false, ["as ordered, shear", "as ordered, normal"], displacement),
            )
        } else {
            let uniformity: [fn(&FrontFilm) -> f64; 2] =
                [|film| shear(film.uniformity_rmse_mm), |film| film.uniformity_rmse_mm[2]];
            (
                shear_and_normal(true, ["displacement, shear", "displacement, normal"], displacement),
                shear_and_normal(false, ["uniformity, shear", "uniformity, normal"], uniformity),
            )
        };
        [a, b, c, d]
    }

    /// The films as CSV.
    fn csv(&self) -> String {
        let first = match self.axis {
            FrontAxis::Amplitude => "amplitude",
            FrontAxis::Parts => "parts",
        };
        let made = if self.is_made() { &["made_p95_displacement"][..] } else { &[] };
        let errors: Vec<String> = ["displacement", "uniformity"]
            .iter()
            .chain(made)
            .flat_map(|error| AXIS_NAMES.map(|axis| format!("{error}_rmse_{axis}_mm")))
            .collect();
        let mut csv = format!("{first},{}\n", errors.join(","));
        for film in self.films.iter().chain(&self.before) {
            let made = film.made_p95_mm.iter().filter(|_| self.is_made()).flatten();
            let errors = film.displacement_rmse_mm.iter().chain(&film.uniformity_rmse_mm).chain(made);
            csv += &errors.fold(film.at.to_string(), |row, error| format!("{row},{error}"));
            csv.push('\n');
        }
        csv
    }
}

/// One of the four errors of a film, and how it is drawn.
struct ErrorSeries {
    name: &'static str,
    colour: RGBColor,
    /// Whether its marks are discs on a thick line, or rings on a thin one.
    filled: bool,
    error: fn(&FrontFilm) -> f64,
}

/// The larger error of x and y.
fn shear([x, y, _]: [f64; 3]) -> f64 {
    x.max(y)
}

fn svg(front: &FrontFigure) -> Result<String, DrawError> {
    let all = front.series();
    let errors = || {
        let films = front.films.iter().chain(&front.before);
        films.flat_map(|film| all.iter().map(move |series| (series.error)(film))).filter(|error| *error > 0.0)
    };
    let (low, high) = errors().fold((f64::INFINITY, 0.0_f64), |(l, h), e| (l.min(e), h.max(e)));
    if low > high {
        return Err("no film has an error above 0".into());
    }
    let at = || front.films.iter().chain(&front.before).map(|film| film.at);
    let (first, last) = at().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
    let margin = if front.axis == FrontAxis::Parts { 0.6 } else { 0.05 * (last - first).max(0.1) };
    let panel = Panel {
        left: LEFT_PX,
        top: TOP_PX,
        width: WIDTH_PX,
        height: HEIGHT_PX,
        x: [first - margin, last + margin],
        // Room for the label above the film that the design started from.
        y: [low.log10() - 0.15, high.log10() + if front.before.is_some() { 0.4 } else { 0.15 }],
    };
    sheet([LEFT_PX + WIDTH_PX + RIGHT_PX, TOP_PX + HEIGHT_PX + BELOW_PX + 8.0], |sheet| {
        decades(sheet, &panel)?;
        for series in &all {
            let points: Vec<[f64; 2]> =
                front.films.iter().map(|film| panel.at(film.at, (series.error)(film).max(low).log10())).collect();
            sheet.line(&points, series.colour, if series.filled { 1.4 } else { 0.8 })?;
            for point in points {
                mark(sheet, series, point)?;
            }
        }
        if let Some(film) = &front.before {
            let errors = all.each_ref().map(|series| (series.error)(film).max(low).log10());
            for (series, error) in all.iter().zip(errors) {
                mark(sheet, series, panel.at(film.at, error))?;
            }
            let top = errors.into_iter().fold(f64::NEG_INFINITY, f64::max);
            let [x, y] = panel.at(film.at, top);
            sheet.text([x, y - 14.0], "before", LETTERS.centred())?;
        }
        frame(sheet, &panel, front.axis)?;
        for (index, series) in all.iter().enumerate() {
            let (column, row) = (index / 2, index % 2);
            let legend = [LEFT_PX + 6.0 + 210.0 * column as f64, 16.0 + 20.0 * row as f64];
            sheet.line(
                &[[legend[0], legend[1]], [legend[0] + 24.0, legend[1]]],
                series.colour,
                if series.filled { 1.4 } else { 0.8 },
            )?;
            mark(sheet, series, [legend[0] + 12.0, legend[1]])?;
            sheet.text([legend[0] + 32.0, legend[1]], series.name, LETTERS)?;
        }
        Ok(())
    })
}

/// Draws the mark of a series at a position on the sheet.
fn mark(sheet: &Sheet, series: &ErrorSeries, at: [f64; 2]) -> DrawResult {
    if series.filled {
        return sheet.disc(at, RADIUS_PX, series.colour);
    }
    sheet.disc(at, RADIUS_PX, RGBColor(255, 255, 255))?;
    sheet.ring(at, RADIUS_PX, series.colour, 1.2)
}

/// Draws the vertical axis: faint lines at powers of ten, ticks between them, and numbers at powers
/// of ten, or also between them where there are too few.
fn decades(sheet: &Sheet, panel: &Panel) -> DrawResult {
    const FAINT: RGBColor = RGBColor(222, 222, 222);
    let [low, high] = panel.y;
    let numbered: &[i32] = if high.floor() - low.ceil() < 2.0 { &[1, 2, 5] } else { &[1] };
    let letters = Lettering { across: plotters::style::text_anchor::HPos::Right, ..LETTERS.sized(NUMBERS_PX) };
    for decade in low.floor() as i32..=high.floor() as i32 {
        for digit in 1..10 {
            let value = f64::from(digit) * 10_f64.powi(decade);
            if !(low..=high).contains(&value.log10()) {
                continue;
            }
            let [left, y] = panel.at(panel.x[0], value.log10());
            if digit == 1 {
                sheet.line(&[[left, y], [panel.right(), y]], FAINT, 0.8)?;
            }
            let is_numbered = numbered.contains(&digit);
            if is_numbered {
                sheet.text([left - 2.0 * TICK_PX, y], &typeset::number(value), letters)?;
            }
            let length = if is_numbered { TICK_PX } else { 0.5 * TICK_PX };
            sheet.line(&[[left - length, y], [left, y]], INK, FRAME_PX)?;
        }
    }
    Ok(())
}

/// Draws the horizontal axis, the names of both axes and the frame.
fn frame(sheet: &Sheet, panel: &Panel, axis: FrontAxis) -> DrawResult {
    let values: Vec<f64> = match axis {
        FrontAxis::Parts => (panel.x[0].ceil() as i64..=panel.x[1].floor() as i64).map(|n| n as f64).collect(),
        FrontAxis::Amplitude => RangedCoordf64::from(panel.x[0]..panel.x[1]).key_points(MAX_NUMBERS),
    };
    let numbers = AxisNumbers::new(&values);
    for &value in &values {
        let [x, bottom] = panel.at(value, panel.y[0]);
        sheet.line(&[[x, bottom], [x, bottom + TICK_PX]], INK, FRAME_PX)?;
        sheet.text([x, bottom + 14.0], &numbers.text(value), LETTERS.sized(NUMBERS_PX).centred())?;
    }
    let name = match axis {
        FrontAxis::Parts => "distinct parts",
        FrontAxis::Amplitude => "amplitude relative to the ideal film",
    };
    sheet.text([panel.left + 0.5 * panel.width, panel.bottom() + 32.0], name, LETTERS.centred())?;
    let upright = Lettering { upright: true, ..LETTERS.centred() };
    sheet.text([16.0, panel.top + 0.5 * panel.height], "RMSE (mm)", upright)?;
    let (right, bottom) = (panel.right(), panel.bottom());
    sheet.outline(&[[panel.left, panel.top], [right, panel.top], [right, bottom], [panel.left, bottom]], INK, FRAME_PX)
}

#[cfg(test)]
mod tests {
    use std::error::Error;

    use super::*;

    #[test]
    fn front_without_films_is_refused_with_its_reason_as_source() {
        let front = FrontFigure { axis: FrontAxis::Parts, films: Vec::new(), before: None };
        let error = front.draw().unwrap_err();
        assert_eq!(error.to_string(), "the figure front-parts cannot be drawn: no film has an error above 0");
        assert_eq!(error.source().unwrap().to_string(), "no film has an error above 0");
    }
}
