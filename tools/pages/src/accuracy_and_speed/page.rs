//! The text of the page.

use std::fmt::Write;

use magsplice::field::InstructionSet;
use magsplice_benches::Growth;

use super::effort::{DialEffort, GROWTH_TOLERANCE, TOLERANCES};
use super::measure::{Contender, Measured, MeasuredScene, Measurements, SLOW_S};
use super::pareto::{ERROR_MEASURES, peers_in_front};
use super::single_precision::{PrecisionErrors, PrecisionTable};

/// Largest exponent of growth that meets the goal.
const LARGEST_EXPONENT: f64 = 1.2;
/// Smallest speedup over the exact field that justifies the error of a tolerance.
const WORTHWHILE_SPEEDUP: f64 = 1.2;

/// The page; `magpylib` is its version if it was run.
pub(crate) fn text(
    scenes: &[MeasuredScene],
    films: &[Growth],
    precision: &PrecisionTable,
    magpylib: Option<&str>,
    effort: DialEffort,
) -> String {
    let mut page = String::from(HEAD);
    how(&mut page, scenes, magpylib, effort);
    comparison(&mut page, scenes, magpylib.is_some());
    page.push_str(TABLES);
    for scene in scenes {
        for (place, at) in scene.scene.places.iter().zip(&scene.measurements) {
            let _ = write!(page, "\n### {}, {}\n\n", scene.scene.title, place.name);
            table(&mut page, at, scene.scene.tiles.len());
        }
    }
    worthless(&mut page, scenes);
    page.push_str(ONLY_EXACT);
    growing(&mut page, films);
    single(&mut page, precision, effort);
    page
}

fn how(page: &mut String, scenes: &[MeasuredScene], magpylib: Option<&str>, effort: DialEffort) {
    let magpylib = match magpylib {
        Some(version) => {
            format!("magpylib {version} is called by its core function in a loop over tiles, its fastest way.")
        }
        None => "magpylib was omitted.".to_owned(),
    };
    let [nx, ny, nz] = effort.sizes.grid;
    let _ = write!(
        page,
        "
## How it was measured

All programs compute in binary64 on one thread, in turns, within one process; magpylib runs in a
Python process that waits for its turn. Times are medians of {} runs ({} of the peers), after one
run that is not counted. If the first counted run takes more than {} s, no other follows. Times
hold for the machine that wrote this page (best instruction set: {:?}). Ratios carry over to other
machines, but a difference of less than a factor of two between rows may be noise.

Grids have {nx} x {ny} x {nz} points, lists and look-ups {} random points ({} among the random
tiles). The time on a grid includes fitting its expansions. The time on a list is for a second
evaluation with the same scene. The time of look-ups begins after their box is prepared; the tables
give the time to prepare it.
magba 0.7.3 is called by its batch function for one tile after the other.
{magpylib}
The peers take the same time for every point, so they run on some of the points only.

Errors are |B - exact| / |exact|. magsplice computes the exact field, at every point of a grid and
at up to {} points of a list. At some of these points the exact field is checked against sums of
numbers with 130 digits. No error is counted as less than the error of the exact field found there.
[accuracy.md](accuracy.md) shows that the exact field of a tile is right to a few 1e-15 at any
distance, against tables of 40 digits. In the picture, the marks of the peers lie at the peers' own
errors.
",
        effort.rounds,
        effort.peer_rounds,
        SLOW_S,
        InstructionSet::available()[0],
        effort.sizes.points,
        effort.sizes.heap_points,
        effort.exact_pairs / scenes.iter().map(|scene| scene.scene.tiles.len()).max().unwrap_or(1),
    );
    page.push_str(
        "\n| scene | place | tiles | points of the peers | points with 130 digits |\n|---|---|---|---|---|\n",
    );
    for scene in scenes {
        for (place, at) in scene.scene.places.iter().zip(&scene.measurements) {
            let (tiles, peers, checked) = (scene.scene.tiles.len(), at.peer_points, at.checked_points);
            let _ = writeln!(page, "| {} | {} | {tiles} | {peers} | {checked} |", scene.scene.title, place.name);
        }
    }
    page.push_str(SCENES);
}

/// Writes the cases with a peer on the Pareto front.
fn comparison(page: &mut String, scenes: &[MeasuredScene], with_magpylib: bool) {
    page.push_str("\n## Against the peers\n\n");
    let peers = if with_magpylib { "magba or magpylib" } else { "magba" };
    let mut in_front = Vec::new();
    for scene in scenes {
        for (place, at) in scene.scene.places.iter().zip(&scene.measurements) {
            for (which, error) in ERROR_MEASURES {
                for peer in peers_in_front(at, error) {
                    let (title, place, name) = (scene.scene.title, place.name, peer.contender.name());
                    in_front.push(format!("* {title}, {place}: {name}, by its {which} error of {:.1e}", error(peer)));
                }
            }
        }
    }
    if in_front.is_empty() {
        let _ = write!(
            page,
            "\
At every place, magsplice has a method that is at least as fast and at least as accurate as
{peers}, both by the largest and by the median error, according to the numbers below.
"
        );
    } else {
        let _ = writeln!(
            page,
            "**Peers in front of magsplice**, where no method of magsplice is both as fast and as accurate:\n\n{}",
            in_front.join("\n")
        );
    }
}

fn table(page: &mut String, at: &Measurements, tiles: usize) {
    let exact = at.exact().ns;
    let magba = at.measured_by(Contender::Magba).next().map_or(f64::NAN, |m| m.ns);
    page.push_str(
        "| model | within | ns for a point | times exact | times magba | median error | largest error | note |\n",
    );
    page.push_str("|---|---|---|---|---|---|---|---|\n");
    for contender in Contender::ALL {
        for m in at.measured_by(contender) {
            let within = m.tolerance.map_or("-".to_owned(), |t| format!("{t:.0e}"));
            let _ = writeln!(
                page,
                "| {} | {within} | {} | {} | {} | {} | {} | {} |",
                contender.name(),
                digits(m.ns),
                digits(exact / m.ns),
                digits(magba / m.ns),
                error(m.median),
                error(m.worst),
                note(m, tiles)
            );
        }
        if contender == Contender::LookUps {
            for tolerance in &at.unprepared {
                let _ = writeln!(page, "| {} | {tolerance:.0e} | - | - | - | - | - | refused |", contender.name());
            }
        }
    }
}

fn note(m: &Measured, tiles: usize) -> String {
    let mut notes = Vec::new();
    if m.contender == Contender::Exact {
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

/// Writes the tolerances whose speedup does not justify their error.
fn worthless(page: &mut String, scenes: &[MeasuredScene]) {
    let mut list = String::new();
    for scene in scenes {
        for (place, at) in scene.scene.places.iter().zip(&scene.measurements) {
            for contender in [Contender::Grid, Contender::List, Contender::LookUps] {
                let slow = at.measured_by(contender).filter(|m| at.exact().ns < WORTHWHILE_SPEEDUP * m.ns);
                let slow: Vec<String> = slow.filter_map(|m| Some(format!("{:.0e}", m.tolerance?))).collect();
                if !slow.is_empty() {
                    let all = if slow.len() == TOLERANCES.len() { "any tolerance".to_owned() } else { slow.join(", ") };
                    let _ =
                        writeln!(list, "* {}, {}: {} within {all}", scene.scene.title, place.name, contender.name());
                }
            }
        }
    }
    if !list.is_empty() {
        let _ = write!(
            page,
            "
### Where the exact field is the better choice

In these cases a tolerance makes the field less than {WORTHWHILE_SPEEDUP} times as fast as the
exact field:

{list}"
        );
    }
}

fn growing(page: &mut String, films: &[Growth]) {
    let _ = write!(
        page,
        "
## Growth

Square films of unit cubes have as many random points 3 to 5 below them as tiles. Their fields are
computed within {GROWTH_TOLERANCE:.0e}. *Everything* is the time to build the scene from its tiles,
with the first evaluation, which builds the tree. *Again* is the time of a second evaluation at the
same points.

The exact field of large films is computed for some neighbourhoods of points, which are as dense as
in the whole list. Its time is scaled to all points (hollow in the picture). For single points, far
from each other, it would take several times longer. *Largest error* is over the points of the exact
field. `cargo bench -p magsplice-benches --bench dial` prints the same numbers.

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
            "From the smallest to the largest film, the exponent of *{what}* is {exponent:.2}. The goal of at most\n\
             {LARGEST_EXPONENT} is {verdict}."
        );
    }
}

fn single(page: &mut String, precision: &PrecisionTable, effort: DialEffort) {
    let _ = write!(
        page,
        "
## Why the closed form is not evaluated in single precision

The textbook closed form is a sum of logarithms and arctangents over the corners of a tile. It takes
differences of nearly equal numbers and loses three digits for each decade of distance. binary32 has
seven digits. The table gives the errors of the same formula in both precisions, over {} random
tiles at each distance:

| distance, sizes | binary32, median | binary32, largest | binary64, median | binary64, largest |
|---|---|---|---|---|
",
        effort.single_cases
    );
    let row = |page: &mut String, name: &str, [single, double]: &[PrecisionErrors; 2]| {
        let [a, b] = [single, double].map(|e| format!("{} | {}", error(e.median), error(e.worst)));
        let _ = writeln!(page, "| {name} | {a} | {b} |");
    };
    for (distance, errors) in &precision.by_distance {
        row(page, &digits(*distance), errors);
    }
    row(page, "published film, in its volume", &precision.film);
    page.push_str(SINGLE);
}

/// Three digits, without an exponent where that is shorter.
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

This page is generated by `cargo run --release -p magsplice-pages -- accuracy-and-speed`. Do not
edit it. The program needs a Python that can import magpylib (`pip install magpylib`), or
`--without-magpylib`.

The page gives the time and the error of every way to evaluate a field, exact and to a tolerance. A
tolerance is set by `scene.with_accuracy(Accuracy::Within(Tolerance::relative(1e-6)?))`.

![Time for a point against error](pictures/accuracy-and-speed.svg)
";

const SCENES: &str = "
The published film and the 80 mm film are in `layouts/`. Their volume is the published working
volume, 3 to 5 mm below the film; *under all of it* covers 72 x 72 mm. The random tiles have sides
of 0.3 to 1.2 and any polarization, and none overlap. Their points lie in the same cube, some of
them inside tiles. The one tile measures 3.3 x 1.7 x 1 mm and is polarized obliquely to its sides.
";

const TABLES: &str = "
## Time and error at each tolerance

* *exact*: `Scene::field_into`, direct summation over all tiles.
* *grid*: `Scene::field_on_grid`, which fits Chebyshev expansions to boxes without tiles.
* *list of points*: `Scene::field_into`, which sums over a tree of the tiles.
* *look-ups*: `FittedField`, a box that is prepared once.

*Within* is the requested relative tolerance, *largest error* the largest measured error.
";

const ONLY_EXACT: &str = "
### Where only the exact field applies

* Single points (`Scene::field`), gradients (`Scene::gradient`) and J are exact
  whatever the accuracy.
* Look-ups in boxes with tiles inside or nearby: `FittedField` refuses the box. A grid there is
  divided, and its points near the tiles are evaluated as a list.
* Tiles near a point of a list are summed directly. The tree expands distant tiles only.
* Tolerances close to 1e-13 of the sum of the tiles' fields give the exact field. Points at which
  even the exact field may exceed the tolerance are reported as errors.

### Scenes drawn at random

`cargo bench -p magsplice-benches --bench costs` draws 300 scenes from a seed: kinds, shapes and
rotations of tiles, distances, shapes of grids, lists of points, and tolerances from 1e-2 to 1e-12.
It prints the worst ratios of least times over interleaved runs on one thread. It also walks along
the aspects and distances of one tile in steps of a quarter of an octave. One run printed:

* Time within a tolerance over the exact time: 1.40, a plate of aspect 41 within 1.1e-10 of |B| at
  231 points. Six of 284 scenes are above 1.25. Where the tolerance refuses points, 1.46.
* The same along the walk within 1e-6: 1.94, beside a strip of aspect 512.
* Time of the gradient over the time of the field: 3.3, far from one rod of aspect 12. Along the
  walk, 3.2, far from any tile.
* Times of one tile at neighbouring steps differ by up to 1.95 times for the field, where the form
  for points close to bars of aspect 4 ends, and by up to 1.31 times for the gradient.
";

const SINGLE: &str = "
The multipole series for distant tiles (docs/physics.md, section 2.7) would not lose these digits.
But the closed form computes the field near a tile, and the fields of the tiles of a film cancel. So
even far away, binary32 alone could not guarantee a tolerance. Single precision would suffice for
drawings within a few sizes of the tiles, where colours and arrows show two to three digits. A grid
within 1e-2 suffices for drawings too, and its error is known.
";
