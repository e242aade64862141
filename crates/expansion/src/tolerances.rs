//! Tuning constants of expansions, each with its trade-off.

/// Highest degree of a multipole expansion's potential. An expansion of this degree takes 40 kB.
pub const HIGHEST_DEGREE: usize = 39;

/// Highest degree of the field of a local expansion.
///
/// The time of a translation grows with its third power. A higher degree would admit hardly more
/// nodes, because nearer nodes need a high degree of their own.
pub const HIGHEST_LOCAL_DEGREE: usize = 24;

/// Number of neighbouring points that share the degree of a multipole expansion: the lanes of two
/// of the longest vectors.
pub const POINTS_PER_DEGREE: usize = 16;

/// Degrees of the exact mode's multipole expansions, each with the distance from which it is
/// sufficient, in radii of the sphere around the tiles; nearest first.
///
/// A dipole in the sphere has a field of at least 1 / (d + 1)^3 at distance d. The truncation error
/// after degree p, relative to it, is at most the sum over l > p of
/// 2 (l + 1/2)^2 / d^(l - 1) (1 + 1 / d)^3, which is below 5e-15 for each entry.
pub const EXPANSION_DEGREES: [(usize, f64); 6] =
    [(39, NEAREST_EXPANSION), (30, 4.0), (23, 6.0), (18, 10.0), (14, 20.0), (10, 60.0)];

/// Smallest distance of the exact mode's expansions, in radii of the sphere around the tiles. At
/// smaller distances the degree rises so fast that direct summation is faster.
pub const NEAREST_EXPANSION: f64 = 3.0;
