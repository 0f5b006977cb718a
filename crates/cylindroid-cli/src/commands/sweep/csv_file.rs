//! A small sweep as one CSV file.

use std::borrow::Cow;
use std::path::Path;

use cylindroid::model::check_output_file;
use cylindroid::sweep::{Progress, Sweep, Table, Values};
use cylindroid::{Error, Result};

use crate::output_file;
use crate::trajectory::cannot_write;

/// Rows of a CSV file at most.
const MOST: u64 = 1_000_000;
/// Rows computed at once.
const BLOCK: u64 = 4096;

/// Returns an error for a file that cannot be written, and for more than such a file takes.
pub(super) fn check(sweep: &Sweep, path: &Path) -> Result<()> {
    check_output_file(path).map_err(|e| cannot_write(path, &e))?;
    let (rows, columns) = (sweep.rows(), sweep.columns().len());
    let what = match sweep.check_memory() {
        _ if rows > MOST => format!("{rows} rows are too many for CSV ({MOST})"),
        Err(_) => format!("{rows} rows of {columns} numbers are too many for CSV"),
        Ok(()) => return Ok(()),
    };
    Err(Error::InvalidOption {
        option: "--out",
        value: path.display().to_string(),
        reason: format!("{what}; name a folder for Parquet"),
    })
}

/// Writes all rows of a sweep that [`check`] takes, which may be there as a table, and returns the
/// size (bytes); `None` if `observe` stopped it.
pub(super) fn write(
    sweep: &Sweep,
    table: Option<&Table>,
    path: &Path,
    observe: impl Fn(&Progress) -> bool,
) -> Result<Option<u64>> {
    let failed = |e: csv::Error| cannot_write(path, &e);
    let all = sweep.rows();
    let file = output_file::create(path).map_err(|e| cannot_write(path, &e))?;
    let mut writer = csv::Writer::from_writer(file);
    writer.write_record(sweep.columns().iter().map(|c| &c.name)).map_err(failed)?;
    let mut start = 0;
    while start < all {
        let progress =
            Progress { unit: "rows", rows: all, at_most: false, done: start, computed: start };
        if !observe(&progress) {
            return Ok(None);
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
    let file = writer.into_inner().map_err(|e| cannot_write(path, e.error()))?;
    file.finish().map(Some).map_err(|e| cannot_write(path, &e))
}
