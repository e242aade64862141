//! B, the decoupling parameters and the displacement or force that a sensor tells while the film is
//! moved along each axis (Dai 2024, Fig. 9).

use glam::DVec3;
use magsplice::decouple::Parameters;
use magsplice::layout::Elastomer;
use magsplice::results::FilmExperiments;
use magsplice::sensor::ExperimentStep;
use plotters::prelude::RGBColor;

use crate::colours::{BLUE, GREEN, VERMILION};
use crate::csv::csv_of_vectors;
use crate::drawing::{Drawing, FigureDraft, SvgText};
use crate::error::{DrawError, ReportError};
use crate::flux_unit::{FluxUnit, flux_unit, largest_component_t};
use crate::panel::{AxisLabel, BELOW_PX, LEFT_PX, Panel, padded};
use crate::shared_ranges::SharedRanges;
use crate::sheet::{DrawResult, LETTERS, Sheet, sheet};
use crate::survey::as_vector;
use crate::typeset::{AXIS_NAMES, parameter, symbol, variable};

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
struct Line {
    name: String,
    colour: RGBColor,
    values: Vec<f64>,
    /// Whether it is a thin line with marked points, or a broad one for others to lie on.
    is_marked: bool,
}

impl Line {
    fn new(name: String, colour: RGBColor, values: impl Iterator<Item = f64>) -> Line {
        Line { name, colour, values: values.collect(), is_marked: true }
    }

    fn width_px(&self) -> f64 {
        if self.is_marked { LINE_PX } else { BROAD_PX }
    }
}

/// The figure of the experiments.
///
/// # Errors
/// [`ReportError::Drawing`] if it cannot be drawn.
pub fn experiment_figure(experiments: &FilmExperiments, text: SvgText) -> Result<Drawing, ReportError> {
    draft(experiments, &SharedRanges::default())?.rendered(text)
}

pub(crate) fn draft(experiments: &FilmExperiments, ranges: &SharedRanges) -> Result<FigureDraft, ReportError> {
    let quantity = if experiments.elastomer.is_some() { "force" } else { "displacement" };
    let caption = format!(
        "The film is moved along x, y and z: the readings of the sensor, their decoupling parameters, and the {quantity} \
         along the axis of motion: the true one, by the closed form (Eq. 14), and by the field of the layout."
    );
    FigureDraft::new("experiment", caption, draw(experiments, ranges), csv(experiments))
}

fn draw(experiments: &FilmExperiments, ranges: &SharedRanges) -> Result<String, DrawError> {
    let left = |column: usize| LEFT_PX + 12.0 + column as f64 * (WIDTH_PX + LEFT_PX + ASIDE_PX);
    let top = |row: usize| TOP_PX + row as f64 * (HEIGHT_PX + BETWEEN_PX);
    let readings = experiments.steps.iter().flatten().map(|step| step.reading_t);
    let unit = flux_unit(ranges.widened("experiment unit", [0.0, largest_component_t(readings)])[1]);
    sheet([left(2) + WIDTH_PX + 14.0, top(2) + HEIGHT_PX + BELOW_PX + 6.0], |sheet| {
        for (axis, steps) in experiments.steps.iter().enumerate() {
            let at: Vec<f64> = steps.iter().map(|step| step.displacement[axis]).collect();
            let (told, unit_told) = told(experiments.elastomer.as_ref(), axis, steps);
            let rows = [
                (fields(steps, &unit), format!("{} ({})", variable("B"), unit.name)),
                (parameters(steps), format!("{}, {} (rad), \u{394}{}", parameter(0), parameter(1), parameter(2))),
                (told, unit_told),
            ];
            for (row, (lines, name)) in rows.into_iter().enumerate() {
                let shared = |what: &str, own: [f64; 2]| ranges.widened(&format!("experiment {axis} {what}"), own);
                let of_lines = lines.iter().flat_map(|line| line.values.iter().copied());
                let y = shared(&format!("{row} {}", name), padded(of_lines));
                let x = shared("x", padded(at.iter().copied()));
                let panel = Panel::new([left(axis), top(row)], [WIDTH_PX, HEIGHT_PX], x, y);
                lines.iter().try_for_each(|line| draw_line(sheet, &panel, &at, line))?;
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

fn fields(steps: &[ExperimentStep], unit: &FluxUnit) -> Vec<Line> {
    let values = |axis: usize| steps.iter().map(move |step| step.reading_t[axis] * unit.per_t);
    (0..3).map(|axis| Line::new(symbol("B", AXIS_NAMES[axis]), COLOURS[axis], values(axis))).collect()
}

/// R_x, R_y, and S_z from its value at rest.
fn parameters(steps: &[ExperimentStep]) -> Vec<Line> {
    let rest = steps.iter().find(|step| step.displacement == DVec3::ZERO);
    let at_rest = rest.and_then(|step| step.parameters).map_or(f64::NAN, |parameters| parameters.s_z);
    let from_rest = |p: Parameters| Parameters { s_z: p.s_z - at_rest, ..p };
    let line = |which: usize| {
        let values = steps.iter().map(|step| as_vector(step.parameters.map(from_rest))[which]);
        Line::new(["", "", "\u{394}"][which].to_owned() + &parameter(which), COLOURS[which], values)
    };
    (0..3).map(line).collect()
}

/// The displacement or force along the axis of motion, true and told.
fn told(layer: Option<&Elastomer>, axis: usize, steps: &[ExperimentStep]) -> (Vec<Line>, String) {
    let line = |name: &str, colour, displacement: fn(&ExperimentStep) -> Option<DVec3>| {
        let value = |moved: DVec3| layer.map_or(moved, |layer| layer.force_n(moved))[axis];
        Line::new(name.to_owned(), colour, steps.iter().map(|step| displacement(step).map_or(f64::NAN, value)))
    };
    let lines = vec![
        Line { is_marked: false, ..line("true", TRUE, |step| Some(step.displacement)) },
        line("closed form", VERMILION, |step| step.by_closed_form),
        line("field", BLUE, |step| step.by_field),
    ];
    let name = match layer {
        Some(_) => format!("{} (N)", symbol("F", AXIS_NAMES[axis])),
        None => format!("displacement along {} (mm)", variable(AXIS_NAMES[axis])),
    };
    let has_values = |line: &Line| line.values.iter().any(|value| value.is_finite());
    (lines.into_iter().filter(has_values).collect(), name)
}

fn draw_line(sheet: &Sheet, panel: &Panel, at: &[f64], line: &Line) -> DrawResult {
    let place = |(x, y): (&f64, &f64)| y.is_finite().then(|| panel.at(*x, *y));
    let places: Vec<Option<[f64; 2]>> = at.iter().zip(&line.values).map(place).collect();
    // A line ends where there is no value.
    for piece in places.split(Option::is_none).filter(|piece| piece.len() > 1) {
        sheet.line(&piece.iter().flatten().copied().collect::<Vec<_>>(), line.colour, line.width_px())?;
    }
    if line.is_marked {
        places.into_iter().flatten().try_for_each(|at| sheet.disc(at, DISC_PX, line.colour))?;
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

fn csv(experiments: &FilmExperiments) -> String {
    let header = "film_dx_mm,film_dy_mm,film_dz_mm,b_x_t,b_y_t,b_z_t,r_x_rad,r_y_rad,s_z_ln_t,closed_form_dx_mm,\
                   closed_form_dy_mm,closed_form_dz_mm,found_dx_mm,found_dy_mm,found_dz_mm";
    let row = |step: &ExperimentStep| {
        let [closed_form, found] = [step.by_closed_form, step.by_field].map(|moved| moved.unwrap_or(DVec3::NAN));
        [step.displacement, step.reading_t, as_vector(step.parameters), closed_form, found]
    };
    csv_of_vectors(header, experiments.all_steps().map(row))
}
