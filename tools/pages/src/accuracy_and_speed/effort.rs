//! The effort and the tolerances of the page's measurements.

use magsplice_benches::SceneSizes;

/// Measured relative tolerances.
pub(crate) const TOLERANCES: [f64; 7] = [1e-2, 1e-4, 1e-6, 1e-8, 1e-9, 1e-10, 1e-12];

/// Relative tolerance of the growing films.
pub(crate) const GROWTH_TOLERANCE: f64 = 1e-6;

/// Numbers of points, tiles and runs.
#[derive(Clone, Copy)]
pub(crate) struct DialEffort {
    /// Points and tiles of the scenes.
    pub(crate) sizes: SceneSizes,
    /// Largest number of tile-point pairs of the exact field at a list.
    pub(crate) exact_pairs: usize,
    /// Largest number of tile-point pairs of a peer.
    pub(crate) peer_pairs: usize,
    /// Smallest number of points of a peer.
    pub(crate) peer_points: usize,
    /// Largest number of tile-point pairs summed with 130 digits.
    pub(crate) oracle_pairs: usize,
    /// Number of timed runs, after one untimed run.
    pub(crate) rounds: usize,
    /// Number of timed runs with the peers.
    pub(crate) peer_rounds: usize,
    /// Random tiles for each distance in the comparison of precisions.
    pub(crate) single_cases: usize,
    /// Tiles along a side of each growing film, and its runs.
    pub(crate) films: &'static [(usize, usize)],
}

impl DialEffort {
    pub(crate) const FULL: DialEffort = DialEffort {
        sizes: SceneSizes { grid: [81, 81, 41], points: 100_000, heap_points: 20_000, heap_side: 22 },
        exact_pairs: 100_000_000,
        peer_pairs: 6_000_000,
        peer_points: 2_000,
        oracle_pairs: 10_000,
        rounds: 5,
        peer_rounds: 3,
        single_cases: 1_000,
        films: &[(32, 15), (100, 7), (316, 3), (1000, 1)],
    };

    pub(crate) const ONCE: DialEffort = DialEffort {
        sizes: SceneSizes { grid: [11, 11, 6], points: 300, heap_points: 300, heap_side: 6 },
        exact_pairs: 100_000,
        peer_pairs: 20_000,
        peer_points: 20,
        oracle_pairs: 60,
        rounds: 1,
        peer_rounds: 1,
        single_cases: 20,
        films: &[(10, 1), (20, 1), (32, 1)],
    };
}
