//! Force and torque of two tiles.

use glam::DVec3;
use magsplice_magnet::Tile;

use crate::aligned_pair::AlignedPair;
use crate::double_double::DoubleDouble;
use crate::load::Load;
use crate::real::Real;
use crate::turned::NotConverged;
use crate::{closed_form, distant, turned};

/// Forces and torques of two tiles on each other: those on the first, and on the second.
///
/// If the edges of the tiles are parallel, force and torque are exact to round-off: the error is
/// below 1e-14 of the result, plus 1e-28 J J' D^2 / (4 pi mu0) for the force, and D times that for
/// the torque, where D is the largest distance of two corners. For tiles that are turned against
/// each other, the error is below `tolerance` times the integral of |J . n| |H| over the surface of
/// the one tile in the field of the other.
///
/// Faces that touch do so from outside. If tiles overlap by more than round-off, the result is that
/// of their magnetic charges.
///
/// # Errors
/// If tiles that are turned against each other are so close that the integral does not converge.
pub fn pair_loads(first: &Tile, second: &Tile, tolerance: f64) -> Result<[Load; 2], NotConverged> {
    let offset = first.position() - second.position();
    let on_first = load::<DoubleDouble>(first, second, tolerance)?;
    Ok([on_first, on_first.reaction(offset)])
}

/// The load on the first tile by the second. Tiles with parallel edges that are not distant are
/// evaluated in numbers of this kind.
pub(crate) fn load<N: Real>(first: &Tile, second: &Tile, tolerance: f64) -> Result<Load, NotConverged> {
    Ok(match AlignedPair::new(first, second) {
        Some(pair) => {
            let load = if distant::is_distant(&pair) { distant::load(&pair) } else { closed_form::load::<N>(&pair) };
            let unscaled = 1.0 / pair.scale;
            let to_scene = |vector: DVec3| first.rotation() * vector;
            Load {
                force: to_scene(load.force * unscaled * unscaled),
                torque: to_scene(load.torque * unscaled * unscaled * unscaled),
            }
        }
        None => turned::load(first, second, tolerance)?,
    })
}
