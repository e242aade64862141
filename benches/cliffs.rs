//! Cliffs: cases in which a small change of the request multiplies the time.
//!
//! `cargo bench -p magsplice-benches --bench cliffs` prints on one thread
//!
//! * `ratio: rods = <magba time / magsplice time>` for 100 rods of 1 x 1 x 30,
//! * `ratio: gradient-over-field = <gradient time / field time>` for the published film,
//! * `ratio: within-over-exact-worst = <time within a tolerance / exact time>`, the worst over the
//!   tolerances 1e-2 to 1e-13 and the scenes of docs/accuracy-and-speed.md, after a line for each.
//!
//! Ratios are medians over interleaved pairs of runs. The memory location of a prepared scene
//! changes a ratio by some 5 %, which would determine the worst of two hundred cases. The worst
//! cases are therefore measured again, each with several pairs of scenes at other locations, and
//! the worst of their medians is printed. `-- --test` runs everything once on smaller scenes; a
//! word runs the cases with this word in their names.

use std::hint::black_box;
use std::time::Instant;

use glam::{DMat3, DVec3};
use magsplice::field::{Accuracy, Grid, Quantity, Scene, Tolerance};
use magsplice_benches::{
    Magba, SceneSizes, Workload, median, placed_scenes, random_cubes, rods, shipped_layout, working_volume,
};
use nalgebra::Vector3;

/// Numbers of points, and of interleaved pairs of runs.
#[derive(Clone, Copy)]
struct CliffEffort {
    /// Points and tiles of the scenes with tolerances.
    sizes: SceneSizes,
    /// Points around the rods.
    rod_points: usize,
    /// Points of the gradient.
    gradient_grid: [usize; 3],
    /// Number of pairs of runs, unless [`CliffEffort::seconds`] pass first.
    pairs: usize,
    /// Smallest number of pairs of runs.
    least_pairs: usize,
    /// Seconds after which no further pair begins, once the smallest number is reached.
    seconds: f64,
    /// Number of worst cases measured again.
    worst: usize,
    /// Number of pairs of scenes for each of them.
    copies: usize,
}

const FULL: CliffEffort = CliffEffort {
    sizes: SceneSizes { grid: [61, 61, 31], points: 20_000, heap_points: 2_000, heap_side: 22 },
    rod_points: 10_000,
    gradient_grid: [21, 21, 11],
    pairs: 15,
    least_pairs: 3,
    seconds: 1.0,
    worst: 5,
    copies: 7,
};

const ONCE: CliffEffort = CliffEffort {
    sizes: SceneSizes { grid: [11, 11, 6], points: 300, heap_points: 300, heap_side: 6 },
    rod_points: 100,
    gradient_grid: [5, 5, 3],
    pairs: 1,
    least_pairs: 1,
    seconds: 0.0,
    worst: 1,
    copies: 1,
};

fn main() {
    let effort = if std::env::args().any(|a| a == "--test") { ONCE } else { FULL };
    let wanted = std::env::args().skip(1).find(|a| !a.starts_with('-')).unwrap_or_default();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    pool.install(|| {
        if "rods".contains(&wanted) {
            rods_against_magba(effort);
        }
        if "gradient-over-field".contains(&wanted) {
            gradient_over_field(effort);
        }
        within_over_exact(effort, &wanted);
    });
}

fn rods_against_magba(effort: CliffEffort) {
    let Workload { tiles, points, .. } = rods(effort.rod_points);
    let (scene, magba) = (Scene::new(&tiles), Magba::new(&tiles, &points));
    let (mut ours, mut theirs) = (vec![DVec3::ZERO; points.len()], vec![Vector3::zeros(); points.len()]);
    let ratio = median_ratio(
        effort,
        || magba.field(&mut theirs),
        || scene.field_into(Quantity::FluxDensity, black_box(&points), &mut ours).expect("bounded"),
    );
    let apart = ours.iter().zip(&theirs).map(|(a, b)| (a - DVec3::new(b.x, b.y, b.z)).length() / a.length());
    println!(
        "ratio: rods = {ratio:.2}   ({} points; the fields are apart by {:.1e} in the median)",
        points.len(),
        median(apart.collect())
    );
}

fn gradient_over_field(effort: CliffEffort) {
    let scene = Scene::new(&shipped_layout("published-film").bare_tiles());
    let points: Vec<DVec3> = working_volume(effort.gradient_grid).points().collect();
    let (mut gradient, mut field) = (vec![DMat3::ZERO; points.len()], vec![DVec3::ZERO; points.len()]);
    let ratio = median_ratio(
        effort,
        || scene.gradient_into(Quantity::FluxDensity, black_box(&points), &mut gradient).expect("bounded"),
        || scene.field_into(Quantity::FluxDensity, black_box(&points), &mut field).expect("bounded"),
    );
    println!("ratio: gradient-over-field = {ratio:.2}   ({} points)", points.len());
}

/// Points of a requested field.
enum Wanted<'a> {
    Grid(&'a Grid),
    List(&'a [DVec3]),
}

impl Wanted<'_> {
    fn len(&self) -> usize {
        match self {
            Wanted::Grid(grid) => grid.len(),
            Wanted::List(points) => points.len(),
        }
    }

    /// Evaluates B. Returns the number of refused points.
    fn evaluate(&self, scene: &Scene, field: &mut [DVec3]) -> usize {
        let evaluated = match self {
            Wanted::Grid(grid) => scene.field_on_grid_into(Quantity::FluxDensity, black_box(grid), field),
            Wanted::List(points) => scene.field_into(Quantity::FluxDensity, black_box(points), field),
        };
        evaluated.err().map_or(0, |errors| errors.0.len())
    }
}

/// A scene, points in it, and a tolerance.
struct ToleranceCase<'a> {
    name: String,
    scene: &'a Scene,
    points: Wanted<'a>,
    tolerance: Tolerance,
}

fn within_over_exact(effort: CliffEffort, wanted: &str) {
    let mut placed = placed_scenes(effort.sizes);
    placed.push(random_cubes(effort.sizes));
    let scenes: Vec<Scene> = placed.iter().map(|placed| Scene::new(&placed.tiles)).collect();
    let mut cases = Vec::new();
    for (placed, scene) in placed.iter().zip(&scenes) {
        for place in &placed.places {
            let name = format!("{}, {}", placed.title, place.name);
            for exponent in 2..=13 {
                let tolerance = Tolerance::relative(10_f64.powi(-exponent)).expect("a tolerance");
                let mut add = |kind: &str, points| {
                    let name = format!("{name}, {kind}, within 1e-{exponent}");
                    cases.push(ToleranceCase { name, scene, points, tolerance });
                };
                if let Some(grid) = &place.volume {
                    add("grid", Wanted::Grid(grid));
                }
                add("list", Wanted::List(&place.points));
            }
        }
    }
    cases.retain(|case| case.name.contains(wanted));
    let mut measured: Vec<(f64, &ToleranceCase)> = cases.iter().map(|case| (case.ratio(effort, 1), case)).collect();
    measured.sort_by(|(one, _), (other, _)| other.total_cmp(one));
    let worst = measured.iter().take(effort.worst).map(|(_, case)| (case.ratio(effort, effort.copies), &case.name));
    if let Some((ratio, name)) = worst.max_by(|(one, _), (other, _)| one.total_cmp(other)) {
        println!("ratio: within-over-exact-worst = {ratio:.2}   ({name})");
    }
}

impl ToleranceCase<'_> {
    /// Measures with `copies` pairs of scenes and prints the median ratio.
    fn ratio(&self, effort: CliffEffort, copies: usize) -> f64 {
        let ToleranceCase { name, scene, points, tolerance } = self;
        let (mut field, mut truth) = (vec![DVec3::ZERO; points.len()], vec![DVec3::ZERO; points.len()]);
        let mut refused = 0;
        let exact = vec![(*scene).clone(); copies];
        let within: Vec<Scene> =
            exact.iter().map(|scene| scene.clone().with_accuracy(Accuracy::Within(*tolerance))).collect();
        let ratio_of = |(within, exact): (&Scene, &Scene)| {
            median_ratio(
                effort,
                || refused = points.evaluate(within, &mut field),
                || assert_eq!(points.evaluate(exact, &mut truth), 0, "bounded"),
            )
        };
        let ratio = median(within.iter().zip(&exact).map(ratio_of).collect());
        let apart = field.iter().zip(&truth).map(|(a, b)| (*a - *b).length() / b.length());
        let largest = apart.fold(0.0, f64::max);
        println!(
            "within-over-exact: {name} = {ratio:.2}   ({} points, {refused} refused; the largest error is {largest:.1e} of |B|)",
            points.len()
        );
        ratio
    }
}

/// The median over interleaved pairs of runs of the time of `one` over the time of `other`. The
/// first pair does not count, because it builds reused data.
fn median_ratio(effort: CliffEffort, mut one: impl FnMut(), mut other: impl FnMut()) -> f64 {
    let mut pair = || {
        let start = Instant::now();
        one();
        let of_one = start.elapsed().as_secs_f64();
        let start = Instant::now();
        other();
        of_one / start.elapsed().as_secs_f64()
    };
    pair();
    let start = Instant::now();
    let mut ratios = Vec::new();
    while ratios.len() < effort.pairs
        && (ratios.len() < effort.least_pairs || start.elapsed().as_secs_f64() < effort.seconds)
    {
        ratios.push(pair());
    }
    median(ratios)
}
