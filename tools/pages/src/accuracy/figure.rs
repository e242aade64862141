//! The picture of `docs/accuracy.md`: error by distance and by closeness to an edge.

use std::path::Path;

use plotters::coord::Shift;
use plotters::prelude::*;

use crate::style::restyle;

use super::curves::ErrorsAtDistance;

/// Colours by Okabe and Ito, which colour-blind readers can distinguish. The marks differ too.
const COLOURS: [RGBColor; 4] =
    [RGBColor(0, 114, 178), RGBColor(213, 94, 0), RGBColor(0, 158, 115), RGBColor(86, 180, 233)];
const NAMES: [&str; 4] = ["magsplice", "magba", "magpylib", "magsplice, gradient"];

const LOWEST: f64 = 1e-17;
/// Upper end of the axis: an error of 1 has no correct digit. Larger errors and NaN are drawn on
/// the upper edge.
const HIGHEST: f64 = 1e2;

pub(crate) fn draw(path: &Path, distance: &[ErrorsAtDistance], closeness: &[ErrorsAtDistance]) -> Result<(), String> {
    let area = SVGBackend::new(path, (1080, 460)).into_drawing_area();
    area.fill(&WHITE).map_err(|e| e.to_string())?;
    let (left, right) = area.split_horizontally(540);
    panel(&left, "Far away", "distance from the tile, in sizes", distance, 1.0..1e9, true)?;
    panel(&right, "Close to an edge", "distance from the edge, in sizes", closeness, 1e-16..1e-1, false)?;
    area.present().map_err(|e| e.to_string())?;
    drop(area);
    restyle(path, 96.0)
}

fn panel(
    area: &DrawingArea<SVGBackend, Shift>,
    title: &str,
    axis: &str,
    curve: &[ErrorsAtDistance],
    range: std::ops::Range<f64>,
    legend: bool,
) -> Result<(), String> {
    let text = |e: DrawingAreaErrorKind<_>| e.to_string();
    let mut chart = ChartBuilder::on(area)
        .caption(title, ("sans-serif", 18))
        .margin(12)
        .x_label_area_size(46)
        .y_label_area_size(64)
        .build_cartesian_2d(range.log_scale(), (LOWEST..HIGHEST).log_scale())
        .map_err(text)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .x_desc(axis)
        .y_desc("worst relative error")
        .x_labels(9)
        .y_labels(10)
        .x_label_formatter(&|x| format!("{x:.0e}"))
        .y_label_formatter(&|y| format!("{y:.0e}"))
        .label_style(("sans-serif", 13))
        .axis_desc_style(("sans-serif", 15))
        .draw()
        .map_err(text)?;
    for (series, (colour, name)) in COLOURS.into_iter().zip(NAMES).enumerate() {
        let value =
            |at: &ErrorsAtDistance| if series == 3 { Some(at.gradient) } else { at.fields.get(series).copied() };
        let drawn = |e: f64| e.clamp(LOWEST, HIGHEST);
        let points: Vec<(f64, f64)> = curve.iter().filter_map(|at| Some((at.distance, drawn(value(at)?)))).collect();
        if points.is_empty() {
            continue;
        }
        chart
            .draw_series(LineSeries::new(points.iter().copied(), colour.stroke_width(2)))
            .map_err(text)?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 22, y)], colour.stroke_width(3)));
        marks(&mut chart, series, &points, colour)?;
    }
    if legend {
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperLeft)
            .background_style(WHITE.mix(0.85))
            .border_style(BLACK.mix(0.4))
            .label_font(("sans-serif", 14))
            .draw()
            .map_err(text)?;
    }
    Ok(())
}

type Chart<'a> = ChartContext<
    'a,
    SVGBackend<'a>,
    Cartesian2d<plotters::coord::combinators::LogCoord<f64>, plotters::coord::combinators::LogCoord<f64>>,
>;

/// Draws one kind of mark for each series, to distinguish them without colour.
fn marks(chart: &mut Chart, series: usize, points: &[(f64, f64)], colour: RGBColor) -> Result<(), String> {
    let points = points.iter().copied();
    match series {
        0 => chart.draw_series(points.map(|p| Circle::new(p, 3, colour.filled()))).map(|_| ()),
        1 => chart.draw_series(points.map(|p| TriangleMarker::new(p, 5, colour.filled()))).map(|_| ()),
        2 => chart.draw_series(points.map(|p| Cross::new(p, 4, colour.stroke_width(2)))).map(|_| ()),
        _ => chart.draw_series(points.map(|p| Circle::new(p, 3, colour.stroke_width(1)))).map(|_| ()),
    }
    .map_err(|e| e.to_string())
}
