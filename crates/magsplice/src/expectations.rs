//! Outcomes of the expectations of a film.

use magsplice_expect::{Baseline, Clearance, Expectation, Outcome};

use crate::film::{Film, FilmError};

impl Film<'_> {
    /// The outcomes of all expectations of the layout, in the order of [`Expectation::stated_in`].
    ///
    /// Each expectation is evaluated by itself, so that one that fails does not hide the others.
    /// `baseline` is the field that the expectation of the field names. Without it that expectation
    /// gives [`FilmError::NoBaseline`].
    pub fn outcomes(&self, baseline: Option<&Baseline>) -> Vec<(Expectation, Result<Outcome, FilmError>)> {
        let expected = &self.layout().expectations;
        let all = Expectation::stated_in(expected);
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
                    Outcome::from_uniformity(expected, parameter, &decoupling()?.uniformity_rmse)
                }
                Expectation::DisplacementRmse(axis) => {
                    let found = decoupling()?.ideal_rmse.as_lengths(self.ideal()?.wavenumber());
                    Outcome::from_displacement(expected, axis, found)
                }
                Expectation::Amplitude => Outcome::from_amplitude(expected, self.compare(field.clone()?)?.amplitude),
                Expectation::Field => {
                    let baseline = baseline.ok_or(FilmError::NoBaseline)?;
                    let points = self.volume()?.grid;
                    let difference =
                        baseline.difference(points.points(), field.clone()?).map_err(FilmError::PointsMismatch)?;
                    Outcome::from_field(expected, &difference)
                }
                Expectation::Clearance => {
                    let (tiles, volume) = (self.layout().bare_tiles(), self.volume()?);
                    let clearance = Clearance::from_tiles(&tiles, volume.lower_mm, volume.upper_mm);
                    Outcome::from_clearance(expected, &clearance.ok_or(FilmError::NoTiles)?)
                }
                _ => unreachable!("Expectation::stated_in gives no other"),
            };
            Ok(outcome.expect("the layout bounds every expectation it states"))
        };
        all.into_iter().map(|expectation| (expectation, outcome(expectation))).collect()
    }
}
