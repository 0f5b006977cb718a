//! The lines for functions whose name in Python is another, or that Python does not have.
//!
//! ```text
//! # a comment
//! screws::ScrewSystem::order -> ScrewSystem.rank
//! linalg::* : numpy and scipy have it
//! ```

use anyhow::{Result, bail};

/// A line.
#[derive(Debug)]
pub(super) struct Exception {
    pub(super) line: usize,
    /// A path, or the beginning of paths with `*` at its end.
    pub(super) pattern: String,
    pub(super) way: Way,
}

/// What Python has instead.
#[derive(Debug)]
pub(super) enum Way {
    /// Something of this name: `Class.member`, `Class` or `function`.
    Name(String),
    /// Nothing, for this reason.
    Reason,
}

impl Exception {
    pub(super) fn covers(&self, path: &str) -> bool {
        match self.pattern.strip_suffix('*') {
            Some(beginning) => path.starts_with(beginning),
            None => path == self.pattern,
        }
    }
}

/// # Errors
/// A line that is neither `path -> name` nor `path : reason`, and a path with two lines.
pub(super) fn parse(text: &str) -> Result<Vec<Exception>> {
    let mut found: Vec<Exception> = Vec::new();
    for (i, line) in text.lines().enumerate().filter(|(_, l)| !l.is_empty() && !l.starts_with('#'))
    {
        let line_number = i + 1;
        let (pattern, way) = match (line.split_once(" -> "), line.split_once(" : ")) {
            (Some((path, name)), _) => (path, Way::Name(name.trim().to_owned())),
            (None, Some((path, reason))) if !reason.trim().is_empty() => (path, Way::Reason),
            _ => {
                bail!("line {line_number}: '{line}' is neither `path -> name` nor `path : reason`")
            }
        };
        if found.iter().any(|e| e.pattern == pattern.trim()) {
            bail!("line {line_number}: {pattern} has two lines");
        }
        found.push(Exception { line: line_number, pattern: pattern.trim().to_owned(), way });
    }
    Ok(found)
}
