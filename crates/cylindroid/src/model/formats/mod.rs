//! File formats: each file here reads one format and writes nothing but a [`Builder`].
//!
//! [`Builder`]: super::Builder

use std::path::Path;

use super::Mechanism;
use crate::error::{Error, Result};

/// Loads a model: the name of a catalogue model, or the path of a file.
///
/// # Errors
/// A name that is neither, a file that cannot be read or understood.
pub fn load(name_or_path: &str) -> Result<Mechanism> {
    let _ = name_or_path;
    Err(Error::check_len("unwritten", 0, 1).unwrap_err())
}

/// Loads a model file, by its extension and content.
///
/// # Errors
/// As [`load`].
pub fn load_file(path: &Path) -> Result<Mechanism> {
    load(&path.to_string_lossy())
}
