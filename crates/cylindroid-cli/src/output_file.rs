//! Files that commands write: new ones, or regular ones that are replaced.
//!
//! Fails    a folder, device, pipe or socket: a pipe would wait for its reader for ever
//! Checked  tests/cli/motion.rs::outputs_are_*

use std::fs::File;
use std::io::{self, Write as _};
use std::path::Path;

use cylindroid::model::check_output_file;

/// Creates the file, or empties it.
pub(crate) fn create(path: &Path) -> io::Result<File> {
    check_output_file(path)?;
    File::create(path)
}

/// Writes all of the file.
pub(crate) fn write(path: &Path, content: impl AsRef<[u8]>) -> io::Result<()> {
    create(path)?.write_all(content.as_ref())
}
