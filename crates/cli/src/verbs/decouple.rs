//! `magsplice decouple`: evaluates a film: field, comparison and decoupling errors.

use std::iter;
use std::path::Path;

use magsplice::layout::Layout;
use magsplice::{Film, Stage};

use crate::args::evaluate::DecoupleArgs;
use crate::args::formats::{DecoupleFormat, TableFormat};
use crate::evaluation::Evaluation;
use crate::failure::{self, Failure};
use crate::inputs::points;
use crate::inputs::points_below_film::GivenPoints;
use crate::json::decouple::DecoupleJson;
use crate::json::decouple_points::DecouplePointsJson;
use crate::output::destination::Output;
use crate::output::{choice, table};
use crate::point_evaluation::PointEvaluation;
use crate::prepared_film::prepare;
use crate::progress::ProgressLine;
use crate::words::{film_failure, no_film};
use crate::{remarks, text};

pub(crate) fn run(args: &DecoupleArgs, quiet: bool) -> Result<(), Failure> {
    let format = choice::choose(args.format, args.output.as_deref(), Some(DecoupleFormat::Text))?;
    if let DecoupleFormat::Table(format) = format {
        choice::accept(format, args.output.as_deref(), args.points.path().is_none())?;
    }
    // No progress line between points that a person types.
    let progress = ProgressLine::start(!quiet && !points::are_typed(args.points.path()));
    let show = |stage: Stage| progress.show(stage);
    let layout = remarks::read_layout(&args.layout, remarks::OF_COMPARISONS, quiet, &progress)?;
    let failed = |error| film_failure(&args.layout, &layout, error);
    // A layout without these tables, and a file that cannot be written, are refused before the
    // field is computed.
    let purpose = "evaluates how well a film above a sensor separates the three displacements";
    let no_film = |error| no_film(&args.layout, error, "decouple", purpose);
    let stated = Film::rigid(&layout);
    stated.ideal().and(stated.volume().map(|_| ())).map_err(no_film)?;
    let inputs: Vec<&Path> = iter::once(args.layout.as_path()).chain(args.points.path()).collect();
    let mut output = Output::open(args.output.as_deref(), &inputs)?;
    let film = prepare(&args.layout, &layout, &show, &remarks::teller(quiet, &progress))?
        .with_accuracy(args.accuracy.accuracy());
    if let Some(path) = args.points.path() {
        let tell = remarks::teller(quiet, &progress);
        let given = GivenPoints::read(path, args.points.unit, film.ideal().map_err(failed)?, true, &tell)?;
        let evaluation = PointEvaluation::new(&film, given, &args.layout, &layout)?;
        return write_at_points(&evaluation, &layout, format, output, &progress, quiet);
    }
    let evaluation = Evaluation::new(&film).map_err(failed)?;
    let DecoupleFormat::Table(format) = format else {
        progress.end();
        output.write(|w| w.write_all(text::decouple::evaluation(&evaluation).as_bytes()))?;
        return finish_text(output, &layout, quiet);
    };
    let table = evaluation.table();
    match &output {
        Output::Stdout(_) => progress.end(),
        _ => progress.show(Stage::uncounted("writing")),
    }
    table::write(&table, &DecoupleJson::new(&evaluation, Some(&table)), format, &mut output)?;
    output.finish()?;
    progress.end();
    tell_singular(evaluation.decoupling.singular.len(), format, quiet);
    Ok(())
}

/// Writes the result of `decouple --points`.
fn write_at_points(
    evaluation: &PointEvaluation,
    layout: &Layout,
    format: DecoupleFormat,
    mut output: Output,
    progress: &ProgressLine,
    quiet: bool,
) -> Result<(), Failure> {
    progress.end();
    let DecoupleFormat::Table(format) = format else {
        output.write(|w| w.write_all(text::decouple_points::evaluation(evaluation).as_bytes()))?;
        return finish_text(output, layout, quiet);
    };
    let table = evaluation.table();
    table::write(&table, &DecouplePointsJson::new(evaluation, &table), format, &mut output)?;
    output.finish()?;
    tell_singular(evaluation.decoupling.singular.len(), format, quiet);
    Ok(())
}

/// Ends a text. On a terminal it has moved the warnings out of view, so they are recalled after it.
fn finish_text(output: Output, layout: &Layout, quiet: bool) -> Result<(), Failure> {
    let is_standard = output.is_standard();
    output.finish()?;
    if is_standard {
        remarks::recall(layout, remarks::OF_COMPARISONS, quiet);
    }
    Ok(())
}

/// Says how many points have NaN for parameters. JSON lists them itself.
fn tell_singular(singular: usize, format: TableFormat, quiet: bool) {
    if singular > 0 && !quiet && format != TableFormat::Json {
        let points = if singular == 1 { "point has" } else { "points have" };
        failure::tell(&format_args!("{singular} singular {points} B_z = 0: their R_x, R_y, S_z are written as NaN"));
    }
}
