//! The errors of many samples.

use std::ops::Range;

use magsplice_decouple::Parameter;
use magsplice_ideal::IdealFilm;
use rayon::prelude::*;

use crate::film_errors::{EvaluationGrid, FilmErrors, SampleError};
use crate::real_film::RealFilm;
use crate::statistics::Statistics;

/// The errors of samples of one film, in the order of the samples.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sampled {
    /// Number of the first sample.
    pub first: u64,
    /// The errors of each sample.
    pub errors: Vec<FilmErrors>,
}

impl Sampled {
    /// Evaluates samples with these numbers, in parallel. The result does not depend on the number of
    /// threads, and samples of several ranges are those of the joined range.
    ///
    /// # Errors
    /// The first sample without errors, by its number, and the reason.
    pub fn new(
        film: &RealFilm,
        volume: &EvaluationGrid,
        ideal: &IdealFilm,
        seed: u64,
        samples: Range<u64>,
    ) -> Result<Sampled, (u64, SampleError)> {
        let first = samples.start;
        let of_sample = |sample| {
            let tiles = film.sample(seed, sample).map_err(SampleError::Tile);
            tiles.and_then(|tiles| FilmErrors::from_tiles(&tiles, volume, ideal)).map_err(|error| (sample, error))
        };
        let results: Vec<Result<FilmErrors, _>> = samples.into_par_iter().map(of_sample).collect();
        Ok(Sampled { first, errors: results.into_iter().collect::<Result<_, _>>()? })
    }

    /// Statistics of the uniformity RMSE of a parameter. `None` without samples.
    pub fn uniformity_rmse(&self, parameter: Parameter) -> Option<Statistics> {
        Statistics::new(self.errors.iter().map(|errors| errors.uniformity_rmse.get(parameter)))
    }

    /// Statistics of the RMSE of the displacement along an axis, in the unit of lengths. `None`
    /// without samples.
    ///
    /// # Panics
    /// If `axis` is not 0, 1 or 2.
    pub fn displacement_rmse(&self, axis: usize) -> Option<Statistics> {
        Statistics::new(self.errors.iter().map(|errors| errors.displacement_rmse[axis]))
    }
}
