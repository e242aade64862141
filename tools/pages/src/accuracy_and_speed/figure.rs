//! The picture of time for a point against error, one panel for each scene.

use std::path::Path;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::style::restyle;

use super::marks::{colour, mark};
use super::measure::{Contender, Measured, MeasuredScene};
use super::pareto::pareto_front;

/// Size in pixels, twice as large as shown, because plotters draws at whole pixels only.
const SIZE: (u32, u32) = (2000, 1900);
const LEGEND: i32 = 150;

const LEAST_ERROR: f64 = 1e-16;
const LARGEST_ERROR: f64 = 1e-1;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

pub(crate) fn draw(path: &Path, scenes: &[MeasuredScene]) -> Result<(), String> {
    let area = SVGBackend::new(path, SIZE).into_drawing_area();
    area.fill(&WHITE).map_err(|e| e.to_string())?;
    let (legend, below) = area.split_vertically(LEGEND);
    draw_legend(&legend)?;
    for (area, (panel, letter)) in below.split_evenly((2, 2)).iter().zip(scenes.iter().zip('a'..)) {
        draw_panel(area, panel, letter)?;
    }
    area.present().map_err(|e| e.to_string())?;
    drop(area);
    restyle(path, 192.0)
}

fn draw_legend(area: &Area) -> Result<(), String> {
    let failed = |e: DrawingAreaErrorKind<_>| e.to_string();
    let style = |size: i32| ("sans-serif", size).into_font().color(&BLACK).pos(Pos::new(HPos::Left, VPos::Center));
    let write = |text: &str, x: i32, y: i32| area.draw(&Text::new(text.to_owned(), (x, y), style(30))).map_err(failed);
    for (contender, x) in Contender::ALL.into_iter().zip([90, 330, 570, 920, 1190, 1430]) {
        area.draw(&mark(contender, (x, 42), true)).map_err(failed)?;
        write(contender.name(), x + 32, 42)?;
    }
    area.draw(&PathElement::new([(60, 104), (120, 104)], FRONT.stroke_width(12))).map_err(failed)?;
    write("Pareto front", 140, 104)?;
    area.draw(&PathElement::new([(400, 104), (450, 104)], colour(Contender::Grid).stroke_width(5))).map_err(failed)?;
    area.draw(&mark(Contender::Grid, (450, 104), true)).map_err(failed)?;
    write(
        "largest error, with a bar from the median error; thin lines join the notches; hollow: the second place named",
        482,
        104,
    )
}

const FRONT: RGBColor = RGBColor(205, 205, 205);

fn draw_panel(area: &Area, panel: &MeasuredScene, letter: char) -> Result<(), String> {
    let failed = |e: DrawingAreaErrorKind<_>| e.to_string();
    let all: Vec<&Measured> = panel.measurements.iter().flat_map(|at| &at.measured).filter(|m| is_shown(m)).collect();
    let fastest = all.iter().map(|m| m.ns).fold(f64::INFINITY, f64::min);
    let slowest = all.iter().map(|m| m.ns).fold(0.0, f64::max);
    let range = 10_f64.powf((fastest / 1.6).log10().floor())..10_f64.powf((1.6 * slowest).log10().ceil());
    let mut chart = ChartBuilder::on(area)
        .caption(format!("({letter}) {}", caption(panel)), ("sans-serif", 32))
        .margin(20)
        .margin_right(40)
        .x_label_area_size(90)
        .y_label_area_size(130)
        .build_cartesian_2d((LEAST_ERROR..LARGEST_ERROR).log_scale(), range.clone().log_scale())
        .map_err(failed)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .x_desc("relative error of |B|")
        .y_desc("time for a point, one thread")
        .x_labels(9)
        .y_labels(10)
        .x_label_formatter(&|x| format!("{x:.0e}"))
        .y_label_formatter(&|ns| time(*ns))
        .label_style(("sans-serif", 26))
        .axis_desc_style(("sans-serif", 30))
        .draw()
        .map_err(failed)?;
    let drawn = |e: f64| e.clamp(LEAST_ERROR, LARGEST_ERROR);
    for at in &panel.measurements {
        chart
            .draw_series([PathElement::new(stairs(&pareto_front(at, |m| m.worst), range.end), FRONT.stroke_width(12))])
            .map_err(failed)?;
    }
    let plane = chart.plotting_area();
    for (at, filled) in panel.measurements.iter().zip([true, false]) {
        for contender in Contender::ALL {
            let notches = at.measured_by(contender).filter(|m| is_shown(m)).map(|m| (drawn(m.worst), m.ns));
            let style = colour(contender).mix(0.35).stroke_width(3);
            plane.draw(&PathElement::new(notches.collect::<Vec<_>>(), style)).map_err(failed)?;
        }
        for m in at.measured.iter().filter(|m| is_shown(m)) {
            let line = [(drawn(m.median), m.ns), (drawn(m.worst), m.ns)];
            plane.draw(&PathElement::new(line, colour(m.contender).mix(0.75).stroke_width(4))).map_err(failed)?;
        }
        for m in at.measured.iter().filter(|m| is_shown(m)) {
            let (x, y) = plane.map_coordinate(&(drawn(m.worst), m.ns));
            let origin = area.get_pixel_range();
            area.draw(&mark(m.contender, (x - origin.0.start, y - origin.1.start), filled)).map_err(failed)?;
        }
    }
    Ok(())
}

/// Whether a contender is drawn: it computes more than half of the points.
fn is_shown(m: &Measured) -> bool {
    m.refused < 0.5
}

fn caption(panel: &MeasuredScene) -> String {
    let places: Vec<&str> = panel.scene.places.iter().map(|place| place.name).collect();
    format!("{}, {}", panel.scene.title, places.join(" and "))
}

/// The staircase below all contenders, from the smallest to the largest error.
fn stairs(front: &[&Measured], slowest: f64) -> Vec<(f64, f64)> {
    let mut line = Vec::new();
    let mut ns = slowest;
    for m in front {
        let x = m.worst.clamp(LEAST_ERROR, LARGEST_ERROR);
        line.extend([(x, ns), (x, m.ns)]);
        ns = m.ns;
    }
    line.push((LARGEST_ERROR, ns));
    line
}

fn time(ns: f64) -> String {
    match ns.log10().round() as i32 {
        ..3 => format!("{ns:.0} ns"),
        3..6 => format!("{:.0} µs", ns / 1e3),
        6..9 => format!("{:.0} ms", ns / 1e6),
        _ => format!("{:.0} s", ns / 1e9),
    }
}
