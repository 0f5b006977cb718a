//! A change of a file, and the place of its build.

/// Programs of the copy: in `target` cargo would take them for those of the workspace.
pub(super) const BUILD: &str = "target/mutants-build";

/// A change of a file.
#[derive(Debug, Clone)]
pub(super) struct Mutant {
    /// Relative to the library's `src`.
    pub(super) file: String,
    pub(super) line: usize,
    /// The whole line, without the spaces around it.
    pub(super) text: String,
    /// Bytes of the file.
    pub(super) range: std::ops::Range<usize>,
    pub(super) old: String,
    pub(super) new: String,
}
