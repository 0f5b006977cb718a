//! From the one error of the library to exceptions, one class for each kind.
//!
//! The classes are written in Python (`cylindroid/_errors.py`), where they derive from what a
//! Python user would catch as well (`ValueError`, `KeyError`, `FileNotFoundError`).

use cylindroid::Error;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// What a function of this package fails with.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The library's.
    Core(Error),
    /// Python's own.
    Python(PyErr),
}

pub(crate) type Result<T> = std::result::Result<T, Failure>;

impl Failure {
    /// An argument that is no number, name or object of the right kind.
    pub(crate) fn kind(message: impl Into<String>) -> Self {
        Self::Python(PyTypeError::new_err(message.into()))
    }

    /// An argument outside its domain.
    pub(crate) fn option(
        option: &'static str,
        value: impl Into<String>,
        reason: impl Into<String>,
    ) -> Self {
        Self::Core(Error::InvalidOption { option, value: value.into(), reason: reason.into() })
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Core(error)
    }
}

impl From<PyErr> for Failure {
    fn from(error: PyErr) -> Self {
        Self::Python(error)
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        match failure {
            Failure::Python(error) => error,
            Failure::Core(error) => {
                Python::attach(|py| exception(py, &error).unwrap_or_else(|e| e))
            }
        }
    }
}

/// The exception of an error, its fields as attributes.
fn exception(py: Python<'_>, error: &Error) -> PyResult<PyErr> {
    let fields = PyDict::new(py);
    let mut message = error.to_string();
    let class = match error {
        Error::File(e) => {
            if !e.help.is_empty() {
                message = format!("{message}\n{}", e.help);
            }
            fields.set_item("format", e.format)?;
            fields.set_item("path", e.path.to_string_lossy())?;
            fields.set_item("line", e.line)?;
            fields.set_item("column", e.column)?;
            fields.set_item("help", &e.help)?;
            "ModelFileError"
        }
        Error::Io { path, .. } => {
            fields.set_item("filename", path.to_string_lossy())?;
            if path.exists() { "UnreadableFileError" } else { "MissingFileError" }
        }
        Error::UnknownName { what, name, similar } => {
            fields.set_item("what", what)?;
            fields.set_item("name", name)?;
            fields.set_item("similar", similar)?;
            "UnknownNameError"
        }
        Error::Dimension { what, expected, got, .. } => {
            fields.set_item("what", what)?;
            fields.set_item("expected", expected)?;
            fields.set_item("got", got)?;
            "DimensionError"
        }
        Error::NotFinite { what, value } => {
            fields.set_item("what", what)?;
            fields.set_item("value", value)?;
            "NotFiniteError"
        }
        Error::InvalidOption { option, value, reason } => {
            fields.set_item("option", option)?;
            fields.set_item("value", value)?;
            fields.set_item("reason", reason)?;
            "InvalidOptionError"
        }
        Error::Model { model, culprit, .. } => {
            fields.set_item("model", model)?;
            fields.set_item("culprit", culprit)?;
            "ModelError"
        }
        _ => "CylindroidError",
    };
    let value = py.import("cylindroid._errors")?.getattr(class)?.call1((message,))?;
    for (name, field) in fields {
        value.setattr(name.extract::<&str>()?, field)?;
    }
    Ok(PyErr::from_value(value))
}
