//! Pages to print: bill of materials, cut list, placement plan.

use magsplice::layout::Layout;
use magsplice::making::PlanRow;
use magsplice::results::{BillOfMaterials, PartItem, twelve_digits};

use crate::drawing::{Drawing, SvgText};
use crate::error::ReportError;
use crate::figures::layout_from_above::layout_figure;
use crate::printed_page::{PrintedTable, printed_page};

/// The tiles of a film from above, each with the number of its part in the bill of materials.
///
/// # Errors
/// [`ReportError::Drawing`] if the figure cannot be drawn.
pub fn parts_figure(list: &BillOfMaterials, text: SvgText) -> Result<Drawing, ReportError> {
    let mut layout = list.layout.clone();
    for (named, part) in layout.tiles.iter_mut().zip(list.part_numbers()) {
        named.name = part.to_string();
    }
    let caption = "The tiles seen from above, with their polarization and the numbers of their parts.".to_owned();
    Ok(Drawing { caption, ..layout_figure(&layout, text)? })
}

/// A page with a film and its bill of materials, as HTML. `figure` is the [`parts_figure`].
pub fn bill_page(list: &BillOfMaterials, figure: &Drawing) -> String {
    let layout = list.layout;
    let numbers = "The numbers in the drawing are the numbers of the parts.".to_owned();
    page(layout, &layout.name, &[summary(list), numbers], figure, &[bill(list)])
}

/// A page with the plan by which a film is placed, and its bill of materials, as HTML.
pub fn plan_page(list: &BillOfMaterials, figure: &Drawing, plan: &[PlanRow]) -> String {
    let layout = list.layout;
    let marks = "Before a tile is measured, an arrow is drawn on its upper side along its x axis, which is along the first \
                 side of its part. In the plan the column up gives the side of the tile that is up at its place: +z is the \
                 side with the arrow, -z is the tile turned over. The angle of the mark is counted from the x axis of the \
                 film towards its y axis, as seen from above. The mark of a tile that stands on its x side is its y axis."
        .to_owned();
    let paragraphs = [summary(list), marks];
    page(layout, &format!("Placement plan: {}", layout.name), &paragraphs, figure, &[plan_table(plan), bill(list)])
}

fn page(layout: &Layout, title: &str, paragraphs: &[String], figure: &Drawing, tables: &[PrintedTable]) -> String {
    let source = format!(
        "Layout \"{}\", SHA-256 {}; magsplice {}. Lengths in mm.",
        layout.name,
        layout.sha256,
        env!("CARGO_PKG_VERSION")
    );
    printed_page(title, paragraphs, figure, tables, &source)
}

fn summary(list: &BillOfMaterials) -> String {
    let counted = |count: usize, one: &str, many: &str| format!("{count} {}", if count == 1 { one } else { many });
    let tiles = counted(list.layout.tiles.len(), "tile", "tiles");
    format!("{tiles} of {}.", counted(list.parts.len(), "part", "different parts"))
}

fn bill(list: &BillOfMaterials) -> PrintedTable<'static> {
    let mut columns = vec!["part", "pieces", "size, mm", "J, T", "direction, deg", "tilt, deg", "tiles"];
    let mut remark =
        "Angles give the direction of J, from the first side of a part towards the second, and out of the \
                      plane of both."
            .to_owned();
    if let Some(kerf_mm) = list.kerf_mm {
        columns.splice(6..6, ["sheet, mm2", "or bar, mm"]);
        remark += &format!(
            " Material with a kerf of {kerf_mm} mm: each piece takes its first two sides of a sheet, or its first side of \
             a bar, each with one kerf."
        );
    }
    if list.parts.iter().any(|item| !item.turned_over.is_empty()) {
        remark += " Pieces that lie upside down have J marked on the other side.";
    }
    let digits = |value: f64| twelve_digits(value).to_string();
    let row = |item: &PartItem| {
        let angles = [item.direction_deg, item.tilt_deg];
        let mut row = vec![
            item.part.to_string(),
            item.count.to_string(),
            item.size_mm.to_array().map(digits).join(" x "),
            digits(item.strength_t),
            angles[0].map_or("none".to_owned(), digits),
            angles[1].map_or(String::new(), digits),
        ];
        row.extend([item.sheet_area_mm2, item.bar_length_mm].into_iter().flatten().map(digits));
        let mut tiles = item.tiles.join(", ");
        if !item.turned_over.is_empty() {
            tiles += &format!("; upside down: {}", item.turned_over.join(", "));
        }
        row.push(tiles);
        row
    };
    let rows = list.parts.iter().map(row).collect();
    PrintedTable { heading: "Bill of materials", remark, columns, rows, has_boxes: false }
}

fn plan_table(plan: &[PlanRow]) -> PrintedTable<'static> {
    let row = |row: &PlanRow| {
        let [x, y, z] = row.centre_mm.to_array().map(|value| twelve_digits(value).to_string());
        let (angle, placed) = (row.mark_deg.to_string(), if row.is_placed { "yes" } else { "" });
        [&row.place, &row.tile, &x, &y, &z, row.up, row.mark, &angle, placed].map(str::to_owned).to_vec()
    };
    PrintedTable {
        heading: "Plan",
        remark: "Centres of the tiles in mm. Placed tiles come first, then row by row from the largest y, from left to right.".to_owned(),
        columns: vec!["place", "tile", "x", "y", "z", "up", "mark", "angle, deg", "placed"],
        rows: PlanRow::in_placing_order(plan).into_iter().map(row).collect(),
        has_boxes: true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drawing_of_the_bill_has_the_numbers_of_the_parts() {
        let tile = |name: &str, x: f64, side: f64| {
            format!(
                "[[tile]]\nname = \"{name}\"\nposition_mm = [{x}, 0, 0.5]\nsize_mm = [{side}, 3, 1]\n\
                 polarization_t = [0, 0.1, 0]\n"
            )
        };
        let tiles = [tile("left", -4.0, 3.0), tile("middle", 0.0, 3.0), tile("right", 4.0, 2.5)].concat();
        let layout = Layout::parse(&format!("format = 1\nname = \"three\"\n{tiles}"), "test").expect("a layout");
        let drawn = parts_figure(&BillOfMaterials::new(&layout, None), SvgText::Text).expect("a drawing").svg;
        // The labels of the tiles come before the numbers of the axes.
        let labels: Vec<&str> = drawn.lines().filter(|line| !line.starts_with('<')).take(3).collect();
        assert_eq!(labels, ["1", "1", "2"], "{drawn}");
    }
}
