//! A film held against what its layout expects.

use magsplice_expect::{self as expect, Baseline, Clearance, Expectation, Outcome};

use crate::film::{Film, FilmError};

impl Film<'_> {
    /// Everything the layout expects and what became of it, in the order of [`Expectation::all_of`]. Each is evaluated by
    /// itself: one that cannot be does not hide the others.
    ///
    /// `baseline` is what the expectation of the field speaks of; without one it ends in [`FilmError::NoBaseline`].
    pub fn outcomes(&self, baseline: Option<&Baseline>) -> Vec<(Expectation, Result<Outcome, FilmError>)> {
        let expected = &self.layout().expectations;
        let all = Expectation::all_of(expected);
        if all.is_empty() {
            return Vec::new();
        }
        let uses_field = |e: &Expectation| !matches!(e, Expectation::Clearance);
        let field = if all.iter().any(uses_field) { self.volume_field_t() } else { Ok(Vec::new()) };
        let field = field.as_deref().map_err(Clone::clone);
        let decoupling =
            all.iter().any(|e| matches!(e, Expectation::UniformityRmse(_) | Expectation::DisplacementRmse(_)));
        let decoupling = decoupling.then(|| self.decouple(field.clone()?));
        let decoupling = || decoupling.as_ref().expect("evaluated if expected").as_ref().map_err(Clone::clone);
        let outcome = |expectation: Expectation| -> Result<Outcome, FilmError> {
            let outcome = match expectation {
                Expectation::UniformityRmse(parameter) => {
                    expect::uniformity(expected, parameter, &decoupling()?.uniformity_rmse)
                }
                Expectation::DisplacementRmse(axis) => {
                    let found = decoupling()?.ideal_rmse.as_lengths(self.ideal()?.wavenumber());
                    expect::displacement(expected, axis, found)
                }
                Expectation::Amplitude => expect::amplitude(expected, self.compare(field.clone()?)?.amplitude),
                Expectation::Field => {
                    let baseline = baseline.ok_or(FilmError::NoBaseline)?;
                    let points = self.volume()?.grid;
                    let difference =
                        baseline.difference(points.points(), field.clone()?).map_err(FilmError::OtherPoints)?;
                    expect::field(expected, &difference)
                }
                Expectation::Clearance => {
                    let (tiles, volume) = (self.layout().bare_tiles(), self.volume()?);
                    let clearance = Clearance::of(&tiles, volume.lower_mm, volume.upper_mm);
                    expect::clearance(expected, &clearance.ok_or(FilmError::NoTiles)?)
                }
            };
            Ok(outcome.expect("only what is expected is asked for"))
        };
        all.into_iter().map(|expectation| (expectation, outcome(expectation))).collect()
    }
}
