//! Tables of the figures of samples.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use magsplice::decouple::{Figure, Figures};
use magsplice::layout::Layout;
use magsplice::results::{ColumnQuantity, LayoutSource, MetadataValue, Rows, Table};
use magsplice_export::numpy;

use super::source::SampleSource;
use crate::args::tolerance::{MAX_SAMPLES, SampleFormat};
use crate::failure::Failure;
use crate::output::destination::Output;

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
pub(crate) fn heading() -> String {
    format!("sample,{}", COLUMNS.join(","))
}

/// A figure of a sample; NaN for an undefined uniformity.
fn number(errors: &Figures, figure: Figure) -> f64 {
    errors.get(figure).copied().unwrap_or(f64::NAN)
}

/// A sample as a line of CSV. Numbers read back to the same bits.
pub(crate) fn line(sample: u64, errors: &Figures) -> String {
    let figures = Figure::ALL.map(|figure| format!("{:?}", number(errors, figure)));
    format!("{sample},{}", figures.join(","))
}

/// Writes samples in a format.
pub(crate) fn write(
    source: &SampleSource,
    errors: &[Figures],
    layout: &Layout,
    format: SampleFormat,
    output: &mut Output,
) -> Result<(), Failure> {
    if format == SampleFormat::Csv {
        return output.write(|w| {
            writeln!(w, "{}\n{}", source.line(), heading())?;
            source.range().zip(errors).try_for_each(|(sample, errors)| writeln!(w, "{}", line(sample, errors)))
        });
    }
    let table = table(source, errors, layout);
    output.write(|w| match format {
        SampleFormat::Csv | SampleFormat::Npz => numpy::npz(&table, w),
        #[cfg(feature = "parquet")]
        SampleFormat::Parquet => magsplice_export::parquet::write(&table, w),
        #[cfg(not(feature = "parquet"))]
        SampleFormat::Parquet => Err(std::io::Error::other(crate::output::choice::WITHOUT_PARQUET)),
    })
}

fn table(source: &SampleSource, errors: &[Figures], layout: &Layout) -> Table {
    let column = |(figure, name): (Figure, &'static &'static str)| ColumnQuantity {
        name,
        components: std::slice::from_ref(name),
        values: errors.iter().map(|errors| number(errors, figure)).collect(),
    };
    let quantities = Figure::ALL.into_iter().zip(&COLUMNS).map(column).collect();
    let mut metadata = LayoutSource::of(layout).metadata(layout.tiles.len());
    metadata.push(("film", MetadataValue::Text(source.fingerprint.clone())));
    metadata.push(("seed", MetadataValue::Text(source.seed.to_string())));
    let rows = Rows::Numbered { name: "sample", first: source.first, count: errors.len() };
    Table::new(rows, quantities, metadata).expect("a value for each sample")
}

/// The samples of a file that [`write`] wrote as CSV, or the complete ones at the beginning of a
/// journal. `bytes` is the length of what was read.
pub(crate) struct SampleFile {
    pub(crate) source: SampleSource,
    pub(crate) errors: Vec<Figures>,
    pub(crate) bytes: u64,
}

/// Reads a file of samples. An incomplete last line, which a run that was killed leaves, ends the
/// samples.
pub(crate) fn read(path: &Path) -> Result<SampleFile, Failure> {
    let refused = |message: String| Failure::Points { path: path.to_owned(), message };
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
    let source =
        SampleSource::parse(&first).ok_or_else(|| refused(not_samples("its first line tells no film and seed")))?;
    if source.count > MAX_SAMPLES || source.first > MAX_SAMPLES {
        return Err(refused(format!("tells of more than {MAX_SAMPLES} samples")));
    }
    match next_line()? {
        Some((names, length)) if names == heading() => bytes += length,
        _ => return Err(refused(not_samples("its second line does not name the figures"))),
    }
    let mut errors: Vec<Figures> = Vec::new();
    while let Some((line, length)) = next_line()? {
        let expected = source.first + errors.len() as u64;
        let number = errors.len() + 3;
        if errors.len() as u64 == source.count {
            return Err(refused(format!("line {number}: more samples than the {} it tells", source.count)));
        }
        let (sample, values) = parse(&line).ok_or_else(|| refused(format!("line {number}: not a sample: {line}")))?;
        if sample != expected {
            return Err(refused(format!("line {number}: sample {sample}, must be sample {expected}")));
        }
        errors.push(values);
        bytes += length;
    }
    Ok(SampleFile { source, errors, bytes })
}

fn not_samples(why: &str) -> String {
    format!("is not a file of samples as `magsplice tolerance --save FILE.csv` writes it: {why}")
}

fn parse(line: &str) -> Option<(u64, Figures)> {
    let (sample, figures) = line.split_once(',')?;
    let figures: Vec<f64> = figures.split(',').map(|figure| figure.parse().ok()).collect::<Option<_>>()?;
    let figures: [f64; Figure::ALL.len()] = figures.try_into().ok()?;
    figures.iter().all(|figure| !figure.is_infinite()).then_some(())?;
    let errors = Figures::from_fn(|figure| Some(figures[figure.index()]).filter(|value| !value.is_nan()))?;
    Some((sample.parse().ok()?, errors))
}

#[cfg(test)]
mod tests {
    use super::*;

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
    }
}
