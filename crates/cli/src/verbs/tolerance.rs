//! `magsplice tolerance`: samples of the films that are made from a layout.

use std::path::{Path, PathBuf};

use magsplice::Stage;
use magsplice::decouple::Figures;

use crate::args::formats::TextOrJson;
use crate::args::tolerance::{MAX_SAMPLES, MergeArgs, SampleFormat, ToleranceArgs, ToleranceResultArgs, ToleranceVerb};
use crate::failure::{self, Failure};
use crate::interrupt::{self, INTERRUPTED};
use crate::output::choice;
use crate::output::destination::Output;
use crate::progress::ProgressLine;
use crate::sampling::journal::Journal;
use crate::sampling::run::SamplingRun;
use crate::sampling::sample_file;
use crate::sampling::sampled_film::SampledFilm;
use crate::sampling::scene::SampledScene;
use crate::sampling::source::SampleSource;
use crate::{json, remarks, text};

pub(crate) fn run(args: &ToleranceArgs, quiet: bool) -> Result<u8, Failure> {
    if let Some(ToleranceVerb::Merge(args)) = &args.merge {
        return merge(args, quiet).map(|()| 0);
    }
    let path = args.layout.as_deref().unwrap_or(Path::new(""));
    let progress = ProgressLine::start_search(!quiet);
    let mut layout = remarks::read_layout(path, remarks::OF_COMPARISONS, quiet, &progress)?;
    args.preset.apply(&mut layout);
    let scene = SampledScene::new(path, &layout, &progress, &remarks::teller(quiet, &progress))?;
    let tolerance = layout.tolerance.as_ref();
    let total = args.samples.or(tolerance.map(|t| t.samples)).unwrap_or(1);
    let seed = args.seed.or(tolerance.map(|t| t.seed)).unwrap_or(1);
    let sorting = args.sorting.sorting()?;
    let source = SampleSource::new(&layout, sorting.as_ref(), seed, args.first, part(args, total)?);
    let outputs = Outputs::open(&args.result, &[path.to_owned()])?;
    let journal = match &args.result.save {
        Some(save) => Some(Journal::open(save, &source, args.resume)?),
        None => None,
    };
    let (mut journal, mut errors) = journal.map_or((None, Vec::new()), |(journal, errors)| (Some(journal), errors));

    let stop = interrupt::defer();
    let sampler = scene.sampler(seed)?;
    let sorted = sorting.map(|sorting| scene.sorted_sampler(&sampler, sorting)).transpose()?;
    let errors_of = |samples| match &sorted {
        Some(sorted) => sorted.errors_of_range(samples).map_err(|(sample, error)| scene.sample_failure(sample, &error)),
        None => sampler.errors_of_range(samples).map_err(|(sample, error)| scene.sample_failure(sample, &error)),
    };
    let run = SamplingRun { errors_of: &errors_of, source: &source };
    let keep = |found: &[Figures]| journal.as_mut().map_or(Ok(()), |journal| journal.append(found));
    run.extend(&mut errors, keep, &progress, Some(stop))?;
    progress.end();
    let interrupted = (errors.len() as u64) < source.count;
    if errors.is_empty() {
        return Ok(INTERRUPTED);
    }
    let found = SampleSource { count: errors.len() as u64, ..source.clone() };
    let film = SampledFilm::new(&scene, found, &errors)?.sorted(sorting);
    if interrupted {
        outputs.finish_result(&film)?;
        tell_interrupted(&film, &source, journal.as_ref(), quiet);
        return Ok(INTERRUPTED);
    }
    outputs.finish(&film, &errors)?;
    if let Some(journal) = journal {
        journal.remove()?;
    }
    Ok(0)
}

/// The number of samples to compute from the first on.
fn part(args: &ToleranceArgs, total: u64) -> Result<u64, Failure> {
    let first = args.first;
    let beyond = |what: String| Failure::Format(format!("{what}, of {total} samples: give a larger --samples"));
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

fn tell_interrupted(film: &SampledFilm, source: &SampleSource, journal: Option<&Journal>, quiet: bool) {
    if quiet {
        return;
    }
    let so_far = format!("interrupted after {} of {} samples", film.source.count, source.count);
    failure::tell(&match journal {
        Some(journal) => format!("{so_far}, which are kept in {}: --resume continues", journal.path().display()),
        None => so_far,
    });
}

/// `tolerance merge`: joins parts.
fn merge(args: &MergeArgs, quiet: bool) -> Result<(), Failure> {
    let progress = ProgressLine::start(!quiet);
    let mut layout = remarks::read_layout(&args.layout, remarks::OF_COMPARISONS, quiet, &progress)?;
    args.preset.apply(&mut layout);
    let scene = SampledScene::new(&args.layout, &layout, &progress, &remarks::teller(quiet, &progress))?;
    let inputs: Vec<PathBuf> = args.parts.iter().chain([&args.layout]).cloned().collect();
    let outputs = Outputs::open(&args.result, &inputs)?;
    let sorting = args.sorting.sorting()?;
    progress.show(Stage::uncounted("reading the parts"));
    let mut parts = Vec::new();
    for path in &args.parts {
        let part = sample_file::read(path)?;
        let refused = |message: String| Err(Failure::Points { path: path.clone(), message });
        let expected = SampleSource::new(&layout, sorting.as_ref(), part.source.seed, 0, 0).fingerprint;
        if part.source.fingerprint != expected {
            return refused(format!(
                "its samples are of another film or other errors than {} has now, or of other options of --sorted",
                args.layout.display()
            ));
        }
        if (part.errors.len() as u64) < part.source.count {
            let (have, of) = (part.errors.len(), part.source.count);
            return refused(format!("has {have} of its {of} samples: its run has not ended"));
        }
        parts.push((path, part));
    }
    parts.sort_by_key(|(_, part)| part.source.first);
    let mut errors: Vec<Figures> = Vec::new();
    let source = parts.first().map(|(_, part)| part.source.clone()).expect("at least one part is required");
    for (path, part) in parts {
        let refused = |message: String| Err(Failure::Points { path: path.clone(), message });
        if part.source.seed != source.seed {
            return refused(format!("has seed {}, another part has seed {}", part.source.seed, source.seed));
        }
        let next = source.first + errors.len() as u64;
        let first = part.source.first;
        if first > next {
            return refused(format!("begins with sample {first}: samples {next} to {} are in no part", first - 1));
        }
        if first < next {
            return refused(format!("begins with sample {first}, which another part has too"));
        }
        errors.extend(part.errors);
        if errors.len() as u64 > MAX_SAMPLES {
            return refused(format!("all parts together have more than {MAX_SAMPLES} samples"));
        }
    }
    let source = SampleSource { count: errors.len() as u64, ..source };
    let film = SampledFilm::new(&scene, source, &errors)?.sorted(sorting);
    progress.end();
    outputs.finish(&film, &errors)
}

/// Where the result and the figures of samples go.
struct Outputs<'a> {
    args: &'a ToleranceResultArgs,
    result: Output,
    samples: Option<(SampleFormat, Output)>,
}

impl<'a> Outputs<'a> {
    /// Opens the files, so that one that cannot be written is refused before any work.
    fn open(args: &'a ToleranceResultArgs, inputs: &[PathBuf]) -> Result<Outputs<'a>, Failure> {
        let inputs: Vec<&Path> = inputs.iter().map(PathBuf::as_path).collect();
        let samples = match args.save.as_deref() {
            Some(save) => {
                let format = choice::choose(None, Some(save), None)?;
                if format == SampleFormat::Parquet && cfg!(not(feature = "parquet")) {
                    return Err(Failure::Format(choice::WITHOUT_PARQUET.to_owned()));
                }
                Some((format, Output::open(Some(save), &inputs)?))
            }
            None => None,
        };
        Ok(Outputs { args, result: Output::open(args.text.output.as_deref(), &inputs)?, samples })
    }

    fn finish(mut self, film: &SampledFilm, errors: &[Figures]) -> Result<(), Failure> {
        if let Some((format, mut output)) = self.samples.take() {
            sample_file::write(&film.source, errors, film.layout, format, &mut output)?;
            output.finish()?;
        }
        self.finish_result(film)
    }

    /// Writes the result alone.
    fn finish_result(mut self, film: &SampledFilm) -> Result<(), Failure> {
        let result = match self.args.text.format {
            TextOrJson::Text => text::tolerance::sampled(film),
            TextOrJson::Json => json::pretty(&json::tolerance::ToleranceJson::new(film)),
        };
        self.result.write(|w| w.write_all(result.as_bytes()))?;
        self.result.finish()
    }
}
