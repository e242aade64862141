//! Tables of the figures of samples.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use clap::ValueEnum;
use magsplice::decouple::{Figure, Figures};
use magsplice::results::{ColumnQuantity, MetadataValue, Rows, SampleRun, SampledFilm, Table};
use magsplice_export::numpy;

use crate::args::formats::{FileFormat, FileKind};
use crate::failure::Failure;
use crate::output::destination::Output;

/// Largest number of samples.
pub(super) const MAX_SAMPLES: u64 = *magsplice::layout::SAMPLE_COUNTS.end();

/// Formats of the figures of samples.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(super) enum SampleFormat {
    /// Text with one line per sample, after a line that identifies the sampled film
    Csv,
    /// NumPy: one array per figure
    Npz,
    /// Parquet, if the program was built with the feature `parquet`
    Parquet,
}

impl FileFormat for SampleFormat {
    const OPTION: Option<&'static str> = None;

    fn file(self) -> FileKind {
        let kind = match self {
            SampleFormat::Csv => FileKind::text(&["csv"]),
            SampleFormat::Npz => FileKind::binary(&["npz"]),
            SampleFormat::Parquet => FileKind::binary(&["parquet"]),
        };
        kind.known_by_ending()
    }
}

/// Names of the columns after the number of the sample, in the order of [`Figure::ALL`].
const COLUMNS: [&str; 7] = [
    "uniformity_rmse_r_x",
    "uniformity_rmse_r_y",
    "uniformity_rmse_s_z",
    "displacement_rmse_x_mm",
    "displacement_rmse_y_mm",
    "displacement_rmse_z_mm",
    "amplitude",
];

/// Longest line of a file of samples: eight numbers of at most 25 characters, or the line before
/// them.
const MAX_LINE: u64 = 400;

/// The names of all columns.
pub(super) fn heading() -> String {
    format!("sample,{}", COLUMNS.join(","))
}

/// A figure of a sample; NaN for an undefined uniformity.
fn number(figures: &Figures, figure: Figure) -> f64 {
    figures.get(figure).copied().unwrap_or(f64::NAN)
}

/// What the first line of a file begins with. The 2 is for the hash of the film.
pub(super) const BEGINNING: &str = "# magsplice tolerance 2: film ";

/// What the first line of a file with another hash began with.
const EARLIER_BEGINNING: &str = "# magsplice tolerance: film ";

/// The line before the samples in a file.
pub(super) fn first_line(SampleRun { film, seed, first, count }: &SampleRun) -> String {
    format!("{BEGINNING}{film}, seed {seed}, first {first}, count {count}")
}

/// The run of a first line. `None` if it describes none.
pub(super) fn parse_first_line(line: &str) -> Option<SampleRun> {
    let (film, rest) = line.strip_prefix(BEGINNING)?.split_once(", seed ")?;
    let (seed, rest) = rest.split_once(", first ")?;
    let (first, count) = rest.split_once(", count ")?;
    let [seed, first, count] = [seed, first, count].map(|number| number.parse().ok());
    Some(SampleRun { film: film.to_owned(), seed: seed?, first: first?, count: count? })
}

/// A sample as a line of CSV. Numbers read back to the same bits.
pub(super) fn line(sample: u64, figures: &Figures) -> String {
    let cells = Figure::ALL.map(|figure| format!("{:?}", number(figures, figure)));
    format!("{sample},{}", cells.join(","))
}

/// Writes samples in a format.
pub(super) fn write(
    result: &SampledFilm,
    samples: &[Figures],
    format: SampleFormat,
    output: &mut Output,
) -> Result<(), Failure> {
    if format == SampleFormat::Csv {
        return output.write(|w| {
            writeln!(w, "{}\n{}", first_line(&result.run), heading())?;
            result.run.range().zip(samples).try_for_each(|(sample, figures)| writeln!(w, "{}", line(sample, figures)))
        });
    }
    let table = table(result, samples);
    output.write(|w| match format {
        SampleFormat::Csv | SampleFormat::Npz => numpy::npz(&table, w),
        #[cfg(feature = "parquet")]
        SampleFormat::Parquet => magsplice_export::parquet::write(&table, w),
        #[cfg(not(feature = "parquet"))]
        SampleFormat::Parquet => Err(std::io::Error::other(crate::output::choice::WITHOUT_PARQUET)),
    })
}

fn table(result: &SampledFilm, samples: &[Figures]) -> Table {
    let column = |(figure, name): (Figure, &'static &'static str)| ColumnQuantity {
        name,
        components: std::slice::from_ref(name),
        values: samples.iter().map(|figures| number(figures, figure)).collect(),
        is_whole: false,
    };
    let quantities = Figure::ALL.into_iter().zip(&COLUMNS).map(column).collect();
    let mut metadata = result.source.layout.metadata(result.source.tiles);
    metadata.push(("film", MetadataValue::Text(result.run.film.clone())));
    metadata.push(("seed", MetadataValue::Text(result.run.seed.to_string())));
    let rows = Rows::Numbered { name: "sample", first: result.run.first, count: samples.len() };
    Table::new(rows, quantities, metadata)
}

/// The samples of a file that [`write`] wrote as CSV, or the complete ones at the beginning of a
/// journal. `bytes` is the length of what was read.
pub(super) struct SampleFile {
    pub(super) run: SampleRun,
    pub(super) samples: Vec<Figures>,
    pub(super) bytes: u64,
}

/// Reads a file of samples. An incomplete last line, which a run that was killed leaves, ends the
/// samples.
pub(super) fn read(path: &Path) -> Result<SampleFile, Failure> {
    let refused = |message: String| Failure::at(path, message);
    let failed = |error: std::io::Error| refused(format!("cannot be read: {error}"));
    let mut reader = BufReader::new(File::open(path).map_err(failed)?);
    let mut bytes = 0;
    // Lines with their ends. `None` at the end of the file and for a line without an end.
    let mut next_line = || -> Result<Option<(String, u64)>, Failure> {
        let mut line = Vec::new();
        let length = (&mut reader).take(MAX_LINE).read_until(b'\n', &mut line).map_err(failed)?;
        let line = match line.strip_suffix(b"\n") {
            Some(line) => line.strip_suffix(b"\r").unwrap_or(line).to_vec(),
            None if length as u64 == MAX_LINE => return Err(refused(not_samples("a line is too long"))),
            None => return Ok(None),
        };
        let line = String::from_utf8(line).map_err(|_| refused(not_samples("it is not text")))?;
        Ok(Some((line, length as u64)))
    };
    let (first, length) = next_line()?.ok_or_else(|| refused(not_samples("it has no first line")))?;
    bytes += length;
    if first.starts_with(EARLIER_BEGINNING) {
        let message = "is of an earlier version of magsplice, with another film identifier: draw its samples again";
        return Err(refused(message.to_owned()));
    }
    let run = parse_first_line(&first).ok_or_else(|| refused(not_samples("its first line has no film and seed")))?;
    if run.count > MAX_SAMPLES || run.first > MAX_SAMPLES {
        return Err(refused(format!("has more than {MAX_SAMPLES} samples")));
    }
    match next_line()? {
        Some((names, length)) if names == heading() => bytes += length,
        _ => return Err(refused(not_samples("its second line has no names of figures"))),
    }
    let mut samples: Vec<Figures> = Vec::new();
    while let Some((line, length)) = next_line()? {
        let expected = run.first + samples.len() as u64;
        let number = samples.len() + 3;
        if samples.len() as u64 == run.count {
            return Err(refused(format!("line {number}: more samples than the {} of its first line", run.count)));
        }
        let (sample, values) = parse(&line).ok_or_else(|| refused(format!("line {number}: not a sample: {line}")))?;
        if sample != expected {
            return Err(refused(format!("line {number}: sample {sample}, must be sample {expected}")));
        }
        samples.push(values);
        bytes += length;
    }
    Ok(SampleFile { run, samples, bytes })
}

fn not_samples(why: &str) -> String {
    format!("is not a file of samples as `magsplice tolerance --save FILE.csv` writes it: {why}")
}

/// Largest figure of a film. Squares of larger ones, in the moments of samples, are not finite.
const LARGEST: f64 = 1e100;

fn parse(line: &str) -> Option<(u64, Figures)> {
    let (sample, figures) = line.split_once(',')?;
    let figures: Vec<f64> = figures.split(',').map(|figure| figure.parse().ok()).collect::<Option<_>>()?;
    let figures: [f64; Figure::ALL.len()] = figures.try_into().ok()?;
    (!figures.iter().any(|figure| figure.abs() > LARGEST)).then_some(())?;
    let errors = Figures::from_fn(|figure| Some(figures[figure.index()]).filter(|value| !value.is_nan()))?;
    Some((sample.parse().ok()?, errors))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_line_reads_back() {
        let run = SampleRun { film: "0123abcd".to_owned(), seed: 7, first: 100, count: 25 };
        assert_eq!(parse_first_line(&first_line(&run)), Some(run));
        assert_eq!(parse_first_line("# x,y,z"), None);
    }

    #[test]
    fn figures_read_back_to_the_same_bits_and_a_uniformity_may_be_undefined() {
        let figures = Figures {
            uniformity_rmse: [None, Some(0.1 + 0.2), Some(1e-300)].into(),
            displacement_rmse_mm: [0.3, 1.0 / 3.0, 0.0].into(),
            amplitude: 0.8,
        };
        let line = line(7, &figures);
        assert!(line.starts_with("7,NaN,0.30000000000000004,1e-300,"), "{line}");
        assert_eq!(parse(&line), Some((7, figures)));
        assert_eq!(parse(&line.replace("0.3,", "NaN,")), None);
        assert_eq!(parse(&line.replace("NaN", "inf")), None);
        assert_eq!(parse(&line.replace("NaN", "1.8e308")), None);
        assert_eq!(parse(&line.replace("NaN", "1e101")), None);
    }
}
