//! A VTK XML file: elements of the arrays, then the numbers of all arrays.
//!
//! Reference: <https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html>.

use std::io::{self, Write};

use magsplice::results::{Metadata, MetadataValue};

/// A dataset with one piece.
pub(super) struct VtkDataset<'a> {
    /// The type of the dataset, such as `PolyData`.
    pub(super) kind: &'static str,
    /// Attributes of the dataset and of its piece.
    pub(super) attributes: [String; 2],
    /// Names of the sections of the piece, with their arrays.
    pub(super) sections: Vec<(&'static str, Vec<VtkArray<'a>>)>,
    pub(super) metadata: &'a Metadata,
}

/// A named list of tuples.
pub(super) struct VtkArray<'a> {
    pub(super) name: &'a str,
    /// Names of the numbers in a tuple; empty if a tuple is one number.
    pub(super) components: &'static [&'static str],
    pub(super) values: ArrayValues<'a>,
}

/// The values of an array, computed during writing.
pub(super) enum ArrayValues<'a> {
    /// The type, the count and the bytes of the numbers.
    Numbers(&'static str, usize, Box<dyn Iterator<Item = [u8; 8]> + 'a>),
    Texts(Vec<&'a str>),
}

impl VtkDataset<'_> {
    /// Writes the file.
    pub(super) fn write(self, w: &mut dyn Write) -> io::Result<()> {
        let VtkDataset { kind, attributes: [of_dataset, of_piece], sections, metadata } = self;
        writeln!(w, "<?xml version=\"1.0\"?>")?;
        let version = "version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\"";
        writeln!(w, "<VTKFile type=\"{kind}\" {version}>\n<{kind} {of_dataset}>\n<FieldData>")?;
        for (name, value) in metadata {
            metadata_array(name, value, w)?;
        }
        writeln!(w, "</FieldData>\n<Piece {of_piece}>")?;
        let mut offset = 0;
        let mut appended = Vec::new();
        for (section, arrays) in sections {
            writeln!(w, "<{section}>")?;
            for array in arrays {
                offset += array.head(offset, w)?;
                appended.push(array.values);
            }
            writeln!(w, "</{section}>")?;
        }
        write!(w, "</Piece>\n</{kind}>\n<AppendedData encoding=\"raw\">\n_")?;
        appended.into_iter().try_for_each(|values| values.append(w))?;
        writeln!(w, "\n</AppendedData>\n</VTKFile>")
    }
}

impl<'a> VtkArray<'a> {
    /// An array of `count` numbers.
    pub(super) fn floats(
        name: &'a str,
        components: &'static [&'static str],
        count: usize,
        values: impl Iterator<Item = f64> + 'a,
    ) -> VtkArray<'a> {
        let values = ArrayValues::Numbers("Float64", count, Box::new(values.map(f64::to_le_bytes)));
        VtkArray { name, components, values }
    }

    /// An array of `count` integers, one in each tuple.
    pub(super) fn integers(name: &'a str, count: usize, values: impl Iterator<Item = usize> + 'a) -> VtkArray<'a> {
        let bytes = values.map(|value| (value as u64).to_le_bytes());
        VtkArray { name, components: &[], values: ArrayValues::Numbers("Int64", count, Box::new(bytes)) }
    }

    /// Writes the element of the array. Returns the number of bytes that `append` will write.
    fn head(&self, offset: usize, w: &mut dyn Write) -> io::Result<usize> {
        let name = self.name;
        let (kind, count) = match &self.values {
            ArrayValues::Texts(texts) => return strings(name, texts, w).map(|()| 0),
            ArrayValues::Numbers(kind, count, _) => (kind, count),
        };
        write!(
            w,
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{}\"",
            self.components.len().max(1)
        )?;
        for (i, component) in self.components.iter().enumerate() {
            write!(w, " ComponentName{i}=\"{component}\"")?;
        }
        writeln!(w, " format=\"appended\" offset=\"{offset}\"/>")?;
        Ok(8 + 8 * count)
    }
}

impl ArrayValues<'_> {
    /// Writes the size in bytes, then the numbers.
    fn append(self, w: &mut dyn Write) -> io::Result<()> {
        let ArrayValues::Numbers(_, count, mut numbers) = self else { return Ok(()) };
        w.write_all(&(8 * count as u64).to_le_bytes())?;
        numbers.try_for_each(|number| w.write_all(&number))
    }
}

/// Writes an entry of the metadata as field data.
fn metadata_array(name: &str, value: &MetadataValue, w: &mut dyn Write) -> io::Result<()> {
    let (kind, count, numbers) = match value {
        MetadataValue::Text(text) => return strings(name, &[text], w),
        MetadataValue::Count(count) => ("Int64", 1, count.to_string()),
        MetadataValue::Numbers(values) => {
            let numbers: Vec<String> = values.iter().map(|value| format!("{value:?}")).collect();
            ("Float64", values.len(), numbers.join(" "))
        }
    };
    let head = format!("type=\"{kind}\" Name=\"{name}\" NumberOfTuples=\"{count}\" format=\"ascii\"");
    writeln!(w, "<DataArray {head}>{numbers}</DataArray>")
}

/// Writes an array of texts: the decimal value of each byte, and 0 after each text.
fn strings(name: &str, texts: &[&str], w: &mut dyn Write) -> io::Result<()> {
    write!(w, "<Array type=\"String\" Name=\"{name}\" NumberOfTuples=\"{}\" format=\"ascii\">", texts.len())?;
    for text in texts {
        text.bytes().try_for_each(|byte| write!(w, "{byte} "))?;
        write!(w, "0 ")?;
    }
    writeln!(w, "</Array>")
}
