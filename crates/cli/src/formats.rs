//! In which format a result is written: as `--format` says, or the ending of the file.

use std::io::{self, IsTerminal};
use std::path::Path;

use clap::ValueEnum;
use clap::builder::PossibleValue;
use magsplice::Film;
use magsplice_export::{Metadata, Table, Value, csv, json, numpy};
use serde::Serialize;

use crate::failure::Failure;
use crate::output::Output;

/// Formats of tables.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(crate) enum TableFormat {
    /// Text, one line per point
    Csv,
    /// Columns as lists, with what they were made from
    Json,
    /// NumPy: one array of records; metadata are left out
    Npy,
    /// NumPy: one array per column
    Npz,
}

/// Formats of `decouple`.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum ReportFormat {
    Text,
    Table(TableFormat),
}

/// A format a person can choose.
pub(crate) trait FileFormat: ValueEnum + Copy + PartialEq + 'static {
    /// The option that chooses it.
    const OPTION: &'static str = "--format";

    /// Endings of its files.
    fn endings(self) -> &'static [&'static str];

    /// Whether a terminal cannot show it.
    fn is_binary(self) -> bool;

    fn name(self) -> String {
        self.to_possible_value().map_or(String::new(), |value| value.get_name().to_owned())
    }
}

impl FileFormat for TableFormat {
    fn endings(self) -> &'static [&'static str] {
        match self {
            TableFormat::Csv => &["csv"],
            TableFormat::Json => &["json"],
            TableFormat::Npy => &["npy"],
            TableFormat::Npz => &["npz"],
        }
    }

    fn is_binary(self) -> bool {
        !matches!(self, TableFormat::Csv | TableFormat::Json)
    }
}

impl ValueEnum for ReportFormat {
    fn value_variants<'a>() -> &'a [ReportFormat] {
        use TableFormat::{Csv, Json, Npy, Npz};
        const ALL: [ReportFormat; 5] = [
            ReportFormat::Text,
            ReportFormat::Table(Json),
            ReportFormat::Table(Csv),
            ReportFormat::Table(Npy),
            ReportFormat::Table(Npz),
        ];
        &ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        match self {
            ReportFormat::Text => Some(PossibleValue::new("text").help("The report, for people")),
            ReportFormat::Table(TableFormat::Json) => {
                Some(PossibleValue::new("json").help("The report, and columns as lists"))
            }
            ReportFormat::Table(format) => format.to_possible_value(),
        }
    }
}

impl FileFormat for ReportFormat {
    fn endings(self) -> &'static [&'static str] {
        match self {
            ReportFormat::Text => &["txt"],
            ReportFormat::Table(format) => format.endings(),
        }
    }

    fn is_binary(self) -> bool {
        matches!(self, ReportFormat::Table(format) if format.is_binary())
    }
}

/// The format that was `asked` for or that the ending of the output means; `default` if neither says anything.
///
/// Refuses a contradiction of the two, an ending without a meaning, and binary data for a terminal.
pub(crate) fn choose<F: FileFormat>(asked: Option<F>, output: Option<&Path>, default: F) -> Result<F, Failure> {
    let formats = F::value_variants();
    let ending = output.and_then(|path| path.extension()).map(|ending| ending.to_string_lossy().to_lowercase());
    let meant = ending.as_ref().and_then(|e| formats.iter().copied().find(|f| f.endings().contains(&e.as_str())));
    let path = || output.unwrap_or(Path::new("-")).display();
    let format = match (asked, meant, &ending) {
        (Some(asked), Some(meant), _) if asked != meant => {
            let (option, asked, meant) = (F::OPTION, asked.name(), meant.name());
            return Err(Failure::Format(format!(
                "{option} {asked} contradicts the ending of {}, which means {meant}: change one of them",
                path()
            )));
        }
        (None, None, Some(ending)) => {
            let known: Vec<String> =
                formats.iter().flat_map(|f| f.endings()).map(|ending| format!(".{ending}")).collect();
            return Err(Failure::Format(format!(
                "{}: no format has the ending .{ending}; use one of {}, or give {}",
                path(),
                known.join(", "),
                F::OPTION
            )));
        }
        (asked, meant, _) => asked.or(meant).unwrap_or(default),
    };
    let to_stdout = output.is_none_or(|path| path == Path::new("-") || path == Path::new("/dev/stdout"));
    if format.is_binary() && to_stdout && io::stdout().is_terminal() {
        return Err(Failure::Format(format!(
            "{} is binary and would go to the terminal: give a file with -o, or redirect standard output",
            format.name()
        )));
    }
    Ok(format)
}

/// Writes a table; as JSON the `report` that holds it.
pub(crate) fn write(
    table: &Table,
    report: &impl Serialize,
    format: TableFormat,
    output: &mut Output,
) -> Result<(), Failure> {
    output.write(|w| match format {
        TableFormat::Csv => csv::header(table, w).and_then(|()| csv::rows(table, w)),
        TableFormat::Json => json::write(report, w),
        TableFormat::Npy => numpy::npy(table, w),
        TableFormat::Npz => numpy::npz(table, w),
    })
}

/// What a table of a film was made from and by.
pub(crate) fn metadata(film: &Film) -> Metadata {
    let layout = film.layout();
    vec![
        ("layout", Value::Text(layout.name.clone())),
        ("sha256", Value::Text(layout.sha256.clone())),
        ("version", Value::Text(env!("CARGO_PKG_VERSION").to_owned())),
        ("tiles", Value::Count(layout.tiles.len())),
        ("accuracy", Value::Text(film.scene().accuracy().to_string())),
    ]
}
