//! Columns of a Parquet file by their names: configurations, poses, quantities.
//!
//! Valid    columns of numbers without gaps, uncompressed or by Snappy; other columns are ignored. Dates,
//!          times, decimals in bytes and numbers of 16 bits are refused, as is a column of a name given twice.
//!          Headers are checked first (`parquet_header.rs`)
//! Why so   column by column into rows: Parquet's own rows take ten times as long
//! Checked  tests/sweep/folder.rs::a_part_is_a_file_of_configurations, tests/sweep/parquet_forms.rs

use std::fs::File;
use std::io::{self, BufRead, BufReader, ErrorKind, Read};
use std::path::Path;

use bytes::Bytes;
use parquet::basic::Encoding;
use parquet::column::page::{Page, PageMetadata, PageReader};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl, get_column_reader};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::metadata::ColumnChunkMetaData;
use parquet::file::reader::{ChunkReader, FileReader, Length, SerializedFileReader};

use super::parquet_form::Form;
use super::parquet_header;
use crate::error::Error;
use crate::model::open_regular_file;

type Result<T, E = Error> = std::result::Result<T, E>;

/// Numbers at most: 4 GiB.
const MOST: usize = 1 << 29;

/// Bytes at the end of a file: the length of its footer, and that it is one.
const END: u64 = 8;

/// A file whose headers are checked, and beyond whose end nothing is read. The header of a page in a
/// damaged file may announce a list of 2^31 entries, which Parquet's reader would skip one by one
/// although the file has ended.
struct Checked(File);

impl Length for Checked {
    fn len(&self) -> u64 {
        self.0.len()
    }
}

impl ChunkReader for Checked {
    type T = Pages;

    fn get_read(&self, start: u64) -> Result<Self::T, ParquetError> {
        let is_header = start.saturating_add(END) < self.0.len();
        Ok(Pages { file: self.0.get_read(start)?, is_header })
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<Bytes, ParquetError> {
        let bytes = self.0.get_bytes(start, length)?;
        let end = start.saturating_add(length as u64).saturating_add(END);
        if end == self.0.len() {
            let refuse = |what| ParquetError::General(format!("the footer {what}"));
            parquet_header::check_footer(&bytes).map_err(refuse)?;
        }
        Ok(bytes)
    }
}

/// A file from a page on.
struct Pages {
    file: BufReader<File>,
    /// True before the header of the page, if that is what comes.
    is_header: bool,
}

impl Read for Pages {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.is_header && !buffer.is_empty() {
            self.is_header = false;
            let capacity = self.file.capacity();
            let ahead = self.file.fill_buf()?;
            parquet_header::check_page(ahead, ahead.len() < capacity)
                .map_err(|what| io::Error::other(format!("the header of a page {what}")))?;
        }
        match self.file.read(buffer)? {
            0 if !buffer.is_empty() => Err(ErrorKind::UnexpectedEof.into()),
            count => Ok(count),
        }
    }
}

/// Pages of which none is in terms of a dictionary before that has come, at which Parquet's reader would
/// panic.
struct Ordered {
    pages: Box<dyn PageReader>,
    has_dictionary: bool,
}

impl Iterator for Ordered {
    type Item = Result<Page, ParquetError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.get_next_page().transpose()
    }
}

impl PageReader for Ordered {
    fn get_next_page(&mut self) -> Result<Option<Page>, ParquetError> {
        let page = self.pages.get_next_page()?;
        let encoding = match &page {
            Some(Page::DictionaryPage { .. }) => {
                self.has_dictionary = true;
                None
            }
            Some(Page::DataPage { encoding, .. } | Page::DataPageV2 { encoding, .. }) => {
                Some(*encoding)
            }
            None => None,
        };
        let refers = [Encoding::PLAIN_DICTIONARY, Encoding::RLE_DICTIONARY].map(Some);
        if refers.contains(&encoding) && !self.has_dictionary {
            return Err(ParquetError::General("a page before its dictionary".to_owned()));
        }
        Ok(page)
    }

    fn peek_next_page(&mut self) -> Result<Option<PageMetadata>, ParquetError> {
        self.pages.peek_next_page()
    }

    fn skip_next_page(&mut self) -> Result<(), ParquetError> {
        self.pages.skip_next_page()
    }
}

/// The columns of these coordinates, a row after the other: `q.` and the name, as in the motions of
/// `move`, or the name.
///
/// # Errors
/// As [`parquet_columns`].
pub fn parquet_configurations(path: &Path, names: &[&str]) -> Result<Vec<f64>> {
    read_columns(path, names, coordinate_column)
}

/// The place of the column of a coordinate: `q.` and the name, otherwise the name.
#[must_use]
pub fn coordinate_column(columns: &[String], name: &str) -> Option<usize> {
    let place = columns.iter().position(|c| c.strip_prefix("q.") == Some(name));
    place.or_else(|| columns.iter().position(|c| c == name))
}

/// The columns of these names, a row after the other.
///
/// # Errors
/// A file that cannot be read, a missing column or one of a name given twice, one of dates or times, an
/// entry that is no number, too many rows.
pub fn parquet_columns(path: &Path, names: &[&str]) -> Result<Vec<f64>> {
    read_columns(path, names, |columns, name| columns.iter().position(|c| c == name))
}

fn read_columns(
    path: &Path,
    names: &[&str],
    find: impl Fn(&[String], &str) -> Option<usize>,
) -> Result<Vec<f64>> {
    let refuse = |message: String| Error::Io { path: path.to_owned(), action: "read", message };
    let because = |error: ParquetError| {
        refuse(format!("{error}; files without compression or with Snappy's can be read"))
    };
    let reader = SerializedFileReader::new(Checked(open_regular_file(path)?)).map_err(because)?;
    let metadata = reader.metadata().file_metadata();
    let columns: Vec<String> =
        metadata.schema_descr().columns().iter().map(|c| c.path().string()).collect();
    let mut places = Vec::with_capacity(names.len());
    for name in names {
        let place = find(&columns, name)
            .ok_or_else(|| refuse(format!("no column '{name}' among {}", columns.join(", "))))?;
        let column = &columns[place];
        if columns.iter().filter(|other| *other == column).count() > 1 {
            return Err(refuse(format!("column '{column}' is given twice")));
        }
        let form = Form::of(&metadata.schema_descr().column(place)).map_err(|what| {
            refuse(format!("column '{column}' holds {what}; write its numbers as float64"))
        })?;
        places.push((place, form));
    }
    let (n, mut q, mut first) = (names.len(), Vec::new(), 0_usize);
    // What the file says about its rows may be wrong: only those that are read count.
    for group in 0..reader.num_row_groups() {
        let group = reader.get_row_group(group).map_err(because)?;
        let rows = usize::try_from(group.metadata().num_rows()).unwrap_or(usize::MAX);
        let end = first.saturating_add(rows);
        if end.saturating_mul(n.max(1)) > MOST {
            return Err(refuse(format!("{end} rows are more than fit; split the file")));
        }
        let mut columns = Vec::with_capacity(n);
        for (&(place, form), name) in places.iter().zip(names) {
            check_place(group.metadata().column(place)).map_err(refuse)?;
            let pages = group.get_column_page_reader(place).map_err(because)?;
            let pages = Box::new(Ordered { pages, has_dictionary: false });
            let of = get_column_reader(metadata.schema_descr().column(place), pages);
            match read(of, form, rows).map_err(because)? {
                Ok(column) => columns.push(column),
                Err(row) => {
                    let row = first + row + 1;
                    return Err(refuse(format!("row {row}, column '{name}': no number")));
                }
            }
        }
        q.reserve(rows * n);
        q.extend((0..rows).flat_map(|row| columns.iter().map(move |column| column[row])));
        first = end;
    }
    Ok(q)
}

/// Refuses negative offsets and sizes, at which the reader would panic.
fn check_place(chunk: &ColumnChunkMetaData) -> Result<(), String> {
    let offsets = [chunk.data_page_offset(), chunk.dictionary_page_offset().unwrap_or(0)];
    if offsets.iter().any(|offset| *offset < 0) || chunk.compressed_size() < 0 {
        let name = chunk.column_path().string();
        return Err(format!("the place of column '{name}' is negative"));
    }
    Ok(())
}

/// The numbers of a column, or the first row that has none.
type Numbers = std::result::Result<Vec<f64>, usize>;

fn read(column: ColumnReader, form: Form, rows: usize) -> Result<Numbers, ParquetError> {
    match column {
        ColumnReader::DoubleColumnReader(column) => numbers(column, rows, |x| x),
        ColumnReader::FloatColumnReader(column) => numbers(column, rows, f64::from),
        ColumnReader::Int32ColumnReader(column) => numbers(column, rows, |x| form.of_short(x)),
        ColumnReader::Int64ColumnReader(column) => numbers(column, rows, |x| form.of_long(x)),
        _ => Ok(if rows == 0 { Ok(Vec::new()) } else { Err(0) }),
    }
}

fn numbers<T: DataType>(
    mut column: ColumnReaderImpl<T>,
    rows: usize,
    number: impl Fn(T::T) -> f64,
) -> Result<Numbers, ParquetError> {
    let (mut values, mut levels, mut read) = (Vec::new(), Vec::new(), 0);
    while read < rows {
        match column.read_records(rows - read, Some(&mut levels), None, &mut values)? {
            (0, ..) => break,
            (records, ..) => read += records,
        }
    }
    // A gap has a level of its own and no value; of repeated values a record has several.
    let gap = || levels.iter().position(|level| *level == 0).unwrap_or(values.len().min(read));
    if values.len() != rows {
        return Ok(Err(gap()));
    }
    Ok(Ok(values.into_iter().map(number).collect()))
}
