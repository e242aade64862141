//! B, the decoupling parameters and the displacement or force that a sensor tells while the film is
//! moved along each axis (Dai 2024, Fig. 9).

use glam::DVec3;
use magsplice::layout::Elastomer;
use magsplice::results::FilmExperiments;
use magsplice::sensor::ExperimentStep;
use plotters::prelude::RGBColor;

use crate::colours::{BLUE, GREEN, VERMILION};
use crate::drawing::{Drawing, SvgText};
use crate::error::{DrawError, ReportError};
use crate::flux_unit::{FluxUnit, flux_unit};
use crate::panel::{AxisLabel, BELOW_PX, LEFT_PX, Panel, padded};
use crate::sheet::{DrawResult, LETTERS, Sheet, sheet};
use crate::typeset::{self, AXIS_NAMES, symbol, variable};

use super::field_maps::csv_row;

/// Name of the figure in files and errors.
const NAME: &str = "experiment";

const WIDTH_PX: f64 = 250.0;
const HEIGHT_PX: f64 = 170.0;
const TOP_PX: f64 = 34.0;
/// Distance of rows, with the legend of the lower one, in pixels.
const BETWEEN_PX: f64 = 36.0;
const ASIDE_PX: f64 = 30.0;
const DISC_PX: f64 = 2.6;
const LINE_PX: f64 = 1.3;
const BROAD_PX: f64 = 5.0;
/// Pale, because other lines lie on it.
const TRUE: RGBColor = RGBColor(200, 200, 200);
/// Length of the mark of a line in a legend, and its distance from the text, in pixels.
const MARK_PX: f64 = 16.0;
const COLOURS: [RGBColor; 3] = [BLUE, VERMILION, GREEN];

/// One of the lines of a panel.
struct Line<'a> {
    name: String,
    colour: RGBColor,
    values: Vec<f64>,
    /// Whether it is a thin line with marked points, or a broad one for others to lie on.
    is_marked: bool,
    at: &'a [f64],
}

impl Line<'_> {
    fn width_px(&self) -> f64 {
        if self.is_marked { LINE_PX } else { BROAD_PX }
    }
}

/// The figure of the experiments.
///
/// # Errors
/// [`ReportError::Drawing`] if it cannot be drawn.
pub fn experiment_figure(experiments: &FilmExperiments, text: SvgText) -> Result<Drawing, ReportError> {
    let drawn = draw(experiments)
        .and_then(|svg| Drawing::new(NAME, caption(experiments), &svg, csv(experiments), text, &typeset::options()));
    drawn.map_err(|source| ReportError::Drawing { figure: NAME, source })
}

pub(crate) fn caption(experiments: &FilmExperiments) -> String {
    let told = if experiments.elastomer.is_some() { "force" } else { "displacement" };
    format!(
        "The film is moved along x, y and z: what the sensor reads, the decoupling parameters of its readings, and the \
         {told} along the axis of motion, as it is and as the closed form (Eq. 14) and the field of the layout tell it."
    )
}

pub(crate) fn draw(experiments: &FilmExperiments) -> Result<String, DrawError> {
    let left = |column: usize| LEFT_PX + 12.0 + column as f64 * (WIDTH_PX + LEFT_PX + ASIDE_PX);
    let top = |row: usize| TOP_PX + row as f64 * (HEIGHT_PX + BETWEEN_PX);
    let readings = || experiments.steps.iter().flat_map(|steps| steps.iter().map(|step| step.reading_t));
    let unit = flux_unit(readings().map(|b| b.abs().max_element()).fold(0.0, f64::max));
    sheet([left(2) + WIDTH_PX + 14.0, top(2) + HEIGHT_PX + BELOW_PX + 6.0], |sheet| {
        for (axis, steps) in experiments.steps.iter().enumerate() {
            let at: Vec<f64> = steps.iter().map(|step| step.displacement[axis]).collect();
            let (told, unit_told) = told(experiments.elastomer.as_ref(), axis, steps, &at);
            let rows = [
                (fields(steps, &at, &unit), format!("{} ({})", variable("B"), unit.name)),
                (
                    parameters(steps, &at),
                    format!("{}, {} (rad), \u{394}{}", symbol("R", "x"), symbol("R", "y"), symbol("S", "z")),
                ),
                (told, unit_told),
            ];
            for (row, (lines, name)) in rows.into_iter().enumerate() {
                let y = padded(lines.iter().flat_map(|line| line.values.iter().copied()));
                let panel = Panel {
                    left: left(axis),
                    top: top(row),
                    width: WIDTH_PX,
                    height: HEIGHT_PX,
                    x: padded(at.iter().copied()),
                    y,
                };
                lines.iter().try_for_each(|line| draw_line(sheet, &panel, line))?;
                let displacement = format!("displacement of the film along {} (mm)", variable(AXIS_NAMES[axis]));
                let x = if row == 2 { AxisLabel::Named(&displacement) } else { AxisLabel::TicksOnly };
                panel.axes(sheet, x, AxisLabel::Named(&name))?;
                panel.title(sheet, 3 * row + axis, "")?;
                if axis == 0 || row == 2 {
                    legend(sheet, &panel, &lines)?;
                }
            }
        }
        Ok(())
    })
}

fn fields<'a>(steps: &[ExperimentStep], at: &'a [f64], unit: &FluxUnit) -> Vec<Line<'a>> {
    let line = |axis: usize| Line {
        name: symbol("B", AXIS_NAMES[axis]),
        colour: COLOURS[axis],
        values: steps.iter().map(|step| step.reading_t[axis] * unit.per_t).collect(),
        is_marked: true,
        at,
    };
    vec![line(0), line(1), line(2)]
}

/// R_x, R_y, and S_z from its value at rest.
fn parameters<'a>(steps: &[ExperimentStep], at: &'a [f64]) -> Vec<Line<'a>> {
    let rest = steps.iter().find(|step| step.displacement == DVec3::ZERO);
    let at_rest = rest.and_then(|step| step.parameters).map_or(f64::NAN, |parameters| parameters.s_z);
    let line = |which: usize| Line {
        name: [symbol("R", "x"), symbol("R", "y"), format!("\u{394}{}", symbol("S", "z"))][which].clone(),
        colour: COLOURS[which],
        values: steps
            .iter()
            .map(|step| step.parameters.map_or(f64::NAN, |p| [p.r_x, p.r_y, p.s_z - at_rest][which]))
            .collect(),
        is_marked: true,
        at,
    };
    vec![line(0), line(1), line(2)]
}

/// The displacement or force along the axis of motion, true and told.
fn told<'a>(
    layer: Option<&Elastomer>,
    axis: usize,
    steps: &[ExperimentStep],
    at: &'a [f64],
) -> (Vec<Line<'a>>, String) {
    let value = |displacement: Option<DVec3>| {
        let of = |moved: DVec3| layer.map_or(moved, |layer| layer.force_n(moved))[axis];
        displacement.map_or(f64::NAN, of)
    };
    let line = |name: &str, colour, is_marked, of: &dyn Fn(&ExperimentStep) -> Option<DVec3>| Line {
        name: name.to_owned(),
        colour,
        values: steps.iter().map(|step| value(of(step))).collect(),
        is_marked,
        at,
    };
    let lines = vec![
        line("true", TRUE, false, &|step| Some(step.displacement)),
        line("closed form", VERMILION, true, &|step| step.by_closed_form),
        line("field", BLUE, true, &|step| step.by_field),
    ];
    let name = match layer {
        Some(_) => format!("{} (N)", symbol("F", AXIS_NAMES[axis])),
        None => format!("displacement along {} (mm)", variable(AXIS_NAMES[axis])),
    };
    let has_values = |line: &Line| line.values.iter().any(|value| value.is_finite());
    (lines.into_iter().filter(has_values).collect(), name)
}

fn draw_line(sheet: &Sheet, panel: &Panel, line: &Line) -> DrawResult {
    let points: Vec<[f64; 2]> =
        line.at.iter().zip(&line.values).filter(|(_, y)| y.is_finite()).map(|(x, y)| panel.at(*x, *y)).collect();
    // A line ends where there is no value.
    for piece in line.at.iter().zip(&line.values).collect::<Vec<_>>().split(|(_, y)| !y.is_finite()) {
        let piece: Vec<[f64; 2]> = piece.iter().map(|(x, y)| panel.at(**x, **y)).collect();
        if piece.len() > 1 {
            sheet.line(&piece, line.colour, line.width_px())?;
        }
    }
    if line.is_marked {
        points.into_iter().try_for_each(|at| sheet.disc(at, DISC_PX, line.colour))?;
    }
    Ok(())
}

/// Draws the names of the lines above the panel, behind its letter.
fn legend(sheet: &Sheet, panel: &Panel, lines: &[Line]) -> DrawResult {
    let (mut x, y) = (panel.left + 30.0, panel.top - 12.0);
    for line in lines {
        sheet.line(&[[x, y], [x + MARK_PX, y]], line.colour, line.width_px())?;
        if line.is_marked {
            sheet.disc([x + 0.5 * MARK_PX, y], DISC_PX, line.colour)?;
        }
        sheet.text([x + MARK_PX + 4.0, y], &line.name, LETTERS.sized(12.0))?;
        // Symbols are short; words have 6 pixels a letter.
        let width = if line.name.is_ascii() { 6.0 * line.name.len() as f64 } else { 20.0 };
        x += MARK_PX + 4.0 + width + 12.0;
    }
    Ok(())
}

pub(crate) fn csv(experiments: &FilmExperiments) -> String {
    let mut csv = "film_dx_mm,film_dy_mm,film_dz_mm,b_x_t,b_y_t,b_z_t,r_x_rad,r_y_rad,s_z_ln_t,closed_form_dx_mm,\
                   closed_form_dy_mm,closed_form_dz_mm,found_dx_mm,found_dy_mm,found_dz_mm\n"
        .to_owned();
    for step in experiments.all_steps() {
        let parameters = step.parameters.map_or([f64::NAN; 3], |p| [p.r_x, p.r_y, p.s_z]);
        let vectors = [step.displacement, step.reading_t, parameters.into()];
        let told = [step.by_closed_form, step.by_field].map(|moved| moved.unwrap_or(DVec3::NAN));
        csv_row(&mut csv, vectors.into_iter().chain(told).flat_map(|vector| vector.to_array()));
    }
    csv
}
