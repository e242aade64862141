//! Samples of the linear model, with the same random numbers as exact samples.

use super::model::FirstOrder;
use super::sources::drawn_values;
use crate::draws::Draws;

impl FirstOrder {
    /// The displacement errors of sample number `sample` under the linear model, in mm: x at all
    /// points, then y, then z. Its random numbers are those of the exact sample of the same seed
    /// and number, see [`Sampler::errors_of`](crate::Sampler::errors_of).
    ///
    /// # Accuracy
    /// A few dozen numbers stand for all errors. The expected square of what this leaves out, over
    /// all axes, is at most 1e-8 of the expected square of the displacement errors.
    pub(super) fn linear_sample_mm(&self, seed: u64, sample: u64) -> Vec<f64> {
        let mut draws = Draws::new(seed, sample);
        let values = drawn_values(&self.film, &mut draws, self.points);
        let deviates = self.sensitivities.iter().filter_map(|sensitivity| {
            let term = &self.terms[sensitivity.term];
            (term.deviation != 0.0).then(|| (values[sensitivity.term] - term.mean) / term.deviation)
        });
        let mut errors_mm = self.mean_mm.clone();
        self.varying.add_combination(deviates, &mut errors_mm);
        if self.has_noise() {
            let changes_t: Vec<_> =
                (0..self.points).map(|reading| self.film.draw_noise_t(&mut draws, reading)).collect();
            for (axis, errors_mm) in errors_mm.chunks_exact_mut(self.points).enumerate() {
                for ((error, row), change_t) in errors_mm.iter_mut().zip(self.displacement.rows()).zip(&changes_t) {
                    *error += row[axis].dot(*change_t - self.noise_mean_t);
                }
            }
        }
        errors_mm
    }
}
