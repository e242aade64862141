//! Costs of scenes drawn at random, and of one tile along fine steps of aspect and distance.
//!
//! `cargo bench -p magsplice-benches --bench costs` prints on one thread
//!
//! * `ratio: random-within-over-exact = <time within a tolerance / exact time>`, the worst of 300
//!   scenes without those where the tolerance refuses points, and
//!   `ratio: random-within-over-exact-refused`, the worst of these,
//! * `ratio: random-gradient-over-field = <gradient time / field time>`, the worst of 300 scenes,
//! * `ratio: walk-field`, `walk-gradient`: the largest ratio of the times of one tile at
//!   neighbouring steps of aspect or distance,
//! * `ratio: walk-gradient-over-field`: the worst at any step,
//! * `ratio: walk-within-over-exact`: the same for a tolerance of 1e-6.
//!
//! * `ratio: head-over-sensor`: time of the weighted sum of five sensors over that of one sensor,
//!   below the published film.
//!
//! A time is the smallest of interleaved runs. The worst cases are measured again, and a ratio is
//! the least time of all rounds over the least other time. `-- --test` runs few cases once;
//! `-- seed=N` draws other scenes; a word selects the ratios with this word in their names.

use std::hint::black_box;
use std::time::Instant;

use glam::{DMat3, DVec3};
use magsplice::field::{Accuracy, Quantity, Scene, Tile, Tolerance};
use magsplice::sensor::SensedField;
use magsplice_benches::{RandomScene, random_scenes, shipped_layout, working_volume};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Number of random scenes.
const SCENES: usize = 300;
/// Number of worst cases that are measured again.
const REPEATED: usize = 12;
/// Number of rounds in which they are measured again.
const ROUNDS: usize = 4;
/// Largest ratio of the time within a tolerance that we accept.
const GOAL: f64 = 1.25;
/// Seconds of interleaved runs of a case, and of a case measured again.
const SECONDS: [f64; 2] = [0.06, 0.5];
/// Smallest number of interleaved runs.
const RUNS: usize = 5;
/// Steps of the walks in each octave of aspect and of distance, and the numbers of octaves.
const STEPS: usize = 4;
const ASPECTS: usize = 10;
const DISTANCES: usize = 20;
/// Smallest distance of the walk, in longest sides.
const NEAREST: f64 = 1e-3;
/// Number of times that a walk is measured; the least times count.
const PASSES: usize = 4;
/// Number of readings of a head.
const HEAD_POINTS: usize = 20_000;
/// Points at each step.
const POINTS: usize = 512;

#[derive(Clone, Copy)]
struct Effort {
    scenes: usize,
    runs: usize,
    seconds: [f64; 2],
    steps: usize,
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let once = arguments.iter().any(|a| a == "--test");
    let effort = if once {
        Effort { scenes: 10, runs: 1, seconds: [0.0; 2], steps: 1 }
    } else {
        Effort { scenes: SCENES, runs: RUNS, seconds: SECONDS, steps: STEPS }
    };
    let seed = arguments.iter().find_map(|a| a.strip_prefix("seed=")?.parse().ok()).unwrap_or(1);
    let wanted = arguments.iter().find(|a| !a.starts_with('-') && !a.contains('=')).cloned().unwrap_or_default();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    pool.install(|| {
        let (refused, kept): (Vec<_>, Vec<_>) = random_scenes(seed).take(effort.scenes).partition(refuses_points);
        if "random-within-over-exact".contains(&wanted) {
            worst_of_scenes("random-within-over-exact", effort, &kept, within_and_exact);
            worst_of_scenes("random-within-over-exact-refused", effort, &refused, within_and_exact);
        }
        if "random-gradient-over-field".contains(&wanted) {
            let all: Vec<_> = kept.into_iter().chain(refused).collect();
            worst_of_scenes("random-gradient-over-field", effort, &all, |of, effort, round| {
                gradient_and_field(&Scene::new(&of.tiles), &of.points, effort, round)
            });
        }
        if "walk".contains(&wanted) {
            walks(effort);
        }
        if "head-over-sensor".contains(&wanted) {
            head_over_sensor(effort);
        }
    });
}

/// Prints the worst scenes, the worst ratio, and the number of scenes above [`GOAL`]. `times` are
/// the least times of two works in a round of runs.
fn worst_of_scenes(
    name: &str,
    effort: Effort,
    scenes: &[RandomScene],
    times: impl Fn(&RandomScene, Effort, usize) -> [f64; 2],
) {
    let mut all: Vec<([f64; 2], &RandomScene)> = scenes.iter().map(|scene| (times(scene, effort, 0), scene)).collect();
    let ratio = |[time, other]: [f64; 2]| time / other;
    let sort = |all: &mut Vec<([f64; 2], &RandomScene)>| {
        all.sort_by(|(one, _), (other, _)| ratio(*other).total_cmp(&ratio(*one)));
    };
    for _ in 0..ROUNDS {
        sort(&mut all);
        for (least, scene) in all.iter_mut().take(REPEATED) {
            let again = times(scene, effort, 1);
            *least = [0, 1].map(|which| least[which].min(again[which]));
        }
    }
    sort(&mut all);
    for (least, scene) in all.iter().take(REPEATED) {
        println!(
            "{name}: {:.3}   {:.2} us over {:.2} us   {}",
            ratio(*least),
            1e6 * least[0],
            1e6 * least[1],
            scene.name
        );
    }
    if let Some((least, scene)) = all.first() {
        let above = all.iter().filter(|(least, _)| ratio(*least) > GOAL).count();
        println!("{name}: {above} of {} scenes are above {GOAL}", scenes.len());
        println!("ratio: {name} = {:.2}   ({} scenes; {})", ratio(*least), scenes.len(), scene.name);
    }
}

/// Prints the ratio for the readings of the five sensors of `layouts/heads/published-cross.toml`.
fn head_over_sensor(effort: Effort) {
    let layout = shipped_layout("heads/published-cross");
    let (scene, volume) = (Scene::new(&layout.bare_tiles()), working_volume([2; 3]));
    let head = SensedField::of_head(&scene, layout.head().expect("a head"), &volume).expect("readings");
    let one = SensedField::from(&scene);
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let (lower, extent) = (volume.lower(), volume.upper() - volume.lower());
    let mut place = || lower + extent * DVec3::from([0, 1, 2].map(|_| random.random_range(0.0..1.0_f64)));
    let points: Vec<DVec3> = (0..HEAD_POINTS).map(|_| place()).collect();
    let [head, one] = least_times(effort, 1, |which| {
        drop(black_box([&head, &one][which].readings_t(black_box(&points))));
    });
    let ns = |seconds: f64| 1e9 * seconds / HEAD_POINTS as f64;
    println!("ratio: head-over-sensor = {:.2}   ({:.0} over {:.0} ns a reading)", head / one, ns(head), ns(one));
}

/// Whether the tolerance refuses points that have an exact field.
fn refuses_points(of: &RandomScene) -> bool {
    let exact = Scene::new(&of.tiles);
    let within = exact.clone().with_accuracy(Accuracy::Within(of.tolerance));
    let without_field =
        |scene: &Scene| scene.field_at(Quantity::FluxDensity, &of.points).err().map_or(0, |errors| errors.0.len());
    without_field(&within) > without_field(&exact)
}

fn within_and_exact(of: &RandomScene, effort: Effort, round: usize) -> [f64; 2] {
    let exact = Scene::new(&of.tiles);
    let within = exact.clone().with_accuracy(Accuracy::Within(of.tolerance));
    let mut values = vec![DVec3::ZERO; of.points.len()];
    // Points without a field are part of the scenes.
    let mut evaluate = |scene: &Scene| match &of.grid {
        Some(grid) => drop(black_box(scene.field_on_grid_into(Quantity::FluxDensity, black_box(grid), &mut values))),
        None => drop(black_box(scene.field_into(Quantity::FluxDensity, black_box(&of.points), &mut values))),
    };
    least_times(effort, round, |which| evaluate([&within, &exact][which]))
}

/// Seconds for the gradient and for the field.
fn gradient_and_field(scene: &Scene, points: &[DVec3], effort: Effort, round: usize) -> [f64; 2] {
    let mut values = vec![DVec3::ZERO; points.len()];
    let mut gradients = vec![DMat3::ZERO; points.len()];
    least_times(effort, round, |which| match which {
        0 => drop(black_box(scene.gradient_into(Quantity::FluxDensity, black_box(points), &mut gradients))),
        _ => drop(black_box(scene.field_into(Quantity::FluxDensity, black_box(points), &mut values))),
    })
}

/// The smallest time of each of two works over interleaved runs.
fn least_times(effort: Effort, round: usize, mut work: impl FnMut(usize)) -> [f64; 2] {
    let (begin, mut least, mut runs) = (Instant::now(), [f64::INFINITY; 2], 0);
    // The first run prepares what is kept.
    while runs <= effort.runs || begin.elapsed().as_secs_f64() < effort.seconds[round] {
        for (which, least) in least.iter_mut().enumerate() {
            let start = Instant::now();
            work(which);
            if runs > 0 {
                *least = least.min(start.elapsed().as_secs_f64());
            }
        }
        runs += 1;
    }
    least
}

/// Names of the times of a walk.
const TIMES: [&str; 3] = ["field", "gradient", "within"];

/// A tile of a walk: its kind, aspect, and the least times inside it and at each distance.
struct WalkRow {
    kind: &'static str,
    aspect: f64,
    size: DVec3,
    times: Vec<[f64; 3]>,
}

/// The tiles of a walk, without times.
fn walk_rows(steps: usize) -> Vec<WalkRow> {
    let sizes = |kind, aspect: f64| match kind {
        "rod" => DVec3::new(1.0 / aspect, 0.8 / aspect, 1.0),
        "plate" => DVec3::new(1.0, 0.8, 0.8 / aspect),
        _ => DVec3::new(1.0, 1.0 / aspect, 0.8 / aspect.powf(1.5)),
    };
    let aspects = (0..=ASPECTS * steps).map(|step| 2_f64.powf(step as f64 / steps as f64));
    let rows = ["rod", "plate", "strip"].into_iter().flat_map(|kind| aspects.clone().map(move |aspect| (kind, aspect)));
    rows.map(|(kind, aspect)| WalkRow { kind, aspect, size: sizes(kind, aspect), times: Vec::new() }).collect()
}

/// Prints the largest ratios of neighbours, and of times at the same step.
fn walks(effort: Effort) {
    let mut rows = walk_rows(effort.steps);
    // A disturbance of the machine lasts longer than the times of a row, so rows are measured again
    // after all others.
    for _ in 0..PASSES {
        for row in &mut rows {
            let times = times_by_distance(row.size, effort);
            match row.times.is_empty() {
                true => row.times = times,
                false => row.times.iter_mut().zip(times).for_each(|(least, again)| {
                    (0..3).for_each(|i| least[i] = least[i].min(again[i]));
                }),
            }
        }
    }
    let distance = |n: usize| match n {
        0 => "inside".to_string(),
        n => format!("at {:.4} sides", NEAREST * 2_f64.powf((n - 1) as f64 / effort.steps as f64)),
    };
    let (mut jumps, mut over) = ([0, 1, 2].map(|_| (1.0, String::new())), [0, 1].map(|_| (0.0, String::new())));
    let keep = |largest: &mut (f64, String), ratio: f64, name: String| {
        if ratio > largest.0 {
            *largest = (ratio, name);
        }
    };
    for (r, row) in rows.iter().enumerate() {
        let before = r.checked_sub(1).map(|before| &rows[before]).filter(|before| before.kind == row.kind);
        for (n, times) in row.times.iter().enumerate() {
            let place = format!("{} of aspect {:.2} {}", row.kind, row.aspect, distance(n));
            for (i, jump) in jumps.iter_mut().enumerate() {
                let mut compare = |other: f64, step: &str| {
                    let ratio = (times[i] / other).max(other / times[i]);
                    keep(jump, ratio, format!("{other:.1} to {:.1} ns by the {step}, {place}", times[i]));
                };
                // From the inside to the outside is no small step.
                if n > 1 {
                    compare(row.times[n - 1][i], "distance");
                }
                if let Some(before) = before {
                    compare(before.times[n][i], "aspect");
                }
            }
            keep(&mut over[0], times[1] / times[0], format!("{:.1} over {:.1} ns, {place}", times[1], times[0]));
            keep(&mut over[1], times[2] / times[0], format!("{:.1} over {:.1} ns, {place}", times[2], times[0]));
        }
    }
    for (name, (ratio, place)) in TIMES.iter().zip(jumps) {
        println!("ratio: walk-{name} = {ratio:.2}   ({place})");
    }
    for (name, (ratio, place)) in ["gradient-over-field", "within-over-exact"].iter().zip(over) {
        println!("ratio: walk-{name} = {ratio:.2}   ({place})");
    }
}

/// Nanoseconds per point of the field, the gradient and the field within 1e-6 of one tile: inside,
/// then at each distance.
fn times_by_distance(size: DVec3, effort: Effort) -> Vec<[f64; 3]> {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let mut vector = || DVec3::from([0, 1, 2].map(|_| random.random_range(-1.0..1.0_f64)));
    let scene = Scene::new(&[Tile::new(DVec3::ZERO, size, vector()).expect("a valid tile")]);
    let tolerance = Tolerance::relative(1e-6).expect("a tolerance");
    let within = scene.clone().with_accuracy(Accuracy::Within(tolerance));
    let times = |points: Vec<DVec3>| {
        let [gradient, field] = gradient_and_field(&scene, &points, Effort { seconds: [0.0; 2], ..effort }, 0);
        let mut values = vec![DVec3::ZERO; points.len()];
        let [within, again] = least_times(Effort { seconds: [0.0; 2], ..effort }, 0, |which| {
            drop(black_box([&within, &scene][which].field_into(
                Quantity::FluxDensity,
                black_box(&points),
                &mut values,
            )));
        });
        [field.min(again), gradient, within].map(|seconds| 1e9 * seconds / points.len() as f64)
    };
    let inside: Vec<DVec3> = (0..POINTS).map(|_| 0.5 * size * vector()).collect();
    let mut rows = vec![times(inside)];
    for step in 0..=DISTANCES * effort.steps {
        let half = 0.5 * size + NEAREST * 2_f64.powf(step as f64 / effort.steps as f64);
        let points = (0..POINTS).map(|n| {
            let mut point = half * vector();
            point[n % 3] = half[n % 3].copysign(point[n % 3]);
            point
        });
        rows.push(times(points.collect()));
    }
    rows
}
