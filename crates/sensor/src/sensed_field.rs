//! The readings of a Hall sensor, or of a head of several: the field averaged over its plates,
//! along its axes.

use std::iter::Sum;
use std::ops::{Add, Mul};

use glam::{DMat3, DQuat, DVec3};
use magsplice_field::Scene;
use magsplice_head::{HeadElement, SensorHead};
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

/// The readings of a Hall sensor, or of a head of several, at any position in a field.
///
/// The reading of a head is the weighted sum of the flux densities that its sensors read, along the
/// axes of the film, with the gain, the offset and the rotation of each sensor corrected. So a head
/// reads like one sensor of gain 1, without offset and rotation and with the noise of the sum.
///
/// A Gauss-Legendre rule of n x n nodes gives the mean of B over the active area. n is the smallest
/// number whose rule differs from the rule of n + 1 by less than 1e-8 of the largest flux density
/// in the volume.
#[derive(Clone, Debug)]
pub struct SensedField<'a> {
    scene: &'a Scene,
    /// The sensor that reads as the whole head does.
    sensor: HallSensor,
    parts: Parts,
    averaging_error_t: f64,
}

/// The sensors that are read.
#[derive(Clone, Debug)]
enum Parts {
    /// The reading of one sensor.
    One(Box<Part>),
    /// The weighted sum of the flux densities that sensors read.
    Sum(Vec<(Part, DVec3)>),
}

/// A sensor, and the nodes of its plates of x, y, z. One list if all plates are at one point.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    pub(crate) sensor: HallSensor,
    pub(crate) nodes: Vec<Vec<Node>>,
}

/// A quadrature node, relative to the position of the sensor or head and in the frame of the tiles,
/// with its weight in the mean.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    pub(crate) offset: DVec3,
    pub(crate) weight: f64,
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
        let sensor = HallSensor::default();
        let parts = Parts::One(Box::new(Part::new(sensor, DVec3::ZERO, 1)));
        SensedField { scene, sensor, parts, averaging_error_t: 0.0 }
    }
}

impl<'a> SensedField<'a> {
    /// The readings of a sensor that moves in the volume of a grid. The scene must be exact.
    ///
    /// # Errors
    /// See [`SensedFieldError`].
    pub fn new(scene: &'a Scene, sensor: HallSensor, volume: &Grid) -> Result<SensedField<'a>, SensedFieldError> {
        let sensor = sensor.checked().map_err(SensedFieldError::Sensor)?;
        let with = |count: usize| SensedField {
            sensor,
            parts: Parts::One(Box::new(Part::new(sensor, DVec3::ZERO, count))),
            ..SensedField::from(scene)
        };
        SensedField::averaging(with, sensor.active_area == [0.0; 2], volume)
    }

    /// The readings of a head whose origin moves in the volume of a grid. The scene must be exact.
    ///
    /// # Errors
    /// See [`SensedFieldError`].
    ///
    /// # Panics
    /// If the head has no sensor.
    pub fn of_head(scene: &'a Scene, head: &SensorHead, volume: &Grid) -> Result<SensedField<'a>, SensedFieldError> {
        assert!(!head.elements.is_empty(), "a head has at least one sensor");
        for element in &head.elements {
            element.sensor.checked().map_err(SensedFieldError::Sensor)?;
        }
        let sensor = head.as_one();
        let part = |of: &HeadElement, count: usize| (Part::new(of.sensor, of.place, count), of.weight);
        let with = |count: usize| SensedField {
            sensor,
            parts: Parts::Sum(head.elements.iter().map(|of| part(of, count)).collect()),
            ..SensedField::from(scene)
        };
        let are_points = head.elements.iter().all(|of| of.sensor.active_area == [0.0; 2]);
        SensedField::averaging(with, are_points, volume)
    }

    /// The field of the first rule, by its number of nodes along each side, that is exact enough.
    fn averaging(
        with: impl Fn(usize) -> SensedField<'a>,
        are_points: bool,
        volume: &Grid,
    ) -> Result<SensedField<'a>, SensedFieldError> {
        if are_points {
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

    /// The sensor, or the one that reads as the head does. Its range is not that of the sensors of
    /// the head.
    pub fn sensor(&self) -> &HallSensor {
        &self.sensor
    }

    /// The tiles and their field.
    pub fn scene(&self) -> &'a Scene {
        self.scene
    }

    /// The sensors of a head with their weights.
    ///
    /// # Panics
    /// If this is the field of one sensor.
    pub(crate) fn sensors(&self) -> Vec<(Part, DVec3)> {
        match &self.parts {
            Parts::One(_) => panic!("the field of a head"),
            Parts::Sum(parts) => parts.clone(),
        }
    }

    /// Number of quadrature nodes along each side of the active area.
    pub fn nodes_per_side(&self) -> usize {
        let part = match &self.parts {
            Parts::One(part) => Some(&**part),
            Parts::Sum(parts) => parts.first().map(|(part, _)| part),
        };
        part.map_or(0, |part| part.nodes[0].len().isqrt())
    }

    /// Estimate of the error of the mean over the active area, in tesla: its largest difference
    /// from the next finer rule, at points of the volume.
    pub fn averaging_error_t(&self) -> f64 {
        self.averaging_error_t
    }

    /// Sets the gain to 1 and the offset to 0.
    pub fn without_gain_and_offset(&self) -> SensedField<'a> {
        let unscaled = |sensor: HallSensor| HallSensor { gain: DVec3::ONE, offset_t: DVec3::ZERO, ..sensor };
        let mut field = SensedField { sensor: unscaled(self.sensor), ..self.clone() };
        if let Parts::One(part) = &mut field.parts {
            part.sensor = unscaled(part.sensor);
        }
        field
    }

    /// The readings at positions of the sensor or head, in tesla, without noise, rounding and
    /// limits.
    ///
    /// # Errors
    /// If a plate reads a point without a field from a position.
    pub fn readings_t(&self, positions: &[DVec3]) -> Result<Vec<DVec3>, PointErrors> {
        let at = |points: &[DVec3]| self.scene.field_at(Quantity::FluxDensity, points);
        self.of_parts(positions, at, Part::reading_t, Part::field_t, |weight, field_t| weight * field_t)
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
        let readings =
            self.of_parts(positions, field_t, Part::reading_t, Part::field_t, |weight, field_t| weight * field_t);
        let slopes = self.of_parts(positions, gradient, Part::slope, Part::gradient, weighted);
        (readings.expect("NaN instead of errors"), slopes.expect("NaN instead of errors"))
    }

    /// The gradients of the readings.
    ///
    /// # Errors
    /// If a plate reads a point without a gradient from a position.
    pub fn gradients(&self, positions: &[DVec3]) -> Result<Vec<DMat3>, PointErrors> {
        let at = |points: &[DVec3]| self.scene.gradient_at(Quantity::FluxDensity, points);
        self.of_parts(positions, at, Part::slope, Part::gradient, weighted)
    }

    /// The readings of each sensor of the head, in their order, at positions of the head.
    ///
    /// # Errors
    /// As [`SensedField::readings_t`].
    pub fn readings_of_sensors_t(&self, positions: &[DVec3]) -> Result<Vec<Vec<DVec3>>, PointErrors> {
        let readings = |part: &Part| -> Result<Vec<DVec3>, PointErrors> {
            let means = part.means(positions, |points| self.scene.field_at(Quantity::FluxDensity, points))?;
            Ok(means.into_iter().map(|means| part.reading_t(means)).collect())
        };
        match &self.parts {
            Parts::One(part) => Ok(vec![readings(part)?]),
            Parts::Sum(parts) => parts.iter().map(|(part, _)| readings(part)).collect(),
        }
    }

    /// The flux density of this reading, in the frame of the tiles, after correction of the
    /// sensor's errors.
    pub fn field_of_reading_t(&self, reading_t: DVec3) -> DVec3 {
        self.sensor.rotation * ((reading_t - self.sensor.offset_t) / self.sensor.gain)
    }

    /// Means over the plates, NaN without a field.
    fn means(&self, positions: &[DVec3]) -> Vec<DVec3> {
        self.readings_and_gradients(positions).0
    }

    /// The reading of one sensor, or the sum of a head, of a quantity at each position.
    fn of_parts<T>(
        &self,
        positions: &[DVec3],
        at: impl Fn(&[DVec3]) -> Result<Vec<T>, PointErrors>,
        of_reading: impl Fn(&Part, [T; 3]) -> T,
        of_field: impl Fn(&Part, [T; 3]) -> T,
        weighted: impl Fn(DVec3, T) -> T,
    ) -> Result<Vec<T>, PointErrors>
    where
        T: Copy + Add<Output = T> + Mul<f64, Output = T> + Sum,
    {
        match &self.parts {
            Parts::One(part) => {
                let means = part.means(positions, at)?;
                Ok(means.into_iter().map(|means| of_reading(part, means)).collect())
            }
            Parts::Sum(parts) => {
                let mut sums: Option<Vec<T>> = None;
                for (part, weight) in parts {
                    let means = part.means(positions, &at)?.into_iter();
                    let terms = means.map(|means| weighted(*weight, of_field(part, means)));
                    sums = Some(match sums {
                        None => terms.collect(),
                        Some(sums) => sums.into_iter().zip(terms).map(|(sum, term)| sum + term).collect(),
                    });
                }
                Ok(sums.unwrap_or_default())
            }
        }
    }
}

/// A gradient whose rows have weights.
fn weighted(weight: DVec3, gradient: DMat3) -> DMat3 {
    DMat3::from_cols(weight * gradient.x_axis, weight * gradient.y_axis, weight * gradient.z_axis)
}

impl Part {
    /// A sensor at a place of a head, with a rule of `count` x `count` nodes for each plate.
    fn new(sensor: HallSensor, place: DVec3, count: usize) -> Part {
        let mut nodes = nodes(&sensor, count);
        nodes.iter_mut().flatten().for_each(|node| node.offset += place);
        Part { sensor, nodes }
    }

    fn reading_t(&self, means: [DVec3; 3]) -> DVec3 {
        self.sensor.gain * self.along(means) + self.sensor.offset_t
    }

    /// The mean flux densities along the axes of the sensor.
    fn along(&self, means: [DVec3; 3]) -> DVec3 {
        if self.sensor.rotation == DQuat::IDENTITY {
            // This avoids the round-off of a product with 1.
            return DVec3::new(means[0].x, means[1].y, means[2].z);
        }
        let axes = DMat3::from_quat(self.sensor.rotation);
        DVec3::from([0, 1, 2].map(|axis| axes.col(axis).dot(means[axis])))
    }

    /// The flux density that the sensor reads, along the axes of the film.
    fn field_t(&self, means: [DVec3; 3]) -> DVec3 {
        self.sensor.rotation * self.along(means)
    }

    /// The gradient of the reading.
    fn slope(&self, slopes: [DMat3; 3]) -> DMat3 {
        weighted(self.sensor.gain, self.slope_along(slopes))
    }

    fn slope_along(&self, slopes: [DMat3; 3]) -> DMat3 {
        let axes = DMat3::from_quat(self.sensor.rotation);
        let row = |axis: usize| slopes[axis].transpose() * axes.col(axis);
        DMat3::from_cols(row(0), row(1), row(2)).transpose()
    }

    /// The gradient of the flux density that the sensor reads.
    fn gradient(&self, slopes: [DMat3; 3]) -> DMat3 {
        DMat3::from_quat(self.sensor.rotation) * self.slope_along(slopes)
    }

    /// The means over the plates of x, y and z of a quantity at each position.
    fn means<T>(
        &self,
        positions: &[DVec3],
        at: impl Fn(&[DVec3]) -> Result<Vec<T>, PointErrors>,
    ) -> Result<Vec<[T; 3]>, PointErrors>
    where
        T: Copy + Mul<f64, Output = T> + Sum,
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
