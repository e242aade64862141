//! Tables: a grid as image data, points as poly data.

use std::io::{self, Write};

use magsplice_field::Grid;

use super::dataset::{Array, Dataset, Values};
use crate::table::{Points, Table};

/// Writes a grid as image data (`.vti`) and scattered points as vertices of poly data (`.vtp`), in millimetres.
///
/// # Accuracy
/// Values are the same numbers. Points of image data follow from the first one and the step, so their coordinates are off by round-off.
///
/// # Errors
/// Those of the writer.
pub fn table(table: &Table, w: &mut dyn Write) -> io::Result<()> {
    match &table.points {
        Points::Grid(grid) => image_data(table, grid, w),
        Points::Scattered(_) => vertices(table, w),
    }
}

fn image_data(table: &Table, grid: &Grid, w: &mut dyn Write) -> io::Result<()> {
    let [nx, ny, nz] = grid.counts();
    let extent = format!("0 {} 0 {} 0 {}", nx - 1, ny - 1, nz - 1);
    let step = |axis: usize| match grid.counts()[axis] {
        1 => 1.0,
        count => (grid.upper()[axis] - grid.lower()[axis]) / (count - 1) as f64,
    };
    let (o, [dx, dy, dz]) = (grid.lower(), [0, 1, 2].map(step));
    let place = format!("Origin=\"{:?} {:?} {:?}\" Spacing=\"{dx:?} {dy:?} {dz:?}\"", o.x, o.y, o.z);
    // In VTK x runs fastest.
    let row = move |index: usize| (index % nx * ny + index / nx % ny) * nz + index / (nx * ny);
    Dataset {
        kind: "ImageData",
        attributes: [format!("WholeExtent=\"{extent}\" {place}"), format!("Extent=\"{extent}\"")],
        sections: vec![("PointData", quantities(table, row))],
        metadata: &table.metadata,
    }
    .write(w)
}

fn vertices(table: &Table, w: &mut dyn Write) -> io::Result<()> {
    let count = table.points.len();
    let coordinates = (0..count).flat_map(|row| table.points.get(row).to_array());
    let points = Values::Float64(3 * count, Box::new(coordinates));
    let index = |name, first: usize| Array {
        name,
        components: &[],
        values: Values::Int64(count, Box::new((0..count).map(move |i| i + first))),
    };
    Dataset {
        kind: "PolyData",
        attributes: [String::new(), format!("NumberOfPoints=\"{count}\" NumberOfVerts=\"{count}\"")],
        sections: vec![
            ("PointData", quantities(table, |index| index)),
            ("Points", vec![Array { name: "Points", components: &["x_mm", "y_mm", "z_mm"], values: points }]),
            ("Verts", vec![index("connectivity", 0), index("offsets", 1)]),
        ],
        metadata: &table.metadata,
    }
    .write(w)
}

/// The quantities, each point taken from the `row` of the table for its index.
fn quantities<'a>(table: &'a Table, row: impl Fn(usize) -> usize + Copy + 'a) -> Vec<Array<'a>> {
    let array = |quantity: &'a crate::Quantity| {
        let (values, step) = (&quantity.values, quantity.components.len());
        let in_order =
            (0..table.points.len()).map(row).flat_map(move |row| values[row * step..][..step].iter().copied());
        Array {
            name: quantity.name,
            components: if step == 1 { &[] } else { quantity.components },
            values: Values::Float64(values.len(), Box::new(in_order)),
        }
    };
    table.quantities.iter().map(array).collect()
}
