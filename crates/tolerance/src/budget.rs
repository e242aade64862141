//! The error budget: displacement errors divided by origin.

use std::ops::Range;

use magsplice_decouple::Figures;
use magsplice_ideal::IdealFilm;
use magsplice_layout::FilmTolerance;
use magsplice_magnet::Axis;

use crate::evaluation_grid::{EvaluationGrid, SampleError};
use crate::first_order::{AxisErrors, Cause, Contribution, FirstOrder, Share};
use crate::one_cause::each_alone;
use crate::real_film::RealFilm;
use crate::sampler::Sampler;

/// The expected mean squares of the displacement errors, divided by origin (docs/physics.md, Eq.
/// P62).
///
/// # Accuracy
/// Errors of tiles and surroundings are taken to first order. [`FirstOrder::check`] compares the
/// total with exact samples: the total times its ratio of mean squares is the simulated one.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use magsplice_ideal::IdealFilm;
/// use magsplice_layout::{FilmTolerance, Preset};
/// use magsplice_magnet::{Grid, Tile};
/// use magsplice_tolerance::{Budget, EndlessPattern, EvaluationGrid, FirstOrder, RealFilm};
///
/// let tile = |x: f64| Tile::new(DVec3::new(x, 0.0, 0.5), DVec3::new(4.0, 9.0, 1.0), DVec3::new(0.1 * x.signum(), 0.0, 0.0));
/// let tiles = [tile(-2.5)?, tile(2.5)?];
/// let film = RealFilm::new(&tiles, &FilmTolerance::of_tiles(&Preset::Workshop.errors(), 2));
/// let grid = Grid::new(DVec3::new(-1.0, -1.0, -5.0), DVec3::new(1.0, 1.0, -3.0), [5, 5, 3])?;
/// let volume = EvaluationGrid { grid, reference: DVec3::new(0.0, 0.0, -5.0) };
/// let ideal = IdealFilm::new(10.0, 1.0, 0.12)?;
/// let pattern = EndlessPattern::new(&tiles, &ideal)?.errors(&volume)?;
/// let budget = Budget::new(&FirstOrder::new(&film, &volume, &ideal)?, Some(&pattern));
/// let along_x = &budget.axes[0];
/// let causes: f64 = along_x.causes.iter().map(|share| share.contribution.total_mm2()).sum();
/// let parts = along_x.pattern_mm2.unwrap() + along_x.finite_film_mm2().unwrap() + causes;
/// assert!((parts - along_x.total_mm2).abs() < 1e-12 * along_x.total_mm2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Budget {
    /// The budgets along x, y, z.
    pub axes: [AxisBudget; 3],
    /// Tiles whose errors are worth halving, the largest saving first.
    pub tiles: Vec<Halving<usize>>,
    /// Causes that are worth halving, the largest saving first.
    pub causes: Vec<Halving<Cause>>,
}

/// The budget of the displacement errors along one axis, as mean squares in mm^2.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct AxisBudget {
    /// The film without errors.
    pub nominal_mm2: f64,
    /// The splicing pattern without end against the ideal film. `None` if unknown.
    pub pattern_mm2: Option<f64>,
    /// The contribution of each cause that has errors: tiles, surroundings and sensor.
    pub causes: Vec<Share>,
    /// The sum of the nominal mean square and of all causes.
    pub total_mm2: f64,
}

impl AxisBudget {
    /// The contribution of the end of the film: the nominal mean square minus the mean square of
    /// the pattern. It is negative where both compensate each other by design. `None` if the
    /// pattern is unknown.
    pub fn finite_film_mm2(&self) -> Option<f64> {
        self.pattern_mm2.map(|pattern| self.nominal_mm2 - pattern)
    }

    /// The excess of the total over the nominal mean square and the contributions of all causes. To
    /// first order it is zero but for rounding.
    pub fn together_mm2(&self) -> f64 {
        let alone: f64 = self.causes.iter().map(|share| share.contribution.total_mm2()).sum();
        self.total_mm2 - self.nominal_mm2 - alone
    }
}

/// The effect of halving all errors of one tile, by its index, or of one cause in all its tiles.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Halving<T> {
    /// The tile or the cause.
    pub of: T,
    /// Decrease of the totals along x, y, z.
    pub saved_mm2: [f64; 3],
}

impl Budget {
    /// The budget to first order of a film, and of its splicing pattern without end if known, see
    /// [`EndlessPattern::errors`](crate::EndlessPattern::errors), in the same volume.
    pub fn new(model: &FirstOrder, pattern: Option<&Figures>) -> Budget {
        let errors = [0, 1, 2].map(|axis| model.axis_errors(axis));
        let saved_mm2 = |tile: usize| errors.each_ref().map(|axis| axis.tiles[tile].saved_by_halving_mm2);
        let tiles = most_saving((0..errors[0].tiles.len()).map(|of| Halving { of, saved_mm2: saved_mm2(of) }));
        let axis_budget = |AxisErrors { nominal_mm2, expected_mm2, shares, .. }| AxisBudget {
            nominal_mm2,
            pattern_mm2: None,
            causes: shares,
            total_mm2: expected_mm2,
        };
        Budget { tiles, ..Budget::of_axes(errors.map(axis_budget), pattern) }
    }

    /// A budget without tiles, from the budgets along each axis without the pattern.
    fn of_axes(mut axes: [AxisBudget; 3], pattern: Option<&Figures>) -> Budget {
        let patterns_mm = pattern.map(|pattern| pattern.displacement_rmse_mm.to_array());
        for (axis, rmse_mm) in axes.iter_mut().zip(patterns_mm.into_iter().flatten()) {
            axis.pattern_mm2 = Some(rmse_mm.powi(2));
        }
        // The causes are the same along each axis.
        let saved_mm2 =
            |number: usize| axes.each_ref().map(|axis| axis.causes[number].contribution.saved_by_halving_mm2);
        let causes = axes[0].causes.iter().enumerate();
        let causes =
            most_saving(causes.map(|(number, share)| Halving { of: share.cause, saved_mm2: saved_mm2(number) }));
        Budget { axes, tiles: Vec::new(), causes }
    }

    /// The budget by exact samples, for films whose errors are too large for the first order. The
    /// contribution of a cause is the mean square with this cause alone minus the nominal one;
    /// [`AxisBudget::together_mm2`] is the remainder of the total. Savings assume that errors add
    /// as squares. Single tiles are not resolved. `progress` is called, from any thread, when a
    /// sample begins.
    ///
    /// # Errors
    /// The first sample whose errors cannot be computed, by its number, and the reason.
    pub fn from_samples(
        film: &RealFilm,
        volume: &EvaluationGrid,
        ideal: &IdealFilm,
        pattern: Option<&Figures>,
        seed: u64,
        samples: Range<u64>,
        progress: impl Fn() + Sync,
    ) -> Result<Budget, (u64, SampleError)> {
        let first = samples.start;
        let mean_squares = |tolerance: &FilmTolerance, samples: Range<u64>| -> Result<[f64; 3], (u64, SampleError)> {
            let count = (samples.end - samples.start) as f64;
            let film = film.clone().with_tolerance(tolerance);
            let sampler = Sampler::new(&film, volume, ideal, seed).map_err(|error| (first, error))?;
            let errors = sampler.errors_of_range(samples, &progress)?;
            let squares = |axis| errors.iter().map(move |errors| errors.displacement_rmse_mm[axis].powi(2));
            Ok(Axis::ALL.map(|axis| squares(axis).sum::<f64>() / count))
        };
        let nominal = mean_squares(&FilmTolerance::default(), first..first + 1)?;
        let total = mean_squares(film.tolerance(), samples.clone())?;
        let mut axes = [0, 1, 2].map(|axis| {
            let [nominal_mm2, total_mm2] = [nominal[axis], total[axis]];
            AxisBudget { nominal_mm2, pattern_mm2: None, causes: Vec::new(), total_mm2 }
        });
        for (cause, alone) in each_alone(film.tolerance()) {
            let with = mean_squares(&alone, samples.clone())?;
            for (axis, with_mm2) in axes.iter_mut().zip(with) {
                let variance_mm2 = with_mm2 - axis.nominal_mm2;
                let saved_by_halving_mm2 = SAVED_OF_A_SQUARE * variance_mm2;
                let contribution = Contribution { fixed_mm2: 0.0, variance_mm2, saved_by_halving_mm2 };
                axis.causes.push(Share { cause, contribution });
            }
        }
        Ok(Budget::of_axes(axes, pattern))
    }
}

/// Fraction of a square that halving saves.
const SAVED_OF_A_SQUARE: f64 = 0.75;

/// Tiles or causes that save anything, ordered by the sum over the axes. Equal ones, such as tiles
/// of a symmetric film, keep their order.
fn most_saving<T>(all: impl Iterator<Item = Halving<T>>) -> Vec<Halving<T>> {
    // In single precision, so that sums that differ by rounding are equal.
    let sum = |halving: &Halving<T>| halving.saved_mm2.iter().sum::<f64>() as f32;
    let mut saving: Vec<Halving<T>> = all.filter(|halving| sum(halving) > 0.0).collect();
    saving.sort_by(|a, b| sum(b).total_cmp(&sum(a)));
    saving
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use glam::DVec3;
    use magsplice_layout::{Distribution, TileErrors};
    use magsplice_magnet::{Grid, Tile};

    use super::*;
    use crate::endless::EndlessPattern;

    fn volume() -> EvaluationGrid {
        let grid = Grid::new(DVec3::new(-1.0, -1.0, -5.0), DVec3::new(1.0, 1.0, -3.0), [2, 3, 2]).unwrap();
        EvaluationGrid { grid, reference: DVec3::new(0.0, 0.1, -4.5) }
    }

    fn ideal() -> IdealFilm {
        IdealFilm::new(10.0, 1.0, 0.12).unwrap()
    }

    /// Two tiles with errors, the second with larger ones, and a third without, which save nothing.
    fn film() -> RealFilm {
        let tile = |x: f64, y: f64| {
            Tile::new(DVec3::new(x, y, 0.5), DVec3::new(4.0, 4.0, 1.0), DVec3::new(0.1 * x.signum(), 0.01 * y, 0.0))
        };
        let tiles = [tile(-2.5, -2.0), tile(2.5, -2.5), tile(2.0, 2.5)].map(Result::unwrap);
        let errors = |deviation: f64| TileErrors {
            position: [deviation; 3].map(Distribution::normal),
            strength: Distribution::normal(0.5 * deviation),
            ..TileErrors::default()
        };
        let mut tolerance = FilmTolerance {
            tiles: vec![errors(0.01), errors(0.03), TileErrors::default()],
            ..FilmTolerance::default()
        };
        tolerance.common.sensor.offset_t = [1e-5; 3].map(Distribution::normal);
        RealFilm::new(&tiles, &tolerance)
    }

    fn pattern() -> Figures {
        EndlessPattern::new(film().tiles(), &ideal()).unwrap().errors(&volume()).unwrap()
    }

    fn sum(saved_mm2: [f64; 3]) -> f64 {
        saved_mm2.iter().sum()
    }

    #[test]
    fn budget_has_the_parts_of_the_model_and_of_the_pattern() {
        let (model, pattern) = (FirstOrder::new(&film(), &volume(), &ideal()).unwrap(), pattern());
        let budget = Budget::new(&model, Some(&pattern));
        let errors = [0, 1, 2].map(|axis| model.axis_errors(axis));
        for (axis, (found, known)) in budget.axes.iter().zip(&errors).enumerate() {
            assert_eq!((found.nominal_mm2, found.total_mm2), (known.nominal_mm2, known.expected_mm2));
            assert_eq!(found.causes, known.shares);
            let pattern_mm2 = pattern.displacement_rmse_mm.to_array()[axis].powi(2);
            assert_eq!(found.pattern_mm2, Some(pattern_mm2));
            assert_eq!(found.finite_film_mm2(), Some(found.nominal_mm2 - pattern_mm2));
            assert!(found.together_mm2().abs() < 1e-12 * found.total_mm2, "{found:?}");
        }
        assert_eq!(budget.tiles.iter().map(|halving| halving.of).collect::<Vec<_>>(), [1, 0]);
        for halving in &budget.tiles {
            assert_eq!(halving.saved_mm2, errors.each_ref().map(|axis| axis.tiles[halving.of].saved_by_halving_mm2));
        }
        assert_eq!(budget.causes.len(), 4);
        assert!(budget.causes.windows(2).all(|pair| sum(pair[0].saved_mm2) >= sum(pair[1].saved_mm2)));
        for halving in &budget.causes {
            let share = |axis: &AxisErrors| *axis.shares.iter().find(|share| share.cause == halving.of).unwrap();
            assert_eq!(halving.saved_mm2, errors.each_ref().map(|axis| share(axis).contribution.saved_by_halving_mm2));
        }
        let unknown = Budget::new(&model, None);
        assert!(unknown.axes.iter().all(|axis| axis.pattern_mm2.is_none() && axis.finite_film_mm2().is_none()));
    }

    /// Each contribution is the mean square with one cause alone, without the nominal one, and
    /// halving saves three quarters of it.
    #[test]
    fn sampled_budget_has_the_mean_squares_of_each_cause_alone() {
        let (film, volume, ideal, seed, samples) = (film(), volume(), ideal(), 5, 3..7);
        let begun = AtomicUsize::new(0);
        let count = || _ = begun.fetch_add(1, Ordering::Relaxed);
        let budget =
            Budget::from_samples(&film, &volume, &ideal, Some(&pattern()), seed, samples.clone(), count).unwrap();
        let mean_squares = |tolerance: &FilmTolerance| {
            let film = RealFilm::new(film.tiles(), tolerance);
            let sampler = Sampler::new(&film, &volume, &ideal, seed).unwrap();
            let errors: Vec<Figures> = samples.clone().map(|sample| sampler.errors_of(sample).unwrap()).collect();
            [0, 1, 2].map(|axis| {
                errors.iter().map(|errors| errors.displacement_rmse_mm.to_array()[axis].powi(2)).sum::<f64>() / 4.0
            })
        };
        let (nominal, total) = (mean_squares(&FilmTolerance::default()), mean_squares(film.tolerance()));
        let alone = each_alone(film.tolerance());
        assert_eq!(begun.into_inner(), 1 + 4 + 4 * alone.len());
        assert!(budget.tiles.is_empty());
        for (axis, found) in budget.axes.iter().enumerate() {
            let agrees = |found: f64, known: f64| (found - known).abs() < 1e-12 * total[axis];
            assert!(agrees(found.nominal_mm2, nominal[axis]) && agrees(found.total_mm2, total[axis]), "{found:?}");
            assert!(found.pattern_mm2.is_some());
            let mut rest = total[axis] - nominal[axis];
            assert_eq!(found.causes.len(), alone.len());
            for (share, (cause, tolerance)) in found.causes.iter().zip(&alone) {
                let known = mean_squares(tolerance)[axis] - nominal[axis];
                rest -= known;
                assert_eq!((share.cause, share.contribution.fixed_mm2), (*cause, 0.0));
                assert!(agrees(share.contribution.variance_mm2, known), "{share:?}, not {known}");
                assert!(agrees(share.contribution.saved_by_halving_mm2, 0.75 * known), "{share:?}");
            }
            assert!(agrees(found.together_mm2(), rest), "{rest}");
        }
    }

    /// The largest sum over the axes first; equal ones keep their order, also if their sums differ
    /// by rounding. What saves nothing is left out.
    #[test]
    fn largest_savings_are_first() {
        let saved = [[1.0, 0.0, 0.0], [0.0; 3], [1.0, 1.0, 1.0], [-1.0, 0.0, 0.0], [0.5, 0.5, 1e-15], [2.0, -0.5, 0.0]];
        let all = saved.into_iter().enumerate().map(|(of, saved_mm2)| Halving { of, saved_mm2 });
        assert_eq!(most_saving(all).iter().map(|halving| halving.of).collect::<Vec<_>>(), [2, 5, 0, 4]);
    }
}
