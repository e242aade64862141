//! The picture of time by the number of tiles, with as many points.

use std::path::Path;

use magsplice_benches::Growth;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::style::restyle;

use super::marks::{RADIUS, colour};
use super::measure::Contender;

/// Size in pixels, twice as large as shown.
const SIZE: (u32, u32) = (1500, 1000);

const MIDDLE: Pos = Pos { h_pos: HPos::Left, v_pos: VPos::Center };

pub(crate) fn draw(path: &Path, films: &[Growth]) -> Result<(), String> {
    let failed = |e: DrawingAreaErrorKind<_>| e.to_string();
    let area = SVGBackend::new(path, SIZE).into_drawing_area();
    area.fill(&WHITE).map_err(|e| e.to_string())?;
    let [first, last] = [films.first(), films.last()].map(|film| film.expect("films"));
    let counts = first.tiles as f64 / 1.5..last.tiles as f64 * 2.5;
    let decade = |s: f64| 10_f64.powf(s.log10());
    let seconds = decade(first.again_s.min(first.exact_s) / 3.0)..decade(last.exact_s * 3.0);
    let mut chart = ChartBuilder::on(&area)
        .margin(24)
        .x_label_area_size(90)
        .y_label_area_size(130)
        .build_cartesian_2d(counts.log_scale(), seconds.log_scale())
        .map_err(failed)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .x_desc("tiles, and as many points")
        .y_desc("seconds, one thread")
        .x_labels(6)
        .x_label_formatter(&|x| format!("{x:.0e}"))
        .y_label_formatter(&|s| format!("{s:.0e}"))
        .label_style(("sans-serif", 26))
        .axis_desc_style(("sans-serif", 30))
        .draw()
        .map_err(failed)?;
    let start = first.everything_s();
    for (power, name, dashes) in [(1.0, "N", 4), (1.2, "N¹·²", 14)] {
        let at = |film: &Growth| (film.tiles as f64, start * (film.tiles as f64 / first.tiles as f64).powf(power));
        let style = RGBColor(120, 120, 120).stroke_width(3);
        chart.draw_series(DashedLineSeries::new([at(first), at(last)], dashes, 10, style)).map_err(failed)?;
        let (x, y) = at(last);
        let label = Text::new(name, (1.2 * x, y), ("sans-serif", 28).into_font().color(&BLACK).pos(MIDDLE));
        chart.draw_series([label]).map_err(failed)?;
    }
    type Curve = (&'static str, fn(&Growth) -> f64, RGBColor);
    let curves: [Curve; 3] = [
        ("exact", |film| film.exact_s, colour(Contender::Exact)),
        ("within 1e-6, everything", Growth::everything_s, colour(Contender::Magba)),
        ("within 1e-6, evaluated again", |film| film.again_s, colour(Contender::Grid)),
    ];
    for (name, time, colour) in curves {
        let points: Vec<(f64, f64)> = films.iter().map(|film| (film.tiles as f64, time(film))).collect();
        chart
            .draw_series(LineSeries::new(points.iter().copied(), colour.stroke_width(5)))
            .map_err(failed)?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 50, y)], colour.stroke_width(6)));
        for (film, at) in films.iter().zip(points) {
            let scaled = name == "exact" && film.exact_points < film.tiles;
            let inside = if scaled { WHITE.filled() } else { colour.filled() };
            chart.draw_series([Circle::new(at, RADIUS, inside)]).map_err(failed)?;
            chart.draw_series([Circle::new(at, RADIUS, colour.stroke_width(4))]).map_err(failed)?;
        }
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .margin(24)
        .legend_area_size(70)
        .background_style(WHITE.filled())
        .border_style(BLACK.mix(0.3))
        .label_font(("sans-serif", 28))
        .draw()
        .map_err(failed)?;
    area.present().map_err(|e| e.to_string())?;
    drop(area);
    restyle(path, 192.0)
}
