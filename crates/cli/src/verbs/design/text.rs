//! A film found, as a designer reads it.

use std::fmt::Write;
use std::path::Path;

use magsplice::design::{DesignProblem, Metrics, ParetoFront, SearchResult};
use magsplice::prelude::DVec3;

use super::found::array;
use crate::text::number;

/// Before and after, side by side.
pub(crate) fn outcome(setting: &DesignProblem, outcome: &SearchResult, path: Option<&Path>) -> String {
    let [nx, ny, nz] = setting.grid().counts();
    let mut text = format!(
        "{} in {}, designed on {nx} x {ny} x {nz} points; {}\n\n",
        count(setting.variable_count(), "free number", "free numbers"),
        match (setting.orbit_count(), outcome.tiles.len()) {
            (orbits, tiles) if orbits == tiles => count(tiles, "tile", "tiles"),
            (orbits, tiles) => format!("{orbits} tiles, whose images are the other {}", tiles - orbits),
        },
        count(outcome.agreeing_starts, "start found this film", "starts found this film or one as good"),
    );
    let columns = [&outcome.before, &outcome.after, &outcome.finer];
    line(&mut text, "", ["before", "after", "5 x finer"].map(str::to_owned));
    let mut errors = |title: &str, of: &dyn Fn(&Metrics) -> [f64; 3], names: [&str; 3]| {
        let _ = writeln!(text, "{title}");
        for (index, name) in names.into_iter().enumerate() {
            line(&mut text, name, columns.map(|figures| number(of(figures)[index])));
        }
    };
    errors("uniformity RMSE", &|f| array(f.uniformity_rmse), ["R_x", "R_y", "S_z"]);
    errors("RMSE of displacement, mm", &|f| f.displacement_rmse_mm, ["x", "y", "z"]);
    let _ = writeln!(text, "against the ideal film");
    line(&mut text, "amplitude", columns.map(|figures| number(figures.amplitude)));
    let scaled = |figures: &Metrics| figures.scaled_relative_rmse.map_or("none".to_owned(), number);
    line(&mut text, "relative RMSE after scaling", columns.map(scaled));

    let _ = writeln!(text, "\nuniformity RMSE after each stage");
    line(&mut text, "", ["R_x", "R_y", "S_z"].map(str::to_owned));
    for stage in &outcome.stages {
        line(&mut text, stage.stage.name(), array(stage.uniformity_rmse).map(number));
    }
    let magnetized = outcome.tiles.iter().filter(|tile| tile.polarization_t() != DVec3::ZERO).count();
    let tiles = count(magnetized, "tile", "tiles");
    let _ = writeln!(text, "\n{tiles} of {}", count(outcome.parts, "part", "distinct parts"));
    for short in &outcome.short_of {
        let _ = writeln!(text, "not reached: {short}");
    }
    if let Some(path) = path {
        let path = path.display();
        let _ = writeln!(text, "wrote {path}; look at it with `magsplice report {path} -o report`");
    }
    text
}

/// The films of a front, one line each.
pub(crate) fn front(front: &ParetoFront) -> String {
    let mut text = String::new();
    let head = ["R_x", "R_y", "S_z", "x, mm", "y, mm", "z, mm", "amplitude", "parts"];
    let mut table = |title: &str, rows: Vec<(String, &SearchResult)>| {
        let _ = writeln!(text, "{title}");
        let _ = write!(text, "{:<24}{:^39}{:^39}", "", "uniformity RMSE", "RMSE of displacement");
        let _ = writeln!(text, "\n{:<24}{}", "", head.map(|name| format!("{name:>13}")).concat());
        for (name, outcome) in rows {
            let figures = &outcome.after;
            let numbers = array(figures.uniformity_rmse).into_iter().chain(figures.displacement_rmse_mm);
            let numbers: String = numbers.map(|value| format!("{:>13}", number(value))).collect();
            let _ = writeln!(text, "  {name:<22}{numbers}{:>13.4}{:>13}", figures.amplitude, outcome.parts);
        }
    };
    let by_amplitude = front.by_amplitude.iter().map(|(least, outcome)| (format!("at least {least}"), outcome));
    table("error against amplitude", by_amplitude.collect());
    if !front.by_parts.is_empty() {
        let by_parts = front.by_parts.iter().map(|outcome| (count(outcome.parts, "part", "parts"), outcome));
        table("\nerror against the number of distinct parts", by_parts.collect());
    }
    text
}

fn line(text: &mut String, label: &str, cells: [String; 3]) {
    let [a, b, c] = cells;
    let _ = writeln!(text, "  {label:<36}{a:>13}{b:>13}{c:>13}");
}

fn count(number: usize, one: &str, many: &str) -> String {
    if number == 1 { format!("1 {one}") } else { format!("{number} {many}") }
}
