//! Speedup of fields to a tolerance over the exact field of magsplice, on one thread.
//!
//! `cargo bench -p magsplice-benches --bench dial` prints for each case `ratio: <case> = <exact
//! time / time>`, the median over interleaved pairs of runs, with the largest error found.
//! `growth:` lines give the times of films with as many points as tiles, `exponent:` lines the
//! power of that number in the growth of the times. `-- --test` runs each case once, on a smaller
//! scene.

use std::hint::black_box;
use std::time::Instant;

use glam::DVec3;
use magsplice::field::{Accuracy, Grid, Quantity, Scene, Tolerance};
use magsplice_benches::{Growth, growth, median, shipped_layout, working_volume};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Interleaved pairs of runs; the median ratio is printed.
const PAIRS: usize = 15;

/// Tiles along each side of the film compared with direct summation, and the number of runs.
const LARGE_FILM: (usize, usize) = (316, 5);
/// Tiles along each side and number of runs of the films for the exponents of growth.
const FILMS: [(usize, usize); 4] = [(32, 15), (100, 7), (316, 3), (1000, 1)];

/// Number of look-ups in the prepared volume.
const LOOK_UPS: usize = 100_000;

fn main() {
    let once = std::env::args().any(|a| a == "--test");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    pool.install(|| {
        let scene = Scene::new(&shipped_layout("published-film").bare_tiles());
        let (pairs, volume) =
            if once { (1, working_volume([21, 21, 11])) } else { (PAIRS, working_volume([81, 81, 41])) };
        for exponent in [2, 4, 6, 9] {
            on_grid(&scene, &volume, 10_f64.powi(-exponent), &format!("film-within-1e-{exponent}"), pairs);
        }
        for exponent in [3, 6, 9] {
            let count = if once { LOOK_UPS / 100 } else { LOOK_UPS };
            look_ups(&scene, &volume, 10_f64.powi(-exponent), &format!("film-look-ups-1e-{exponent}"), count, pairs);
        }
        large_film(if once { (32, 1) } else { LARGE_FILM });
        growing_films(if once { &[(10, 1), (32, 1)] } else { &FILMS });
    });
}

fn on_grid(scene: &Scene, grid: &Grid, fraction: f64, name: &str, pairs: usize) {
    let within = scene.clone().with_accuracy(Accuracy::Within(Tolerance::relative(fraction).expect("a tolerance")));
    let field = |scene: &Scene, field: &mut [DVec3]| {
        scene.field_on_grid_into(Quantity::FluxDensity, black_box(grid), field).expect("bounded");
    };
    report(name, grid.len(), pairs, |values| field(scene, values), |values| field(&within, values));
}

fn look_ups(scene: &Scene, grid: &Grid, fraction: f64, name: &str, count: usize, pairs: usize) {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let points: Vec<DVec3> = (0..count)
        .map(|_| DVec3::from([0, 1, 2].map(|axis: usize| random.random_range(grid.lower()[axis]..grid.upper()[axis]))))
        .collect();
    let tolerance = Tolerance::relative(fraction).expect("a tolerance");
    let start = Instant::now();
    let fitted = scene.fitted_field(grid.lower(), grid.upper(), tolerance).expect("no tile is near");
    let made = start.elapsed();
    report(
        name,
        count,
        pairs,
        |field| scene.field_into(Quantity::FluxDensity, black_box(&points), field).expect("bounded"),
        |field| fitted.flux_density_into(black_box(&points), field).expect("in the box"),
    );
    let cells = fitted.cells();
    println!("       made in {:.1} ms, {cells:?} cells, {} kB", 1e3 * made.as_secs_f64(), fitted.memory_bytes() / 1000);
}

fn one_millionth() -> Tolerance {
    Tolerance::relative(1e-6).expect("a tolerance")
}

/// Prints the speedup of one large film. The exact time is measured at some of the points and
/// scaled to all.
fn large_film((side, runs): (usize, usize)) {
    let film = growth(side, one_millionth(), runs);
    println!(
        "ratio: 1e{:.0}-tiles-within-1e-6 = {:.1}   ({} tiles, as many points; {:.1} with everything counted, scene and tree made; exact time scaled from {} \
         points; the largest error there is {:.1e} of |B|)",
        (film.tiles as f64).log10(),
        film.exact_s / film.again_s,
        film.tiles,
        film.exact_everything_s() / film.everything_s(),
        film.exact_points,
        film.worst
    );
}

fn growing_films(films: &[(usize, usize)]) {
    let films: Vec<Growth> = films.iter().map(|&(side, runs)| growth(side, one_millionth(), runs)).collect();
    for film in &films {
        println!(
            "growth: {} tiles and points within 1e-6   scene {:.3e} s, first evaluation {:.3e} s, second {:.3e} s; exact {:.3e} s, scaled from {} points; \
             the largest error there is {:.1e} of |B|",
            film.tiles, film.scene_s, film.first_s, film.again_s, film.exact_s, film.exact_points, film.worst
        );
    }
    let ends = films.iter().zip(&films[1..]).chain(films.first().zip(films.last()).filter(|_| films.len() > 2));
    for (smaller, larger) in ends {
        let [from, to] = [smaller, larger].map(|film| (film.tiles as f64).log10());
        println!(
            "exponent: 1e{from:.0} to 1e{to:.0} = {:.2} for the second evaluation, {:.2} for everything",
            smaller.exponent_to(larger, |film| film.again_s),
            smaller.exponent_to(larger, Growth::everything_s)
        );
    }
}

fn report(name: &str, points: usize, pairs: usize, exact: impl Fn(&mut [DVec3]), within: impl Fn(&mut [DVec3])) {
    let (mut truth, mut field) = (vec![DVec3::ZERO; points], vec![DVec3::ZERO; points]);
    let mut seconds = Vec::new();
    let ratios: Vec<f64> = (0..pairs)
        .map(|_| {
            let start = Instant::now();
            within(&mut field);
            let own = start.elapsed().as_secs_f64();
            let start = Instant::now();
            exact(&mut truth);
            seconds.push(own);
            start.elapsed().as_secs_f64() / own
        })
        .collect();
    let worst = truth.iter().zip(&field).map(|(a, b)| (*a - *b).length() / a.length()).fold(0.0, f64::max);
    println!(
        "ratio: {name} = {:.1}   ({points} points, {:.1} ns each; the largest error is {worst:.1e} of |B|)",
        median(ratios),
        1e9 * median(seconds) / points as f64
    );
}
