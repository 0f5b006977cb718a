//! Loading of models, and the load report.

use std::path::{Path, PathBuf};

use cylindroid::model::{LoadReport, formats};
use cylindroid::{Mechanism, ParametricModel};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::{Origin, PyMechanism};
use crate::error::{Failure, Result, argument, entry};
use crate::options;
use crate::table::{self, Table};

/// Loads a model.
///
/// Parameters
/// ----------
/// model : str or os.PathLike
///     The name of a catalogue model (see `catalogue`), or the path of a file: URDF, MJCF, SDF, or a
///     mechanism file in TOML. 'world.sdf#NAME' is one of the models of an SDF file.
/// parameters : dict of str to float, optional
///     Values of parameters of a mechanism file, in place of those of the file.
///
/// Returns
/// -------
/// Mechanism
///
/// Raises
/// ------
/// UnknownNameError
///     For a name that is neither and for an unknown parameter, with the nearest names.
/// InvalidOptionError
///     For a value that is out of the range of its parameter, and a model without parameters.
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
#[pyo3(signature = (model, parameters = None))]
pub(crate) fn load(
    py: Python<'_>,
    #[pyo3(from_py_with = argument)] model: PathBuf,
    #[pyo3(from_py_with = argument)] parameters: Option<Bound<'_, PyDict>>,
) -> Result<PyMechanism> {
    let parameters = parameter_values(parameters.as_ref())?;
    let name = model.to_string_lossy().into_owned();
    let inner = py.detach(|| match model.to_str() {
        None if parameters.is_empty() => cylindroid::load_file(&model),
        _ => cylindroid::load_with_parameters(&name, &pairs(&parameters)),
    })?;
    // A path is the same from another folder only if it is absolute.
    let model = match std::path::absolute(&model) {
        Ok(path) if !cylindroid::catalogue::names().contains(&name.as_str()) => {
            path.to_string_lossy().into_owned()
        }
        _ => name,
    };
    Ok(PyMechanism::new(inner, Origin::Model { model, parameters }))
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
/// parameters : dict of str to float, optional
///     Values of parameters of a mechanism file, as for `load`.
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
#[pyo3(signature = (text, format = "urdf", path = None, parameters = None))]
pub(crate) fn parse(
    py: Python<'_>,
    #[pyo3(from_py_with = argument)] text: &str,
    #[pyo3(from_py_with = argument)] format: &str,
    #[pyo3(from_py_with = argument)] path: Option<PathBuf>,
    #[pyo3(from_py_with = argument)] parameters: Option<Bound<'_, PyDict>>,
) -> Result<PyMechanism> {
    let parameters = parameter_values(parameters.as_ref())?;
    let path = path.unwrap_or_else(|| PathBuf::from("<text>"));
    type Reader = fn(&str, &Path) -> cylindroid::Result<Mechanism>;
    let readers: [(&str, Reader); 4] = [
        ("urdf", formats::urdf::parse),
        ("mjcf", formats::mjcf::parse),
        ("sdf", formats::sdf::parse),
        ("toml", cylindroid::load_text),
    ];
    let read = options::named("format", format, &readers)?;
    if !parameters.is_empty() && format != "toml" {
        let reason = "only mechanism files, format 'toml', have parameters";
        return Err(Failure::option("parameters", format, reason));
    }
    let inner = py.detach(|| match &parameters[..] {
        [] => read(text, &path),
        given => Ok(ParametricModel::of_text(text, &path, &pairs(given))?.nominal().clone()),
    })?;
    let (text, format) = (text.to_owned(), format.to_owned());
    Ok(PyMechanism::new(inner, Origin::Text { text, format, path, parameters }))
}

/// Values of parameters, in the order of the dictionary.
pub(crate) fn parameter_values(given: Option<&Bound<'_, PyDict>>) -> Result<Vec<(String, f64)>> {
    let values = given.into_iter().flat_map(|dict| dict.iter());
    values
        .map(|(name, value)| Ok((entry("parameters", &name)?, entry("parameters", &value)?)))
        .collect()
}

pub(crate) fn pairs(values: &[(String, f64)]) -> Vec<(&str, f64)> {
    values.iter().map(|(name, value)| (name.as_str(), *value)).collect()
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

impl From<&LoadReport> for PyLoadReport {
    fn from(report: &LoadReport) -> Self {
        let ignored = report.ignored.iter().map(|i| (i.line, i.what.clone(), i.why.clone()));
        Self { format: report.format, source: report.source.clone(), ignored: ignored.collect() }
    }
}

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
        PyLoadReport::from(self.inner.report())
    }
}
