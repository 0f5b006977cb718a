//! Own columns of a sweep: functions of Python.

use std::sync::{Arc, Mutex, PoisonError};

use cylindroid::Mechanism;
use cylindroid::sweep::{ColumnFunction, OwnColumn};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyException;
use pyo3::prelude::*;

use crate::arrays::Numbers;
use crate::error::{Failure, Result};

/// Name, unit, version and function of a column.
pub(super) type Given = (String, String, String, Py<PyAny>);

/// The columns, and the first exception that one of their functions has raised since.
#[derive(Debug)]
pub(super) struct OwnColumns {
    given: Vec<Given>,
    raised: Arc<Mutex<Option<PyErr>>>,
}

impl OwnColumns {
    pub(super) fn new(given: Vec<Given>) -> Self {
        Self { given, raised: Arc::default() }
    }

    /// For the library, whose threads have no interpreter.
    pub(super) fn columns(&self, mechanism: &Mechanism) -> Vec<OwnColumn> {
        let names: Arc<[String]> = mechanism.coordinates().iter().map(|c| c.name.clone()).collect();
        let column = |(name, unit, version, function): &Given| {
            let (names, raised) = (Arc::clone(&names), Arc::clone(&self.raised));
            let function = Python::attach(|py| function.clone_ref(py));
            let call = move |q: &[f64]| {
                Python::attach(|py| called(function.bind(py), q, &names)).map_err(|error| {
                    let message = error.to_string();
                    raised.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
                    message
                })
            };
            OwnColumn {
                name: name.clone(),
                unit: unit.clone(),
                version: version.clone(),
                function: Arc::new(call) as ColumnFunction,
            }
        };
        self.given.iter().map(column).collect()
    }

    /// The result; an error that a function has raised is the cause of that of the library.
    pub(super) fn checked<T>(&self, py: Python<'_>, found: cylindroid::Result<T>) -> Result<T> {
        let raised = self.raised.lock().unwrap_or_else(PoisonError::into_inner).take();
        match (found, raised) {
            (Ok(found), _) => Ok(found),
            (Err(error), None) => Err(error.into()),
            // KeyboardInterrupt and others that are no errors.
            (Err(_), Some(raised)) if !raised.is_instance_of::<PyException>(py) => {
                Err(raised.into())
            }
            (Err(error), Some(raised)) => {
                let error = PyErr::from(Failure::from(error));
                error.set_cause(py, Some(raised));
                Err(error.into())
            }
        }
    }
}

/// The numbers that a function returns for a block of configurations.
fn called(function: &Bound<'_, PyAny>, q: &[f64], names: &[String]) -> PyResult<Vec<f64>> {
    let py = function.py();
    let rows = q.len() / names.len().max(1);
    let block = PyArray1::from_slice(py, q).reshape([rows, names.len()])?;
    let found: Numbers<'_> = function.call1((block, names.to_vec()))?.extract()?;
    match found.shape() {
        [_] => Ok(found.values().to_vec()),
        _ => {
            let shape = found.shape_text();
            Err(Failure::kind(format!("{shape}; one number for each row is needed, ({rows},)"))
                .into())
        }
    }
}
