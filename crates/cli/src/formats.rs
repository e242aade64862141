//! In which format a result is written: as `--format` says, or the ending of the file.

use std::io::{self, IsTerminal};
use std::path::Path;

use clap::ValueEnum;
use clap::builder::PossibleValue;
use magsplice::Film;
use magsplice::layout::Layout;
use magsplice_export::{Metadata, MetadataValue, Table, csv, json, numpy, vtk};
use serde::Serialize;

use crate::failure::Failure;
use crate::output::Output;

const WITHOUT_PARQUET: &str = "parquet is not built into this program: build it with `--features parquet`, as in \
    `cargo install --path crates/cli --features parquet`";

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
    /// ParaView: the grid as image data (.vti), points of a file as poly data (.vtp)
    Vtk,
    /// Parquet, if the program was built with the feature of that name
    Parquet,
}

/// Formats of `decouple`.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum ReportFormat {
    Text,
    Table(TableFormat),
}

/// Formats of `export`.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(crate) enum ExportFormat {
    /// A Python script for magpylib 5 and 6 (.py)
    Magpylib,
    /// Poly data for ParaView (.vtp)
    Vtk,
}

/// A format a person can choose.
pub(crate) trait FileFormat: ValueEnum + Copy + PartialEq + 'static {
    /// The option that chooses it.
    const OPTION: &'static str = "--format";

    /// Endings of its files.
    fn endings(self) -> &'static [&'static str];

    /// Whether a terminal cannot show it.
    fn is_binary(self) -> bool;

    /// Whether other programs tell it by the ending of the file.
    fn is_known_by_ending(self) -> bool;

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
            TableFormat::Vtk => &["vti", "vtp"],
            TableFormat::Parquet => &["parquet"],
        }
    }

    fn is_binary(self) -> bool {
        !matches!(self, TableFormat::Csv | TableFormat::Json)
    }

    fn is_known_by_ending(self) -> bool {
        self == TableFormat::Vtk
    }
}

impl FileFormat for ExportFormat {
    const OPTION: &'static str = "--to";

    fn endings(self) -> &'static [&'static str] {
        match self {
            ExportFormat::Magpylib => &["py"],
            ExportFormat::Vtk => &["vtp"],
        }
    }

    fn is_binary(self) -> bool {
        self == ExportFormat::Vtk
    }

    fn is_known_by_ending(self) -> bool {
        self == ExportFormat::Vtk
    }
}

impl ValueEnum for ReportFormat {
    fn value_variants<'a>() -> &'a [ReportFormat] {
        use TableFormat::{Csv, Json, Npy, Npz, Parquet, Vtk};
        const ALL: [ReportFormat; 7] = [
            ReportFormat::Text,
            ReportFormat::Table(Json),
            ReportFormat::Table(Csv),
            ReportFormat::Table(Npy),
            ReportFormat::Table(Npz),
            ReportFormat::Table(Vtk),
            ReportFormat::Table(Parquet),
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

    fn is_known_by_ending(self) -> bool {
        matches!(self, ReportFormat::Table(format) if format.is_known_by_ending())
    }
}

/// The format that was `asked` for or that the ending of the output means; `default` if neither says anything.
///
/// Refuses a contradiction of the two, an ending without a meaning, and binary data for a terminal.
pub(crate) fn choose<F: FileFormat>(asked: Option<F>, output: Option<&Path>, default: Option<F>) -> Result<F, Failure> {
    let formats = F::value_variants();
    let ending = output.and_then(|path| path.extension()).map(|ending| ending.to_string_lossy().to_lowercase());
    let meant = ending.as_ref().and_then(|e| formats.iter().copied().find(|f| f.endings().contains(&e.as_str())));
    let path = || output.unwrap_or(Path::new("-")).display();
    let endings = |formats: &[F]| {
        let all: Vec<String> = formats.iter().flat_map(|f| f.endings()).map(|ending| format!(".{ending}")).collect();
        all.join(", ")
    };
    let refused = |why: String| Err(Failure::Format(format!("{}: {why}", path())));
    let format = match (asked, meant, &ending) {
        (Some(asked), Some(meant), _) if asked != meant => {
            let (option, asked, meant) = (F::OPTION, asked.name(), meant.name());
            return refused(format!(
                "the ending means {meant}, which contradicts {option} {asked}: change one of them"
            ));
        }
        (Some(asked), None, Some(ending)) if asked.is_known_by_ending() => {
            let (name, endings) = (asked.name(), endings(&[asked]));
            return refused(format!(
                "programs tell {name} by its ending, and .{ending} is another format: use {endings}"
            ));
        }
        (None, None, Some(ending)) => {
            let (endings, option) = (endings(formats), F::OPTION);
            return refused(format!("no format has the ending .{ending}: use one of {endings}, or give {option}"));
        }
        (None, None, None) => match default {
            Some(format) => format,
            None => return refused(format!("without an ending it has no format: give {}", F::OPTION)),
        },
        (Some(format), _, _) | (None, Some(format), _) => format,
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

/// Refuses a format that is not built in, and a VTK file whose ending belongs to another kind.
pub(crate) fn accept(format: TableFormat, output: Option<&Path>, on_grid: bool) -> Result<(), Failure> {
    if format == TableFormat::Parquet && cfg!(not(feature = "parquet")) {
        return Err(Failure::Format(WITHOUT_PARQUET.to_owned()));
    }
    let (kind, ending) =
        if on_grid { ("the working volume is image data", "vti") } else { ("points are poly data", "vtp") };
    let ended = |path: &Path| path.extension().is_none_or(|e| e.eq_ignore_ascii_case(ending));
    if let Some(path) = output.filter(|path| format == TableFormat::Vtk && !ended(path)) {
        return Err(Failure::Format(format!(
            "{}: {kind}, which programs tell by the ending: use .{ending}",
            path.display()
        )));
    }
    Ok(())
}

/// Writes a table; as JSON the `report` that holds it.
pub(crate) fn write(
    table: &Table,
    report: &impl Serialize,
    format: TableFormat,
    output: &mut Output,
) -> Result<(), Failure> {
    output.write(|w| match format {
        TableFormat::Csv => csv::write(table, w),
        TableFormat::Json => json::write(report, w),
        TableFormat::Npy => numpy::npy(table, w),
        TableFormat::Npz => numpy::npz(table, w),
        TableFormat::Vtk => vtk::table(table, w),
        #[cfg(feature = "parquet")]
        TableFormat::Parquet => magsplice_export::parquet::write(table, w),
        #[cfg(not(feature = "parquet"))]
        TableFormat::Parquet => Err(std::io::Error::other(WITHOUT_PARQUET)),
    })
}

/// What a table of a film was made from and by.
pub(crate) fn metadata(film: &Film) -> Metadata {
    let mut metadata = origin(film.layout());
    metadata.push(("accuracy", MetadataValue::Text(film.scene().accuracy().to_string())));
    metadata
}

/// The layout and the program.
pub(crate) fn origin(layout: &Layout) -> Metadata {
    vec![
        ("layout", MetadataValue::Text(layout.name.clone())),
        ("sha256", MetadataValue::Text(layout.sha256.clone())),
        ("version", MetadataValue::Text(env!("CARGO_PKG_VERSION").to_owned())),
        ("tiles", MetadataValue::Count(layout.tiles.len())),
    ]
}
