//! Tolerances and tuning constants of the design.

/// Tiles are images of each other if they fit to this fraction of a side and of the polarization: layouts are written with decimals, sometimes six of them.
pub(crate) const SAME_TILE: f64 = 1e-6;

/// Along one step no length changes by more than this fraction of the wavelength, so that which side two tiles are apart on can be decided anew before they meet.
pub(crate) const LONGEST_STEP: f64 = 0.05;

/// Along one step no angle changes by more than this, in radians.
pub(crate) const WIDEST_STEP: f64 = 0.3;

/// Along one step no strength changes by more than this fraction of the largest.
pub(crate) const STRONGEST_STEP: f64 = 0.3;

/// Starts differ from the layout by normal deviates of this fraction of the longest step: far enough to reach other basins, near enough that tiles keep their neighbours.
pub(crate) const SPREAD_OF_STARTS: f64 = 1.0;

/// The design grid has at most so many points along x and y, and along z: the field is smooth on the scale of a fifth of the wavelength, and on a grid five times finer
/// the errors of the films found are no larger (docs/design.md).
pub(crate) const POINTS_ALONG: [usize; 3] = [9, 9, 5];

/// A film whose amplitude is short by a counts as if the sum of its squared errors were larger by this times a, as a fraction. It must be above what amplitude is worth: on the published
/// film's outline the squared errors grow tenfold for 0.05 of amplitude, that is by 46 times a.
pub(crate) const PRICE_OF_AMPLITUDE: f64 = 200.0;

/// The amplitude designed for is larger by this fraction than the one asked for, so that rounding keeps it.
pub(crate) const AMPLITUDE_MARGIN: f64 = 5e-5;

/// First damping, as a fraction of the curvature; divided or multiplied by the factors below as steps succeed or fail.
pub(crate) const FIRST_DAMPING: f64 = 1e-3;
pub(crate) const LESS_DAMPING: f64 = 0.2;
pub(crate) const MORE_DAMPING: f64 = 4.0;
pub(crate) const LEAST_DAMPING: f64 = 1e-12;
/// More means that no step along the gradient helps any more.
pub(crate) const MOST_DAMPING: f64 = 1e6;

/// A search ends when this many steps together gained less than this fraction.
pub(crate) const PATIENCE: usize = 8;
pub(crate) const LEAST_GAIN: f64 = 1e-3;

/// ... or after so many steps.
pub(crate) const MOST_STEPS: usize = 150;

/// Rules are kept to this: what the solver of quadratic programs leaves, far below the resolution of films, which are rounded so that they keep them.
pub(crate) const KEPT_MM: f64 = 1e-6;

/// So often a rounded film is improved by the linear model about it.
pub(crate) const ROUNDINGS: usize = 4;

/// So often a rounded film whose amplitude is short is designed for more.
pub(crate) const ROUNDS_OF_AMPLITUDE: usize = 4;

/// Parts beyond this number are made fewer by their sizes alone, then by trying each pair.
pub(crate) const PARTS_TRIED: usize = 12;

/// Steps of a trial, which only has to tell better from worse.
pub(crate) const TRIAL_STEPS: usize = 12;

/// So many of the best trials go on to the end.
pub(crate) const TRIALS_FINISHED: usize = 4;
