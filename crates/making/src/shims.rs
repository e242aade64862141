//! Shim tiles, whose strength is chosen after all other tiles are placed.

use glam::DVec3;
use magsplice_magnet::Tile;
use magsplice_tolerance::TileChanges;

use crate::assignment::AssignmentError;

/// Smallest part of a shim's contribution that is independent of the other shims. A smaller part is
/// mostly round-off, and would require impossible strengths.
const OWN_PART: f64 = 1e-6;

/// Number of rounds of least squares with the exact field. Each squares the remaining error, which
/// is a few percent at first.
const ROUNDS: usize = 4;

/// Shim tiles of a film, and their effects on its displacement errors.
#[derive(Clone, Debug)]
pub(crate) struct Shims {
    tiles: Vec<usize>,
    /// Orthonormal coordinates that span the contributions.
    basis: Vec<Vec<f64>>,
    /// For each shim, the components along the basis of its contribution at twice its strength
    /// minus its contribution at its strength. Upper triangular.
    components: Vec<Vec<f64>>,
}

impl Shims {
    pub(crate) fn new(model: &TileChanges, film: &[Tile], tiles: &[usize]) -> Result<Shims, AssignmentError> {
        let mut shims = Shims { tiles: tiles.to_vec(), basis: Vec::new(), components: Vec::new() };
        for &tile in tiles {
            let mut own = model.change(tile, film[tile].polarization_t(), DVec3::ZERO);
            let whole = dot(&own, &own).sqrt();
            let mut along: Vec<f64> = shims.basis.iter().map(|unit| dot(unit, &own)).collect();
            shims.take_out(&mut own);
            let left = dot(&own, &own).sqrt();
            if left.is_nan() || left <= OWN_PART * whole {
                return Err(AssignmentError::Shim { tile });
            }
            along.push(left);
            shims.components.push(along);
            shims.basis.push(own.into_iter().map(|value| value / left).collect());
        }
        Ok(shims)
    }

    /// Removes the part of displacement errors that shims can compensate.
    pub(crate) fn take_out(&self, errors: &mut [f64]) {
        for unit in &self.basis {
            let along = dot(unit, errors);
            errors.iter_mut().zip(unit).for_each(|(error, unit)| *error -= along * unit);
        }
    }

    /// The factors of unchanged shims.
    pub(crate) fn unchanged(&self) -> Vec<f64> {
        vec![1.0; self.tiles.len()]
    }

    /// The factors with the smallest mean square error. `errors` gives the errors at given factors.
    pub(crate) fn factors(
        &self,
        errors: impl Fn(&[f64]) -> Result<Vec<f64>, AssignmentError>,
    ) -> Result<Vec<f64>, AssignmentError> {
        let mut factors = self.unchanged();
        if self.tiles.is_empty() {
            return Ok(factors);
        }
        for _ in 0..ROUNDS {
            let errors = errors(&factors)?;
            let mut left: Vec<f64> = self.basis.iter().map(|unit| -dot(unit, &errors)).collect();
            for shim in (0..self.tiles.len()).rev() {
                let change = left[shim] / self.components[shim][shim];
                factors[shim] += change;
                left.iter_mut().zip(&self.components[shim]).for_each(|(left, along)| *left -= change * along);
            }
        }
        Ok(factors)
    }

    /// Multiplies the polarization of the shims of a film.
    pub(crate) fn apply(&self, film: &mut [Tile], factors: &[f64]) -> Result<(), AssignmentError> {
        assert_eq!(factors.len(), self.tiles.len(), "one factor for each shim");
        for (&tile, factor) in self.tiles.iter().zip(factors) {
            let old = film[tile];
            film[tile] = Tile::new(old.position(), old.size(), old.polarization_t() * *factor)
                .and_then(|new| new.rotated(old.rotation()))
                .map_err(|faults| AssignmentError::Tile { name: format!("shim {}", tile + 1), faults })?;
        }
        Ok(())
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
