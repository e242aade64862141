//! The mean over one box of the field of another: the mean demagnetizing tensor.

use glam::{DMat3, DVec3};
use magsplice_magnet::Tile;

use crate::symmetric_tensor::SymmetricTensor;
use crate::tolerances::{CORNER_ROUNDINGS, MOST_HALVINGS, PARALLEL, TENSOR_ERROR};
use crate::turned::{self, TurnedNotConverged};
use crate::{corner_sum, distant};

/// The mean demagnetizing tensor N of two tiles, in the frame of the scene: the mean of mu0 H over
/// `receiver` is -N J for the polarization J of `source`.
///
/// # Accuracy
/// For tiles with parallel edges 1e-9 of the norm of the tensor, plus, for tiles that touch, a few
/// units of round-off of the cube of their largest distance over the volume of the receiver. For
/// tiles that are turned against each other [`crate::tolerances::TURNED_ERROR`] of the norm.
///
/// # Errors
/// If the average over a turned tile does not converge, which happens if two tiles overlap.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use magsplice_magnet::Tile;
/// use magsplice_recoil::mean_tensor;
///
/// let cube = Tile::new(DVec3::ZERO, DVec3::ONE, DVec3::Z).unwrap();
/// let own = mean_tensor(&cube, &cube).unwrap();
/// assert!((own.diagonal - DVec3::splat(1.0 / 3.0)).length() < 1e-14);
/// ```
pub fn mean_tensor(receiver: &Tile, source: &Tile) -> Result<SymmetricTensor, TurnedNotConverged> {
    mean_tensor_within(receiver, source, TENSOR_ERROR)
}

/// [`mean_tensor`] of tiles with parallel edges to an error relative to the norm of the tensor.
pub(crate) fn mean_tensor_within(
    receiver: &Tile,
    source: &Tile,
    error: f64,
) -> Result<SymmetricTensor, TurnedNotConverged> {
    let offset = receiver.position() - source.position();
    let frame = source.rotation();
    let relative = DMat3::from_quat(frame.inverse() * receiver.rotation());
    let Some(axes) = parallel_axes(relative) else {
        return turned::mean_tensor(receiver, source);
    };
    let size = axes * receiver.size();
    if frame == glam::DQuat::IDENTITY {
        return Ok(of_boxes(size, source.size(), offset, error));
    }
    let tensor = of_boxes(size, source.size(), frame.inverse() * offset, error);
    Ok(tensor.rotated(DMat3::from_quat(frame)))
}

/// The matrix of ones and zeros that permutes sizes, if a rotation takes axes to axes.
fn parallel_axes(relative: DMat3) -> Option<DMat3> {
    let permutes = |column: DVec3| {
        let magnitudes = column.abs();
        let largest = magnitudes.max_position();
        let rest = magnitudes - DVec3::AXES[largest];
        (rest.abs().max_element() <= PARALLEL).then_some(DVec3::AXES[largest])
    };
    Some(DMat3::from_cols(permutes(relative.x_axis)?, permutes(relative.y_axis)?, permutes(relative.z_axis)?))
}

/// The tensor of two boxes of these sides with parallel edges; `offset` leads from the source to
/// the receiver.
pub(crate) fn of_boxes(receiver: DVec3, source: DVec3, offset: DVec3, error: f64) -> SymmetricTensor {
    // In units of the largest length, so that no power leaves the range of numbers.
    let unit = receiver.max_element().max(source.max_element()).max(offset.abs().max_element());
    of_scaled_boxes([receiver / unit, source / unit], offset / unit, error, MOST_HALVINGS)
}

fn of_scaled_boxes([receiver, source]: [DVec3; 2], offset: DVec3, error: f64, halvings: usize) -> SymmetricTensor {
    if let Some(tensor) = distant::mean_tensor(receiver, source, offset, error) {
        return tensor;
    }
    let touches = (offset.abs() - 0.5 * (receiver + source)).max_element() <= 0.0;
    if touches || halvings == 0 || corner_error(receiver, source, offset) <= error {
        return corner_sum::mean_tensor(receiver, source, offset);
    }
    // The longest side is halved. The mean over a receiver is that of the means over its halves,
    // and the field of a source is the sum of those of its halves.
    let (axis_of_receiver, axis_of_source) = (receiver.max_position(), source.max_position());
    let halves_receiver = receiver[axis_of_receiver] >= source[axis_of_source];
    let (mut receiver, mut source) = (receiver, source);
    let (half, factor) = if halves_receiver {
        receiver[axis_of_receiver] *= 0.5;
        (0.5 * receiver[axis_of_receiver] * DVec3::AXES[axis_of_receiver], 0.5)
    } else {
        source[axis_of_source] *= 0.5;
        (0.5 * source[axis_of_source] * DVec3::AXES[axis_of_source], 1.0)
    };
    let [lower, upper] =
        [-half, half].map(|shift| of_scaled_boxes([receiver, source], offset + shift, error, halvings - 1));
    (lower + upper) * factor
}

/// Estimate of the error of the sum over corners, relative to the tensor of a dipole.
fn corner_error(receiver: DVec3, source: DVec3, offset: DVec3) -> f64 {
    let farthest = (offset.abs() + 0.5 * (receiver + source)).length();
    let magnitude = source.element_product() / offset.length().powi(3);
    CORNER_ROUNDINGS * f64::EPSILON * farthest.powi(3) * 4.0 * std::f64::consts::PI
        / (receiver.element_product() * magnitude)
}

#[cfg(test)]
mod golden_tensors;
#[cfg(test)]
mod tests;
