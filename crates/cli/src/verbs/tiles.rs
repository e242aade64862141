//! `magsplice tiles`: lists the tiles of a layout and its bill of materials.

use std::fmt::Write;
use std::iter;
use std::path::{Path, PathBuf};

use magsplice::expect::NarrowGaps;
use magsplice::layout::{NamedTile, Rotation};
use magsplice::prelude::{DVec3, Tile};
use magsplice::results::{BillOfMaterials, MAX_KERF_MM, PartItem, twelve_digits};
#[cfg(feature = "report")]
use magsplice_report::{SvgText, bill_page, parts_figure};

use crate::args::formats::TilesFormat;
use crate::args::numbers::length_mm;
use crate::failure::Failure;
use crate::output::json;
use crate::remarks;
use crate::session::Session;
use crate::text::header::tile_count;
use crate::text::number::components;
use crate::text::rows;
use crate::text::units::in_deg;

/// List the tiles of a layout and its bill of materials.
///
/// The bill counts the pieces of each part. Tiles that differ only in position and orientation are
/// the same part. Angles give the direction of the polarization, from the first side of a part
/// towards the second.
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  magsplice tiles layouts/published-film.toml --kerf 0.2\n  magsplice tiles layouts/published-film.toml --format csv -o cut-list.csv"
)]
pub(crate) struct TilesArgs {
    /// Layout file
    layout: PathBuf,
    /// Format of the result
    #[arg(long, value_enum, default_value = "text")]
    format: TilesFormat,
    /// Width of material that each cut removes, such as 0.2mm; adds the area of sheet and the
    /// length of bar that the parts need
    #[arg(long = "kerf", alias = "kerf-mm", value_name = "LENGTH", value_parser = kerf, allow_hyphen_values = true)]
    kerf_mm: Option<f64>,
    /// File to write, complete or not at all [default: -, standard output]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Write the film and its bill of materials as a page to print (HTML)
    #[cfg(feature = "report")]
    #[arg(long, value_name = "PAGE")]
    page: Option<PathBuf>,
}

fn kerf(text: &str) -> Result<f64, String> {
    let kerf_mm = length_mm(text)?;
    let rule = || format!("must be a length from 0 to {MAX_KERF_MM} mm, such as 0.2mm");
    (0.0..=MAX_KERF_MM).contains(&kerf_mm).then_some(kerf_mm).ok_or_else(rule)
}

pub(crate) fn run(args: &TilesArgs, quiet: bool) -> Result<(), Failure> {
    let session = Session::open(&args.layout, remarks::OF_TILES, quiet)?;
    #[cfg(feature = "report")]
    let page = session.page(args.page.as_deref(), None)?;
    let output = args.output.as_deref().map(|path| session.output(Some(path), None)).transpose()?;
    let list = BillOfMaterials::new(&session.layout, args.kerf_mm);
    #[cfg(feature = "report")]
    if let Some(page) = page {
        let figure = parts_figure(&list, SvgText::Outlines)?;
        page.complete(&bill_page(&list, &figure))?;
    }
    let shown = match args.format {
        TilesFormat::Json => json::pretty(&list),
        TilesFormat::Text => format!("{}\n{}", text(&args.layout, &list), bill(&list)),
        TilesFormat::Csv => csv(&list),
    };
    match output {
        Some(output) => output.complete(&shown),
        None => session.print(&shown),
    }
}

/// Between the names of tiles in one cell. A comma would look like the next cell.
const BETWEEN_NAMES: &str = ";";

/// The cut list as CSV, one line for each part: its number, the number of pieces, sides in mm,
/// strength in T, angles of the polarization in degrees, the tiles made of it; with a kerf the
/// material; the tiles whose piece lies upside down.
fn csv(list: &BillOfMaterials) -> String {
    let mut head = vec!["part", "count", "a_mm", "b_mm", "c_mm", "strength_t", "direction_deg", "tilt_deg", "tiles"];
    if list.kerf_mm.is_some() {
        head.extend(["sheet_area_mm2", "bar_length_mm"]);
    }
    head.push("turned_over");
    let digits = |value: f64| twelve_digits(value).to_string();
    let row = |item: &PartItem| {
        let mut row = vec![item.part.to_string(), item.count.to_string()];
        row.extend(item.size_mm.to_array().map(digits));
        row.push(digits(item.strength_t));
        row.extend([item.direction_deg, item.tilt_deg].map(|angle| angle.map_or(String::new(), digits)));
        row.push(item.tiles.join(BETWEEN_NAMES));
        row.extend([item.sheet_area_mm2, item.bar_length_mm].into_iter().flatten().map(digits));
        row.push(item.turned_over.join(BETWEEN_NAMES));
        row
    };
    rows::csv(iter::once(head.into_iter().map(str::to_owned).collect()).chain(list.parts.iter().map(row)))
}

/// The tiles of a layout, one line each.
fn text(path: &Path, list: &BillOfMaterials) -> String {
    let layout = list.layout;
    let head = ["tile", "part", "size, mm", "centre, mm", "polarization in its own frame, T", "rotation"];
    let tiles = layout.tiles.iter().zip(list.part_numbers()).map(|(named, part)| tile_row(named, part));
    let table = rows::headed(head, tiles);
    format!("{}: {}, {}\n{table}{}", path.display(), layout.name, tile_count(layout), narrow_gaps(list))
}

/// Gaps below this are no gaps in a film as made: tiles are placed to about 0.01 mm at best, and
/// sawn sides are no better.
const NARROW_GAP_MM: f64 = 0.01;

/// A sentence about tiles that almost touch, if there are any.
fn narrow_gaps(list: &BillOfMaterials) -> String {
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
fn bill(list: &BillOfMaterials) -> String {
    let head = ["part", "pieces", "size, mm", "strength, T", "polarized from the first side", "such as"];
    let mut text = format!("bill of materials\n{}", rows::headed(head, list.parts.iter().map(part_row)));
    for item in list.parts.iter().filter(|item| !item.turned_over.is_empty()) {
        let (turned, count) = (item.turned_over.len(), item.count);
        let words =
            format!("part {}: {turned} of {count} pieces lie upside down: {}", item.part, item.turned_over.join(", "));
        rows::prose(&mut text, &words);
    }
    if let Some(kerf_mm) = list.kerf_mm {
        text += &material(&list.parts, kerf_mm);
    }
    text
}

/// The sheet or the bars that the parts need.
fn material(parts: &[PartItem], kerf_mm: f64) -> String {
    let head = ["part", "pieces", "size, mm", "sheet, mm2", "or bar, mm"];
    let row = |item: &PartItem| {
        let section = size2(item.size_mm.y, item.size_mm.z);
        let bar = format!("{} of {section}", short(item.bar_length_mm.unwrap_or_default()));
        let sheet = short(item.sheet_area_mm2.unwrap_or_default());
        [item.part.to_string(), item.count.to_string(), size(item.size_mm), sheet, bar]
    };
    let table = rows::headed(head, parts.iter().map(row));
    let mut text = format!("\nmaterial with a kerf of {} mm\n{table}", short(kerf_mm));
    let mut sheets: Vec<(f64, f64)> = Vec::new();
    for part in parts {
        let area = part.sheet_area_mm2.unwrap_or_default();
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

fn tile_row(named: &NamedTile, part: usize) -> [String; 6] {
    let NamedTile { name, tile, rotation, .. } = named;
    let turn = rotation.map_or(String::new(), |rotation| {
        // As written; the other forms are easier to read as an axis and an angle too.
        let (axis, angle_deg) = match rotation {
            Rotation::AxisAngle { axis, angle_deg } => (axis.into(), angle_deg),
            other => {
                let (axis, angle) = other.quaternion().to_axis_angle();
                (axis, in_deg(angle))
            }
        };
        format!("{} deg about {}", short(angle_deg), triple(axis))
    });
    let [size, centre, j] = [size(tile.size()), triple(tile.position()), triple(tile.polarization_t())];
    [name.clone(), part.to_string(), size, centre, j, turn]
}

fn part_row(item: &PartItem) -> [String; 6] {
    let angle = match (item.direction_deg, item.tilt_deg) {
        (Some(direction), Some(0.0)) => format!("{} deg", short(direction)),
        (Some(_), Some(tilt)) if tilt.abs() == 90.0 => format!("{} deg out of plane", short(tilt)),
        (Some(direction), Some(tilt)) => format!("{} deg, {} deg out of plane", short(direction), short(tilt)),
        _ => "not polarized".to_owned(),
    };
    let [number, count] = [item.part, item.count].map(|n| n.to_string());
    [number, count, size(item.size_mm), short(item.strength_t), angle, item.tiles[0].clone()]
}

fn size2(first: f64, second: f64) -> String {
    format!("{} x {} mm", short(first), short(second))
}

fn size(v: DVec3) -> String {
    v.to_array().map(short).join(" x ")
}

fn triple(v: DVec3) -> String {
    format!("({})", components(v).map(short).join(", "))
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
