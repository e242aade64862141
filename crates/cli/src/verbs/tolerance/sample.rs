//! `magsplice tolerance sample`: one film as made, and its scan.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;
use magsplice::Film;
use magsplice::layout::TileForm;
use magsplice::results::{Points, SampledScan};
use magsplice::scan::FreeParameters;

use super::sampling::{require_tolerance, sample_number, sampling_failure};
use crate::args::formats::{TableFormat, TextOrJson};
use crate::args::numbers::seed;
use crate::args::points::PointsArgs;
use crate::args::preset::PresetArgs;
use crate::failure::{self, Failure};
use crate::inputs::points;
use crate::output::destination::{is_standard, print};
use crate::output::{PROGRAM, choice, table};
use crate::remarks;
use crate::session::Session;
use crate::text::number::counted;
use crate::text::{header, rows};
use crate::verbs::scan::text::fitted;

/// Memory in bytes that a scan takes at each of its points. Measured: 167.
const BYTES_AT_POINT: f64 = 168.0;

/// Write one sample: the film as made as a layout, and the readings of its sensor as a scan.
///
/// The scan has what the sensor of the layout reads at the points: with the errors of the sample,
/// with noise, rounded to counts, and limited to the range of [sensor]. `magsplice scan` and
/// `magsplice diagnose` read it. The noise is the noise of [tolerance.sensor], or if it has none,
/// the noise of [sensor]. Fields and changes of temperature after the reading at the reference
/// point are present. The result has the parameters that `scan` should find with the film as made.
#[derive(Args)]
#[command(
    after_help = "Example:\n  magsplice tolerance sample layouts/published-film.toml --preset workshop --index 7 \
    --scan scan.csv -o made.toml\n  magsplice scan made.toml scan.csv"
)]
pub(super) struct SampleArgs {
    /// Layout file of the film as ordered
    layout: PathBuf,
    #[command(flatten)]
    preset: PresetArgs,
    /// Index of the sample, counted from 0
    #[arg(long, value_name = "K", default_value = "0", value_parser = sample_number)]
    index: u64,
    /// Seed of the random numbers [default: the value of [tolerance], else 1]
    #[arg(long, value_name = "SEED", value_parser = seed)]
    seed: Option<u64>,
    #[command(flatten)]
    points: PointsArgs,
    /// File for the scan: .csv for `scan` and `diagnose`, or another format by its ending
    #[arg(long, value_name = "TABLE")]
    scan: Option<PathBuf>,
    /// Layout file to write, with the tiles as made
    #[arg(short, long, value_name = "LAYOUT")]
    output: Option<PathBuf>,
    /// Format of the result
    #[arg(long, value_enum, default_value = "text")]
    format: TextOrJson,
}

pub(super) fn run(args: &SampleArgs, quiet: bool) -> Result<(), Failure> {
    let mut session = Session::open_with_points(&args.layout, args.points.path(), remarks::OF_TILES, quiet)?;
    let original = session.layout.clone();
    let remark = args.preset.apply(Arc::make_mut(&mut session.layout), &args.layout)?;
    remark.iter().for_each(|remark| session.tell(remark));
    require_tolerance(&session)?;
    let (made_file, scan_file) = (args.output.as_deref(), args.scan.as_deref());
    let made = made_file.map(|path| session.output(Some(path), args.points.path())).transpose()?;
    let scan = match scan_file {
        Some(path) => {
            let format: TableFormat = choice::choose(None, Some(path), Some(TableFormat::Csv))?;
            choice::accept(format, Some(path), false)?;
            Some((format, session.output(Some(path), args.points.path())?))
        }
        None => None,
    };
    let takes_output = [made_file, scan_file].map(|path| path.is_some_and(is_standard));
    if takes_output == [true; 2] {
        let message = "-o and --scan are both standard output: give a file for one of them";
        return Err(Failure::Refused(message.to_owned()));
    }
    let (points, place) = points::given(&session, &args.points)?;
    if let (Points::Grid(_), Some(volume)) = (&points, &session.layout.volume) {
        volume.check_memory(BYTES_AT_POINT).map_err(|error| Failure::at(session.path, error))?;
    }
    let film = session.film()?;
    let seed = args.seed.or(film.layout().tolerance.as_ref().map(|stated| stated.seed)).unwrap_or(1);
    let found = film.sampled_scan(points.iter().collect(), seed, args.index);
    let found = found.map_err(|error| sampling_failure(&session, error))?;
    session.progress.end();
    if let Some(file) = made {
        let layout = found.made_layout(&original, &format!("{PROGRAM} tolerance sample"));
        let folder = made_file.and_then(Path::parent).unwrap_or(Path::new(""));
        let origin = format!("sample {} of {}", args.index, args.layout.display());
        file.complete(&layout.to_edited_toml(TileForm::Plain, folder, &origin)?)?;
    }
    if let Some((format, mut file)) = scan {
        table::write(&found.table(), &found, format, &mut file)?;
        file.finish()?;
    }
    let result = args.format.shown(&found, || text(&film, &found, &place));
    if takes_output == [false; 2] {
        print(&result)?;
    } else if !quiet {
        failure::print_escaped(&result);
    }
    Ok(())
}

/// The sample, and the parameters of its scan at the points of `place`.
fn text(film: &Film, found: &SampledScan, place: &str) -> String {
    let mut text = header::with_recoil(film);
    let readings = counted(found.readings, "reading", "readings");
    let _ = write!(text, "sample {}, seed {}: {readings} at {place}", found.sample, found.seed);
    if found.saturated > 0 {
        let _ = write!(text, ", {} at the limit of the sensor's range", found.saturated);
    }
    text += "\n\n";
    rows::heading(&mut text, "parameters of the scan", ["x", "y", "z"]);
    fitted(&mut text, FreeParameters::ALL, &found.scan, None);
    text
}
