//! What a loader did not use: nothing in a file is dropped in silence.

/// What was read and what was not.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LoadReport {
    /// "URDF", "mechanism file", "catalogue", ...
    pub format: &'static str,
    /// Where the numbers come from, as far as the file says.
    pub source: String,
    /// What was ignored, in the order of the file.
    pub ignored: Vec<Ignored>,
}

/// Something in a file that the model does not hold, or that was repaired.
#[derive(Debug, Clone, PartialEq)]
pub struct Ignored {
    /// Line in the file, from 1; 0 where it has none.
    pub line: usize,
    /// What: element, attribute, value.
    pub what: String,
    /// Why, and what it means for the result.
    pub why: String,
}

impl LoadReport {
    /// Notes that something was not used.
    pub fn ignore(&mut self, line: usize, what: impl Into<String>, why: impl Into<String>) {
        self.ignored.push(Ignored { line, what: what.into(), why: why.into() });
    }
}
