//! Configurations of a Parquet file, its columns matched by the names of the coordinates.
//!
//! Valid    columns of numbers without gaps, uncompressed or by Snappy; other columns are ignored
//! Why so   column by column into rows: Parquet's own rows take ten times as long
//! Checked  tests/sweep/folder.rs::a_part_is_a_file_of_configurations

use std::fs::File;
use std::path::Path;

use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};

use crate::error::Error;

type Result<T, E = Error> = std::result::Result<T, E>;

/// Numbers at most: 4 GiB.
const MOST: u64 = 1 << 29;

/// The columns of these names (or `q.` and the name, as in the motions of `move`), a row after the
/// other.
///
/// # Errors
/// A file that cannot be read, a missing column, an entry that is no number, too many rows.
pub fn parquet_configurations(path: &Path, names: &[&str]) -> Result<Vec<f64>> {
    let refuse = |message: String| Error::Io { path: path.to_owned(), action: "read", message };
    let because = |error: ParquetError| {
        refuse(format!("{error}; files without compression or with Snappy's can be read"))
    };
    let file = File::open(path).map_err(|error| refuse(error.to_string()))?;
    let reader = SerializedFileReader::new(file).map_err(because)?;
    let metadata = reader.metadata().file_metadata();
    let columns: Vec<String> =
        metadata.schema_descr().columns().iter().map(|c| c.path().string()).collect();
    let mut places = Vec::with_capacity(names.len());
    for name in names {
        let is_it = |c: &String| c == name || c.strip_prefix("q.") == Some(name);
        let place = columns
            .iter()
            .position(is_it)
            .ok_or_else(|| refuse(format!("no column '{name}' among {}", columns.join(", "))))?;
        places.push(place);
    }
    let rows = u64::try_from(metadata.num_rows()).unwrap_or(0);
    if rows.saturating_mul(names.len() as u64) > MOST {
        return Err(refuse(format!("{rows} rows are more than fit; split the file")));
    }
    let n = names.len();
    let mut q = vec![0.0; usize::try_from(rows).unwrap_or(0) * n];
    let (mut first, mut column) = (0, Vec::new());
    for group in 0..reader.num_row_groups() {
        let group = reader.get_row_group(group).map_err(because)?;
        let rows = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
        let Some(own) = q.get_mut(first * n..(first + rows) * n) else {
            return Err(refuse("its row groups have more rows than the file".to_owned()));
        };
        for (j, (&place, name)) in places.iter().zip(names).enumerate() {
            let of = group.get_column_reader(place).map_err(because)?;
            if let Some(row) = read(of, rows, &mut column).map_err(because)? {
                let row = first + row + 1;
                return Err(refuse(format!("row {row}, column '{name}': no number")));
            }
            own.iter_mut().skip(j).step_by(n).zip(&column).for_each(|(q, x)| *q = *x);
        }
        first += rows;
    }
    Ok(q)
}

/// The numbers of a column, or the first row that has none.
fn read(
    column: ColumnReader,
    rows: usize,
    out: &mut Vec<f64>,
) -> Result<Option<usize>, ParquetError> {
    match column {
        ColumnReader::DoubleColumnReader(column) => numbers(column, rows, out, |x| x),
        ColumnReader::FloatColumnReader(column) => numbers(column, rows, out, f64::from),
        ColumnReader::Int32ColumnReader(column) => numbers(column, rows, out, f64::from),
        ColumnReader::Int64ColumnReader(column) => numbers(column, rows, out, |x| x as f64),
        _ => Ok(Some(0)),
    }
}

fn numbers<T: DataType>(
    mut column: ColumnReaderImpl<T>,
    rows: usize,
    out: &mut Vec<f64>,
    number: impl Fn(T::T) -> f64,
) -> Result<Option<usize>, ParquetError> {
    let (mut values, mut levels, mut read) = (Vec::with_capacity(rows), Vec::new(), 0);
    while read < rows {
        match column.read_records(rows - read, Some(&mut levels), None, &mut values)? {
            (0, ..) => break,
            (records, ..) => read += records,
        }
    }
    out.clear();
    out.extend(values.into_iter().map(number));
    // A gap has a level of its own and no value.
    let gap = || levels.iter().position(|level| *level == 0).unwrap_or(out.len());
    Ok((out.len() < rows).then(gap))
}
