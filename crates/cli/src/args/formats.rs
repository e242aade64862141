//! Output formats, their names and file endings.

use std::path::PathBuf;

use clap::ValueEnum;
use clap::builder::PossibleValue;
use serde::Serialize;

use crate::output::json;

/// Formats of results that are never tables of points.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(crate) enum TextOrJson {
    Text,
    Json,
}

impl TextOrJson {
    /// The result as JSON, or as `text` has it.
    pub(crate) fn shown(self, result: &impl Serialize, text: impl FnOnce() -> String) -> String {
        match self {
            TextOrJson::Text => text(),
            TextOrJson::Json => json::pretty(result),
        }
    }
}

/// Where a result that is never a table of points goes.
#[derive(clap::Args)]
pub(crate) struct ResultArgs {
    /// Format of the result
    #[arg(long, value_enum, default_value = "text")]
    pub(crate) format: TextOrJson,
    /// File to write, complete or not at all [default: -, standard output]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
}

/// Formats of `tiles`.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(crate) enum TilesFormat {
    /// The tiles and the bill of materials as printed tables
    Text,
    /// A layout with one entry per tile, and its parts with the tiles of each
    Json,
    /// The cut list: one line per part
    Csv,
}

/// Formats of `check`.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(crate) enum CheckFormat {
    Text,
    Json,
    /// JUnit XML, for build systems
    Junit,
}

/// Formats of tables of points.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(crate) enum TableFormat {
    /// Text with one line per point
    Csv,
    /// Columns as lists, with metadata: layout, version, accuracy
    Json,
    /// NumPy: one structured array, without metadata
    Npy,
    /// NumPy: one array per column
    Npz,
    /// ParaView: the grid of a volume as image data (.vti), points of a file as poly data (.vtp)
    Vtk,
    /// Parquet, if the program was built with the feature `parquet`
    Parquet,
}

/// Formats of `decouple`.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum DecoupleFormat {
    Text,
    Table(TableFormat),
}

/// Formats of `export`.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(crate) enum ExportFormat {
    /// A Python script for magpylib 5 and 6 (.py)
    Magpylib,
    /// A Python script that writes a magpylib collection as a table for `import`; needs no layout
    MagpylibImport,
    /// Poly data for ParaView (.vtp)
    Vtk,
    /// A drawing of the film from above, in mm: outlines and arrows, a layer for each part (.dxf)
    Dxf,
    /// The bodies of the tiles as triangles, in mm (.stl)
    Stl,
    /// The displacement of a sensor from its reading, as a function in C for firmware (.h)
    CHeader,
}

/// The files of a format.
#[derive(Clone, Copy)]
pub(crate) struct FileKind {
    /// Endings of their names.
    pub(crate) endings: &'static [&'static str],
    /// Whether a terminal cannot show them.
    pub(crate) is_binary: bool,
    /// Whether other programs recognize them by the ending.
    pub(crate) is_known_by_ending: bool,
}

impl FileKind {
    /// Text, which is read whatever its file is called.
    pub(crate) const fn text(endings: &'static [&'static str]) -> FileKind {
        FileKind { endings, is_binary: false, is_known_by_ending: false }
    }

    /// Binary data, which is read whatever its file is called.
    pub(crate) const fn binary(endings: &'static [&'static str]) -> FileKind {
        FileKind { is_binary: true, ..FileKind::text(endings) }
    }

    /// The same, recognized by the ending.
    pub(crate) const fn known_by_ending(self) -> FileKind {
        FileKind { is_known_by_ending: true, ..self }
    }
}

/// A format that an option or the ending of a file chooses.
pub(crate) trait FileFormat: ValueEnum + Copy + PartialEq + 'static {
    /// The option that chooses it. `None` where the ending alone does.
    const OPTION: Option<&'static str> = Some("--format");

    /// Its files.
    fn file(self) -> FileKind;

    /// The name that the option takes.
    fn name(self) -> String {
        self.to_possible_value().map_or(String::new(), |value| value.get_name().to_owned())
    }
}

impl FileFormat for TableFormat {
    fn file(self) -> FileKind {
        match self {
            TableFormat::Csv => FileKind::text(&["csv"]),
            TableFormat::Json => FileKind::text(&["json"]),
            TableFormat::Npy => FileKind::binary(&["npy"]),
            TableFormat::Npz => FileKind::binary(&["npz"]),
            TableFormat::Vtk => FileKind::binary(&["vti", "vtp"]).known_by_ending(),
            TableFormat::Parquet => FileKind::binary(&["parquet"]),
        }
    }
}

impl FileFormat for ExportFormat {
    const OPTION: Option<&'static str> = Some("--to");

    fn file(self) -> FileKind {
        match self {
            ExportFormat::Magpylib => FileKind::text(&["py"]),
            ExportFormat::MagpylibImport => FileKind::text(&["py"]).known_by_ending(),
            ExportFormat::Vtk => FileKind::binary(&["vtp"]).known_by_ending(),
            ExportFormat::Dxf => FileKind::text(&["dxf"]).known_by_ending(),
            ExportFormat::Stl => FileKind::binary(&["stl"]).known_by_ending(),
            ExportFormat::CHeader => FileKind::text(&["h"]).known_by_ending(),
        }
    }
}

impl ValueEnum for DecoupleFormat {
    fn value_variants<'a>() -> &'a [DecoupleFormat] {
        use TableFormat::{Csv, Json, Npy, Npz, Parquet, Vtk};
        const ALL: [DecoupleFormat; 7] = [
            DecoupleFormat::Text,
            DecoupleFormat::Table(Json),
            DecoupleFormat::Table(Csv),
            DecoupleFormat::Table(Npy),
            DecoupleFormat::Table(Npz),
            DecoupleFormat::Table(Vtk),
            DecoupleFormat::Table(Parquet),
        ];
        &ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        match self {
            DecoupleFormat::Text => Some(PossibleValue::new("text").help("The report as printed tables")),
            DecoupleFormat::Table(TableFormat::Json) => {
                Some(PossibleValue::new("json").help("The report, and columns as lists"))
            }
            DecoupleFormat::Table(format) => format.to_possible_value(),
        }
    }
}

impl FileFormat for DecoupleFormat {
    fn file(self) -> FileKind {
        match self {
            DecoupleFormat::Text => FileKind::text(&["txt"]),
            DecoupleFormat::Table(format) => format.file(),
        }
    }
}
