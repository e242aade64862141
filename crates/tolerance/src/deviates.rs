//! Independent normal deviates by sample, tile and error, without state: each is a function of the
//! seed and its own place alone.

use std::f64::consts::TAU;

use rand::{RngCore, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Normal deviates of one tile. They are an even number, as Box's and Muller's method makes pairs.
pub(crate) const DEVIATES_PER_TILE: usize = 12;

/// Words of 32 bits of the random stream for each deviate.
const WORDS_PER_DEVIATE: u128 = 2;

/// The deviates of all tiles of one sample. The stream of ChaCha8 that belongs to the sample is read
/// at the place of the tile, so that neither other samples nor other tiles change them.
pub(crate) struct Deviates(ChaCha8Rng);

impl Deviates {
    pub(crate) fn new(seed: u64, sample: u64) -> Deviates {
        let mut stream = ChaCha8Rng::seed_from_u64(seed);
        stream.set_stream(sample);
        Deviates(stream)
    }

    /// Deviates of mean 0 and standard deviation 1 of a tile.
    pub(crate) fn of_tile(&mut self, tile: usize) -> [f64; DEVIATES_PER_TILE] {
        self.0.set_word_pos(tile as u128 * DEVIATES_PER_TILE as u128 * WORDS_PER_DEVIATE);
        let mut deviates = [0.0; DEVIATES_PER_TILE];
        for pair in deviates.chunks_exact_mut(2) {
            // In (0, 1], so that the logarithm is finite.
            let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
            let (sine, cosine) = (TAU * self.uniform()).sin_cos();
            pair.copy_from_slice(&[radius * cosine, radius * sine]);
        }
        deviates
    }

    /// A uniform deviate in [0, 1), a multiple of 2^-53.
    fn uniform(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean, variance and fourth moment of n normal deviates deviate from 0, 1 and 3 by normal errors
    /// of 1, 2^1/2 and 96^1/2 over the root of n. Six of these are allowed.
    #[test]
    fn deviates_are_normal_and_independent() {
        let tiles = 20_000;
        let mut stream = Deviates::new(7, 3);
        let all: Vec<[f64; DEVIATES_PER_TILE]> = (0..tiles).map(|tile| stream.of_tile(tile)).collect();
        let root = (tiles as f64).sqrt();
        let mean = |f: &dyn Fn(&[f64; DEVIATES_PER_TILE]) -> f64| all.iter().map(f).sum::<f64>() / tiles as f64;
        for i in 0..DEVIATES_PER_TILE {
            assert!(mean(&|d| d[i]).abs() < 6.0 / root, "mean of deviate {i}");
            assert!((mean(&|d| d[i].powi(2)) - 1.0).abs() < 6.0 * 2.0_f64.sqrt() / root, "variance of deviate {i}");
            assert!((mean(&|d| d[i].powi(4)) - 3.0).abs() < 6.0 * 96.0_f64.sqrt() / root, "moment of deviate {i}");
            for j in 0..i {
                assert!(mean(&|d| d[i] * d[j]).abs() < 6.0 / root, "deviates {i} and {j}");
            }
        }
    }

    #[test]
    fn deviates_depend_on_seed_sample_and_tile_alone() {
        let in_order = Deviates::new(7, 3).of_tile(4);
        let mut later = Deviates::new(7, 3);
        later.of_tile(9);
        assert_eq!(later.of_tile(4), in_order);
        assert_ne!(Deviates::new(8, 3).of_tile(4), in_order);
        assert_ne!(Deviates::new(7, 2).of_tile(4), in_order);
        assert_ne!(Deviates::new(7, 3).of_tile(5), in_order);
    }
}
