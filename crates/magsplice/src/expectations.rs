//! Outcomes of the expectations of a film.

use std::cell::OnceCell;

use glam::DVec3;
use magsplice_decouple::{Figure, Figures};
use magsplice_expect::{Baseline, Clearance, Expectation, Outcome};

use crate::film::Film;
use crate::film_error::FilmError;

impl Film {
    /// The outcomes of all expectations of the layout, in the order of [`Expectation::stated_in`].
    ///
    /// Each expectation is evaluated by itself, so that one that fails does not hide the others.
    /// `baseline` is the field that the expectation of the field names. Without it that expectation
    /// gives [`FilmError::NoBaseline`].
    pub fn outcomes(&self, baseline: Option<&Baseline>) -> Vec<(Expectation, Result<Outcome, FilmError>)> {
        let mut outcomes = Vec::new();
        self.each_outcome(baseline, &[], |expectation, outcome| outcomes.push((expectation, outcome)));
        outcomes
    }

    /// The same as [`Film::outcomes`], each passed to `take` as soon as it is known.
    ///
    /// The field is computed for the first expectation that needs it, and kept for the others.
    /// `made` are the errors of the first samples of films as made, with the seed of the layout, as
    /// far as they are known. They are sampled if they are fewer than the layout specifies.
    pub fn each_outcome(
        &self,
        baseline: Option<&Baseline>,
        made: &[Figures],
        mut take: impl FnMut(Expectation, Result<Outcome, FilmError>),
    ) {
        let expected = &self.layout().expectations;
        let all = Expectation::stated_in(expected);
        // Evaluated when the first expectation needs them.
        let decoupling = OnceCell::new();
        let decoupling = || decoupling.get_or_init(|| self.volume_decoupling()).as_ref().map_err(Clone::clone);
        let made_films = OnceCell::new();
        let made_films = || made_films.get_or_init(|| self.made_films(made)).as_deref().map_err(Clone::clone);
        let outcome = |expectation: Expectation| -> Result<Outcome, FilmError> {
            let outcome = match expectation {
                Expectation::Figure(figure) => {
                    let found = match figure {
                        Figure::Uniformity(parameter) => {
                            decoupling()?.uniformity_rmse[parameter].ok_or(FilmError::OnePointPlanes(parameter))?
                        }
                        Figure::Displacement(axis) => decoupling()?.displacement_rmse_mm[axis],
                        Figure::Amplitude => self.volume_comparison()?.amplitude,
                    };
                    Outcome::from_figure(&expected.bounds, figure, found)
                }
                Expectation::Field => {
                    let baseline = baseline.ok_or(FilmError::NoBaseline)?;
                    let points = self.volume()?.grid;
                    let difference = baseline
                        .difference(points.points(), self.volume_field_t()?)
                        .map_err(FilmError::PointsMismatch)?;
                    Outcome::from_field(expected, &difference)
                }
                Expectation::Clearance => {
                    let (tiles, volume) = (self.layout().bare_tiles(), self.volume()?);
                    let places = self
                        .layout()
                        .head()
                        .map_or_else(|| vec![DVec3::ZERO], |head| head.elements.iter().map(|of| of.place).collect());
                    let at =
                        |place: DVec3| Clearance::from_tiles(&tiles, volume.lower_mm + place, volume.upper_mm + place);
                    let all = places.into_iter().filter_map(at);
                    let least = all.min_by(|a, b| a.distance.total_cmp(&b.distance)).ok_or(FilmError::NoTiles)?;
                    Outcome::from_clearance(expected, &least)
                }
                Expectation::Made(figure) => {
                    let made = expected.made.as_ref().ok_or(FilmError::Missing("expect.made"))?;
                    let errors = made_films()?;
                    if let (Figure::Uniformity(parameter), Some(first)) = (figure, errors.first()) {
                        first.get(figure).ok_or(FilmError::OnePointPlanes(parameter))?;
                    }
                    let outcome = Outcome::from_made(made, figure, errors);
                    return outcome.ok_or(FilmError::TooFewSamples(errors.len()));
                }
                _ => unreachable!("Expectation::stated_in gives no other"),
            };
            Ok(outcome.expect("the layout bounds every expectation it states"))
        };
        for expectation in all {
            take(expectation, outcome(expectation));
        }
    }

    /// The errors of films as made, of as many samples as the layout specifies.
    fn made_films(&self, known: &[Figures]) -> Result<Vec<Figures>, FilmError> {
        let (seed, stated) = self.layout().tolerance.as_ref().map_or((1, 1), |stated| (stated.seed, stated.samples));
        let made = self.layout().expectations.made.as_ref();
        let count = made.and_then(|made| made.samples).unwrap_or(stated);
        if let Some(known) = known.get(..count as usize) {
            return Ok(known.to_vec());
        }
        let sampling = self.sampling()?;
        let counted = self.counting("films", Some(count as usize), "samples");
        let errors = sampling.sampler(seed)?.errors_of_range(0..count, counted);
        errors.map_err(|(sample, error)| FilmError::Sample { sample, error })
    }
}
