//! `tiles`: the tiles of a layout and its bill of materials.

use std::fmt::Write;
use std::path::Path;

use magsplice::expect::NarrowGaps;
use magsplice::layout::{NamedTile, Part, Rotation};
use magsplice::prelude::{DVec3, Tile};

use super::header::tile_count;
use super::rows;
use crate::cut_list::{CutList, bar_length_mm, sheet_area_mm2};

/// The tiles of a layout, one line each.
pub(crate) fn tiles(path: &Path, list: &CutList) -> String {
    let layout = list.layout;
    let head =
        ["tile", "part", "size, mm", "centre, mm", "polarization in its own frame, T", "rotation"].map(str::to_owned);
    let tiles = layout.tiles.iter().zip(list.part_numbers()).map(|(named, part)| tile_row(named, part));
    let rows: Vec<[String; 6]> = std::iter::once(head).chain(tiles).collect();
    format!("{}: {}, {}\n{}{}", path.display(), layout.name, tile_count(layout), table(&rows), narrow_gaps(list))
}

/// Gaps below this are no gaps in a made film: tiles are placed to about 0.01 mm at best, and sawn
/// sides are no better.
const NARROW_GAP_MM: f64 = 0.01;

/// A sentence about tiles that almost touch, if there are any.
fn narrow_gaps(list: &CutList) -> String {
    let tiles: Vec<Tile> = list.layout.tiles.iter().map(|named| named.tile).collect();
    NarrowGaps::below(NARROW_GAP_MM, &tiles).map_or(String::new(), |NarrowGaps { pairs, smallest }| {
        let [pairs, verb, not] =
            if pairs == 1 { ["1 pair".to_owned(), "is".to_owned(), "does".to_owned()] } else { [format!("{pairs} pairs"), "are".to_owned(), "do".to_owned()] };
        format!(
            "{pairs} of tiles {verb} less than {NARROW_GAP_MM} mm apart and {not} not touch; the smallest gap is {} mm\n",
            short(smallest)
        )
    })
}

/// The parts of a layout and how many pieces of each there are; with a kerf also the material.
pub(crate) fn bill(list: &CutList) -> String {
    let head =
        ["part", "pieces", "size, mm", "strength, T", "polarized from the first side", "such as"].map(str::to_owned);
    let rows: Vec<[String; 6]> = std::iter::once(head).chain(list.parts.iter().enumerate().map(part_row)).collect();
    let mut text = format!("bill of materials\n{}", table(&rows));
    if let Some(kerf_mm) = list.kerf_mm {
        text += &material(&list.parts, kerf_mm);
    }
    text
}

/// The sheet or the bars that the parts need.
fn material(parts: &[Part], kerf_mm: f64) -> String {
    let head = ["part", "pieces", "size, mm", "sheet, mm2", "or bar, mm"].map(str::to_owned);
    let row = |(index, part): (usize, &Part)| {
        let section = size2(part.size_mm.y, part.size_mm.z);
        let bar = format!("{} of {section}", short(bar_length_mm(part, kerf_mm)));
        let sheet = short(sheet_area_mm2(part, kerf_mm));
        [(index + 1).to_string(), part.count.to_string(), size(part.size_mm), sheet, bar]
    };
    let rows: Vec<[String; 5]> = std::iter::once(head).chain(parts.iter().enumerate().map(row)).collect();
    let mut text = format!("\nmaterial with a kerf of {} mm\n{}", short(kerf_mm), table(&rows));
    let mut sheets: Vec<(f64, f64)> = Vec::new();
    for part in parts {
        let area = sheet_area_mm2(part, kerf_mm);
        match sheets.iter_mut().find(|(thickness, _)| *thickness == part.size_mm.z) {
            Some((_, sum)) => *sum += area,
            None => sheets.push((part.size_mm.z, area)),
        }
    }
    for (thickness, area) in sheets {
        let _ = writeln!(text, "  sheet of {} mm: {} mm2 in all", short(thickness), short(area));
    }
    text + "  A piece takes its first and second side of the sheet, or its first side of the bar, each with\n  one \
            kerf. Rims of the sheet, ends of bars and the direction of magnetization are not counted.\n"
}

fn table<const N: usize>(rows: &[[String; N]]) -> String {
    rows::columns(rows).into_iter().map(|line| line + "\n").collect()
}

fn tile_row(named: &NamedTile, part: usize) -> [String; 6] {
    let NamedTile { name, tile, rotation, .. } = named;
    let turn = rotation.map_or(String::new(), |rotation| {
        // As written; the other forms are easier to read as an axis and an angle too.
        let (axis, angle_deg) = match rotation {
            Rotation::AxisAngle { axis, angle_deg } => (axis.into(), angle_deg),
            other => {
                let (axis, angle) = other.quaternion().to_axis_angle();
                (axis, angle.to_degrees())
            }
        };
        format!("{} deg about {}", short(angle_deg), triple(axis))
    });
    let [size, centre, j] = [size(tile.size()), triple(tile.position()), triple(tile.polarization_t())];
    [name.clone(), part.to_string(), size, centre, j, turn]
}

fn part_row((index, part): (usize, &Part)) -> [String; 6] {
    let angle = match part.angles_deg() {
        None => "not polarized".to_owned(),
        Some([direction, 0.0]) => format!("{} deg", short(direction)),
        Some([_, tilt]) if tilt.abs() == 90.0 => format!("{} deg out of plane", short(tilt)),
        Some([direction, tilt]) => format!("{} deg, {} deg out of plane", short(direction), short(tilt)),
    };
    let [number, count] = [index + 1, part.count].map(|n| n.to_string());
    [number, count, size(part.size_mm), short(part.strength_t), angle, part.example.clone()]
}

fn size2(first: f64, second: f64) -> String {
    format!("{} x {} mm", short(first), short(second))
}

fn size(v: DVec3) -> String {
    v.to_array().map(short).join(" x ")
}

fn triple(v: DVec3) -> String {
    format!("({})", v.to_array().map(short).join(", "))
}

/// Six decimals without trailing zeros; very large and very small numbers with six digits.
fn short(value: f64) -> String {
    if value != 0.0 && !(1e-4..1e7).contains(&value.abs()) {
        return format!("{value:.5e}");
    }
    let text = format!("{value:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}
