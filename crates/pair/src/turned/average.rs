//! The mean tensor of two boxes turned against each other.
//!
//! Gauss-Legendre rules average the exact field of the source over parts of the receiver, which are
//! divided until the average does not change. Far away the tensor of a dipole is averaged over both
//! boxes.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};
use magsplice_field::Scene;
use magsplice_magnet::{MU_0, Quantity, Tile};

use super::{TurnedBox, scene_of};
use crate::distant::dipole;
use crate::gauss::LEGENDRE_4;
use crate::not_converged::{NotConverged, PairIntegral};
use crate::symmetric_tensor::SymmetricTensor;
use crate::tolerances::{MOST_PARTS, TURNED_DISTANT, TURNED_ERROR};

impl TurnedBox {
    fn eighths(self) -> [TurnedBox; 8] {
        let sides = self.sides.map(|side| 0.5 * side);
        [0, 1, 2, 3, 4, 5, 6, 7].map(|corner: usize| {
            let shift = |axis: usize| if corner >> axis & 1 == 1 { sides[axis] } else { -sides[axis] };
            TurnedBox { centre: self.centre + shift(0) + shift(1) + shift(2), sides }
        })
    }

    fn volume(self) -> f64 {
        8.0 * self.sides.iter().map(|side| side.length()).product::<f64>()
    }

    fn nodes(self) -> impl Iterator<Item = (DVec3, f64)> {
        LEGENDRE_4.into_iter().flat_map(move |(u, weight_u)| {
            LEGENDRE_4.into_iter().flat_map(move |(v, weight_v)| {
                LEGENDRE_4.into_iter().map(move |(w, weight_w)| {
                    let lever = u * self.sides[0] + v * self.sides[1] + w * self.sides[2];
                    (self.centre + lever, weight_u * weight_v * weight_w)
                })
            })
        })
    }
}

/// The tensor of [`crate::mean_tensor`].
pub(crate) fn mean_tensor(receiver: &Tile, source: &Tile) -> Result<SymmetricTensor, NotConverged> {
    let offset = receiver.position() - source.position();
    if offset.length() >= TURNED_DISTANT * 0.5 * (receiver.size().length() + source.size().length()) {
        return Ok(in_distance(receiver, source, offset));
    }
    // Over the smaller box the field of the other is smoother.
    let volumes = [receiver, source].map(|tile| tile.size().element_product());
    if volumes[0] > volumes[1] {
        return Ok(in_field(source, receiver)? * (volumes[1] / volumes[0]));
    }
    in_field(receiver, source)
}

/// The mean of the tensor of a dipole over both boxes.
fn in_distance(receiver: &Tile, source: &Tile, offset: DVec3) -> SymmetricTensor {
    let [receiver, source] = [receiver, source].map(|tile| TurnedBox {
        centre: DVec3::ZERO,
        sides: [0, 1, 2].map(|axis: usize| tile.rotation() * (0.5 * tile.size()[axis] * DVec3::AXES[axis])),
    });
    let mut total = SymmetricTensor::ZERO;
    for (to, weight) in receiver.nodes() {
        for (from, share) in source.nodes() {
            total += dipole(offset + to - from) * (weight * share);
        }
    }
    total * (source.volume() / (4.0 * PI))
}

fn in_field(receiver: &Tile, source: &Tile) -> Result<SymmetricTensor, NotConverged> {
    let whole = TurnedBox::in_frame_of(source, receiver);
    let scenes = DVec3::AXES.map(|polarization_t| scene_of(source, polarization_t));
    let mut parts = vec![(whole, average(&scenes, whole), 1.0)];
    let mut evaluated = 1;
    let (mut settled, mut error) = (SymmetricTensor::ZERO, 0.0);
    let norm = parts[0].1.norm();
    // Depth first. The allowed error of a part grows with the root of its share of the receiver's
    // volume, because errors at singular edges are in few parts.
    while let Some((part, coarse, volume)) = parts.pop() {
        let eighths = part.eighths().map(|eighth| (eighth, average(&scenes, eighth), 0.125 * volume));
        evaluated += 8;
        let fine = eighths.iter().fold(SymmetricTensor::ZERO, |sum, (_, mean, _)| sum + *mean * 0.125);
        let change = (fine + coarse * -1.0).norm() * volume;
        if change <= TURNED_ERROR * norm * volume.sqrt() {
            settled += fine * volume;
            error += change;
        } else if evaluated > MOST_PARTS || !change.is_finite() {
            let reached = (error + change) / norm;
            return Err(NotConverged { integral: PairIntegral::MeanField, reached, tolerance: TURNED_ERROR });
        } else {
            parts.extend(eighths);
        }
    }
    Ok(settled.rotated(DMat3::from_quat(source.rotation())))
}

/// The average over one part.
fn average(scenes: &[Scene; 3], part: TurnedBox) -> SymmetricTensor {
    let points: Vec<DVec3> = part.nodes().map(|(point, _)| point).collect();
    let columns = scenes.each_ref().map(|scene| match scene.field_at(Quantity::FieldStrength, &points) {
        Ok(field) => part.nodes().zip(field).map(|((_, weight), h)| -MU_0 * weight * h).sum(),
        Err(_) => DVec3::NAN,
    });
    SymmetricTensor::from_matrix(DMat3::from_cols_array_2d(&columns.map(|column: DVec3| column.to_array())))
}

#[cfg(test)]
mod tests {
    use glam::{DQuat, EulerRot};

    use super::*;

    /// The average of dipoles equals the average of the exact field at the smallest distance of its
    /// use.
    #[test]
    fn distant_average_is_that_of_the_exact_field() {
        let rotation = DQuat::from_euler(EulerRot::XYZ, 0.3, -0.7, 1.1);
        let receiver = Tile::new(DVec3::ZERO, DVec3::new(0.5, 1.0, 2.0), DVec3::Z).unwrap();
        let source = DVec3::new(1.0, 0.25, 3.0);
        let distance = TURNED_DISTANT * 0.5 * (receiver.size().length() + source.length());
        for direction in [DVec3::Z, rotation * DVec3::Z, DVec3::new(0.6, -0.48, 0.64)] {
            let source = Tile::new(-distance * direction, source, DVec3::Z).unwrap().rotated(rotation).unwrap();
            let value = in_distance(&receiver, &source, distance * direction);
            let exact = in_field(&receiver, &source).unwrap();
            let error = (value + exact * -1.0).norm() / exact.norm();
            assert!(error <= TURNED_ERROR, "{direction}: {error:e}");
        }
    }

    /// The closed form against averages of the exact field, which share no code with it.
    #[test]
    fn tensors_are_averages_of_the_exact_field() {
        let frame = DQuat::from_euler(EulerRot::XYZ, 0.3, -0.7, 1.1);
        let quarter = DQuat::from_rotation_y(0.5 * PI);
        let first = Tile::new(DVec3::ZERO, DVec3::new(1.0, 1.5, 0.75), DVec3::Z).unwrap();
        for position in [[1.6, 1.0, 0.25], [-4.0, 3.0, 1.0], [-20.0, 30.0, 5.0]] {
            let second = Tile::new(position.into(), DVec3::new(1.5, 2.0, 1.0), DVec3::Z).unwrap();
            let turned = [first, second].map(|tile| tile.rotated(frame).unwrap());
            for [first, second] in [[first, second], turned, [first, second.rotated(quarter).unwrap()]] {
                let average = mean_tensor(&first, &second).unwrap();
                let value = crate::mean_tensor(&first, &second).unwrap();
                let error = (value + average * -1.0).norm() / average.norm();
                assert!(error <= 10.0 * TURNED_ERROR, "{first:?} {second:?}: {error:e}");
            }
        }
    }
}
