//! Speedup of magsplice over the fastest call of magba 0.7.3 on one thread, then of several threads
//! over one.
//!
//! `cargo bench -p magsplice-benches --bench peers` prints for each workload `ratio: <workload> =
//! <magba time / magsplice time>`, the median over interleaved pairs of runs in one process, and
//! the median difference of the two fields. Then it prints `threads: <workload>, <n> threads =
//! <time of one / time of n>`, followed by the same ratio for n independent scenes evaluated at the
//! same time, which is the limit of the machine.
//!
//! Arguments after `--`:
//!
//! | argument | effect |
//! |---|---|
//! | `--test` | runs each workload once on few points |
//! | `NAME` | runs the workloads with this text in their names |
//! | `--threads` | skips the comparison with magba |
//! | `--avx2` or another instruction set | compares with this set instead of the best one |

use std::hint::black_box;
use std::time::Instant;

use glam::DVec3;
use magsplice::field::{Accuracy, InstructionSet, Quantity, Scene, Tolerance};
use magsplice_benches::{Magba, Speedup, Workload, speedups, workloads};
use nalgebra::Vector3;

/// Interleaved pairs of runs; the median ratio is printed.
const PAIRS: usize = 7;

/// Above this number of tile-point pairs, where magba takes more than a few seconds, the ratio is a
/// median over [`FEW_PAIRS`].
const LARGE_RUN: usize = 20_000_000;
/// See [`LARGE_RUN`].
const FEW_PAIRS: usize = 3;

/// Number of runs with threads. They vary more, because a program on any of the processors disturbs
/// them.
const THREAD_RUNS: usize = 25;

fn main() {
    let once = std::env::args().any(|a| a == "--test");
    let wanted = std::env::args().skip(1).find(|a| !a.starts_with('-')).unwrap_or_default();
    let sets = InstructionSet::available();
    let threads_only = std::env::args().any(|a| a == "--threads");
    let named = |set: &&InstructionSet| std::env::args().any(|a| a == format!("--{set:?}").to_lowercase());
    let set = *sets.iter().find(named).unwrap_or(&sets[0]);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    let peers = workloads().into_iter().filter(|_| !threads_only).flat_map(variants);
    for (workload, accuracy) in peers.filter(|(w, _)| w.name.contains(&wanted)) {
        let pairs = if workload.pairs() > LARGE_RUN { FEW_PAIRS } else { PAIRS };
        let (workload, pairs) = if once { (workload.thinned(20_000), 1) } else { (workload, pairs) };
        pool.install(|| compare(workload, accuracy, set, pairs));
    }
    for workload in workloads().into_iter().filter(|w| w.name.contains(&wanted)) {
        threads(workload, once);
    }
}

fn threads(workload: Workload, once: bool) {
    let (workload, runs) = if once { (workload.thinned(20_000), 1) } else { (workload, THREAD_RUNS) };
    for Speedup { threads, times, apart } in speedups(&workload, runs) {
        let name = workload.name;
        println!(
            "threads: {name}, {threads} threads = {times:.2}   ({threads} scenes at the same time, one thread each = {apart:.2})"
        );
    }
}

/// The workload with its exact field; for the film also with a tolerance, on the grid of its
/// points.
fn variants(workload: Workload) -> Vec<(Workload, Accuracy)> {
    let mut variants = Vec::new();
    if workload.name == "film-exact" {
        let within = Accuracy::Within(Tolerance::relative(1e-9).expect("a tolerance"));
        variants.push((Workload { name: "film-within-1e-9", ..workload.clone() }, within));
    }
    variants.insert(0, (workload, Accuracy::Exact));
    variants
}

fn compare(workload: Workload, accuracy: Accuracy, set: InstructionSet, pairs: usize) {
    let Workload { name, tiles, points, grid } = workload;
    let scene = Scene::new(&tiles).with_instruction_set(set).expect("available").with_accuracy(accuracy);
    let magba = Magba::new(&tiles, &points);
    let (mut ours, mut theirs) = (vec![DVec3::ZERO; points.len()], vec![Vector3::zeros(); points.len()]);
    let mut fastest = f64::INFINITY;
    let mut ratios: Vec<f64> = (0..pairs)
        .map(|_| {
            let start = Instant::now();
            match (accuracy, &grid) {
                (Accuracy::Within(_), Some(grid)) => {
                    scene.field_on_grid_into(Quantity::FluxDensity, black_box(grid), &mut ours).expect("bounded");
                }
                _ => scene.field_into(Quantity::FluxDensity, black_box(&points), &mut ours).expect("bounded"),
            }
            let own = start.elapsed();
            let start = Instant::now();
            magba.field(&mut theirs);
            let other = start.elapsed();
            fastest = fastest.min(own.as_secs_f64());
            other.as_secs_f64() / own.as_secs_f64()
        })
        .collect();
    ratios.sort_by(f64::total_cmp);
    let apart = ours.iter().zip(&theirs).map(|(a, b)| (a - DVec3::new(b.x, b.y, b.z)).length() / a.length());
    let mut apart: Vec<f64> = apart.collect();
    apart.sort_by(f64::total_cmp);
    println!(
        "ratio: {} = {:.2}   ({} tiles, {} points, {:.3} ns per pair; the fields are apart by {:.1e} in the median)",
        name,
        ratios[ratios.len() / 2],
        tiles.len(),
        points.len(),
        1e9 * fastest / (points.len() * tiles.len()) as f64,
        apart[apart.len() / 2]
    );
}
