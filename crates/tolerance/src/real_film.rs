//! Samples of a film with errors of its tiles.

use glam::{DQuat, DVec3};
use magsplice_magnet::{Tile, TileFaults};

use crate::deviates::Deviates;
use crate::tile_errors::TileErrors;

/// A film with the errors of its tiles.
///
/// ```
/// use glam::DVec3;
/// use magsplice_magnet::Tile;
/// use magsplice_tolerance::{RealFilm, TileErrors};
///
/// let cube = Tile::new(DVec3::ZERO, DVec3::ONE, DVec3::Z).unwrap();
/// let errors = TileErrors { strength: 0.1, ..TileErrors::default() };
/// let film = RealFilm::new(&[cube, cube], &[errors, TileErrors::default()]);
/// let sample = film.sample(1, 0).unwrap();
/// assert!(sample[0].polarization_t() != cube.polarization_t());
/// assert_eq!(sample[1], cube);
/// ```
#[derive(Clone, Debug)]
pub struct RealFilm {
    tiles: Vec<Tile>,
    errors: Vec<TileErrors>,
}

impl RealFilm {
    /// Pairs each tile with its errors.
    ///
    /// # Panics
    /// If there are not as many errors as tiles.
    pub fn new(tiles: &[Tile], errors: &[TileErrors]) -> RealFilm {
        assert_eq!(tiles.len(), errors.len(), "errors of each tile");
        RealFilm { tiles: tiles.to_vec(), errors: errors.to_vec() }
    }

    /// The tiles without errors.
    pub fn tiles(&self) -> &[Tile] {
        &self.tiles
    }

    /// Sample number `sample` of the film. It depends on `seed` and `sample` alone, and a tile of it
    /// on its own errors alone. Tiles may overlap.
    ///
    /// # Errors
    /// The faults of the first tile that cannot exist, such as one without thickness.
    pub fn sample(&self, seed: u64, sample: u64) -> Result<Vec<Tile>, TileFaults> {
        let mut deviates = Deviates::new(seed, sample);
        let tiles = self.tiles.iter().zip(&self.errors).enumerate();
        tiles.map(|(index, (tile, errors))| with_errors(tile, errors, deviates.of_tile(index))).collect()
    }
}

/// A tile with errors of these deviates: three each of position, rotation and size, one of strength,
/// and two of direction.
fn with_errors(tile: &Tile, errors: &TileErrors, deviates: [f64; 12]) -> Result<Tile, TileFaults> {
    if *errors == TileErrors::default() {
        return Ok(*tile);
    }
    let [px, py, pz, rx, ry, rz, sx, sy, sz, strength, first, second] = deviates;
    let position = tile.position() + errors.position * DVec3::new(px, py, pz);
    let turn = DQuat::from_scaled_axis(errors.rotation_rad * DVec3::new(rx, ry, rz));
    let size = tile.size() + errors.size * DVec3::new(sx, sy, sz);
    let j_t = tile.polarization_t();
    let mut turned_t = j_t;
    if let Some(along) = j_t.try_normalize() {
        let (one, other) = along.any_orthonormal_pair();
        let axis = errors.direction_rad * (first * one + second * other);
        turned_t = DQuat::from_scaled_axis(axis) * j_t;
    }
    Tile::new(position, size, turned_t * (1.0 + errors.strength * strength))?.rotated(turn * tile.rotation())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn film(errors: TileErrors) -> RealFilm {
        let tile = |n: usize| {
            let turn = DQuat::from_scaled_axis(DVec3::new(0.3, -0.2, 0.1) * n as f64);
            let tile = Tile::new(DVec3::splat(n as f64), DVec3::new(3.0, 2.0, 1.0), DVec3::new(0.3, -0.4, 0.5));
            tile.and_then(|tile| tile.rotated(turn)).expect("valid")
        };
        let tiles: Vec<Tile> = (0..4).map(tile).collect();
        RealFilm::new(&tiles, &[errors; 4])
    }

    /// Means of squares of each error over `n` values are wrong by a normal error of (2 / n)^1/2.
    /// Six of these are allowed, and the square of the error, by which rotations are not normal.
    #[test]
    fn samples_have_the_standard_deviations_of_the_errors() {
        let errors = TileErrors {
            position: DVec3::new(0.01, 0.02, 0.03),
            rotation_rad: DVec3::new(0.004, 0.005, 0.006),
            size: DVec3::new(0.001, 0.002, 0.003),
            strength: 0.01,
            direction_rad: 0.02,
        };
        let film = film(errors);
        let (mut squares, mut count) = ([[0.0; 3]; 3], 0.0);
        let (mut strength, mut direction) = (0.0, 0.0);
        for sample in 0..5000 {
            let made = film.sample(11, sample).expect("no tile has lost its sides");
            for (tile, ideal) in made.iter().zip(film.tiles()) {
                let turn = (tile.rotation() * ideal.rotation().inverse()).to_scaled_axis();
                let found = [tile.position() - ideal.position(), turn, tile.size() - ideal.size()];
                for (sums, found) in squares.iter_mut().zip(found) {
                    (0..3).for_each(|axis| sums[axis] += found[axis].powi(2));
                }
                let (j, ideal_j) = (tile.polarization_t(), ideal.polarization_t());
                strength += (j.length() / ideal_j.length() - 1.0).powi(2);
                direction += j.angle_between(ideal_j).powi(2);
                count += 1.0;
            }
        }
        let allowed = 6.0 * (2.0_f64 / count).sqrt() + 1e-3;
        let wanted = [errors.position, errors.rotation_rad, errors.size];
        for (squares, wanted) in squares.iter().zip(wanted) {
            for axis in 0..3 {
                let ratio = squares[axis] / count / wanted[axis].powi(2);
                assert!((ratio - 1.0).abs() < allowed, "{ratio} along {axis} of {wanted}");
            }
        }
        let ratio = strength / count / errors.strength.powi(2);
        assert!((ratio - 1.0).abs() < allowed, "{ratio} of the strength");
        // Two angles.
        let ratio = direction / count / (2.0 * errors.direction_rad.powi(2));
        assert!((ratio - 1.0).abs() < allowed, "{ratio} of the direction");
    }

    #[test]
    fn a_further_error_changes_no_other() {
        let only_position = TileErrors { position: DVec3::splat(0.1), ..TileErrors::default() };
        let both = TileErrors { strength: 0.1, ..only_position };
        let (one, other) = (film(only_position).sample(5, 17), film(both).sample(5, 17));
        for (one, other) in one.expect("valid").iter().zip(&other.expect("valid")) {
            assert_eq!(one.position(), other.position());
            assert_ne!(one.polarization_t(), other.polarization_t());
        }
    }

    #[test]
    fn tiles_that_cannot_exist_are_faults() {
        let errors = TileErrors { size: DVec3::splat(10.0), ..TileErrors::default() };
        assert!((0..20).any(|sample| film(errors).sample(1, sample).is_err()));
    }
}
