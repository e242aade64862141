//! `magsplice import`: makes a layout from a table of blocks.

use std::collections::HashMap;
use std::path::Path;

use magsplice::layout::{Layout, LayoutError, LayoutFault, meant_length};

use crate::args::import::ImportArgs;
use crate::csv_input::table::is_stdin;
use crate::failure::{self, Failure};
use crate::faults::FaultList;
use crate::inputs::blocks::{self, Blocks, SMALLEST_MAGNET_MM};
use crate::output::destination::{self, Output};
use crate::text::number::counted;

pub(crate) fn run(args: &ImportArgs, quiet: bool) -> Result<(), Failure> {
    let mut output = Output::open(args.output.as_deref(), &[&args.blocks])?;
    let Blocks { tiles, lines, ignored, suspicious_size_mm } = blocks::read(&args.blocks, args)?;
    let place = args.blocks.display().to_string();
    let source = if is_stdin(&args.blocks) { "standard input".to_owned() } else { file_name(&args.blocks) };
    let history = vec![format!("imported from {source} by magsplice {}", env!("CARGO_PKG_VERSION"))];
    let name = args.name.clone().unwrap_or_else(|| stem(&args.blocks));
    let layout = Layout { name, history, tiles, ..Layout::default() };
    let layout = layout.checked(&place).map_err(|error| in_lines(error, &place, &lines))?;
    output.write(|w| w.write_all(layout.to_toml().as_bytes()))?;
    let to_file = !output.is_standard();
    output.finish()?;
    if quiet {
        return Ok(());
    }
    if !ignored.is_empty() {
        failure::tell(&format_args!("{place}: columns that were not read: {}", ignored.join(", ")));
    }
    if let Some(largest_mm) = suspicious_size_mm {
        failure::tell(&format_args!(
            "warning: {place}: the largest block measures {largest_mm} mm, less than {SMALLEST_MAGNET_MM} mm; {}",
            meant_length(largest_mm)
        ));
    }
    for finding in &layout.findings {
        failure::tell(&format_args!("{place}: {finding}"));
    }
    if let Some(file) = args.output.as_ref().filter(|file| to_file && !destination::is_standard(file)) {
        let (file, tiles) = (file.display(), counted(layout.tiles.len(), "tile", "tiles"));
        failure::tell(&format_args!(
            "wrote {file}: {tiles}; give points (`magsplice field {file} --points P.csv`), or add [volume], and [ideal] \
             for `decouple`"
        ));
    }
    Ok(())
}

fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}

/// The name of a layout from this file.
fn stem(path: &Path) -> String {
    let stem = path.file_stem().filter(|_| !is_stdin(path));
    stem.map_or("blocks".to_owned(), |stem| stem.to_string_lossy().into_owned())
}

/// Broken rules of a layout with the lines of the blocks, which the places name.
fn in_lines(error: LayoutError, place: &str, lines: &HashMap<String, u64>) -> Failure {
    let LayoutError::Invalid { faults, .. } = error else { return Failure::Layout(error) };
    let mut listed = FaultList::default();
    for LayoutFault { place, message, .. } in faults {
        let named = place.split('"').skip(1).step_by(2).filter_map(|name| lines.get(name));
        let named: Vec<String> = named.map(u64::to_string).collect();
        let at = match &named[..] {
            [] => String::new(),
            [line] => format!("line {line}: "),
            all => format!("lines {}: ", all.join(" and ")),
        };
        listed.add(0, format!("{at}{place}: {message}"));
    }
    listed.failure(place.to_owned())
}
