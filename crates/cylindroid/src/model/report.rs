//! Load reports: the parameters of a file, and its parts that a loader did not use.

use super::parameter::Parameter;

/// The result of loading a file: its format, its source, its parameters, what was ignored.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LoadReport {
    /// "URDF", "mechanism file", "catalogue", ...
    pub format: &'static str,
    /// The origin of the data, if the file gives one.
    pub source: String,
    /// The parameters, in the order of the file.
    pub parameters: Vec<Parameter>,
    /// What was ignored, in the order of the file.
    pub ignored: Vec<Ignored>,
}

/// A part of a file that the model does not contain, or that was repaired.
#[derive(Debug, Clone, PartialEq)]
pub struct Ignored {
    /// Line in the file, from 1; 0 where it has none.
    pub line: usize,
    /// The element, attribute or value.
    pub what: String,
    /// The reason, and the effect on the result.
    pub why: String,
}

impl LoadReport {
    /// Records a part that was not used.
    pub fn ignore(&mut self, line: usize, what: impl Into<String>, why: impl Into<String>) {
        self.ignored.push(Ignored { line, what: what.into(), why: why.into() });
    }
}
