//! `[expect.made]`: requirements on a percentile of the films that are made.

use crate::expectations::MadeExpectations;
use crate::read::expect::figure_bounds;
use crate::read::faults::TableFaults;
use crate::read::tables_present::TablesPresent;
use crate::read::tolerance::check_samples;
use crate::tables::expect::MadeTable;

/// The requirements. Faults are added; the result is meant for use only if there are none.
pub(crate) fn resolve(table: &MadeTable, present: TablesPresent, faults: &mut TableFaults) -> MadeExpectations {
    let MadeTable { percentile, uniformity_rmse, displacement_rmse_mm, amplitude, samples, confidence } = table;
    let defaults = MadeExpectations::default();
    present.check_for_made_films(faults);
    if uniformity_rmse.is_none() && displacement_rmse_mm.is_none() && amplitude.is_none() {
        faults.add("has no bound, must give at least one of uniformity_rmse, displacement_rmse_mm, amplitude");
    }
    let percentile = percentile.unwrap_or(defaults.percentile);
    if !(percentile > 0.0 && percentile < 100.0) {
        faults.add(format!(
            "percentile = {percentile}, must be greater than 0 and less than 100, in per cent of the films"
        ));
    } else if percentile <= 1.0 {
        faults.add(format!("percentile = {percentile}, must be greater than 1 (per cent: {}?)", 100.0 * percentile));
    }
    let confidence = confidence.unwrap_or(defaults.confidence);
    if !(confidence > 0.0 && confidence < 1.0) {
        let meant = if (1.0..100.0).contains(&confidence) {
            format!(" (a fraction, not per cent: {}?)", confidence / 100.0)
        } else {
            String::new()
        };
        faults.add(format!("confidence = {confidence}, must be greater than 0 and less than 1{meant}"));
    }
    if let Some(samples) = samples {
        check_samples(*samples, faults);
    }
    let bounds = figure_bounds(uniformity_rmse.as_ref(), displacement_rmse_mm.as_ref(), amplitude.as_ref(), faults);
    MadeExpectations { percentile, bounds, samples: *samples, confidence }
}
