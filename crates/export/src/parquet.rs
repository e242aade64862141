//! Tables as Parquet: columns of doubles and of integers, metadata as key-value metadata of the
//! file.

use std::io::{self, Write};
use std::sync::Arc;

use parquet::basic::{Repetition, Type as Physical};
use parquet::data_type::{DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use magsplice::results::{MetadataValue, Table, TableColumn};

/// Rows per row group. Readers hold one group in memory at a time.
const ROW_GROUP: usize = 1 << 20;

/// Writes the columns as doubles, whole numbers as integers, and the metadata as key-value metadata
/// of the file. Metadata become texts: a count its digits, a list of numbers JSON.
///
/// # Errors
/// Errors of the writer.
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
    let field = |column: &TableColumn| -> Result<Arc<Type>, ParquetError> {
        let kind = if column.is_whole() { Physical::INT64 } else { Physical::DOUBLE };
        let field = Type::primitive_type_builder(column.name, kind).with_repetition(Repetition::REQUIRED);
        Ok(Arc::new(field.build()?))
    };
    let fields = columns.iter().map(field).collect::<Result<_, _>>()?;
    let schema = Arc::new(Type::group_type_builder("points").with_fields(fields).build()?);
    let metadata =
        table.metadata().iter().map(|(name, value)| KeyValue::new((*name).to_owned(), metadata_text(value))).collect();
    let properties = WriterProperties::builder()
        // A dictionary has no benefit, because hardly any number occurs twice.
        .set_dictionary_enabled(false)
        .set_key_value_metadata(Some(metadata))
        .build();
    // The crate needs a writer that is `Send`, unlike `w`, so each group is written to memory
    // first.
    let mut file = SerializedFileWriter::new(Vec::new(), schema, Arc::new(properties))?;
    for start in (0..table.rows().len()).step_by(ROW_GROUP) {
        let rows = start..table.rows().len().min(start + ROW_GROUP);
        let mut group = file.next_row_group()?;
        for column in &columns {
            let values = rows.clone().map(|row| column.get(row));
            let mut writer = group.next_column()?.expect("the schema has a writer for each column");
            if column.is_whole() {
                let whole: Vec<i64> = values.map(|value| value as i64).collect();
                writer.typed::<Int64Type>().write_batch(&whole, None, None)?;
            } else {
                writer.typed::<DoubleType>().write_batch(&values.collect::<Vec<f64>>(), None, None)?;
            }
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

fn metadata_text(value: &MetadataValue) -> String {
    match value {
        MetadataValue::Text(text) => text.clone(),
        MetadataValue::Count(count) => count.to_string(),
        MetadataValue::Numbers(values) => serde_json::to_string(values).expect("numbers always serialize as JSON"),
    }
}
