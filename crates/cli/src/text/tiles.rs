//! `tiles`: the tiles of a layout and its bill of materials.

use std::path::Path;

use magsplice::layout::{Layout, NamedTile, Part, Rotation};
use magsplice::prelude::DVec3;

use super::header::tile_count;
use super::rows;

/// The tiles of a layout, one line each.
pub(crate) fn tiles(path: &Path, layout: &Layout) -> String {
    let head = ["tile", "size, mm", "centre, mm", "polarization in its own frame, T", "rotation"].map(str::to_owned);
    let rows: Vec<[String; 5]> = std::iter::once(head).chain(layout.tiles.iter().map(tile_row)).collect();
    format!("{}: {}, {}\n{}", path.display(), layout.name, tile_count(layout), table(&rows))
}

/// The parts of a layout and how many pieces of each there are.
pub(crate) fn bill(layout: &Layout) -> String {
    let head = ["pieces", "size, mm", "strength, T", "direction along its sides", "such as"].map(str::to_owned);
    let rows: Vec<[String; 5]> = std::iter::once(head).chain(layout.parts().into_iter().map(part_row)).collect();
    format!("bill of materials\n{}", table(&rows))
}

fn table(rows: &[[String; 5]]) -> String {
    rows::columns(rows).into_iter().map(|line| line + "\n").collect()
}

fn tile_row(named: &NamedTile) -> [String; 5] {
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
    [name.clone(), size(tile.size()), triple(tile.position()), triple(tile.polarization_t()), turn]
}

fn part_row(part: Part) -> [String; 5] {
    [part.count.to_string(), size(part.size_mm), short(part.strength_t), triple(part.direction), part.example]
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
