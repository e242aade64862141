//! Limits on layout files: the format version, counts above which a file is refused, and the number
//! of tiles that a message names.

/// The version of the format that this crate reads and writes.
pub(crate) const FORMAT: i64 = 1;

/// Largest number of tiles that one repetition or lattice may make. A larger number is a mistake in
/// the repetition: the tiles would take gigabytes of memory.
pub(crate) const MAX_TILES: usize = 4_000_000;

/// Largest number of points of the working volume, because compare and decouple hold
/// [`BYTES_PER_POINT`] in memory.
pub(crate) const MAX_POINTS: f64 = 1e8;

/// Approximate memory that compare and decouple need for each point.
pub(crate) const BYTES_PER_POINT: f64 = 80.0;

/// Fraction of a step by which a grid may miss the upper end of its range and still include it.
/// Decimal steps are not exact in binary.
pub(crate) const STEP_ROUNDING: f64 = 1e-6;

/// Largest number of starting points of a design search.
pub(crate) const MAX_STARTS: usize = 10_000;

/// Largest number of faults or findings of one sort that are listed one by one: a wrong pitch makes
/// thousands of them.
pub(crate) const MAX_LISTED: usize = 20;
