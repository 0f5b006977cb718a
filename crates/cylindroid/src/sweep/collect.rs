//! All rows of a sweep in memory.
//!
//! Checked  tests/sweep/parts.rs::collected_rows_are_those_of_the_table

use std::cell::Cell;
use std::num::NonZeroUsize;

use super::Progress;
use super::job::Sweep;
use super::parts::run_parts;
use super::table::{Table, Values};
use crate::error::{Error, Result};

/// Numbers at most: 16 GiB.
const MOST: u64 = 1 << 31;

impl Sweep {
    /// Returns an error for more numbers than [`Sweep::collect`] takes into memory.
    ///
    /// # Errors
    /// More than 2^31 numbers.
    pub fn check_memory(&self) -> Result<()> {
        let numbers = self.rows().saturating_mul(self.columns.len() as u64);
        if numbers <= MOST {
            return Ok(());
        }
        Err(Error::InvalidOption {
            option: "out",
            value: String::new(),
            reason: format!("{numbers} numbers are too many for memory; name a folder"),
        })
    }

    /// All rows, computed by several threads. `threads` and `observe` as in [`Sweep::write`]; `None`
    /// if `observe` stopped the run.
    ///
    /// # Errors
    /// As [`Sweep::table`]; more than 2^31 numbers.
    pub fn collect(
        &self,
        threads: Option<NonZeroUsize>,
        mut observe: impl FnMut(&Progress) -> bool,
    ) -> Result<Option<Table>> {
        self.check_memory()?;
        let mut parts: Vec<Option<Table>> = vec![None; self.parts()];
        let state = Cell::new(Progress::of_rows(self.rows()));
        let work = |(): &mut (), part: usize| self.table(self.rows_of(part));
        let finished = |part: usize, table: Table| {
            let done = state.get().done + table.rows() as u64;
            state.set(Progress { done, computed: done, ..state.get() });
            parts[part] = Some(table);
        };
        run_parts(self.parts(), threads, work, finished, || Ok(observe(&state.get())))?;
        let columns = self.columns.clone();
        let mut all: Vec<Values> = columns.iter().map(super::Column::empty).collect();
        for part in parts {
            let Some(part) = part else { return Ok(None) };
            for (own, more) in all.iter_mut().zip(part.values) {
                own.append(more);
            }
        }
        Ok(Some(Table { columns, values: all }))
    }
}
