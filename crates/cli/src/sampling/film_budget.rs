//! Results of `budget`: where the displacement error of films that are made comes from.

use magsplice::{FilmBudget, FilmRecoil};

use super::scene::SampledScene;
use crate::failure::Failure;

/// A film with its budget.
pub(crate) struct BudgetedFilm {
    pub(crate) recoil: Option<FilmRecoil>,
    pub(crate) seed: u64,
    pub(crate) samples: u64,
    pub(crate) found: FilmBudget,
}

impl BudgetedFilm {
    pub(crate) fn new(scene: &SampledScene, seed: u64, samples: u64) -> Result<BudgetedFilm, Failure> {
        let found = scene.budget(seed, samples)?;
        Ok(BudgetedFilm { recoil: scene.recoil().cloned(), seed, samples, found })
    }
}
