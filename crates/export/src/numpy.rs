//! Tables as NPY and NPZ, for NumPy. npyz writes the headers; the data are little-endian numbers.

use std::io::{self, BufWriter, Write};

use npyz::npz::file_name_from_array_name;
use npyz::{DType, Field, TypeStr, WriteOptions, WriterBuilder};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use magsplice::results::{MetadataValue, Table};

/// Writes an NPY file: one array of records, in the shape of [`Rows::shape`], with one field per
/// column. The format has no metadata.
///
/// [`Rows::shape`]: magsplice::results::Rows::shape
///
/// # Errors
/// Errors of the writer.
pub fn npy(table: &Table, w: &mut dyn Write) -> io::Result<()> {
    let columns = table.columns();
    let fields = columns.iter().map(|column| Field { name: column.name.to_owned(), dtype: scalar("<f8") });
    header(DType::Record(fields.collect()), &table.rows().shape(), w)?;
    (0..table.rows().len()).try_for_each(|row| numbers(columns.iter().map(|column| column.get(row)), w))
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
        archive.start_file(file_name_from_array_name(name), options)
    };
    let shape = table.rows().shape();
    for column in table.columns() {
        begin(&mut archive, column.name, 8 * table.rows().len())?;
        let mut entry = BufWriter::new(&mut archive);
        header(scalar("<f8"), &shape, &mut entry)?;
        numbers(column.values(), &mut entry)?;
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
            header(scalar(&format!("<U{length}")), &[], w)?;
            let padded = points.into_iter().chain(std::iter::repeat(0)).take(length);
            padded.into_iter().try_for_each(|point| w.write_all(&point.to_le_bytes()))
        }
        MetadataValue::Count(count) => {
            header(scalar("<i8"), &[], w)?;
            w.write_all(&(*count as u64).to_le_bytes())
        }
        MetadataValue::Numbers(values) => {
            header(scalar("<f8"), &[values.len()], w)?;
            numbers(values.iter().copied(), w)
        }
    }
}

fn scalar(text: &str) -> DType {
    DType::Plain(text.parse::<TypeStr>().expect("a type name that NumPy knows"))
}

fn header(dtype: DType, shape: &[usize], w: &mut dyn Write) -> io::Result<()> {
    let shape: Vec<u64> = shape.iter().map(|&n| n as u64).collect();
    WriteOptions::new_header_only().dtype(dtype).shape(&shape).writer(w).write_header_only().map(drop)
}

fn numbers(values: impl Iterator<Item = f64>, w: &mut dyn Write) -> io::Result<()> {
    for value in values {
        w.write_all(&value.to_le_bytes())?;
    }
    Ok(())
}
