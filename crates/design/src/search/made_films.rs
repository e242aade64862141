//! The errors of films as made, by samples: from the film before a search, and from the film found.

use magsplice_decouple::Figures;
use magsplice_magnet::Tile;
use magsplice_tolerance::{EvaluationGrid, Sampler, Statistics, statistics};

use crate::error::DesignError;
use crate::problem::design_problem::DesignProblem;
use crate::progress::{ProgressUpdate, SearchStage, Watch};
use crate::search::shortfall::Shortfall;

/// Samples between two updates about progress: about a tenth of a second for a film of 56 tiles.
const BATCH: u64 = 100;

/// Errors of films as made, with the errors of `[tolerance]`, from exact samples over the working
/// volume.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct MadeFilms {
    /// Number of samples of each film: the number in `[tolerance]`, or fewer if the search was
    /// interrupted.
    pub samples: u64,
    /// Seed of the samples. Both films have the same errors.
    pub seed: u64,
    /// Errors of the layout's film.
    pub before: Figures<Statistics>,
    /// Errors of the designed film.
    pub after: Figures<Statistics>,
}

impl DesignProblem<'_> {
    /// Samples the film before the search and the film found. `None` if the brief does not count
    /// films as made.
    ///
    /// If the search is stopped, the samples end after the first batch.
    ///
    /// # Errors
    /// If a sample has no errors.
    pub(crate) fn made_films(&self, found: &[Tile], watch: &Watch) -> Result<Option<MadeFilms>, Shortfall> {
        let (Some(_), Some(tolerance)) = (&self.least_squares.errors, &self.layout.tolerance) else {
            return Ok(None);
        };
        let volume = EvaluationGrid { grid: self.volume.grid, reference: self.volume.reference_mm };
        let missed = |film: usize, sample, error| Shortfall::Samples { found: film == 1, sample, error };
        let real_film =
            |film, tiles: &[Tile]| self.real_film(tiles, tolerance).map_err(|error| missed(film, None, error));
        let films = [real_film(0, &self.tiles)?, real_film(1, found)?];
        let sampler = |film: usize| {
            Sampler::new(&films[film], &volume, &self.ideal, tolerance.seed)
                .map_err(|error| missed(film, None, DesignError::Sample(error)))
        };
        let samplers = [sampler(0)?, sampler(1)?];
        let mut errors: [Vec<Figures>; 2] = [Vec::new(), Vec::new()];
        let mut done = 0;
        while done < tolerance.samples {
            let end = (done + BATCH).min(tolerance.samples);
            for (film, sampler) in samplers.iter().enumerate() {
                let of_batch = sampler.errors_of_range(done..end, || {});
                errors[film].extend(
                    of_batch.map_err(|(sample, error)| missed(film, Some(sample), DesignError::Sample(error)))?,
                );
            }
            done = end;
            let (done, of) = (done as usize, tolerance.samples as usize);
            let update = ProgressUpdate { stage: SearchStage::Samples, done, of, best: None };
            if watch.show(update).is_break() {
                break;
            }
        }
        let [before, after] = errors.map(|errors| statistics(&errors));
        Ok(before.zip(after).map(|(before, after)| MadeFilms { samples: done, seed: tolerance.seed, before, after }))
    }
}
