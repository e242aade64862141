//! Errors of measurements of tiles, and their effect on films sorted by them.

use glam::{DQuat, DVec3};
use magsplice_tolerance::Statistics;
use rand::{RngCore, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::assignment::{AssignmentError, CutTile, PlacedTile};
use crate::problem::AssignmentProblem;

/// Number of samples of measurements of one film, for a standard error of 1 % of the 95th
/// percentile.
const SAMPLES: u64 = 4000;

/// Standard deviations of the errors of a measurement. The errors are normal and independent.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct MeasurementErrors {
    /// Error of |J|, as a fraction of it.
    pub strength: f64,
    /// Angle of J about each of two axes normal to it, in radians.
    pub direction_rad: f64,
    /// Error of each side, in millimetres. `None` if sides are taken as ordered, without
    /// measurement.
    pub size_mm: Option<f64>,
}

impl MeasurementErrors {
    /// The measured tile, with errors drawn from a random stream. `ordered_mm` are its ordered
    /// sides.
    pub fn measured(&self, tile: &CutTile, ordered_mm: DVec3, random: &mut impl RngCore) -> CutTile {
        let [strength, first, second, x, y, z] = std::array::from_fn(|_| normal(random));
        let j_t = tile.polarization_t;
        let turned_t = match j_t.try_normalize() {
            Some(along) => {
                let across = along.any_orthonormal_vector();
                DQuat::from_scaled_axis(self.direction_rad * (first * across + second * along.cross(across))) * j_t
            }
            None => j_t,
        };
        CutTile {
            name: tile.name.clone(),
            polarization_t: turned_t * (1.0 + self.strength * strength),
            size_mm: self.size_mm.map_or(ordered_mm, |error| tile.size_mm + error * DVec3::new(x, y, z)),
        }
    }
}

impl AssignmentProblem<'_> {
    /// The distribution of the root mean square of the displacement errors, in mm, of a film whose
    /// tiles were measured with these errors, over 4000 measurements by the linear model.
    ///
    /// The true tiles are taken as the measured tiles minus errors of the measurement. This
    /// overestimates the errors where measurement errors are not small compared with the
    /// differences of the tiles: by a tenth of the mean square if they are a third of the
    /// differences.
    ///
    /// # Errors
    /// If a tile is invalid, or the parameters of a film are undefined.
    ///
    /// # Panics
    /// If the number of factors differs from the number of shim tiles.
    pub fn rms_of_measured_mm(
        &self,
        placed: &[PlacedTile],
        shim_factors: &[f64],
        errors: &MeasurementErrors,
        seed: u64,
    ) -> Result<Statistics, AssignmentError> {
        let nominal = self.exact(placed, shim_factors)?;
        // The effect of each error at one standard deviation.
        let columns: Vec<Vec<f64>> = placed.iter().flat_map(|placed| self.changes_by_errors(placed, errors)).collect();
        let rms_mm = |sample: u64| {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            random.set_stream(sample);
            let mut sum = nominal.clone();
            for column in &columns {
                let deviate = normal(&mut random);
                sum.iter_mut().zip(column).for_each(|(sum, value)| *sum += deviate * value);
            }
            self.model().rms_mm(&sum)
        };
        let samples: Vec<f64> = (0..SAMPLES).into_par_iter().map(rms_mm).collect();
        Ok(Statistics::new(samples).expect("there are samples"))
    }

    /// Changes of the displacement errors by one standard deviation of each error of a tile.
    fn changes_by_errors(&self, placed: &PlacedTile, errors: &MeasurementErrors) -> Vec<Vec<f64>> {
        let j_t = placed.orientation.apply(self.cut_tile(placed).polarization_t);
        let mut changes = Vec::new();
        if let Some(along) = j_t.try_normalize() {
            let across = along.any_orthonormal_vector();
            let turned = errors.direction_rad * j_t.length();
            for j_t in [errors.strength * j_t, turned * across, turned * along.cross(across)] {
                changes.push(self.model().change(placed.place, j_t, DVec3::ZERO));
            }
        }
        if let Some(error) = errors.size_mm {
            let sides = DVec3::AXES.map(|axis| error * axis);
            changes.extend(sides.map(|size_mm| self.model().change(placed.place, DVec3::ZERO, size_mm)));
        }
        changes
    }
}

/// A normal deviate of mean 0 and deviation 1 (Box and Muller).
fn normal(random: &mut impl RngCore) -> f64 {
    let uniform = |bits: u64| (bits >> 11) as f64 / (1_u64 << 53) as f64;
    let (radius, turn) = (1.0 - uniform(random.next_u64()), uniform(random.next_u64()));
    (-2.0 * radius.ln()).sqrt() * (std::f64::consts::TAU * turn).cos()
}
