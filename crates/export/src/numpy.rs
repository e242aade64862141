//! Tables as NPY and NPZ, for NumPy: headers of format version 1.0, then little-endian numbers.
//!
//! Format: <https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>.

use std::io::{self, BufWriter, Write};

use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use magsplice::results::{MetadataValue, Table, TableColumn};

/// The type of a column: little-endian f64.
const DOUBLE: &str = "'<f8'";

/// The type of a column of whole numbers: little-endian i64.
const INTEGER: &str = "'<i8'";

/// Bytes before the text of a header: magic string, version, and the length of the text.
const BEFORE_TEXT: usize = 10;

/// The data begin at a multiple of this number of bytes, as the format asks for.
const ALIGNMENT: usize = 64;

/// Writes an NPY file: one array of records, in the shape of [`Rows::shape`], with one field per
/// column. The format has no metadata.
///
/// [`Rows::shape`]: magsplice::results::Rows::shape
///
/// # Errors
/// Errors of the writer.
pub fn npy(table: &Table, w: &mut dyn Write) -> io::Result<()> {
    let columns = table.columns();
    let fields: String = columns.iter().map(|column| format!("('{}', {}), ", column.name, dtype(column))).collect();
    header(&format!("[{fields}]"), &table.rows().shape(), w)?;
    let cells = (0..table.rows().len()).flat_map(|row| columns.iter().map(move |column| (column, row)));
    cells.into_iter().try_for_each(|(column, row)| cell(column, row, w))
}

fn dtype(column: &TableColumn) -> &'static str {
    if column.is_whole() { INTEGER } else { DOUBLE }
}

fn cell(column: &TableColumn, row: usize, w: &mut dyn Write) -> io::Result<()> {
    let value = column.get(row);
    w.write_all(&if column.is_whole() { (value as i64).to_le_bytes() } else { value.to_le_bytes() })
}

/// Writes an NPZ archive: one array per column, in the shape of [`Rows::shape`], and one array
/// per entry of the metadata.
///
/// [`Rows::shape`]: magsplice::results::Rows::shape
///
/// # Errors
/// Errors of the writer.
pub fn npz(table: &Table, w: &mut dyn Write) -> io::Result<()> {
    // Not compressed, like numpy.savez, because the digits of fields look random.
    let mut archive = ZipWriter::new_stream(w);
    let begin = |archive: &mut ZipWriter<_>, name: &str, bytes: usize| {
        let options = SimpleFileOptions::default()
            .compression_method(zip::CompressionMethod::Stored)
            .large_file(bytes as u64 >= u64::from(u32::MAX) / 2);
        archive.start_file(format!("{name}.npy"), options)
    };
    let shape = table.rows().shape();
    for column in table.columns() {
        begin(&mut archive, column.name, 8 * table.rows().len())?;
        let mut entry = BufWriter::new(&mut archive);
        header(dtype(&column), &shape, &mut entry)?;
        (0..table.rows().len()).try_for_each(|row| cell(&column, row, &mut entry))?;
        entry.flush()?;
    }
    for (name, value) in table.metadata() {
        begin(&mut archive, name, 0)?;
        metadata_array(value, &mut archive)?;
    }
    archive.finish()?;
    Ok(())
}

fn metadata_array(value: &MetadataValue, w: &mut dyn Write) -> io::Result<()> {
    match value {
        MetadataValue::Text(text) => {
            let points: Vec<u32> = text.chars().map(u32::from).collect();
            // NumPy has no strings of length 0.
            let length = points.len().max(1);
            header(&format!("'<U{length}'"), &[], w)?;
            let padded = points.into_iter().chain(std::iter::repeat(0)).take(length);
            padded.into_iter().try_for_each(|point| w.write_all(&point.to_le_bytes()))
        }
        MetadataValue::Count(count) => {
            header(INTEGER, &[], w)?;
            w.write_all(&(*count as u64).to_le_bytes())
        }
        MetadataValue::Numbers(values) => {
            header(DOUBLE, &[values.len()], w)?;
            numbers(values.iter().copied(), w)
        }
    }
}

/// Writes the header of an array. `dtype` is the Python literal of its type, whose names need no
/// quoting.
fn header(dtype: &str, shape: &[usize], w: &mut dyn Write) -> io::Result<()> {
    let shape: String = shape.iter().map(|n| format!("{n}, ")).collect();
    let text = format!("{{'descr': {dtype}, 'fortran_order': False, 'shape': ({shape}), }}");
    let length = (BEFORE_TEXT + text.len() + 1).next_multiple_of(ALIGNMENT) - BEFORE_TEXT;
    let shown = u16::try_from(length).expect("a header of some dozens of columns");
    w.write_all(b"\x93NUMPY\x01\x00")?;
    w.write_all(&shown.to_le_bytes())?;
    writeln!(w, "{text:0$}", length - 1)
}

fn numbers(values: impl Iterator<Item = f64>, w: &mut dyn Write) -> io::Result<()> {
    for value in values {
        w.write_all(&value.to_le_bytes())?;
    }
    Ok(())
}
