//! The cut list: the parts of a layout, and the material that they need.

use magsplice::layout::{Layout, Part};
use magsplice_export::twelve_digits;

/// The parts of a layout, largest first. They are numbered from 1 on in this order, here, in the
/// bill of materials and on the layers of a drawing.
pub(crate) struct CutList<'a> {
    pub(crate) layout: &'a Layout,
    pub(crate) parts: Vec<Part>,
    /// Width of material that a cut removes, in mm, if the material is asked for.
    pub(crate) kerf_mm: Option<f64>,
}

/// Between the names of tiles in one cell. A comma would look like the next cell.
const BETWEEN_NAMES: &str = ";";

impl CutList<'_> {
    pub(crate) fn new(layout: &Layout, kerf_mm: Option<f64>) -> CutList<'_> {
        CutList { layout, parts: layout.parts(), kerf_mm }
    }

    /// The number of the part that each tile is.
    pub(crate) fn part_numbers(&self) -> Vec<usize> {
        let mut numbers = vec![0; self.layout.tiles.len()];
        for (index, part) in self.parts.iter().enumerate() {
            for &tile in &part.tiles {
                numbers[tile] = index + 1;
            }
        }
        numbers
    }

    /// The names of the tiles of a part, in the order of the layout.
    pub(crate) fn names(&self, part: &Part) -> Vec<&str> {
        part.tiles.iter().map(|&tile| self.layout.tiles[tile].name.as_str()).collect()
    }

    /// The list as CSV, one line for each part: its number, the number of pieces, sides in mm,
    /// strength in T, angles of the polarization in degrees, the tiles made of it; with a kerf the
    /// material.
    pub(crate) fn csv(&self) -> String {
        let mut head =
            vec!["part", "count", "a_mm", "b_mm", "c_mm", "strength_t", "direction_deg", "tilt_deg", "tiles"];
        if self.kerf_mm.is_some() {
            head.extend(["sheet_area_mm2", "bar_length_mm"]);
        }
        let mut writer = csv::Writer::from_writer(Vec::new());
        let mut write = |row: &[String]| writer.write_record(row).expect("memory takes every row");
        write(&head.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>());
        for (index, part) in self.parts.iter().enumerate() {
            let angles = part.angles_deg().map_or([String::new(), String::new()], |angles| angles.map(digits));
            let sides = part.size_mm.to_array().map(digits);
            let mut row = vec![(index + 1).to_string(), part.count.to_string()];
            row.extend(sides);
            row.push(digits(part.strength_t));
            row.extend(angles);
            row.push(self.names(part).join(BETWEEN_NAMES));
            if let Some(kerf_mm) = self.kerf_mm {
                row.extend([sheet_area_mm2(part, kerf_mm), bar_length_mm(part, kerf_mm)].map(digits));
            }
            write(&row);
        }
        let bytes = writer.into_inner().expect("memory takes every row");
        String::from_utf8(bytes).expect("text is written as text")
    }
}

fn digits(value: f64) -> String {
    twelve_digits(value).to_string()
}

/// Area of a sheet, as thick as the third side, for all pieces of a part. Each piece takes its
/// first two sides with one kerf each.
pub(crate) fn sheet_area_mm2(part: &Part, kerf_mm: f64) -> f64 {
    part.count as f64 * (part.size_mm.x + kerf_mm) * (part.size_mm.y + kerf_mm)
}

/// Length of a bar with the second and third side as its section, for all pieces of a part. Each
/// piece takes its first side with one kerf.
pub(crate) fn bar_length_mm(part: &Part, kerf_mm: f64) -> f64 {
    part.count as f64 * (part.size_mm.x + kerf_mm)
}
