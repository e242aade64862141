//! Output formats, their names and file endings.

use std::path::PathBuf;

use clap::ValueEnum;
use clap::builder::PossibleValue;

/// Formats of results that are never tables of points.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(crate) enum TextOrJson {
    Text,
    Json,
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

/// A format that an option or the ending of a file chooses.
pub(crate) trait FileFormat: ValueEnum + Copy + PartialEq + 'static {
    /// The option that chooses it.
    const OPTION: &'static str = "--format";

    /// Endings of its files.
    fn endings(self) -> &'static [&'static str];

    /// Whether a terminal cannot show it.
    fn is_binary(self) -> bool {
        false
    }

    /// Whether other programs recognize it by the ending of the file.
    fn is_known_by_ending(self) -> bool {
        false
    }

    /// The name that the option takes.
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
            ExportFormat::Magpylib | ExportFormat::MagpylibImport => &["py"],
            ExportFormat::Vtk => &["vtp"],
            ExportFormat::Dxf => &["dxf"],
            ExportFormat::Stl => &["stl"],
            ExportFormat::CHeader => &["h"],
        }
    }

    fn is_binary(self) -> bool {
        matches!(self, ExportFormat::Vtk | ExportFormat::Stl)
    }

    fn is_known_by_ending(self) -> bool {
        self != ExportFormat::Magpylib
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
    fn endings(self) -> &'static [&'static str] {
        match self {
            DecoupleFormat::Text => &["txt"],
            DecoupleFormat::Table(format) => format.endings(),
        }
    }

    fn is_binary(self) -> bool {
        matches!(self, DecoupleFormat::Table(format) if format.is_binary())
    }

    fn is_known_by_ending(self) -> bool {
        matches!(self, DecoupleFormat::Table(format) if format.is_known_by_ending())
    }
}
