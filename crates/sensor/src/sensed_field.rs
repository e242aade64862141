//! The readings of a Hall sensor: the field averaged over its plates, along its axes.

use glam::{DMat3, DQuat, DVec3};
use magsplice_field::Scene;
use magsplice_magnet::{Grid, HallSensor, HallSensorFault, PointError, PointErrors, Quantity};
use nalgebra::{DMatrix, SymmetricEigen};
use thiserror::Error;

/// Difference of two quadrature rules, as a fraction of the largest flux density in the volume,
/// below which the first is used. It moves positions by 1e-8 of the wavelength over 2 pi, or by ten
/// times as much where the field is weak.
const AVERAGED: f64 = 1e-8;

/// Largest number of quadrature nodes along a side of the active area. A film of wavelength L needs
/// four for a side of L / 10 and eight for L / 2.
const MOST_NODES: usize = 8;

/// Number of points along each side of the volume for the comparison of quadrature rules.
const COMPARED: usize = 5;

/// The readings of a Hall sensor at any position in a field.
///
/// A Gauss-Legendre rule of n x n nodes gives the mean of B over the active area. n is the smallest
/// number whose rule differs from the rule of n + 1 by less than 1e-8 of the largest flux density
/// in the volume.
#[derive(Clone, Debug)]
pub struct SensedField<'a> {
    scene: &'a Scene,
    sensor: HallSensor,
    /// Nodes for the plates of x, y, z. One list if all plates are at one point.
    nodes: Vec<Vec<Node>>,
    averaging_error_t: f64,
}

/// A quadrature node, relative to the position of the sensor and in the frame of the tiles, with
/// its weight in the mean.
#[derive(Clone, Copy, Debug)]
struct Node {
    offset: DVec3,
    weight: f64,
}

/// The reason why a sensor cannot read a field.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SensedFieldError {
    /// The sensor is invalid.
    #[error("{0}")]
    Sensor(HallSensorFault),
    /// The field changes too much over the active area: rules of 8 x 8 and 9 x 9 nodes differ too
    /// much.
    #[error(
        "the field changes too much over the active area of the sensor: rules of {MOST_NODES} x {MOST_NODES} and more \
         nodes differ by {difference_t:.2e} T; use a smaller area, or keep away from the tiles"
    )]
    ActiveArea {
        /// Difference in tesla.
        difference_t: f64,
    },
}

impl<'a> From<&'a Scene> for SensedField<'a> {
    /// The readings of a perfect sensor: B.
    fn from(scene: &'a Scene) -> SensedField<'a> {
        let nodes = vec![vec![Node { offset: DVec3::ZERO, weight: 1.0 }]];
        SensedField { scene, sensor: HallSensor::default(), nodes, averaging_error_t: 0.0 }
    }
}

impl<'a> SensedField<'a> {
    /// The readings of a sensor that moves in the volume of a grid. The scene must be exact.
    ///
    /// # Errors
    /// See [`SensedFieldError`].
    pub fn new(scene: &'a Scene, sensor: HallSensor, volume: &Grid) -> Result<SensedField<'a>, SensedFieldError> {
        let sensor = sensor.checked().map_err(SensedFieldError::Sensor)?;
        let with = |count: usize| SensedField { nodes: nodes(&sensor, count), sensor, ..SensedField::from(scene) };
        if sensor.active_area == [0.0; 2] {
            return Ok(with(1));
        }
        let counts = [COMPARED; 3].map(|count| count.min(volume.len()));
        let points: Vec<DVec3> = match Grid::new(volume.lower(), volume.upper(), counts) {
            Ok(grid) => grid.points().collect(),
            // A volume without extent along an axis has one point along it.
            Err(_) => volume.points().collect(),
        };
        let mut coarse = with(1);
        let mut before = coarse.means(&points);
        let mut difference_t = f64::INFINITY;
        for count in 2..=MOST_NODES + 1 {
            let fine = with(count);
            let after = fine.means(&points);
            let finite = before.iter().zip(&after).filter(|(a, b)| a.is_finite() && b.is_finite());
            let (largest_t, most) = finite.fold((0.0, 0.0), |(largest, most): (f64, f64), (a, b)| {
                (largest.max(b.length()), most.max((*a - *b).abs().max_element()))
            });
            difference_t = most;
            if difference_t <= AVERAGED * largest_t {
                return Ok(SensedField { averaging_error_t: difference_t, ..coarse });
            }
            (coarse, before) = (fine, after);
        }
        Err(SensedFieldError::ActiveArea { difference_t })
    }

    /// The sensor.
    pub fn sensor(&self) -> &HallSensor {
        &self.sensor
    }

    /// Number of quadrature nodes along each side of the active area.
    pub fn nodes_per_side(&self) -> usize {
        self.nodes[0].len().isqrt()
    }

    /// Estimate of the error of the mean over the active area, in tesla: its largest difference
    /// from the next finer rule, at points of the volume.
    pub fn averaging_error_t(&self) -> f64 {
        self.averaging_error_t
    }

    /// Sets the gain to 1 and the offset to 0.
    pub fn without_gain_and_offset(&self) -> SensedField<'a> {
        let sensor = HallSensor { gain: DVec3::ONE, offset_t: DVec3::ZERO, ..self.sensor };
        SensedField { sensor, ..self.clone() }
    }

    /// The readings at positions of the sensor, in tesla, without noise, rounding and limits.
    ///
    /// # Errors
    /// If a plate reads a point without a field from a position.
    pub fn readings_t(&self, positions: &[DVec3]) -> Result<Vec<DVec3>, PointErrors> {
        let means = self.means_of(positions, |points| self.scene.field_at(Quantity::FluxDensity, points))?;
        Ok(means.into_iter().map(|means: [DVec3; 3]| self.reading_t(means)).collect())
    }

    /// The readings, and their gradients: column j is the derivative along x_j, in tesla per unit
    /// of length. NaN where the field does not exist.
    pub fn readings_and_gradients(&self, positions: &[DVec3]) -> (Vec<DVec3>, Vec<DMat3>) {
        let field_t = |points: &[DVec3]| -> Result<Vec<DVec3>, PointErrors> {
            let mut field_t = vec![DVec3::ZERO; points.len()];
            let _ = self.scene.field_into(Quantity::FluxDensity, points, &mut field_t);
            Ok(field_t)
        };
        let gradient = |points: &[DVec3]| -> Result<Vec<DMat3>, PointErrors> {
            let mut gradient = vec![DMat3::ZERO; points.len()];
            let _ = self.scene.gradient_into(Quantity::FluxDensity, points, &mut gradient);
            Ok(gradient)
        };
        let means: Vec<[DVec3; 3]> = self.means_of(positions, field_t).expect("NaN instead of errors");
        let slopes: Vec<[DMat3; 3]> = self.means_of(positions, gradient).expect("NaN instead of errors");
        let readings = means.into_iter().map(|means| self.reading_t(means)).collect();
        (readings, slopes.into_iter().map(|slopes| self.gradient(slopes)).collect())
    }

    /// The gradients of the readings.
    ///
    /// # Errors
    /// If a plate reads a point without a gradient from a position.
    pub fn gradients(&self, positions: &[DVec3]) -> Result<Vec<DMat3>, PointErrors> {
        let slopes = self.means_of(positions, |points| self.scene.gradient_at(Quantity::FluxDensity, points))?;
        Ok(slopes.into_iter().map(|slopes: [DMat3; 3]| self.gradient(slopes)).collect())
    }

    /// The flux density of this reading, in the frame of the tiles, after correction of the
    /// sensor's errors.
    pub fn field_of_reading_t(&self, reading_t: DVec3) -> DVec3 {
        self.sensor.rotation * ((reading_t - self.sensor.offset_t) / self.sensor.gain)
    }

    fn reading_t(&self, means: [DVec3; 3]) -> DVec3 {
        if self.sensor.rotation == DQuat::IDENTITY {
            // This avoids the round-off of a product with 1.
            return self.sensor.gain * DVec3::new(means[0].x, means[1].y, means[2].z) + self.sensor.offset_t;
        }
        let axes = DMat3::from_quat(self.sensor.rotation);
        let along = DVec3::from([0, 1, 2].map(|axis| axes.col(axis).dot(means[axis])));
        self.sensor.gain * along + self.sensor.offset_t
    }

    fn gradient(&self, slopes: [DMat3; 3]) -> DMat3 {
        let axes = DMat3::from_quat(self.sensor.rotation);
        let row = |axis: usize| self.sensor.gain[axis] * (slopes[axis].transpose() * axes.col(axis));
        DMat3::from_cols(row(0), row(1), row(2)).transpose()
    }

    /// Means over the plates, NaN without a field.
    fn means(&self, positions: &[DVec3]) -> Vec<DVec3> {
        self.readings_and_gradients(positions).0
    }

    /// The means over the plates of x, y and z of a quantity at each position.
    fn means_of<T>(
        &self,
        positions: &[DVec3],
        at: impl Fn(&[DVec3]) -> Result<Vec<T>, PointErrors>,
    ) -> Result<Vec<[T; 3]>, PointErrors>
    where
        T: Copy + std::ops::Mul<f64, Output = T> + std::iter::Sum,
    {
        let mut of_plates: Vec<Vec<T>> = Vec::new();
        for nodes in &self.nodes {
            let points: Vec<DVec3> =
                positions.iter().flat_map(|position| nodes.iter().map(|node| *position + node.offset)).collect();
            let values = at(&points).map_err(|errors| of_positions(errors, nodes.len()))?;
            let mean = |values: &[T]| match (values, nodes.as_slice()) {
                // A sum from 0 would lose the sign of -0.
                ([value], [_]) => *value,
                _ => values.iter().zip(nodes).map(|(value, node)| *value * node.weight).sum(),
            };
            of_plates.push(values.chunks(nodes.len()).map(mean).collect());
        }
        let plate = |axis: usize| &of_plates[axis.min(of_plates.len() - 1)];
        Ok((0..positions.len()).map(|index| [0, 1, 2].map(|axis| plate(axis)[index])).collect())
    }
}

/// The errors of nodes as errors of positions, each once.
fn of_positions(errors: PointErrors, nodes: usize) -> PointErrors {
    let mut of_positions: Vec<PointError> =
        errors.0.into_iter().map(|error| PointError { index: error.index / nodes, ..error }).collect();
    of_positions.dedup_by_key(|error| error.index);
    PointErrors(of_positions)
}

/// The nodes of the plates for a rule of `count` x `count` points.
fn nodes(sensor: &HallSensor, count: usize) -> Vec<Vec<Node>> {
    let rule = gauss_legendre(count);
    let [width, height] = sensor.active_area;
    let of_plate = |plate: DVec3| -> Vec<Node> {
        let rows = rule.iter().flat_map(|(u, weight_u)| {
            rule.iter().map(move |(v, weight_v)| Node {
                offset: sensor.rotation * (plate + DVec3::new(0.5 * width * u, 0.5 * height * v, 0.0)),
                weight: 0.25 * weight_u * weight_v,
            })
        });
        rows.collect()
    };
    let [x, y, z] = sensor.plates;
    if x == y && x == z { vec![of_plate(x)] } else { sensor.plates.map(of_plate).into() }
}

/// Nodes and weights of the Gauss-Legendre rule on [-1, 1], by the eigenvalues of its Jacobi matrix
/// (Golub and Welsch 1969).
fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    let beta = |n: usize| n as f64 / ((4 * n * n - 1) as f64).sqrt();
    let jacobi = DMatrix::from_fn(count, count, |i, j| if i.abs_diff(j) == 1 { beta(i.max(j)) } else { 0.0 });
    let SymmetricEigen { eigenvalues, eigenvectors } = SymmetricEigen::new(jacobi);
    (0..count).map(|n| (eigenvalues[n], 2.0 * eigenvectors[(0, n)].powi(2))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rule of n nodes integrates powers up to 2 n - 1 exactly.
    #[test]
    fn rules_integrate_polynomials() {
        for count in 1..=9 {
            let rule = gauss_legendre(count);
            for power in 0..2 * count as i32 {
                let sum: f64 = rule.iter().map(|(x, weight)| weight * x.powi(power)).sum();
                let exact = if power % 2 == 0 { 2.0 / f64::from(power + 1) } else { 0.0 };
                assert!((sum - exact).abs() < 1e-14, "{count} nodes, power {power}: {sum}");
            }
        }
    }
}
