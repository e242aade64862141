//! `magsplice read`: displacements of the sensor from its readings.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use magsplice::prelude::DVec3;
use magsplice::results::{AtRest, FilmReadings, HeadFits};
use magsplice::sensor::{HeadUnknowns, Noise};
use magsplice::{Film, FilmError};

use crate::args::formats::TableFormat;
use crate::args::given_units::{GivenUnits, given_units};
use crate::args::numbers::whole;
use crate::args::readings::noise;
use crate::failure::Failure;
use crate::faults::FaultList;
use crate::inputs::readings::{self, Readings};
use crate::output::{choice, table};
use crate::remarks;
use crate::session::{OF_SENSORS, Session};

/// Find the displacement of the sensor from its readings of the flux density.
///
/// The displacement is from the reference point of the working volume, in the frame of the film.
/// The film has moved by the opposite. The displacement is computed from the exact field of the
/// layout, so that it does not contain the error of the splicing pattern and of the end of the
/// film. With [ideal] the result also has the displacement by the closed form of the ideal film
/// (Dai 2024, Eqs. 14 and 15), and with --noise the standard deviations that noise causes.
///
/// Readings without a position in the working volume, or with two, are listed on standard error.
/// The displacement is NaN where there are two positions or none. The column `status` is 0 for a
/// position in the volume, 1 for one outside by more than four deviations of the noise, 2 for two
/// positions, 3 for none, 4 for a reading at the limit of the sensor's range, 5 for a missing
/// component, and 6 where the sensors of a head contradict each other.
///
/// With [sensor] in the layout, the readings are from this sensor, with its plates, gains, offsets
/// and rotation, and --noise defaults to its noise. With [elastomer], the result has the force on
/// the film.
///
/// With a head, a row has the weighted sum of its sensors, or a reading of each: bx1_t, by1_t,
/// bz1_t, bx2_t and so on, in the order of the head and counted from 0 or 1. Position and stray
/// field are then fitted to all of them, and a residual beyond the noise, but for 1 in 1000, is
/// remarked on.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  magsplice read film.toml readings.csv --noise 5uT -o moved.csv")]
pub(crate) struct ReadArgs {
    /// Layout file of the film
    layout: PathBuf,
    /// Table (CSV) with columns bx_t, by_t, bz_t, or bx (mT), ...; - is standard input
    #[arg(value_name = "TABLE")]
    readings: PathBuf,
    /// Standard deviation of a reading, such as 5uT, or of its x, y and z: 5uT,5uT,8uT [default:
    /// the noise of [sensor] in the layout]
    #[arg(long, value_name = "NOISE", value_parser = noise)]
    noise: Option<Noise>,
    /// The first N readings are of the sensor at rest at the reference point: their mean, less the
    /// field of the film there, is subtracted from all
    ///
    /// A constant stray field and the offset of the sensor then have no effect.
    #[arg(long, value_name = "N", default_value = "0", value_parser = |text: &str| whole(text, 0..=usize::MAX))]
    zero: usize,
    /// The first N readings are of the sensor at rest: displacements count from the position of
    /// their mean, not from the reference point
    ///
    /// The film may then lie elsewhere than in the layout. A constant field moves all positions.
    #[arg(long, value_name = "N", default_value = "0", conflicts_with = "zero",
        value_parser = |text: &str| whole(text, 0..=usize::MAX))]
    rest: usize,
    /// Numbers that are fitted to the readings of all sensors of a head [default: stray-field]
    #[arg(long, value_enum, value_name = "WHAT")]
    fit: Option<HeadFitArg>,
    /// Unit of columns named bx, by, bz without a unit, such as uT, G or counts of [sensor]; the
    /// line of column names is still required
    #[arg(long, value_name = "UNIT", value_parser = given_units)]
    unit: Option<GivenUnits>,
    /// File to write, complete or not at all [default: -, standard output]
    #[arg(short, long, value_name = "TABLE")]
    output: Option<PathBuf>,
    /// Format of the result [default: by the file's ending, else csv]
    #[arg(long, value_enum)]
    format: Option<TableFormat>,
}

/// Numbers that are fitted to the readings of a head.
#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum HeadFitArg {
    /// The position
    Position,
    /// The position and a uniform stray field: two sensors
    StrayField,
    /// The position, a uniform stray field, and tilts and turn of the board: three sensors
    Pose,
}

impl HeadFitArg {
    const fn unknowns(self) -> HeadUnknowns {
        match self {
            HeadFitArg::Position => HeadUnknowns::Position,
            HeadFitArg::StrayField => HeadUnknowns::StrayField,
            HeadFitArg::Pose => HeadUnknowns::Pose,
        }
    }
}

pub(crate) fn run(args: &ReadArgs, quiet: bool) -> Result<(), Failure> {
    let session = Session::open(&args.layout, remarks::OF_FIELDS, quiet)?;
    let film = session.film()?;
    session.volume(OF_SENSORS)?;
    let format = choice::choose_rows(args.format, args.output.as_deref(), "readings")?;
    let mut output = session.output(args.output.as_deref(), [&*args.readings])?;
    let readings = readings::alone(&session, &args.readings, args.unit.as_ref())?;
    if readings.sensors == 1 && args.fit.is_some() {
        let message = "--fit needs a reading of each sensor of the head: bx1, by1, bz1, bx2, ...";
        return Err(Failure::at(&args.readings, message.to_owned()));
    }
    let fitted = args.fit.unwrap_or(HeadFitArg::StrayField);
    let found = located(&session, &film, &args.readings, &readings, [args.zero, args.rest], args.noise, fitted)?;
    let lines = readings.lines;
    table::write(&found.table(&args.readings.display().to_string()), &found, format, &mut output)?;
    output.finish()?;
    session.progress.end();
    let faults = unlocated(&found, &lines);
    if !faults.is_empty() {
        session.tell(&faults.remarks(args.readings.display()));
    }
    for remark in found.of_head.iter().flat_map(HeadFits::remarks).chain(found.hint.clone()) {
        session.tell(&format!("{}: {remark}", args.readings.display()));
    }
    Ok(())
}

/// The positions of the readings in `file`. At its beginning are readings at rest: those of
/// `--zero` and `--rest`, one of which is 0.
pub(super) fn located(
    session: &Session,
    film: &Film,
    file: &Path,
    readings: &Readings,
    [zero, rest]: [usize; 2],
    noise: Option<Noise>,
    fitted: HeadFitArg,
) -> Result<FilmReadings, Failure> {
    let refused = |message: String| Failure::at(file, message);
    let option = if rest > 0 { "--rest" } else { "--zero" };
    let Readings { readings_t, sensors, lines, .. } = readings;
    let first = |count: usize| {
        let too_few = || refused(format!("has {} readings, fewer than the {count} of {option}", lines.len()));
        readings_t.get(..sensors.saturating_mul(count)).ok_or_else(too_few)
    };
    let at_rest = match (zero, rest) {
        (0, 0) => AtRest::Constant(DVec3::ZERO),
        (zero, 0) => AtRest::Zero(first(zero)?),
        (_, rest) => AtRest::Rest(first(rest)?),
    };
    session.volume(OF_SENSORS)?;
    let found = match sensors {
        1 => film.read(readings_t, at_rest, noise),
        _ => film.read_sensors(readings_t, at_rest, noise, fitted.unknowns()),
    };
    found.map_err(|error| match error {
        FilmError::AtRest(error) => refused(format!("the mean of the readings of {option}: {error}")),
        FilmError::HeadLocator(error) => refused(format!("{error}, by another --fit")),
        error => session.failed(error),
    })
}

/// The readings without a position in the volume, with their lines.
pub(super) fn unlocated(readings: &FilmReadings, lines: &[u64]) -> FaultList {
    let mut faults = FaultList::default();
    for (found, line) in readings.found.iter().zip(lines) {
        if let Err(error) = found {
            faults.add(*line, format!("line {line}: {error}"));
        }
    }
    faults
}
