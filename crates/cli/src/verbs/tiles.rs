//! `magsplice tiles`: the tiles of a layout.

use std::fmt::Write;
use std::path::Path;

use magsplice::layout::{Layout, NamedTile};
use magsplice::prelude::DVec3;

use crate::args::TilesArgs;
use crate::failure::Failure;
use crate::output;
use crate::text::tile_count;

pub(crate) fn run(args: &TilesArgs) -> Result<(), Failure> {
    let layout = Layout::read(&args.layout)?;
    output::print(&listed(&args.layout, &layout))
}

/// The tiles of a layout, one line each.
fn listed(path: &Path, layout: &Layout) -> String {
    let head = ["tile", "size, mm", "centre, mm", "polarization in its own frame, T", "rotation"].map(str::to_owned);
    let rows: Vec<[String; 5]> = std::iter::once(head).chain(layout.tiles.iter().map(tile_row)).collect();
    let width = |column: usize| rows.iter().map(|row| row[column].len()).max().unwrap_or(0);
    let widths = [0, 1, 2, 3].map(width);
    let mut text = format!("{}: {}, {}\n", path.display(), layout.name, tile_count(layout));
    for row in &rows {
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
