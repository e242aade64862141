//! Tables as Parquet.

use std::io::{self, Write};
use std::sync::Arc;

use parquet::basic::{Repetition, Type as Physical};
use parquet::data_type::DoubleType;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use crate::table::{Table, Value};

/// Rows of a row group: readers take one at a time.
const ROW_GROUP: usize = 1 << 20;

/// Writes the columns as doubles, and what they were made from as key-value metadata of the file; lists of numbers there are JSON.
///
/// # Errors
/// Those of the writer.
pub fn write(table: &Table, w: &mut dyn Write) -> io::Result<()> {
    in_row_groups(table, w).map_err(|error| match error {
        ParquetError::External(error) => match error.downcast::<io::Error>() {
            Ok(error) => *error,
            Err(error) => io::Error::other(error),
        },
        error => io::Error::other(error),
    })
}

fn in_row_groups(table: &Table, w: &mut dyn Write) -> Result<(), ParquetError> {
    let columns = table.columns();
    let field = |name: &str| -> Result<Arc<Type>, ParquetError> {
        let field = Type::primitive_type_builder(name, Physical::DOUBLE).with_repetition(Repetition::REQUIRED);
        Ok(Arc::new(field.build()?))
    };
    let fields = columns.iter().map(|column| field(column.name)).collect::<Result<_, _>>()?;
    let schema = Arc::new(Type::group_type_builder("points").with_fields(fields).build()?);
    let facts = table.metadata.iter().map(|(name, value)| KeyValue::new((*name).to_owned(), fact(value))).collect();
    let properties = WriterProperties::builder()
        // Hardly a number occurs twice.
        .set_dictionary_enabled(false)
        .set_key_value_metadata(Some(facts))
        .build();
    // The crate wants a writer that can go to other threads: into memory, and from there group by group.
    let mut file = SerializedFileWriter::new(Vec::new(), schema, Arc::new(properties))?;
    for start in (0..table.points.len()).step_by(ROW_GROUP) {
        let rows = start..table.points.len().min(start + ROW_GROUP);
        let mut group = file.next_row_group()?;
        for column in &columns {
            let values: Vec<f64> = rows.clone().map(|row| column.get(row)).collect();
            let mut writer = group.next_column()?.expect("a column of the schema");
            writer.typed::<DoubleType>().write_batch(&values, None, None)?;
            writer.close()?;
        }
        group.close()?;
        file.flush()?;
        w.write_all(file.inner())?;
        file.inner_mut().clear();
    }
    w.write_all(&file.into_inner()?)?;
    Ok(())
}

fn fact(value: &Value) -> String {
    match value {
        Value::Text(text) => text.clone(),
        Value::Count(count) => count.to_string(),
        Value::Numbers(values) => serde_json::to_string(values).expect("numbers can always be written"),
    }
}
