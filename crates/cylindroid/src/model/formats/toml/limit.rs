//! The limits of a mechanism file, verified before the text is parsed: its size, its values, and
//! its words and marks.
//!
//! Why so   the parser keeps about 150 bytes for every value and up to 110 for every other word,
//!          mark, blank and line, so a small file can exhaust memory
//! Checked  tests/formats/limits.rs, tests/formats/large_models.rs

use crate::error::Result;
use crate::model::formats::span::Source;
use crate::model::formats::text_file;

/// Keys, values and tables of a file; the marks that separate them are counted, wherever they are.
const MOST_VALUES: usize = 1_000_000;

/// Words, marks, runs of blanks and ends of lines, wherever they are.
const MOST_WORDS: usize = 4_000_000;

/// Returns an error for a text that exceeds a limit.
pub(super) fn check(source: &Source<'_>) -> Result<()> {
    text_file::check_size(source)?;
    let exceeds = |at: usize, most: usize, what: &str| {
        let message = format!("the file has more than {most} {what}, the limit of this reader");
        Err(source.error(at..at + 1, message, ""))
    };
    let (mut values, mut words, mut before) = (0, 0, Kind::Mark);
    for (at, byte) in source.text.bytes().enumerate() {
        let kind = Kind::of(byte);
        words += usize::from(kind == Kind::Mark || kind != before);
        values += usize::from(matches!(byte, b',' | b'=' | b'[' | b'{'));
        before = kind;
        if values > MOST_VALUES {
            return exceeds(at, MOST_VALUES, "values");
        }
        if words > MOST_WORDS {
            return exceeds(at, MOST_WORDS, "words, marks and lines");
        }
    }
    Ok(())
}

/// The parts of a text that the parser distinguishes.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// One byte is one part.
    Mark,
    Blank,
    Word,
}

impl Kind {
    const fn of(byte: u8) -> Self {
        match byte {
            b' ' | b'\t' => Self::Blank,
            b'.' | b'=' | b',' | b'[' | b']' | b'{' | b'}' | b'#' | b'\r' | b'\n' | b'\''
            | b'"' => Self::Mark,
            _ => Self::Word,
        }
    }
}
