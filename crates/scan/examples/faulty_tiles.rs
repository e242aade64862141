//! The share of scans that identify exactly the three faulty tiles of a film, by height and noise:
//!
//!     cargo run --release -p magsplice-scan --example faulty_tiles -- layouts/published-film.toml 100
//!
//! The arguments are a layout, a number of films, and optionally `workshop` or `jig` for the
//! expected errors of all other tiles. In each film one tile is turned by 3 degrees about z,
//! another is 5 % weaker, and a third is displaced by 0.1 mm in the plane. The scan covers the film
//! in steps of 1 mm.

use std::f64::consts::TAU;
use std::time::Instant;

use glam::DVec3;
use magsplice_layout::{FilmTolerance, Layout, Preset, TileErrors};
use magsplice_magnet::{BoundingBox, PerTileError, Tile};
use magsplice_scan::{Diagnosis, DiagnosisSettings, ErrorKind, FieldScan, ScanDiagnosis, ScanParameters};
use magsplice_tolerance::RealFilm;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

const HEIGHTS_MM: [f64; 4] = [0.5, 1.0, 2.0, 3.0];
const NOISES_T: [f64; 3] = [1e-6, 1e-5, 5e-5];
const STEP_MM: f64 = 1.0;

#[path = "../tests/scan/noisy.rs"]
mod noisy;

use noisy::readings;

/// Points below the whole film, at this distance.
fn scan_points(tiles: &[Tile], height_mm: f64) -> Vec<DVec3> {
    let around = BoundingBox::from_tiles(tiles);
    let count = |axis: usize| ((around.upper[axis] - around.lower[axis]) / STEP_MM).round() as usize + 1;
    let (nx, ny, z) = (count(0), count(1), around.lower.z - height_mm);
    let at = |i: usize, j: usize| around.lower + STEP_MM * DVec3::new(i as f64, j as f64, 0.0);
    (0..nx * ny).map(|n| at(n % nx, n / nx).with_z(z)).collect()
}

/// Three different tiles with their errors, added to the expected errors.
fn faulty_tiles(count: usize, random: &mut ChaCha8Rng) -> [(usize, ErrorKind, PerTileError<f64>); 3] {
    let mut chosen: Vec<usize> = Vec::new();
    while chosen.len() < 3 {
        let tile = random.random_range(0..count);
        if !chosen.contains(&tile) {
            chosen.push(tile);
        }
    }
    let [mut turn, mut weak, mut moved] = [PerTileError::default(); 3];
    turn.rotation[2] = if random.random::<bool>() { 3_f64.to_radians() } else { -3_f64.to_radians() };
    weak.strength = -0.05;
    let along = TAU * random.random::<f64>();
    (moved.position[0], moved.position[1]) = (0.1 * along.cos(), 0.1 * along.sin());
    [
        (chosen[0], ErrorKind::Turn, turn),
        (chosen[1], ErrorKind::Strength, weak),
        (chosen[2], ErrorKind::Displacement, moved),
    ]
}

fn names_exactly(found: &Diagnosis, wanted: &[(usize, ErrorKind)]) -> bool {
    let mut detected: Vec<(usize, ErrorKind)> =
        found.detected.iter().map(|detected| (detected.candidate.tile, detected.candidate.kind)).collect();
    let mut wanted = wanted.to_vec();
    detected.sort_unstable();
    wanted.sort_unstable();
    detected == wanted
}

/// Three shares of films: exactly the three faulty tiles are identified; all faulty tiles are
/// identified, possibly with others; a fault-free film has an identified tile.
fn measure(layout: &Layout, films: u64, expected: Option<&TileErrors>, height_mm: f64, noise_t: f64) -> [u64; 3] {
    let tiles = layout.bare_tiles();
    let points_mm = scan_points(&tiles, height_mm);
    let tolerance = expected.map_or_else(FilmTolerance::default, |errors| FilmTolerance::of_tiles(errors, tiles.len()));
    let settings = DiagnosisSettings { expected: tolerance.clone(), ..DiagnosisSettings::default() };
    let scan = FieldScan { points_mm: points_mm.clone(), noise_t: DVec3::splat(noise_t) };
    let diagnosis = ScanDiagnosis::new(&tiles, scan, settings, ScanParameters::PERFECT).expect("a scan outside tiles");
    let population = RealFilm::new(&tiles, &tolerance);
    let read = |tiles: &[Tile], random: &mut ChaCha8Rng| readings(tiles, &points_mm, noise_t, random);
    let mut counts = [0; 3];
    for film in 0..films {
        let mut random = ChaCha8Rng::seed_from_u64(film);
        let made = population.sample_tiles(film, 1).expect("tiles exist");
        let faulty = faulty_tiles(tiles.len(), &mut random);
        let mut errors = vec![PerTileError::default(); tiles.len()];
        faulty.iter().for_each(|(tile, _, values)| errors[*tile] = *values);
        let film =
            RealFilm::new(&made, &FilmTolerance::default()).tiles_with_errors(&errors, &[]).expect("tiles exist");
        let found = diagnosis.diagnose(&read(&film, &mut random), |_| {}).expect("a diagnosis");
        let wanted = faulty.map(|(tile, kind, _)| (tile, kind));
        let is_detected = |tile: usize| found.detected.iter().any(|detected| detected.candidate.tile == tile);
        counts[0] += u64::from(names_exactly(&found, &wanted));
        counts[1] += u64::from(wanted.iter().all(|(tile, _)| is_detected(*tile)));
        let right = diagnosis.diagnose(&read(&made, &mut random), |_| {}).expect("a diagnosis");
        counts[2] += u64::from(!right.detected.is_empty());
    }
    counts
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [path, films, rest @ ..] = &arguments[..] else { panic!("arguments: LAYOUT FILMS [workshop|jig]") };
    let layout = Layout::read(path).unwrap_or_else(|error| panic!("{error}"));
    let films: u64 = films.parse().expect("a number of films");
    let expected = rest.first().map(|preset| match preset.as_str() {
        "workshop" => Preset::Workshop.errors(),
        "jig" => Preset::Jig.errors(),
        other => panic!("{other} is neither workshop nor jig"),
    });
    println!("{path}: of {films} films: exactly the three faulty tiles / all three and others / false alarms");
    for height_mm in HEIGHTS_MM {
        for noise_t in NOISES_T {
            let start = Instant::now();
            let [exact, all, false_alarms] = measure(&layout, films, expected.as_ref(), height_mm, noise_t);
            let seconds = start.elapsed().as_secs_f64();
            println!(
                "{height_mm} mm, {} uT: {exact} / {all} / {false_alarms} ({:.2} s per film)",
                noise_t * 1e6,
                seconds / (2 * films) as f64
            );
        }
    }
}
