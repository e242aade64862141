//! The error budget of a film as bars.

use magsplice::decouple::PerAxis;
use magsplice::results::{BudgetPart, FilmBudget};
use plotters::prelude::RGBColor;
use plotters::style::text_anchor::HPos;

use crate::colours::{BLUE, VERMILION};
use crate::csv::quoted;
use crate::drawing::{Drawing, FigureDraft, SvgText};
use crate::error::{DrawError, ReportError};
use crate::panel::{AxisLabel, BELOW_PX, Panel};
use crate::sheet::{DrawResult, LETTERS, Lettering, Sheet, rectangle, sheet};
use crate::typeset::{self, AXIS_NAMES, variable};

const NAMES_PX: f64 = 176.0;
const WIDTH_PX: f64 = 210.0;
const BETWEEN_PX: f64 = 26.0;
const TOP_PX: f64 = 34.0;
const ROW_PX: f64 = 21.0;
const BAR_PX: f64 = 13.0;
/// Room for the number beside the longest bar, as a fraction of the axis.
const NUMBER_ROOM: f64 = 0.34;
/// Room at the left of the bars, as a fraction of the axis.
const MARGIN: f64 = 0.03;

/// The budget of a film as bars: for each axis, the share of each part in the mean square of the
/// displacement error.
///
/// # Errors
/// [`ReportError::Drawing`] if it cannot be drawn.
pub fn budget_figure(budget: &FilmBudget) -> Result<Drawing, ReportError> {
    let caption = "Shares of all causes in the mean square of the displacement error of films as made. Parts below \
                   zero compensate others.";
    let drawn = svg(&budget.parts, budget.total_mm2.to_array());
    FigureDraft::new("budget", caption, drawn, csv(&budget.parts))?.rendered(SvgText::Text)
}

fn svg(parts: &[BudgetPart], totals_mm2: [f64; 3]) -> Result<String, DrawError> {
    let square_mm2 = |part: &BudgetPart, axis: usize| part.mean_square_mm2.to_array()[axis];
    let share = |part: &BudgetPart, axis: usize| {
        if totals_mm2[axis] > 0.0 { 100.0 * square_mm2(part, axis) / totals_mm2[axis] } else { 0.0 }
    };
    let all = || parts.iter().flat_map(|part| (0..3).map(move |axis| share(part, axis)));
    let most = all().fold(10.0, f64::max);
    let least = all().fold(0.0, f64::min);
    let x = [least - MARGIN * (most - least), most + NUMBER_ROOM * (most - least)];
    let height = ROW_PX * parts.len() as f64 + 8.0;
    let width = NAMES_PX + 3.0 * (WIDTH_PX + BETWEEN_PX);
    sheet([width, TOP_PX + height + BELOW_PX + 6.0], |sheet| {
        for axis in 0..3 {
            let left = NAMES_PX + axis as f64 * (WIDTH_PX + BETWEEN_PX);
            let panel = Panel { left, top: TOP_PX, width: WIDTH_PX, height, x, y: [0.0, height] };
            for (row, part) in parts.iter().enumerate() {
                let middle = height - 4.0 - ROW_PX * (row as f64 + 0.5);
                of_part(sheet, &panel, middle, share(part, axis), square_mm2(part, axis))?;
                if axis == 0 {
                    let [x, y] = panel.at(panel.x[0], middle);
                    let letters = Lettering { across: HPos::Right, ..LETTERS.sized(12.0) };
                    sheet.text([x - 10.0, y], &part.name, letters)?;
                }
            }
            frame(sheet, &panel)?;
            let total = typeset::number(format!("{:.3}", totals_mm2[axis].sqrt()).parse().unwrap_or(0.0));
            panel.title(sheet, axis, &format!("{}: {total} mm RMS", variable(AXIS_NAMES[axis])))?;
        }
        Ok(())
    })
}

/// Draws the bar of one part, with its root mean square in um beside it.
fn of_part(sheet: &Sheet, panel: &Panel, middle: f64, share: f64, square_mm2: f64) -> DrawResult {
    let colour: RGBColor = if share < 0.0 { VERMILION } else { BLUE };
    let (low, high) = (middle - 0.5 * BAR_PX, middle + 0.5 * BAR_PX);
    sheet.fill(&rectangle(panel.at(0.0, low), panel.at(share, high)), colour)?;
    let um = 1e3 * square_mm2.abs().sqrt();
    let number = if um >= 10.0 { format!("{um:.0}") } else { format!("{um:.1}") };
    // A minus sign, not a hyphen.
    let sign = if share < 0.0 && um >= 0.05 { "\u{2212}" } else { "" };
    let [x, y] = panel.at(share.max(0.0), middle);
    sheet.text([x + 5.0, y], &format!("{sign}{number} \u{b5}m"), LETTERS.sized(11.0))
}

fn frame(sheet: &Sheet, panel: &Panel) -> DrawResult {
    let [x, bottom] = panel.at(0.0, 0.0);
    let [_, top] = panel.at(0.0, panel.y[1]);
    sheet.line(&[[x, bottom], [x, top]], RGBColor(150, 150, 150), 0.8)?;
    let scale = Panel { y: [0.0, 1.0], ..*panel };
    scale.axes(sheet, AxisLabel::Named("share of the mean square (%)"), AxisLabel::Bare)
}

fn csv(parts: &[BudgetPart]) -> String {
    let mut csv = "part,x_mm2,y_mm2,z_mm2\n".to_owned();
    for BudgetPart { name, mean_square_mm2: PerAxis { x, y, z }, .. } in parts {
        csv += &format!("{},{x},{y},{z}\n", quoted(name));
    }
    csv
}
