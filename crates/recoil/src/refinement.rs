//! Levels of division until a quantity is known to a tolerance.
//!
//! Let Q_l be the field of the cells of level l. With the cells of [`crate::cells`] its error falls
//! with the square of the level, Q_l = Q + c / l^2, in the mean over the measured films. The field
//! of two levels, with the polarization of their cells times weights, has no error of this order
//! (Richardson): it is the extrapolated field. The quantity is evaluated for these cells. Its
//! estimated error is its step from the level before, times a factor of safety. The step of one
//! value can be small by chance, that of the largest of many cannot: values of a group, such as B
//! at many points, have the error of the largest step. In a group of few values the error is at
//! least a share of the change by the permeability.
//!
//! The share and the factor were fitted to the values of the tests: B near and far, and mean
//! polarizations, of 19 sets of tiles. These are rods, plates, cubes, touching and separate pairs,
//! a Halbach row, a checkerboard, stripes, anisotropic and turned tiles, with permeabilities up to
//! 3. The result is an estimate, not a bound. It excludes the error of the solution of the cells,
//! which with many cells is [`crate::tolerances::TREE_ERROR`] of the change.

use magsplice_magnet::{IronPlanes, Tile};
use thiserror::Error;

use crate::cells::cell_count;
use crate::error::RecoilError;
use crate::magnetization::Magnetization;
use crate::material::RecoilTile;
use crate::tolerances::MAX_CELLS;

/// Smallest step of a value at level 1, as a share of its change by the permeability. It falls with
/// the square of the level, and in a group with the number of values.
const LEAST_SHARE: f64 = 0.5;

/// Factors of safety between the error and the largest step of a group: at the third level, whose
/// step begins with two divisions of few cells, and later. Without them the largest error of the
/// groups of 19 sets of tiles is 2.5 steps at level 3 and 1.9 at levels 4 and 5.
const SAFETY: [f64; 2] = [3.0, 2.0];

/// Number of levels with two extrapolations.
const LEAST_LEVEL: usize = 3;

/// Number of levels from which on the decrease of the errors so far tells the level that is needed.
const KNOWN_FALL: usize = 6;

/// Smallest and largest assumed power of the level in the decrease of errors.
const FALLS: [f64; 2] = [1.0, 4.0];

/// Vectors of one kind among the values of a quantity, such as B at many points. All components
/// have the error of the vector with the largest step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Group {
    /// Number of vectors.
    pub vectors: usize,
    /// Number of components of each, one at least.
    pub components: usize,
}

impl Group {
    /// A value of its own kind.
    const ALONE: Group = Group { vectors: 1, components: 1 };
}

/// Settings of a refinement.
#[derive(Clone, Debug, PartialEq)]
pub struct RefinementSettings {
    /// Largest error of each value, in its unit; infinite to estimate the error without a limit.
    pub tolerances: Vec<f64>,
    /// Largest number of cells, at most [`MAX_CELLS`].
    pub most_cells: usize,
    /// Flat iron around the tiles. The quantity adds the field of its images.
    pub iron: IronPlanes,
}

/// Values with their errors.
#[derive(Clone, Debug, PartialEq)]
pub struct Refined {
    /// The values for the cells of `magnetization`.
    pub values: Vec<f64>,
    /// Estimates of the errors of the values.
    pub errors: Vec<f64>,
    /// The highest level.
    pub level: usize,
    /// The solution of the highest level, extrapolated from it and the level before.
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
        /// Number of cells of the level at which the error is small enough if it falls on as it
        /// did; the cells of the third level if the error is unknown.
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
/// the best result. Levels are not solved where their errors would have to fall faster than with
/// the fourth power of the level or, from the sixth on, faster than they did.
///
/// # Panics
/// Never; a quantity that is not finite does not converge.
pub fn refine(
    tiles: &[RecoilTile],
    settings: &RefinementSettings,
    quantity: impl Fn(&[Tile]) -> Vec<f64>,
    progress: impl Fn(usize) + Sync,
) -> Result<Refined, RefinementError> {
    let RefinementSettings { tolerances, most_cells, iron } = settings;
    refine_within(tiles, iron, *most_cells, &[], |_, _| tolerances.clone(), quantity, progress)
}

/// [`refine`] to tolerances that depend on the values: `tolerances` maps the values for J_r and
/// those of a level to the largest error of each. A share of the change by the permeability, for
/// example, is known only when the change is. `groups` of values follow each other from the first
/// value on; values after them are alone.
///
/// # Errors
/// The errors of [`refine`].
pub fn refine_within(
    tiles: &[RecoilTile],
    iron: &IronPlanes,
    most_cells: usize,
    groups: &[Group],
    tolerances: impl Fn(&[f64], &[f64]) -> Vec<f64>,
    quantity: impl Fn(&[Tile]) -> Vec<f64>,
    progress: impl Fn(usize) + Sync,
) -> Result<Refined, RefinementError> {
    let most_cells = most_cells.min(MAX_CELLS);
    let highest = highest_level(tiles, most_cells);
    let mut levels = Levels::new(tiles, iron, quantity);
    let mut last_tolerances = tolerances(&levels.rigid, &levels.rigid);
    let counted = |values: usize, tolerances: usize| match values == tolerances {
        true => Ok(()),
        false => Err(RefinementError::Count { tolerances, values }),
    };
    counted(levels.rigid.len(), last_tolerances.len())?;
    let mut first_excess = f64::NAN;
    for level in 1..=highest {
        let magnetization = levels.next(&progress).map_err(RefinementError::Recoil)?;
        counted(levels.values[level - 1].len(), levels.rigid.len())?;
        if level < levels.least() {
            continue;
        }
        let best = levels.refined(magnetization, groups);
        last_tolerances = tolerances(&levels.rigid, &best.values);
        let (reached, tolerance) = farthest(&best.errors, &last_tolerances);
        if reached <= tolerance {
            return Ok(best);
        }
        let excess = reached / tolerance;
        if level == LEAST_LEVEL {
            first_excess = excess;
        }
        let fall = (first_excess / excess).ln() / (level as f64 / LEAST_LEVEL as f64).ln();
        let fall = if level < KNOWN_FALL { FALLS[1] } else { fall.clamp(FALLS[0], FALLS[1]) };
        let needed = level as f64 * excess.powf(1.0 / fall);
        // This comparison fails for NaN.
        if level == highest || !(needed <= highest as f64) {
            // The number of cells saturates at the largest number.
            let needed_cells = count(tiles, needed.ceil().max(highest as f64 + 1.0) as usize);
            let best = Some(Box::new(best));
            return Err(RefinementError::NotConverged { tolerance, reached, most_cells, needed_cells, best });
        }
    }
    let tolerance = last_tolerances.into_iter().fold(f64::INFINITY, f64::min);
    let needed_cells = count(tiles, levels.least());
    Err(RefinementError::NotConverged { tolerance, reached: f64::INFINITY, most_cells, needed_cells, best: None })
}

/// The quantity at a level, 3 or higher, extrapolated from this level and the one before, with its
/// errors. See [`refine`] and, for `groups`, [`refine_within`]; tiles without permeabilities above
/// 1 have no errors at any level.
///
/// # Errors
/// If the polarization cannot be computed, or the level has more than [`MAX_CELLS`] cells.
///
/// # Panics
/// If the level is less than 3, or the number of values of the quantity changes between levels.
pub fn extrapolated_at(
    tiles: &[RecoilTile],
    iron: &IronPlanes,
    level: usize,
    groups: &[Group],
    quantity: impl Fn(&[Tile]) -> Vec<f64>,
    progress: impl Fn(usize) + Sync,
) -> Result<Refined, RecoilError> {
    assert!(level >= LEAST_LEVEL, "level {level}, must be at least {LEAST_LEVEL}");
    let mut levels = Levels::new(tiles, iron, quantity);
    for _ in 1..level {
        levels.next(&progress)?;
    }
    let last = levels.next(&progress)?;
    Ok(levels.refined(last, groups))
}

impl Magnetization {
    /// The polarization of a level, 2 or higher, extrapolated from it and the level before, as
    /// [`refine`] evaluates it.
    ///
    /// # Errors
    /// As [`Magnetization::solve`].
    pub fn extrapolated(
        tiles: &[RecoilTile],
        iron: &IronPlanes,
        level: usize,
        progress: impl Fn(usize) + Sync,
    ) -> Result<Magnetization, RecoilError> {
        let before = Magnetization::solve(tiles, iron, level.saturating_sub(1), &progress)?;
        Ok(Magnetization::solve(tiles, iron, level, &progress)?.extrapolated_from(&before, weight(level)))
    }
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
    iron: &'a IronPlanes,
    quantity: Q,
    rigid: Vec<f64>,
    values: Vec<Vec<f64>>,
    /// The solution of the last level.
    last: Option<Magnetization>,
}

impl<'a, Q: Fn(&[Tile]) -> Vec<f64>> Levels<'a, Q> {
    fn new(tiles: &'a [RecoilTile], iron: &'a IronPlanes, quantity: Q) -> Levels<'a, Q> {
        let bare: Vec<Tile> = tiles.iter().map(|each| each.tile).collect();
        Levels { tiles, iron, rigid: quantity(&bare), quantity, values: Vec::new(), last: None }
    }

    /// Solves the next level, and extrapolates from it and the one before.
    fn next(&mut self, progress: &(impl Fn(usize) + Sync)) -> Result<Magnetization, RecoilError> {
        let level = self.values.len() + 1;
        let solved = Magnetization::solve(self.tiles, self.iron, level, |_| progress(level))?;
        let extrapolated = match &self.last {
            Some(before) => solved.extrapolated_from(before, weight(level)),
            None => solved.clone(),
        };
        self.last = Some(solved);
        self.values.push((self.quantity)(extrapolated.cells()));
        Ok(extrapolated)
    }

    fn is_rigid(&self) -> bool {
        self.tiles.iter().all(|each| each.permeability.is_rigid())
    }

    /// The lowest level with known errors.
    fn least(&self) -> usize {
        if self.is_rigid() { 1 } else { LEAST_LEVEL }
    }

    /// Values and errors of the last level.
    fn refined(&self, magnetization: Magnetization, groups: &[Group]) -> Refined {
        let level = self.values.len();
        let errors = if self.is_rigid() { vec![0.0; self.rigid.len()] } else { self.errors(groups) };
        Refined { values: self.values[level - 1].clone(), errors, level, magnetization }
    }

    /// Errors of the values of the last level, the third or a later one.
    fn errors(&self, groups: &[Group]) -> Vec<f64> {
        let level = self.values.len();
        let [before, last] = [level - 2, level - 1].map(|i| &self.values[i]);
        let grouped: usize = groups.iter().map(|group| group.vectors * group.components).sum();
        let alone = std::iter::repeat_n(Group::ALONE, last.len().saturating_sub(grouped));
        let mut errors = Vec::with_capacity(last.len());
        for Group { vectors, components } in groups.iter().copied().chain(alone) {
            let values = errors.len()..(errors.len() + vectors * components).min(last.len());
            let largest = |of: &[f64]| {
                let [last, of] = [&last[values.clone()], &of[values.clone()]];
                let steps = last.chunks(components).zip(of.chunks(components)).map(|(last, of)| distance(last, of));
                steps.fold(0.0, |most, step| if step > most || step.is_nan() { step } else { most })
            };
            let least = LEAST_SHARE * largest(&self.rigid) / (vectors * level.pow(2)) as f64;
            let step = largest(before);
            let safety = SAFETY[usize::from(level > LEAST_LEVEL)];
            errors.resize(values.end, safety * if step.is_nan() { step } else { step.max(least) });
        }
        errors
    }
}

/// Length of the difference of two vectors.
fn distance(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).map(|(one, other)| (one - other).powi(2)).sum::<f64>().sqrt()
}

/// The weight of a level, the second or a later one, in the sum with the level before from which
/// errors that fall with the square of the level cancel. The weights add up to 1.
fn weight(level: usize) -> f64 {
    let [last, before] = [level, level - 1].map(|level| (level as f64).powi(2));
    last / (last - before)
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
