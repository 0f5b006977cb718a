//! The one way to read a file: a regular file of bounded size.
//!
//! Fails    a folder, device, pipe or socket; a file that is larger than the limit
//! Why so   a device never ends, a pipe waits for its writer, and memory has an end
//! Checked  tests/formats/limits.rs, tests/collision/files.rs

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::error::{Error, Result};

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

/// Opens a regular file.
///
/// # Errors
/// Those of [`read_regular_file`], but for the size.
pub(crate) fn open_regular_file(path: &Path) -> Result<File> {
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
