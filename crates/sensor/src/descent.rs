//! Gauss-Newton steps towards the position with a reading, for many readings at once to evaluate
//! the field at many points per call.

use glam::{DMat3, DVec3};

use crate::sensed_field::SensedField;

/// Largest number of evaluations of one search. Convergence takes five; a halved step takes one
/// more.
const MOST_EVALUATIONS: usize = 60;

/// Length of a step, as a fraction of the diagonal of the volume, below which the search ends.
/// Steps converge quadratically, so the remaining error is the square of this length, plus
/// round-off.
const SHORTEST_STEP: f64 = 1e-8;

/// Longest step, as a fraction of the diagonal. Farther away the field is not linear.
const LONGEST_STEP: f64 = 0.25;

/// Largest difference of a field from the reading, as a fraction of its magnitude, that counts as
/// equal. The error of the exact field is 1e-13 of the sum over tiles, which is rarely 1e4 times
/// the field.
pub(crate) const SAME_FIELD: f64 = 1e-9;

/// The box of the search for positions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Region {
    pub(crate) lower: DVec3,
    pub(crate) upper: DVec3,
    /// Diagonal of the volume.
    pub(crate) diagonal: f64,
}

/// The end of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Ending {
    /// The field at the position equals the reading. Includes the gradient of the field there.
    Found { position: DVec3, gradient: DMat3 },
    /// The search ended where the field differs from the reading.
    Lost,
}

/// A search in progress.
struct Descent {
    search: usize,
    reading_t: DVec3,
    /// The best point so far, its distance from the reading in tesla, and its gradient.
    best: Option<(DVec3, f64, DMat3)>,
    candidate: DVec3,
    step: DVec3,
}

/// Searches from each start for the position with its reading.
pub(crate) fn descend(field: &SensedField, region: &Region, searches: &[(DVec3, DVec3)]) -> Vec<Ending> {
    let mut endings = vec![Ending::Lost; searches.len()];
    let mut active: Vec<Descent> = searches
        .iter()
        .enumerate()
        .map(|(search, &(reading_t, start))| Descent {
            search,
            reading_t,
            best: None,
            candidate: start,
            step: DVec3::ZERO,
        })
        .collect();
    for _ in 0..MOST_EVALUATIONS {
        if active.is_empty() {
            break;
        }
        let points: Vec<DVec3> = active.iter().map(|descent| descent.candidate).collect();
        // The field on edges is NaN, and the step is halved.
        let (readings_t, gradient) = field.readings_and_gradients(&points);
        let mut evaluated = readings_t.into_iter().zip(gradient);
        active.retain_mut(|descent| {
            let (field_t, gradient) = evaluated.next().expect("a value for each point");
            match descent.next(field_t, gradient, region) {
                None => true,
                Some(ending) => {
                    endings[descent.search] = ending;
                    false
                }
            }
        });
    }
    endings
}

impl Descent {
    /// Chooses the next candidate from the field and its gradient at the current candidate. Returns
    /// the end of the search, if it ended.
    fn next(&mut self, field_t: DVec3, gradient: DMat3, region: &Region) -> Option<Ending> {
        let difference = self.reading_t - field_t;
        let distance = difference.length();
        let is_better = match self.best {
            None => distance.is_finite(),
            Some((_, before, _)) => distance < before,
        };
        if is_better {
            self.best = Some((self.candidate, distance, gradient));
            let step = gradient.inverse() * difference;
            if !step.is_finite() {
                return Some(self.ending(region));
            }
            self.step = step.clamp_length_max(LONGEST_STEP * region.diagonal);
        } else {
            self.step *= 0.5;
        }
        let (from, ..) = self.best?;
        // A step out of the region ends on its surface, from which later steps lead back.
        self.candidate = (from + self.step).clamp(region.lower, region.upper);
        self.step = self.candidate - from;
        if self.step.length() <= SHORTEST_STEP * region.diagonal {
            // The last step needs no evaluation, because the field is linear over it.
            return Some(self.ending(region));
        }
        None
    }

    fn ending(&self, region: &Region) -> Ending {
        match self.best {
            Some((from, distance, gradient)) => {
                let position = from + self.step;
                // The largest change of the field over the last step.
                let change = (gradient * self.step).length();
                let is_same = distance <= SAME_FIELD * self.reading_t.length() + 2.0 * change;
                let is_short = self.step.length() <= SHORTEST_STEP * region.diagonal;
                if is_same && is_short { Ending::Found { position, gradient } } else { Ending::Lost }
            }
            None => Ending::Lost,
        }
    }
}
