//! `--sorted`: tiles that are measured and sorted before they are placed.

use clap::Args;
use magsplice::making::{AssignmentSettings, MeasurementErrors, Sorting};

use super::measurement::MeasurementArgs;
use super::numbers::whole;
use crate::failure::Failure;

/// Starts and disturbances of the search for each sample. With 16 and 200, as `assign` has, the P95
/// of the shipped films is lower by a tenth and samples take eight times as long.
const STARTS: usize = 4;
const KICKS: usize = 100;

/// How tiles are sorted.
#[derive(Args)]
pub(crate) struct SortingArgs {
    /// Measure the tiles of each sample, and place them so that the displacement error is least
    #[arg(long)]
    pub(crate) sorted: bool,
    /// Number of spare tiles, cut in addition to the tiles of the film, in proportion to its parts
    #[arg(long, value_name = "N", requires = "sorted", value_parser = |text: &str| whole(text, 0..=MAX_SPARES))]
    pub(crate) spares: Option<usize>,
    /// Turn no tile over: the side that was up when it was measured stays up
    #[arg(long, requires = "sorted")]
    pub(crate) keep_side_up: bool,
    #[command(flatten)]
    pub(crate) errors: MeasurementArgs,
}

impl SortingArgs {
    /// How tiles are sorted. `None` if they are not.
    pub(crate) fn sorting(&self) -> Result<Option<Sorting>, Failure> {
        let errors = self.errors.errors();
        if !self.sorted {
            let refused = "measurement errors need --sorted";
            return errors.map_or(Ok(None), |_| Err(Failure::Refused(refused.to_owned())));
        }
        let settings =
            AssignmentSettings { starts: Some(STARTS), kicks: KICKS, seed: 1, may_turn_over: !self.keep_side_up };
        let measurement: MeasurementErrors = errors.unwrap_or_default();
        Ok(Some(Sorting { spares: self.spares.unwrap_or(0), measurement, settings }))
    }
}

/// Largest number of spare tiles.
const MAX_SPARES: usize = 100_000;
