//! Progress of evaluations, and their interruption by it.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;
use magsplice_field::{Accuracy, Grid, PointErrors, Quantity, Scene, Tile, Tolerance};

const B: Quantity = Quantity::FluxDensity;

/// Exact scenes and scenes with tolerances, of few and of many tiles.
fn scenes() -> Vec<Scene> {
    let film = |across: usize| {
        let tile = |n: usize| {
            let [x, y] = [n % across, n / across].map(|i| i as f64 - 0.5 * across as f64);
            let j = DVec3::new((0.6 * x).sin(), (0.6 * y).sin(), 0.2);
            Tile::new(DVec3::new(x, y, 0.5), DVec3::ONE, j).unwrap()
        };
        Scene::new(&(0..across * across).map(tile).collect::<Vec<Tile>>())
    };
    let tolerances = [Tolerance::relative(1e-6).unwrap(), Tolerance::absolute_t(1e-16).unwrap()];
    let accuracies = [Accuracy::Exact, Accuracy::Within(tolerances[0]), Accuracy::Within(tolerances[1])];
    [2, 16].iter().flat_map(|across| accuracies.map(|accuracy| film(*across).with_accuracy(accuracy))).collect()
}

/// A grid below the film, and one across it, with points on edges.
fn grids() -> [Grid; 2] {
    let grid = |lower: [f64; 3], upper: [f64; 3]| Grid::new(lower.into(), upper.into(), [33, 33, 19]).unwrap();
    [grid([-2.0, -2.0, -5.0], [2.0, 2.0, -3.0]), grid([-2.0, -2.0, -1.0], [2.0, 2.0, 1.0])]
}

type Evaluation<'a> = &'a dyn Fn(&mut [DVec3], &(dyn Fn(usize) + Sync)) -> Result<(), PointErrors>;

/// Calls `check` for evaluations on grids and at their points.
fn for_each_evaluation(scene: &Scene, check: &dyn Fn(usize, Evaluation)) {
    for grid in grids() {
        let points: Vec<DVec3> = grid.points().collect();
        let mut with_nan = points.clone();
        with_nan[7] = DVec3::NAN;
        let count = points.len();
        check(count, &|field, progress| scene.field_on_grid_with_progress(B, &grid, field, progress));
        check(count, &|field, progress| scene.field_with_progress(B, &points, field, progress));
        check(count, &|field, progress| scene.field_with_progress(B, &with_nan, field, progress));
    }
}

#[test]
fn progress_counts_every_point_once() {
    for scene in scenes() {
        for_each_evaluation(&scene, &|count, evaluate| {
            let done = AtomicUsize::new(0);
            let mut field = vec![DVec3::ZERO; count];
            let _ = evaluate(&mut field, &|points| {
                done.fetch_add(points, Ordering::Relaxed);
            });
            assert_eq!(done.into_inner(), count, "{:?}", scene.accuracy());
        });
    }
}

#[test]
fn panic_of_progress_ends_an_evaluation_and_leaves_the_scene_as_it_was() {
    let places = [DVec3::new(0.1, 0.2, -3.0), DVec3::new(9.0, 0.2, -3.0)];
    for scene in scenes() {
        let before = scene.clone().field_at(B, &places);
        for_each_evaluation(&scene, &|count, evaluate| {
            let calls = AtomicUsize::new(0);
            let mut field = vec![DVec3::ZERO; count];
            let interrupted = catch_unwind(AssertUnwindSafe(|| {
                evaluate(&mut field, &|_| {
                    calls.fetch_add(1, Ordering::Relaxed);
                    resume_unwind(Box::new("interrupted"));
                })
            }));
            assert_eq!(interrupted.unwrap_err().downcast_ref(), Some(&"interrupted"));
            assert!(calls.into_inner() > 0);
            assert_eq!(scene.field_at(B, &places), before);
        });
    }
}
