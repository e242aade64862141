//! Tables for VTK: a grid as image data, scattered points as poly data.

use std::io::{self, Write};

use magsplice_magnet::Grid;

use super::dataset::{VtkArray, VtkDataset};
use magsplice::results::{ColumnQuantity, Points, Rows, Table};

/// Writes a table: a grid as image data (`.vti`), scattered points as vertices of poly data
/// (`.vtp`). Lengths are in millimetres.
///
/// # Accuracy
/// Quantities keep every digit. VTK computes the points of image data from the first point and the
/// spacing, so their coordinates differ from the table's by round-off.
///
/// # Errors
/// Errors of the writer, and rows without points.
pub fn table(table: &Table, w: &mut dyn Write) -> io::Result<()> {
    match table.rows() {
        Rows::Points(Points::Grid(grid)) => image_data(table, grid, w),
        Rows::Points(points) => vertices(table, points, w),
        Rows::Numbered { .. } => Err(io::Error::other("rows without points have no place in VTK")),
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
    // x varies fastest in VTK; z varies fastest in a table.
    let row = move |index: usize| (index % nx * ny + index / nx % ny) * nz + index / (nx * ny);
    VtkDataset {
        kind: "ImageData",
        attributes: [format!("WholeExtent=\"{extent}\" {place}"), format!("Extent=\"{extent}\"")],
        sections: vec![("PointData", quantities(table, row))],
        metadata: table.metadata(),
    }
    .write(w)
}

fn vertices(table: &Table, points: &Points, w: &mut dyn Write) -> io::Result<()> {
    let count = points.len();
    let coordinates = points.iter().flat_map(|point| point.to_array());
    let index = |name, first: usize| VtkArray::integers(name, count, (0..count).map(move |i| i + first));
    VtkDataset {
        kind: "PolyData",
        attributes: [String::new(), format!("NumberOfPoints=\"{count}\" NumberOfVerts=\"{count}\"")],
        sections: vec![
            ("PointData", quantities(table, |index| index)),
            ("Points", vec![VtkArray::floats("Points", &["x_mm", "y_mm", "z_mm"], 3 * count, coordinates)]),
            ("Verts", vec![index("connectivity", 0), index("offsets", 1)]),
        ],
        metadata: table.metadata(),
    }
    .write(w)
}

/// The arrays of the quantities. `row` maps the index of a point in VTK to its row in the table.
fn quantities<'a>(table: &'a Table, row: impl Fn(usize) -> usize + Copy + 'a) -> Vec<VtkArray<'a>> {
    let array = |quantity: &'a ColumnQuantity| {
        let (values, step) = (&quantity.values, quantity.components.len());
        let in_order =
            (0..table.rows().len()).map(row).flat_map(move |row| values[row * step..][..step].iter().copied());
        let components = if step == 1 { &[] } else { quantity.components };
        if quantity.is_whole {
            return VtkArray::integers(quantity.name, values.len(), in_order.map(|value| value as usize));
        }
        VtkArray::floats(quantity.name, components, values.len(), in_order)
    };
    table.quantities().iter().map(array).collect()
}
