//! The errors of films as made, by samples: from the film before a search, and from the film found.

use magsplice_decouple::Figures;
use magsplice_layout::{FilmTolerance, Preset};
use magsplice_magnet::Tile;
use magsplice_tolerance::{EvaluationGrid, Sampler, Statistics, statistics};

use crate::error::DesignError;
use crate::problem::design_problem::DesignProblem;
use crate::progress::{ProgressUpdate, SearchProgress, SearchStage, Watch};
use crate::search::shortfall::Shortfall;

/// Samples between two updates about progress: about a tenth of a second for a film of 56 tiles.
const BATCH: u64 = 100;

/// Errors of films as made, from exact samples over the working volume.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct MadeFilms {
    /// Number of samples of each film: the number in `[tolerance]`, or fewer if the search was
    /// interrupted.
    pub samples: u64,
    /// Seed of the samples. Both films have the same errors.
    pub seed: u64,
    /// The preset of the errors of the tiles. `None` if they have the errors of `[tolerance]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub preset: Option<Preset>,
    /// Errors of the layout's film. `None` for films designed without an initial layout.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub before: Option<Figures<Statistics>>,
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
        self.sampled(Some(&self.tiles), found, tolerance, watch).map(Some)
    }

    /// Samples the film found, [`SearchResult::tiles`](crate::SearchResult::tiles), with the errors
    /// of `tolerance`, one for each tile of the layout.
    ///
    /// # Errors
    /// [`Shortfall::Samples`] if a sample has no errors.
    pub fn found_film_as_made(
        &self,
        found: &[Tile],
        tolerance: &FilmTolerance,
        progress: SearchProgress,
    ) -> Result<MadeFilms, Shortfall> {
        self.sampled(None, found, tolerance, &Watch::new(progress))
    }

    fn sampled(
        &self,
        before: Option<&[Tile]>,
        found: &[Tile],
        tolerance: &FilmTolerance,
        watch: &Watch,
    ) -> Result<MadeFilms, Shortfall> {
        let volume = EvaluationGrid { grid: self.volume.grid, reference: self.volume.reference_mm };
        let missed = |found: bool, sample, error| Shortfall::Samples { found, sample, error };
        let real_film =
            |found: bool, tiles: &[Tile]| self.real_film(tiles, tolerance).map_err(|error| missed(found, None, error));
        let films = [before.map(|tiles| real_film(false, tiles)).transpose()?, Some(real_film(true, found)?)];
        let mut samplers = Vec::new();
        for (found, film) in [false, true].into_iter().zip(&films) {
            let Some(film) = film else { continue };
            let sampler = Sampler::new(film, &volume, &self.ideal, tolerance.seed);
            let sampler = sampler.map_err(|error| missed(found, None, DesignError::Sample(error)))?;
            samplers.push((found, sampler, Vec::new()));
        }
        let mut done = 0;
        while done < tolerance.samples {
            let end = (done + BATCH).min(tolerance.samples);
            for (found, sampler, errors) in &mut samplers {
                let of_batch = sampler.errors_of_range(done..end, || {});
                errors.extend(
                    of_batch.map_err(|(sample, error)| missed(*found, Some(sample), DesignError::Sample(error)))?,
                );
            }
            done = end;
            let (done, of) = (done as usize, tolerance.samples as usize);
            let update = ProgressUpdate { stage: SearchStage::Samples, done, of, best: None };
            if watch.show(update).is_break() {
                break;
            }
        }
        let mut of_films = samplers.into_iter().rev().map(|(.., errors)| statistics(&errors));
        let after = of_films.next().flatten().expect("a film has at least one sample");
        let before = of_films.next().flatten();
        Ok(MadeFilms { samples: done, seed: tolerance.seed, preset: None, before, after })
    }
}
