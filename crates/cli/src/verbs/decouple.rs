//! `magsplice decouple`: evaluates a film: field, comparison and decoupling errors.

use std::fmt::Write;
use std::path::PathBuf;

use magsplice::prelude::{DVec3, Decoupling};
use magsplice::results::{FilmDecoupling, FilmEvaluation, FilmPointDecoupling, FilmPointEvaluation, Table};
use magsplice::{Film, Stage};
use serde::Serialize;

use super::compare::comparison;
use crate::args::accuracy::AccuracyArgs;
use crate::args::formats::{DecoupleFormat, TableFormat};
use crate::args::points::PointsArgs;
use crate::failure::{Failure, PRINTED_FAULTS};
use crate::inputs::points_below_film::GivenPoints;
use crate::output::destination::Output;
use crate::output::{choice, table};
use crate::remarks;
use crate::session::Session;
use crate::text::number::{point, uniformity_number};
use crate::text::units::in_mt;
use crate::text::{header, recoil, rows};

/// Evaluate the film: field, difference from the ideal film, decoupling errors.
///
/// Text is a report. JSON is the report with every point of the working volume. The other formats
/// hold B, R_x, R_y and S_z at every point. With --points they also hold the errors of the
/// parameters and of the displacement at each point, without the uniformity RMSE, which needs a
/// grid.
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  magsplice decouple layouts/published-film.toml\n  magsplice decouple layouts/published-film.toml -o film.npz"
)]
pub(crate) struct DecoupleArgs {
    /// Layout file
    layout: PathBuf,
    #[command(flatten)]
    points: PointsArgs,
    /// File to write, complete or not at all [default: -, standard output]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Format of the result [default: by the file's ending, else text]
    #[arg(long, value_enum)]
    format: Option<DecoupleFormat>,
    #[command(flatten)]
    accuracy: AccuracyArgs,
}

pub(crate) fn run(args: &DecoupleArgs, quiet: bool) -> Result<(), Failure> {
    let format = choice::choose(args.format, args.output.as_deref(), Some(DecoupleFormat::Text))?;
    if let DecoupleFormat::Table(format) = format {
        choice::accept(format, args.output.as_deref(), args.points.path().is_none())?;
    }
    let session = Session::open_with_points(&args.layout, args.points.path(), remarks::OF_COMPARISONS, quiet)?;
    // A layout without these tables, and a file that cannot be written, are refused before the
    // field is computed.
    let purpose = "evaluates how well a film above a sensor separates the three displacements";
    session.require_film(true, "decouple", purpose)?;
    let output = session.output(args.output.as_deref(), args.points.path())?;
    let film = session.film()?.with_accuracy(args.accuracy.accuracy());
    if let Some(given) = GivenPoints::read(&session, &args.points, true)? {
        let found = film.evaluate_at(given.points.clone()).map_err(|error| given.failure(error))?;
        let DecoupleFormat::Table(format) = format else {
            return write_text(&session, output, &at_points(&found, &given));
        };
        let FilmPointEvaluation { decoupling, .. } = &found;
        let singular = decoupling.decoupling.singular.len();
        return write_table(&session, output, &found, &decoupling.table(), singular, format);
    }
    let found = film.evaluate().map_err(|error| session.failed(error))?;
    let DecoupleFormat::Table(format) = format else { return write_text(&session, output, &text(&found)) };
    let table = found.decoupling.table().map_err(|error| session.failed(error))?;
    write_table(&session, output, &found, &table, found.decoupling.decoupling.singular.len(), format)
}

/// Writes a text. On a terminal it has moved the warnings out of view, so they are recalled after
/// it.
fn write_text(session: &Session, output: Output, text: &str) -> Result<(), Failure> {
    let is_standard = output.is_standard();
    session.write(output, text)?;
    if is_standard {
        session.recall();
    }
    Ok(())
}

/// Writes a table, and reports how many points have NaN for parameters. JSON lists them itself.
fn write_table(
    session: &Session,
    mut output: Output,
    found: &impl Serialize,
    table: &Table,
    singular: usize,
    format: TableFormat,
) -> Result<(), Failure> {
    match &output {
        Output::Stdout(_) => session.progress.end(),
        _ => session.progress.show(Stage::uncounted("writing")),
    }
    table::write(table, found, format, &mut output)?;
    output.finish()?;
    session.progress.end();
    if singular > 0 && format != TableFormat::Json {
        let points = if singular == 1 { "point has" } else { "points have" };
        session.tell(&format!("{singular} singular {points} B_z = 0: their R_x, R_y, S_z are written as NaN"));
    }
    Ok(())
}

/// The report over the working volume.
pub(super) fn text(found: &FilmEvaluation) -> String {
    let FilmEvaluation { decoupling, comparison: compared, .. } = found;
    let film = &decoupling.film;
    let mut sections = vec![
        header::of_points(film, None),
        field(film, decoupling.reference_field_t, film.volume_field_t().unwrap_or_default(), "volume"),
        comparison(compared),
        errors(decoupling),
    ];
    sections.extend(film.recoil().map(|recoil| recoil::section(film, recoil)));
    sections.join("\n")
}

/// The report at points.
fn at_points(found: &FilmPointEvaluation, given: &GivenPoints) -> String {
    let FilmPointEvaluation { decoupling, comparison: compared } = found;
    let film = &decoupling.film;
    let sections = [
        header::of_points(film, Some(given.summary())),
        field(film, decoupling.reference_field_t, &decoupling.field_t, "points"),
        comparison(compared),
        errors_at_points(decoupling),
        each_point(decoupling),
    ];
    sections.into_iter().filter(|section| !section.is_empty()).collect::<Vec<_>>().join("\n")
}

/// B at the reference point, beside B of the ideal film if there is one, and its range over the
/// volume or over points.
pub(super) fn field(film: &Film, reference_field_t: DVec3, field_t: &[DVec3], over: &str) -> String {
    let r = film.volume().map_or(DVec3::NAN, |volume| volume.reference_mm);
    let mut text = String::new();
    rows::heading(&mut text, "field, mT", ["B_x", "B_y", "B_z"]);
    let at_reference = format!("  at the reference {} mm", point(r));
    rows::vector(&mut text, &at_reference, in_mt(reference_field_t));
    if let Some(b_t) = film.ideal().ok().and_then(|ideal| ideal.flux_density_t(r)) {
        rows::vector(&mut text, "  ideal film (Eq. 2) there", in_mt(b_t));
    }
    let least_t = field_t.iter().copied().reduce(DVec3::min).unwrap_or_default();
    let most_t = field_t.iter().copied().reduce(DVec3::max).unwrap_or_default();
    rows::vector(&mut text, &format!("  least in the {over}"), in_mt(least_t));
    rows::vector(&mut text, &format!("  most in the {over}"), in_mt(most_t));
    text
}

/// The decoupling errors, as parameters and as millimetres.
fn errors(found: &FilmDecoupling) -> String {
    let Decoupling { uniformity_rmse, ideal_rmse, singular, .. } = &found.decoupling;
    let mut text = String::new();
    rows::heading(&mut text, "decoupling (Eq. 15)", ["R_x", "R_y", "S_z"]);
    rows::cells(&mut text, "  uniformity RMSE", uniformity_rmse.to_array().map(uniformity_number));
    let lengths = found.uniformity_rmse_mm.to_array().map(uniformity_number);
    rows::cells(&mut text, "    as displacement x, y, z, mm", lengths);
    rows::vector(&mut text, "  RMSE against the ideal film", ideal_rmse.to_array().into());
    rows::vector(&mut text, "    as displacement x, y, z, mm", found.decoupling.displacement_rmse_mm.into());
    text + &changes_from(found.reference_mm) + &singular_points(singular)
}

fn errors_at_points(found: &FilmPointDecoupling) -> String {
    let mut text = String::new();
    rows::heading(&mut text, "decoupling (Eq. 15)", ["R_x", "R_y", "S_z"]);
    rows::vector(&mut text, "  RMSE against the ideal film", found.decoupling.ideal_rmse.to_array().into());
    rows::vector(&mut text, "    as displacement x, y, z, mm", found.decoupling.displacement_rmse_mm.into());
    if let (Some(at), Some(worst_mm)) = (found.worst_displacement_at_mm, found.worst_displacement_error_mm) {
        rows::vector(&mut text, "  largest displacement error, mm", worst_mm.into());
        let _ = writeln!(text, "    at {} mm", point(at));
    }
    text += &changes_from(found.reference_mm);
    text += &singular_points(&found.decoupling.singular);
    text + &format!("  uniformity RMSE: undefined, {}\n", found.omitted.uniformity_rmse)
}

fn changes_from(r: DVec3) -> String {
    format!("  changes are from the reference {} mm\n", point(r))
}

fn singular_points(points: &[DVec3]) -> String {
    if points.is_empty() {
        return "  singular points (B_z = 0): none\n".to_owned();
    }
    let named: Vec<String> = points.iter().take(PRINTED_FAULTS).map(|p| point(*p)).collect();
    let rest = if points.len() > PRINTED_FAULTS { " and more" } else { "" };
    format!("  singular points (B_z = 0), excluded: {}, at {}{rest} mm\n", points.len(), named.join(" "))
}

/// Parameters and displacement errors at each of a few points; nothing for many.
fn each_point(found: &FilmPointDecoupling) -> String {
    if found.points > PRINTED_FAULTS {
        return format!("{} points: -o FILE.csv writes the parameters and errors at each\n", found.points);
    }
    let mut text = String::new();
    rows::heading(&mut text, "at each point", ["R_x, rad", "R_y, rad", "S_z"]);
    let parameters = found.decoupling.parameters.iter().zip(&found.displacement_errors_mm);
    for (p, at) in found.points_mm.iter().zip(parameters) {
        let label = format!("  {} mm", point(*p));
        let (Some(at), Some(error_mm)) = at else {
            rows::cell(&mut text, &label, "singular");
            continue;
        };
        rows::vector(&mut text, &label, DVec3::new(at.r_x, at.r_y, at.s_z));
        rows::vector(&mut text, "    displacement error, mm", *error_mm);
    }
    text
}
