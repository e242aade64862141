//! Criterion benchmarks of one tile, films, instruction sets, threads, and the path from a layout
//! file to its decoupling error.
//!
//! `cargo bench -p magsplice-benches --bench film`

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput};
use glam::DVec3;
use magsplice::field::InstructionSet;
use magsplice::prelude::*;
use magsplice_benches::{shipped_layout, working_volume, workloads};

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    one_tile_by_distance(&mut criterion);
    field_on_a_grid(&mut criterion);
    instruction_sets(&mut criterion);
    scenes(&mut criterion);
    threads(&mut criterion);
    file_to_number(&mut criterion);
    criterion.final_summary();
}

/// Times one tile at distances from its near field to far away, one distance for each method.
fn one_tile_by_distance(criterion: &mut Criterion) {
    let tile = Tile::new(DVec3::ZERO, DVec3::new(3.3, 1.7, 1.0), DVec3::new(0.3, -0.5, 0.7)).expect("a valid tile");
    let scene = Scene::new(&[tile]);
    let mut group = criterion.benchmark_group("kernel");
    for distance in [0.55, 1.5, 6.0, 30.0, 100.0, 1000.0] {
        let points: Vec<DVec3> = working_volume([16, 16, 4])
            .points()
            .map(|p| DVec3::new(0.1 * p.x, 0.1 * p.y, -distance + 0.01 * (p.z + 4.0)))
            .collect();
        let mut field = vec![DVec3::ZERO; points.len()];
        group.sample_size(10).throughput(Throughput::Elements(points.len() as u64));
        group.bench_function(BenchmarkId::new("distance", distance), |bencher| {
            bencher.iter(|| scene.field_into(Quantity::FluxDensity, black_box(&points), &mut field));
        });
    }
    group.finish();
}

fn field_on_a_grid(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("field");
    for name in ["single-tile", "published-film", "film-80mm"] {
        let layout = shipped_layout(name);
        let scene = Scene::new(&layout.bare_tiles());
        let points: Vec<DVec3> = working_volume([21, 21, 11]).points().collect();
        let mut field = vec![DVec3::ZERO; points.len()];
        let pairs = points.len() * layout.tiles.len();
        group.sample_size(10).throughput(Throughput::Elements(pairs as u64));
        group.bench_function(BenchmarkId::new("tile-point pairs", name), |bencher| {
            bencher.iter(|| scene.field_into(Quantity::FluxDensity, black_box(&points), &mut field));
        });
    }
    group.finish();
}

fn instruction_sets(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("instruction set");
    let tiles = shipped_layout("published-film").bare_tiles();
    let points: Vec<DVec3> = working_volume([21, 21, 11]).points().collect();
    let mut field = vec![DVec3::ZERO; points.len()];
    for set in InstructionSet::available() {
        let scene = Scene::new(&tiles).with_instruction_set(set).expect("available");
        group.sample_size(10).throughput(Throughput::Elements((points.len() * tiles.len()) as u64));
        group.bench_function(BenchmarkId::new("published film", format!("{set:?}")), |bencher| {
            bencher.iter(|| scene.field_into(Quantity::FluxDensity, black_box(&points), &mut field));
        });
    }
    group.finish();
}

fn scenes(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("scene");
    for workload in workloads() {
        let workload = workload.thinned(300_000);
        let scene = Scene::new(&workload.tiles);
        let mut field = vec![DVec3::ZERO; workload.points.len()];
        group.sample_size(10).throughput(Throughput::Elements(workload.pairs() as u64));
        group.bench_function(BenchmarkId::new("tile-point pairs", workload.name), |bencher| {
            bencher.iter(|| scene.field_into(Quantity::FluxDensity, black_box(&workload.points), &mut field));
        });
    }
    group.finish();
}

fn threads(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("threads");
    let tiles = shipped_layout("published-film").bare_tiles();
    let scene = Scene::new(&tiles);
    let points: Vec<DVec3> = working_volume([41, 41, 21]).points().collect();
    let mut field = vec![DVec3::ZERO; points.len()];
    let most = std::thread::available_parallelism().map_or(1, usize::from);
    for threads in std::iter::successors(Some(1), |n| Some(2 * n)).take_while(|n| *n <= most) {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        group.sample_size(10).throughput(Throughput::Elements((points.len() * tiles.len()) as u64));
        group.bench_function(BenchmarkId::new("published film", threads), |bencher| {
            bencher.iter(|| pool.install(|| scene.field_into(Quantity::FluxDensity, black_box(&points), &mut field)));
        });
    }
    group.finish();
}

fn file_to_number(criterion: &mut Criterion) {
    criterion.bench_function("decoupling of the published film, file to number", |bencher| {
        bencher.iter(|| {
            let film = Film::rigid(shipped_layout("published-film"));
            film.decouple().expect("regular").decoupling.uniformity_rmse
        });
    });
}
