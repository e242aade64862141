//! Levels of division until a quantity is known to a tolerance.
//!
//! Let Q_l be the quantity at level l. With the cells of [`crate::cells`] its error falls with the square
//! of the level, Q_l = Q + c / l^2, in the mean over films that were measured. The value is extrapolated
//! with this order (Richardson). Its error is that of Q_l by the last two changes of Q, of which
//! the earlier one is brought to the last level: one change can be small by chance. It is not less than a
//! share of what the permeability changes in the value, and it is multiplied by a factor of safety: odd and
//! even numbers of cells have errors of their own.
//!
//! The share and the factor were fitted to the values of the tests: B near and far, and mean polarizations,
//! of 19 sets of tiles. These are rods, plates, cubes, touching and separate pairs, a Halbach row, a
//! checkerboard, stripes, anisotropic and turned tiles, with permeabilities up to 3. The result is an
//! estimate, not a bound. It does not contain the error of the solution of the cells, which is
//! [`crate::tolerances::TREE_ERROR`] of the change with many cells.

use std::error::Error;
use std::fmt;

use magsplice_magnet::Tile;

use crate::cells::cell_count;
use crate::error::RecoilError;
use crate::magnetization::Magnetization;
use crate::material::RecoilTile;
use crate::tolerances::MAX_CELLS;

/// Least error of a value at level 1, as a share of what the permeability changes in it. It falls with the
/// square of the level too. Both changes of one value of many can be small by chance: one value has an error
/// at level 3 of a tenth of its change, over 3^2.
const LEAST_SHARE: f64 = 0.25;

/// Factor of safety. Of the 418 values of 19 sets of tiles, the largest error at level 3 is 4.2 times the
/// estimate without it, and three are more than 3 times it; at levels 4 to 6 the largest is 1.1 times it.
const SAFETY: f64 = 4.5;

/// Levels that are needed for two changes.
const LEAST_LEVEL: usize = 3;

/// When a refinement ends.
#[derive(Clone, Debug, PartialEq)]
pub struct RefinementSettings {
    /// Largest error of each value, in its unit; infinite for a value whose error is only estimated.
    pub tolerances: Vec<f64>,
    /// Most cells, at most [`MAX_CELLS`].
    pub most_cells: usize,
}

/// Values with their errors.
#[derive(Clone, Debug, PartialEq)]
pub struct Refined {
    /// The values, extrapolated to infinitely many cells.
    pub values: Vec<f64>,
    /// Estimates of the errors of the values.
    pub errors: Vec<f64>,
    /// The highest level.
    pub level: usize,
    /// The solution of the highest level.
    pub magnetization: Magnetization,
}

/// Why a quantity is not known to a tolerance.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum RefinementError {
    /// The polarization is not known.
    Recoil(RecoilError),
    /// A tolerance is not reached with as many cells as are allowed.
    NotConverged {
        /// The tolerance of the value that is farthest from its own.
        tolerance: f64,
        /// The error of this value; infinite with fewer than three levels.
        reached: f64,
        /// Most cells.
        most_cells: usize,
        /// Cells that the next level would need.
        needed_cells: usize,
        /// The best that is known, with two levels or more of which three are needed for errors.
        best: Option<Box<Refined>>,
    },
    /// The quantity has another number of values than there are tolerances.
    Count {
        /// Number of tolerances.
        tolerances: usize,
        /// Number of values.
        values: usize,
    },
}

/// Divides tiles at level 1, 2, 3 and so on, until `quantity` is known to a tolerance. `quantity` takes the
/// cells as tiles to any number of values: B at points, an error of a film. Without permeabilities above 1
/// level 1 is exact.
///
/// `progress` is told the level, from any thread, once for each of its cells.
///
/// # Errors
/// If the polarization is not known, or the tolerance is not reached; the error then holds the best that is
/// known.
///
/// # Panics
/// Never; a quantity that is not finite does not converge.
pub fn refine(
    tiles: &[RecoilTile],
    settings: &RefinementSettings,
    quantity: impl Fn(&[Tile]) -> Vec<f64>,
    progress: impl Fn(usize) + Sync,
) -> Result<Refined, RefinementError> {
    let most_cells = settings.most_cells.min(MAX_CELLS);
    let is_rigid = tiles.iter().all(|each| each.permeability.is_rigid());
    let bare: Vec<Tile> = tiles.iter().map(|each| each.tile).collect();
    let rigid = quantity(&bare);
    let mut history: Vec<Vec<f64>> = Vec::new();
    let mut best: Option<Box<Refined>> = None;
    for level in 1.. {
        let count = tiles.iter().fold(0_usize, |sum, each| sum.saturating_add(cell_count(each.tile.size(), level)));
        if count > most_cells {
            let worst = |best: &Refined| farthest(&best.errors, &settings.tolerances);
            let fallback = || (f64::INFINITY, settings.tolerances.iter().copied().fold(f64::INFINITY, f64::min));
            let (reached, tolerance) = best.as_deref().map_or_else(fallback, worst);
            let needed_cells = count;
            return Err(RefinementError::NotConverged { tolerance, reached, most_cells, needed_cells, best });
        }
        let magnetization = Magnetization::solve(tiles, level, || progress(level)).map_err(RefinementError::Recoil)?;
        let values = quantity(magnetization.cells());
        if values.len() != settings.tolerances.len() || rigid.len() != values.len() {
            return Err(RefinementError::Count { tolerances: settings.tolerances.len(), values: values.len() });
        }
        if is_rigid {
            let errors = vec![0.0; values.len()];
            return Ok(Refined { values, errors, level, magnetization });
        }
        history.push(values);
        if level >= LEAST_LEVEL {
            let (values, errors) = extrapolate(&rigid, &history);
            let refined = Refined { values, errors, level, magnetization };
            let (error, tolerance) = farthest(&refined.errors, &settings.tolerances);
            if error <= tolerance {
                return Ok(refined);
            }
            best = Some(Box::new(refined));
        }
    }
    unreachable!("each level has more cells than the one before, and they are limited")
}

/// The error that is farthest above its tolerance, with the tolerance. An error that is no number is the
/// farthest.
fn farthest(errors: &[f64], tolerances: &[f64]) -> (f64, f64) {
    let pairs = errors.iter().copied().zip(tolerances.iter().copied());
    // An infinite tolerance is for an error that may be anything.
    let asked = pairs.filter(|(_, tolerance)| tolerance.is_finite());
    let excess = |(error, tolerance): (f64, f64)| if error.is_nan() { f64::INFINITY } else { error / tolerance };
    asked.reduce(|worst, pair| if excess(pair) > excess(worst) { pair } else { worst }).unwrap_or((0.0, f64::INFINITY))
}

/// Values and errors from those with J_r and those of levels 1, 2 and so on, three or more.
fn extrapolate(rigid: &[f64], history: &[Vec<f64>]) -> (Vec<f64>, Vec<f64>) {
    let level = history.len();
    let inverse_square = |level: usize| (level as f64).powi(-2);
    let change = inverse_square(level - 1) - inverse_square(level);
    let earlier_change = inverse_square(level - 2) - inverse_square(level - 1);
    let [earlier, before, last] = [level - 3, level - 2, level - 1].map(|i| &history[i]);
    let of_one = |i: usize| {
        let slope = (before[i] - last[i]) / change;
        let earlier_slope = (earlier[i] - before[i]) / earlier_change;
        let value = last[i] - slope * inverse_square(level);
        let steepest = if slope.abs() >= earlier_slope.abs() { slope } else { earlier_slope };
        let least = LEAST_SHARE * (last[i] - rigid[i]).abs();
        (value, SAFETY * steepest.abs().max(least) * inverse_square(level))
    };
    (0..last.len()).map(of_one).unzip()
}

impl fmt::Display for RefinementError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RefinementError::Recoil(error) => error.fmt(f),
            RefinementError::NotConverged { tolerance, reached, most_cells, needed_cells, .. } => write!(
                f,
                "the error is {reached:.1e}, must be at most {tolerance:.1e}: accept a larger tolerance, or allow \
                 {needed_cells} cells instead of {most_cells}, at most {MAX_CELLS}"
            ),
            RefinementError::Count { tolerances, values } => {
                write!(f, "the quantity has {values} values, must have as many as there are tolerances, {tolerances}")
            }
        }
    }
}

impl Error for RefinementError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            RefinementError::Recoil(error) => Some(error),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests;
