//! The text of a model file.
//!
//! Valid    UTF-8, with or without a byte order mark; XML that declares ISO-8859-1 (Latin-1)
//! Fails    those of [`read_regular_file`]; a text of more than [`LARGEST_FILE`] bytes; UTF-16; TOML in another encoding. XML with bytes that are
//!          not UTF-8 is read with a note: old files have names and comments in other encodings, and
//!          their numbers are ASCII in all of them
//! Checked  tests/formats/limits.rs, tests/formats/srdf.rs, tests/formats/joint_limits.rs

use std::path::Path;

use super::span::Source;
use crate::error::{Error, Result};
use crate::model::read_regular_file;

/// The largest model file (bytes): 32 MiB. The largest of 300 public models has 1 MB.
pub(super) const LARGEST_FILE: u64 = 32 << 20;

/// The text of a file.
pub(super) struct TextFile {
    pub(super) text: String,
    /// Byte offset in `text` of the first character that replaces bytes that are not UTF-8.
    pub(super) replaced: Option<usize>,
}

/// Returns an error for a text that is larger than a model file may be.
pub(super) fn check_size(source: &Source<'_>) -> Result<()> {
    if source.text.len() as u64 <= LARGEST_FILE {
        return Ok(());
    }
    let message =
        format!("the text is larger than {} MiB, the limit of a model file", LARGEST_FILE >> 20);
    Err(source.error(0..1, message, ""))
}

/// Subject of the note that bytes were replaced.
pub(super) const NOT_UTF8: &str = "bytes that are not UTF-8";
/// Its reason.
pub(super) const WHY_REPLACED: &str =
    "names and texts have \u{fffd} for them; save the file as UTF-8";

impl TextFile {
    /// The text of TOML, which is UTF-8: bytes that are not are an error at their place.
    pub(super) fn utf8(self, format: &'static str, path: &Path) -> Result<String> {
        let Some(at) = self.replaced else { return Ok(self.text) };
        let source = Source { format, path, text: &self.text };
        let message = format!("this is not UTF-8, which a {format} must be");
        Err(source.error(at..at + 1, message, "save it as UTF-8"))
    }

    /// Line, subject and reason of the note that bytes were replaced, if any were.
    pub(super) fn note(&self) -> Option<(usize, &'static str, &'static str)> {
        let line = self.text[..self.replaced?].matches('\n').count() + 1;
        Some((line, NOT_UTF8, WHY_REPLACED))
    }
}

/// Reads a model file.
pub(super) fn read(path: &Path) -> Result<TextFile> {
    let bytes = read_regular_file(path, LARGEST_FILE)?;
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        let message = "it is UTF-16, a model file is UTF-8; convert it first".to_owned();
        return Err(Error::Io { path: path.to_owned(), action: "read", message });
    }
    let bytes = match String::from_utf8(bytes) {
        Ok(text) => return Ok(TextFile { text, replaced: None }),
        Err(error) => error.into_bytes(),
    };
    if declares_latin_1(&bytes) {
        let text = bytes.iter().map(|&b| char::from(b)).collect();
        return Ok(TextFile { text, replaced: None });
    }
    let replaced = std::str::from_utf8(&bytes).err().map(|e| e.valid_up_to());
    Ok(TextFile { text: String::from_utf8_lossy(&bytes).into_owned(), replaced })
}

/// True for an XML declaration with the encoding ISO-8859-1.
fn declares_latin_1(bytes: &[u8]) -> bool {
    let end = bytes.windows(2).take(200).position(|w| w == b"?>").unwrap_or(0);
    let head = String::from_utf8_lossy(&bytes[..end]).to_lowercase();
    head.starts_with("<?xml")
        && ["iso-8859-1", "latin-1", "latin1"].iter().any(|e| head.contains(e))
}
