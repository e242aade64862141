//! The format of a result: the one that the option names, or the one the file's ending stands for.

use std::io::{self, IsTerminal};
use std::path::Path;

use super::destination::is_standard;
use crate::args::formats::{FileFormat, TableFormat};
use crate::failure::Failure;

/// Message for Parquet in a program that was built without it.
pub(crate) const WITHOUT_PARQUET: &str = "parquet is not built into this program: build it with its default \
    features, as `cargo install --locked --path crates/cli` does";

/// Ending of the legacy format of VTK.
const LEGACY_VTK: &str = "vtk";

/// Endings of the formats of VTK that are written.
const VTK: [&str; 2] = ["vti", "vtp"];

/// The format that was `asked` for, or that the ending of `output` stands for, or else `default`.
///
/// Refuses a contradiction of the two, an ending that no format has, and binary data on a terminal.
pub(crate) fn choose<F: FileFormat>(asked: Option<F>, output: Option<&Path>, default: Option<F>) -> Result<F, Failure> {
    let formats = F::value_variants();
    let ending = output.and_then(|path| path.extension()).map(|ending| ending.to_string_lossy().to_lowercase());
    // Formats may share an ending, which then stands for the first of them.
    let has_ending = |format: &F| ending.as_ref().is_some_and(|e| format.file().endings.contains(&e.as_str()));
    let meant = asked.filter(has_ending).or_else(|| formats.iter().copied().find(has_ending));
    let path = || output.unwrap_or(Path::new("-")).display();
    let endings = |formats: &[F]| {
        let mut all: Vec<String> =
            formats.iter().flat_map(|f| f.file().endings).map(|ending| format!(".{ending}")).collect();
        all.dedup();
        all.join(", ")
    };
    let refused = |why: String| Err(Failure::Refused(format!("{}: {why}", path())));
    let format = match (asked, meant, &ending) {
        (Some(asked), Some(meant), _) if asked != meant => {
            let (option, asked, meant) = (F::OPTION.unwrap_or_default(), asked.name(), meant.name());
            return refused(format!(
                "the ending means {meant}, which contradicts {option} {asked}: change one of them"
            ));
        }
        (asked, None, Some(ending))
            if ending == LEGACY_VTK && asked.is_none_or(|asked| asked.file().is_known_by_ending) =>
        {
            let others = formats.iter().flat_map(|format| format.file().endings);
            let words = match others.filter(|ending| VTK.contains(ending)).count() {
                1 => "write .vtp",
                _ => "write .vti (grid) or .vtp (points)",
            };
            return refused(format!("the legacy format of VTK is not written: {words}"));
        }
        (Some(asked), None, Some(ending)) if asked.file().is_known_by_ending => {
            let (name, endings) = (asked.name(), endings(&[asked]));
            return refused(format!(
                "programs recognize {name} by the ending, and .{ending} is another format: use {endings}"
            ));
        }
        (None, None, Some(ending)) => {
            let endings = endings(formats);
            let other = F::OPTION.map_or_else(
                || {
                    let example = output.unwrap_or(Path::new("-")).with_extension(formats[0].file().endings[0]);
                    format!(", such as {}", example.display())
                },
                |option| format!(", or give {option}"),
            );
            return refused(format!("no format has the ending .{ending}: use one of {endings}{other}"));
        }
        (None, None, None) => match default {
            Some(format) => format,
            None => {
                let needed = F::OPTION
                    .map_or_else(|| format!("use one of {}", endings(formats)), |option| format!("give {option}"));
                return refused(format!("without an ending it has no format: {needed}"));
            }
        },
        (Some(format), _, _) | (None, Some(format), _) => format,
    };
    if format.file().is_binary && output.is_none_or(is_standard) && io::stdout().is_terminal() {
        return Err(Failure::Refused(format!(
            "{} is binary and would go to the terminal: give a file with -o, or redirect standard output",
            format.name()
        )));
    }
    Ok(format)
}

/// The format of a table whose rows are no points, but `things`.
pub(crate) fn choose_rows(
    asked: Option<TableFormat>,
    output: Option<&Path>,
    things: &str,
) -> Result<TableFormat, Failure> {
    let format = choose(asked, output, Some(TableFormat::Csv))?;
    if format == TableFormat::Vtk {
        return Err(Failure::Refused(format!("{things} have no place in VTK: give another --format")));
    }
    accept(format, None, false)?;
    Ok(format)
}

/// Refuses a format that is not built in, and a VTK file whose ending belongs to another kind of
/// points.
pub(crate) fn accept(format: TableFormat, output: Option<&Path>, on_grid: bool) -> Result<(), Failure> {
    if format == TableFormat::Parquet && cfg!(not(feature = "parquet")) {
        return Err(Failure::Refused(WITHOUT_PARQUET.to_owned()));
    }
    let (kind, ending) =
        if on_grid { ("the working volume is image data", "vti") } else { ("points of a file are poly data", "vtp") };
    let has_ending = |path: &Path| path.extension().is_none_or(|e| e.eq_ignore_ascii_case(ending));
    if let Some(path) = output.filter(|path| format == TableFormat::Vtk && !has_ending(path)) {
        return Err(Failure::Refused(format!(
            "{}: {kind}, which programs recognize by the ending: use .{ending}",
            path.display()
        )));
    }
    Ok(())
}
