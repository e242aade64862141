//! Mean squares of the displacement errors along one axis, divided into causes and tiles.

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
    /// Standard deviation of the mean square from film to film, as if all errors were normal.
    pub deviation_mm2: f64,
    /// The contribution of each cause that has errors.
    pub shares: Vec<Share>,
    /// The contribution of the errors of each tile, without those of groups.
    pub tiles: Vec<Contribution>,
}

/// What one cause contributes.
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
    /// The part by errors that are the same in each film: twice the product with the nominal
    /// errors, and the product with all fixed errors. It is negative where they compensate others.
    pub fixed_mm2: f64,
    /// The part by errors that vary.
    pub variance_mm2: f64,
    /// What the expected mean square falls by if these errors are halved.
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
    has_errors: bool,
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

    /// Products are sums over the points. `mean` is the expectation of the errors, `nominal` that
    /// without any error.
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
        let noise = self.along(&self.noise_mm2, axis);
        let mut causes: Vec<(Cause, Sums)> = Vec::new();
        let mut tiles = vec![Sums::default(); self.film.tiles().len()];
        let of_cause = |causes: &mut Vec<(Cause, Sums)>, cause| {
            causes.iter().position(|(known, _)| *known == cause).unwrap_or_else(|| {
                causes.push((cause, Sums::default()));
                causes.len() - 1
            })
        };
        for Sensitivity { term, column } in &self.sensitivities {
            let (term, column) = (&self.terms[*term], self.along(column, axis));
            let variance = term.deviation * term.deviation * dot(column, column);
            let index = of_cause(&mut causes, term.source.cause());
            let tile = match term.source {
                ErrorSource::Tile { tile, .. } => Some(&mut tiles[tile]),
                _ => None,
            };
            for sums in [Some(&mut causes[index].1), tile].into_iter().flatten() {
                sums.has_errors = true;
                sums.variance += variance;
                sums.shift_by(term.mean, column);
            }
        }
        if let Some(changes_mm) = &self.by_neighbour_mm {
            let index = of_cause(&mut causes, Cause::Neighbour);
            causes[index].1.shift_by(1.0, self.along(changes_mm, axis));
        }
        if self.has_noise() {
            let index = of_cause(&mut causes, Cause::SensorNoise);
            causes[index].1.variance += noise.iter().sum::<f64>();
            causes[index].1.shift_by(1.0, self.along(&self.noise_shift_mm, axis));
        }
        causes.sort_by_key(|(cause, _)| *cause);
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
            deviation_mm2: self.deviation_mm2(axis),
            shares,
            tiles: tiles.iter().map(|sums| sums.contribution(nominal, mean)).collect(),
        }
    }

    /// Standard deviation of the mean square: for normal errors of covariance C and mean m over N
    /// points its square is (2 tr C^2 + 4 m C m) / N^2. C is that of the low-rank sensitivities and
    /// of the noise of each reading, which is diagonal.
    fn deviation_mm2(&self, axis: usize) -> f64 {
        let (mean, noise) = (self.along(&self.mean_mm, axis), self.along(&self.noise_mm2, axis));
        let rank = self.varying.rank();
        let basis: Vec<&[f64]> = self.varying.basis.iter().map(|column| self.along(column, axis)).collect();
        // C = basis * inner * basis^T.
        let mut inner = vec![vec![0.0; rank]; rank];
        for coordinates in &self.varying.coordinates {
            for (row, factor) in inner.iter_mut().zip(coordinates) {
                add(row, *factor, coordinates);
            }
        }
        let gram: Vec<Vec<f64>> = basis.iter().map(|a| basis.iter().map(|b| dot(a, b)).collect::<Vec<f64>>()).collect();
        // Both are symmetric, so that columns are rows.
        let product = |a: &[Vec<f64>], b: &[Vec<f64>]| -> Vec<Vec<f64>> {
            a.iter().map(|row| b.iter().map(|column| dot(row, column)).collect()).collect()
        };
        let (straight, transposed) = (product(&inner, &gram), product(&gram, &inner));
        let mut trace: f64 = straight.iter().zip(&transposed).map(|(a, b)| dot(a, b)).sum();
        let along_mean: Vec<f64> = basis.iter().map(|column| dot(column, mean)).collect();
        let mut with_mean: f64 = inner.iter().zip(&along_mean).map(|(row, along)| along * dot(row, &along_mean)).sum();
        if self.has_noise() {
            for (point, (noise, mean)) in noise.iter().zip(mean).enumerate() {
                let at_point: Vec<f64> = basis.iter().map(|column| column[point]).collect();
                let own: f64 = inner.iter().zip(&at_point).map(|(row, value)| value * dot(row, &at_point)).sum();
                trace += noise * (2.0 * own + noise);
                with_mean += noise * mean * mean;
            }
        }
        (2.0 * trace + 4.0 * with_mean).max(0.0).sqrt() / self.points as f64
    }
}
