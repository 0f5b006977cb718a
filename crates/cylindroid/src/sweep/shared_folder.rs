//! The folder of a sweep whose parts several processes write, and parts for another storage.
//!
//! Why so   parts are the unit of work, whoever computes them: files and manifest are to the byte
//!          those of `Sweep::write`. One process opens the folder, hands out the numbers of parts,
//!          collects what `Sweep::write_part` returns and writes the manifest; a part that two
//!          processes write has the same bytes. Storage that is no folder takes the bytes of
//!          `Sweep::part_file` and `Sweep::manifest`
//! Checked  tests/sweep/shared_folder.rs, tests/sweep/folder.rs

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::job::Sweep;
use super::manifest::{self, MANIFEST, Part, TEMPORARY, cannot_write, part_name};
use super::parquet_file;
use super::table::{Table, Values};
use crate::error::{Error, Result};
use crate::model::check_output_file;

/// A folder that is locked until this value is dropped.
#[derive(Debug)]
pub struct SharedFolder {
    path: PathBuf,
    /// The parts that its manifest lists, none of a new folder. [`Sweep::write_part`] verifies them.
    pub listed: Vec<Option<Part>>,
    /// The lock ends with the open file.
    _lock: File,
}

impl SharedFolder {
    /// Creates a folder, or opens one of the same recipe.
    ///
    /// # Errors
    /// As [`Sweep::write`].
    pub fn open(sweep: &Sweep, path: &Path, resume: bool) -> Result<Self> {
        fs::create_dir_all(path).map_err(|error| cannot_write(path, &error))?;
        let lock = lock(path)?;
        let listed = sweep.listed(path, resume)?;
        remove_temporary(path);
        let own = Self { path: path.to_owned(), listed, _lock: lock };
        own.write_manifest(sweep, &own.listed)?;
        Ok(own)
    }

    /// Writes `manifest.json` with these finished parts.
    ///
    /// # Errors
    /// Another number of parts than the sweep has, a folder or disk that cannot be written.
    pub fn write_manifest(&self, sweep: &Sweep, parts: &[Option<Part>]) -> Result<()> {
        manifest::write(&self.path, &sweep.manifest(parts)?)
    }
}

impl Sweep {
    /// Number of parts.
    #[must_use]
    pub fn parts(&self) -> usize {
        usize::try_from(self.rows().div_ceil(self.part_rows)).unwrap_or(usize::MAX)
    }

    /// The rows of a part.
    pub(super) fn rows_of(&self, part: usize) -> Range<u64> {
        let first = (part as u64).saturating_mul(self.part_rows);
        first..self.rows().min(first.saturating_add(self.part_rows))
    }

    /// Number of rows of a part; 0 of one that the sweep does not have.
    #[must_use]
    pub fn rows_in(&self, part: usize) -> u64 {
        let rows = self.rows_of(part);
        rows.end.saturating_sub(rows.start)
    }

    /// The name of the file of a part.
    #[must_use]
    pub fn part_name(part: usize) -> String {
        part_name(part)
    }

    /// The rows of a part, computed on the thread of the caller.
    ///
    /// # Errors
    /// A part that the sweep does not have; as [`Sweep::table`].
    pub fn part(&self, part: usize) -> Result<Table> {
        self.table(self.rows_of(part))
    }

    /// The file of a part as bytes.
    ///
    /// # Errors
    /// As [`Sweep::part`].
    pub fn part_file(&self, part: usize) -> Result<(Part, Vec<u8>)> {
        let Table { columns, values } = self.part(part)?;
        parquet_file::bytes(&part_name(part), (&self.recipe, &columns), &values)
    }

    /// Writes the file of a part, under another name first. A part that is `listed` is computed only
    /// if its file is another one than that; true if it was.
    ///
    /// # Errors
    /// As [`Sweep::part`]; a folder or disk that cannot be written.
    pub fn write_part(
        &self,
        folder: &Path,
        part: usize,
        listed: Option<&Part>,
    ) -> Result<(Part, bool)> {
        self.write_part_with(&mut Vec::new(), folder, part, listed)
    }

    /// The same with memory for the rows.
    pub(super) fn write_part_with(
        &self,
        memory: &mut Vec<Values>,
        folder: &Path,
        part: usize,
        listed: Option<&Part>,
    ) -> Result<(Part, bool)> {
        let path = folder.join(part_name(part));
        let is_same = |own: &&Part| parquet_file::checksum(&path).is_ok_and(|found| found == **own);
        if let Some(own) = listed.filter(is_same) {
            return Ok((own.clone(), false));
        }
        self.fill(self.rows_of(part), memory)?;
        let temporary = path.with_file_name(temporary_name(part));
        let what = (&self.recipe, &self.columns[..]);
        let written = parquet_file::write(&temporary, what, memory).and_then(|own| {
            fs::rename(&temporary, &path).map_err(|error| cannot_write(&path, &error))?;
            Ok((own, true))
        });
        if written.is_err() {
            // Room for others on a full disk; the error is reported either way.
            let _ = fs::remove_file(&temporary);
        }
        written
    }

    /// The text of `manifest.json` with these finished parts.
    ///
    /// # Errors
    /// Another number of parts than the sweep has.
    pub fn manifest(&self, parts: &[Option<Part>]) -> Result<String> {
        Error::check_len("parts", self.parts(), parts.len())?;
        let what = (&self.recipe, self.columns.as_slice());
        Ok(manifest::text(what, (self.rows(), self.part_rows), parts))
    }

    /// The parts that the text of a manifest lists; `place` names it in errors.
    ///
    /// # Errors
    /// Text that is no manifest; one of another recipe, with the difference; any without `resume`.
    pub fn listed_parts(
        &self,
        place: &str,
        manifest: &str,
        resume: bool,
    ) -> Result<Vec<Option<Part>>> {
        let value = manifest::of_bytes(&Path::new(place).join(MANIFEST), manifest.as_bytes())?;
        self.listed_in(place, &value, resume)
    }

    /// The first entry in which another recipe differs from [`Sweep::recipe`], with both values.
    ///
    /// # Errors
    /// Text that is no JSON.
    pub fn recipe_difference(&self, other: &str) -> Result<Option<String>> {
        let value = manifest::of_bytes(Path::new("recipe"), other.as_bytes())?;
        Ok(self.recipe.difference(&value))
    }

    /// The parts that a folder has according to its manifest.
    fn listed(&self, folder: &Path, resume: bool) -> Result<Vec<Option<Part>>> {
        let place = crate::error::shown(folder);
        match manifest::read(folder)? {
            Some(manifest) => self.listed_in(&place, &manifest, resume),
            // Readers of all parts would take those that this sweep does not replace for its own.
            None => match first_part(folder)? {
                Some(part) => {
                    let name = part_name(part);
                    let reason = format!(
                        "it has parts of a sweep ({name}), but no manifest; remove them, or name \
                         another folder"
                    );
                    Err(refused(&place, reason))
                }
                None => Ok(vec![None; self.parts()]),
            },
        }
    }

    fn listed_in(&self, place: &str, manifest: &Value, resume: bool) -> Result<Vec<Option<Part>>> {
        if !resume {
            let reason = "it has a sweep already; resume it, or name another folder";
            return Err(refused(place, reason.to_owned()));
        }
        match self.recipe.difference(&manifest["recipe"]) {
            None => Ok(manifest::parts(manifest, self.parts())),
            Some(difference) => Err(refused(
                place,
                format!("it has a sweep of another recipe: {difference}; name another folder"),
            )),
        }
    }
}

/// The smallest number of a part whose file is in the folder.
fn first_part(folder: &Path) -> Result<Option<usize>> {
    let cannot = |error: io::Error| Error::Io {
        path: folder.to_owned(),
        action: "read",
        message: error.to_string(),
    };
    let mut first: Option<usize> = None;
    for entry in fs::read_dir(folder).map_err(cannot)? {
        let name = entry.map_err(cannot)?.file_name();
        let number = name.to_str().and_then(manifest::part_number);
        first = first.into_iter().chain(number).min();
    }
    Ok(first)
}

/// The error about a place that does not take the sweep.
fn refused(place: &str, reason: String) -> Error {
    Error::InvalidOption { option: "out", value: place.to_owned(), reason }
}

/// Another one in each process: of several that write into a folder, two may have the same part.
fn temporary_name(part: usize) -> String {
    format!(".{}.{}.tmp", part_name(part), std::process::id())
}

/// Removes parts and a manifest that an ended process left unfinished.
fn remove_temporary(folder: &Path) {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let is_ours = |path: &PathBuf| {
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        name == TEMPORARY || name.starts_with(".part-") && name.ends_with(".tmp")
    };
    for path in entries.map(|entry| entry.path()).filter(is_ours) {
        let _ = fs::remove_file(path);
    }
}

/// One process at a time; the operating system opens the lock of a process that ends.
fn lock(folder: &Path) -> Result<File> {
    let path = folder.join(".lock");
    // Opening a pipe waits for its reader.
    if check_output_file(&path).is_err() {
        let reason = "its .lock is no regular file; remove it, or name another folder";
        return Err(refused(&crate::error::shown(folder), reason.to_owned()));
    }
    let file = OpenOptions::new().create(true).append(true).open(&path);
    let file = file.map_err(|error| cannot_write(&path, &error))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => {
            let reason = "another process is writing a sweep into it";
            Err(refused(&crate::error::shown(folder), reason.to_owned()))
        }
        // File systems without locks.
        Err(TryLockError::Error(_)) => Ok(file),
    }
}
