//! Limits on layout files: the format version, counts and lengths above which a file is refused,
//! and the number of items that a list in a message names.

/// The version of the format that this crate reads and writes.
pub(crate) const FORMAT: i64 = 1;

/// Largest size of a layout file, 64 MiB. It holds 400 000 tiles in the plain form, ten times as
/// many as the largest films; parsing takes about twenty times the size in memory.
pub(crate) const MAX_FILE_BYTES: usize = 64 << 20;

/// Largest number of tiles of a layout, cells of lattices without a tile included. A larger number
/// is a mistake in a repetition: the tiles would take gigabytes of memory.
pub(crate) const MAX_TILES: usize = 4_000_000;

/// Largest length of a name. Tables on a terminal and identifiers in other programs hold it.
pub const MAX_NAME_BYTES: usize = 200;

/// Largest total length of the names and kinds of all tiles, 256 MiB: 64 bytes for each of
/// [`MAX_TILES`].
pub(crate) const MAX_TOTAL_NAME_BYTES: usize = 256 << 20;

/// Largest number of points of the working volume, because compare and decouple hold
/// [`BYTES_PER_POINT`] in memory.
pub(crate) const MAX_POINTS: f64 = 1e8;

/// Memory that compare and decouple need for each point of the volume: its field, and beside it the
/// points, the ideal field and the parameters with their table. Measured: 73, with the table 103.
pub const BYTES_PER_POINT: f64 = 104.0;

/// Largest number of points of the grid on which a search evaluates films. A search holds the
/// derivatives with respect to every variable at each of them, and confirms the film on 125 times
/// as many.
pub(crate) const MAX_DESIGN_POINTS: f64 = 1e5;

/// Fraction of a step by which a grid may miss the upper end of its range and still include it.
/// Decimal steps are not exact in binary.
pub(crate) const STEP_ROUNDING: f64 = 1e-6;

/// Largest number of pairs of tiles that are examined for overlap: this many for each tile, which
/// is more than the half of 26 neighbours, and [`SPARE_PAIRS`].
pub(crate) const PAIRS_PER_TILE: usize = 16;

/// Pairs examined besides [`PAIRS_PER_TILE`], in a second. They are enough for 3000 bars side by
/// side that are not along an axis, each of which is near every other.
pub(crate) const SPARE_PAIRS: usize = 5_000_000;

/// Largest number of overlapping pairs of tiles that are looked through for those to name. It finds
/// every pair of entries of a film that has a few mistakes.
pub(crate) const MAX_OVERLAPS: usize = 100_000;

/// Largest number of starting points of a design search.
pub(crate) const MAX_STARTS: usize = 10_000;

/// Largest number of tiles of a layout with `[tolerance]`. The errors of a tile take about 300
/// bytes, and every sample evaluates all tiles: a sample of a larger film takes a minute.
pub(crate) const MAX_TOLERANCE_TILES: usize = 100_000;

/// Largest number of tiles in all groups of `[tolerance]` together, each counted in every group.
pub(crate) const MAX_GROUP_MEMBERS: usize = 4 * MAX_TOLERANCE_TILES;

/// Largest number of values of a tabulated distribution. Its quantiles of 0.01 % are then known to
/// a third of themselves.
pub(crate) const MAX_TABULATED: usize = 100_000;

/// Largest number of tabulated values in a layout, counted in each distribution that they are used
/// for. They are written into the layout with up to 25 bytes each.
pub(crate) const MAX_TABULATED_IN_ALL: usize = 1_000_000;

/// Largest number of names with an asterisk in `[tolerance]`, times the number of tiles: a few
/// seconds of comparing.
pub(crate) const MAX_NAME_TRIALS: usize = 10_000_000;

/// Numbers of samples of a tolerance analysis. Ten samples have no percentiles, but they show that
/// an analysis runs. The figures of more than ten million take gigabytes of memory.
pub const SAMPLE_COUNTS: std::ops::RangeInclusive<u64> = 10..=10_000_000;

/// Largest number of faults, findings of one sort, or names that are listed one by one: a wrong
/// pitch makes thousands of them.
pub(crate) const MAX_LISTED: usize = 20;

/// Largest number of characters of one line of a message about the syntax of a file.
pub(crate) const MAX_MESSAGE_LINE: usize = 1000;

/// Largest number of characters that a message shows of a name.
pub(crate) const MAX_SHOWN: usize = 60;
