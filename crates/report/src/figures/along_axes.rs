//! Each decoupling parameter along its own axis, its spread over the two other axes, and the
//! straight line of the ideal film; below each the residual as a displacement.

use magsplice::decouple::{Parameter, PlaneResidual, PlaneStatistics};
use plotters::prelude::RGBColor;

use crate::colours::{BLUE, VERMILION};
use crate::csv::csv;
use crate::drawing::FigureDraft;
use crate::error::{DrawError, ReportError};
use crate::panel::{AxisLabel, BELOW_PX, LEFT_PX, Panel, padded};
use crate::shared_ranges::SharedRanges;
use crate::sheet::{DrawResult, LETTERS, Sheet, rectangle, sheet};
use crate::survey::{AgainstIdeal, Survey};
use crate::typeset::{self, AXIS_NAMES, PARAMETER_NAMES, parameter, variable};

use super::parameter_maps::name;

const CAPTION: &str = "Each decoupling parameter along its own axis, the straight line of the ideal film, and the spread \
    of the parameter over the two other axes, on which it should not depend. Below: the displacement from the reference \
    point that the parameter shows, minus the true displacement.";

const SIDE_PX: f64 = 250.0;
/// Height of the panels of residuals, and their distance from the panels above, in pixels.
const RESIDUAL_PX: f64 = 120.0;
const BETWEEN_PX: f64 = 28.0;
const TOP_PX: f64 = 78.0;
/// Distance of the note from the legend above it, in pixels.
const NOTE_PX: f64 = 22.0;
/// Distance of neighbouring panels beside the numbers of their axes, in pixels.
const ASIDE_PX: f64 = 28.0;
const BAND: RGBColor = RGBColor(198, 221, 236);
const UM_PER_MM: f64 = 1e3;

/// A parameter over one plane normal to its axis, and its value for the ideal film.
struct ParameterPlane {
    at_mm: f64,
    over: PlaneStatistics,
    ideal: f64,
}

/// The parameters of all planes, and the same as displacements.
struct AlongAxes {
    values: [Vec<ParameterPlane>; 3],
    /// Displacement that the parameter shows, from the reference point, minus the true one, in um.
    residuals_um: [Vec<ParameterPlane>; 3],
    uniformity_rmse: [Option<f64>; 3],
}

/// The figure of the film against the ideal film.
pub(crate) fn draft(
    survey: &Survey,
    against: &AgainstIdeal,
    ranges: &SharedRanges,
) -> Result<FigureDraft, ReportError> {
    let values = [0, 1, 2].map(|which| planes(survey, against, which));
    let residuals =
        against.decoupling.residuals(&survey.volume.grid, survey.volume.reference_mm, against.film.wavenumber());
    let residuals_um = [residuals.x, residuals.y, residuals.z].map(|of| residuals_um(&of));
    let along = AlongAxes { values, residuals_um, uniformity_rmse: against.decoupling.uniformity_rmse.to_array() };
    FigureDraft::new("parameters-along-axes", CAPTION, along.draw(ranges), along.csv())
}

impl AlongAxes {
    fn draw(&self, ranges: &SharedRanges) -> Result<String, DrawError> {
        let step = SIDE_PX + LEFT_PX + ASIDE_PX;
        let lower = TOP_PX + SIDE_PX + BETWEEN_PX;
        let size = [3.0 * step + 8.0, lower + RESIDUAL_PX + BELOW_PX + 6.0];
        sheet(size, |sheet| {
            legend(sheet)?;
            for (which, axis) in AXIS_NAMES.into_iter().enumerate() {
                let left = LEFT_PX + 12.0 + which as f64 * step;
                let (values, residuals) = (&self.values[which], &self.residuals_um[which]);
                let shared = |what: &str, range: [f64; 2]| ranges.widened(&format!("along {which} {what}"), range);
                let x = shared("x", padded(values.iter().map(|plane| plane.at_mm)));
                let y = shared("value", padded(all_values(values)));
                let upper = Panel { left, top: TOP_PX, width: SIDE_PX, height: SIDE_PX, x, y };
                draw_planes(sheet, &upper, values)?;
                upper.axes(sheet, AxisLabel::TicksOnly, AxisLabel::Named(&name(which)))?;
                let rmse = self.uniformity_rmse[which].map_or("one point".to_owned(), rounded);
                upper.title(sheet, which, &format!("uniformity RMSE of {}: {rmse}", parameter(which)))?;
                let y = shared("residual", padded(all_values(residuals)));
                let under = Panel { top: lower, height: RESIDUAL_PX, y, ..upper };
                draw_planes(sheet, &under, residuals)?;
                under.title(sheet, 3 + which, "")?;
                let residual = format!("\u{394}{} (\u{b5}m)", variable(axis));
                under.axes(sheet, AxisLabel::Coordinate(axis), AxisLabel::Named(&residual))?;
            }
            Ok(())
        })
    }

    /// The planes as CSV.
    fn csv(&self) -> String {
        let of = |s: &PlaneStatistics| [s.mean, s.deviation.unwrap_or(f64::NAN), s.least, s.most];
        let rows = PARAMETER_NAMES.into_iter().zip(self.values.iter().zip(&self.residuals_um)).flat_map(
            |(name, (values, residuals_um))| {
                values.iter().zip(residuals_um).map(move |(value, residual)| {
                    let numbers = [value.at_mm].into_iter().chain(of(&value.over)).chain([value.ideal]);
                    (format!("{name},"), numbers.chain(of(&residual.over)))
                })
            },
        );
        csv(
            "parameter,at_mm,value_mean,value_deviation,value_least,value_most,value_ideal,residual_mean_um,\
             residual_deviation_um,residual_least_um,residual_most_um",
            rows,
        )
    }
}

/// Draws what the marks mean, above the panels.
fn legend(sheet: &Sheet) -> DrawResult {
    let at = [LEFT_PX + 12.0, 14.0];
    sheet.line(&[at, [at[0] + 26.0, at[1]]], VERMILION, 1.8)?;
    sheet.text([at[0] + 34.0, at[1]], "ideal film", LETTERS)?;
    let (left, right) = (at[0] + 124.0, at[0] + 150.0);
    let middle = 0.5 * (left + right);
    sheet.disc([middle, at[1]], 3.0, BLUE)?;
    sheet.line(&[[middle, at[1] - 9.0], [middle, at[1] + 9.0]], BLUE, 1.4)?;
    for end in [at[1] - 9.0, at[1] + 9.0] {
        sheet.line(&[[middle - 4.0, end], [middle + 4.0, end]], BLUE, 1.4)?;
    }
    sheet.text([right + 4.0, at[1]], "mean over the two other axes, \u{b1} standard deviation", LETTERS)?;
    let (left, right) = (at[0] + 530.0, at[0] + 556.0);
    let (up, down) = (at[1] - 7.0, at[1] + 7.0);
    sheet.fill(&rectangle([left, up], [right, down]), BAND)?;
    sheet.text([right + 8.0, at[1]], "minimum to maximum", LETTERS)?;
    let note = format!(
        "\u{394}: displacement that the parameter shows, minus the true displacement. An offset of {} is the logarithm of the \
         amplitude, and shows no displacement.",
        parameter(2)
    );
    sheet.text([at[0], at[1] + NOTE_PX], &note, LETTERS)
}

/// Every value that a panel must show.
fn all_values(planes: &[ParameterPlane]) -> impl Iterator<Item = f64> {
    planes.iter().flat_map(|ParameterPlane { over, ideal, .. }| {
        let deviation = over.deviation.unwrap_or_default();
        [over.least, over.most, over.mean - deviation, over.mean + deviation, *ideal]
    })
}

/// Draws the band from minimum to maximum, the line of the ideal film, and the means.
fn draw_planes(sheet: &Sheet, panel: &Panel, planes: &[ParameterPlane]) -> DrawResult {
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
        if let Some(deviation) = p.over.deviation {
            let reach = deviation / (panel.y[1] - panel.y[0]) * panel.height;
            sheet.line(&[[x, y - reach], [x, y + reach]], BLUE, 0.5 * radius)?;
            for end in [y - reach, y + reach] {
                sheet.line(&[[x - radius, end], [x + radius, end]], BLUE, 0.5 * radius)?;
            }
        }
        sheet.disc([x, y], radius, BLUE)?;
    }
    Ok(())
}

/// The planes normal to the axis of a parameter that have at least one regular point.
fn planes(survey: &Survey, against: &AgainstIdeal, which: usize) -> Vec<ParameterPlane> {
    let grid = &survey.volume.grid;
    let spliced = against.decoupling.plane_statistics(Parameter::ALL[which]).into_iter().enumerate();
    spliced
        .filter_map(|(index, over)| {
            let at_mm = grid.coordinate(which, index);
            let ideal = against.ideal_on_axis(survey.volume.reference_mm.z, which, at_mm)?;
            Some(ParameterPlane { at_mm, over: over?, ideal: ideal.get(Parameter::ALL[which]) })
        })
        .collect()
}

/// The residuals of the displacements along an axis, in um. The ideal film has none.
fn residuals_um(residuals: &[PlaneResidual]) -> Vec<ParameterPlane> {
    let residual = |PlaneResidual { at_mm, over_mm }: &PlaneResidual| {
        let over = PlaneStatistics {
            mean: UM_PER_MM * over_mm.mean,
            deviation: over_mm.deviation.map(|deviation| UM_PER_MM * deviation),
            least: UM_PER_MM * over_mm.least,
            most: UM_PER_MM * over_mm.most,
        };
        ParameterPlane { at_mm: *at_mm, over, ideal: 0.0 }
    };
    residuals.iter().map(residual).collect()
}

/// A number with four decimals, or with three digits where four decimals would not show it.
fn rounded(value: f64) -> String {
    if value == 0.0 || value >= 1e-2 {
        return format!("{value:.4}");
    }
    typeset::rounded(value, 2)
}
