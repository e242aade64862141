//! `magsplice decouple`: evaluates a film: field, comparison and decoupling errors.

use magsplice::{Film, Stage};

use crate::args::evaluate::DecoupleArgs;
use crate::args::formats::{DecoupleFormat, TableFormat};
use crate::evaluation::Evaluation;
use crate::failure::{self, Failure};
use crate::json::decouple::DecoupleJson;
use crate::output::destination::Output;
use crate::output::{choice, table};
use crate::progress::ProgressLine;
use crate::words::{film_failure, no_film};
use crate::{remarks, text};

pub(crate) fn run(args: &DecoupleArgs, quiet: bool) -> Result<(), Failure> {
    let format = choice::choose(args.format, args.output.as_deref(), Some(DecoupleFormat::Text))?;
    if let DecoupleFormat::Table(format) = format {
        choice::accept(format, args.output.as_deref(), true)?;
    }
    let progress = ProgressLine::start(!quiet);
    let show = |stage: Stage| progress.show(stage);
    let layout = remarks::read_layout(&args.layout, remarks::OF_COMPARISONS, quiet, &progress)?;
    let film = Film::new(&layout).with_accuracy(args.accuracy.accuracy()).with_progress(&show);
    let failed = |error| film_failure(&args.layout, &layout, error);
    // A layout without these tables, and a file that cannot be written, are refused before the
    // field is computed.
    let purpose = "evaluates how well a film above a sensor separates the three displacements";
    let no_film = |error| no_film(&args.layout, error, "decouple", purpose);
    film.ideal().and(film.volume().map(|_| ())).map_err(no_film)?;
    let mut output = Output::open(args.output.as_deref(), &[&args.layout])?;
    let evaluation = Evaluation::new(&film).map_err(failed)?;
    let DecoupleFormat::Table(format) = format else {
        progress.end();
        output.write(|w| w.write_all(text::decouple::evaluation(&evaluation).as_bytes()))?;
        return output.finish();
    };
    let table = evaluation.table();
    match &output {
        Output::Stdout(_) => progress.end(),
        _ => progress.show(Stage::uncounted("writing")),
    }
    table::write(&table, &DecoupleJson::new(&evaluation, Some(&table)), format, &mut output)?;
    output.finish()?;
    progress.end();
    let singular = evaluation.decoupling.singular.len();
    if singular > 0 && !quiet && format != TableFormat::Json {
        let points = if singular == 1 { "point has" } else { "points have" };
        failure::tell(&format_args!("{singular} singular {points} B_z = 0: their R_x, R_y, S_z are written as NaN"));
    }
    Ok(())
}
