//! Tuning constants of expansions, each with what it trades.

/// The highest of them: 40 kB for the tiles of a cluster.
pub const HIGHEST_DEGREE: usize = 39;

/// The highest degree of the field around a batch of points to which nodes are translated. What a translation takes grows with its third power, and higher
/// ones serve hardly more nodes: those nearer are so near that their own degree is high.
pub const HIGHEST_LOCAL_DEGREE: usize = 24;

/// Of the points of a batch so many neighbours share the degree of a node's expansion: what two of the longest vectors hold.
pub const POINTS_PER_DEGREE: usize = 16;

/// Degrees of the expansion of tiles together, and the distance in radii of the sphere around them from which each is enough, nearer ones first. A dipole in
/// the sphere has a field of at least 1 / (d + 1)^3 there; of it what is left out after degree p is at most the sum over l > p of
/// 2 (l + 1/2)^2 / d^(l - 1) (1 + 1 / d)^3, which is below 5e-15 for each of these.
pub const EXPANSION_DEGREES: [(usize, f64); 6] =
    [(39, NEAREST_EXPANSION), (30, 4.0), (23, 6.0), (18, 10.0), (14, 20.0), (10, 60.0)];

/// Nearer the degrees rise so fast that tiles one by one cost less.
pub const NEAREST_EXPANSION: f64 = 3.0;
