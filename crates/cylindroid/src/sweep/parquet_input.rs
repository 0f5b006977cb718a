//! Configurations of a Parquet file, its columns matched by the names of the coordinates.
//!
//! Valid    columns of numbers without gaps, uncompressed or by Snappy; other columns are ignored
//! Checked  tests/sweep/folder.rs::a_part_is_a_file_of_configurations

use std::fs::File;
use std::path::Path;

use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use parquet::schema::types::Type;

use crate::error::{Error, Result};

/// Numbers at most: 4 GiB.
const MOST: u64 = 1 << 29;

/// The columns of these names (or `q.` and the name, as in the motions of `move`), a row after the
/// other.
///
/// # Errors
/// A file that cannot be read, a missing column, an entry that is no number, too many rows.
pub fn parquet_configurations(path: &Path, names: &[&str]) -> Result<Vec<f64>> {
    let refuse = |message: String| Error::Io { path: path.to_owned(), action: "read", message };
    let because = |error: parquet::errors::ParquetError| {
        refuse(format!("{error}; files without compression or with Snappy's can be read"))
    };
    let file = File::open(path).map_err(|error| refuse(error.to_string()))?;
    let reader = SerializedFileReader::new(file).map_err(because)?;
    let metadata = reader.metadata().file_metadata();
    let schema = metadata.schema();
    let columns: Vec<&str> = schema.get_fields().iter().map(|field| field.name()).collect();
    let mut fields = Vec::with_capacity(names.len());
    for name in names {
        let is_it = |c: &&str| c == name || c.strip_prefix("q.") == Some(name);
        let place = columns
            .iter()
            .position(is_it)
            .ok_or_else(|| refuse(format!("no column '{name}' among {}", columns.join(", "))))?;
        fields.push(place);
    }
    let rows = u64::try_from(metadata.num_rows()).unwrap_or(0);
    if rows.saturating_mul(names.len() as u64) > MOST {
        return Err(refuse(format!("{rows} rows are more than fit; split the file")));
    }
    // A projection has the columns in the order of the file.
    let mut chosen = fields.clone();
    chosen.sort_unstable();
    chosen.dedup();
    let types = chosen.iter().map(|&i| schema.get_fields()[i].clone()).collect();
    let projection = Type::group_type_builder(schema.name()).with_fields(types).build();
    let rows = reader.get_row_iter(Some(projection.map_err(because)?)).map_err(because)?;
    let places: Vec<usize> =
        fields.iter().filter_map(|field| chosen.iter().position(|c| c == field)).collect();
    let mut q = Vec::new();
    let mut line = vec![0.0; chosen.len()];
    for (k, row) in rows.enumerate() {
        let row = row.map_err(because)?;
        for ((name, field), x) in row.get_column_iter().zip(&mut line) {
            *x = match field {
                Field::Double(x) => *x,
                Field::Float(x) => f64::from(*x),
                Field::Int(x) => f64::from(*x),
                Field::Long(x) => *x as f64,
                _ => {
                    return Err(refuse(format!("row {}, column '{name}': no number", k + 1)));
                }
            };
        }
        q.extend(places.iter().map(|&i| line[i]));
    }
    Ok(q)
}
