//! A small sweep as one CSV file.

use std::borrow::Cow;
use std::path::Path;

use cylindroid::model::check_output_file;
use cylindroid::sweep::{Progress, Sweep, Table, Values};
use cylindroid::{Error, Result};

use crate::output_file;

/// Rows of a CSV file at most.
const MOST: u64 = 1_000_000;
/// Rows computed at once.
const BLOCK: u64 = 4096;

/// Writes all rows, which may be there as a table, under a temporary name, renames, and returns the
/// size (bytes); `None` if `observe` stopped it.
pub(super) fn write(
    sweep: &Sweep,
    table: Option<&Table>,
    path: &Path,
    observe: impl Fn(&Progress) -> bool,
) -> Result<Option<u64>> {
    let rows = sweep.rows();
    if rows > MOST {
        return Err(Error::InvalidOption {
            option: "--out",
            value: path.display().to_string(),
            reason: format!("{rows} rows are too many for CSV ({MOST}); name a folder for Parquet"),
        });
    }
    let cannot = |message: String| Error::Io { path: path.to_owned(), action: "write", message };
    check_output_file(path).map_err(|e| cannot(e.to_string()))?;
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".tmp");
    let temporary = path.with_file_name(name);
    let finished = lines((sweep, table), &temporary, observe, &cannot);
    match finished {
        Ok(true) => {
            std::fs::rename(&temporary, path).map_err(|e| cannot(e.to_string()))?;
            let size = std::fs::metadata(path).map_err(|e| cannot(e.to_string()))?.len();
            Ok(Some(size))
        }
        stopped => {
            let _ = std::fs::remove_file(&temporary);
            stopped.map(|_| None)
        }
    }
}

fn lines(
    (sweep, table): (&Sweep, Option<&Table>),
    path: &Path,
    observe: impl Fn(&Progress) -> bool,
    cannot: &dyn Fn(String) -> Error,
) -> Result<bool> {
    let failed = |e: csv::Error| cannot(e.to_string());
    let all = sweep.rows();
    let file = output_file::create(path).map_err(|e| cannot(e.to_string()))?;
    let mut writer = csv::Writer::from_writer(file);
    writer.write_record(sweep.columns().iter().map(|c| &c.name)).map_err(failed)?;
    let mut start = 0;
    while start < all {
        let progress =
            Progress { unit: "rows", rows: all, at_most: false, done: start, computed: start };
        if !observe(&progress) {
            return Ok(false);
        }
        let end = all.min(start + BLOCK);
        let (table, rows) = match table {
            Some(table) => (Cow::Borrowed(table), start as usize..end as usize),
            None => {
                let table = sweep.table(start..end)?;
                let rows = 0..table.rows();
                (Cow::Owned(table), rows)
            }
        };
        for i in rows {
            let cell = |values: &Values| match values {
                Values::Numbers(numbers) => numbers[i].to_string(),
                Values::Counts(counts) => counts[i].to_string(),
                Values::Texts(texts) => texts[i].to_owned(),
                _ => String::new(),
            };
            writer.write_record(table.values.iter().map(cell)).map_err(failed)?;
        }
        start = end;
    }
    writer.flush().map_err(|e| cannot(e.to_string()))?;
    Ok(true)
}
