//! The class `Parameter`.

use cylindroid::ParametricModel;
use pyo3::prelude::*;

use super::load::pairs;
use super::{Origin, PyMechanism};
use crate::error::{Failure, Result};

/// A parameter of a mechanism file.
///
/// Attributes
/// ----------
/// name : str
/// value : float
///     That of the mechanism, in the unit of the file.
/// lower, upper : float
///     Its range; infinite if the file has none.
/// unit, description : str
///     As the file has them; may be empty.
/// expression : str
///     Of other parameters, from which the value follows; empty for a number.
#[pyclass(frozen, get_all, name = "Parameter", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyParameter {
    name: String,
    value: f64,
    lower: f64,
    upper: f64,
    unit: String,
    description: String,
    expression: String,
}

#[pymethods]
impl PyParameter {
    fn __repr__(&self) -> String {
        format!("Parameter({} = {} {})", self.name, self.value, self.unit).replace(" )", ")")
    }
}

#[pymethods]
impl PyMechanism {
    #[getter]
    fn parameters(&self) -> Vec<PyParameter> {
        let all = self.inner.parameters().iter();
        all.map(|p| PyParameter {
            name: p.name.clone(),
            value: p.value,
            lower: p.lower,
            upper: p.upper,
            unit: p.unit.clone(),
            description: p.description.clone(),
            expression: p.expression.clone(),
        })
        .collect()
    }
}

impl PyMechanism {
    /// The file of the mechanism, for other values of its parameters.
    pub(crate) fn parametric(&self) -> Result<ParametricModel> {
        match &self.origin {
            Origin::Model { model, parameters } => {
                Ok(ParametricModel::read(model, &pairs(parameters))?)
            }
            Origin::Text { text, format, path, parameters } if format == "toml" => {
                Ok(ParametricModel::of_text(text, path, &pairs(parameters))?)
            }
            _ => {
                let reason = "it has no parameters: it is of another format, or its limits or \
                              actuators were changed after loading; write them into its file";
                Err(Failure::option("mechanism", self.inner.name(), reason))
            }
        }
    }
}
