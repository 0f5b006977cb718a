//! A change of a file.

/// A change of a file.
#[derive(Debug, Clone)]
pub(super) struct Mutant {
    /// Relative to the library's `src`.
    pub(super) file: String,
    pub(super) line: usize,
    /// Bytes of the file.
    pub(super) range: std::ops::Range<usize>,
    pub(super) old: String,
    pub(super) new: String,
}
