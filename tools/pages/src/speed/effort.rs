//! The effort of the page's measurements.

/// Tile-point pairs and runs of each measurement.
#[derive(Clone, Copy)]
pub(crate) struct SpeedEffort {
    /// Tile-point pairs in a run.
    pub(crate) pairs: usize,
    /// Tile-point pairs in a run with the peers: enough for many points in scenes of many tiles.
    pub(crate) peer_pairs: usize,
    /// Interleaved runs.
    pub(crate) runs: usize,
}

impl SpeedEffort {
    pub(crate) const FULL: SpeedEffort = SpeedEffort { pairs: 3_000_000, peer_pairs: 8_000_000, runs: 7 };

    pub(crate) const ONCE: SpeedEffort = SpeedEffort { pairs: 20_000, peer_pairs: 20_000, runs: 1 };
}
