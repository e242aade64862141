//! The text of `docs/accuracy-and-speed.md`.

use std::fmt::Write;

use magsplice::field::InstructionSet;
use magsplice_benches::Growth;

use crate::front::{ERRORS, peers_in_front};
use crate::measure::{Measured, Measurements, Model, SLOW_S};
use crate::single_precision::{Errors, Precision};
use crate::{Effort, GROWING, NOTCHES, Panel};

/// No exponent of growth may be larger.
const LARGEST_EXPONENT: f64 = 1.2;
/// A model that is less than so many times as fast as the exact field is not worth its error.
const WORTH: f64 = 1.2;

pub(crate) fn text(
    panels: &[Panel],
    films: &[Growth],
    precision: &Precision,
    magpylib: Option<&str>,
    effort: Effort,
) -> String {
    let mut page = String::from(HEAD);
    how(&mut page, panels, magpylib, effort);
    comparison(&mut page, panels, magpylib.is_some());
    page.push_str(TABLES);
    for panel in panels {
        for (place, at) in panel.scene.places.iter().zip(&panel.measurements) {
            let _ = write!(page, "\n### {}, {}\n\n", panel.scene.title, place.name);
            table(&mut page, at, panel.scene.tiles.len());
        }
    }
    worthless(&mut page, panels);
    page.push_str(ONLY_EXACT);
    growing(&mut page, films);
    single(&mut page, precision, effort);
    page
}

fn how(page: &mut String, panels: &[Panel], magpylib: Option<&str>, effort: Effort) {
    let magpylib = match magpylib {
        Some(version) => format!(" magpylib {version} by its core function in a loop over tiles, its fastest way."),
        None => " magpylib was left out.".to_owned(),
    };
    let [nx, ny, nz] = effort.grid;
    let _ = write!(
        page,
        "
## How it was measured

All programs in binary64 on one thread, in turns, within one process (magpylib in a Python that waits for its turn); medians of {} runs ({} of the peers), after one that is not counted; what takes more than {} s is timed once. Times are
of the machine that wrote this page (best instructions: {:?}); ratios carry over, but rows that differ by less than a factor of two may do so by noise. Grids have {nx} x {ny} x {nz} points, lists and look-ups {} random points ({} among the random tiles). Time on a grid includes making its
expansion; lists are evaluated again with the same scene, and look-ups after their box was prepared, which the tables state.
magba 0.7.3 by its batch call, one tile after the other.{magpylib} Peers take the same time for every point, and were run on a part of them.

Errors are |B - exact| / |exact|, where the exact field is our own, at every point of a grid and up to {} points of a list. The exact field itself was held against sums of numbers of 130
digits at some of these points, and no error is counted as less than its own there; [accuracy.md](accuracy.md) shows it to be right to a few 1e-15
for a tile at any distance, against tables of 40 digits. The points of the peers lie where their own errors are.
",
        effort.rounds,
        effort.peer_rounds,
        SLOW_S,
        InstructionSet::available()[0],
        effort.points,
        effort.heap_points,
        effort.exact_pairs / panels.iter().map(|panel| panel.scene.tiles.len()).max().unwrap_or(1),
    );
    page.push_str(
        "\n| scene | place | tiles | points of the peers | points with 130 digits |\n|---|---|---|---|---|\n",
    );
    for panel in panels {
        for (place, at) in panel.scene.places.iter().zip(&panel.measurements) {
            let (tiles, peers, checked) = (panel.scene.tiles.len(), at.peer_points, at.checked_points);
            let _ = writeln!(page, "| {} | {} | {tiles} | {peers} | {checked} |", panel.scene.title, place.name);
        }
    }
    page.push_str(SCENES);
}

/// Whether a peer is anywhere as fast and as near as none of ours.
fn comparison(page: &mut String, panels: &[Panel], with_magpylib: bool) {
    page.push_str("\n## Against the peers\n\n");
    let peers = if with_magpylib { "magba or magpylib" } else { "magba" };
    let mut in_front = Vec::new();
    for panel in panels {
        for (place, at) in panel.scene.places.iter().zip(&panel.measurements) {
            for (which, error) in ERRORS {
                for peer in peers_in_front(at, error) {
                    let (title, place, name) = (panel.scene.title, place.name, peer.model.name());
                    in_front.push(format!("* {title}, {place}: {name}, by its {which} error of {:.1e}", error(peer)));
                }
            }
        }
    }
    if in_front.is_empty() {
        let _ = writeln!(
            page,
            "No point of {peers} lies in front of ours, computed from the numbers below: at every place some model of ours is at least as fast and at least as exact, by the largest error and by \
             the median."
        );
    } else {
        let _ = writeln!(
            page,
            "**Points of peers in front of ours**, where no model of ours is both as fast and as exact:\n\n{}",
            in_front.join("\n")
        );
    }
}

fn table(page: &mut String, at: &Measurements, tiles: usize) {
    let exact = at.exact().ns;
    let magba = at.of(Model::Magba).next().map_or(f64::NAN, |m| m.ns);
    page.push_str(
        "| model | within | ns for a point | times exact | times magba | median error | largest error | note |\n",
    );
    page.push_str("|---|---|---|---|---|---|---|---|\n");
    for model in Model::ALL {
        for m in at.of(model) {
            let within = m.tolerance.map_or("-".to_owned(), |t| format!("{t:.0e}"));
            let _ = writeln!(
                page,
                "| {} | {within} | {} | {} | {} | {} | {} | {} |",
                model.name(),
                digits(m.ns),
                digits(exact / m.ns),
                digits(magba / m.ns),
                error(m.median),
                error(m.worst),
                note(m, tiles)
            );
        }
        if model == Model::LookUps {
            for tolerance in &at.unprepared {
                let _ = writeln!(page, "| {} | {tolerance:.0e} | - | - | - | - | - | refused |", model.name());
            }
        }
    }
}

fn note(m: &Measured, tiles: usize) -> String {
    let mut notes = Vec::new();
    if m.model == Model::Exact {
        notes.push(format!("{:.2} ns for a tile and a point", m.ns / tiles as f64));
    }
    if let Some(ms) = m.prepared_ms {
        notes.push(format!("prepared in {} ms", digits(ms)));
    }
    if m.refused > 0.0 {
        notes.push(format!("{:.2} % of the points refused", 100.0 * m.refused));
    }
    if m.tolerance.is_some_and(|tolerance| m.worst > tolerance) {
        notes.push("**tolerance not kept**".to_owned());
    }
    notes.join("; ")
}

/// Notches that are not worth their error, from the data.
fn worthless(page: &mut String, panels: &[Panel]) {
    let mut list = String::new();
    for panel in panels {
        for (place, at) in panel.scene.places.iter().zip(&panel.measurements) {
            for model in [Model::Grid, Model::List, Model::LookUps] {
                let slow = at.of(model).filter(|m| at.exact().ns < WORTH * m.ns);
                let slow: Vec<String> = slow.filter_map(|m| Some(format!("{:.0e}", m.tolerance?))).collect();
                if !slow.is_empty() {
                    let all = if slow.len() == NOTCHES.len() { "any tolerance".to_owned() } else { slow.join(", ") };
                    let _ = writeln!(list, "* {}, {}: {} within {all}", panel.scene.title, place.name, model.name());
                }
            }
        }
    }
    if !list.is_empty() {
        let _ = write!(
            page,
            "
### Not worth it

Less than {WORTH} times as fast as the exact field, which should be taken there:

{list}"
        );
    }
}

fn growing(page: &mut String, films: &[Growth]) {
    let _ = write!(
        page,
        "
## Growth

Square films of unit cubes with as many random points 3 to 5 below them, within {GROWING:.0e}. *Everything* is the scene from its tiles and the first evaluation, which makes the tree; *again* the same points once
more. The exact field of large films was computed for some neighbourhoods of points as dense as in the whole list, and its time scaled by their number (hollow in the picture); single points of
the list, far from each other, would take it several times longer. Errors are the largest
on these points. `cargo bench -p magsplice-benches --bench dial` prints the same.

![Seconds against the number of tiles and points](pictures/accuracy-and-speed-growth.svg)

| tiles and points | scene, s | everything, s | again, s | exact, s | points of the exact field | times exact, everything | times exact, again | largest error |
|---|---|---|---|---|---|---|---|---|
"
    );
    for film in films {
        let _ = writeln!(
            page,
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} |",
            film.tiles,
            digits(film.scene_s),
            digits(film.everything_s()),
            digits(film.again_s),
            digits(film.exact_s),
            film.exact_points,
            digits(film.exact_everything_s() / film.everything_s()),
            digits(film.exact_s / film.again_s),
            error(film.worst)
        );
    }
    page.push_str("\n| from | to | exponent, everything | exponent, again |\n|---|---|---|---|\n");
    let mut exponents = Vec::new();
    let ends = films.iter().zip(&films[1..]).chain(films.first().zip(films.last()));
    for (smaller, larger) in ends {
        let [everything, again] =
            [Growth::everything_s, |f: &Growth| f.again_s].map(|time| smaller.exponent_to(larger, time));
        let _ = writeln!(page, "| {} | {} | {everything:.2} | {again:.2} |", smaller.tiles, larger.tiles);
        exponents = vec![("everything", everything), ("again", again)];
    }
    page.push('\n');
    for (what, exponent) in exponents {
        let verdict = if exponent <= LARGEST_EXPONENT { "kept" } else { "**missed**" };
        let _ = writeln!(
            page,
            "From the smallest to the largest, {what}: {exponent:.2}; the goal of at most {LARGEST_EXPONENT} is {verdict}."
        );
    }
}

fn single(page: &mut String, precision: &Precision, effort: Effort) {
    let _ = write!(
        page,
        "
## Why the closed form is not in single precision

The usual closed form, a sum of logarithms and arctangents over the corners of a tile, takes differences of nearly equal numbers, and loses three digits for each decade of distance. In binary32 there are seven to
lose. The same formula in both precisions, {} random tiles for each distance:

| distance, sizes | binary32, median | binary32, largest | binary64, median | binary64, largest |
|---|---|---|---|---|
",
        effort.single_cases
    );
    let row = |page: &mut String, name: &str, [single, double]: &[Errors; 2]| {
        let [a, b] = [single, double].map(|e| format!("{} | {}", error(e.median), error(e.worst)));
        let _ = writeln!(page, "| {name} | {a} | {b} |");
    };
    for (distance, errors) in &precision.at {
        row(page, &digits(*distance), errors);
    }
    row(page, "published film, in its volume", &precision.film);
    page.push_str(SINGLE);
}

/// Three digits, without an exponent where that is short.
fn digits(number: f64) -> String {
    match number.abs() {
        1e5.. => format!("{number:.2e}"),
        100.0..1e5 => format!("{number:.0}"),
        10.0..100.0 => format!("{number:.1}"),
        0.1..10.0 => format!("{number:.2}"),
        n if n.is_nan() => "-".to_owned(),
        _ => format!("{number:.2e}"),
    }
}

fn error(error: f64) -> String {
    if error.is_nan() { "-".to_owned() } else { format!("{error:.1e}") }
}

const HEAD: &str = "# Accuracy and speed

Generated by `cargo run --release -p magsplice-benches --bin dial-page` (it needs a Python with magpylib: `pip install magpylib`; see `--help`). Do not edit.

What each notch of the dial, `scene.with_accuracy(Accuracy::Within(Tolerance::relative(1e-6)?))`, costs and is worth.

![Time for a point against error](pictures/accuracy-and-speed.svg)
";

const SCENES: &str = "
The published film and the 80 mm film are those of `layouts/`; their volume is the published one, 3 to 5 mm below, and *under all of it* reaches over 72 x 72 mm. The random tiles have sides of 0.3 to 1.2 and any
polarization, none overlap, and the points are in the same cube, some of them in tiles. The one tile is 3.3 x 1.7 x 1 mm, polarized along no axis.
";

const TABLES: &str = "
## What each notch costs and is worth

*Grid*: `Scene::field_on_grid`, Chebyshev expansions of boxes without tiles. *List of points*: `Scene::field_into`, a tree over the tiles. *Look-ups*: `FittedField`, a box prepared once.
*Within* is what was asked for; the largest error is what came out.
";

const ONLY_EXACT: &str = "
### Where no model but the exact one applies

* Single points (`Scene::field`), gradients (`Scene::flux_density_gradient`) and J: exact whatever the accuracy.
* Look-ups in boxes with tiles in or beside them: `FittedField` refuses the box. Grids there are divided, and what is beside the tiles is served as a list.
* Tiles near a point, in a list: the tree serves far ones only, so what is near is exact.
* Tolerances close to 2e-14 of the sum of the tiles' fields: exact, and points at which even that is not certain enough are named as errors.
";

const SINGLE: &str = "
The series for tiles far away (docs/physics.md, 2.7) would not lose them, but near a tile the closed form decides, and on a film tiles cancel, so that even there binary32 alone could not tell which tolerance it keeps. It would
do for drawings, where colours and arrows show two to three digits, within a few sizes of the tiles; a grid within 1e-2 serves them too, with an error that is known.
";
