//! Tolerances and tuning constants of the design.

/// Tiles are images of each other if they agree to this fraction of a side and of the polarization.
/// Layouts are written with decimals, sometimes with only six of them.
pub(crate) const SAME_TILE: f64 = 1e-6;

/// Longest step of a length, as a fraction of the wavelength. It is so short that the axis along
/// which two tiles stay apart can be decided anew before they meet.
pub(crate) const LONGEST_STEP: f64 = 0.05;

/// Longest step of an angle, in radians.
pub(crate) const WIDEST_STEP: f64 = 0.3;

/// Longest step of a strength, as a fraction of the largest strength.
pub(crate) const STRONGEST_STEP: f64 = 0.3;

/// Starts differ from the layout by uniform deviates of at most this fraction of the longest step.
/// That is far enough to reach other basins, and near enough that tiles keep their neighbours.
pub(crate) const SPREAD_OF_STARTS: f64 = 1.0;

/// Maximum number of points of the design grid along x, y and z. The field is smooth on the scale
/// of a fifth of the wavelength, and on a grid five times finer the errors of the films found are
/// no larger (docs/design.md).
pub(crate) const POINTS_ALONG: [usize; 3] = [9, 9, 5];

/// Relative increase of the sum of squares that stands for one unit of lacking amplitude. It must
/// be above the worth of amplitude: on the published film's outline the squared errors grow tenfold
/// for 0.05 of amplitude, that is by 46 times the lack.
pub(crate) const PRICE_OF_AMPLITUDE: f64 = 200.0;

/// Number of spacings of a head that are tried between its bounds at first.
pub(crate) const FIRST_SPACINGS: usize = 5;
/// Number of spacings of a head that are tried next, in golden sections around the best. They leave
/// 0.07 of the distance of the bounds. Within it the error of the films of the tests changes by
/// less than a hundredth.
pub(crate) const FURTHER_SPACINGS: usize = 6;

/// Relative margin of the designed amplitude above the bound, so that rounding keeps the bound.
pub(crate) const AMPLITUDE_MARGIN: f64 = 5e-5;

/// First damping, as a fraction of the curvature.
pub(crate) const FIRST_DAMPING: f64 = 1e-3;
/// Factor of the damping after a successful step.
pub(crate) const LESS_DAMPING: f64 = 0.2;
/// Factor of the damping after a failed step.
pub(crate) const MORE_DAMPING: f64 = 4.0;
/// Least damping.
pub(crate) const LEAST_DAMPING: f64 = 1e-12;
/// Largest damping. Beyond it no step along the gradient helps.
pub(crate) const MOST_DAMPING: f64 = 1e6;

/// A descent ends when this many steps together gain less than [`LEAST_GAIN`].
pub(crate) const PATIENCE: usize = 8;
/// Relative gain of [`PATIENCE`] steps below which a descent ends.
pub(crate) const LEAST_GAIN: f64 = 1e-3;

/// A descent ends when the root mean square of its residuals, in radians or relative to the ideal
/// field, is below this. That is a ten-millionth of a wavelength, a thousandth of a micrometre for
/// 10 mm, far below the error of any rounded film.
pub(crate) const NOTHING_LEFT: f64 = 1e-7;

/// From this number of variables on, the curvature of a step is a product of few rows instead of a
/// matrix. The matrix costs the cube of the number of variables in each iteration of the solver:
/// 0.2 s for 300 of them.
pub(crate) const FACTORED_FROM: usize = 150;

/// Parts of the curvature below the square of this, relative to the largest, are left out of the
/// rows. The field in the working volume is smooth, so some tens of rows are left. The residuals
/// that a descent can reduce are above [`NOTHING_LEFT`].
pub(crate) const SMALLEST_ROW: f64 = 1e-9;

/// Elements of the curvature by errors of films below the square of this, relative to the largest,
/// are left out of the rows unless they are on the diagonal. Every tile has errors of its own, so
/// the curvature has no small rank; a step needs it to a per mille only.
pub(crate) const SMALLEST_FACTOR: f64 = 0.03;

/// Maximum number of steps of a descent.
pub(crate) const MOST_STEPS: usize = 150;

/// Rules may be broken by this much, in millimetres (tesla for strengths): the accuracy of the
/// solver of quadratic programs. It is far below the resolution of films, and rounding restores
/// the rules.
pub(crate) const KEPT_MM: f64 = 1e-6;

/// Maximum number of times a rounded film is improved by a linear model about it.
pub(crate) const ROUNDINGS: usize = 4;

/// Maximum number of times a rounded film whose amplitude is short is designed for more.
pub(crate) const ROUNDS_OF_AMPLITUDE: usize = 4;

/// Level of division of tiles with a recoil permeability, the least at which an error is known.
pub(crate) const RECOIL_LEVEL: usize = 3;

/// Relative change of the field below which the part that recoil adds counts as converged. Films
/// are designed to errors of 1e-5 of the field.
pub(crate) const RECOIL_STAYS: f64 = 1e-7;

/// Most rounds until it stays. Each is nearer by about the susceptibility, 0.05 to 0.2.
pub(crate) const ROUNDS_OF_RECOIL: usize = 8;

/// With more parts than this, pairs to be merged are chosen by their sizes alone; with fewer, each
/// pair is tried.
pub(crate) const PARTS_TRIED: usize = 12;

/// With more parts than this, a quarter of them is merged before the film is designed anew, so that
/// the number of designs grows with the logarithm of the number of parts.
pub(crate) const PARTS_SINGLY: usize = 24;

/// Maximum number of steps of a trial, which only has to rank films.
pub(crate) const TRIAL_STEPS: usize = 12;

/// Number of the best trials that are descended to the end.
pub(crate) const TRIALS_FINISHED: usize = 4;

/// Largest number of tiles or rules that a message lists.
pub(crate) const MAX_LISTED: usize = 20;

/// Largest RMSE of the displacement of a useful film, as a fraction of the travel.
///
/// At this limit the sensor can tell five positions of the travel apart, each as wide as twice the
/// RMSE. A sensor that always reports the middle of the travel has an RMSE of 1 / sqrt(12) = 0.29
/// of it. The published film, with errors of its finite size, has 0.06 along x and y. Films that a
/// search found are below 0.01, unless it failed.
pub(crate) const LARGEST_SHARE_OF_TRAVEL: f64 = 0.1;
