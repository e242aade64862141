//! The search for significant errors: forward selection, backward elimination and exchange, each
//! with a refit by Gauss-Newton steps.

use std::ops::RangeInclusive;

use glam::DVec3;
use magsplice_magnet::{PerTileError, TileError};
use nalgebra::{Matrix3, Vector3};

use crate::diagnosis::candidate::{Candidate, ErrorKind};
use crate::diagnosis::error::DiagnosisError;
use crate::diagnosis::model::{Compared, Linearized, ScanModel};
use crate::diagnosis::prior_fit::{PriorFit, Score};
use crate::diagnosis::result::DetectedError;
use crate::diagnosis::significance::is_implausible;
use crate::diagnosis::unknowns::{Unknown, Unknowns};
use crate::fit::{DEVIATION_OVER_MEDIAN, MOST_OUTLIERS, OUTLIER};

/// Number of exchanges for each identified error after which errors are added again. Where errors
/// of single tiles do not explain a scan, each set of them may seem better than the set before.
const MOST_EXCHANGES: usize = 2;

/// Logarithm of the ratio of probabilities, a thousand, up to which another error is an alternative
/// to an identified error.
const ALTERNATIVE: f64 = 6.9;

/// Error of the strength of a reversed tile.
const AS_REVERSED: f64 = -2.0;

/// Errors of the strength that a reversed tile seems to have beside other errors.
const REVERSED: RangeInclusive<f64> = -3.0..=-1.0;

/// Errors of the strength from which on the fit also begins at a reversed tile. Expected errors of
/// the other tiles bend to the change of sign on the way, so that the fit may end between.
const BETWEEN: RangeInclusive<f64> = -1.5..=-0.1;

/// Share of the sum of squares that a reversed tile explains at least. In films made by hand, 1 mm
/// below, small tiles at the edge explain 0.09 to 0.25, others 0.5 to 0.85.
const LEAST_SHARE: f64 = 0.05;

/// Number of readings, with the largest residuals, that are tested as wild.
const SUSPECTED: usize = 30;

/// A search for faulty tiles in one scan.
pub(crate) struct Search<'a> {
    pub(crate) model: &'a ScanModel,
    pub(crate) readings_t: &'a [DVec3],
    pub(crate) candidates: &'a [Candidate],
    /// Number of readings that were unusable from the beginning.
    pub(crate) unusable: usize,
    /// The logarithm of the probability below which an error is identified.
    pub(crate) ln_limit: f64,
    pub(crate) most_errors: usize,
}

/// The model at the found errors.
pub(crate) struct Found {
    pub(crate) at: Linearized,
    pub(crate) compared: Compared,
    /// Identified errors without their components.
    pub(crate) detected: Vec<DetectedError>,
    /// Whether no further error is significant.
    pub(crate) is_complete: bool,
}

/// Readings that may be wild.
struct Suspects {
    /// Each reading, and its square distance from the fit of the others in units of the noise.
    readings: Vec<(usize, f64)>,
    /// The square distance beyond which a reading is suspected.
    limit: f64,
}

/// What follows a round of the search.
enum Next {
    /// Another round with these errors.
    Round(Vec<Candidate>),
    /// All errors are confirmed, and no further error is significant.
    Complete,
    /// As many errors as may be found, each as strong as the strongest now, leave more than noise.
    Hopeless,
}

impl Search<'_> {
    /// The errors that noise and expected errors do not explain, beginning with the model at
    /// `start`.
    pub(crate) fn run(&self, start: &Linearized, mut watch: impl FnMut(usize)) -> Result<Found, DiagnosisError> {
        let mut detected: Vec<Candidate> = Vec::new();
        let mut visited: Vec<Vec<Candidate>> = vec![Vec::new()];
        let usable = start.is_used.clone();
        let ordered = self.with_reversed(start, &mut detected)?;
        // Wild readings are excluded before they pull the first fit. Where too many seem wild, the
        // errors are too large for the linear model: the fit decides.
        let mut start = ordered.clone();
        loop {
            let compared = self.model.compared(&start, self.readings_t);
            start = match self.wild(&start, &compared, &detected) {
                Ok(wild) if wild.is_empty() => break,
                Ok(wild) => start.without(&wild),
                Err(DiagnosisError::AnotherFilm { .. }) => {
                    start = ordered;
                    break;
                }
                Err(error) => return Err(error),
            };
        }
        visited.push(sorted(&detected));
        let (mut at, mut compared) = self.fitted(start, &detected)?;
        // The linear model at the nominal film cannot judge them where errors are large.
        if let Some(admitted) = self.with_unsuspicious(&at, &compared, &usable)? {
            (at, compared) = self.fitted(admitted, &detected)?;
        }
        let mut exchanges = 0;
        let is_complete = loop {
            watch(detected.len());
            let wild = self.wild(&at, &compared, &detected)?;
            if !wild.is_empty() {
                (at, compared) = self.fitted(at.without(&wild), &detected)?;
                // Errors that wild readings suggested or hid are tested anew.
                visited = vec![sorted(&detected)];
                continue;
            }
            let may_exchange = exchanges < MOST_EXCHANGES * detected.len();
            let next = match self.next(&at, &compared, &detected, &visited, may_exchange)? {
                Next::Round(next) => next,
                Next::Complete => break true,
                Next::Hopeless => break false,
            };
            exchanges = if next.len() == detected.len() { exchanges + 1 } else { 0 };
            if next.len() > self.most_errors {
                break false;
            }
            detected = next;
            visited.push(sorted(&detected));
            (at, compared) = self.fitted(at, &detected)?;
        };
        let mut tested = detected
            .iter()
            .map(|error| {
                let scores = self.without(&at, &compared, &detected, *error)?;
                let own = scores.iter().find(|(other, _)| other == error).map_or(Score::NONE, |(_, score)| *score);
                let is_alike = |(other, score): &(Candidate, Score)| {
                    other != error && score.ln_probability < own.ln_probability + ALTERNATIVE
                };
                let mut alike: Vec<(Candidate, Score)> = scores.into_iter().filter(is_alike).collect();
                alike.sort_by(|a, b| a.1.ln_probability.total_cmp(&b.1.ln_probability));
                let alternatives = alike.into_iter().map(|(other, _)| other).collect();
                let Score { chi_squared, ln_probability } = own;
                Ok(DetectedError {
                    candidate: *error,
                    components: Vec::new(),
                    chi_squared,
                    ln_probability,
                    alternatives,
                })
            })
            .collect::<Result<Vec<DetectedError>, DiagnosisError>>()?;
        tested.sort_by(|a, b| a.ln_probability.total_cmp(&b.ln_probability));
        Ok(Found { at, compared, detected: tested, is_complete })
    }

    /// The fit of the identified errors, from a model or, where tiles may be reversed, from those.
    fn fitted(&self, from: Linearized, detected: &[Candidate]) -> Result<(Linearized, Compared), DiagnosisError> {
        let deviations = self.model.unknowns.with_detected(detected);
        let sum = |(at, compared): &(Linearized, Compared)| {
            compared.chi_squared + Unknowns::sum_of_squares(&self.model.values(&at.state), &deviations)
        };
        let mut best = self.model.converged(self.readings_t, from, &deviations)?;
        for Candidate { tile, kind } in detected.iter().copied() {
            let strength = Unknown::Tile { tile, error: TileError::Strength };
            if kind != ErrorKind::Strength || !BETWEEN.contains(&best.0.state.get(strength)) {
                continue;
            }
            let mut state = best.0.state.clone();
            state.tiles[tile] = PerTileError::default();
            state.set(strength, AS_REVERSED);
            let reversed = self.model.linearized(state, None, &best.0.is_used, None)?;
            let reversed = self.model.converged(self.readings_t, reversed, &deviations)?;
            if sum(&reversed) < sum(&best) {
                best = reversed;
            }
        }
        Ok(best)
    }

    /// The start with tiles that seem reversed, which `detected` receives. Expected errors of the
    /// other tiles would bend to a reversed tile, and right readings would contradict them. The
    /// test does not use the expected errors: where those are large, the linear model at the start
    /// is wrong by far more than the noise.
    fn with_reversed(&self, start: &Linearized, detected: &mut Vec<Candidate>) -> Result<Linearized, DiagnosisError> {
        let mut at = start.clone();
        while detected.len() < self.most_errors {
            let compared = self.model.compared(&at, self.readings_t);
            let signal = &compared.projected - &at.gram * self.model.values(&at.state);
            let seen = |(index, unknown): (usize, &Unknown)| {
                let Unknown::Tile { tile, error: TileError::Strength } = *unknown else { return None };
                let (value, information) = (signal[index] / at.gram[(index, index)], at.gram[(index, index)]);
                let error = Candidate { tile, kind: ErrorKind::Strength };
                let is_reversed = REVERSED.contains(&value) && !detected.contains(&error);
                is_reversed.then_some((value * value * information, *unknown, error))
            };
            let best = self.model.unknowns.list.iter().enumerate().filter_map(seen).max_by(|a, b| a.0.total_cmp(&b.0));
            let Some((_, unknown, error)) = best.filter(|best| best.0 > LEAST_SHARE * compared.chi_squared) else {
                break;
            };
            let fit = PriorFit::new(&at.gram, &compared.projected, &self.model.unknowns.with_detected(detected))?;
            let score = fit.scores(&[self.model.unknowns.of_error(error)])[0];
            if score.ln_probability > self.ln_limit {
                break;
            }
            detected.push(error);
            let mut state = at.state.clone();
            state.set(unknown, AS_REVERSED);
            at = self.model.linearized(state, None, &at.is_used, Some(&at))?;
        }
        Ok(at)
    }

    /// The identified errors of the next round: one less, one exchanged, or one more.
    fn next(
        &self,
        at: &Linearized,
        compared: &Compared,
        detected: &[Candidate],
        visited: &[Vec<Candidate>],
        may_exchange: bool,
    ) -> Result<Next, DiagnosisError> {
        let is_new = |errors: &[Candidate]| !visited.contains(&sorted(errors));
        let mut weakest: Option<(Candidate, f64)> = None;
        let mut exchange: Option<(Vec<Candidate>, f64)> = None;
        for error in detected {
            let scores = self.without(at, compared, detected, *error)?;
            let own = scores.iter().find(|(other, _)| other == error).map_or(0.0, |(_, score)| score.ln_probability);
            if own > self.ln_limit && weakest.is_none_or(|(_, least)| own > least) {
                weakest = Some((*error, own));
            }
            for (other, score) in scores.iter().filter(|(other, _)| may_exchange && other != error) {
                let gain = own - score.ln_probability;
                if gain > 0.0 && exchange.as_ref().is_none_or(|(_, most)| gain > *most) {
                    let exchanged: Vec<Candidate> = rest(detected, *error).into_iter().chain([*other]).collect();
                    if is_new(&exchanged) {
                        exchange = Some((exchanged, gain));
                    }
                }
            }
        }
        if let Some(fewer) = weakest.map(|(error, _)| rest(detected, error)) {
            return Ok(if is_new(&fewer) { Next::Round(fewer) } else { Next::Complete });
        }
        if let Some((exchanged, _)) = exchange {
            return Ok(Next::Round(exchanged));
        }
        let deviations = self.model.unknowns.with_detected(detected);
        let best = |at: &Linearized, compared: &Compared| -> Result<Option<(Candidate, Score)>, DiagnosisError> {
            let fit = PriorFit::new(&at.gram, &compared.projected, &deviations)?;
            let significant = self.scores(&fit, detected).into_iter().filter(|of| of.1.ln_probability < self.ln_limit);
            Ok(significant.min_by(|a, b| a.1.ln_probability.total_cmp(&b.1.ln_probability)))
        };
        let mut found = best(at, compared)?;
        // Derivatives of the film without its errors are coarse for the errors of one tile: near a
        // film made in a workshop they found an error of 6.5 deviations that was none.
        if found.is_some() && at.slopes_at.is_some() {
            let (exact, compared) = self.model.least(self.readings_t, at.clone(), &deviations)?;
            found = best(&exact, &compared)?;
        }
        let Some((error, score)) = found else { return Ok(Next::Complete) };
        let more: Vec<Candidate> = detected.iter().copied().chain([error]).collect();
        if !is_new(&more) {
            return Ok(Next::Complete);
        }
        let left = compared.chi_squared + Unknowns::sum_of_squares(&self.model.values(&at.state), &deviations);
        let freedom = self.model.freedom(&at.is_used);
        let most_explained = (self.most_errors - detected.len()) as f64 * score.chi_squared;
        // Readings that are wild, but explain less than this error, are excluded after it.
        let suspected = || -> Result<f64, DiagnosisError> {
            let fit = PriorFit::new(&at.gram, &compared.projected, &deviations)?;
            Ok(self.suspects(at, compared, &fit).readings.iter().map(|of| of.1).sum())
        };
        let is_hopeless = is_implausible(left, freedom)
            && most_explained < left - freedom as f64
            && most_explained + suspected()? < left - freedom as f64;
        Ok(if is_hopeless { Next::Hopeless } else { Next::Round(more) })
    }

    /// The readings that contradict all others: more than six standard deviations from the fit of
    /// the others, and better explained alone than with any error of a tile. The deviation is the
    /// noise, or the deviation of the residuals if that is larger. A reading with any value is an
    /// outlier of the mean-shift model (R. D. Cook and S. Weisberg, Residuals and Influence in
    /// Regression, 1982, section 2.2.2).
    fn wild(&self, at: &Linearized, compared: &Compared, detected: &[Candidate]) -> Result<Vec<usize>, DiagnosisError> {
        let fit = PriorFit::new(&at.gram, &compared.projected, &self.model.unknowns.with_detected(detected))?;
        let Suspects { readings, limit } = self.suspects(at, compared, &fit);
        if readings.is_empty() {
            return Ok(Vec::new());
        }
        let best_tile = self.scores(&fit, detected).into_iter().map(|(_, score)| score.chi_squared).fold(0.0, f64::max);
        let limit = best_tile.max(limit);
        let wild: Vec<usize> = readings.into_iter().filter(|(_, of)| *of > limit).map(|(reading, _)| reading).collect();
        let unused = at.is_used.iter().filter(|is_used| !**is_used).count();
        let excluded = unused + wild.len() - self.unusable;
        match excluded as f64 > MOST_OUTLIERS * (at.is_used.len() - self.unusable) as f64 {
            true => Err(DiagnosisError::AnotherFilm { outliers: excluded }),
            false => Ok(wild),
        }
    }

    /// The readings that are more than six standard deviations from the fit of the others, at most
    /// [`SUSPECTED`] of them.
    fn suspects(&self, at: &Linearized, compared: &Compared, fit: &PriorFit) -> Suspects {
        let used: Vec<usize> = (0..at.is_used.len()).filter(|reading| at.is_used[*reading]).collect();
        let step = &fit.estimate - self.model.values(&at.state);
        let residual = |reading: usize| {
            Vector3::from_fn(|axis, _| {
                let row = 3 * reading + axis;
                let moved: f64 = at.columns.iter().zip(step.iter()).map(|(column, step)| column[row] * step).sum();
                compared.whitened[row] - moved
            })
        };
        let mut residuals: Vec<(usize, Vector3<f64>)> =
            used.iter().map(|reading| (*reading, residual(*reading))).collect();
        let mut magnitudes: Vec<f64> = residuals.iter().flat_map(|(_, of)| of.abs().as_slice().to_vec()).collect();
        let middle = magnitudes.len() / 2;
        let (_, median, _) = magnitudes.select_nth_unstable_by(middle, f64::total_cmp);
        let variance = (DEVIATION_OVER_MEDIAN * *median).max(1.0).powi(2);
        residuals.sort_by(|(_, a), (_, b)| b.norm_squared().total_cmp(&a.norm_squared()));
        residuals.truncate(SUSPECTED);
        // The test of a reading without the reading itself, by its leverage.
        let chi_squared = |(reading, residual): &(usize, Vector3<f64>)| {
            let own = Matrix3::identity() - fit.leverage(&at.columns, 3 * reading);
            own.cholesky().map_or(0.0, |own| residual.dot(&own.solve(residual)))
        };
        let suspected: Vec<(usize, f64)> = residuals.iter().map(|of| (of.0, chi_squared(of))).collect();
        let limit = OUTLIER * OUTLIER * variance;
        Suspects { readings: suspected.into_iter().filter(|(_, chi_squared)| *chi_squared > limit).collect(), limit }
    }

    /// The model with those of the `usable` readings that agree with the fit of the used ones:
    /// within six standard deviations of the noise and of the fit together. `None` if no reading is
    /// added.
    fn with_unsuspicious(
        &self,
        at: &Linearized,
        compared: &Compared,
        usable: &[bool],
    ) -> Result<Option<Linearized>, DiagnosisError> {
        if at.is_used == usable {
            return Ok(None);
        }
        let fit = PriorFit::new(&at.gram, &compared.projected, &self.model.unknowns.with_detected(&[]))?;
        let all = self.model.linearized(at.state.clone(), at.slopes_at.clone(), usable, None)?;
        let residuals = self.model.compared(&all, self.readings_t).whitened;
        let is_suspicious = |reading: &usize| {
            let row = 3 * reading;
            let residual = Vector3::from_column_slice(&residuals[row..row + 3]);
            let predicted = Matrix3::identity() + fit.leverage(&all.columns, row);
            let chi_squared = predicted.cholesky().map_or(f64::INFINITY, |own| residual.dot(&own.solve(&residual)));
            chi_squared > OUTLIER * OUTLIER
        };
        let suspicious: Vec<usize> = (0..usable.len())
            .filter(|reading| usable[*reading] && !at.is_used[*reading])
            .filter(is_suspicious)
            .collect();
        let admitted = all.without(&suspicious);
        Ok((admitted.is_used != at.is_used).then_some(admitted))
    }

    /// The tests of all errors that are not identified, after the removal of `error`.
    fn without(
        &self,
        at: &Linearized,
        compared: &Compared,
        detected: &[Candidate],
        error: Candidate,
    ) -> Result<Vec<(Candidate, Score)>, DiagnosisError> {
        let rest = rest(detected, error);
        let fit = PriorFit::new(&at.gram, &compared.projected, &self.model.unknowns.with_detected(&rest))?;
        Ok(self.scores(&fit, &rest))
    }

    /// The tests of all errors that are not identified.
    fn scores(&self, fit: &PriorFit, detected: &[Candidate]) -> Vec<(Candidate, Score)> {
        let others: Vec<Candidate> =
            self.candidates.iter().copied().filter(|error| !detected.contains(error)).collect();
        let components: Vec<Vec<usize>> = others.iter().map(|other| self.model.unknowns.of_error(*other)).collect();
        others.into_iter().zip(fit.scores(&components)).collect()
    }
}

/// The errors in an order of their own.
fn sorted(errors: &[Candidate]) -> Vec<Candidate> {
    let mut sorted = errors.to_vec();
    sorted.sort_unstable();
    sorted
}

/// The identified errors without one of them.
fn rest(detected: &[Candidate], error: Candidate) -> Vec<Candidate> {
    detected.iter().copied().filter(|other| *other != error).collect()
}
