//! `tolerance`: statistics of samples as tables.

use std::fmt::Write;

use magsplice::decouple::{Figure, Parameter};
use magsplice::layout::{CommonErrors, Distribution, FilmPose, FilmTolerance, SensorErrors, TileErrors};
use magsplice::making::Sorting;
use magsplice::tolerance::{Estimate, Statistics};

use super::number::counted;
use super::rows::{Column, left, right};
use super::{header, rows};
use crate::sampling::sampled_film::SampledFilm;
use crate::sampling::source::SampleSource;

/// The report of `tolerance`.
pub(crate) fn sampled(film: &SampledFilm) -> String {
    header::with_recoil(film.layout, film.recoil.as_ref()) + &samples(film)
}

/// The statistics of the samples, without the layout.
pub(crate) fn samples(film: &SampledFilm) -> String {
    let mut text = format!("{}\n", in_words(&film.source));
    if let Some(tolerance) = &film.layout.tolerance {
        text += &tile_errors(tolerance);
        text += &other_errors(tolerance);
    }
    if let Some(sorting) = &film.sorting {
        rows::prose(&mut text, &sorted_in_words(sorting));
    }
    text.push('\n');
    let names = ["", "nominal", "mean", "P50", "P95", "P99", "P95 is within"].map(str::to_owned);
    let mut table = vec![names];
    for (figure, statistics) in film.statistics.iter().filter(|(figure, _)| *figure != Figure::Amplitude) {
        table.push(row(figure, film.nominal.get(figure).zip(statistics)));
    }
    text += &rows::table(&COLUMNS, &table);
    let amplitude = &film.statistics.amplitude;
    let names = ["", "nominal", "mean", "P50", "P5", "P1", "P5 is within"].map(str::to_owned);
    let values =
        [film.nominal.amplitude, amplitude.mean.value, amplitude.p50.value, amplitude.p5.value, amplitude.p1.value];
    let [nominal, mean, p50, p5, p1] = values.map(figure);
    text.push('\n');
    let values = ["amplitude".to_owned(), nominal, mean, p50, p5, p1, interval(&amplitude.p5)];
    text += &rows::table(&COLUMNS, &[names, values]);
    text.push('\n');
    for (share, bounds) in [(film.yield_share, "[expect]"), (film.yield_made, "[expect.made]")] {
        let Some(share) = share else { continue };
        let [value, low, high] = [share.value, share.interval[0], share.interval[1]].map(|share| 100.0 * share);
        let _ =
            writeln!(text, "yield: {value:.1} % of the films keep all bounds of {bounds} ({low:.1} .. {high:.1} %)");
    }
    text += "intervals hold with 95 % confidence\n";
    text
}

/// How tiles are sorted.
fn sorted_in_words(sorting: &Sorting) -> String {
    let measurement = &sorting.measurement;
    let [percent, degrees] =
        [100.0 * measurement.strength, measurement.direction_rad.to_degrees()].map(magsplice::results::twelve_digits);
    let sides = match measurement.size_mm {
        Some(size_mm) => format!("sides to {size_mm} mm"),
        None => "sides not measured".to_owned(),
    };
    let over = if sorting.settings.may_turn_over { "" } else { ", none turned over" };
    format!(
        "tiles are measured and sorted before they are laid: {}{over}; strength measured to {percent} %, direction to \
         {degrees} deg, {sides}",
        counted(sorting.spares, "spare tile", "spare tiles")
    )
}

/// The number of samples in words, for the header of the text.
fn in_words(source: &SampleSource) -> String {
    let samples = counted(source.count as usize, "sample", "samples");
    let SampleSource { seed, first, count, .. } = source;
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

fn row(of: Figure, found: Option<(&f64, &Statistics)>) -> [String; 7] {
    let name = match of {
        Figure::Uniformity(Parameter::Rx) => "uniformity RMSE of R_x".to_owned(),
        Figure::Uniformity(Parameter::Ry) => "uniformity RMSE of R_y".to_owned(),
        Figure::Uniformity(Parameter::Sz) => "uniformity RMSE of S_z".to_owned(),
        Figure::Displacement(axis) => format!("displacement RMSE, {axis}, mm"),
        Figure::Amplitude => "amplitude".to_owned(),
    };
    let Some((nominal, Statistics { mean, p50, p95, p99, .. })) = found else {
        return [&name, "one point", "", "", "", "", ""].map(str::to_owned);
    };
    let [nominal, mean, p50, p95_value, p99] = [*nominal, mean.value, p50.value, p95.value, p99.value].map(figure);
    [name, nominal, mean, p50, p95_value, p99, interval(p95)]
}

/// Three significant digits beyond the point for what samples tell, four for an amplitude.
fn figure(value: f64) -> String {
    if value.abs() < 1e-3 { format!("{value:.2e}") } else { format!("{value:.4}") }
}

fn interval(estimate: &Estimate) -> String {
    let end = |end: f64| if end.is_finite() { figure(end) } else { "?".to_owned() };
    let [low, high] = estimate.interval.map(end);
    format!("{low} .. {high}")
}

/// The errors of the tiles in words, if all tiles have the same.
fn tile_errors(tolerance: &FilmTolerance) -> String {
    let Some(first) = tolerance.tiles.first() else { return String::new() };
    if tolerance.tiles.iter().any(|errors| errors != first) {
        return "errors of the tiles: not the same for all\n".to_owned();
    }
    let TileErrors { position, rotation, size, strength, direction } = first;
    let degrees = 1.0_f64.to_degrees();
    let causes = [
        ("position", position.as_slice(), 1.0, "mm"),
        ("rotation", rotation, degrees, "deg"),
        ("size", size, 1.0, "mm"),
        ("strength", std::slice::from_ref(strength), 100.0, "%"),
        ("direction", direction, degrees, "deg"),
    ];
    let mut stated = Vec::new();
    for (name, errors, factor, unit) in causes {
        if errors.iter().any(|error| !error.is_none()) {
            let mut shown: Vec<String> = errors.iter().map(|error| distribution(&error.scaled(factor))).collect();
            if shown.iter().all(|one| *one == shown[0]) {
                shown.truncate(1);
            }
            stated.push(format!("{name} {} {unit}", shown.join(", ")));
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
    let CommonErrors { film, stray_field, neighbour, temperature, sensor } = &tolerance.common;
    let groups = counted(tolerance.groups.len(), "group of tiles", "groups of tiles");
    let named = [
        (!tolerance.groups.is_empty(), groups.as_str()),
        (*film != FilmPose::default(), "pose of the film"),
        (stray_field.is_some(), "stray field"),
        (neighbour.is_some(), "neighbouring film"),
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
    let number = |value: f64| magsplice::results::twelve_digits(value);
    match distribution {
        Distribution::Fixed(value) if *value == 0.0 => "0".to_owned(),
        Distribution::Fixed(value) => format!("always {}", number(*value)),
        Distribution::Normal { deviation } => number(*deviation).to_string(),
        Distribution::Truncated { deviation, limit } => {
            format!("{} (at most {})", number(*deviation), number(*limit))
        }
        Distribution::Uniform { half_width } => format!("-{0} .. {0}", number(*half_width)),
        Distribution::Tabulated(values) => match &values[..] {
            [first, .., last] => format!("{} .. {} as measured", number(*first), number(*last)),
            _ => "as measured".to_owned(),
        },
    }
}
