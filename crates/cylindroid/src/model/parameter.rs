//! Parameters of a model: named numbers from which its file derives geometry, limits and masses.

/// A parameter of a mechanism file, with the value that the model was built with.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// Its value, in the unit of the file.
    pub value: f64,
    /// Smallest value; minus infinity if the file has none.
    pub lower: f64,
    /// Largest value; infinity if the file has none.
    pub upper: f64,
    /// The unit as the file has it; may be empty.
    pub unit: String,
    /// One line of the file; may be empty.
    pub description: String,
    /// The expression of other parameters that gives the value; empty for a number.
    pub expression: String,
}

/// Values of parameters by name, in place of those of the file.
#[cfg(feature = "formats")]
pub(crate) type ParameterValues<'a> = &'a [(&'a str, f64)];
