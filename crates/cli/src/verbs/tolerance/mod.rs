//! `magsplice tolerance`: samples of films as made.

use std::error::Error;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;

use clap::{Args, Subcommand};
use magsplice::decouple::Figures;
use magsplice::layout::Layout;
use magsplice::making::Sorting;
use magsplice::results::{FilmSampling, SampleRun, SampledFilm, in_stretches};
use magsplice::{Film, Stage};

use crate::args::formats::ResultArgs;
use crate::args::numbers::{seed, whole};
use crate::args::preset::PresetArgs;
use crate::args::sorting::SortingArgs;
use crate::failure::Failure;
use crate::interrupt::{self, INTERRUPTED};
use crate::output::choice;
use crate::output::destination::Output;
use crate::progress::ProgressLine;
use crate::remarks;
use crate::session::Session;

/// The journal of a run: every sample as soon as it is known.
mod journal;
/// One film as made, and its scan.
mod sample;
/// Tables of the figures of samples.
mod sample_file;
/// The errors that films as made need, and failures.
pub(super) mod sampling;
/// Statistics of samples as tables.
pub(super) mod text;

use journal::Journal;
use sample::SampleArgs;
use sample_file::{MAX_SAMPLES, SampleFormat};
use sampling::{require_errors, sample_number, sampling_failure};

/// Evaluate films as made: random samples with the errors of the table [tolerance].
///
/// Each sample is a film whose tiles are misplaced, turned, cut to wrong sizes, and of wrong
/// strength and direction. The surroundings and the sensor also have the errors of [tolerance]. The
/// exact field gives the uniformity RMSE, the displacement RMSE and the amplitude. The result has
/// their mean and percentiles with intervals of 95 % confidence, and the yield: the share of the
/// films that keep the bounds of [expect.made]. Bounds of [expect] are for the film as ordered.
///
/// Sample i depends on the seed and on i alone, so that machines can share the work: see --first.
/// Ctrl-C ends the run with the result so far.
///
/// With --sorted the tiles of each sample are cut, measured and assigned as by `magsplice assign`,
/// before they are placed with the errors of position and rotation; this shows the benefit of
/// measuring. Errors of groups belong to the places, and stay there whichever tiles are placed.
#[derive(Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
#[command(after_help = "Example:\n  magsplice tolerance layouts/robust-in-plane.toml --samples 10000\n  \
    magsplice tolerance layouts/published-film.toml --preset workshop\n  \
    magsplice tolerance layouts/designed-stock.toml --preset jig --sorted --spares 14 --strength-error 0.5% \
    --direction-error 0.3deg --samples 200\n  \
    magsplice tolerance film.toml --samples 100000 --first 25000 --count 25000 --save part-2.csv\n  \
    magsplice tolerance merge film.toml part-*.csv --save samples.parquet\n  \
    magsplice tolerance sample film.toml --index 7 --scan scan.csv -o made.toml")]
pub(crate) struct ToleranceArgs {
    #[command(subcommand)]
    verb: Option<ToleranceVerb>,
    /// Layout file
    #[arg(required = true)]
    layout: Option<PathBuf>,
    #[command(flatten)]
    preset: PresetArgs,
    /// Number of samples [default: the value of [tolerance], else 1000]
    #[arg(long, value_name = "N", value_parser = |text: &str| whole(text, 1..=MAX_SAMPLES))]
    samples: Option<u64>,
    /// Seed of the random numbers [default: the value of [tolerance], else 1]
    #[arg(long, value_name = "SEED", value_parser = seed)]
    seed: Option<u64>,
    /// Index of the first sample, counted from 0, to compute a part of the samples
    #[arg(long, value_name = "N", default_value = "0", value_parser = sample_number)]
    first: u64,
    /// Number of samples of the part [default: all from the first on]
    #[arg(long, value_name = "N", value_parser = |text: &str| whole(text, 1..=MAX_SAMPLES))]
    count: Option<u64>,
    /// Continue a run that was interrupted or killed, from its file FILE.partial beside --save
    #[arg(long, requires = "save")]
    resume: bool,
    #[command(flatten)]
    result: ToleranceResultArgs,
    #[command(flatten)]
    sorting: SortingArgs,
}

/// Where the result of samples goes.
#[derive(Args)]
struct ToleranceResultArgs {
    /// File for the results of every sample: .csv, .npz or .parquet; parts of a run must be .csv
    #[arg(long, value_name = "TABLE")]
    save: Option<PathBuf>,
    #[command(flatten)]
    text: ResultArgs,
}

#[derive(Subcommand)]
enum ToleranceVerb {
    Merge(MergeArgs),
    Sample(SampleArgs),
}

/// Join parts of the samples of a layout. The result equals a single run to the last bit.
#[derive(Args)]
struct MergeArgs {
    /// Layout file that the parts were computed from
    layout: PathBuf,
    /// Files that `tolerance --save` wrote, in any order
    #[arg(required = true, value_name = "PART")]
    parts: Vec<PathBuf>,
    #[command(flatten)]
    preset: PresetArgs,
    #[command(flatten)]
    result: ToleranceResultArgs,
    #[command(flatten)]
    sorting: SortingArgs,
}

pub(crate) fn run(args: &ToleranceArgs, quiet: bool) -> Result<u8, Failure> {
    match &args.verb {
        Some(ToleranceVerb::Merge(args)) => return merge(args, quiet).map(|()| 0),
        Some(ToleranceVerb::Sample(args)) => return sample::run(args, quiet).map(|()| 0),
        None => {}
    }
    let path = args.layout.as_deref().unwrap_or(Path::new(""));
    let mut session = Session::begin(path, remarks::OF_COMPARISONS, quiet, ProgressLine::start_search(!quiet))?;
    let remark = args.preset.apply(Arc::make_mut(&mut session.layout), path)?;
    remark.iter().for_each(|remark| session.tell(remark));
    require_errors(&session)?;
    let film = session.film()?;
    let sampling = film.sampling().map_err(|error| session.failed(error))?;
    let tolerance = film.layout().tolerance.as_ref();
    let total = args.samples.or(tolerance.map(|t| t.samples)).unwrap_or(1);
    let seed = args.seed.or(tolerance.map(|t| t.seed)).unwrap_or(1);
    let sorting = args.sorting.sorting()?;
    let run = sample_run(film.layout(), sorting.as_ref(), seed, args.first, part(args, total)?);
    let outputs = Outputs::open(&args.result, &session, &[])?;
    let journal = match &args.result.save {
        Some(save) => Some(Journal::open(save, &run, args.resume)?),
        None => None,
    };
    let (mut journal, mut samples) = journal.map_or((None, Vec::new()), |(journal, samples)| (Some(journal), samples));

    let stop = interrupt::defer();
    let keep = |found: &[Figures]| {
        journal.as_mut().map_or(Ok(()), |journal| journal.append(found))?;
        Ok(if stop.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    };
    draw(&session, &sampling, &run, sorting, &mut samples, keep)?;
    session.progress.end();
    if samples.is_empty() {
        return Ok(INTERRUPTED);
    }
    let found = SampleRun { count: samples.len() as u64, ..run.clone() };
    let result = sampling.statistics(found, sorting, &samples).map_err(|error| sampling_failure(&session, error))?;
    if result.run.count < run.count {
        outputs.finish_result(&film, &result)?;
        let so_far = format!("interrupted after {} of {} samples", result.run.count, run.count);
        session.tell(&match &journal {
            Some(journal) => format!("{so_far}, which are kept in {}: --resume continues", journal.path().display()),
            None => so_far,
        });
        return Ok(INTERRUPTED);
    }
    outputs.finish(&film, &result, &samples)?;
    if let Some(journal) = journal {
        journal.remove()?;
    }
    Ok(0)
}

/// Appends the samples of a run that are not among `samples` yet. `keep` takes each stretch of
/// them, and may end the run.
pub(super) fn draw(
    session: &Session,
    sampling: &FilmSampling,
    run: &SampleRun,
    sorting: Option<Sorting>,
    samples: &mut Vec<Figures>,
    mut keep: impl FnMut(&[Figures]) -> Result<ControlFlow<()>, Failure>,
) -> Result<(), Failure> {
    let failed = |error| sampling_failure(session, error);
    let sampler = sampling.sampler(run.seed).map_err(failed)?;
    let sorted = sorting.map(|sorting| sampling.sorted_sampler(&sampler, sorting)).transpose().map_err(failed)?;
    let of_sample = |sample, error: &dyn Error| Failure::at(session.path, format_args!("sample {sample}: {error}"));
    let evaluate = |numbers| match &sorted {
        Some(sorted) => sorted.errors_of_range(numbers).map_err(|(sample, error)| of_sample(sample, &error)),
        None => sampler.errors_of_range(numbers, || {}).map_err(|(sample, error)| of_sample(sample, &error)),
    };
    let of = Some(run.count as usize);
    let show = |done| session.progress.show(Stage { name: "films", done, of, unit: "samples" });
    show(samples.len());
    let left = run.first + samples.len() as u64..run.range().end;
    in_stretches(left, rayon::current_num_threads(), evaluate, |found| {
        let goes_on = keep(&found)?;
        samples.extend(found);
        show(samples.len());
        Ok(goes_on)
    })
}

pub(super) fn sample_run(layout: &Layout, sorting: Option<&Sorting>, seed: u64, first: u64, count: u64) -> SampleRun {
    SampleRun { film: layout.sample_fingerprint(&sorting), seed, first, count }
}

/// The number of samples to compute from the first on.
fn part(args: &ToleranceArgs, total: u64) -> Result<u64, Failure> {
    let first = args.first;
    let beyond = |what: String| Failure::Refused(format!("{what}, of {total} samples: give a larger --samples"));
    if first >= total {
        return Err(beyond(format!("--first {first} is beyond the last sample")));
    }
    match args.count {
        Some(count) if first + count > total => {
            Err(beyond(format!("--first {first} --count {count} ends beyond the last sample")))
        }
        count => Ok(count.unwrap_or(total - first)),
    }
}

/// `tolerance merge`: joins parts.
fn merge(args: &MergeArgs, quiet: bool) -> Result<(), Failure> {
    let mut session = Session::open(&args.layout, remarks::OF_COMPARISONS, quiet)?;
    let remark = args.preset.apply(Arc::make_mut(&mut session.layout), &args.layout)?;
    remark.iter().for_each(|remark| session.tell(remark));
    require_errors(&session)?;
    let film = session.film()?;
    let sampling = film.sampling().map_err(|error| session.failed(error))?;
    let outputs = Outputs::open(&args.result, &session, &args.parts)?;
    let sorting = args.sorting.sorting()?;
    session.progress.show(Stage::uncounted("reading the parts"));
    let mut parts = Vec::new();
    for path in &args.parts {
        let part = sample_file::read(path)?;
        let refused = |message: String| Err(Failure::at(path, message));
        if part.run.film != sample_run(film.layout(), sorting.as_ref(), 0, 0, 0).film {
            return refused(format!(
                "its samples have another film, other errors or other options of --sorted than {} has now",
                args.layout.display()
            ));
        }
        if (part.samples.len() as u64) < part.run.count {
            let (have, of) = (part.samples.len(), part.run.count);
            return refused(format!("has {have} of its {of} samples: its run has not ended"));
        }
        parts.push((path, part));
    }
    parts.sort_by_key(|(_, part)| part.run.first);
    let mut samples: Vec<Figures> = Vec::new();
    let run = parts.first().map(|(_, part)| part.run.clone()).expect("at least one part is required");
    for (path, part) in parts {
        let refused = |message: String| Err(Failure::at(path, message));
        if part.run.seed != run.seed {
            return refused(format!("has seed {}, another part has seed {}", part.run.seed, run.seed));
        }
        let next = run.first + samples.len() as u64;
        let first = part.run.first;
        if first > next {
            return refused(format!("begins with sample {first}: samples {next} to {} are in no part", first - 1));
        }
        if first < next {
            return refused(format!("begins with sample {first}, which another part has too"));
        }
        samples.extend(part.samples);
        if samples.len() as u64 > MAX_SAMPLES {
            return refused(format!("all parts together have more than {MAX_SAMPLES} samples"));
        }
    }
    let run = SampleRun { count: samples.len() as u64, ..run };
    let result = sampling.statistics(run, sorting, &samples).map_err(|error| sampling_failure(&session, error))?;
    session.progress.end();
    outputs.finish(&film, &result, &samples)
}

/// Where the result and the figures of samples go.
struct Outputs<'a> {
    args: &'a ToleranceResultArgs,
    result: Output,
    samples: Option<(SampleFormat, Output)>,
}

impl<'a> Outputs<'a> {
    /// Opens the files, so that one that cannot be written is refused before any work.
    fn open(args: &'a ToleranceResultArgs, session: &Session, inputs: &[PathBuf]) -> Result<Outputs<'a>, Failure> {
        let inputs = || inputs.iter().map(PathBuf::as_path);
        let samples = match args.save.as_deref() {
            Some(save) => {
                let format = choice::choose(None, Some(save), None)?;
                if format == SampleFormat::Parquet && cfg!(not(feature = "parquet")) {
                    return Err(Failure::Refused(choice::WITHOUT_PARQUET.to_owned()));
                }
                Some((format, session.output(Some(save), inputs())?))
            }
            None => None,
        };
        Ok(Outputs { args, result: session.output(args.text.output.as_deref(), inputs())?, samples })
    }

    fn finish(mut self, film: &Film, result: &SampledFilm, samples: &[Figures]) -> Result<(), Failure> {
        if let Some((format, mut output)) = self.samples.take() {
            sample_file::write(result, samples, format, &mut output)?;
            output.finish()?;
        }
        self.finish_result(film, result)
    }

    /// Writes the result alone.
    fn finish_result(self, film: &Film, result: &SampledFilm) -> Result<(), Failure> {
        let text = self.args.text.format.shown(result, || text::sampled(film, result));
        self.result.complete(&text)
    }
}
