//! `magsplice scan`: compares a measured scan with the layout.

use std::path::{Path, PathBuf};

#[cfg(feature = "report")]
use magsplice::Film;
use magsplice::FilmError;
use magsplice::prelude::DVec3;
#[cfg(feature = "report")]
use magsplice::results::FilmScan;
use magsplice::scan::{DiagnosisError, Exclusion, ScanError};
#[cfg(feature = "report")]
use magsplice_report::scan_figures;

use crate::args::fit::FitArg;
use crate::args::formats::{ResultArgs, TableFormat};
use crate::args::given_units::{GivenUnits, given_units};
use crate::failure::Failure;
use crate::faults::FaultList;
use crate::inputs::readings::{self, Readings};
#[cfg(feature = "report")]
use crate::output::folder::Folder;
use crate::output::{choice, table};
use crate::remarks;
use crate::session::Session;
use crate::text::units::in_ut;
use crate::words::no_field;

/// What was fitted, and the uniformity of the readings, as text.
pub(super) mod text;

/// Compare a measured scan of the field with the layout.
///
/// Fits the strength of the tiles, the offset (sensor and uniform stray field together), the
/// rotation of the sensor, and the start of the scan in the frame of the film, with standard
/// deviations from the residuals. Readings farther from the fit than six standard deviations are
/// excluded and listed. Missing and repeated positions are listed too. With [ideal], the uniformity
/// RMSE of the readings is printed beside the uniformity RMSE of the layout at the same points.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  magsplice scan film.toml scan.csv\n  \
    magsplice scan film.toml scan.csv --fit strength,offset --save corrected.csv")]
pub(crate) struct ScanArgs {
    /// Layout file of the film
    layout: PathBuf,
    /// Table (CSV) with columns x_mm, y_mm, z_mm and bx_mt, by_mt, bz_mt, or in other units, such
    /// as bx (uT); - is standard input
    #[arg(value_name = "TABLE")]
    scan: PathBuf,
    /// Units of columns without a unit in their names, such as uT, or mm,uT; the line of column
    /// names is still required
    #[arg(long, value_name = "UNITS", value_parser = given_units)]
    unit: Option<GivenUnits>,
    /// Parameters to fit, such as offset,start [default: all, but the strength only where errors of
    /// tiles do not look like another strength and height]
    #[arg(long, value_enum, value_delimiter = ',', value_name = "WHAT")]
    fit: Vec<FitArg>,
    /// File for a table of the readings, corrected for offset and rotation, with the field of the
    /// layout and the residuals
    #[arg(long, value_name = "TABLE")]
    save: Option<PathBuf>,
    /// Folder for figures of planes of the scan, measured beside simulated: B, and R_x, R_y, S_z
    /// (Dai 2024, Figs. 6 to 8)
    #[cfg(feature = "report")]
    #[arg(long, value_name = "FOLDER")]
    figures: Option<PathBuf>,
    #[command(flatten)]
    result: ResultArgs,
}

pub(crate) fn run(args: &ScanArgs, quiet: bool) -> Result<(), Failure> {
    let session = Session::open(&args.layout, remarks::OF_TILES, quiet)?;
    let film = session.film()?;
    let output = session.output(args.result.output.as_deref(), [&*args.scan])?;
    let save = match args.save.as_deref() {
        Some(path) => {
            let format: TableFormat = choice::choose(None, Some(path), None)?;
            choice::accept(format, Some(path), false)?;
            Some((format, session.output(Some(path), [&*args.scan])?))
        }
        None => None,
    };
    #[cfg(feature = "report")]
    let figures =
        args.figures.as_deref().map(|path| Folder::open(path, "scan", &[&args.layout, &args.scan])).transpose()?;
    let Readings { beside: points_mm, readings_t, lines, .. } =
        readings::at_positions(&session, &args.scan, args.unit.as_ref())?;
    let found = film
        .scan(&points_mm, &readings_t, &lines, (!args.fit.is_empty()).then(|| FitArg::free(&args.fit)))
        .map_err(|error| match error {
            FilmError::Scan(error @ (ScanError::Misfit { .. } | ScanError::AnotherFilm { .. })) => {
                let states_errors = film.layout().states_errors_of_tiles();
                let cause = if states_errors { "the errors of all tiles in [tolerance]" } else { "faulty tiles" };
                Failure::at(&args.scan, format!("{error}. Near the film, {cause} leave as much: try diagnose"))
            }
            error => refused(&session, &args.scan, &lines, error),
        })?;
    #[cfg(feature = "report")]
    if let Some(mut folder) = figures {
        draw(args, &film, &found, &mut folder)?;
        folder.finish()?;
    }
    session.progress.end();
    if let Some((format, mut file)) = save {
        table::write(&found.table(), &found, format, &mut file)?;
        file.finish()?;
    }
    let result = args.result.format.shown(&found, || text::scan(&film, &args.scan, &found));
    // Before the numbers that they qualify.
    for remark in found.remarks() {
        session.tell(&format!("{}: {remark}", args.scan.display()));
    }
    session.write(output, &result)?;
    tell_excluded(&session, &args.scan, &lines, &found.exclusions, &found.residuals_t);
    Ok(())
}

/// The failure of a scan: points without a field with their lines.
pub(super) fn refused(session: &Session, scan: &Path, lines: &[u64], error: FilmError) -> Failure {
    let message = match error {
        FilmError::Points(errors) => {
            let mut faults = FaultList::default();
            for error in errors.0 {
                let (line, cause) = (lines[error.index], no_field(error.cause, &session.layout));
                faults.add(line, format!("line {line}: {cause}"));
            }
            return faults.failure(scan.display());
        }
        FilmError::Scan(error @ ScanError::Unit { .. }) => {
            format!("{error}; the unit stands in the names of their columns, such as \"x (in)\"")
        }
        FilmError::Scan(error) => error.to_string(),
        FilmError::Misplaced(placement) => placement.to_string(),
        FilmError::Diagnosis(DiagnosisError::NoDerivative { tile, point: DVec3 { x, y, z } }) => format!(
            "the field of tile \"{}\" has no derivatives at ({x}, {y}, {z}) mm, must be away from its edges",
            session.layout.tiles[tile].name
        ),
        FilmError::Diagnosis(error) => error.to_string(),
        error => return session.failed(error),
    };
    Failure::at(scan, message)
}

/// Draws planes of the scan into the folder.
#[cfg(feature = "report")]
fn draw(args: &ScanArgs, film: &Film, found: &FilmScan, folder: &mut Folder) -> Result<(), Failure> {
    let drawn = scan_figures(film, found)?;
    if drawn.is_empty() {
        let message = "--figures needs positions on a grid with equal steps, and at least two positions along two axes"
            .to_owned();
        return Err(Failure::at(&args.scan, message));
    }
    for figure in &drawn {
        for (name, contents) in figure.files() {
            folder.write(&name, contents)?;
        }
    }
    Ok(())
}

/// Lists the excluded readings on standard error.
pub(super) fn tell_excluded(
    session: &Session,
    scan: &Path,
    lines: &[u64],
    exclusions: &[Option<Exclusion>],
    residuals_t: &[DVec3],
) {
    let mut faults = FaultList::default();
    for ((line, exclusion), residual_t) in lines.iter().zip(exclusions).zip(residuals_t) {
        let DVec3 { x, y, z } = in_ut(*residual_t);
        let reason = match exclusion {
            None => continue,
            Some(Exclusion::Incomplete) => "as incomplete: a component is missing".to_owned(),
            Some(Exclusion::Saturated) => "as saturated: a component is at the limit of the sensor's range".to_owned(),
            Some(Exclusion::Outlier) => format!("as an outlier, residual ({x:.1}, {y:.1}, {z:.1}) uT"),
        };
        faults.add(*line, format!("line {line}: excluded {reason}"));
    }
    if !faults.is_empty() {
        session.tell(&faults.remarks(scan.display()));
    }
}
