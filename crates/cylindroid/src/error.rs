//! The error type of the library: every message names the culprit, the place and a remedy.
//!
//! Degeneracy (a lost rank, an inverse that does not exist, an unreachable target) is never an
//! error; it is a value in a report. Errors are for invalid input: a malformed file, a wrong number
//! of joints, a non-finite value, an unknown name.
//!
//! Checked  tests in this file, tests/formats/broken.rs

use std::ops::{Range, RangeInclusive};
use std::path::{Path, PathBuf};

/// Result of every fallible function of the library.
pub type Result<T> = std::result::Result<T, Error>;

/// An error: its cause, its place and a remedy.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A model file that cannot be parsed.
    #[error(transparent)]
    File(Box<FileError>),

    /// A file that cannot be read or written.
    #[error("cannot {action} {}: {message}", shown(path))]
    Io {
        /// The path as given.
        path: PathBuf,
        /// The attempted action: "read" or "write".
        action: &'static str,
        /// The message of the operating system.
        message: String,
    },

    /// A name unknown to the model or the library.
    #[error("no {what} named '{}'{}", beginning(name), offer(similar))]
    UnknownName {
        /// The kind of thing: "frame", "joint", "catalogue model", ...
        what: &'static str,
        /// The name as given.
        name: String,
        /// The most similar valid names, best first; all names where there are few.
        similar: Vec<String>,
    },

    /// A vector or matrix of the wrong size.
    #[error("{what} has {got} entries, expected {expected}{}", hint_text(hint))]
    Dimension {
        /// The argument.
        what: String,
        /// The expected size.
        expected: usize,
        /// The given size.
        got: usize,
        /// The meaning of the entries (joint names in order), or empty.
        hint: String,
    },

    /// NaN or infinity where a finite number is required.
    #[error("{what} is not finite: {value}")]
    NotFinite {
        /// The argument, with its index or joint name if it has one.
        what: String,
        /// The offending value.
        value: f64,
    },

    /// A finite number whose products would not be finite.
    #[error("{what} = {value:e} is out of range: magnitudes up to {range:e} are accepted")]
    OutOfRange {
        /// The argument, with its index or joint name if it has one.
        what: String,
        /// The offending value.
        value: f64,
        /// The largest magnitude accepted.
        range: f64,
    },

    /// An argument outside its domain.
    #[error("{option}{}: {reason}", refused(value))]
    InvalidOption {
        /// The argument or option.
        option: &'static str,
        /// Its value as text, empty if it is missing.
        value: String,
        /// The reason, and an alternative.
        reason: String,
    },

    /// An inconsistent model (from the builder; loaders add the place in the file).
    #[error("model '{model}': {message}")]
    Model {
        /// Name of the mechanism.
        model: String,
        /// The joint, link or frame at fault (empty for the model as a whole).
        culprit: String,
        /// The fault and its remedy.
        message: String,
    },
}

/// A place in a model file that cannot be parsed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{}:{line}:{column}: {message}", shown(path))]
pub struct FileError {
    /// The format of the file: "URDF", "mechanism file", ...
    pub format: &'static str,
    /// The file.
    pub path: PathBuf,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Byte range of the offending text in the file.
    pub span: Range<usize>,
    /// The fault.
    pub message: String,
    /// The remedy (may be empty).
    pub help: String,
}

impl Error {
    /// An [`Error::UnknownName`] that suggests the most similar of the `known` names.
    pub fn unknown(
        what: &'static str,
        name: &str,
        known: impl IntoIterator<Item: AsRef<str>>,
    ) -> Self {
        Self::UnknownName { what, name: name.to_owned(), similar: nearest(name, known) }
    }

    /// Returns an error for the first entry of `values` that is NaN or infinite.
    #[inline]
    pub fn check_finite(what: &str, values: &[f64]) -> Result<()> {
        if all_finite(values) { Ok(()) } else { Self::find_not_finite(what, values) }
    }

    #[cold]
    fn find_not_finite(what: &str, values: &[f64]) -> Result<()> {
        match values.iter().position(|v| !v.is_finite()) {
            None => Ok(()),
            Some(i) => Err(Self::NotFinite { what: format!("{what}[{i}]"), value: values[i] }),
        }
    }

    /// Returns an error for the first entry of `values` that is NaN, infinite or of a magnitude
    /// beyond `range`.
    pub fn check_within(what: &str, values: &[f64], range: f64) -> Result<()> {
        if all_within(values, range) {
            return Ok(());
        }
        Self::check_finite(what, values)?;
        match values.iter().position(|x| x.abs() > range) {
            None => Ok(()),
            Some(i) => {
                Err(Self::OutOfRange { what: format!("{what}[{i}]"), value: values[i], range })
            }
        }
    }

    /// Returns an error for an option that is not positive and finite.
    pub fn check_positive(option: &'static str, value: f64) -> Result<()> {
        if value > 0.0 && value.is_finite() {
            return Ok(());
        }
        Err(Self::InvalidOption {
            option,
            value: number_text(value),
            reason: "it must be positive and finite".to_owned(),
        })
    }

    /// Returns an error for an option that is not within this range, NaN included.
    pub fn check_range(
        option: &'static str,
        value: f64,
        range: &RangeInclusive<f64>,
    ) -> Result<()> {
        if range.contains(&value) {
            return Ok(());
        }
        Err(Self::InvalidOption {
            option,
            value: number_text(value),
            reason: format!("it must be from {:e} to {:e}", range.start(), range.end()),
        })
    }

    /// A size that is not `each` numbers for each configuration.
    pub(crate) fn rows(what: &str, expected: usize, got: usize, each: usize) -> Self {
        let hint = format!("{each} for each configuration");
        Self::Dimension { what: what.to_owned(), expected, got, hint }
    }

    /// Returns an error for a size other than `expected`.
    pub fn check_len(what: &str, expected: usize, got: usize) -> Result<()> {
        if expected == got {
            Ok(())
        } else {
            Err(Self::Dimension { what: what.to_owned(), expected, got, hint: String::new() })
        }
    }
}

/// Longer names (bytes) are not compared: the time of a comparison is the product of the lengths.
const LONGEST_COMPARED: usize = 1000;

/// The names of `known` nearest to `name`, best first: at most five, all when there are no more.
fn nearest(name: &str, known: impl IntoIterator<Item: AsRef<str>>) -> Vec<String> {
    if name.len() > LONGEST_COMPARED {
        return Vec::new();
    }
    let given = name.to_lowercase();
    let mut ranked: Vec<(f64, String)> = known
        .into_iter()
        .filter(|candidate| candidate.as_ref().len() <= LONGEST_COMPARED)
        .map(|candidate| {
            let candidate = candidate.as_ref();
            let lower = candidate.to_lowercase();
            let contains = lower.contains(&given) || given.contains(&lower);
            // One or two letters occur in half of all words by chance.
            let bonus = if contains && lower.len().min(given.len()) > 2 { 0.5 } else { 0.0 };
            (strsim::jaro_winkler(&given, &lower) + bonus, candidate.to_owned())
        })
        .collect();
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0).then_with(|| a.1.cmp(&b.1)));
    ranked.into_iter().take(5).map(|(_, name)| name).collect()
}

fn offer(similar: &[String]) -> String {
    if similar.is_empty() { String::new() } else { format!("; nearest: {}", similar.join(", ")) }
}

fn refused(value: &str) -> String {
    if value.is_empty() {
        return " is missing".to_owned();
    }
    format!(" = {} cannot be used", beginning(value))
}

/// Longest part of a given text in a message [characters].
const LONGEST_SHOWN: usize = 200;

/// A given text for messages, without the end of a long one.
fn beginning(text: &str) -> String {
    match text.char_indices().nth(LONGEST_SHOWN) {
        None => text.to_owned(),
        Some((end, _)) => format!("{}...", &text[..end]),
    }
}

fn hint_text(hint: &str) -> String {
    if hint.is_empty() { String::new() } else { format!(" ({hint})") }
}

/// A path for messages; bytes that are not UTF-8 are written as `\xNN`.
pub(crate) fn shown(path: &Path) -> String {
    let mut text = String::new();
    for chunk in path.as_os_str().as_encoded_bytes().utf8_chunks() {
        text.push_str(chunk.valid());
        chunk.invalid().iter().for_each(|byte| text.push_str(&format!("\\x{byte:02x}")));
    }
    text
}

/// A number for a message: without rows of zeros.
pub(crate) fn number_text(value: f64) -> String {
    let is_usual = value == 0.0 || (1e-4..1e16).contains(&value.abs());
    if is_usual { value.to_string() } else { format!("{value:e}") }
}

/// True if no number is NaN or infinite (zero times it is zero). Eight independent sums, for speed.
#[inline]
pub(crate) fn all_finite(values: &[f64]) -> bool {
    let (eights, rest) = values.as_chunks::<8>();
    let mut sums = [0.0; 8];
    for eight in eights {
        for (sum, x) in sums.iter_mut().zip(eight) {
            *sum += 0.0 * x;
        }
    }
    let rest: f64 = rest.iter().map(|x| 0.0 * x).sum();
    sums.iter().sum::<f64>() + rest == 0.0
}

/// True if all numbers are finite and at most `range` in magnitude, up to the root of their number:
/// the sum of their squares says so without a branch. False needs a closer look.
#[inline]
pub(crate) fn all_within(values: &[f64], range: f64) -> bool {
    let (eights, rest) = values.as_chunks::<8>();
    let mut sums = [0.0; 8];
    for eight in eights {
        for (sum, x) in sums.iter_mut().zip(eight) {
            *sum += x * x;
        }
    }
    let rest: f64 = rest.iter().map(|x| x * x).sum();
    sums.iter().sum::<f64>() + rest <= range * range
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_name_offers_the_nearest_first() {
        let error = Error::unknown("frame", "tool_0", ["base", "tool0", "wrist_3_link"]);
        assert!(error.to_string().starts_with("no frame named 'tool_0'; nearest: tool0"));
    }

    #[test]
    fn long_texts_are_not_repeated() {
        let long = "\u{e9}".repeat(5000);
        let unknown = Error::unknown("frame", &long, ["tool0"]);
        let invalid =
            Error::InvalidOption { option: "name", value: long, reason: "it is long".to_owned() };
        for error in [unknown, invalid] {
            let message = error.to_string();
            assert!(message.contains("\u{e9}...") && message.len() < 500, "{message}");
        }
    }

    #[test]
    fn one_number_that_is_not_finite_is_found_anywhere() {
        for n in 0..=17 {
            let mut values = vec![-1e308; n];
            assert!(all_finite(&values));
            for i in 0..n {
                for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                    values[i] = bad;
                    assert!(!all_finite(&values), "{bad} at {i} of {n}");
                }
                values[i] = 0.0;
            }
        }
    }

    #[test]
    fn a_number_out_of_range_is_found_anywhere() {
        for n in 1..=17 {
            let mut values = vec![1e90; n];
            assert!(all_within(&values, 1e100) && !all_within(&values, 1e90 * 0.9));
            for i in 0..n {
                for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e101, -f64::MAX] {
                    values[i] = bad;
                    assert!(!all_within(&values, 1e100), "{bad} at {i} of {n}");
                    assert!(Error::check_within("q", &values, 1e100).is_err());
                }
                values[i] = 0.0;
            }
        }
    }

    #[test]
    fn check_finite_names_the_entry() {
        let error = Error::check_finite("q", &[0.0, f64::NAN]).unwrap_err();
        assert_eq!(error.to_string(), "q[1] is not finite: NaN");
    }
}
