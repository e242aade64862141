//! Results of `tolerance`: statistics of the samples of a film.

use magsplice::FilmRecoil;
use magsplice::decouple::Figures;
use magsplice::expect::keeps_bounds;
use magsplice::layout::{FigureBounds, Layout};
use magsplice::making::Sorting;
use magsplice::tolerance::{Estimate, Statistics, share, statistics};

use super::scene::SampledScene;
use super::source::SampleSource;
use crate::failure::Failure;

/// A film with the statistics of its samples.
pub(crate) struct SampledFilm<'a> {
    pub(crate) layout: &'a Layout,
    pub(crate) recoil: Option<FilmRecoil>,
    /// The errors of the film as it was ordered.
    pub(crate) nominal: Figures,
    pub(crate) source: SampleSource,
    /// How the tiles are sorted, if they are.
    pub(crate) sorting: Option<Sorting>,
    pub(crate) statistics: Figures<Statistics>,
    /// The share of the samples that keep the bounds of `[expect]`; nothing if there are none.
    pub(crate) yield_share: Option<Estimate>,
    /// The share of the samples that keep all bounds of `[expect.made]`; nothing if there are none.
    pub(crate) yield_made: Option<Estimate>,
}

impl<'a> SampledFilm<'a> {
    /// # Panics
    /// Without samples.
    pub(crate) fn new(
        scene: &SampledScene<'a>,
        source: SampleSource,
        errors: &[Figures],
    ) -> Result<SampledFilm<'a>, Failure> {
        let (layout, recoil, nominal) = (scene.layout(), scene.recoil().cloned(), scene.nominal()?);
        let statistics = statistics(errors).expect("at least one sample");
        let yield_share = keeping(&layout.expectations.bounds, errors);
        let yield_made = layout.expectations.made.as_ref().and_then(|made| keeping(&made.bounds, errors));
        Ok(SampledFilm { layout, recoil, nominal, source, sorting: None, statistics, yield_share, yield_made })
    }

    /// The same, of sorted tiles.
    pub(crate) fn sorted(self, sorting: Option<Sorting>) -> SampledFilm<'a> {
        SampledFilm { sorting, ..self }
    }
}

/// The share of the samples that keep all bounds; nothing if there are none.
fn keeping(bounds: &FigureBounds, errors: &[Figures]) -> Option<Estimate> {
    let kept: Vec<bool> = errors.iter().map(|errors| keeps_bounds(bounds, errors)).collect::<Option<_>>()?;
    share(kept.iter().filter(|kept| **kept).count(), kept.len())
}
