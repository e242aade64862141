//! Random errors without state: each is a function of the seed, the sample and its own place only.

use std::f64::consts::TAU;

use glam::DVec3;
use magsplice_layout::{Distribution, StrayField, TileErrors};
use magsplice_magnet::{PerTileError, TileError};
use rand::{RngCore, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::quantile::{mean, quantile};

/// Words of 32 bits of the random stream for each deviate.
const WORDS_PER_DEVIATE: u128 = 2;

/// Regions of the stream of a sample, in deviates. Each has room for 2^40 deviates, more than any
/// layout has errors.
const REGION: u128 = 1 << 40;

/// Deviates of one sample. Each error has its own place in the ChaCha8 stream of the sample, so
/// neither other samples nor other errors change it.
pub(crate) struct Draws {
    stream: ChaCha8Rng,
}

impl Draws {
    pub(crate) fn new(seed: u64, sample: u64) -> Draws {
        let mut stream = ChaCha8Rng::seed_from_u64(seed);
        stream.set_stream(sample);
        Draws { stream }
    }

    /// The errors of tile number `tile`.
    pub(crate) fn of_tile(&mut self, tile: usize, errors: &TileErrors) -> PerTileError<f64> {
        self.of_errors(0, tile, errors)
    }

    /// The errors of group number `group`.
    pub(crate) fn of_group(&mut self, group: usize, errors: &TileErrors) -> PerTileError<f64> {
        self.of_errors(REGION, group, errors)
    }

    fn of_errors(&mut self, region: u128, number: usize, errors: &TileErrors) -> PerTileError<f64> {
        let mut drawn = PerTileError::default();
        let place = region + (number * TileError::ALL.len()) as u128;
        self.fill(place, errors.values(), drawn.iter_mut().map(|(_, value)| value));
        drawn
    }

    /// Values of errors that all tiles share. `cause` is the number of the first.
    pub(crate) fn common<const N: usize>(&mut self, cause: usize, errors: [&Distribution; N]) -> [f64; N] {
        let mut values = [0.0; N];
        self.fill(2 * REGION + cause as u128, errors.into_iter(), values.iter_mut());
        values
    }

    /// The uniform field, whose errors begin at number `cause`.
    pub(crate) fn stray_field_t(&mut self, cause: usize, field: &StrayField) -> DVec3 {
        let [x, y, z] = &field.field_t;
        let components = self.common(cause, [x, y, z]);
        let [magnitude] = self.common(cause + 3, [&field.any_direction_t]);
        // The direction does not depend on how the magnitude is distributed.
        let unit = Distribution::Uniform { half_width: 1.0 };
        let [height, turn] = self.common(cause + 4, [&unit, &unit]);
        let (sine, cosine) = (0.5 * TAU * turn).sin_cos();
        let across = (1.0 - height * height).sqrt();
        DVec3::from(components) + magnitude * DVec3::new(across * cosine, across * sine, height)
    }

    /// Noise of reading number `reading` along each axis.
    pub(crate) fn noise_t(&mut self, reading: usize, errors: &[Distribution; 3]) -> DVec3 {
        let mut values = [0.0; 3];
        self.fill(3 * REGION + 3 * reading as u128, errors.iter(), values.iter_mut());
        DVec3::from(values)
    }

    /// Values of distributions, the first at this place of the stream.
    fn fill<'e, 'v>(
        &mut self,
        place: u128,
        errors: impl Iterator<Item = &'e Distribution> + Clone,
        values: impl Iterator<Item = &'v mut f64>,
    ) {
        let is_fixed = |error: &Distribution| matches!(error, Distribution::Fixed(_));
        if errors.clone().all(is_fixed) {
            values.zip(errors).for_each(|(value, error)| *value = mean(error));
            return;
        }
        self.stream.set_word_pos(place * WORDS_PER_DEVIATE);
        for (value, error) in values.zip(errors) {
            *value = quantile(error, self.uniform());
        }
    }

    /// A uniform deviate in (0, 1), an odd multiple of 2^-53, so that its quantiles are finite.
    fn uniform(&mut self) -> f64 {
        ((self.stream.next_u64() >> 12) as f64 + 0.5) / (1_u64 << 52) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all_normal() -> TileErrors {
        TileErrors::from_fn(|_| Distribution::normal(1.0))
    }

    /// Mean, variance and fourth moment of n normal deviates deviate from 0, 1 and 3 by normal
    /// errors of 1, 2^1/2 and 96^1/2 over the root of n. Six of these are allowed.
    #[test]
    fn deviates_are_normal_and_independent() {
        let tiles = 20_000;
        let mut draws = Draws::new(7, 3);
        let errors = all_normal();
        let all: Vec<_> = (0..tiles).map(|tile| draws.of_tile(tile, &errors)).collect();
        let root = (tiles as f64).sqrt();
        let mean = |f: &dyn Fn(&PerTileError<f64>) -> f64| all.iter().map(f).sum::<f64>() / tiles as f64;
        for (number, i) in TileError::ALL.into_iter().enumerate() {
            assert!(mean(&|d| d[i]).abs() < 6.0 / root, "mean of deviate {i:?}");
            assert!((mean(&|d| d[i].powi(2)) - 1.0).abs() < 6.0 * 2.0_f64.sqrt() / root, "variance of deviate {i:?}");
            assert!((mean(&|d| d[i].powi(4)) - 3.0).abs() < 6.0 * 96.0_f64.sqrt() / root, "moment of deviate {i:?}");
            for &j in &TileError::ALL[..number] {
                assert!(mean(&|d| d[i] * d[j]).abs() < 6.0 / root, "deviates {i:?} and {j:?}");
            }
        }
    }

    #[test]
    fn draws_depend_on_seed_sample_and_place_alone() {
        let errors = all_normal();
        let in_order = Draws::new(7, 3).of_tile(4, &errors);
        let mut later = Draws::new(7, 3);
        later.of_tile(9, &errors);
        assert_eq!(later.of_tile(4, &errors), in_order);
        for (seed, sample, tile) in [(8, 3, 4), (7, 2, 4), (7, 3, 5)] {
            assert_ne!(Draws::new(seed, sample).of_tile(tile, &errors), in_order);
        }
        // Tiles, groups, common errors and noise have deviates of their own.
        let position = in_order.position;
        assert_ne!(later.of_group(4, &errors), in_order);
        let [x, y, z] = &errors.position;
        assert_ne!(later.common(4 * TileError::ALL.len(), [x, y, z]), position);
        assert_ne!(later.noise_t(4 * TileError::ALL.len() / 3, &errors.position).to_array(), position);
        // The first place of each differs too.
        let first = [
            later.of_tile(0, &errors).position,
            later.of_group(0, &errors).position,
            later.common(0, [x, y, z]),
            later.noise_t(0, &errors.position).to_array(),
        ];
        for (number, place) in first.iter().enumerate() {
            assert!(first[..number].iter().all(|other| other != place), "{first:?}");
        }
    }

    /// Mean and mean square of n normal deviates scatter about 0 and 1 by 1 and 2^1/2 over the root
    /// of n. Six of these are allowed.
    #[test]
    fn noise_has_its_deviation_along_each_axis() {
        let deviations_t = DVec3::new(1e-6, 2e-6, 5e-6);
        let noise = deviations_t.to_array().map(Distribution::normal);
        let n = 10_000;
        let mut draws = Draws::new(3, 5);
        let all: Vec<DVec3> = (0..n).map(|reading| draws.noise_t(reading, &noise) / deviations_t).collect();
        let root = (n as f64).sqrt();
        let mean = all.iter().sum::<DVec3>() / n as f64;
        let squares = all.iter().map(|b| *b * *b).sum::<DVec3>() / n as f64;
        assert!(mean.abs().max_element() < 6.0 / root, "{mean}");
        assert!((squares - 1.0).abs().max_element() < 6.0 * 2.0_f64.sqrt() / root, "{squares}");
    }

    /// Components of a unit vector of any direction have mean 0 and mean square 1/3, with standard
    /// deviations of (1/3)^1/2 and (4/45)^1/2 over the root of n.
    #[test]
    fn any_direction_has_no_preference() {
        let field = StrayField { any_direction_t: Distribution::Fixed(2.0), ..StrayField::default() };
        let n = 20_000;
        let all: Vec<DVec3> = (0..n).map(|sample| 0.5 * Draws::new(1, sample).stray_field_t(6, &field)).collect();
        let root = (n as f64).sqrt();
        assert!(all.iter().all(|b| (b.length() - 1.0).abs() < 1e-12));
        let mean = all.iter().sum::<DVec3>() / n as f64;
        assert!(mean.abs().max_element() < 6.0 * (1.0 / 3.0_f64).sqrt() / root, "{mean}");
        let squares = all.iter().map(|b| *b * *b).sum::<DVec3>() / n as f64 - DVec3::splat(1.0 / 3.0);
        assert!(squares.abs().max_element() < 6.0 * (4.0_f64 / 45.0).sqrt() / root, "{squares}");
        let products = all.iter().map(|b| b.x * b.y).sum::<f64>() / n as f64;
        assert!(products.abs() < 6.0 * (1.0 / 15.0_f64).sqrt() / root, "{products}");
    }
}
