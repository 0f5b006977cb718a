//! The class `Solution`: the result of inverse kinematics.

use cylindroid::ik::{FoundBy, Solution};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;

use crate::arrays::{self, Array, Many};
use crate::error::Result;
use crate::table::{self, Table};

/// The result of inverse kinematics; for several targets every attribute has a leading axis.
///
/// Attributes
/// ----------
/// success : bool or ndarray of bool, (N,)
///     True if the target is reached within tolerance, checked by forward kinematics.
/// q : ndarray, (n,) or (N, n)
///     The configuration, within the limits; without success the closest one found.
/// position_error, orientation_error : float or ndarray, (N,)
///     Largest of all goals, in the components of the task, and the distance outside of half-spaces
///     (m, rad).
/// analytic : bool or ndarray of bool, (N,)
///     True if the solution was computed in closed form.
/// iterations, restarts : int or ndarray of int, (N,)
/// out_of_reach : bool or ndarray of bool, (N,)
///     True if no solution exists: the target is farther from the first joint than the length of
///     the chain. Failure alone does not prove this.
/// criterion : float or None, or list of them
///     The value of what `maximise` or a task makes as large as possible; None without one.
/// reason : str or None, or list of them
///     Of a miss: begins with "out of reach" (proven), "collision" (with the two bodies),
///     "half-space" (with their names: there is a solution outside), "limits" (with the joints: there
///     is a solution outside their position limits) or "not proven".
#[pyclass(frozen, name = "Solution", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PySolution {
    pub(super) inner: Many<Solution>,
    pub(super) n: usize,
}

table::shown!(PySolution);

impl PySolution {
    fn table(&self) -> Table {
        let Many::One(s) = &self.inner else {
            let all = self.inner.as_slice();
            let mut table = Table::new(&format!("Solutions for {} targets", all.len()));
            table.row("reached", all.iter().filter(|s| s.success).count().to_string());
            return table;
        };
        let mut table = Table::new("Solution");
        table.row("success", if s.success { "yes" } else { "no" });
        if let Some((distance, length)) = s.out_of_reach {
            let (distance, length) = (table::number(distance), table::number(length));
            table.row("out of reach", format!("{distance} m away, the arm is {length} m long"));
        }
        if let Some(reason) = s.reason.as_ref().filter(|_| s.out_of_reach.is_none()) {
            table.row("reason", reason.to_string());
        }
        if let Some(value) = s.criterion {
            table.row("criterion", table::number(value));
        }
        let errors = format!("{:.1e} m, {:.1e} rad", s.position_error, s.orientation_error);
        table.row("errors", errors);
        table.row("found by", s.found_by.name());
        table.row("iterations", format!("{} in {} restarts", s.iterations, s.restarts));
        table.row("q", table::list(&s.q));
        table
    }
}

#[pymethods]
impl PySolution {
    #[getter]
    fn success<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        arrays::each(py, &self.inner, |s| s.success)
    }

    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        let all = self.inner.as_slice().iter().map(|s| &s.q);
        arrays::rows(py, self.inner.count(), self.n, all)
    }

    #[getter]
    fn position_error<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        arrays::each(py, &self.inner, |s| s.position_error)
    }

    #[getter]
    fn orientation_error<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        arrays::each(py, &self.inner, |s| s.orientation_error)
    }

    #[getter]
    fn analytic<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        arrays::each(py, &self.inner, |s| s.found_by == FoundBy::Analytic)
    }

    #[getter]
    fn iterations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        arrays::each(py, &self.inner, |s| s.iterations as i64)
    }

    #[getter]
    fn restarts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        arrays::each(py, &self.inner, |s| s.restarts as i64)
    }

    #[getter]
    fn out_of_reach<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        arrays::each(py, &self.inner, |s| s.out_of_reach.is_some())
    }

    #[getter]
    fn criterion<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        match &self.inner {
            Many::One(s) => s.criterion.into_bound_py_any(py),
            Many::All(all) => {
                all.iter().map(|s| s.criterion).collect::<Vec<_>>().into_bound_py_any(py)
            }
        }
    }

    #[getter]
    fn reason<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let words = |s: &Solution| s.reason.as_ref().map(ToString::to_string);
        match &self.inner {
            Many::One(s) => words(s).into_bound_py_any(py),
            Many::All(all) => all.iter().map(words).collect::<Vec<_>>().into_bound_py_any(py),
        }
    }
}
