//! Statistics of samples as tables.

use std::fmt::Write;

use magsplice::Film;
use magsplice::decouple::Figure;
use magsplice::layout::{CommonErrors, Distribution, FilmPose, FilmTolerance, SensorErrors};
use magsplice::magnet::{Axis, DirectionError, PerTileError, TileError};
use magsplice::making::Sorting;
use magsplice::results::{SampleRun, SampledFigure, SampledFilm, twelve_digits};
use magsplice::tolerance::{Estimate, Statistics};

use crate::text::number::counted;
use crate::text::rows::{Column, left, right};
use crate::text::units::{in_deg, in_per_cent};
use crate::text::{header, rows};

/// The report of `tolerance`.
pub(super) fn sampled(film: &Film, result: &SampledFilm) -> String {
    header::with_recoil(film) + &samples(film, result)
}

/// The statistics of the samples of a film, without the layout.
pub(crate) fn samples(film: &Film, result: &SampledFilm) -> String {
    let mut text = format!("{}\n", in_words(&result.run));
    if let Some(tolerance) = &film.layout().tolerance {
        text += &tile_errors(tolerance);
        text += &other_errors(tolerance);
    }
    if let Some(sorting) = &result.sorting {
        rows::prose(&mut text, &sorted_in_words(sorting));
    }
    if let Some(depth_mm) = result.overlap_mm.filter(|depth_mm| *depth_mm > 0.0) {
        let overlap = format!(
            "tiles of the first samples overlap by up to {depth_mm:.2} mm. Errors of neighbours are independent here; \
             placed tiles push each other aside. Gaps that are larger by this depth avoid it"
        );
        rows::prose(&mut text, &overlap);
    }
    if let Some(depth_mm) = result.in_iron_mm.filter(|depth_mm| *depth_mm > 0.0) {
        let in_iron = format!(
            "tiles of the first samples reach up to {depth_mm:.2} mm into the iron. Tiles placed on a plate do not: give \
             smaller errors of position_mm and rotation_deg across it, in [tolerance]"
        );
        rows::prose(&mut text, &in_iron);
    }
    text.push('\n');
    let names = ["", "nominal", "mean", "P50", "P95", "P99", "P95 is within"].map(str::to_owned);
    let mut table = vec![names];
    for (figure, sampled) in result.figures.iter().filter(|(figure, _)| *figure != Figure::Amplitude) {
        table.push(row(figure, sampled));
    }
    text += &rows::table(&COLUMNS, &table);
    let SampledFigure { nominal, statistics } = &result.figures.amplitude;
    let names = ["", "nominal", "mean", "P50", "P5", "P1", "P5 is within"].map(str::to_owned);
    let values = [*nominal, statistics.mean.value, statistics.p50.value, statistics.p5.value, statistics.p1.value];
    let [nominal, mean, p50, p5, p1] = values.map(number);
    text.push('\n');
    let values = ["amplitude".to_owned(), nominal, mean, p50, p5, p1, interval(&statistics.p5)];
    text += &rows::table(&COLUMNS, &[names, values]);
    text.push('\n');
    text += &match result.yield_made {
        Some(share) => {
            let [value, low, high] = [share.value, share.interval[0], share.interval[1]].map(in_per_cent);
            format!("yield: {value:.1} % of the films meet all bounds of [expect.made] ({low:.1} .. {high:.1} %)\n")
        }
        None => "yield: none, because the layout has no [expect.made] table with bounds of films as made\n".to_owned(),
    };
    let statistics = result.figures.iter().filter_map(|(_, sampled)| sampled.map(|sampled| &sampled.statistics));
    let mut ends = statistics.flat_map(|statistics| [statistics.p95, statistics.p5]).flat_map(|shown| shown.interval);
    if ends.any(|end| !end.is_finite()) {
        let _ = writeln!(
            text,
            "unknown: {} are too few for this end; at least {} are needed, such as --samples 1000",
            counted(result.run.count as usize, "sample", "samples"),
            Statistics::SAMPLES_OF_P95
        );
    }
    text += "intervals hold with 95 % confidence\n";
    text
}

/// How tiles are sorted.
fn sorted_in_words(sorting: &Sorting) -> String {
    let measurement = &sorting.measurement;
    let percent = twelve_digits(in_per_cent(measurement.strength));
    let degrees = twelve_digits(in_deg(measurement.direction_rad));
    let sides = match measurement.size_mm {
        Some(size_mm) => format!("sides to {size_mm} mm"),
        None => "sides not measured".to_owned(),
    };
    let over = if sorting.settings.may_turn_over { "" } else { ", none turned over" };
    format!(
        "tiles are measured and sorted before they are placed: {}{over}; strength measured to {percent} %, direction to \
         {degrees} deg, {sides}",
        counted(sorting.spares, "spare tile", "spare tiles")
    )
}

/// The number of samples in words, for the header of the text.
fn in_words(run: &SampleRun) -> String {
    let samples = counted(run.count as usize, "sample", "samples");
    let SampleRun { seed, first, count, .. } = run;
    match (first, count) {
        (0, _) => format!("{samples}, seed {seed}"),
        (first, 1) => format!("sample {first}, seed {seed}"),
        (first, count) => format!("{samples}, {first} to {}, seed {seed}", first + count - 1),
    }
}

/// Columns of both tables, so that their numbers stand below each other.
const COLUMNS: [Column; 7] = {
    let number = right(9).growing().after(2);
    [left(26).growing(), number, number, number, number, number, number]
};

fn row(figure: Figure, sampled: Option<&SampledFigure>) -> [String; 7] {
    let name = match figure {
        Figure::Uniformity(parameter) => {
            format!("uniformity RMSE of {}", ["R_x", "R_y", "S_z"][parameter.axis().index()])
        }
        Figure::Displacement(axis) => format!("displacement RMSE, {axis}, mm"),
        Figure::Amplitude => "amplitude".to_owned(),
    };
    let Some(SampledFigure { nominal, statistics }) = sampled else {
        // Planes with a single point have no uniformity.
        let none = String::new();
        return [name, "one point".to_owned(), none.clone(), none.clone(), none.clone(), none.clone(), none];
    };
    let values = [*nominal, statistics.mean.value, statistics.p50.value, statistics.p95.value, statistics.p99.value];
    let [nominal, mean, p50, p95, p99] = values.map(number);
    [name, nominal, mean, p50, p95, p99, interval(&statistics.p95)]
}

/// Three significant digits beyond the point for statistics of samples, four for an amplitude.
fn number(value: f64) -> String {
    if value.abs() < 1e-3 { format!("{value:.2e}") } else { format!("{value:.4}") }
}

fn interval(estimate: &Estimate) -> String {
    let end = |end: f64| if end.is_finite() { number(end) } else { "unknown".to_owned() };
    let [low, high] = estimate.interval.map(end);
    format!("{low} .. {high}")
}

/// The errors of the tiles in words, if all tiles have the same.
fn tile_errors(tolerance: &FilmTolerance) -> String {
    let Some(first) = tolerance.tiles.first() else { return String::new() };
    if tolerance.tiles.iter().any(|errors| errors != first) {
        return "errors of the tiles: not the same for all\n".to_owned();
    }
    let PerTileError { position, rotation, size, strength, direction } = first;
    let causes = [
        ("position", &position[..], TileError::Position(Axis::X)),
        ("rotation", rotation, TileError::Rotation(Axis::X)),
        ("size", size, TileError::Size(Axis::X)),
        ("strength", std::slice::from_ref(strength), TileError::Strength),
        ("direction", direction, TileError::Direction(DirectionError::InPlane)),
    ];
    let mut stated = Vec::new();
    for (name, errors, error) in causes {
        if errors.iter().any(|error| !error.is_none()) {
            let mut shown: Vec<String> = errors.iter().map(|of| distribution(&of.scaled(error.shown(1.0)))).collect();
            if shown.iter().all(|one| *one == shown[0]) {
                shown.truncate(1);
            }
            stated.push(format!("{name} {} {}", shown.join(", "), error.unit()));
        }
    }
    let mut text = String::new();
    if !stated.is_empty() {
        rows::prose(&mut text, &format!("each tile has errors of {}", stated.join("; ")));
    }
    text
}

/// The names of the other causes.
fn other_errors(tolerance: &FilmTolerance) -> String {
    let CommonErrors { film, stray_field, neighbour, iron, temperature, sensor } = &tolerance.common;
    let groups = counted(tolerance.groups.len(), "group of tiles", "groups of tiles");
    let named = [
        (!tolerance.groups.is_empty(), groups.as_str()),
        (*film != FilmPose::default(), "pose of the film"),
        (stray_field.is_some(), "stray field"),
        (neighbour.is_some(), "neighbouring film"),
        (iron.is_some(), "iron nearby"),
        (temperature.is_some(), "temperature"),
        (*sensor != SensorErrors::default(), "sensor"),
    ];
    let named: Vec<&str> = named.into_iter().filter(|(is_there, _)| *is_there).map(|(_, name)| name).collect();
    let mut text = String::new();
    if !named.is_empty() {
        rows::prose(&mut text, &format!("other errors: {}", named.join(", ")));
    }
    text
}

/// A distribution in words: a plain number is a standard deviation.
fn distribution(distribution: &Distribution) -> String {
    // Twelve digits hide the rounding of degrees.
    let number = |value: &f64| twelve_digits(*value);
    match distribution {
        Distribution::Fixed(value) if *value == 0.0 => "0".to_owned(),
        Distribution::Fixed(value) => format!("always {}", number(value)),
        Distribution::Normal { deviation } => number(deviation).to_string(),
        Distribution::Truncated { deviation, limit } => {
            format!("{} (at most {})", number(deviation), number(limit))
        }
        Distribution::Uniform { half_width } => format!("-{0} .. {0}", number(half_width)),
        Distribution::Tabulated(values) => match &values[..] {
            [first, .., last] => format!("{} .. {} as measured", number(first), number(last)),
            _ => "as measured".to_owned(),
        },
    }
}
