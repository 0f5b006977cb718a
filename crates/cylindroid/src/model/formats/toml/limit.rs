//! The limit of values of a mechanism file, verified before the text is parsed.
//!
//! Why so   the parser keeps about 150 bytes for every value, so a small file can exhaust memory
//! Checked  tests/formats/limits.rs

use crate::error::Result;
use crate::model::formats::span::Source;

/// Keys and values of a file; the marks that separate them are counted, wherever they are.
const MOST_VALUES: usize = 1_000_000;

/// Returns an error for a text with more values.
pub(super) fn check(source: &Source<'_>) -> Result<()> {
    let marks = source.text.bytes().enumerate().filter(|(_, b)| matches!(b, b',' | b'=' | b'['));
    match marks.map(|(i, _)| i).nth(MOST_VALUES) {
        None => Ok(()),
        Some(at) => {
            let message =
                format!("the file has more than {MOST_VALUES} values, the limit of this reader");
            Err(source.error(at..at + 1, message, ""))
        }
    }
}
