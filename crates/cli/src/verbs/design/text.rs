//! `design` and `splice`: a film that was found, and the films of a front.

use std::fmt::Write;
use std::path::Path;

use magsplice::decouple::Figures;
use magsplice::design::{DesignProblem, MadeFilms, Metrics, ParetoFront, SearchResult, SpliceChange, SpliceTrial};
use magsplice::layout::{Symmetry, Under};
use magsplice::prelude::DVec3;
use magsplice::results::{FoundFilm, OutOfRange, twelve_digits};
use magsplice::tolerance::Statistics;

use crate::text::number::{counted, number, uniformity_number};
use crate::text::rows;
use crate::text::units::in_mt;

/// The film before and after the search, side by side, and what the film is worth. The film before
/// is a pattern if `from_pattern`.
pub(super) fn found_film(
    problem: &DesignProblem,
    found: &FoundFilm,
    path: Option<&Path>,
    from_pattern: bool,
) -> String {
    let result = &found.search;
    let [nx, ny, nz] = problem.grid().counts();
    let mut text = format!(
        "{} in {}, designed on {nx} x {ny} x {nz} points; {}\n\n",
        counted(problem.variable_count(), "free parameter", "free parameters"),
        match (problem.orbit_count(), result.tiles.len()) {
            (orbits, tiles) if orbits == tiles => counted(tiles, "tile", "tiles"),
            (orbits, tiles) => {
                let symmetry = if problem.brief().symmetry == Symmetry::FourFold { "four-fold" } else { "mirror" };
                format!("{orbits} tiles, from which the {symmetry} symmetry makes all {tiles}")
            }
        },
        format_args!(
            "{} of {} found this film or one as good",
            result.agreeing_starts,
            counted(problem.brief().starts, "start", "starts")
        ),
    );
    let columns = [&result.before, &result.after, &result.finer];
    let before = if from_pattern { "start pattern" } else { "before" };
    rows::heading(&mut text, "", [before, "after", "5 x finer"]);
    let mut errors = |title: &str, of: &dyn Fn(&Figures) -> [String; 3], names: [&str; 3]| {
        let _ = writeln!(text, "{title}");
        for (index, name) in names.into_iter().enumerate() {
            rows::cells(&mut text, &format!("  {name}"), columns.map(|metrics| of(&metrics.figures)[index].clone()));
        }
    };
    let uniformity = |figures: &Figures| figures.uniformity_rmse.map(uniformity_number).to_array();
    errors("uniformity RMSE", &uniformity, ["R_x", "R_y", "S_z"]);
    let displacement = |figures: &Figures| figures.displacement_rmse_mm.map(number).to_array();
    errors("RMSE of displacement, mm", &displacement, ["x", "y", "z"]);
    let _ = writeln!(text, "against the ideal film");
    rows::cells(&mut text, "  amplitude", columns.map(|metrics| number(metrics.figures.amplitude)));
    let scaled = |metrics: &Metrics| metrics.scaled_relative_rmse.map_or("none".to_owned(), number);
    rows::cells(&mut text, "  relative RMSE after scaling", columns.map(scaled));

    if let Some(made) = &result.made {
        films_made(&mut text, made, before);
    }
    // Rounding alone is no news.
    if result.stages.len() > 2 {
        let _ = writeln!(text, "\nuniformity RMSE after each stage");
        rows::heading(&mut text, "", ["R_x", "R_y", "S_z"]);
        for stage in &result.stages {
            let uniformity = stage.uniformity_rmse.to_array().map(uniformity_number);
            rows::cells(&mut text, &format!("  {}", stage.stage.name()), uniformity);
        }
    }
    let magnetized = result.tiles.iter().filter(|tile| tile.polarization_t() != DVec3::ZERO).count();
    let tiles = counted(magnetized, "tile", "tiles");
    if let Some(spacing_mm) = result.spacing_mm {
        let _ = writeln!(text, "\nspacing of the head, mm: {spacing_mm}");
    }
    let _ = writeln!(text, "\n{tiles} of {}", counted(result.parts, "part", "distinct parts"));
    for short in &result.short_of {
        let _ = writeln!(text, "not reached: {short}");
    }
    trials(&mut text, problem, &found.trials);
    if let Some(beyond) = &found.out_of_range {
        let _ = writeln!(text, "warning: {}", out_of_range(beyond));
    }
    if let Some(path) = path {
        let path = path.display();
        let _ = writeln!(text, "wrote {path}; look at it with `magsplice report {path} -o report`");
        if let Some(made) = &result.made {
            let preset = made.preset.map_or(String::new(), |preset| format!(" --preset {}", preset.name()));
            let _ = writeln!(text, "`magsplice tolerance {path}{preset}` evaluates films as made");
            if problem.brief().under != Under::Tolerance {
                let _ = writeln!(
                    text,
                    "the search was for the film as ordered:{preset} --under tolerance searches for films as made"
                );
            }
        }
    }
    text
}

/// Which limit stands in the way of a film, found by searches with one option changed.
fn trials(text: &mut String, problem: &DesignProblem, trials: &[SpliceTrial]) {
    if trials.is_empty() {
        return;
    }
    for SpliceTrial { change, displacement_rmse_mm, .. } in trials.iter().filter(|trial| trial.is_enough) {
        let [x, y, z] = displacement_rmse_mm.map(|error_mm| format!("{error_mm:.2e}")).to_array();
        let _ = writeln!(text, "{}: {} gives {x}, {y}, {z} mm along x, y, z", change.limit(), in_option(*change));
    }
    let not_enough: Vec<String> =
        trials.iter().filter(|trial| !trial.is_enough).map(|trial| in_option(trial.change)).collect();
    if not_enough.len() == trials.len() {
        let _ = writeln!(
            text,
            "none of these is enough alone, so combine them or change the wavelength, {} mm: {}",
            problem.ideal().wavelength(),
            not_enough.join(", ")
        );
    } else if !not_enough.is_empty() {
        let _ = writeln!(text, "not enough alone: {}", not_enough.join(", "));
    }
}

/// A change as the option of `splice` that makes it.
fn in_option(change: SpliceChange) -> String {
    match change {
        SpliceChange::Starts(starts) => format!("--starts {starts}"),
        SpliceChange::SmallestCutMm(cut_mm) => format!("--smallest-cut {cut_mm}"),
        SpliceChange::FilmMm([x, y]) => format!("--film {x}x{y}"),
        SpliceChange::RangeMm([x, y]) => format!("--range {x}x{y}"),
        SpliceChange::DistanceMm([near, far]) => format!("--distance {near}..{far}"),
        SpliceChange::LeastAmplitude(least) => format!("--amplitude {least}"),
        SpliceChange::AnyParts => "no --parts".to_owned(),
        _ => "another option".to_owned(),
    }
}

/// Where the field of a film leaves the range of its sensor.
fn out_of_range(beyond: &OutOfRange) -> String {
    let OutOfRange { points, of, axis, largest_t, range_t, sensor, ref setting } = *beyond;
    let sensor = sensor.map_or("the sensor".to_owned(), |number| format!("sensor {number}"));
    format!(
        "the field leaves the range of {sensor} at {points} of {of} points: B_{axis} reaches {:.4} mT, the range is \
         {} mT{}; weaker tiles, a greater distance or another sensor help",
        in_mt(largest_t),
        twelve_digits(in_mt(range_t)),
        setting.as_deref().unwrap_or_default()
    )
}

/// The errors of films as made, before and after the search.
fn films_made(text: &mut String, made: &MadeFilms, before: &str) {
    let samples = counted(made.samples as usize, "sample", "samples");
    let errors = made.preset.map_or(String::new(), |preset| format!(", errors of the preset {}", preset.name()));
    let _ = writeln!(text, "\nRMSE of displacement of films as made, mm; {samples}, seed {}{errors}", made.seed);
    rows::heading(text, "", ["x", "y", "z"]);
    let before = made.before.as_ref().map(|errors| (before, errors));
    for (film, errors) in before.into_iter().chain([("after", &made.after)]) {
        let mut percentile = |name: &str, of: &dyn Fn(&Statistics) -> f64| {
            let cells = errors.displacement_rmse_mm.map(|axis| number(of(&axis)));
            rows::cells(text, &format!("  {film}, {name}"), cells.to_array());
        };
        percentile("mean", &|errors| errors.mean.value);
        percentile("P50", &|errors| errors.p50.value);
        percentile("P95", &|errors| errors.p95.value);
        percentile("P99", &|errors| errors.p99.value);
    }
}

/// The films of a front, one line each.
pub(super) fn front(front: &ParetoFront) -> String {
    let mut text = String::new();
    let films = || front.by_amplitude.iter().map(|(_, film)| film).chain(&front.by_parts);
    let are_made = films().next().is_some() && films().all(|film| film.made.is_some());
    let (parameters, titles) = if are_made {
        (["x, mm", "y, mm", "z, mm"], ["films made: displacement, P95", "as ordered: displacement"])
    } else {
        (["R_x", "R_y", "S_z"], ["uniformity RMSE", "RMSE of displacement"])
    };
    let head = parameters.into_iter().chain(["x, mm", "y, mm", "z, mm", "amplitude", "parts"]);
    let head: String = head.map(|name| format!("{name:>13}")).collect();
    let mut table = |title: &str, rows: Vec<(String, &SearchResult)>| {
        let _ = writeln!(text, "{title}");
        let _ = write!(text, "{:<24}{:^39}{:^39}", "", titles[0], titles[1]);
        let _ = writeln!(text, "\n{:<24}{head}", "");
        for (name, result) in rows {
            let metrics = &result.after;
            let made = result.made.as_ref().filter(|_| are_made);
            let first = match made {
                Some(made) => made.after.displacement_rmse_mm.map(|axis| number(axis.p95.value)).to_array(),
                None => metrics.figures.uniformity_rmse.map(uniformity_number).to_array(),
            };
            let numbers = first.into_iter().chain(metrics.figures.displacement_rmse_mm.map(number).to_array());
            let numbers: String = numbers.map(|number| format!("{number:>13}")).collect();
            let _ = writeln!(text, "  {name:<22}{numbers}{:>13.4}{:>13}", metrics.figures.amplitude, result.parts);
        }
    };
    let by_amplitude = front.by_amplitude.iter().map(|(least, film)| (format!("at least {least}"), film));
    table("error against amplitude", by_amplitude.collect());
    if !front.by_parts.is_empty() {
        let by_parts = front.by_parts.iter().map(|film| (counted(film.parts, "part", "parts"), film));
        table("\nerror against the number of distinct parts", by_parts.collect());
    }
    text
}
