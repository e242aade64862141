//! Errors of films as made: histograms and empirical distributions of samples.

use magsplice::decouple::{Figure, Figures, Parameter};
use magsplice::magnet::Axis;

use crate::colours::{BLUE, VERMILION};
use crate::drawing::FigureDraft;
use crate::error::{DrawError, ReportError};
use crate::film_results::FilmSamples;
use crate::panel::{AxisLabel, BELOW_PX, LEFT_PX, Panel};
use crate::shared_ranges::SharedRanges;
use crate::sheet::{DrawResult, LETTERS, Sheet, rectangle, sheet};
use crate::typeset::{AXIS_NAMES, parameter, variable};
use plotters::prelude::RGBColor;

const SIDE_PX: f64 = 236.0;
const HISTOGRAM_PX: f64 = 120.0;
const DISTRIBUTION_PX: f64 = 150.0;
const TOP_PX: f64 = 58.0;
const BETWEEN_PX: f64 = 30.0;
/// Room at the left for the names of the vertical axes.
const MARGIN_PX: f64 = 8.0;

/// Colour of the bars of histograms.
const BARS: RGBColor = RGBColor(166, 206, 227);
/// Colour of guide lines.
const GUIDE: RGBColor = RGBColor(150, 150, 150);

/// Percentiles that are marked.
const MARKED: [f64; 3] = [0.5, 0.95, 0.99];

/// Number of rows of the CSV: quantiles at steps of a thousandth.
const QUANTILES: usize = 1001;

const UM_PER_MM: f64 = 1e3;

/// Which errors a figure shows.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum ErrorKind {
    /// Displacement RMSE along x, y, z, in um.
    Displacement,
    /// Uniformity RMSE of R_x, R_y, S_z, times a thousand.
    Uniformity,
}

impl ErrorKind {
    fn file(self) -> &'static str {
        match self {
            ErrorKind::Displacement => "made-displacement",
            ErrorKind::Uniformity => "made-uniformity",
        }
    }

    fn figure(self, axis: usize) -> Figure {
        match self {
            ErrorKind::Displacement => Figure::Displacement(Axis::ALL[axis]),
            ErrorKind::Uniformity => Figure::Uniformity(Parameter::ALL[axis]),
        }
    }

    fn name(self, axis: usize) -> String {
        match self {
            ErrorKind::Displacement => format!("displacement RMSE in {} (\u{b5}m)", variable(AXIS_NAMES[axis])),
            ErrorKind::Uniformity => format!("uniformity RMSE of {} (10\u{207b}\u{b3})", parameter(axis)),
        }
    }
}

/// The errors of one kind of samples.
struct Distributions {
    kind: ErrorKind,
    /// The samples along each axis in ascending order. None of an undefined uniformity.
    sorted: [Vec<f64>; 3],
    /// The film as it was ordered.
    nominal: [Option<f64>; 3],
}

/// The figure of the errors of one kind. There must be samples.
pub(crate) fn draft(kind: ErrorKind, samples: &FilmSamples, ranges: &SharedRanges) -> Result<FigureDraft, ReportError> {
    let of = |errors: &Figures, axis| errors.get(kind.figure(axis)).map(|value| UM_PER_MM * value);
    let sorted = [0, 1, 2].map(|axis| {
        let mut values: Vec<f64> = samples.errors.iter().filter_map(|errors| of(errors, axis)).collect();
        values.sort_by(f64::total_cmp);
        values
    });
    let errors = Distributions {
        kind,
        sorted,
        nominal: [0, 1, 2].map(|axis| of(&samples.found.figures.map(|of| of.nominal), axis)),
    };
    let error = match kind {
        ErrorKind::Displacement => "displacement RMSE",
        ErrorKind::Uniformity => "uniformity RMSE",
    };
    let caption = format!(
        "The {error} of films as made, with the errors of [tolerance]. Above: the number of films in ranges of equal \
         width. Below: the share of the films with a smaller error."
    );
    FigureDraft::new(kind.file(), caption, errors.draw(ranges), errors.csv())
}

/// The shares of films at which quantiles are drawn and written.
fn shares() -> impl Iterator<Item = f64> {
    (0..QUANTILES).map(|step| step as f64 / (QUANTILES - 1) as f64)
}

impl Distributions {
    fn draw(&self, ranges: &SharedRanges) -> Result<String, DrawError> {
        let width = MARGIN_PX + 3.0 * (LEFT_PX + SIDE_PX) + 16.0;
        let lower = TOP_PX + HISTOGRAM_PX + BETWEEN_PX;
        sheet([width, lower + DISTRIBUTION_PX + BELOW_PX + 8.0], |sheet| {
            legend(sheet, self.sorted.iter().map(Vec::len).max().unwrap_or(0))?;
            for axis in 0..3 {
                let (sorted, Some(nominal)) = (&self.sorted[axis], self.nominal[axis]) else { continue };
                let key = |what: &str| format!("{} {axis} {what}", self.kind.file());
                let x = ranges.widened(&key("x"), range(sorted, nominal));
                let left = MARGIN_PX + LEFT_PX + axis as f64 * (LEFT_PX + SIDE_PX);
                let counts = counts(sorted, x);
                let most = counts.iter().copied().max().unwrap_or(1) as f64;
                let [_, most] = ranges.widened(&key("films"), [0.0, most]);
                let upper = Panel { left, top: TOP_PX, width: SIDE_PX, height: HISTOGRAM_PX, x, y: [0.0, 1.08 * most] };
                bars(sheet, &upper, &counts)?;
                vertical(sheet, &upper, nominal, VERMILION, 1.8)?;
                let films = if axis == 0 { AxisLabel::Named("films") } else { AxisLabel::Named("") };
                upper.axes(sheet, AxisLabel::TicksOnly, films)?;
                upper.title(sheet, axis, "")?;
                let under = Panel { top: lower, height: DISTRIBUTION_PX, y: [0.0, 103.0], ..upper };
                for share in MARKED {
                    let value = quantile(sorted, share);
                    let [left, at] = under.at(x[0], 100.0 * share);
                    let [across, bottom] = under.at(value, 0.0);
                    sheet.line(&[[left, at], [across, at], [across, bottom]], GUIDE, 0.9)?;
                }
                let steps: Vec<[f64; 2]> =
                    shares().map(|share| under.at(quantile(sorted, share), 100.0 * share)).collect();
                sheet.line(&steps, BLUE, 1.6)?;
                vertical(sheet, &under, nominal, VERMILION, 1.8)?;
                let below = if axis == 0 { AxisLabel::Named("films below (%)") } else { AxisLabel::Named("") };
                under.axes(sheet, AxisLabel::Named(&self.kind.name(axis)), below)?;
                under.title(sheet, 3 + axis, "")?;
            }
            Ok(())
        })
    }

    /// Quantiles of the samples as CSV, in the units of the tables: mm, and numbers without unit.
    fn csv(&self) -> String {
        let names = match self.kind {
            ErrorKind::Displacement => "x_mm,y_mm,z_mm",
            ErrorKind::Uniformity => "r_x,r_y,s_z",
        };
        let mut csv = format!("share_below,{names}\n");
        for share in shares() {
            let cell = |sorted: &Vec<f64>| match sorted[..] {
                [] => String::new(),
                _ => (quantile(sorted, share) / UM_PER_MM).to_string(),
            };
            let [x, y, z] = self.sorted.each_ref().map(cell);
            csv += &format!("{share},{x},{y},{z}\n");
        }
        csv
    }
}

/// The value below which a share of the sorted values lies.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let place = share * (sorted.len() - 1) as f64;
    let below = place as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (place - below as f64) * (sorted[above] - sorted[below])
}

/// The range of an axis: all samples and the nominal film, with a margin.
fn range(sorted: &[f64], nominal: f64) -> [f64; 2] {
    let low = sorted.first().copied().unwrap_or(nominal).min(nominal);
    let high = sorted.last().copied().unwrap_or(nominal).max(nominal);
    let margin = if high > low { 0.04 * (high - low) } else { 0.1 * high.abs().max(1e-9) };
    [low - margin, high + margin]
}

/// Numbers of samples in bins of equal width over the range. Their number is the cube root rule of
/// Rice, twice the cube root of the number of samples.
fn counts(sorted: &[f64], [low, high]: [f64; 2]) -> Vec<usize> {
    let bins = ((2.0 * (sorted.len() as f64).cbrt()).round() as usize).clamp(5, 60);
    let mut counts = vec![0; bins];
    for value in sorted {
        let bin = ((value - low) / (high - low) * bins as f64) as usize;
        counts[bin.min(bins - 1)] += 1;
    }
    counts
}

fn bars(sheet: &Sheet, panel: &Panel, counts: &[usize]) -> DrawResult {
    let width = (panel.x[1] - panel.x[0]) / counts.len() as f64;
    for (bin, &count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
        let [left, right] = [bin, bin + 1].map(|edge| panel.x[0] + edge as f64 * width);
        sheet.shape(&rectangle(panel.at(left, 0.0), panel.at(right, count as f64)), BARS, BLUE, 0.6)?;
    }
    Ok(())
}

fn vertical(sheet: &Sheet, panel: &Panel, at: f64, colour: RGBColor, width: f64) -> DrawResult {
    let [x, bottom] = panel.at(at, panel.y[0]);
    sheet.line(&[[x, bottom], [x, panel.top]], colour, width)
}

/// Draws what the marks mean, above the panels.
fn legend(sheet: &Sheet, samples: usize) -> DrawResult {
    let (x, y) = (MARGIN_PX + LEFT_PX, 18.0);
    sheet.shape(&rectangle([x, y - 6.0], [x + 20.0, y + 6.0]), BARS, BLUE, 0.6)?;
    let films = if samples == 1 { "1 film as made".to_owned() } else { format!("{samples} films as made") };
    sheet.text([x + 28.0, y], &films, LETTERS)?;
    let lines = [
        (x + 230.0, VERMILION, 1.8, "film as ordered"),
        (x + 230.0 + 160.0, GUIDE, 0.9, "50, 95 and 99 % of the films"),
    ];
    for (x, colour, width, meaning) in lines {
        sheet.line(&[[x, y], [x + 24.0, y]], colour, width)?;
        sheet.text([x + 32.0, y], meaning, LETTERS)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_and_counts_are_those_of_the_values() {
        let sorted: Vec<f64> = (0..=100).map(f64::from).collect();
        assert_eq!([0.0, 0.5, 0.95, 1.0].map(|share| quantile(&sorted, share)), [0.0, 50.0, 95.0, 100.0]);
        assert_eq!(quantile(&[3.0], 0.95), 3.0);
        let range = range(&sorted, -5.0);
        assert!(range[0] <= -5.0 && range[1] > 100.0);
        assert_eq!(counts(&sorted, range).iter().sum::<usize>(), 101);
    }
}
