//! The displacement of a sensor as a C header.

use std::io::{self, Write};

use magsplice::results::SensorPolynomial;
use magsplice_layout::Layout;

/// The header, with placeholders `{...}` for its data.
const HEADER: &str = include_str!("c_header.h");

/// Writes a header of C99 with one function, which computes in `float` and needs only `math.h`.
/// `version` is the version of the writing program.
///
/// # Errors
/// Errors of the writer.
pub fn displacement(layout: &Layout, found: &SensorPolynomial, version: &str, w: &mut dyn Write) -> io::Result<()> {
    let SensorPolynomial { polynomial: table, volume, field_of_reading, offset_t } = found;
    let (low, high, reference) = (volume.grid.lower(), volume.grid.upper(), volume.reference_mm);
    let row = |values: [f64; 3]| values.map(float).join(", ");
    let rows: String = table.coefficients.iter().map(|values| format!("    {{{}}},\n", row(*values))).collect();
    let axes = [0, 1, 2].map(|axis| format!("{{{}}}", row(field_of_reading.row(axis).to_array()))).join(", ");
    let range = |axis: usize| format!("{} .. {}", low[axis], high[axis]);
    // A name may contain the beginning or the end of a comment.
    let name = layout.name.replace("*/", "* /").replace("/*", "/ *");
    let text = HEADER
        .replace("{{lower}}", &format!("{{{}}}", row(table.lower)))
        .replace("{{upper}}", &format!("{{{}}}", row(table.upper)))
        .replace("{{axes}}", &format!("{{{axes}}}"))
        .replace("{{offset}}", &format!("{{{}}}", row(offset_t.to_array())))
        .replace("{head}", &head(layout))
        .replace("{coefficients}", &rows)
        .replace("{degree}", &table.degree.to_string())
        .replace("{terms}", &table.coefficients.len().to_string())
        .replace("{sign}", if table.branch_sign < 0.0 { "-1.0" } else { "1.0" })
        .replace("{error}", &format!("{:.1e}", table.largest_error))
        .replace("{checked}", &table.checked.to_string())
        .replace("{x}", &range(0))
        .replace("{y}", &range(1))
        .replace("{z}", &range(2))
        .replace("{reference}", &format!("{}, {}, {}", reference.x, reference.y, reference.z))
        .replace("{version}", version)
        .replace("{sha256}", &layout.sha256)
        // Last, because a name may contain any text, including another placeholder.
        .replacen("{layout}", &name, 1);
    w.write_all(text.as_bytes())
}

/// Lines of the comment about a head: the reading is a weighted sum.
fn head(layout: &Layout) -> String {
    let Some(head) = layout.sensor.as_ref().and_then(|sensor| sensor.head.as_ref()) else { return String::new() };
    let mut lines =
        " *\n * The reading is the sum of the readings of these sensors, each without its offset, gain and\n \
                     * rotation, times its weight along x, y, z:\n"
            .to_owned();
    for of in &head.sensors.elements {
        let [place, weight] = [of.place, of.weight].map(|of| format!("({}, {}, {})", of.x, of.y, of.z));
        lines += &format!(" *   at {place} mm of the board: {weight}\n");
    }
    lines + " *\n"
}

/// A literal of C with the digits of a float.
fn float(value: f64) -> String {
    format!("{:.9e}f", value as f32)
}
