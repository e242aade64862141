//! Mean squares of the displacement errors along one axis, divided into causes and tiles.

use std::collections::BTreeMap;

use super::model::{FirstOrder, Sensitivity};
use super::sources::{Cause, ErrorSource};
use crate::low_rank::{add, dot};

/// The expected mean square of the displacement errors along one axis over the working volume, in
/// mm^2 (docs/physics.md, Eqs. P56 to P58).
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct AxisErrors {
    /// Mean square of the film without errors.
    pub nominal_mm2: f64,
    /// Expected mean square: the nominal one and all contributions of the causes.
    pub expected_mm2: f64,
    /// Its part by errors that vary: the variance of the displacement error, averaged over the
    /// points.
    pub variance_mm2: f64,
    /// The contribution of each cause that has errors.
    pub shares: Vec<Share>,
    /// The contribution of each tile, without errors of groups.
    pub tiles: Vec<Contribution>,
}

/// The contribution of one cause.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Share {
    /// The cause.
    pub cause: Cause,
    /// Its contribution.
    #[serde(flatten)]
    pub contribution: Contribution,
}

/// A contribution to the expected mean square of the displacement errors.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Contribution {
    /// The part by errors that are equal in all films: twice the product with the nominal errors,
    /// and the product with all fixed errors. It is negative where they compensate others.
    pub fixed_mm2: f64,
    /// The part by errors that vary.
    pub variance_mm2: f64,
    /// Decrease of the expected mean square if these errors are halved.
    pub saved_by_halving_mm2: f64,
}

impl Contribution {
    /// Both parts.
    pub fn total_mm2(&self) -> f64 {
        self.fixed_mm2 + self.variance_mm2
    }
}

/// Sums over the errors of one cause or tile.
#[derive(Clone, Default)]
struct Sums {
    variance: f64,
    shift: Vec<f64>,
}

impl Sums {
    fn shift_by(&mut self, mean: f64, column: &[f64]) {
        if mean != 0.0 {
            self.shift.resize(column.len(), 0.0);
            add(&mut self.shift, mean, column);
        }
    }

    /// Products are sums over the points. `mean` is the expectation of the displacement errors,
    /// `nominal` their value without any error.
    fn contribution(&self, nominal: &[f64], mean: &[f64]) -> Contribution {
        let count = mean.len() as f64;
        let (with_mean, with_nominal) = (dot(&self.shift, mean), dot(&self.shift, nominal));
        Contribution {
            // The squares of sums: each product of two causes is divided evenly between them.
            fixed_mm2: (with_nominal + with_mean) / count,
            variance_mm2: self.variance / count,
            saved_by_halving_mm2: (0.75 * self.variance + with_mean - 0.25 * dot(&self.shift, &self.shift)) / count,
        }
    }
}

impl FirstOrder {
    /// The mean squares of the displacement errors along an axis.
    ///
    /// # Panics
    /// If the axis is not 0, 1 or 2.
    pub fn axis_errors(&self, axis: usize) -> AxisErrors {
        let (nominal, mean) = (self.along(&self.nominal_mm, axis), self.along(&self.mean_mm, axis));
        let mut causes: BTreeMap<Cause, Sums> = BTreeMap::new();
        let mut tiles = vec![Sums::default(); self.film.tiles().len()];
        for Sensitivity { term, column } in &self.sensitivities {
            let (term, column) = (&self.terms[*term], self.along(column, axis));
            let variance = term.deviation * term.deviation * dot(column, column);
            let tile = match term.source {
                ErrorSource::Tile { tile, .. } => Some(&mut tiles[tile]),
                _ => None,
            };
            let cause = causes.entry(term.source.cause()).or_default();
            for sums in [Some(cause), tile].into_iter().flatten() {
                sums.variance += variance;
                sums.shift_by(term.mean, column);
            }
        }
        if let Some((cause, changes_mm)) = &self.by_surroundings_mm {
            causes.entry(*cause).or_default().shift_by(1.0, self.along(changes_mm, axis));
        }
        if self.has_noise() {
            let sums = causes.entry(Cause::SensorNoise).or_default();
            sums.variance += self.along(&self.noise_mm2, axis).iter().sum::<f64>();
            sums.shift_by(1.0, self.along(&self.noise_shift_mm, axis));
        }
        let shares: Vec<Share> = causes
            .iter()
            .map(|(cause, sums)| Share { cause: *cause, contribution: sums.contribution(nominal, mean) })
            .collect();
        let count = self.points as f64;
        let variance_mm2: f64 = shares.iter().map(|share| share.contribution.variance_mm2).sum();
        AxisErrors {
            nominal_mm2: dot(nominal, nominal) / count,
            expected_mm2: dot(mean, mean) / count + variance_mm2,
            variance_mm2,
            shares,
            tiles: tiles.iter().map(|sums| sums.contribution(nominal, mean)).collect(),
        }
    }
}
