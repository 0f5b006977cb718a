//! Limits of the coordinates.

use pyo3::prelude::*;

use super::PyMechanism;
use crate::arrays::{self, Array, Numbers};
use crate::error::Result;

impl PyMechanism {
    fn limits<'py>(
        &self,
        py: Python<'py>,
        of: impl Fn(&cylindroid::model::Limits) -> f64,
    ) -> Array<'py> {
        let all: Vec<f64> = self.inner.coordinates().iter().map(|c| of(&c.limits)).collect();
        arrays::vector(py, &all)
    }
}

#[pymethods]
impl PyMechanism {
    #[getter]
    fn lower<'py>(&self, py: Python<'py>) -> Array<'py> {
        self.limits(py, |l| l.lower)
    }

    #[getter]
    fn upper<'py>(&self, py: Python<'py>) -> Array<'py> {
        self.limits(py, |l| l.upper)
    }

    #[getter]
    fn velocity_limit<'py>(&self, py: Python<'py>) -> Array<'py> {
        self.limits(py, |l| l.velocity)
    }

    #[getter]
    fn acceleration_limit<'py>(&self, py: Python<'py>) -> Array<'py> {
        self.limits(py, |l| l.acceleration)
    }

    #[getter]
    fn effort_limit<'py>(&self, py: Python<'py>) -> Array<'py> {
        self.limits(py, |l| l.effort)
    }

    /// The names of coordinates outside their position limits.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,)
    ///
    /// Returns
    /// -------
    /// list of str
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError
    #[pyo3(signature = (q))]
    fn outside_limits(&self, q: Numbers<'_>) -> Result<Vec<&str>> {
        let q = q.vector("q")?;
        self.inner.check_q("q", q)?;
        let outside = self.inner.outside_limits(q);
        Ok(outside.map(|i| self.inner.coordinates()[i].name.as_str()).collect())
    }
}
