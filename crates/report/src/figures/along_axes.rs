//! Each decoupling parameter along its own axis, its spread over the two other axes, and the
//! straight line of the ideal film.

use magsplice::decouple::{Parameter, PlaneStatistics};
use plotters::prelude::RGBColor;

use crate::colours::{BLUE, VERMILION};
use crate::error::DrawError;
use crate::panel::{AxisLabel, BELOW_PX, LEFT_PX, Panel};
use crate::sheet::{LETTERS, sheet};
use crate::survey::{AgainstIdeal, Survey};
use crate::typeset::{self, AXIS_NAMES, symbol};

use super::parameter_maps::{names, value};

const SIDE_PX: f64 = 250.0;
const TOP_PX: f64 = 58.0;
const BAND: RGBColor = RGBColor(198, 221, 236);

/// A parameter over one plane normal to its axis, and its value for the ideal film.
struct ParameterPlane {
    at_mm: f64,
    over: PlaneStatistics,
    ideal: f64,
}

/// The figure as SVG; `None` if the layout has no ideal film.
pub(crate) fn draw(survey: &Survey) -> Option<Result<String, DrawError>> {
    let against = survey.against_ideal.as_ref()?;
    let rows: Vec<Vec<ParameterPlane>> = (0..3).map(|which| planes(survey, against, which)).collect();
    let step = SIDE_PX + LEFT_PX + 22.0;
    let size = [3.0 * step + 2.0, TOP_PX + SIDE_PX + BELOW_PX + 6.0];
    let uniformity = against.decoupling.uniformity_rmse;
    let uniformity = [uniformity.r_x, uniformity.r_y, uniformity.s_z];
    Some(sheet(size, |sheet| {
        let legend = [LEFT_PX + 6.0, 14.0];
        sheet.line(&[legend, [legend[0] + 26.0, legend[1]]], VERMILION, 1.8)?;
        sheet.text([legend[0] + 34.0, legend[1]], "ideal film", LETTERS)?;
        let (left, right) = (legend[0] + 124.0, legend[0] + 150.0);
        sheet.disc([0.5 * (left + right), legend[1]], 3.0, BLUE)?;
        sheet.line(&[[0.5 * (left + right), legend[1] - 9.0], [0.5 * (left + right), legend[1] + 9.0]], BLUE, 1.4)?;
        sheet.text([right + 4.0, legend[1]], "mean over the two other axes, \u{b1} standard deviation", LETTERS)?;
        let (left, right) = (legend[0] + 490.0, legend[0] + 516.0);
        let (up, down) = (legend[1] - 7.0, legend[1] + 7.0);
        sheet.fill(&[[left, up], [right, up], [right, down], [left, down]], BAND)?;
        sheet.text([right + 8.0, legend[1]], "minimum to maximum", LETTERS)?;
        for (which, planes) in rows.iter().enumerate() {
            let values = planes.iter().flat_map(|ParameterPlane { over, ideal, .. }| {
                [over.least, over.most, over.mean - over.deviation, over.mean + over.deviation, *ideal]
            });
            let panel = Panel {
                left: LEFT_PX + 6.0 + which as f64 * step,
                top: TOP_PX,
                width: SIDE_PX,
                height: SIDE_PX,
                x: padded(planes.iter().map(|p| p.at_mm)),
                y: padded(values),
            };
            let upper = planes.iter().map(|p| panel.at(p.at_mm, p.over.most));
            let lower = planes.iter().rev().map(|p| panel.at(p.at_mm, p.over.least));
            sheet.fill(&upper.chain(lower).collect::<Vec<_>>(), BAND)?;
            let line: Vec<[f64; 2]> = planes.iter().map(|p| panel.at(p.at_mm, p.ideal)).collect();
            sheet.line(&line, VERMILION, 1.8)?;
            let mean: Vec<[f64; 2]> = planes.iter().map(|p| panel.at(p.at_mm, p.over.mean)).collect();
            sheet.line(&mean, BLUE, 0.8)?;
            let radius = (0.12 * SIDE_PX / planes.len() as f64).clamp(0.6, 3.0);
            for p in planes {
                let [x, y] = panel.at(p.at_mm, p.over.mean);
                let reach = p.over.deviation / (panel.y[1] - panel.y[0]) * panel.height;
                sheet.line(&[[x, y - reach], [x, y + reach]], BLUE, 0.5 * radius)?;
                for end in [y - reach, y + reach] {
                    sheet.line(&[[x - radius, end], [x + radius, end]], BLUE, 0.5 * radius)?;
                }
                sheet.disc([x, y], radius, BLUE)?;
            }
            panel.axes(sheet, AxisLabel::Coordinate(AXIS_NAMES[which]), AxisLabel::Named(&names()[which]))?;
            let parameter = [symbol("R", "x"), symbol("R", "y"), symbol("S", "z")];
            let title = format!("uniformity RMSE of {}: {}", parameter[which], rounded(uniformity[which]));
            panel.title(sheet, &title)?;
        }
        Ok(())
    }))
}

/// The planes normal to the axis of a parameter that have at least one regular point.
fn planes(survey: &Survey, against: &AgainstIdeal, which: usize) -> Vec<ParameterPlane> {
    let grid = &survey.volume.grid;
    let spliced = against.decoupling.plane_statistics(Parameter::ALL[which]).into_iter().enumerate();
    spliced
        .filter_map(|(index, over)| {
            let at_mm = grid.coordinate(which, index);
            let ideal = against.ideal_on_axis(survey.volume.reference_mm.z, which, at_mm)?;
            Some(ParameterPlane { at_mm, over: over?, ideal: value(&ideal, which) })
        })
        .collect()
}

/// A number with four decimals, or with three digits where four decimals would not show it.
fn rounded(value: f64) -> String {
    if value == 0.0 || value >= 1e-2 {
        return format!("{value:.4}");
    }
    typeset::number(format!("{value:.2e}").parse().unwrap_or(value))
}

/// The range of the values with a margin. It is never empty.
fn padded(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    if low > high {
        return [0.0, 1.0];
    }
    let margin = if high > low { 0.06 * (high - low) } else { 0.1 * high.abs().max(1.0) };
    [low - margin, high + margin]
}
