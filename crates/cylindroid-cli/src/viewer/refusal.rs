//! Why a model is not shown, with the place in its files.

use std::path::Path;

use cylindroid::Error;
use cylindroid::model::read_regular_file;
use serde::Serialize;

/// Longest line of a file that is shown, in characters.
const LONGEST_LINE: usize = 200;
/// Maximum size of a file whose line is shown [bytes].
const LARGEST: u64 = 256 << 20;

/// Why a model is not shown.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub(super) struct Refusal {
    message: String,
    file: Option<String>,
    /// From 1.
    line: Option<usize>,
    /// In characters, from 1.
    column: Option<usize>,
    /// The line itself.
    text: Option<String>,
    help: String,
}

impl Refusal {
    pub(super) fn new(message: impl Into<String>, help: &str) -> Box<Self> {
        let (message, help) = (message.into(), help.to_owned());
        Box::new(Self { message, file: None, line: None, column: None, text: None, help })
    }

    /// An error of the library; paths are those inside `folder`.
    pub(super) fn of(error: &Error, folder: Option<&Path>) -> Box<Self> {
        let inside = |text: &str| match folder {
            Some(folder) => text.replace(&format!("{}/", folder.display()), ""),
            None => text.to_owned(),
        };
        let Error::File(place) = error else {
            return Self::new(inside(&error.to_string()), "");
        };
        // Lines of files elsewhere, which a model includes, are nobody's but the user's.
        let is_inside = folder.is_some_and(|folder| {
            place.path.canonicalize().is_ok_and(|path| path.starts_with(folder))
        });
        let bytes = if is_inside { read_regular_file(&place.path, LARGEST) } else { Ok(vec![]) };
        let bytes = bytes.unwrap_or_default();
        let text = String::from_utf8_lossy(&bytes);
        let line = text.lines().nth(place.line.saturating_sub(1)).unwrap_or_default();
        Box::new(Self {
            message: inside(&place.message),
            file: Some(inside(&place.path.display().to_string())),
            line: Some(place.line),
            column: Some(place.column),
            text: Some(line.trim().chars().take(LONGEST_LINE).collect()),
            help: inside(&place.help),
        })
    }
}
