//! Conversion of results to Python: one object, or a list of objects for many configurations.

use pyo3::prelude::*;
use pyo3::types::PyList;
use pyo3::{PyClass, PyClassInitializer};

use crate::arrays::Many;

/// The Python object of one result, or a list of them for many configurations.
pub(super) fn object<'py, T>(py: Python<'py>, many: Many<T>) -> PyResult<Bound<'py, PyAny>>
where
    T: PyClass + Into<PyClassInitializer<T>>,
{
    Ok(match many {
        Many::One(one) => Bound::new(py, one)?.into_any(),
        Many::All(all) => {
            let list = PyList::empty(py);
            for one in all {
                list.append(Bound::new(py, one)?)?;
            }
            list.into_any()
        }
    })
}
