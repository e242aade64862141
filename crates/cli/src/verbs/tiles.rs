//! `magsplice tiles`: the tiles of a layout.

use std::fmt::Write;
use std::path::Path;

use magsplice::layout::{Layout, NamedTile, Part};
use magsplice::prelude::DVec3;

use crate::args::{Format, TilesArgs};
use crate::failure::Failure;
use crate::output;
use crate::progress::Progress;
use crate::text::{self, tile_count};

pub(crate) fn run(args: &TilesArgs, quiet: bool) -> Result<(), Failure> {
    let progress = Progress::start(!quiet);
    let layout = Layout::read(&args.layout)?;
    let text = match args.format {
        Format::Json => text::json(&layout.plain()),
        Format::Text => format!("{}\n{}", listed(&args.layout, &layout), bill(&layout)),
    };
    progress.end();
    output::print(&text)
}

/// The tiles of a layout, one line each.
fn listed(path: &Path, layout: &Layout) -> String {
    let head = ["tile", "size, mm", "centre, mm", "polarization in its own frame, T", "rotation"].map(str::to_owned);
    let rows = std::iter::once(head).chain(layout.tiles.iter().map(tile_row)).collect();
    format!("{}: {}, {}\n{}", path.display(), layout.name, tile_count(layout), table(rows))
}

/// How many pieces of which size, strength and direction.
fn bill(layout: &Layout) -> String {
    let head = ["pieces", "size, mm", "strength, T", "direction along its sides", "such as"].map(str::to_owned);
    let row = |part: Part| {
        let size = part.size_mm.to_array().map(short).join(" x ");
        [part.count.to_string(), size, short(part.strength_t), triple(part.direction), part.example]
    };
    let rows = std::iter::once(head).chain(layout.parts().into_iter().map(row)).collect();
    format!("bill of materials\n{}", table(rows))
}

/// Rows in columns as wide as they must be.
fn table(rows: Vec<[String; 5]>) -> String {
    let widths = [0, 1, 2, 3].map(|column| rows.iter().map(|row| row[column].len()).max().unwrap_or(0));
    let mut text = String::new();
    for row in rows {
        let mut line = String::new();
        for (cell, width) in row.iter().zip(widths) {
            let _ = write!(line, "  {cell:<width$}");
        }
        let _ = writeln!(text, "{}", format!("{line}  {}", row[4]).trim_end());
    }
    text
}

fn tile_row(named: &NamedTile) -> [String; 5] {
    let NamedTile { name, tile, rotation, .. } = named;
    let turn =
        rotation.map_or(String::new(), |r| format!("{} deg about {}", short(r.angle_deg), triple(r.axis.into())));
    let size = tile.size().to_array().map(short).join(" x ");
    [name.clone(), size, triple(tile.position()), triple(tile.polarization_t()), turn]
}

fn triple(v: DVec3) -> String {
    let [x, y, z] = v.to_array().map(short);
    format!("({x}, {y}, {z})")
}

/// Six decimals without the zeros that say nothing; very large and very small numbers with six digits.
fn short(value: f64) -> String {
    if value != 0.0 && !(1e-4..1e7).contains(&value.abs()) {
        return format!("{value:.5e}");
    }
    let text = format!("{value:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}
