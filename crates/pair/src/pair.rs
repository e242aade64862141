//! The choice of method for two tiles: the mean tensor, and force and torque.

use std::f64::consts::PI;

use glam::{DMat3, DQuat, DVec3};
use magsplice_magnet::Tile;

use crate::aligned_pair::{AlignedPair, axes_to_axes};
use crate::double_double::DoubleDouble;
use crate::load::Load;
use crate::not_converged::NotConverged;
use crate::real::Real;
use crate::symmetric_tensor::SymmetricTensor;
use crate::tolerances::{CORNER_ROUNDINGS, MOST_HALVINGS, PARALLEL, TENSOR_ERROR};
use crate::turned::{average, charges};
use crate::{closed_form, distant};

/// The mean demagnetizing tensor N of two tiles, in the frame of the scene: the mean of mu0 H over
/// `receiver` is -N J for the polarization J of `source`.
///
/// # Accuracy
/// For tiles with parallel edges the error is 1e-9 of the norm of the tensor. Tiles that touch add
/// a few units of round-off of the cube of their largest distance over the volume of the receiver.
/// For tiles turned against each other it is [`crate::tolerances::TURNED_ERROR`] of the norm.
///
/// # Errors
/// If the average over a turned tile does not converge, as for tiles that overlap.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use magsplice_magnet::Tile;
/// use magsplice_pair::mean_tensor;
///
/// let cube = Tile::new(DVec3::ZERO, DVec3::ONE, DVec3::Z).unwrap();
/// let own = mean_tensor(&cube, &cube).unwrap();
/// assert!((own.diagonal - DVec3::splat(1.0 / 3.0)).length() < 1e-14);
/// ```
pub fn mean_tensor(receiver: &Tile, source: &Tile) -> Result<SymmetricTensor, NotConverged> {
    mean_tensor_within(receiver, source, TENSOR_ERROR)
}

/// [`mean_tensor`] with another error for tiles with parallel edges, relative to the norm of the
/// tensor.
///
/// # Errors
/// The errors of [`mean_tensor`].
pub fn mean_tensor_within(receiver: &Tile, source: &Tile, error: f64) -> Result<SymmetricTensor, NotConverged> {
    let frame = source.rotation();
    let Some(axes) = axes_to_axes(DMat3::from_quat(frame.inverse() * receiver.rotation()), PARALLEL) else {
        return average::mean_tensor(receiver, source);
    };
    let (size, offset) = ((axes * receiver.size()).abs(), receiver.position() - source.position());
    if frame == DQuat::IDENTITY {
        return Ok(mean_tensor_of_boxes(size, source.size(), offset, error));
    }
    let tensor = mean_tensor_of_boxes(size, source.size(), frame.inverse() * offset, error);
    Ok(tensor.rotated(DMat3::from_quat(frame)))
}

/// The mean tensor of two boxes of these sides with parallel edges, to an error relative to the
/// norm of the tensor. `offset` is the vector from the centre of the source to the centre of the
/// receiver.
pub fn mean_tensor_of_boxes(receiver: DVec3, source: DVec3, offset: DVec3, error: f64) -> SymmetricTensor {
    // In units of the largest length, so that no power overflows.
    let unit = receiver.max_element().max(source.max_element()).max(offset.abs().max_element());
    of_scaled_boxes([receiver / unit, source / unit], offset / unit, error, MOST_HALVINGS)
}

fn of_scaled_boxes([receiver, source]: [DVec3; 2], offset: DVec3, error: f64, halvings: usize) -> SymmetricTensor {
    if let Some(tensor) = distant::mean_tensor(receiver, source, offset, error) {
        return tensor;
    }
    let touches = (offset.abs() - 0.5 * (receiver + source)).max_element() <= 0.0;
    if touches || halvings == 0 || corner_error(receiver, source, offset) <= error {
        return closed_form::mean_tensor(receiver, source, offset);
    }
    // The longest side is halved. The mean over a receiver is the mean of the means over its
    // halves, and the field of a source is the sum of the fields of its halves.
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
    CORNER_ROUNDINGS * f64::EPSILON * farthest.powi(3) * 4.0 * PI / (receiver.element_product() * magnitude)
}

/// Forces and torques of two tiles on each other: on the first, and on the second.
///
/// If the edges of the tiles are parallel, force and torque are exact to round-off: the error is
/// below 1e-14 of the result, plus 1e-28 J J' D^2 / (4 pi mu0) for the force and D times this for
/// the torque, where D is the largest distance of two corners. For tiles turned against each other,
/// the error is below `tolerance` times the integral of |J . n| |H| over the surface of one tile in
/// the field of the other.
///
/// Faces that touch do so from outside. If tiles overlap by more than round-off, the result is the
/// load of their magnetic charges.
///
/// # Errors
/// If tiles turned against each other are so close that the integral does not converge.
pub fn pair_loads(first: &Tile, second: &Tile, tolerance: f64) -> Result<[Load; 2], NotConverged> {
    let offset = first.position() - second.position();
    let on_first = load::<DoubleDouble>(first, second, tolerance)?;
    Ok([on_first, on_first.reaction(offset)])
}

/// The load on the first tile by the second, evaluated in `f64` for tiles with parallel edges: a
/// hundred times faster than [`pair_loads`] for near tiles.
///
/// For random pairs with parallel edges the error of the force was below 1e-11 J J' D^2 / (4 pi
/// mu0), and the error of the torque below D times this. For turned tiles the error of
/// [`pair_loads`] applies.
///
/// # Errors
/// The errors of [`pair_loads`].
pub fn load_in_f64(first: &Tile, second: &Tile, tolerance: f64) -> Result<Load, NotConverged> {
    load::<f64>(first, second, tolerance)
}

fn load<N: Real>(first: &Tile, second: &Tile, tolerance: f64) -> Result<Load, NotConverged> {
    match AlignedPair::new(first, second) {
        None => charges::load(first, second, tolerance),
        Some(pair) if distant::is_distant(&pair) => Ok(pair.to_scene(distant::load(&pair), first)),
        Some(pair) => Ok(pair.to_scene(closed_form::load::<N>(&pair), first)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::rows;

    /// The sum over corners also keeps its estimate beyond the range of its use.
    #[test]
    fn errors_of_corner_sums_are_below_their_estimate() {
        for (tag, numbers) in rows("mean_tensors", 55).into_iter().filter(|(tag, _)| tag != "own") {
            let [receiver, source, offset, diagonal, off_diagonal] =
                [0, 3, 6, 9, 12].map(|n: usize| DVec3::from_slice(&numbers[n..]));
            let exact = SymmetricTensor { diagonal, off_diagonal };
            let error = (closed_form::mean_tensor(receiver, source, offset) + exact * -1.0).norm() / exact.norm();
            let estimate = corner_error(receiver, source, offset);
            assert!(error <= estimate.max(1e-14), "{tag} {receiver} {source} {offset}: {error:e} {estimate:e}");
        }
    }
}
