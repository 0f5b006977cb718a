//! The class `Inverse`: an inverse and what was done to get it.

use cylindroid::Matrix;
use cylindroid::inverse::{self, Inverse};
use pyo3::prelude::*;

use crate::arrays::{self, Array, Many};
use crate::error::Result;
use crate::table::{self, Table};

/// An inverse and what was done to get it; of a stack of Jacobians everything has its axis first.
///
/// Attributes
/// ----------
/// matrix : ndarray, (n, m) or (N, n, m)
///     The inverse: rates = matrix @ task. NaN where none exists.
/// rank : int or ndarray of int, (N,)
///     Directions of which at least one half is realised.
/// singular_values : ndarray, (k,) or (N, k)
///     Of the (weighted) Jacobian, largest first.
/// threshold : float or ndarray, (N,)
///     The singular value below which a direction counts as dropped.
/// gap : float or ndarray, (N,)
///     Smallest singular value kept over the largest dropped: near 1 the rank is a matter of taste.
/// dropped : list of Dropped, or list of such lists
///     The directions that the inverse gives up.
/// exists : bool or ndarray of bool, (N,)
///     False where the method has no inverse for this Jacobian.
/// reason : str or None, or list of them
///     Why there is none.
#[pyclass(frozen, name = "Inverse", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyInverse {
    pub(super) inner: Many<Inverse>,
    /// Rows and columns of the Jacobian.
    pub(super) shape: (usize, usize),
}

/// A task direction that an inverse gives up, wholly or by more than half.
///
/// Attributes
/// ----------
/// singular_value : float
/// direction : ndarray, (m,)
///     Unit vector in the (weighted) task space.
/// realised : float
///     The share of a motion along it that is realised, in [0, 1/2).
#[pyclass(frozen, name = "Dropped", module = "cylindroid")]
#[derive(Debug, Clone)]
pub(crate) struct PyDropped {
    #[pyo3(get)]
    singular_value: f64,
    direction: Vec<f64>,
    #[pyo3(get)]
    realised: f64,
}

#[pymethods]
impl PyDropped {
    #[getter]
    fn direction<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.direction)
    }

    fn __repr__(&self) -> String {
        format!(
            "Dropped(singular_value={}, realised={}, direction={})",
            table::number(self.singular_value),
            table::number(self.realised),
            table::list(&self.direction)
        )
    }
}

fn dropped(inverse: &Inverse) -> Vec<PyDropped> {
    let one = |d: &inverse::Dropped| PyDropped {
        singular_value: d.singular_value,
        direction: d.direction.clone(),
        realised: d.realised,
    };
    inverse.dropped.iter().map(one).collect()
}

fn reason(inverse: &Inverse) -> Option<String> {
    inverse.reason.map(|r| r.to_string())
}

#[pymethods]
impl PyInverse {
    #[getter]
    fn matrix<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        let (m, n) = self.shape;
        arrays::written(py, self.inner.count(), &[n, m], |out| {
            for (inverse, out) in
                self.inner.as_slice().iter().zip(out.chunks_exact_mut((n * m).max(1)))
            {
                arrays::put_rows(&inverse.matrix, out);
            }
        })
    }

    #[getter]
    fn rank<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        arrays::each(py, &self.inner, |i| i.rank as i64)
    }

    #[getter]
    fn singular_values<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        let k = match self.inner.as_slice().first() {
            Some(first) => first.singular_values.len(),
            None => self.shape.0.min(self.shape.1),
        };
        let all = self.inner.as_slice().iter().map(|i| &i.singular_values);
        arrays::rows(py, self.inner.count(), k, all)
    }

    #[getter]
    fn threshold<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        arrays::each(py, &self.inner, |i| i.threshold)
    }

    #[getter]
    fn gap<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        arrays::each(py, &self.inner, |i| i.gap)
    }

    #[getter]
    fn dropped<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        match &self.inner {
            Many::One(inverse) => dropped(inverse).into_pyobject(py),
            Many::All(all) => all.iter().map(dropped).collect::<Vec<_>>().into_pyobject(py),
        }
    }

    #[getter]
    fn exists<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        arrays::each(py, &self.inner, |i| i.exists)
    }

    #[getter]
    fn reason<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        match &self.inner {
            Many::One(inverse) => Ok(reason(inverse).into_pyobject(py)?),
            Many::All(all) => all.iter().map(reason).collect::<Vec<_>>().into_pyobject(py),
        }
    }
}

table::shown!(PyInverse);

impl PyInverse {
    pub(super) fn new(j: &Many<Matrix>, inner: Many<Inverse>, stacked: (usize, usize)) -> Self {
        let shape = j.as_slice().first().map_or(stacked, |m| (m.rows(), m.cols()));
        Self { inner, shape }
    }

    fn table(&self) -> Table {
        let (m, n) = self.shape;
        let Many::One(inverse) = &self.inner else {
            let count = self.inner.count().unwrap_or(0);
            let mut table = Table::new(&format!("Inverses of {count} Jacobians of {m} x {n}"));
            let none = self.inner.as_slice().iter().filter(|i| !i.exists).count();
            table.row("without inverse", none.to_string());
            return table;
        };
        let mut table = Table::new(&format!("Inverse of a Jacobian of {m} x {n}"));
        table.row("exists", if inverse.exists { "yes" } else { "no" });
        if let Some(reason) = inverse.reason {
            table.row("reason", reason.to_string());
        }
        table.row("rank", inverse.rank.to_string());
        table.row("singular values", table::list(&inverse.singular_values));
        table.row("threshold", table::number(inverse.threshold));
        for d in &inverse.dropped {
            table.row("dropped", d_text(d));
        }
        table
    }
}

fn d_text(d: &inverse::Dropped) -> String {
    format!("{} (realised {})", table::list(&d.direction), table::number(d.realised))
}
