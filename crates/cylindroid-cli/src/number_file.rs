//! Files of rows of numbers: CSV, JSON lists of lists, and Parquet for configurations.

use std::fmt;
use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

use cylindroid::model::read_regular_file;
use cylindroid::sweep::{coordinate_column, parquet_columns, parquet_configurations};
use cylindroid::{Error, Matrix, Result};

/// The largest file of numbers (bytes): 128 MiB, a million configurations of seven coordinates.
const LARGEST: u64 = 128 << 20;

/// Longest part of a cell in a message [characters].
const LONGEST_SHOWN: usize = 40;

/// Rows of a file.
const MOST_ROWS: usize = 5_000_000;

/// The place of a row in its file, from 1.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Place {
    /// Of CSV.
    Line(u64),
    /// Of a JSON list.
    Row(usize),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Row(row) => write!(f, "row {row}"),
        }
    }
}

/// A row and its place.
#[derive(Debug)]
pub(crate) struct Row {
    pub(crate) place: Place,
    pub(crate) numbers: Vec<f64>,
}

/// The rows of a file, and the names of the columns where a first line has them.
struct Table {
    names: Option<Vec<String>>,
    rows: Vec<Row>,
    /// The first cell of each named column that is no number: its column and its line, as text.
    words: Vec<(usize, String)>,
}

impl Table {
    /// Returns an error if one of these columns has a cell that is no number.
    fn check_numbers(&self, path: &Path, wanted: impl Fn(usize) -> bool) -> Result<()> {
        match self.words.iter().find(|(column, _)| wanted(*column)) {
            Some((_, line)) => Err(cannot_read(path, line)),
            None => Ok(()),
        }
    }
}

/// True for the name of an Arrow file, which Python alone reads.
#[must_use]
pub fn is_arrow(path: &Path) -> bool {
    let ending = path.extension().unwrap_or_default();
    ["arrow", "feather", "ipc"].iter().any(|known| ending.eq_ignore_ascii_case(known))
}

/// True for a Parquet file: by its name, or by its beginning where it has no other known one.
fn is_parquet(path: &Path) -> bool {
    let has_ending = |known: &[&str]| {
        path.extension().is_some_and(|e| known.iter().any(|k| e.eq_ignore_ascii_case(k)))
    };
    let mut beginning = [0; 4];
    // Opening a pipe would wait for its writer.
    has_ending(&["parquet"])
        || !has_ending(&["csv", "json"])
            && fs::metadata(path).is_ok_and(|about| about.is_file())
            && File::open(path).and_then(|mut file| file.read_exact(&mut beginning)).is_ok()
            && beginning == *b"PAR1"
}

/// The rows of a regular file of at most [`LARGEST`] bytes and [`MOST_ROWS`] rows; CSV unless its
/// name ends in .json. A first line of CSV without any number names the columns.
pub(crate) fn rows(path: &Path) -> Result<Vec<Row>> {
    let table = table(path)?;
    table.check_numbers(path, |_| true)?;
    Ok(table.rows)
}

/// The same, with the names of their columns where a first line has them.
pub(crate) fn named_rows(path: &Path) -> Result<(Option<Vec<String>>, Vec<Row>)> {
    let table = table(path)?;
    table.check_numbers(path, |_| true)?;
    Ok((table.names, table.rows))
}

fn table(path: &Path) -> Result<Table> {
    if is_arrow(path) && path.exists() {
        let (from, to) = (path.to_string_lossy(), path.with_extension("parquet"));
        let message = format!(
            "it is an Arrow file; convert it: \
             pyarrow.parquet.write_table(pyarrow.ipc.open_file({from:?}).read_all(), {:?}), or give \
             it to cy.sweep(configurations=...) in Python",
            to.to_string_lossy()
        );
        return Err(cannot_read(path, &message));
    }
    let bytes = read_regular_file(path, LARGEST)?;
    let is_json = path.extension().is_some_and(|e| e == "json");
    if is_json { json(path, &bytes) } else { csv(path, &bytes) }
}

/// The table of a file whose columns have names.
fn named_table(path: &Path) -> Result<Table> {
    let table = table(path)?;
    if table.names.is_some() {
        return Ok(table);
    }
    let remedy = "write them into the first line of a CSV file, or give an array";
    Err(cannot_read(path, &format!("its columns have no names; {remedy}")))
}

/// Configurations one after the other, of the coordinates `names`. Where columns are named, those
/// of the coordinates are read, as in a motion of `move` `q.name` or `name`, and others are not;
/// otherwise, a row has a number for each.
pub(crate) fn configurations(path: &Path, names: &[&str]) -> Result<Vec<f64>> {
    if is_parquet(path) {
        return parquet_configurations(path, names);
    }
    read_columns(path, &table(path)?, names, coordinate_column)
}

/// The same, but never by place.
///
/// # Errors
/// A file that cannot be read or has too many rows, a missing column, an entry that is no number,
/// columns without names.
pub fn named_configurations(path: &Path, names: &[&str]) -> Result<Vec<f64>> {
    if is_parquet(path) {
        return parquet_configurations(path, names);
    }
    read_columns(path, &named_table(path)?, names, coordinate_column)
}

/// The columns of these names, a row after the other; without names, a row has a number for each.
pub(crate) fn columns(path: &Path, names: &[&str]) -> Result<Vec<f64>> {
    if is_parquet(path) {
        return parquet_columns(path, names);
    }
    read_columns(path, &table(path)?, names, own_column)
}

/// The same, but never by place.
///
/// # Errors
/// As [`named_configurations`].
pub fn named_columns(path: &Path, names: &[&str]) -> Result<Vec<f64>> {
    if is_parquet(path) {
        return parquet_columns(path, names);
    }
    read_columns(path, &named_table(path)?, names, own_column)
}

fn own_column(columns: &[String], name: &str) -> Option<usize> {
    columns.iter().position(|column| column == name)
}

fn read_columns(
    path: &Path,
    table: &Table,
    names: &[&str],
    find: impl Fn(&[String], &str) -> Option<usize>,
) -> Result<Vec<f64>> {
    let places: Vec<usize> = match &table.names {
        None => (0..names.len()).collect(),
        Some(columns) => {
            let place = |name: &&str| {
                find(columns, name).ok_or_else(|| {
                    let known = columns.join(", ");
                    cannot_read(path, &format!("no column '{name}' among {known}"))
                })
            };
            let places: Vec<usize> = names.iter().map(place).collect::<Result<_>>()?;
            let twice = |i: &&usize| columns.iter().filter(|c| **c == columns[**i]).count() > 1;
            if let Some(&i) = places.iter().find(twice) {
                return Err(cannot_read(path, &format!("column '{}' is given twice", columns[i])));
            }
            places
        }
    };
    table.check_numbers(path, |column| places.contains(&column))?;
    let expected = table.names.as_ref().map_or(names.len(), Vec::len);
    let mut q = Vec::with_capacity(table.rows.len() * names.len());
    for Row { place, numbers } in &table.rows {
        if numbers.len() != expected {
            let (given, names) = (numbers.len(), names.join(", "));
            let message = format!("{place} has {given} numbers, not {expected} ({names})");
            return Err(cannot_read(path, &message));
        }
        q.extend(places.iter().map(|&i| numbers[i]));
    }
    Ok(q)
}

/// The rows of a file as a matrix of `columns` columns.
pub(crate) fn matrix(path: &Path, columns: usize) -> Result<Matrix> {
    let rows = rows(path)?;
    if let Some(row) = rows.iter().find(|row| row.numbers.len() != columns) {
        let (place, given) = (&row.place, row.numbers.len());
        return Err(cannot_read(path, &format!("{place} has {given} numbers, not {columns}")));
    }
    Ok(Matrix::from_fn(rows.len(), columns, |i, j| rows[i].numbers[j]))
}

fn too_many_rows(path: &Path) -> Error {
    cannot_read(path, &format!("it has more than {MOST_ROWS} rows, the limit of such a file"))
}

fn csv(path: &Path, bytes: &[u8]) -> Result<Table> {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .flexible(true)
        .from_reader(bytes);
    let (mut names, mut rows) = (None, Vec::new());
    let mut words: Vec<(usize, String)> = Vec::new();
    for (i, record) in reader.records().enumerate() {
        let record = record.map_err(|e| cannot_read(path, &e.to_string()))?;
        let line = record.position().map_or(i as u64 + 1, csv::Position::line);
        if rows.len() >= MOST_ROWS {
            return Err(too_many_rows(path));
        }
        let message = |column: usize, cell: &str| {
            let cell: String = cell.chars().take(LONGEST_SHOWN).collect();
            format!("line {line}, column {}: '{cell}' is not a number", column + 1)
        };
        let is_number = |cell: &str| cell.parse::<f64>().is_ok();
        if names.is_none()
            && let Some(column) = record.iter().position(|cell| !is_number(cell))
        {
            let message = message(column, &record[column]);
            if i > 0 {
                return Err(cannot_read(path, &message));
            }
            if record.iter().any(is_number) {
                let remedy = "a first line of names alone is a header";
                return Err(cannot_read(path, &format!("{message}; {remedy}")));
            }
            names = Some(record.iter().map(str::to_owned).collect::<Vec<_>>());
            continue;
        }
        let cell = |(column, cell): (usize, &str)| {
            cell.parse().unwrap_or_else(|_| {
                if words.iter().all(|(known, _)| *known != column) {
                    words.push((column, message(column, cell)));
                }
                f64::NAN
            })
        };
        let numbers = record.iter().enumerate().map(cell).collect();
        rows.push(Row { place: Place::Line(line), numbers });
    }
    Ok(Table { names, rows, words })
}

fn json(path: &Path, bytes: &[u8]) -> Result<Table> {
    // Every row begins with a bracket, and the list of them.
    if bytes.iter().filter(|b| **b == b'[').count() > MOST_ROWS + 1 {
        return Err(too_many_rows(path));
    }
    let rows: Vec<Vec<f64>> = serde_json::from_slice(bytes)
        .map_err(|e| cannot_read(path, &format!("not a list of lists of numbers: {e}")))?;
    let row = |(i, numbers)| Row { place: Place::Row(i + 1), numbers };
    let rows = rows.into_iter().enumerate().map(row).collect();
    Ok(Table { names: None, rows, words: Vec::new() })
}

pub(crate) fn cannot_read(path: &Path, message: &str) -> Error {
    Error::Io { path: path.to_owned(), action: "read", message: message.to_owned() }
}
