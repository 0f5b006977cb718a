//! A sweep in a folder: a Parquet file for each part and a manifest, computed by several threads,
//! stopped and resumed.
//!
//! Why so   a part is written under another name, made durable and renamed, and a manifest of the
//!          finished parts follows at most a second later: whatever ends the process, the folder is
//!          a valid beginning. A resumed run computes the parts that are missing from the manifest
//!          or do not have its checksum. Each thread holds one part, so memory does not grow with
//!          the sweep
//! Checked  tests/sweep/folder.rs

use std::cell::{Cell, RefCell};
use std::fs::{self, File, OpenOptions, TryLockError};
use std::num::NonZeroUsize;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::job::Sweep;
use super::manifest::{self, Part, cannot_write, part_name};
use super::parquet_file;
use super::parts::run_parts;
use crate::error::{Error, Result};

/// Between two manifests at least.
const BETWEEN_MANIFESTS: Duration = Duration::from_secs(1);

/// How a sweep is written.
#[derive(Debug, Clone, Copy, Default)]
pub struct WriteOptions {
    /// Threads: as many as the machine has by default. Results do not depend on them.
    pub threads: Option<NonZeroUsize>,
    /// Continues a folder of the same recipe.
    pub resume: bool,
}

/// The state of a running sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Rows of the sweep.
    pub rows: u64,
    /// Rows in finished parts, those of earlier runs included.
    pub done: u64,
    /// Rows that this run computed.
    pub computed: u64,
}

/// The result of writing a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Summary {
    /// Rows of the sweep.
    pub rows: u64,
    /// Rows that this run computed.
    pub computed: u64,
    /// Finished parts.
    pub parts: usize,
    /// Size of the finished parts (bytes).
    pub bytes: u64,
    /// False if the observer stopped the run.
    pub complete: bool,
}

impl Sweep {
    /// Number of parts.
    #[must_use]
    pub fn parts(&self) -> usize {
        usize::try_from(self.rows().div_ceil(self.part_rows)).unwrap_or(usize::MAX)
    }

    /// Writes `part-*.parquet` and `manifest.json` into a folder, which is created. `observe` is
    /// called ten times a second on the thread of the caller, until it returns false, which stops
    /// the run after the parts that are being computed.
    ///
    /// # Errors
    /// A folder that has a sweep already, without [`WriteOptions::resume`]; with it, one of another
    /// recipe, with the difference; one that another process is writing; a folder or disk that
    /// cannot be written. Finished parts remain valid after an error.
    pub fn write(
        &self,
        folder: &Path,
        options: &WriteOptions,
        mut observe: impl FnMut(&Progress) -> bool,
    ) -> Result<Summary> {
        fs::create_dir_all(folder).map_err(|error| cannot_write(folder, &error))?;
        let _lock = lock(folder)?;
        let listed = self.listed(folder, options.resume)?;
        remove_temporary(folder);
        // Listed until they are verified, so that a stop meanwhile loses nothing.
        let parts = listed.clone();
        self.write_manifest(folder, &parts)?;
        let parts = RefCell::new(parts);
        let state = Cell::new(Progress { rows: self.rows(), done: 0, computed: 0 });
        let finished = Cell::new(0);
        let mut last = Instant::now();
        let work = |part: usize| self.verified_or_written(folder, part, listed[part].as_ref());
        let take = |part: usize, (own, computed): (Part, bool)| {
            let rows = self.rows_of(part);
            let (rows, before) = (rows.end - rows.start, state.get());
            let computed = before.computed + if computed { rows } else { 0 };
            state.set(Progress { done: before.done + rows, computed, ..before });
            finished.set(finished.get() + 1);
            parts.borrow_mut()[part] = Some(own);
        };
        let tick = || {
            if last.elapsed() > BETWEEN_MANIFESTS {
                last = Instant::now();
                self.write_manifest(folder, &parts.borrow())?;
            }
            Ok(observe(&state.get()))
        };
        let ended = run_parts(self.parts(), options.threads, work, take, tick);
        let parts = parts.into_inner();
        let written = self.write_manifest(folder, &parts);
        ended.and(written)?;
        Ok(Summary {
            rows: self.rows(),
            computed: state.get().computed,
            parts: finished.get(),
            bytes: parts.iter().flatten().map(|part| part.bytes).sum(),
            complete: finished.get() == parts.len(),
        })
    }

    /// The parts that a folder has according to its manifest.
    fn listed(&self, folder: &Path, resume: bool) -> Result<Vec<Option<Part>>> {
        let refuse = |reason: String| {
            Err(Error::InvalidOption { option: "out", value: crate::error::shown(folder), reason })
        };
        let Some(manifest) = manifest::read(folder)? else {
            let has_parts = folder.join(part_name(0)).exists();
            if has_parts && !resume {
                return refuse(
                    "it has parts of a sweep, but no manifest; name another folder".to_owned(),
                );
            }
            return Ok(vec![None; self.parts()]);
        };
        if !resume {
            let reason = "it has a sweep already; resume it, or name another folder";
            return refuse(reason.to_owned());
        }
        match self.recipe.difference(&manifest["recipe"]) {
            None => Ok(manifest::parts(&manifest, self.parts())),
            Some(difference) => refuse(format!(
                "it has a sweep of another recipe: {difference}; name another folder"
            )),
        }
    }

    fn write_manifest(&self, folder: &Path, parts: &[Option<Part>]) -> Result<()> {
        let what = (&self.recipe, self.columns.as_slice());
        manifest::write(folder, what, (self.rows(), self.part_rows), parts)
    }

    /// The rows of a part.
    pub(super) fn rows_of(&self, part: usize) -> Range<u64> {
        let first = part as u64 * self.part_rows;
        first..self.rows().min(first + self.part_rows)
    }

    /// A part that the manifest lists, if its file is the one that was written; otherwise a new one.
    /// True if it was computed.
    fn verified_or_written(
        &self,
        folder: &Path,
        part: usize,
        listed: Option<&Part>,
    ) -> Result<(Part, bool)> {
        let path = folder.join(part_name(part));
        let is_same = |own: &&Part| parquet_file::checksum(&path).is_ok_and(|found| found == **own);
        match listed.filter(is_same) {
            Some(own) => Ok((own.clone(), false)),
            None => Ok((self.write_part(&path, part)?, true)),
        }
    }

    fn write_part(&self, path: &Path, part: usize) -> Result<Part> {
        let table = self.table(self.rows_of(part))?;
        let temporary = path.with_file_name(temporary_name(part));
        let written =
            parquet_file::write(&temporary, &table.columns, &table.values).and_then(|own| {
                fs::rename(&temporary, path).map_err(|error| cannot_write(path, &error))?;
                Ok(own)
            });
        if written.is_err() {
            // Room for others on a full disk; the error is reported either way.
            let _ = fs::remove_file(&temporary);
        }
        written
    }
}

fn temporary_name(part: usize) -> String {
    format!(".{}.tmp", part_name(part))
}

/// Removes parts that an ended process left unfinished.
fn remove_temporary(folder: &Path) {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let is_ours = |path: &PathBuf| {
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        name.starts_with(".part-") && name.ends_with(".parquet.tmp")
    };
    for path in entries.map(|entry| entry.path()).filter(is_ours) {
        let _ = fs::remove_file(path);
    }
}

/// One process at a time; the operating system opens the lock of a process that ends.
fn lock(folder: &Path) -> Result<File> {
    let path = folder.join(".lock");
    let file = OpenOptions::new().create(true).append(true).open(&path);
    let file = file.map_err(|error| cannot_write(&path, &error))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(Error::InvalidOption {
            option: "out",
            value: crate::error::shown(folder),
            reason: "another process is writing a sweep into it".to_owned(),
        }),
        // File systems without locks.
        Err(TryLockError::Error(_)) => Ok(file),
    }
}
