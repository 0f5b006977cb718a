//! Loading of models, and the load report.

use std::path::{Path, PathBuf};

use cylindroid::Mechanism;
use cylindroid::model::formats;
use pyo3::prelude::*;

use super::{Origin, PyMechanism};
use crate::error::{Result, argument};
use crate::options;
use crate::table::{self, Table};

/// Loads a model.
///
/// Parameters
/// ----------
/// model : str or os.PathLike
///     The name of a catalogue model (see `catalogue`), or the path of a file: URDF, MJCF, SDF, or a
///     mechanism file in TOML.
///
/// Returns
/// -------
/// Mechanism
///
/// Raises
/// ------
/// UnknownNameError
///     For a name that is neither, with the nearest names.
/// MissingFileError, UnreadableFileError
/// ModelFileError
///     For a file that cannot be understood, with line and column.
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> cy.load("panda")
/// <Mechanism 'panda': 7 coordinates, tool 'hand_tcp'>
/// >>> cy.load("pnda")
/// Traceback (most recent call last):
///     ...
/// cylindroid._errors.UnknownNameError: no catalogue model or file named 'pnda'; nearest: panda, ...
#[pyfunction]
#[pyo3(signature = (model))]
pub(crate) fn load(
    py: Python<'_>,
    #[pyo3(from_py_with = argument)] model: PathBuf,
) -> Result<PyMechanism> {
    let name = model.to_string_lossy().into_owned();
    let inner = py.detach(|| match model.to_str() {
        Some(name) => cylindroid::load(name),
        None => cylindroid::load_file(&model),
    })?;
    // A path is the same from another folder only if it is absolute.
    let model = match std::path::absolute(&model) {
        Ok(path) if !cylindroid::catalogue::names().contains(&name.as_str()) => {
            path.to_string_lossy().into_owned()
        }
        _ => name,
    };
    Ok(PyMechanism::new(inner, Origin::Model(model)))
}

/// Reads a model from text.
///
/// Parameters
/// ----------
/// text : str
/// format : str
///     'urdf', 'mjcf', 'sdf' or 'toml' (a mechanism file).
/// path : str or os.PathLike, optional
///     For messages, and to find meshes and files that the text includes.
///
/// Returns
/// -------
/// Mechanism
///
/// Raises
/// ------
/// UnknownNameError
///     For another format.
/// ModelFileError
///     With line and column.
#[pyfunction]
#[pyo3(signature = (text, format = "urdf", path = None))]
pub(crate) fn parse(
    py: Python<'_>,
    #[pyo3(from_py_with = argument)] text: &str,
    #[pyo3(from_py_with = argument)] format: &str,
    #[pyo3(from_py_with = argument)] path: Option<PathBuf>,
) -> Result<PyMechanism> {
    let path = path.unwrap_or_else(|| PathBuf::from("<text>"));
    type Reader = fn(&str, &Path) -> cylindroid::Result<Mechanism>;
    let readers: [(&str, Reader); 4] = [
        ("urdf", formats::urdf::parse),
        ("mjcf", formats::mjcf::parse),
        ("sdf", formats::sdf::parse),
        ("toml", cylindroid::load_text),
    ];
    let read = options::named("format", format, &readers)?;
    let inner = py.detach(|| read(text, &path))?;
    let origin = Origin::Text { text: text.to_owned(), format: format.to_owned(), path };
    Ok(PyMechanism::new(inner, origin))
}

/// The catalogue of built-in models.
///
/// Returns
/// -------
/// list of (str, str, str)
///     Name, description and source of the parameters.
#[pyfunction]
pub(crate) fn catalogue() -> Vec<(&'static str, String, String)> {
    let entries = cylindroid::catalogue::entries();
    entries.into_iter().map(|e| (e.name, e.description, e.source)).collect()
}

/// A load report: the format and source of a model, and the ignored elements of its file.
///
/// Attributes
/// ----------
/// format, source : str
/// ignored : list of (int, str, str)
///     Line (0 if unknown), element or attribute, and reason.
#[pyclass(frozen, get_all, name = "LoadReport", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyLoadReport {
    format: &'static str,
    source: String,
    /// Line, element or attribute, reason.
    ignored: Vec<(usize, String, String)>,
}

#[pymethods]
impl PyLoadReport {}

table::shown!(PyLoadReport);

impl PyLoadReport {
    fn table(&self) -> Table {
        let mut table = Table::new("LoadReport");
        table.row("format", self.format);
        table.row("source", &self.source);
        table.row("ignored", self.ignored.len().to_string());
        for (line, what, why) in &self.ignored {
            table.row(&format!("line {line}"), format!("{what}: {why}"));
        }
        table
    }
}

#[pymethods]
impl PyMechanism {
    #[getter]
    fn report(&self) -> PyLoadReport {
        let report = self.inner.report();
        PyLoadReport {
            format: report.format,
            source: report.source.clone(),
            ignored: report
                .ignored
                .iter()
                .map(|i| (i.line, i.what.clone(), i.why.clone()))
                .collect(),
        }
    }
}
