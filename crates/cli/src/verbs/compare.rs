//! `magsplice compare`: the field against the ideal film.

use magsplice::field::Comparison;
use magsplice::layout::Layout;
use magsplice::{Film, Stage};
use serde::Serialize;

use crate::args::{Format, LayoutArgs};
use crate::failure::Failure;
use crate::output;
use crate::progress::Progress;
use crate::text;
use crate::verbs::decouple::Source;

pub(crate) fn run(args: &LayoutArgs, quiet: bool) -> Result<(), Failure> {
    let progress = Progress::start(!quiet);
    let tell = |stage: Stage| progress.show(stage);
    let layout = Layout::read(&args.layout)?;
    let film = Film::new(&layout).with_accuracy(args.accuracy.get()).with_progress(&tell);
    let failed = |error| text::film_failure(&args.layout, &layout, error);
    // Whether there is something to compare with is known before the field is computed.
    film.ideal().map_err(failed)?;
    let field = film.volume_field_t().map_err(failed)?;
    let comparison = film.compare(&field).map_err(failed)?;
    progress.end();
    match args.format {
        Format::Json => {
            output::print(&text::json(&Report { source: Source::of(&film), comparison: (&comparison).into() }))
        }
        Format::Text => {
            let volume = film.volume().map_err(failed)?;
            output::print(&format!("{}\n{}", text::header(&film, volume), text::comparison(&comparison)))
        }
    }
}

#[derive(Serialize)]
struct Report<'a> {
    #[serde(flatten)]
    source: Source<'a>,
    comparison: ComparisonReport,
}

/// [`Comparison`] with units in its keys.
#[derive(Serialize)]
pub(crate) struct ComparisonReport {
    points: usize,
    component_rmse_t: [f64; 3],
    rmse_t: f64,
    relative_rmse: f64,
    worst_t: f64,
    worst_at_mm: [f64; 3],
    amplitude: f64,
    scaled_relative_rmse: Option<f64>,
    correlation: [Option<f64>; 3],
}

impl From<&Comparison> for ComparisonReport {
    fn from(c: &Comparison) -> ComparisonReport {
        ComparisonReport {
            points: c.points,
            component_rmse_t: c.component_rmse_t.to_array(),
            rmse_t: c.rmse_t,
            relative_rmse: c.relative_rmse,
            worst_t: c.worst_t,
            worst_at_mm: c.worst_at.to_array(),
            amplitude: c.amplitude,
            scaled_relative_rmse: c.scaled_relative_rmse,
            correlation: c.correlation,
        }
    }
}
