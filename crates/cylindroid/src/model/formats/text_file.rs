//! The one reader of model files: regular files of bounded size, as text.
//!
//! Valid    UTF-8, with or without a byte order mark; XML that declares ISO-8859-1 (Latin-1)
//! Fails    a folder, device, pipe or socket; more than [`LARGEST_FILE`]; UTF-16; TOML in another
//!          encoding. XML with bytes that are not UTF-8 is read with a note: old files have names
//!          and comments in other encodings, and their numbers are ASCII in all of them
//! Checked  tests/formats/limits.rs

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::error::{Error, Result};

/// The largest model file (bytes): 32 MiB. The largest of 300 public models has 1 MB.
pub(super) const LARGEST_FILE: u64 = 32 << 20;

/// The bytes of all files that one file includes: 64 MiB.
pub(super) const LARGEST_INCLUSION: usize = 64 << 20;

/// The text of a file.
pub(super) struct TextFile {
    pub(super) text: String,
    /// Byte offset in `text` of the first character that replaces bytes that are not UTF-8.
    pub(super) replaced: Option<usize>,
}

/// Reads a model file.
pub(super) fn read(path: &Path) -> Result<TextFile> {
    let bytes = read_bytes(path, LARGEST_FILE)?;
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err(refuse(path, "it is UTF-16, a model file is UTF-8; convert it first"));
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

/// The bytes of a regular file of at most `most` bytes.
fn read_bytes(path: &Path, most: u64) -> Result<Vec<u8>> {
    let io = |e: std::io::Error| refuse(path, &e.to_string());
    // Opening a pipe waits for its writer: the kind of the file is known before.
    let metadata = std::fs::metadata(path).map_err(io)?;
    if metadata.is_dir() {
        return Err(refuse(path, "it is a folder, name a file in it"));
    }
    if !metadata.is_file() {
        return Err(refuse(path, "it is a device, pipe or socket, not a regular file"));
    }
    let mut bytes = Vec::new();
    // Files of some file systems are longer than their size says.
    let read = File::open(path).map_err(io)?.take(most + 1).read_to_end(&mut bytes);
    read.map_err(io)?;
    if bytes.len() as u64 > most {
        let message = format!("it is larger than {} MiB, the limit of a model file", most >> 20);
        return Err(refuse(path, &message));
    }
    Ok(bytes)
}

fn refuse(path: &Path, message: &str) -> Error {
    Error::Io { path: path.to_owned(), action: "read", message: message.to_owned() }
}

/// True for an XML declaration with the encoding ISO-8859-1.
fn declares_latin_1(bytes: &[u8]) -> bool {
    let end = bytes.windows(2).take(200).position(|w| w == b"?>").unwrap_or(0);
    let head = String::from_utf8_lossy(&bytes[..end]).to_lowercase();
    head.starts_with("<?xml")
        && ["iso-8859-1", "latin-1", "latin1"].iter().any(|e| head.contains(e))
}
