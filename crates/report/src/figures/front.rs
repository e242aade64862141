//! Errors of the films of a Pareto front against what better films cost.

use magsplice::decouple::Figures;
use magsplice::design::{Metrics, ParetoFront, SearchResult};
use magsplice::ideal::IdealFilm;
use magsplice::tolerance::Statistics;
use plotters::coord::ranged1d::Ranged;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::RGBColor;

use crate::colours::{BLUE, VERMILION};
use crate::drawing::{Drawing, FigureDraft, SvgText};
use crate::error::{DrawError, ReportError};
use crate::panel::{BELOW_PX, NUMBERS_PX, Panel, TICK_PX};
use crate::shared_ranges::range_of;
use crate::sheet::{DrawResult, FRAME_PX, INK, LETTERS, Lettering, Sheet, sheet};
use crate::typeset::{self, AXIS_NAMES, AxisNumbers};

const WIDTH_PX: f64 = 430.0;
const HEIGHT_PX: f64 = 300.0;
const LEFT_PX: f64 = 78.0;
const TOP_PX: f64 = 66.0;
const RIGHT_PX: f64 = 24.0;
const RADIUS_PX: f64 = 3.6;
/// Maximum count of numbers on the horizontal axis.
const MAX_NUMBERS: usize = 9;

/// A front and what its better films cost.
struct FrontFigure {
    axis: FrontAxis,
    /// The films of the front, in ascending or descending order of [`FrontFilm::at`].
    films: Vec<FrontFilm>,
    /// The film that the design started from, if the figure shows it.
    before: Option<FrontFilm>,
}

/// What better films cost: the horizontal axis of a figure.
#[derive(Clone, Copy, PartialEq)]
enum FrontAxis {
    /// Best-fit amplitude relative to the ideal film, without unit.
    Amplitude,
    /// The number of distinct parts.
    Parts,
}

/// A film of a front.
struct FrontFilm {
    /// Its position on the horizontal axis.
    at: f64,
    /// RMSE along x, y, z in millimetres: of the displacement found from B against the true one, of
    /// the uniformity divided by k, and the displacement that 95 % of the films as made do not
    /// exceed, where they were sampled.
    errors_mm: Vec<[f64; 3]>,
}

/// The figures of a Pareto front, `front-amplitude` and `front-parts`: four errors of each film
/// against what better films cost. A front without films of a kind has no figure of it.
///
/// The four errors are displacement and uniformity RMSE, each for shear (the larger one of x and y)
/// and for the normal direction z, in millimetres on a logarithmic scale. Where all films have
/// errors as made, these are drawn, and the displacement RMSE of the films as ordered.
///
/// # Errors
/// [`ReportError::Drawing`] if no film has an error above 0, which the logarithmic scale needs.
pub fn front_figures(front: &ParetoFront, ideal: &IdealFilm) -> Result<Vec<Drawing>, ReportError> {
    let film = |at: f64, metrics: &Metrics, made: Option<&Figures<Statistics>>| {
        let Figures { displacement_rmse_mm, uniformity_rmse, .. } = metrics.figures;
        // An undefined uniformity is no error.
        let uniformity_mm = uniformity_rmse.map(Option::unwrap_or_default).as_lengths(ideal.wavenumber());
        let mut errors_mm = vec![displacement_rmse_mm.to_array(), uniformity_mm.to_array()];
        errors_mm.extend(made.map(|made| made.displacement_rmse_mm.map(|axis| axis.p95.value).to_array()));
        FrontFilm { at, errors_mm }
    };
    let after = |at: f64, result: &SearchResult| film(at, &result.after, result.made.as_ref().map(|made| &made.after));
    let before = front.by_amplitude.first().map(|(_, result)| {
        film(
            result.before.figures.amplitude,
            &result.before,
            result.made.as_ref().and_then(|made| made.before.as_ref()),
        )
    });
    let by_amplitude =
        front.by_amplitude.iter().map(|(_, result)| after(result.after.figures.amplitude, result)).collect();
    let by_parts = front.by_parts.iter().map(|result| after(result.parts as f64, result)).collect();
    let figures = [
        FrontFigure { axis: FrontAxis::Amplitude, films: by_amplitude, before },
        FrontFigure { axis: FrontAxis::Parts, films: by_parts, before: None },
    ];
    let shown = figures.iter().filter(|figure| !figure.films.is_empty());
    shown.map(|figure| figure.draft()?.rendered(SvgText::Outlines)).collect()
}

impl FrontFigure {
    fn draft(&self) -> Result<FigureDraft, ReportError> {
        let (name, cost) = match self.axis {
            FrontAxis::Amplitude => ("front-amplitude", "its best-fit amplitude relative to the ideal film"),
            FrontAxis::Parts => ("front-parts", "its number of distinct parts"),
        };
        let made = "Discs: RMSE of displacement that 95 % of the films as made do not exceed. ";
        let caption = format!(
            "RMSE of each film of the front against {cost}. {}Shear is the larger RMSE of x and y.",
            if self.is_made() { made } else { "" }
        );
        FigureDraft::new(name, caption, svg(self), self.csv())
    }

    fn all(&self) -> impl Iterator<Item = &FrontFilm> {
        self.films.iter().chain(&self.before)
    }

    /// Whether all films have errors as made.
    fn is_made(&self) -> bool {
        self.all().all(|film| film.errors_mm.len() == 3)
    }

    fn series(&self) -> [ErrorSeries; 4] {
        let [discs, rings] = if self.is_made() {
            [
                (2, ["95 % of films made, shear", "95 % of films made, normal"]),
                (0, ["as ordered, shear", "as ordered, normal"]),
            ]
        } else {
            [(0, ["displacement, shear", "displacement, normal"]), (1, ["uniformity, shear", "uniformity, normal"])]
        };
        [(discs, 0), (discs, 1), (rings, 0), (rings, 1)].map(|((error, names), direction)| ErrorSeries {
            name: names[direction],
            colour: [BLUE, VERMILION][direction],
            filled: error == discs.0,
            error,
            is_normal: direction == 1,
        })
    }

    /// The films as CSV.
    fn csv(&self) -> String {
        let first = match self.axis {
            FrontAxis::Amplitude => "amplitude",
            FrontAxis::Parts => "parts",
        };
        let kinds = if self.is_made() { 3 } else { 2 };
        let names = ["displacement", "uniformity", "made_p95_displacement"].into_iter().take(kinds);
        let errors: Vec<String> =
            names.flat_map(|error| AXIS_NAMES.map(|axis| format!("{error}_rmse_{axis}_mm"))).collect();
        let mut csv = format!("{first},{}\n", errors.join(","));
        for film in self.all() {
            let errors = film.errors_mm.iter().take(kinds).flatten();
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
    /// Index in [`FrontFilm::errors_mm`].
    error: usize,
    /// Whether it is the error along z, or the larger one of x and y.
    is_normal: bool,
}

impl ErrorSeries {
    fn of(&self, film: &FrontFilm) -> f64 {
        let [x, y, z] = film.errors_mm[self.error];
        if self.is_normal { z } else { x.max(y) }
    }

    fn width_px(&self) -> f64 {
        if self.filled { 1.4 } else { 0.8 }
    }
}

fn svg(front: &FrontFigure) -> Result<String, DrawError> {
    let all = front.series();
    let errors = front.all().flat_map(|film| all.iter().map(move |series| series.of(film)));
    let [low, high] = range_of(errors.filter(|error| *error > 0.0));
    if low > high {
        return Err("no film has an error above 0".into());
    }
    let [first, last] = range_of(front.all().map(|film| film.at));
    let margin = if front.axis == FrontAxis::Parts { 0.6 } else { 0.05 * (last - first).max(0.1) };
    let x = [first - margin, last + margin];
    // Room for the label above the film that the design started from.
    let y = [low.log10() - 0.15, high.log10() + if front.before.is_some() { 0.4 } else { 0.15 }];
    let panel = Panel::new([LEFT_PX, TOP_PX], [WIDTH_PX, HEIGHT_PX], x, y);
    sheet([LEFT_PX + WIDTH_PX + RIGHT_PX, TOP_PX + HEIGHT_PX + BELOW_PX + 8.0], |sheet| {
        decades(sheet, &panel)?;
        for series in &all {
            let points: Vec<[f64; 2]> =
                front.films.iter().map(|film| panel.at(film.at, series.of(film).max(low).log10())).collect();
            sheet.line(&points, series.colour, series.width_px())?;
            for point in points {
                mark(sheet, series, point)?;
            }
        }
        if let Some(film) = &front.before {
            let errors = all.each_ref().map(|series| series.of(film).max(low).log10());
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
            let [x, y] = [LEFT_PX + 6.0 + 210.0 * column as f64, 16.0 + 20.0 * row as f64];
            sheet.line(&[[x, y], [x + 24.0, y]], series.colour, series.width_px())?;
            mark(sheet, series, [x + 12.0, y])?;
            sheet.text([x + 32.0, y], series.name, LETTERS)?;
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
    panel.frame(sheet)
}

#[cfg(test)]
mod tests {
    use std::error::Error;

    use super::*;

    #[test]
    fn front_without_films_is_refused_with_its_reason_as_source() {
        let front = FrontFigure { axis: FrontAxis::Parts, films: Vec::new(), before: None };
        let error = front.draft().err().unwrap();
        assert_eq!(error.to_string(), "the figure front-parts cannot be drawn: no film has an error above 0");
        assert_eq!(error.source().unwrap().to_string(), "no film has an error above 0");
    }
}
