//! The published film: its field on a grid, and the way from the file to the decoupling error.
//!
//! `cargo bench -p magsplice-benches --bench film`

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput};
use glam::DVec3;
use magsplice::prelude::*;
use magsplice_benches::{shipped_layout, working_volume};

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    field_on_a_grid(&mut criterion);
    file_to_number(&mut criterion);
    criterion.final_summary();
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

fn file_to_number(criterion: &mut Criterion) {
    criterion.bench_function("decoupling of the published film, file to number", |bencher| {
        bencher.iter(|| {
            let layout = shipped_layout("published-film");
            let film = Film::new(&layout);
            let field = film.volume_field_t().expect("bounded");
            film.decouple(&field).expect("regular").uniformity_rmse
        });
    });
}
