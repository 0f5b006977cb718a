//! Source files: which there are, and their text.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

/// The text of a file.
///
/// # Errors
/// A file that cannot be read; the message names it.
pub(super) fn text_of(file: &Path) -> Result<String> {
    fs::read_to_string(file).with_context(|| file.display().to_string())
}

/// Files with one of these endings, in a folder and its subfolders; folders with built or
/// installed files are skipped.
///
/// # Errors
/// A folder that cannot be read.
pub(crate) fn files(folder: &Path, endings: &[&str]) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let path = entry?.path();
        if path.is_dir() {
            let built = path.file_name().is_some_and(|n| n == "target" || n == "node_modules");
            if !built {
                found.extend(files(&path, endings)?);
            }
        } else if path.extension().is_some_and(|e| endings.iter().any(|ending| e == *ending)) {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

/// The path of a file below a folder, with `/`.
pub(super) fn below(folder: &Path, file: &Path) -> String {
    let short = file.strip_prefix(folder).unwrap_or(file);
    short.iter().map(|s| s.to_string_lossy()).collect::<Vec<_>>().join("/")
}
