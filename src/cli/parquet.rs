//! The same table as Parquet, for programs that read columns.

use std::sync::Arc;

use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use crate::cli::format;

/// A column: numbers, or words.
pub enum Column {
    /// SI values.
    Numbers(Vec<f64>),
    /// Words, such as the lubrication regime.
    Words(Vec<String>),
}

/// A file of named columns of equal length, none of them with gaps; its metadata has their units, as JSON by the key `units`.
pub fn file(columns: &[(&str, Column)]) -> Result<Vec<u8>, ParquetError> {
    let fields = columns.iter().map(|(name, column)| {
        let field = match column {
            Column::Numbers(_) => Type::primitive_type_builder(name, Physical::DOUBLE),
            Column::Words(_) => {
                Type::primitive_type_builder(name, Physical::BYTE_ARRAY).with_logical_type(Some(LogicalType::String))
            }
        };
        field.with_repetition(Repetition::REQUIRED).build().map(Arc::new)
    });
    let schema = Type::group_type_builder("stribeck").with_fields(fields.collect::<Result<_, _>>()?).build()?;
    let units: serde_json::Map<_, _> =
        columns.iter().map(|(name, _)| ((*name).to_owned(), format::unit(name).into())).collect();
    let units = KeyValue::new("units".to_owned(), serde_json::Value::Object(units).to_string());
    let properties = WriterProperties::builder().set_key_value_metadata(Some(vec![units])).build();
    let mut file = SerializedFileWriter::new(Vec::new(), Arc::new(schema), Arc::new(properties))?;
    let mut group = file.next_row_group()?;
    for (_, column) in columns {
        let Some(mut writer) = group.next_column()? else { break };
        match column {
            Column::Numbers(values) => writer.typed::<DoubleType>().write_batch(values, None, None)?,
            Column::Words(words) => {
                let words: Vec<_> = words.iter().map(|word| ByteArray::from(word.as_str())).collect();
                writer.typed::<ByteArrayType>().write_batch(&words, None, None)?
            }
        };
        writer.close()?;
    }
    group.close()?;
    file.into_inner()
}
