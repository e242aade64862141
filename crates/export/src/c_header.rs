//! The displacement of a sensor as a C header.

use std::io::{self, Write};

use glam::{DMat3, DVec3};
use magsplice_layout::Layout;

/// The header, with placeholders `{...}` for its data.
const HEADER: &str = include_str!("c_header.h");

/// A polynomial of R_x, R_y and S_z.
#[derive(Clone, Copy, Debug)]
pub struct DisplacementTable<'a> {
    /// Highest sum of degrees.
    pub degree: usize,
    /// The sign of B_z on the axis.
    pub branch_sign: f64,
    /// Least R_x, R_y, S_z.
    pub lower: [f64; 3],
    /// Largest R_x, R_y, S_z.
    pub upper: [f64; 3],
    /// Millimetres along x, y, z for each term: products of Chebyshev polynomials of the degrees i,
    /// j and k, in the order of i, then j, then k.
    pub coefficients: &'a [[f64; 3]],
    /// Largest error in millimetres.
    pub largest_error_mm: f64,
    /// Number of points at which it was measured.
    pub checked: usize,
    /// Lower corner of the working volume, in millimetres.
    pub volume_lower_mm: DVec3,
    /// Its upper corner.
    pub volume_upper_mm: DVec3,
    /// The point from which displacements count.
    pub reference_mm: DVec3,
    /// Takes readings without their offset to flux densities along the axes of the film.
    pub field_of_reading: DMat3,
    /// Offset of the readings, in tesla.
    pub offset_t: DVec3,
}

/// Writes a header of C99 with one function, which computes in `float` and needs no other file than
/// `math.h`. `version` is the version of the program that writes it.
///
/// # Errors
/// Errors of the writer.
pub fn displacement(layout: &Layout, table: &DisplacementTable, version: &str, w: &mut dyn Write) -> io::Result<()> {
    let DisplacementTable { volume_lower_mm: low, volume_upper_mm: high, reference_mm: reference, .. } = table;
    let row = |values: [f64; 3]| values.map(float).join(", ");
    let rows: String = table.coefficients.iter().map(|values| format!("    {{{}}},\n", row(*values))).collect();
    let axes = [0, 1, 2].map(|axis| format!("{{{}}}", row(table.field_of_reading.row(axis).to_array()))).join(", ");
    let range = |axis: usize| format!("{} .. {}", low[axis], high[axis]);
    // A name may contain the beginning or the end of a comment.
    let name = layout.name.replace("*/", "* /").replace("/*", "/ *");
    let text = HEADER
        .replace("{{lower}}", &format!("{{{}}}", row(table.lower)))
        .replace("{{upper}}", &format!("{{{}}}", row(table.upper)))
        .replace("{{axes}}", &format!("{{{axes}}}"))
        .replace("{{offset}}", &format!("{{{}}}", row(table.offset_t.to_array())))
        .replace("{coefficients}", &rows)
        .replace("{degree}", &table.degree.to_string())
        .replace("{terms}", &table.coefficients.len().to_string())
        .replace("{sign}", if table.branch_sign < 0.0 { "-1.0" } else { "1.0" })
        .replace("{error}", &format!("{:.1e}", table.largest_error_mm))
        .replace("{checked}", &table.checked.to_string())
        .replace("{x}", &range(0))
        .replace("{y}", &range(1))
        .replace("{z}", &range(2))
        .replace("{reference}", &format!("{}, {}, {}", reference.x, reference.y, reference.z))
        .replace("{version}", version)
        .replace("{sha256}", &layout.sha256)
        // Last, because a name may contain any text, also another placeholder.
        .replacen("{layout}", &name, 1);
    w.write_all(text.as_bytes())
}

/// A literal of C with the digits of a float.
fn float(value: f64) -> String {
    format!("{:.9e}f", value as f32)
}
