//! The mean demagnetizing tensor of two boxes that are turned against each other.
//!
//! The exact field of the source is averaged over the receiver by Gauss-Legendre rules on parts
//! that are divided until the average does not change. Far away the tensor of a dipole is averaged
//! over both.

use std::error::Error;
use std::f64::consts::PI;
use std::fmt;

use glam::{DMat3, DVec3};
use magsplice_field::Scene;
use magsplice_magnet::{MU_0, Quantity, Tile};

use crate::distant::dipole;
use crate::symmetric_tensor::SymmetricTensor;
use crate::tolerances::{MOST_PARTS, TURNED_DISTANT, TURNED_ERROR};

/// Gauss-Legendre rule of four nodes on [-1, 1]: nodes and weights, whose sum is 1.
const RULE: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.173_927_422_568_726_93),
    (-0.339_981_043_584_856_26, 0.326_072_577_431_273_07),
    (0.339_981_043_584_856_26, 0.326_072_577_431_273_07),
    (0.861_136_311_594_052_6, 0.173_927_422_568_726_93),
];

/// The average of the field of a tile over another one that is turned does not converge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurnedNotConverged {
    /// Error that was reached, relative to the norm of the tensor.
    pub reached: f64,
}

impl fmt::Display for TurnedNotConverged {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the mean field of a tile in another one that is turned against it is known to {:.1e} only, not to \
             {TURNED_ERROR:.1e}; tiles must not overlap, leave a gap between them",
            self.reached
        )
    }
}

impl Error for TurnedNotConverged {}

/// A part of the receiver: the middle of it and half its sides, in the frame of the source.
#[derive(Clone, Copy)]
struct Part {
    centre: DVec3,
    sides: [DVec3; 3],
}

impl Part {
    fn eighths(self) -> [Part; 8] {
        let sides = self.sides.map(|side| 0.5 * side);
        [0, 1, 2, 3, 4, 5, 6, 7].map(|corner: usize| {
            let shift = |axis: usize| if corner >> axis & 1 == 1 { sides[axis] } else { -sides[axis] };
            Part { centre: self.centre + shift(0) + shift(1) + shift(2), sides }
        })
    }

    fn volume(self) -> f64 {
        8.0 * self.sides.iter().map(|side| side.length()).product::<f64>()
    }

    fn nodes(self) -> impl Iterator<Item = (DVec3, f64)> {
        RULE.into_iter().flat_map(move |(u, weight_u)| {
            RULE.into_iter().flat_map(move |(v, weight_v)| {
                RULE.into_iter().map(move |(w, weight_w)| {
                    let lever = u * self.sides[0] + v * self.sides[1] + w * self.sides[2];
                    (self.centre + lever, weight_u * weight_v * weight_w)
                })
            })
        })
    }
}

/// The tensor, as [`crate::mean_tensor`].
pub(crate) fn mean_tensor(receiver: &Tile, source: &Tile) -> Result<SymmetricTensor, TurnedNotConverged> {
    let offset = receiver.position() - source.position();
    if offset.length() >= TURNED_DISTANT * 0.5 * (receiver.size().length() + source.size().length()) {
        return Ok(in_distance(receiver, source, offset));
    }
    // The field in the smaller box is smoother over it.
    let volumes = [receiver, source].map(|tile| tile.size().element_product());
    if volumes[0] > volumes[1] {
        return Ok(in_field(source, receiver)? * (volumes[1] / volumes[0]));
    }
    in_field(receiver, source)
}

/// The mean of the tensor of a dipole over both boxes.
fn in_distance(receiver: &Tile, source: &Tile, offset: DVec3) -> SymmetricTensor {
    let [receiver, source] = [receiver, source].map(|tile| Part {
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

fn in_field(receiver: &Tile, source: &Tile) -> Result<SymmetricTensor, TurnedNotConverged> {
    let to_source = source.rotation().inverse();
    let relative = to_source * receiver.rotation();
    let whole = Part {
        centre: to_source * (receiver.position() - source.position()),
        sides: [0, 1, 2].map(|axis: usize| relative * (0.5 * receiver.size()[axis] * DVec3::AXES[axis])),
    };
    let scenes = DVec3::AXES.map(|polarization_t| {
        let tile = Tile::new(DVec3::ZERO, source.size(), polarization_t).expect("the size is that of a tile");
        Scene::new(&[tile])
    });
    let mut parts = vec![(whole, average(&scenes, whole), 1.0)];
    let mut evaluated = 1;
    let (mut settled, mut error) = (SymmetricTensor::ZERO, 0.0);
    let norm = parts[0].1.norm();
    // Depth first; each part may have the share of the error that its volume is of the receiver, by
    // its root, because errors at singular edges are in few parts.
    while let Some((part, coarse, volume)) = parts.pop() {
        let eighths = part.eighths().map(|eighth| (eighth, average(&scenes, eighth), 0.125 * volume));
        evaluated += 8;
        let fine = eighths.iter().fold(SymmetricTensor::ZERO, |sum, (_, mean, _)| sum + *mean * 0.125);
        let change = (fine + coarse * -1.0).norm() * volume;
        if change <= TURNED_ERROR * norm * volume.sqrt() {
            settled += fine * volume;
            error += change;
        } else if evaluated > MOST_PARTS || !change.is_finite() {
            return Err(TurnedNotConverged { reached: (error + change) / norm });
        } else {
            parts.extend(eighths);
        }
    }
    Ok(settled.rotated(DMat3::from_quat(source.rotation())))
}

/// The average over one part.
fn average(scenes: &[Scene; 3], part: Part) -> SymmetricTensor {
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

    /// The average of dipoles is that of the exact field, at the least distance at which it is
    /// used.
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
}
