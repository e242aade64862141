//! magsplice against magba 0.7.3's best call, one thread, in one process.
//!
//! `cargo bench -p magsplice-benches --bench peers` prints for each workload `ratio: <workload> = <magba time / magsplice time>`, the median
//! over interleaved pairs of runs, and how far the two fields are apart. `-- --test` runs each workload once on few points, `-- NAME` those with
//! this in their name.

use std::hint::black_box;
use std::time::Instant;

use glam::{DQuat, DVec3};
use magba::fields::cuboid_B_batch;
use magsplice::field::{InstructionSet, Quantity, Scene, Tile};
use magsplice_benches::{shipped_layout, working_volume};
use nalgebra::{Point3, Quaternion, UnitQuaternion, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Interleaved pairs of runs; the median ratio is printed.
const PAIRS: usize = 7;

/// magba is timed on at most this many tile-point pairs, magsplice on the same, so that a pair of runs takes about a second.
const LARGEST_RUN: usize = 3_000_000;

struct Workload {
    name: &'static str,
    tiles: Vec<Tile>,
    points: Vec<DVec3>,
}

fn main() {
    let once = std::env::args().any(|a| a == "--test");
    let wanted = std::env::args().skip(1).find(|a| !a.starts_with('-')).unwrap_or_default();
    let sets = InstructionSet::available();
    let named = |set: &&InstructionSet| std::env::args().any(|a| a == format!("--{set:?}").to_lowercase());
    let set = *sets.iter().find(named).unwrap_or(&sets[0]);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    for workload in workloads().into_iter().filter(|w| w.name.contains(&wanted)) {
        let (most, pairs) = if once { (20_000, 1) } else { (LARGEST_RUN, PAIRS) };
        pool.install(|| compare(&workload, set, most, pairs));
    }
}

fn compare(workload: &Workload, set: InstructionSet, most: usize, pairs: usize) {
    // Evenly thinned, so that the points keep their distribution.
    let keep = (most / workload.tiles.len()).clamp(1, workload.points.len());
    let points: Vec<DVec3> = (0..keep).map(|i| workload.points[i * workload.points.len() / keep]).collect();
    let scene = Scene::new(&workload.tiles).with_instruction_set(set).expect("available");
    let magba = Magba::new(&workload.tiles, &points);
    let (mut ours, mut theirs) = (vec![DVec3::ZERO; points.len()], vec![Vector3::zeros(); points.len()]);
    let mut fastest = f64::INFINITY;
    let mut ratios: Vec<f64> = (0..pairs)
        .map(|_| {
            let start = Instant::now();
            scene.field_into(Quantity::FluxDensity, black_box(&points), &mut ours).expect("bounded");
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
        "ratio: {} = {:.2}   ({} tiles, {} points, {:.2} ns per pair; the fields are apart by {:.1e} in the median)",
        workload.name,
        ratios[ratios.len() / 2],
        workload.tiles.len(),
        points.len(),
        1e9 * fastest / (points.len() * workload.tiles.len()) as f64,
        apart[apart.len() / 2]
    );
}

/// The scene as magba takes it.
struct Magba {
    points: Vec<Point3<f64>>,
    tiles: Vec<MagbaTile>,
}

/// Position, orientation, polarization and size.
type MagbaTile = (Point3<f64>, UnitQuaternion<f64>, Vector3<f64>, Vector3<f64>);

impl Magba {
    fn new(tiles: &[Tile], points: &[DVec3]) -> Magba {
        let vector = |v: DVec3| Vector3::new(v.x, v.y, v.z);
        let turn = |q: DQuat| UnitQuaternion::new_unchecked(Quaternion::new(q.w, q.x, q.y, q.z));
        let tile =
            |t: &Tile| (vector(t.position()).into(), turn(t.rotation()), vector(t.polarization_t()), vector(t.size()));
        Magba { points: points.iter().map(|p| vector(*p).into()).collect(), tiles: tiles.iter().map(tile).collect() }
    }

    /// Its batch call, one tile after the other.
    fn field(&self, sum: &mut [Vector3<f64>]) {
        sum.fill(Vector3::zeros());
        let mut field = vec![Vector3::zeros(); sum.len()];
        for (position, orientation, polarization, size) in &self.tiles {
            cuboid_B_batch(black_box(&self.points), *position, *orientation, *polarization, *size, &mut field);
            sum.iter_mut().zip(&field).for_each(|(total, b)| *total += b);
        }
    }
}

fn workloads() -> Vec<Workload> {
    let film = shipped_layout("published-film").bare_tiles();
    let grid: Vec<DVec3> = working_volume([81, 81, 41]).points().collect();
    let mut random = ChaCha8Rng::seed_from_u64(4);
    let mut within = |reach: f64| DVec3::from([0, 1, 2].map(|_| random.random_range(-reach..reach)));
    // Different in every tile, so that no two are one block.
    let general = |(i, t): (usize, &Tile)| {
        let j = t.polarization_t() + DVec3::new(0.02, -0.03, 0.04 + 1e-4 * i as f64);
        Tile::new(t.position(), t.size(), j).expect("a valid tile")
    };
    let turned =
        |(i, t): (usize, &Tile)| t.rotated(DQuat::from_rotation_z(1e-3 * (i as f64 + 1.0))).expect("a rotation");
    let one = Tile::new(DVec3::ZERO, DVec3::new(3.3, 1.7, 1.0), DVec3::new(0.3, -0.5, 0.7)).expect("a valid tile");
    let near_and_far: Vec<DVec3> = (0..1_000_000).map(|i| within(if i % 2 == 0 { 4.0 } else { 40.0 })).collect();
    let lattice = (0..10_000).map(|i| {
        let (x, y) = (f64::from(i % 100) - 49.5, f64::from(i / 100) - 49.5);
        let j = DVec3::new((0.6 * x).sin(), (0.6 * y).sin(), 0.0).normalize() * 0.12;
        Tile::new(DVec3::new(x, y, 0.5), DVec3::ONE, j).expect("a valid tile")
    });
    let below: Vec<DVec3> =
        (0..10_000).map(|_| within(40.0) * DVec3::new(1.0, 1.0, 0.02) - DVec3::new(0.0, 0.0, 4.0)).collect();
    vec![
        Workload { name: "film-exact", tiles: film.clone(), points: grid.clone() },
        Workload {
            name: "film-general-polarization",
            tiles: film.iter().enumerate().map(general).collect(),
            points: grid.clone(),
        },
        Workload { name: "film-rotated", tiles: film.iter().enumerate().map(turned).collect(), points: grid },
        Workload { name: "one-tile", tiles: vec![one], points: near_and_far },
        Workload { name: "many-tiles", tiles: lattice.collect(), points: below },
    ]
}
