//! The one way to read a file, a regular file of bounded size; and the check of a file that is written.
//!
//! Fails    a folder, device, pipe or socket; a file that is larger than the limit
//! Why so   a device never ends, a pipe waits for its writer or reader, and memory has an end. [`files_read`]
//!          lists files here instead of in every loader, so that a loader that fails half-way has
//!          its list as well
//! Checked  tests/formats/limits.rs, tests/formats/load.rs::files_that_are_read_*,
//!          tests/collision/files.rs

use std::cell::RefCell;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};

thread_local! {
    /// The files read in this thread, while [`files_read`] asks for them.
    static READ: RefCell<Option<Vec<PathBuf>>> = const { RefCell::new(None) };
}

/// Does some work, for example loads a model; gives its result and the files that the work read in
/// this thread, or tried to read, each once: the file itself and all that it includes. Files that
/// the program `xacro` reads are not among them, and meshes are read where their shape is needed.
pub fn files_read<T>(work: impl FnOnce() -> T) -> (T, Vec<PathBuf>) {
    let outer = READ.replace(Some(Vec::new()));
    let done = work();
    let read = READ.replace(outer).unwrap_or_default();
    read.iter().for_each(|path| note(path));
    (done, read)
}

/// Adds a file to the list that somebody asks for.
fn note(path: &Path) {
    READ.with_borrow_mut(|read| {
        if let Some(read) = read
            && !read.iter().any(|known| known == path)
        {
            read.push(path.to_owned());
        }
    });
}

/// Reads a regular file of at most `most` bytes; every loader of this library reads by this
/// function.
///
/// # Errors
/// [`Error::Io`] for a path that is missing, unreadable, a folder, device, pipe or socket, and for
/// a file of more than `most` bytes.
pub fn read_regular_file(path: &Path, most: u64) -> Result<Vec<u8>> {
    let file = open_regular_file(path)?;
    let mut bytes = Vec::new();
    // Files of some file systems are longer than their metadata says.
    let read = file.take(most.saturating_add(1)).read_to_end(&mut bytes);
    read.map_err(|e| refusal(path, e.to_string()))?;
    if bytes.len() as u64 > most {
        let limit = most >> 20;
        let message = format!("it is larger than {limit} MiB, the limit of such a file");
        return Err(refusal(path, message));
    }
    Ok(bytes)
}

/// Rejects a path for output that exists and is no regular file; the front ends write to no others.
///
/// # Errors
/// A folder, device, pipe or socket: a pipe would wait for its reader for ever. A file that cannot be
/// created is none; creating it says why.
pub fn check_output_file(path: &Path) -> std::io::Result<()> {
    let Ok(metadata) = std::fs::metadata(path) else { return Ok(()) };
    let message = match (metadata.is_dir(), metadata.is_file()) {
        (_, true) => return Ok(()),
        (true, _) => "it is a folder, name a file in it",
        _ => "it is a device, pipe or socket; name a regular file or a new one",
    };
    Err(std::io::Error::other(message))
}

/// Opens a regular file.
///
/// # Errors
/// Those of [`read_regular_file`], but for the size.
pub(crate) fn open_regular_file(path: &Path) -> Result<File> {
    note(path);
    let io = |e: std::io::Error| refusal(path, e.to_string());
    // Opening a pipe waits for its writer: the kind of the file is known before.
    let metadata = std::fs::metadata(path).map_err(io)?;
    if metadata.is_dir() {
        return Err(refusal(path, "it is a folder, name a file in it".to_owned()));
    }
    if !metadata.is_file() {
        let message = "it is a device, pipe or socket, not a regular file".to_owned();
        return Err(refusal(path, message));
    }
    File::open(path).map_err(io)
}

fn refusal(path: &Path, message: String) -> Error {
    Error::Io { path: path.to_owned(), action: "read", message }
}
