//! Error budgets of shipped films, against exact samples.

use magsplice::layout::{
    CommonErrors, Distribution, FilmTolerance, Layout, Preset, SensorErrors, StrayField, Temperature, TileErrors,
};
use magsplice::tolerance::{Budget, Cause, EndlessPattern, EvaluationGrid, FirstOrder, RealFilm, Sampler};

use crate::shipped::layout;

/// Errors of a workshop with direction and size, a stray field, 5 uT of noise, and a fixed warming.
fn tolerance(tiles: usize) -> FilmTolerance {
    let degree = || Distribution::normal(1.0_f64.to_radians());
    let three = |deviation| [const { Distribution::NONE }; 3].map(|_| Distribution::normal(deviation));
    let errors = TileErrors { size: three(0.02), direction: [degree(), degree()], ..Preset::Workshop.errors() };
    let any_direction_t = Distribution::Fixed(30e-6);
    FilmTolerance {
        common: CommonErrors {
            stray_field: Some(StrayField { any_direction_t, ..StrayField::default() }),
            sensor: SensorErrors { noise_t: three(5e-6), ..SensorErrors::default() },
            temperature: Some(Temperature { change_k: Distribution::Fixed(10.0), strength_per_k: -0.0012 }),
            ..CommonErrors::default()
        },
        ..FilmTolerance::of_tiles(&errors, tiles)
    }
}

/// Calls a function with the budget of a film, its model, and a sampler.
fn with_budget<T>(
    layout: &Layout,
    tolerance: &FilmTolerance,
    of: impl FnOnce(&Budget, &FirstOrder, &Sampler) -> T,
) -> T {
    let (volume, ideal) = (layout.volume.as_ref().expect("stated"), layout.ideal.expect("stated"));
    let volume = EvaluationGrid { grid: volume.grid, reference: volume.reference_mm };
    let tiles = layout.bare_tiles();
    let film = RealFilm::new(&tiles, tolerance);
    let pattern = EndlessPattern::new(&tiles, &ideal).and_then(|pattern| pattern.errors(&volume)).expect("errors");
    let model = FirstOrder::new(&film, &volume, &ideal).expect("a model");
    let sampler = Sampler::new(&film, &volume, &ideal, 1).expect("no neighbour");
    of(&Budget::new(&model, Some(&pattern)), &model, &sampler)
}

/// The parts add up to the total, and the total agrees with exact samples: within 5 % by pairs of
/// exact and linear samples, and within four standard errors by exact samples alone.
#[test]
fn parts_add_up_to_the_simulated_total() {
    for name in ["designed-displacement", "published-film"] {
        let layout = layout(name);
        with_budget(&layout, &tolerance(layout.tiles.len()), |budget, model, sampler| {
            let check = model.check(sampler, 0..200, || {}).expect("samples");
            let samples = sampler.errors_of_range(0..200, || {}).expect("samples");
            for (axis, of_axis) in budget.axes.iter().enumerate() {
                let causes: f64 = of_axis.causes.iter().map(|share| share.contribution.total_mm2()).sum();
                let parts = of_axis.pattern_mm2.expect("known") + of_axis.finite_film_mm2().expect("known") + causes;
                let total = of_axis.total_mm2;
                assert!((parts - total).abs() < 1e-12 * total, "{name}, {axis}: {parts}, not {total}");
                assert!(check.axes[axis].mean_square_is_valid(), "{name}, {axis}: {:?}", check.axes[axis]);
                let squares: Vec<f64> =
                    samples.iter().map(|sample| sample.displacement_rmse_mm.to_array()[axis].powi(2)).collect();
                let n = squares.len() as f64;
                let mean = squares.iter().sum::<f64>() / n;
                let stated = check.axes[axis].sampled_mm2;
                assert!((stated - mean).abs() < 1e-12 * mean, "{name}, {axis}: {stated}, not {mean}");
                let deviation = (squares.iter().map(|square| (square - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
                assert!((mean - total).abs() < 4.0 * deviation / n.sqrt(), "{name}, {axis}: {mean}, not {total}");
            }
        });
    }
}

/// Halving a cause, or all errors of a tile, reduces the totals by the reported amount.
#[test]
fn halved_errors_save_what_is_stated() {
    let layout = layout("designed-displacement");
    let whole = tolerance(layout.tiles.len());
    let total = |tolerance: &FilmTolerance| {
        with_budget(&layout, tolerance, |budget, _, _| budget.axes.each_ref().map(|axis| axis.total_mm2))
    };
    let budget = with_budget(&layout, &whole, |budget, _, _| budget.clone());
    let before = budget.axes.each_ref().map(|axis| axis.total_mm2);
    let agrees = |halved: &FilmTolerance, saved_mm2: [f64; 3]| {
        let after = total(halved);
        for axis in 0..3 {
            let saved = before[axis] - after[axis];
            assert!((saved - saved_mm2[axis]).abs() < 1e-12 * before[axis], "{axis}: {saved}, not {saved_mm2:?}");
        }
    };
    let half = |errors: &[Distribution; 3]| errors.each_ref().map(|error| error.scaled(0.5));
    let causes: Vec<Cause> = budget.causes.iter().take(3).map(|cause| cause.of).collect();
    assert_eq!(causes, [Cause::Direction, Cause::StrayField, Cause::Size]);
    let mut halved = [whole.clone(), whole.clone(), whole.clone()];
    for tile in &mut halved[0].tiles {
        tile.direction = tile.direction.each_ref().map(|error| error.scaled(0.5));
    }
    let field = halved[1].common.stray_field.as_mut().expect("a field");
    field.any_direction_t = field.any_direction_t.scaled(0.5);
    for tile in &mut halved[2].tiles {
        tile.size = half(&tile.size);
    }
    for (halved, of) in halved.iter().zip(&budget.causes) {
        agrees(halved, of.saved_mm2);
    }
    // The four tiles around the axis have equal savings; the first tiles are reported.
    let tiles: Vec<usize> = budget.tiles.iter().take(4).map(|tile| tile.of).collect();
    assert_eq!(tiles, [20, 22, 33, 35]);
    let mut halved = whole.clone();
    halved.tiles[20] = whole.tiles[20].each_ref().map(|error| error.scaled(0.5));
    agrees(&halved, budget.tiles[0].saved_mm2);
}

/// The end of the published film causes nearly all of its error. The end of a designed film
/// compensates the error of its pattern.
#[test]
fn pattern_and_finite_film_make_the_nominal_error() {
    let parts = |name: &str| {
        let layout = layout(name);
        with_budget(&layout, &FilmTolerance::default(), |budget, _, _| {
            assert!(budget.tiles.is_empty() && budget.causes.is_empty());
            budget.axes.each_ref().map(|axis| {
                assert!(axis.causes.is_empty() && axis.total_mm2 == axis.nominal_mm2);
                [axis.total_mm2, axis.pattern_mm2.expect("known"), axis.finite_film_mm2().expect("known")]
            })
        })
    };
    for [total, pattern, finite] in parts("published-film") {
        assert!(total.sqrt() > 0.24 && pattern.sqrt() < 0.009 && finite > 0.99 * total);
    }
    for [total, pattern, finite] in parts("designed-displacement") {
        assert!(total.sqrt() < 1e-4 && pattern.sqrt() > 0.001 && finite < 0.0);
    }
}
