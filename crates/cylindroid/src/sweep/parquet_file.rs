//! A table as a Parquet file.
//!
//! Shapes   one row group; columns without dictionary, compression and statistics: random numbers
//!          do not compress, and a page is then a copy. Names are stored by dictionary
//! Units    in the metadata `cylindroid` of the file: a JSON object with the model, the frame, its tool
//!          point, the frame from which it is seen unless that is the world (relative_to), the
//!          characteristic length [m], and name, unit and description of each column
//! Checked  tests/sweep/folder.rs

use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::{ColumnPath, Type, TypePtr};
use serde_json::json;

use super::checksum::Checksum;
use super::manifest::{Part, cannot_write};
use super::recipe::Recipe;
use super::table::{Column, ColumnKind, Values};
use crate::error::{Error, Result};
use crate::model::open_regular_file;

/// The recipe and the columns of a table.
pub(super) type Contents<'a> = (&'a Recipe, &'a [Column]);

/// Writes the columns, and makes the file durable.
pub(super) fn write(path: &Path, contents: Contents<'_>, values: &[Values]) -> Result<Part> {
    let file = File::create(path).map_err(|error| cannot_write(path, &error))?;
    let (part, file) = into_sink(path, file, contents, values)?;
    file.sync_all().map_err(|error| cannot_write(path, &error))?;
    Ok(part)
}

/// The bytes of the same file.
pub(super) fn bytes(
    name: &str,
    contents: Contents<'_>,
    values: &[Values],
) -> Result<(Part, Vec<u8>)> {
    into_sink(Path::new(name), Vec::new(), contents, values)
}

fn into_sink<W: Write + Send>(
    path: &Path,
    inner: W,
    contents: Contents<'_>,
    values: &[Values],
) -> Result<(Part, W)> {
    let mut sink = Summed { inner, checksum: Checksum::new(), bytes: 0, failed: None };
    let written = into(&mut sink, contents, values);
    if let Some(error) = sink.failed {
        return Err(cannot_write(path, &error));
    }
    written.map_err(|error| Error::Io {
        path: path.to_owned(),
        action: "write",
        message: error.to_string(),
    })?;
    let part = Part { bytes: sink.bytes, checksum: sink.checksum.finish() };
    Ok((part, sink.inner))
}

/// The checksum of a regular file.
pub(super) fn checksum(path: &Path) -> Result<Part> {
    let (mut file, mut checksum, mut bytes) = (open_regular_file(path)?, Checksum::new(), 0);
    let mut buffer = vec![0; 1 << 18];
    loop {
        let count = file.read(&mut buffer).map_err(|error| Error::Io {
            path: path.to_owned(),
            action: "read",
            message: error.to_string(),
        })?;
        if count == 0 {
            break;
        }
        checksum.update(&buffer[..count]);
        bytes += count as u64;
    }
    Ok(Part { bytes, checksum: checksum.finish() })
}

/// A file, or bytes in memory, and its checksum.
struct Summed<W> {
    inner: W,
    checksum: Checksum,
    bytes: u64,
    /// The first error, of which Parquet's keeps the text only.
    failed: Option<io::Error>,
}

impl<W: Write> Write for Summed<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.inner.write_all(bytes) {
            Ok(()) => {
                self.checksum.update(bytes);
                self.bytes += bytes.len() as u64;
                Ok(bytes.len())
            }
            Err(error) => {
                let again = io::Error::new(error.kind(), error.to_string());
                self.failed.get_or_insert(error);
                Err(again)
            }
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn schema(columns: &[Column]) -> std::result::Result<TypePtr, ParquetError> {
    let field = |column: &Column| {
        let (physical, logical) = match column.kind {
            ColumnKind::Number => (Physical::DOUBLE, None),
            ColumnKind::Count => (Physical::INT64, Some(LogicalType::integer(64, false))),
            ColumnKind::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
        };
        Type::primitive_type_builder(&column.name, physical)
            .with_repetition(Repetition::REQUIRED)
            .with_logical_type(logical)
            .build()
            .map(Arc::new)
    };
    let fields = columns.iter().map(field).collect::<std::result::Result<_, _>>()?;
    Type::group_type_builder("sweep").with_fields(fields).build().map(Arc::new)
}

fn into<W: Write + Send>(
    sink: &mut Summed<W>,
    (recipe, columns): Contents<'_>,
    values: &[Values],
) -> std::result::Result<(), ParquetError> {
    let described = columns
        .iter()
        .map(|c| json!({"name": c.name, "unit": c.unit, "description": c.description}));
    let mut about = json!({ "columns": described.collect::<Vec<_>>() });
    for entry in ["model", "frame", "frame_from_tool", "length"] {
        about[entry] = recipe.0[entry].clone();
    }
    if let Some(base) = recipe.0.get("relative_to") {
        about["relative_to"] = base.clone();
    }
    let mut properties = WriterProperties::builder()
        .set_created_by(concat!("cylindroid ", env!("CARGO_PKG_VERSION")).to_owned())
        .set_compression(Compression::UNCOMPRESSED)
        .set_dictionary_enabled(false)
        .set_statistics_enabled(EnabledStatistics::None)
        .set_offset_index_disabled(true)
        .set_key_value_metadata(Some(vec![KeyValue::new(
            "cylindroid".to_owned(),
            about.to_string(),
        )]));
    for column in columns.iter().filter(|c| c.kind == ColumnKind::Text) {
        let path = ColumnPath::new(vec![column.name.clone()]);
        properties = properties.set_column_dictionary_enabled(path, true);
    }
    let mut writer =
        SerializedFileWriter::new(sink, schema(columns)?, Arc::new(properties.build()))?;
    let mut group = writer.next_row_group()?;
    for values in values {
        let Some(mut column) = group.next_column()? else { break };
        match values {
            Values::Numbers(numbers) => {
                column.typed::<DoubleType>().write_batch(numbers, None, None)?;
            }
            Values::Counts(counts) => {
                // The bits of a signed number are those of the unsigned one.
                let bits: Vec<i64> = counts.iter().map(|c| c.cast_signed()).collect();
                column.typed::<Int64Type>().write_batch(&bits, None, None)?;
            }
            Values::Texts(texts) => {
                let bytes: Vec<ByteArray> = texts.iter().map(|t| ByteArray::from(*t)).collect();
                column.typed::<ByteArrayType>().write_batch(&bytes, None, None)?;
            }
        }
        column.close()?;
    }
    group.close()?;
    writer.close()?;
    Ok(())
}
