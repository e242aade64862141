//! `magsplice diagnose`: the faulty tiles of a film as made.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::{Args, ValueEnum};
use magsplice::layout::TileForm;
use magsplice::prelude::DVec3;
use magsplice::results::FilmDiagnosis;
use magsplice::scan::{Diagnosis, FALSE_ALARM, ScanError};
use magsplice::sensor::Noise;
use magsplice::{Film, FilmError};
#[cfg(feature = "report")]
use magsplice_report::diagnosis_figure;

use super::scan::{refused, tell_excluded};
use crate::args::fit::FitArg;
use crate::args::given_units::{GivenUnits, given_units};
use crate::args::preset::PresetArgs;
use crate::args::readings::noise;
use crate::failure::Failure;
use crate::inputs::readings::{self, Readings};
use crate::output::destination::print;
use crate::output::{PROGRAM, json};
use crate::progress::ProgressLine;
use crate::remarks;
use crate::session::Session;

/// The faulty tiles, and what the scan does not resolve, as text.
mod text;

/// Find the weak, turned and displaced tiles of a film from a scan of its field.
///
/// The scan is of the field near the film, for example in steps of 1 mm, 1 mm below it. Each tile
/// may be weaker or stronger, turned, magnetized in another direction, or displaced. An error is
/// reported if neither the noise nor the expected errors of tiles explain it. [tolerance] or
/// --preset gives the expected errors. Without either, or with --as-ordered, other tiles count as
/// ordered. The result has each error with its standard deviation, errors that would explain the
/// scan nearly as well, and the errors that the scan does not resolve.
///
/// With -o the film found is written as a layout for `tolerance`, `decouple` and `read`.
#[derive(Args)]
#[command(after_help = "Example:\n  magsplice diagnose film.toml --scan scan.csv --noise 10uT\n  \
    magsplice diagnose film.toml --scan scan.csv --fit --preset workshop -o found.toml --figure faulty.svg")]
pub(crate) struct DiagnoseArgs {
    /// Layout file of the film as ordered
    layout: PathBuf,
    /// CSV file with columns x_mm, y_mm, z_mm and bx_mt, by_mt, bz_mt, or in other units, such as
    /// bx (uT); - is standard input
    #[arg(long, value_name = "TABLE")]
    scan: PathBuf,
    /// Units of columns without a unit in their names, such as uT, or mm,uT; the line of column
    /// names is still required
    #[arg(long, value_name = "UNITS", value_parser = given_units)]
    unit: Option<GivenUnits>,
    /// Standard deviation of a reading, such as 10uT, or of its x, y and z: 5uT,5uT,8uT [default:
    /// the noise of [sensor] in the layout]
    #[arg(long, value_name = "NOISE", value_parser = noise)]
    noise: Option<Noise>,
    #[command(flatten)]
    preset: PresetArgs,
    /// Ignore [tolerance]: other tiles count as exactly as ordered
    ///
    /// Smaller errors are then reported, and expected errors of several tiles too.
    #[arg(long, conflicts_with = "preset")]
    as_ordered: bool,
    /// Fit unknown parameters of the scan together with the errors of tiles, such as
    /// --fit=offset,start; --fit alone fits everything
    #[arg(
        long,
        value_enum,
        value_delimiter = ',',
        value_name = "WHAT",
        num_args = 0..,
        require_equals = true,
        default_missing_value = "all"
    )]
    fit: Vec<FitArg>,
    /// Probability that a tile of a fault-free film is reported
    #[arg(long, value_name = "P", default_value_t = FALSE_ALARM, value_parser = probability)]
    false_alarm: f64,
    /// Layout file to write, with the tiles found
    #[arg(short, long, value_name = "LAYOUT")]
    output: Option<PathBuf>,
    /// File for a figure of the faulty tiles and of the resolution of the scan: .pdf, .svg or
    /// .png
    #[cfg(feature = "report")]
    #[arg(long, value_name = "FIGURE")]
    figure: Option<PathBuf>,
    /// Format of the result
    #[arg(long, value_enum, default_value = "text")]
    format: DiagnoseFormat,
}

/// Formats of `diagnose`.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(crate) enum DiagnoseFormat {
    Text,
    Json,
    /// One line for each component of each error
    Csv,
}

pub(crate) fn run(args: &DiagnoseArgs, quiet: bool) -> Result<(), Failure> {
    let progress = ProgressLine::start_search(!quiet);
    let mut session = Session::begin(&args.layout, remarks::OF_TILES, quiet, progress)?;
    let original = session.layout.clone();
    let remark = args.preset.apply(Arc::make_mut(&mut session.layout), &args.layout)?;
    remark.iter().for_each(|remark| session.tell(remark));
    if args.as_ordered {
        Arc::make_mut(&mut session.layout).tolerance = None;
    }
    let found_file = args.output.as_deref().map(|path| session.output(Some(path), [&*args.scan])).transpose()?;
    #[cfg(feature = "report")]
    let figure = session.figure(args.figure.as_deref(), [&*args.scan])?;
    // A scan without noise is refused before its file is read.
    let known = Film::rigid(session.layout.clone()).scan_noise_t(args.noise);
    known.map_err(|_| session.no_noise("--noise, such as 10uT"))?;
    let Readings { beside: points_mm, readings_t, lines, .. } =
        readings::at_positions(&session, &args.scan, args.unit.as_ref())?;
    let element = session.layout.sensor.as_ref().map(|sensor| sensor.as_one()).unwrap_or_default();
    if element.plates != [DVec3::ZERO; 3] || element.active_area != [0.0; 2] {
        let layout = args.layout.display();
        session.tell(&format!("{layout}: the plates of [sensor] count as points at the positions of the scan"));
    }
    let film = session.film()?;
    let found = film
        .diagnose(&points_mm, &readings_t, &lines, args.noise, FitArg::free(&args.fit), args.false_alarm)
        .map_err(|error| match error {
        FilmError::Scan(error @ ScanError::Misfit { .. }) if args.fit.is_empty() => {
            let advice = "; errors of every tile are expected with --preset, such as by-hand, and --fit fits strength, \
                 offset and place of a scan that was taken otherwise than stated";
            Failure::at(&args.scan, format!("{error}{advice}"))
        }
        error => refused(&session, &args.scan, &lines, error),
    })?;
    session.progress.end();
    if let Some(file) = found_file.filter(|_| !found.is_rejected) {
        let scan = args.scan.file_name().map_or_else(|| "a scan".into(), |name| name.to_string_lossy());
        let layout = found.found_layout(&original, &scan, &format!("{PROGRAM} diagnose"));
        let folder = args.output.as_deref().and_then(Path::parent).unwrap_or(Path::new(""));
        let origin = format!("the film of {}", args.scan.display());
        let text = layout.to_edited_toml(TileForm::Plain, folder, &origin)?;
        file.complete(&text)?;
    }
    #[cfg(feature = "report")]
    if let Some(file) = figure {
        file.write(diagnosis_figure(&session.layout, &found))?;
    }
    let result = match args.format {
        DiagnoseFormat::Text => text::diagnosis(&film, &args.scan, FitArg::free(&args.fit), &found),
        DiagnoseFormat::Json => json::pretty(&found),
        DiagnoseFormat::Csv => csv(&found),
    };
    // A layout on standard output leaves no room for anything else.
    if args.output.as_deref() != Some(Path::new("-")) {
        print(&result)?;
    }
    let Diagnosis { exclusions, residuals_t, .. } = &found.diagnosis;
    tell_excluded(&session, &args.scan, &lines, exclusions, residuals_t);
    for remark in found.remarks() {
        let advice = match (found.made_as, found.is_residual_too_large && args.fit.is_empty()) {
            (Some(preset), _) => format!("; --preset {} expects them", preset.name()),
            (None, _) if found.explained_by.is_some() => "; --fit fits them".to_owned(),
            (None, true) => {
                "; --preset expects other errors, --fit fits the strength, the offset and the place of the scan"
                    .to_owned()
            }
            (None, false) => String::new(),
        };
        session.tell(&format!("{}: {remark}{advice}", args.scan.display()));
    }
    if found.is_rejected && args.output.is_some() {
        let message = match found.made_as {
            Some(_) => "errors of every tile explain the scan, so no layout is written without --preset",
            None => "errors of tiles do not explain the scan, so no layout is written",
        };
        return Err(Failure::at(&args.scan, message.to_owned()));
    }
    Ok(())
}

/// One line for each component of each error.
fn csv(found: &FilmDiagnosis) -> String {
    let mut csv = "tile,kind,component,value,deviation,chi_squared\n".to_owned();
    for faulty in &found.faulty {
        for (error, [value, deviation]) in &faulty.components {
            csv += &format!(
                "\"{}\",{},{},{value:?},{deviation:?},{:?}\n",
                faulty.tile.replace('"', "\"\""),
                faulty.kind.name(),
                error.key(),
                faulty.chi_squared
            );
        }
    }
    csv
}

fn probability(text: &str) -> Result<f64, String> {
    let value: Option<f64> = text.parse().ok().filter(|value| *value > 0.0 && *value < 1.0);
    value.ok_or_else(|| "must be a number greater than 0 and less than 1, such as 0.01".to_owned())
}
