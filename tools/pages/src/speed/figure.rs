//! The pictures of `docs/speed.md`: times of the peers, and growth with tiles and points.

use std::path::Path;

use plotters::coord::Shift;
use plotters::prelude::*;

use crate::style::restyle;

use super::growth::TimeAtCount;
use super::peers::SceneTimes;

/// Colours by Okabe and Ito, which colour-blind readers can distinguish. The marks differ too.
const COLOURS: [RGBColor; 3] = [RGBColor(0, 114, 178), RGBColor(213, 94, 0), RGBColor(0, 158, 115)];
const NAMES: [&str; 3] = ["magsplice", "magba", "magpylib"];

/// Draws one row of marks for each scene, with time along a logarithmic axis.
pub(crate) fn draw_peers(path: &Path, rows: &[SceneTimes]) -> Result<(), String> {
    let area = SVGBackend::new(path, (900, 380)).into_drawing_area();
    area.fill(&WHITE).map_err(|e| e.to_string())?;
    let text = |e: DrawingAreaErrorKind<_>| e.to_string();
    let last = rows.len() as f64;
    let mut chart = ChartBuilder::on(&area)
        .margin(14)
        .x_label_area_size(48)
        .y_label_area_size(210)
        .build_cartesian_2d((1.0..2000.0).log_scale(), -0.6..last - 0.4)
        .map_err(text)?;
    chart
        .configure_mesh()
        .disable_y_mesh()
        .x_desc("nanoseconds for a tile and a point, one thread")
        .y_labels(rows.len())
        .y_label_formatter(&|y| {
            let row = y.round();
            let exact = (y - row).abs() < 1e-6 && row >= 0.0 && row < last;
            if exact { rows[rows.len() - 1 - row as usize].name.to_owned() } else { String::new() }
        })
        .x_label_formatter(&|x| format!("{x}"))
        .label_style(("sans-serif", 15))
        .axis_desc_style(("sans-serif", 15))
        .light_line_style(BLACK.mix(0.06))
        .draw()
        .map_err(text)?;
    for (program, (colour, name)) in COLOURS.into_iter().zip(NAMES).enumerate() {
        let at = |(index, row): (usize, &SceneTimes)| row.ns[program].map(|ns| (ns, (rows.len() - 1 - index) as f64));
        let marks: Vec<(f64, f64)> = rows.iter().enumerate().filter_map(at).collect();
        if marks.is_empty() {
            continue;
        }
        let mark = move |program: usize, at: (f64, f64)| match program {
            0 => Circle::new(at, 7, colour.filled()).into_dyn(),
            1 => TriangleMarker::new(at, 8, colour.filled()).into_dyn(),
            _ => Cross::new(at, 6, colour.stroke_width(3)).into_dyn(),
        };
        let key = move |(x, y): (i32, i32)| match program {
            0 => Circle::new((x + 10, y), 6, colour.filled()).into_dyn(),
            1 => TriangleMarker::new((x + 10, y), 7, colour.filled()).into_dyn(),
            _ => Cross::new((x + 10, y), 5, colour.stroke_width(3)).into_dyn(),
        };
        chart.draw_series(marks.into_iter().map(|at| mark(program, at))).map_err(text)?.label(name).legend(key);
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerLeft)
        .background_style(WHITE.mix(0.85))
        .border_style(BLACK.mix(0.4))
        .label_font(("sans-serif", 15))
        .draw()
        .map_err(text)?;
    area.present().map_err(|e| e.to_string())?;
    drop(area);
    restyle(path, 96.0)
}

/// Draws two panels: time for a tile and a point by the numbers of tiles and of points.
pub(crate) fn draw_growth(path: &Path, tiles: &[TimeAtCount], points: &[TimeAtCount]) -> Result<(), String> {
    let area = SVGBackend::new(path, (900, 340)).into_drawing_area();
    area.fill(&WHITE).map_err(|e| e.to_string())?;
    let (left, right) = area.split_horizontally(450);
    panel(&left, "tiles, of different J", tiles, 1.0..2e4)?;
    panel(&right, "points, published film", points, 1.0..2e5)?;
    area.present().map_err(|e| e.to_string())?;
    drop(area);
    restyle(path, 96.0)
}

fn panel(
    area: &DrawingArea<SVGBackend, Shift>,
    axis: &str,
    growth: &[TimeAtCount],
    range: std::ops::Range<f64>,
) -> Result<(), String> {
    let text = |e: DrawingAreaErrorKind<_>| e.to_string();
    let mut chart = ChartBuilder::on(area)
        .margin(14)
        .x_label_area_size(48)
        .y_label_area_size(64)
        .build_cartesian_2d(range.log_scale(), (1.0..1000.0).log_scale())
        .map_err(text)?;
    chart
        .configure_mesh()
        .x_desc(axis)
        .y_desc("ns for a tile and a point")
        .x_label_formatter(&|x| format!("{x:.0e}"))
        .label_style(("sans-serif", 14))
        .axis_desc_style(("sans-serif", 15))
        .light_line_style(BLACK.mix(0.06))
        .draw()
        .map_err(text)?;
    let line: Vec<(f64, f64)> = growth.iter().map(|at| (at.count as f64, at.ns)).collect();
    chart.draw_series(LineSeries::new(line.iter().copied(), COLOURS[0].stroke_width(2))).map_err(text)?;
    chart.draw_series(line.into_iter().map(|p| Circle::new(p, 4, COLOURS[0].filled()))).map_err(text)?;
    Ok(())
}
