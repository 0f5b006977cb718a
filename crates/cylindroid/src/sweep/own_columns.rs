//! Own columns of a sweep: functions of the configurations, beside its quantities.
//!
//! Shapes   q: rows x n, row-major; one number for each row
//! Valid    functions whose result for a row depends on this row alone: parts are computed in any
//!          order, by any thread or machine
//! Fails    on another number of results, and with the function's own message; both name the
//!          column and the rows
//! Why so   a function cannot be compared with that of an earlier run, so the recipe has a version,
//!          which its author changes with the function
//! Checked  tests/sweep/own_columns.rs

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use super::source::Configurations;
use super::table::{Column, Values};
use crate::error::{Error, Result};

/// A function of configurations, n numbers each (rad or m), one after the other: a number for each
/// configuration, or the reason why there is none.
pub type ColumnFunction =
    Arc<dyn Fn(&[f64]) -> std::result::Result<Vec<f64>, String> + Send + Sync>;

/// A column of numbers that the caller computes. The result for a configuration must not depend on
/// the others.
#[derive(Clone)]
pub struct OwnColumn {
    /// Its name, which no other column has.
    pub name: String,
    /// Its unit, "1" for numbers without one.
    pub unit: String,
    /// Of the function; a part of the recipe.
    pub version: String,
    /// Computes a block of rows.
    pub function: ColumnFunction,
}

impl fmt::Debug for OwnColumn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, unit, version, .. } = self;
        f.debug_struct("OwnColumn")
            .field("name", name)
            .field("unit", unit)
            .field("version", version)
            .finish_non_exhaustive()
    }
}

fn refuse(name: &str, reason: String) -> Error {
    Error::InvalidOption { option: "columns", value: name.to_owned(), reason }
}

/// The columns, after the others.
pub(super) fn columns(own: &[OwnColumn], others: &[Column]) -> Result<Vec<Column>> {
    for (i, column) in own.iter().enumerate() {
        let name = &column.name;
        if name.is_empty() {
            return Err(refuse(name, "a column needs a name".to_owned()));
        }
        if others.iter().any(|c| c.name == *name) || own[..i].iter().any(|c| c.name == *name) {
            return Err(refuse(name, "another column has this name; choose another".to_owned()));
        }
    }
    Ok(own.iter().map(|c| Column::own(&c.name, &c.unit)).collect())
}

/// Their entries of these rows.
pub(super) fn run(
    own: &[OwnColumn],
    from: &Configurations,
    rows: Range<u64>,
) -> Result<Vec<Values>> {
    if own.is_empty() {
        return Ok(Vec::new());
    }
    let count = usize::try_from(rows.end - rows.start).unwrap_or(0);
    let mut q = vec![0.0; count * from.n];
    let absent = from.write(rows.clone(), &mut q)?;
    let of = |column: &OwnColumn| {
        let failed = |reason: String| {
            let last = rows.end.saturating_sub(1);
            refuse(&column.name, format!("rows {} to {last}: {reason}", rows.start))
        };
        let found = (column.function)(&q).map_err(failed)?;
        if found.len() != count {
            let got = found.len();
            return Err(failed(format!("{got} values, where {count} rows need one each")));
        }
        let mut found = Values::Numbers(found);
        absent.iter().for_each(|row| found.blank(*row));
        Ok(found)
    };
    own.iter().map(of).collect()
}
