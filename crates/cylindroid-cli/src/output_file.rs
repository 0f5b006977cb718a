//! Files that commands write: new ones, or regular ones that are replaced as a whole.
//!
//! Fails    a folder, device, pipe or socket: a pipe would wait for its reader for ever; a file that may
//!          not be written
//! Why so   written under a name of its own in the same folder and renamed, so that a full disk or a second
//!          process never leaves half a file, or one of two. A link stays one: its file is replaced
//! Checked  tests/cli/motion.rs::outputs_are_*, tests/cli/output_files.rs

use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use cylindroid::model::check_output_file;
use tempfile::NamedTempFile;

/// Links that lead to one another at most, as on Linux.
const MOST_LINKS: usize = 40;

/// A file that is written; one that is not finished is removed.
#[derive(Debug)]
pub(crate) struct OutputFile {
    file: NamedTempFile,
    path: PathBuf,
}

impl OutputFile {
    /// Puts the file in its place and returns its size (bytes).
    pub(crate) fn finish(self) -> io::Result<u64> {
        self.file.as_file().sync_all()?;
        let file = self.file.persist(&self.path).map_err(|failed| failed.error)?;
        Ok(file.metadata()?.len())
    }
}

impl Write for OutputFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.as_file_mut().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.as_file_mut().flush()
    }
}

/// Begins the file; what is there stays until it is finished.
pub(crate) fn create(path: &Path) -> io::Result<OutputFile> {
    check_output_file(path)?;
    let path = behind_links(path)?;
    let folder = path.parent().filter(|folder| *folder != Path::new(""));
    let new = |path: &Path| OpenOptions::new().write(true).create_new(true).open(path);
    let file = tempfile::Builder::new()
        .prefix(".cylindroid-")
        .suffix(".tmp")
        .make_in(folder.unwrap_or(Path::new(".")), new)?;
    // Opened as it would be to write into it, which says whether that is allowed.
    match OpenOptions::new().write(true).open(&path) {
        Ok(old) => keep_permissions(&old, file.as_file())?,
        Err(error) if error.kind() == ErrorKind::NotFound => {}
        Err(error) => return Err(error),
    }
    Ok(OutputFile { file, path })
}

/// Writes all of the file.
pub(crate) fn write(path: &Path, content: impl AsRef<[u8]>) -> io::Result<()> {
    let mut file = create(path)?;
    file.write_all(content.as_ref())?;
    file.finish().map(drop)
}

/// The file to which links lead, which need not be there.
fn behind_links(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        let Ok(next) = fs::read_link(&path) else { return Ok(path) };
        path = path.parent().unwrap_or(Path::new("")).join(next);
    }
    Err(io::Error::other("its links lead to one another; name a regular file or a new one"))
}

/// Gives a file owner and permissions of the one that it replaces.
fn keep_permissions(old: &File, new: &File) -> io::Result<()> {
    let about = old.metadata()?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::{MetadataExt, fchown};
        // Of another owner only root may; the permissions are kept either way.
        let _ = fchown(new, Some(about.uid()), Some(about.gid()));
    }
    new.set_permissions(about.permissions())
}
