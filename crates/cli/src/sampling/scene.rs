//! A film whose samples are drawn.

use std::path::Path;
use std::sync::Arc;

use magsplice::decouple::Figures;
use magsplice::ideal::IdealFilm;
use magsplice::layout::Layout;
use magsplice::making::{PlaceGroup, SortedSampler, Sorting};
use magsplice::tolerance::{EvaluationGrid, RealFilm, SampleError, Sampler};
use magsplice::{Film, FilmBudget, FilmError, FilmRecoil};

use crate::failure::Failure;
use crate::prepared_film::prepare;
use crate::progress::ProgressLine;
use crate::words::{film_failure, no_film};

/// A film that is sampled, with its working volume and its ideal film.
pub(crate) struct SampledScene<'a> {
    path: &'a Path,
    layout: &'a Layout,
    film: Film,
    real: RealFilm,
    /// The same film without errors.
    exact: RealFilm,
    volume: EvaluationGrid,
}

impl<'a> SampledScene<'a> {
    pub(crate) fn new(
        path: &'a Path,
        layout: &'a Layout,
        progress: &Arc<ProgressLine>,
        tell: &dyn Fn(&str),
    ) -> Result<SampledScene<'a>, Failure> {
        let film = Film::rigid(layout.clone());
        let purpose = "evaluates the films that are made from a layout";
        let missing = |error| no_film(path, error, "tolerance", purpose);
        film.ideal().map_err(missing)?;
        let volume = film.evaluation_grid().map_err(missing)?;
        film.real_film().map_err(|error| match error {
            FilmError::Missing(_) => Failure::Points {
                path: path.to_owned(),
                message: "the layout has no [tolerance] table, which states the errors of the films that are made: \
                          give --preset workshop to begin with, or add the table that docs/layout-format.md describes"
                    .to_owned(),
            },
            error => film_failure(path, layout, error),
        })?;
        let film = prepare(path, layout, progress, tell)?;
        let real = film.real_film().map_err(|error| film_failure(path, layout, error))?;
        let exact = real.clone().without_errors();
        Ok(SampledScene { path, layout, film, real, exact, volume })
    }

    pub(crate) fn sampler(&self, seed: u64) -> Result<Sampler<'_>, Failure> {
        self.sampler_of(&self.real, seed)
    }

    /// A sampler of films whose tiles are sorted: those of a part of the layout may be exchanged.
    pub(crate) fn sorted_sampler<'b>(
        &self,
        sampler: &'b Sampler<'b>,
        sorting: Sorting,
    ) -> Result<SortedSampler<'b>, Failure> {
        SortedSampler::new(sampler, PlaceGroup::from_layout(self.layout), &self.volume, self.ideal()?, sorting)
            .map_err(|error| Failure::Points { path: self.path.to_owned(), message: error.to_string() })
    }

    pub(crate) fn layout(&self) -> &'a Layout {
        self.layout
    }

    pub(crate) fn budget(&self, seed: u64, samples: u64) -> Result<FilmBudget, Failure> {
        self.film.budget(seed, samples).map_err(|error| film_failure(self.path, self.layout, error))
    }

    pub(crate) fn recoil(&self) -> Option<&FilmRecoil> {
        self.film.recoil()
    }

    pub(crate) fn ideal(&self) -> Result<&IdealFilm, Failure> {
        self.film.ideal().map_err(|error| film_failure(self.path, self.layout, error))
    }

    fn sampler_of<'b>(&'b self, film: &'b RealFilm, seed: u64) -> Result<Sampler<'b>, Failure> {
        Sampler::new(film, &self.volume, self.ideal()?, seed).map_err(|error| self.failure(&error))
    }

    /// The errors of the film as it was ordered.
    pub(crate) fn nominal(&self) -> Result<Figures, Failure> {
        self.sampler_of(&self.exact, 1)?.errors_of(0).map_err(|error| self.failure(&error))
    }

    pub(crate) fn failure(&self, error: &SampleError) -> Failure {
        Failure::Points { path: self.path.to_owned(), message: error.to_string() }
    }

    pub(crate) fn sample_failure(&self, sample: u64, error: &dyn std::error::Error) -> Failure {
        Failure::Points { path: self.path.to_owned(), message: format!("sample {sample}: {error}") }
    }
}
