//! Results of `tolerance`: statistics of the samples of a film.

use magsplice::expect::keeps_bounds;
use magsplice::layout::Layout;
use magsplice::tolerance::{Estimate, Figure, FilmErrors, Statistics, share, statistics};

use super::source::SampleSource;

/// A film with the statistics of its samples.
pub(crate) struct SampledFilm<'a> {
    pub(crate) layout: &'a Layout,
    /// The errors of the film as it was ordered.
    pub(crate) nominal: FilmErrors,
    pub(crate) source: SampleSource,
    /// In the order of [`Figure::ALL`].
    pub(crate) statistics: [Statistics; 7],
    /// The share of the samples that keep the bounds of `[expect]`; nothing if there are none.
    pub(crate) yield_share: Option<Estimate>,
}

impl<'a> SampledFilm<'a> {
    /// # Panics
    /// Without samples.
    pub(crate) fn new(
        layout: &'a Layout,
        nominal: FilmErrors,
        source: SampleSource,
        errors: &[FilmErrors],
    ) -> SampledFilm<'a> {
        let statistics = Figure::ALL.map(|figure| statistics(errors, figure).expect("at least one sample"));
        let kept: Option<Vec<bool>> = errors.iter().map(|errors| keeps_bounds(&layout.expectations, errors)).collect();
        let yield_share = kept.and_then(|kept| share(kept.iter().filter(|kept| **kept).count(), kept.len()));
        SampledFilm { layout, nominal, source, statistics, yield_share }
    }
}
