//! `magsplice splice`: designs a film from nothing.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use magsplice::design::{DesignError, DesignProblem, MadeFilms, SearchResult, SpliceRequest, distances_of};
use magsplice::head::Board;
use magsplice::layout::{self, Brief, FilmTolerance, Goal, StatedSensor, Under};

use super::design::search::{self, Origin};
use crate::args::formats::TextOrJson;
use crate::args::numbers::{extents_mm, flux_density_t, interval_mm, length_mm, positive, seed, whole};
use crate::args::preset::Preset;
use crate::failure::Failure;
use crate::output::destination::Output;

/// Design a film for a given wavelength, without a layout to start from.
///
/// Starts from the pattern of Dai 2024, Fig. 5: intervals one third of the wavelength wide about
/// the crests of the ideal polarization, and one sixth wide about its zeros. Then searches as
/// `design` does, with sizes, positions and directions free.
///
/// Lengths scale with the wavelength: by default the thickness is 0.1 wavelengths, the range 0.4
/// and the distance 0.3 to 0.5. The published film is two wavelengths long and wide. The film must
/// contain the crests about its middle, so it must be at least 5/6 of the wavelength long and wide.
///
/// Lengths may have a unit (mm, cm, um, m) and polarizations too (T, mT, uT, nT), such as 0.8cm,
/// 20mmx20mm, 120mT.
///
/// If the film found is useless, because its error is above a tenth of the travel of the sensor,
/// searches with one option changed at a time show which limit stands in the way, and the exit
/// status is 1. The summary ends with the errors of the film as made.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  magsplice splice --wavelength 10 --film 20x20 --parts 3 -o found.toml")]
pub(crate) struct SpliceArgs {
    /// Wavelength of the ideal film, in mm
    #[arg(long, value_name = "LENGTH", value_parser = length_mm, allow_hyphen_values = true)]
    wavelength: f64,
    /// Extent of the film along x and y, in mm, such as 20x20
    #[arg(long, value_name = "XxY", value_parser = extents_mm, allow_hyphen_values = true)]
    film: [f64; 2],
    /// Largest number of distinct parts [default: no limit]
    #[arg(long, value_name = "N", value_parser = |text: &str| whole(text, 1..=u32::MAX))]
    parts: Option<u32>,
    /// Thickness of the film, in mm [default: 0.1 of the wavelength]
    #[arg(long, value_name = "LENGTH", value_parser = length_mm, allow_hyphen_values = true)]
    thickness: Option<f64>,
    /// Polarization of every tile, in T
    #[arg(long, value_name = "POLARIZATION", value_parser = flux_density_t, allow_hyphen_values = true, default_value_t = 0.12)]
    remanence: f64,
    /// Extent of the working volume along x and y, in mm, such as 4x4: the region under the middle
    /// of the film in which the sensor moves [default: 0.4 of the wavelength each]
    #[arg(long, value_name = "XxY", value_parser = extents_mm, allow_hyphen_values = true)]
    range: Option<[f64; 2]>,
    /// Least and greatest distance of the sensor below the film, in mm, such as 3..5, or its z,
    /// such as -5..-3 [default: 0.3 and 0.5 of the wavelength]
    #[arg(long, value_name = "A..B", value_parser = distance_mm, allow_hyphen_values = true)]
    distance: Option<[f64; 2]>,
    /// Shortest side of a tile, in mm, at most a quarter of the wavelength [default: 0.08 of the
    /// wavelength]
    #[arg(long, value_name = "LENGTH", value_parser = length_mm, allow_hyphen_values = true)]
    smallest_cut: Option<f64>,
    /// Least distance between neighbouring tiles, in mm
    #[arg(long, value_name = "LENGTH", value_parser = length_mm, allow_hyphen_values = true, default_value_t = 0.0)]
    gap: f64,
    /// Sides of tiles are rounded to multiples of this, in mm. A tile centred on a mirror plane has
    /// its faces at half multiples
    #[arg(long, value_name = "LENGTH", value_parser = length_mm, allow_hyphen_values = true, default_value_t = 0.001)]
    resolution: f64,
    /// Directions of polarization are rounded to multiples of this, in degrees
    #[arg(long, value_name = "DEG", value_parser = degrees, default_value = "0.01", allow_negative_numbers = true)]
    resolution_deg: f64,
    /// Least amplitude of the field, as a fraction of the field of an ideal film with the
    /// polarization of the tiles
    #[arg(long, value_name = "FRACTION", value_parser = positive, allow_hyphen_values = true, default_value_t = 0.65)]
    amplitude: f64,
    /// Typical errors of every tile, for the table [tolerance] of the film. Without it the errors
    /// of workshop are assumed at the end, and not written
    #[arg(long, value_enum)]
    preset: Option<Preset>,
    /// Films whose error the search minimizes: as ordered, or as made with the errors of --preset,
    /// which takes several times as long
    #[arg(long, value_enum, default_value = "nominal", requires_if("tolerance", "preset"))]
    under: UnderArg,
    /// Keep errors small when flat iron comes near the upper face, at 0.1 of the wavelength: with
    /// tiles magnetized out of the plane too, for films as made with the errors of --preset and of
    /// this iron
    #[arg(long, requires = "preset")]
    one_sided: bool,
    /// Part with known noise, counts and range, for the table [sensor] of the film
    #[arg(long, value_name = "PART", ignore_case = true,
        value_parser = sensor_part())]
    sensor: Option<Box<StatedSensor>>,
    /// Board of several such sensors, read as one weighted sum, for the table [sensor] of the film
    #[arg(long, value_name = "BOARD", value_parser = board())]
    head: Option<Board>,
    /// Distance of the sensors of --head, in mm [default: half the wavelength; pair-z needs it, and
    /// reskin has its own]
    #[arg(long, value_name = "LENGTH", value_parser = length_mm, allow_hyphen_values = true, requires = "head")]
    spacing: Option<f64>,
    /// Error to minimize
    #[arg(long, value_enum, default_value = "displacement")]
    goal: GoalArg,
    /// Name of the film in its layout [default: its extent and the wavelength]
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// Number of points from which the search starts
    #[arg(long, value_name = "N", default_value = "8", value_parser = |text: &str| whole(text, 1..=10_000_u32))]
    starts: u32,
    /// Seed of the random numbers that vary the starting points
    #[arg(long, value_name = "SEED", default_value = "1", value_parser = seed)]
    seed: u64,
    /// Layout file to write, complete or not at all [default: -, standard output]
    #[arg(short, long, value_name = "LAYOUT")]
    output: Option<PathBuf>,
    /// Format of the summary
    #[arg(long, value_enum, default_value = "text")]
    format: TextOrJson,
}

impl SpliceArgs {
    /// The film asked for.
    fn request(&self) -> SpliceRequest {
        let default = SpliceRequest::new(self.wavelength, self.film);
        SpliceRequest {
            name: self.name.clone(),
            thickness_mm: self.thickness.unwrap_or(default.thickness_mm),
            remanence_t: self.remanence,
            range_mm: self.range.unwrap_or(default.range_mm),
            distance_mm: self.distance.unwrap_or(default.distance_mm),
            smallest_cut_mm: self.smallest_cut.unwrap_or(default.smallest_cut_mm),
            preset: self.preset.map(layout::Preset::from),
            one_sided: self.one_sided,
            sensor: self.sensor.as_deref().cloned(),
            head: self.head.map(|board| (board, self.spacing)),
            brief: Brief {
                gap_mm: self.gap,
                resolution_mm: self.resolution,
                resolution_deg: self.resolution_deg,
                least_amplitude: Some(self.amplitude),
                parts: self.parts.map(|parts| parts as usize),
                goal: match self.goal {
                    GoalArg::Uniformity => Goal::Uniformity,
                    GoalArg::Displacement => Goal::Displacement,
                    GoalArg::Field => Goal::Field,
                },
                under: match self.under {
                    UnderArg::Nominal => Under::Nominal,
                    UnderArg::Tolerance => Under::Tolerance,
                },
                starts: self.starts as usize,
                seed: self.seed,
                ..default.brief
            },
            ..default
        }
    }
}

#[derive(Clone, Copy, ValueEnum)]
enum GoalArg {
    /// Uniformity RMSE of R_x, R_y, S_z
    Uniformity,
    /// RMSE of the measured displacement against the true one
    Displacement,
    /// RMSE of B against the field of the ideal film times the amplitude
    Field,
}

#[derive(Clone, Copy, ValueEnum)]
enum UnderArg {
    /// The film as ordered
    Nominal,
    /// Films as made: the mean of their squared errors
    Tolerance,
}

pub(crate) fn run(args: &SpliceArgs, quiet: bool) -> Result<u8, Failure> {
    let failed = |error: DesignError| match error {
        DesignError::Contradiction(_) => {
            let way_out = "more --parts or none, a smaller --smallest-cut, --gap or --resolution, or a larger --film leaves room for \
                 the tiles of the pattern";
            Failure::at(Path::new("splice"), format!("{error}\n{way_out}"))
        }
        error => Failure::design(Path::new("splice"), error),
    };
    let request = args.request();
    let layout = request.layout().map_err(failed)?;
    let problem = DesignProblem::new(&layout).map_err(failed)?;
    let output = Output::open(args.output.as_deref(), &[])?;
    let mut result = search::search(&problem, quiet).map_err(failed)?;
    evaluate_as_made(&problem, &mut result, layout.tolerance.as_ref(), quiet);
    search::finish(&problem, result, Origin::Pattern(&request), output, args.output.as_deref(), args.format, quiet)
}

/// Errors that are assumed where the user gives none, and the number of samples with them: the
/// interval of their 95th percentile is a tenth of it wide.
const ASSUMED: (layout::Preset, u64) = (layout::Preset::Workshop, 200);

/// Adds the errors of films as made to a film that meets its requirements as ordered.
fn evaluate_as_made(problem: &DesignProblem, result: &mut SearchResult, given: Option<&FilmTolerance>, quiet: bool) {
    if result.made.is_some() || result.interrupted || !result.short_of.is_empty() {
        return;
    }
    let (preset, samples) = ASSUMED;
    let assumed = || FilmTolerance { samples, ..FilmTolerance::of_tiles(&preset.errors(), result.tiles.len()) };
    let tolerance = given.cloned().unwrap_or_else(assumed);
    match search::sampled(problem, &result.tiles, &tolerance, quiet) {
        Ok(made) => result.made = Some(MadeFilms { preset: given.is_none().then_some(preset), ..made }),
        Err(missed) => result.short_of.push(missed),
    }
}

/// Parser of the names of boards.
fn board() -> impl TypedValueParser<Value = Board> {
    let known = |name: String| Board::ALL.into_iter().find(|board| board.name() == name);
    PossibleValuesParser::new(Board::ALL.map(Board::name))
        .map(move |name| known(name).expect("clap accepts known names only"))
}

/// Parser of the names of known parts.
fn sensor_part() -> impl TypedValueParser<Value = Box<StatedSensor>> {
    // Names of values must live as long as the program.
    let names = StatedSensor::part_names().into_iter().map(|name| &*name.leak());
    PossibleValuesParser::new(names).map(|name| Box::new(part(&name)))
}

/// The sensor with one of the known names, in any case.
fn part(name: &str) -> StatedSensor {
    let known = StatedSensor::part_names().into_iter().find(|known| known.eq_ignore_ascii_case(name));
    known.as_deref().and_then(StatedSensor::of_part).expect("clap accepts known names only")
}

fn degrees(text: &str) -> Result<f64, String> {
    text.trim().parse().map_err(|_| "must be a number of degrees, such as 0.01".to_owned())
}

/// The distances of an interval of distances or, where both are negative, of z.
fn distance_mm(text: &str) -> Result<[f64; 2], String> {
    interval_mm(text).map(distances_of)
}
