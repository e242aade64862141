//! Levels of division until a quantity is known to a tolerance.
//!
//! Let Q_l be the quantity at level l. With the cells of [`crate::cells`] its error falls with the
//! square of the level, Q_l = Q + c / l^2, in the mean over films that were measured. The value is
//! extrapolated with this order (Richardson). Its error is that of Q_l by the last two changes of
//! Q, of which the earlier one is brought to the last level: one change can be small by chance. It
//! is not less than a share of what the permeability changes in the value, and it is multiplied by
//! a factor of safety: odd and even numbers of cells have errors of their own.
//!
//! The share and the factor were fitted to the values of the tests: B near and far, and mean
//! polarizations, of 19 sets of tiles. These are rods, plates, cubes, touching and separate pairs,
//! a Halbach row, a checkerboard, stripes, anisotropic and turned tiles, with permeabilities up
//! to 3. The result is an estimate, not a bound. It does not contain the error of the solution of
//! the cells, which is [`crate::tolerances::TREE_ERROR`] of the change with many cells.

use std::error::Error;
use std::fmt;

use magsplice_magnet::Tile;

use crate::cells::cell_count;
use crate::error::RecoilError;
use crate::magnetization::Magnetization;
use crate::material::RecoilTile;
use crate::tolerances::MAX_CELLS;

/// Least error of a value at level 1, as a share of what the permeability changes in it. It falls
/// with the square of the level too. Both changes of one value of many can be small by chance: one
/// value has an error at level 3 of a tenth of its change, over 3^2.
const LEAST_SHARE: f64 = 0.25;

/// Factor of safety. Of the 418 values of 19 sets of tiles, the largest error at level 3 is 4.2
/// times the estimate without it, and three are more than 3 times it; at levels 4 to 6 the largest
/// is 1.1 times it.
const SAFETY: f64 = 4.5;

/// Levels that are needed for two changes.
const LEAST_LEVEL: usize = 3;

/// Power of the level with which errors may fall at most. They fall with the square, and change by
/// chance.
const STEEPEST_FALL: i32 = 3;

/// When a refinement ends.
#[derive(Clone, Debug, PartialEq)]
pub struct RefinementSettings {
    /// Largest error of each value, in its unit; infinite for a value whose error is only
    /// estimated.
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
        /// Cells of the level at which the error is small enough if it falls with the square of the
        /// level, or of the third level if it is not known.
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

/// Divides tiles at level 1, 2, 3 and so on, until `quantity` is known to a tolerance. `quantity`
/// takes the cells as tiles to any number of values: B at points, an error of a film. Without
/// permeabilities above 1 level 1 is exact.
///
/// `progress` is told the level, from any thread, while it is solved. A panic of it ends the work
/// and reaches the caller.
///
/// # Errors
/// If the polarization is not known, or the tolerance is not reached; the error then holds the best
/// that is known. Levels above the third are not solved where their errors would have to fall
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
    let tolerances = &settings.tolerances;
    let most_cells = settings.most_cells.min(MAX_CELLS);
    let highest = highest_level(tiles, most_cells);
    let mut levels = Levels::new(tiles, quantity);
    let counted = |values: usize| match values == tolerances.len() {
        true => Ok(()),
        false => Err(RefinementError::Count { tolerances: tolerances.len(), values }),
    };
    counted(levels.rigid.len())?;
    for level in 1..=highest {
        let magnetization = levels.next(&progress).map_err(RefinementError::Recoil)?;
        counted(levels.values[level - 1].len())?;
        if level < levels.least() {
            continue;
        }
        let best = levels.refined(magnetization);
        let (reached, tolerance) = farthest(&best.errors, tolerances);
        if reached <= tolerance {
            return Ok(best);
        }
        let reachable = tolerance * (highest as f64 / level as f64).powi(STEEPEST_FALL);
        // Written so that NaN fails the test.
        if level == highest || !(reached <= reachable) {
            let fall = (reached / tolerance).sqrt();
            // A level beyond the largest number has as many cells as there are numbers for.
            let needed_cells = count(tiles, (level as f64 * fall).ceil().max(highest as f64 + 1.0) as usize);
            let best = Some(Box::new(best));
            return Err(RefinementError::NotConverged { tolerance, reached, most_cells, needed_cells, best });
        }
    }
    let tolerance = tolerances.iter().copied().fold(f64::INFINITY, f64::min);
    let needed_cells = count(tiles, levels.least());
    Err(RefinementError::NotConverged { tolerance, reached: f64::INFINITY, most_cells, needed_cells, best: None })
}

/// The quantity at a level, 3 or higher, extrapolated from this level and those before, with its
/// errors. See [`refine`]; tiles without permeabilities above 1 have no errors at any level.
///
/// # Errors
/// If the polarization is not known, or the level has more than [`MAX_CELLS`] cells.
///
/// # Panics
/// If the level is less than 3, or the quantity does not have the same number of values at each
/// level.
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

/// The quantity with J_r, and at levels 1, 2 and so on.
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

    /// The least level whose errors are known.
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

/// The error that is farthest above its tolerance, with the tolerance. An error that is no number
/// is the farthest.
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
                "the error is {reached:.1e}, must be at most {tolerance:.1e}, which takes about {needed_cells} cells and at \
                 most {most_cells} are allowed: accept a larger tolerance, or allow more cells, up to {MAX_CELLS}"
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
