//! Levels of division until a quantity is known to a tolerance.
//!
//! Let Q_l be the quantity at level l. With the cells of [`crate::cells`] its error falls with the
//! square of the level, Q_l = Q + c / l^2, in the mean over the measured films. The value is
//! extrapolated with this order (Richardson). Its estimated error is the error of Q_l from the last
//! two changes of Q, with the earlier change scaled to the last level, because one change can be
//! small by chance. The estimate is at least a share of the change of the value by the
//! permeability. A factor of safety multiplies it, because odd and even numbers of cells have
//! different errors.
//!
//! The share and the factor were fitted to the values of the tests: B near and far, and mean
//! polarizations, of 19 sets of tiles. These are rods, plates, cubes, touching and separate pairs,
//! a Halbach row, a checkerboard, stripes, anisotropic and turned tiles, with permeabilities up to
//! 3. The result is an estimate, not a bound. It excludes the error of the solution of the cells,
//! which with many cells is [`crate::tolerances::TREE_ERROR`] of the change.

use magsplice_magnet::Tile;
use thiserror::Error;

use crate::cells::cell_count;
use crate::error::RecoilError;
use crate::magnetization::Magnetization;
use crate::material::RecoilTile;
use crate::tolerances::MAX_CELLS;

/// Smallest error of a value at level 1, as a share of its change by the permeability. It falls
/// with the square of the level too. Among many values, both changes of one can be small by chance:
/// one value has an error at level 3 of a tenth of its change, over 3^2.
const LEAST_SHARE: f64 = 0.25;

/// Factor of safety. Without it, the largest error of the 418 values of 19 sets of tiles at level 3
/// is 4.2 times the estimate, and three errors exceed 3 times the estimate; at levels 4 to 6 the
/// largest is 1.1 times the estimate.
const SAFETY: f64 = 4.5;

/// Number of levels with two changes.
const LEAST_LEVEL: usize = 3;

/// Largest assumed power of the level in the decrease of errors. They fall with the square, and
/// vary by chance.
const STEEPEST_FALL: i32 = 3;

/// Settings of a refinement.
#[derive(Clone, Debug, PartialEq)]
pub struct RefinementSettings {
    /// Largest error of each value, in its unit; infinite to estimate the error without a limit.
    pub tolerances: Vec<f64>,
    /// Largest number of cells, at most [`MAX_CELLS`].
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

/// The reason why a quantity does not reach its tolerance.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum RefinementError {
    /// The polarization cannot be computed.
    #[error("{0}")]
    Recoil(#[source] RecoilError),
    /// A tolerance is not reached with the allowed number of cells.
    #[error(
        "the error is {reached:.1e}, must be at most {tolerance:.1e}, which needs about {needed_cells} cells, but at most \
         {most_cells} are allowed; accept a larger tolerance, or allow more cells, up to {MAX_CELLS}"
    )]
    NotConverged {
        /// The tolerance of the value that exceeds its tolerance by the largest factor.
        tolerance: f64,
        /// The error of this value; infinite with fewer than three levels.
        reached: f64,
        /// Largest number of cells.
        most_cells: usize,
        /// Number of cells at which the error is small enough if it falls with the square of the
        /// level; the cells of the third level if the error is unknown.
        needed_cells: usize,
        /// The best result, from at least two levels. Errors need three.
        best: Option<Box<Refined>>,
    },
    /// The numbers of values and tolerances differ.
    #[error("the quantity has {values} values, must have one for each of the {tolerances} tolerances")]
    Count {
        /// Number of tolerances.
        tolerances: usize,
        /// Number of values.
        values: usize,
    },
}

/// Divides tiles at level 1, 2, 3 and so on, until `quantity` reaches its tolerances. `quantity`
/// maps the cells, as tiles, to any number of values, such as B at points or an error of a film.
/// Without permeabilities above 1 level 1 is exact.
///
/// `progress` receives the level, from any thread, during its solution. A panic of `progress` ends
/// the work and reaches the caller.
///
/// # Errors
/// If the polarization cannot be computed, or the tolerance is not reached; the error then holds
/// the best result. Levels above the third are not solved where their errors would have to fall
/// faster than with the cube of the level.
///
/// # Panics
/// Never; a quantity that is not finite does not converge.
pub fn refine(
    tiles: &[RecoilTile],
    settings: &RefinementSettings,
    quantity: impl Fn(&[Tile]) -> Vec<f64>,
    progress: impl Fn(usize) + Sync,
) -> Result<Refined, RefinementError> {
    let RefinementSettings { tolerances, most_cells } = settings;
    refine_within(tiles, *most_cells, |_, _| tolerances.clone(), quantity, progress)
}

/// [`refine`] to tolerances that depend on the values: `tolerances` maps the values for J_r and the
/// extrapolated values of a level to the largest error of each. A share of the change by the
/// permeability, for example, is known only when the change is.
///
/// # Errors
/// The errors of [`refine`].
pub fn refine_within(
    tiles: &[RecoilTile],
    most_cells: usize,
    tolerances: impl Fn(&[f64], &[f64]) -> Vec<f64>,
    quantity: impl Fn(&[Tile]) -> Vec<f64>,
    progress: impl Fn(usize) + Sync,
) -> Result<Refined, RefinementError> {
    let most_cells = most_cells.min(MAX_CELLS);
    let highest = highest_level(tiles, most_cells);
    let mut levels = Levels::new(tiles, quantity);
    let mut last_tolerances = tolerances(&levels.rigid, &levels.rigid);
    let counted = |values: usize, tolerances: usize| match values == tolerances {
        true => Ok(()),
        false => Err(RefinementError::Count { tolerances, values }),
    };
    counted(levels.rigid.len(), last_tolerances.len())?;
    for level in 1..=highest {
        let magnetization = levels.next(&progress).map_err(RefinementError::Recoil)?;
        counted(levels.values[level - 1].len(), levels.rigid.len())?;
        if level < levels.least() {
            continue;
        }
        let best = levels.refined(magnetization);
        last_tolerances = tolerances(&levels.rigid, &best.values);
        let (reached, tolerance) = farthest(&best.errors, &last_tolerances);
        if reached <= tolerance {
            return Ok(best);
        }
        let reachable = tolerance * (highest as f64 / level as f64).powi(STEEPEST_FALL);
        // This comparison fails for NaN.
        if level == highest || !(reached <= reachable) {
            let fall = (reached / tolerance).sqrt();
            // The number of cells saturates at the largest number.
            let needed_cells = count(tiles, (level as f64 * fall).ceil().max(highest as f64 + 1.0) as usize);
            let best = Some(Box::new(best));
            return Err(RefinementError::NotConverged { tolerance, reached, most_cells, needed_cells, best });
        }
    }
    let tolerance = last_tolerances.into_iter().fold(f64::INFINITY, f64::min);
    let needed_cells = count(tiles, levels.least());
    Err(RefinementError::NotConverged { tolerance, reached: f64::INFINITY, most_cells, needed_cells, best: None })
}

/// The quantity at a level, 3 or higher, extrapolated from this level and those before, with its
/// errors. See [`refine`]; tiles without permeabilities above 1 have no errors at any level.
///
/// # Errors
/// If the polarization cannot be computed, or the level has more than [`MAX_CELLS`] cells.
///
/// # Panics
/// If the level is less than 3, or the number of values of the quantity changes between levels.
pub fn extrapolated_at(
    tiles: &[RecoilTile],
    level: usize,
    quantity: impl Fn(&[Tile]) -> Vec<f64>,
    progress: impl Fn(usize) + Sync,
) -> Result<Refined, RecoilError> {
    assert!(level >= LEAST_LEVEL, "level {level}, must be at least {LEAST_LEVEL}");
    let mut levels = Levels::new(tiles, quantity);
    for _ in 1..level {
        levels.next(&progress)?;
    }
    let last = levels.next(&progress)?;
    Ok(levels.refined(last))
}

/// The highest level at which tiles have at most this number of cells; 0 if there is none.
pub fn highest_level(tiles: &[RecoilTile], most_cells: usize) -> usize {
    if tiles.is_empty() {
        return 1;
    }
    (1..).take_while(|level| count(tiles, *level) <= most_cells).count()
}

/// Number of cells of a level.
fn count(tiles: &[RecoilTile], level: usize) -> usize {
    tiles.iter().fold(0, |sum: usize, each| sum.saturating_add(cell_count(each.tile.size(), level)))
}

/// The quantity for J_r, and at levels 1, 2 and so on.
struct Levels<'a, Q> {
    tiles: &'a [RecoilTile],
    quantity: Q,
    rigid: Vec<f64>,
    values: Vec<Vec<f64>>,
}

impl<'a, Q: Fn(&[Tile]) -> Vec<f64>> Levels<'a, Q> {
    fn new(tiles: &'a [RecoilTile], quantity: Q) -> Levels<'a, Q> {
        let bare: Vec<Tile> = tiles.iter().map(|each| each.tile).collect();
        Levels { tiles, rigid: quantity(&bare), quantity, values: Vec::new() }
    }

    /// Solves the next level.
    fn next(&mut self, progress: &(impl Fn(usize) + Sync)) -> Result<Magnetization, RecoilError> {
        let level = self.values.len() + 1;
        let magnetization = Magnetization::solve(self.tiles, level, |_| progress(level))?;
        self.values.push((self.quantity)(magnetization.cells()));
        Ok(magnetization)
    }

    fn is_rigid(&self) -> bool {
        self.tiles.iter().all(|each| each.permeability.is_rigid())
    }

    /// The lowest level with known errors.
    fn least(&self) -> usize {
        if self.is_rigid() { 1 } else { LEAST_LEVEL }
    }

    /// Values and errors of the last level.
    fn refined(&self, magnetization: Magnetization) -> Refined {
        let level = self.values.len();
        let (values, errors) = if self.is_rigid() {
            (self.values[level - 1].clone(), vec![0.0; self.rigid.len()])
        } else {
            extrapolate(&self.rigid, &self.values)
        };
        Refined { values, errors, level, magnetization }
    }
}

/// The error that exceeds its tolerance by the largest factor, with the tolerance. NaN counts as
/// the largest error.
fn farthest(errors: &[f64], tolerances: &[f64]) -> (f64, f64) {
    let pairs = errors.iter().copied().zip(tolerances.iter().copied());
    // An infinite tolerance allows any error.
    let asked = pairs.filter(|(_, tolerance)| tolerance.is_finite());
    let excess = |(error, tolerance): (f64, f64)| if error.is_nan() { f64::INFINITY } else { error / tolerance };
    asked.reduce(|worst, pair| if excess(pair) > excess(worst) { pair } else { worst }).unwrap_or((0.0, f64::INFINITY))
}

/// Values and errors from the values for J_r and the values of three or more levels.
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
