//! Weights with the least noise.

use glam::DVec3;
use nalgebra::{DMatrix, DVector};
use thiserror::Error;

/// Singular value of the conditions, over the largest, below which they count as dependent. Places
/// of boards have four or more digits, so independent conditions have larger ones.
const DEPENDENT: f64 = 1e-9;

/// Largest error of a condition of weights that satisfy it. Round-off is 1e-15 times the weights,
/// which are below 1e4 for spacings of a thousandth of the wavelength.
const SATISFIED: f64 = 1e-9;

/// The reason why a head has no weights.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum WeightsError {
    /// No weights of sensors at these places reject uniform fields and keep the form of Eq. 2.
    #[error(
        "no weights of sensors at these places reject uniform fields and keep the form of the ideal film: use places \
         that differ in z, or by half a wavelength in x and in y, or state the weights"
    )]
    NoWeights,
}

/// The weights with the least noise among those that reject uniform fields and keep the form of
/// Eq. 2 with the factor 1 (Eqs. 1 and 2 of the crate). Where sensors at these places can also
/// reject fields that change linearly (Eq. 3), the weights do. `deviations` are the standard
/// deviations of the sensors' noise, in any unit.
///
/// # Errors
/// [`WeightsError::NoWeights`].
///
/// # Panics
/// If the numbers of places and deviations differ.
pub fn least_noise_weights(places: &[DVec3], deviations: &[f64], wavenumber: f64) -> Result<Vec<f64>, WeightsError> {
    assert_eq!(places.len(), deviations.len(), "a deviation for each place");
    // A sensor without noise would make the others useless: equal noise instead.
    let has_noise = deviations.iter().all(|deviation| *deviation > 0.0 && deviation.is_finite());
    let deviation = |index: usize| if has_noise { deviations[index] / deviations[0] } else { 1.0 };
    let condition = |row: usize, place: DVec3| -> f64 {
        let wave = |angle: f64| (wavenumber * place.z).exp() * angle;
        match row {
            0 => wave((wavenumber * place.x).cos()),
            1 => wave((wavenumber * place.x).sin()),
            2 => wave((wavenumber * place.y).cos()),
            3 => wave((wavenumber * place.y).sin()),
            4 => 1.0,
            _ => wavenumber * place[row - 5],
        }
    };
    let wanted = |row: usize| if row == 0 || row == 2 { 1.0 } else { 0.0 };
    [8, 5]
        .into_iter()
        .find_map(|conditions| {
            let all = DMatrix::from_fn(conditions, places.len(), |row, of| condition(row, places[of]));
            let over_noise = DMatrix::from_fn(conditions, places.len(), |row, of| all[(row, of)] / deviation(of));
            let wanted = DVector::from_fn(conditions, |row, _| wanted(row));
            let singular = over_noise.svd(true, true);
            let least = DEPENDENT * singular.singular_values.max();
            let scaled = singular.solve(&wanted, least).ok()?;
            let weights = DVector::from_fn(places.len(), |of, _| scaled[of] / deviation(of));
            ((all * &weights - wanted).amax() < SATISFIED).then(|| weights.iter().copied().collect())
        })
        .ok_or(WeightsError::NoWeights)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use glam::DVec2;
    use magsplice_ideal::IdealFilm;
    use proptest::prelude::*;

    use super::*;
    use crate::board::Board;
    use crate::form::HeadForm;

    const WAVENUMBER: f64 = TAU / 10.0;

    fn close(found: &[f64], expected: &[f64]) {
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}, not {expected:?}");
    }

    /// The weights of pairs and of the cross have closed forms.
    #[test]
    fn boards_have_their_known_weights() {
        let weights = |board: Board, spacing: f64| {
            let places = board.places(spacing);
            least_noise_weights(&places, &vec![1e-6; places.len()], WAVENUMBER).unwrap()
        };
        let near = 1.0 / (1.0 - (-WAVENUMBER).exp());
        close(&weights(Board::PairZ, 1.0), &[near, -near]);
        close(&weights(Board::PairXy, 5.0), &[0.5, -0.5]);
        close(&weights(Board::Cross, 5.0), &[0.5, -0.125, -0.125, -0.125, -0.125]);
    }

    /// Side by side, sensors that are not half a wavelength apart turn the phase of the field.
    #[test]
    fn places_without_weights_are_refused() {
        let places = Board::PairXy.places(4.0);
        assert_eq!(least_noise_weights(&places, &[1.0; 2], WAVENUMBER), Err(WeightsError::NoWeights));
        assert_eq!(least_noise_weights(&[DVec3::ZERO], &[1.0], WAVENUMBER), Err(WeightsError::NoWeights));
    }

    /// A sensor of twice the noise gets a smaller weight. No other weights have less noise: they
    /// differ by a combination that every condition maps to 0.
    #[test]
    fn noisy_sensors_count_less() {
        let mut places = Board::Cross.places(5.0);
        places.push(DVec3::new(0.0, 0.0, 0.0));
        let weights = least_noise_weights(&places, &[1.0, 1.0, 1.0, 1.0, 1.0, 2.0], WAVENUMBER).unwrap();
        close(&weights, &[0.4, -0.125, -0.125, -0.125, -0.125, 0.1]);
    }

    proptest! {
        /// Weights of twelve sensors near the points of a grid satisfy their conditions: the head
        /// reads an ideal film as one sensor does, and uniform and linear fields as 0. Sensors
        /// anywhere may be too close to a board that cannot reject linear fields.
        #[test]
        fn heads_read_ideal_films_and_no_stray_fields(
            shifts in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 12),
            at in prop::array::uniform3(-4.0..-1.0_f64),
            stray_t in prop::array::uniform3(-1.0..1.0_f64),
        ) {
            let grid = (0..12).map(|n| DVec3::new(3.0 * f64::from(n % 4) - 4.5, 3.0 * f64::from(n / 4) - 3.0, -1.0));
            let places: Vec<DVec3> = grid.zip(shifts).map(|(point, shift)| point + DVec3::from(shift)).collect();
            let weights = least_noise_weights(&places, &vec![1.0; places.len()], WAVENUMBER).unwrap();
            let ideal = IdealFilm::new(10.0, 1.0, 0.12).unwrap();
            let (at, stray_t) = (DVec3::from(at), DVec3::from(stray_t));
            let seen = |field: &dyn Fn(DVec3) -> DVec3| -> DVec3 {
                places.iter().zip(&weights).map(|(place, weight)| *weight * field(at + *place)).sum()
            };
            let one = ideal.flux_density_t(at).unwrap();
            // Round-off is that of the sum of the magnitudes of the terms.
            let most = 1e-9 * weights.iter().map(|weight| weight.abs()).sum::<f64>();
            prop_assert!((seen(&|point| ideal.flux_density_t(point).unwrap()) - one).length() < most);
            prop_assert!(seen(&|_| stray_t).length() < 10.0 * most);
            prop_assert!(seen(&|point| stray_t * point.dot(stray_t)).length() < 100.0 * most);
            let form = HeadForm::new(&places, &weights.iter().map(|of| DVec3::splat(*of)).collect::<Vec<_>>(), WAVENUMBER);
            prop_assert!(form.distance() < most && (form.factor() - 1.0).abs() < most);
        }
    }

    /// A head of one sensor keeps the form and rejects nothing. A turned phase is a distance.
    #[test]
    fn forms_state_factor_and_distance() {
        let one = HeadForm::new(&[DVec3::ZERO], &[DVec3::ONE], WAVENUMBER);
        assert_eq!((one.factor(), one.distance(), one.uniform), (1.0, 0.0, DVec3::ONE));
        let shifted = HeadForm::new(&[DVec3::new(1.0, 0.0, 0.0)], &[DVec3::ONE], WAVENUMBER);
        let along_x = DVec2::from_angle(WAVENUMBER);
        let factor = 0.5 * (1.0 + along_x.x);
        assert!((shifted.factor() - factor).abs() < 1e-15);
        assert!((shifted.distance() - along_x.distance(DVec2::new(factor, 0.0)) / factor).abs() < 1e-15);
    }
}
