//! From the one error of the library to exceptions, one class for each kind.
//!
//! The classes are written in Python (`cylindroid/_errors.py`), where they derive from what a
//! Python user would catch as well (`ValueError`, `KeyError`, `FileNotFoundError`).

use cylindroid::Error;
use pyo3::exceptions::{PyOverflowError, PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// What a function of this package fails with.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The library's.
    Core(Error),
    /// Python's own.
    Python(PyErr),
    /// An argument of the wrong kind, as a sentence.
    Kind(String),
    /// An object that another call changes at this moment, as a sentence.
    InUse(String),
}

pub(crate) type Result<T> = std::result::Result<T, Failure>;

impl Failure {
    /// An argument that is no number, name or object of the right kind.
    pub(crate) fn kind(message: impl Into<String>) -> Self {
        Self::Kind(message.into())
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
            Failure::Kind(message) => of_class("ArgumentTypeError", &message),
            Failure::InUse(message) => of_class("InUseError", &message),
            Failure::Core(error) => {
                Python::attach(|py| exception(py, &error).unwrap_or_else(|e| e))
            }
        }
    }
}

/// An argument, for `#[pyo3(from_py_with = argument)]`: what Python or PyO3 raise for a value that
/// does not fit becomes an error of this package, which the caller of this function gives the name
/// of the argument (`CylindroidError.add_note`).
pub(crate) fn argument<'a, 'py, T: FromPyObject<'a, 'py>>(
    object: &'a Bound<'py, PyAny>,
) -> PyResult<T> {
    object.extract::<T>().map_err(|error| unfit(object.py(), error.into()))
}

/// Largest number of anything that is found, drawn or repeated: time and memory grow with it.
const MOST: usize = 1_000_000;

/// The same for a number of things.
pub(crate) fn count(object: &Bound<'_, PyAny>) -> PyResult<usize> {
    let n: usize = argument(object)?;
    if n > MOST {
        let message = format!("{n} is too large: at most {MOST}");
        return Err(of_class("InvalidOptionError", &message));
    }
    Ok(n)
}

/// The same for a value inside an argument, here with its name.
pub(crate) fn entry<'a, 'py, T: FromPyObject<'a, 'py>>(
    name: &str,
    object: &'a Bound<'py, PyAny>,
) -> Result<T> {
    argument(object).map_err(|error| {
        let py = object.py();
        let note = format!("while processing '{name}'");
        let _ = error.value(py).call_method1("add_note", (note,));
        error.into()
    })
}

/// The error of this package for one of Python about an argument.
pub(crate) fn unfit(py: Python<'_>, error: PyErr) -> PyErr {
    let class = if error.is_instance_of::<PyTypeError>(py) {
        "ArgumentTypeError"
    } else if error.is_instance_of::<PyValueError>(py)
        || error.is_instance_of::<PyOverflowError>(py)
    {
        "InvalidOptionError"
    } else if error.is_instance_of::<PyRuntimeError>(py) {
        "InUseError"
    } else {
        return error;
    };
    let message = error.value(py).to_string();
    let found = of_class(class, &message);
    found.set_cause(py, Some(error));
    found
}

fn of_class(class: &str, message: &str) -> PyErr {
    Python::attach(|py| {
        let class = py.import("cylindroid._errors").and_then(|m| m.getattr(class));
        match class.and_then(|class| class.call1((message,))) {
            Ok(value) => PyErr::from_value(value),
            Err(error) => error,
        }
    })
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
        Error::OutOfRange { what, value, .. } => {
            fields.set_item("option", what)?;
            fields.set_item("value", value.to_string())?;
            "InvalidOptionError"
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
