//! Files that commands write: new ones, or regular ones that are replaced.
//!
//! Fails    a folder, device, pipe or socket: a pipe would wait for its reader for ever
//! Checked  tests/cli/motion.rs::outputs_are_*

use std::fs::File;
use std::io::{self, Write as _};
use std::path::Path;

/// Rejects what exists and is no regular file.
pub(crate) fn check(path: &Path) -> io::Result<()> {
    // Without metadata it is a new file, or cannot be created for a reason that `create` gives.
    if let Ok(metadata) = std::fs::metadata(path) {
        if metadata.is_dir() {
            return Err(io::Error::other("it is a folder, name a file in it"));
        }
        if !metadata.is_file() {
            let message = "it is a device, pipe or socket; name a regular file or a new one";
            return Err(io::Error::other(message));
        }
    }
    Ok(())
}

/// Creates the file, or empties it.
pub(crate) fn create(path: &Path) -> io::Result<File> {
    check(path)?;
    File::create(path)
}

/// Writes all of the file.
pub(crate) fn write(path: &Path, content: impl AsRef<[u8]>) -> io::Result<()> {
    create(path)?.write_all(content.as_ref())
}
