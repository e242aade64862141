//! The time of a sample of a film as made.
//!
//! `cargo bench -p magsplice-benches --bench tolerance` prints on one thread
//!
//! * `ratio: tolerance-sample-over-film = <time of a sample / time of one exact evaluation>` for
//!   the published film with workshop errors, at the 405 points of its working volume and its
//!   reference point. A sample draws a film, computes its field and evaluates its errors; the exact
//!   evaluation prepares the same misplaced tiles and computes their field.
//!
//! The ratio is the median over interleaved pairs of runs. `-- --test` runs a pair once.

use std::hint::black_box;
use std::time::Instant;

use glam::DVec3;
use magsplice::field::{Quantity, Scene};
use magsplice::layout::{FilmTolerance, Preset};
use magsplice::tolerance::{EvaluationGrid, RealFilm, Sampler};
use magsplice_benches::{median, shipped_layout};

/// Numbers of pairs of runs, and of samples in each run.
const FULL: [u64; 2] = [40, 25];
const ONCE: [u64; 2] = [1, 2];

fn main() {
    let [pairs, samples] = if std::env::args().any(|a| a == "--test") { ONCE } else { FULL };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    pool.install(|| sample_over_film(pairs, samples));
}

fn sample_over_film(pairs: u64, samples: u64) {
    let layout = shipped_layout("published-film");
    let (volume, ideal) = (layout.volume.as_ref().expect("stated"), layout.ideal.expect("stated"));
    let volume = EvaluationGrid { grid: volume.grid, reference: volume.reference_mm };
    let tiles = layout.bare_tiles();
    let film = RealFilm::new(&tiles, &FilmTolerance::of_tiles(&Preset::Workshop.errors(), tiles.len()));
    let sampler = Sampler::new(&film, &volume, &ideal, 1).expect("no neighbour");
    let points: Vec<DVec3> = volume.grid.points().chain([volume.reference]).collect();
    let mut field_t = vec![DVec3::ZERO; points.len()];
    let (mut ratios, mut nanoseconds) = (Vec::new(), Vec::new());
    for pair in 0..pairs {
        let numbers = pair * samples..(pair + 1) * samples;
        let films: Vec<_> = numbers.clone().map(|sample| film.sample_tiles(1, sample).expect("valid")).collect();
        let start = Instant::now();
        for tiles in &films {
            let scene = Scene::new(black_box(tiles));
            scene.field_into(Quantity::FluxDensity, &points, &mut field_t).expect("bounded");
            black_box(&field_t);
        }
        let of_film = start.elapsed().as_secs_f64();
        let start = Instant::now();
        for sample in numbers {
            black_box(sampler.errors_of(sample).expect("parameters"));
        }
        let of_sample = start.elapsed().as_secs_f64();
        ratios.push(of_sample / of_film);
        nanoseconds.push(of_sample * 1e9 / (samples as usize * tiles.len() * points.len()) as f64);
    }
    println!(
        "ratio: tolerance-sample-over-film = {:.2}   ({} tiles, {} points, {:.1} ns per pair in a sample)",
        median(ratios),
        tiles.len(),
        points.len(),
        median(nanoseconds)
    );
}
