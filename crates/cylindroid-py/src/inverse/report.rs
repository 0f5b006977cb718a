//! The class `Inverse`: the inverse of a Jacobian and its report.

use cylindroid::inverse::{self, Inverse, Inverses};
use cylindroid::linalg::Rank;
use cylindroid::{Matrix, Method};
use numpy::{Element, IntoPyArray};
use pyo3::prelude::*;

use crate::arrays::{self, Array, Many};
use crate::error::Result;
use crate::table::{self, Table};

/// The inverse of a Jacobian and its report (rank, singular values, truncated directions). For a
/// stack of Jacobians, every attribute has the axis of the stack first.
///
/// Attributes
/// ----------
/// matrix : ndarray, (n, m) or (N, n, m)
///     The inverse: qd = matrix @ task. NaN if it does not exist.
/// rank : int or ndarray of int, (N,)
///     Directions of which at least one half is realised.
/// singular_values : ndarray, (k,) or (N, k)
///     Singular values of the (weighted) Jacobian, largest first.
/// threshold : float or ndarray, (N,)
///     The singular value below which a direction counts as dropped.
/// gap : float or ndarray, (N,)
///     Smallest singular value kept over the largest dropped: near 1 the rank is ambiguous.
/// dropped : list of TruncatedDirection, or list of such lists
///     The truncated directions.
/// exists : bool or ndarray of bool, (N,)
///     False if the inverse does not exist for this Jacobian.
/// reason : str or None, or list of them
///     The reason why it does not exist.
#[pyclass(frozen, name = "Inverse", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyInverse {
    inner: Inner,
    /// Rows and columns of the Jacobian.
    shape: (usize, usize),
}

#[derive(Debug)]
enum Inner {
    Reports(Many<Inverse>),
    /// Numbers of a stack; the directions that were dropped are found when they are asked for.
    Stack {
        method: Method,
        jacobians: Vec<f64>,
        inverses: Inverses,
    },
}

/// A task direction that an inverse gives up, wholly or by more than half.
///
/// Attributes
/// ----------
/// singular_value : float
/// direction : ndarray, (m,)
///     Unit vector in the (weighted) task space.
/// filter_factor : float
///     The share of a motion along it that is realised, in [0, 1/2).
#[pyclass(frozen, name = "TruncatedDirection", module = "cylindroid")]
#[derive(Debug, Clone)]
pub(crate) struct PyTruncatedDirection {
    #[pyo3(get)]
    singular_value: f64,
    direction: Vec<f64>,
    #[pyo3(get)]
    filter_factor: f64,
}

#[pymethods]
impl PyTruncatedDirection {
    #[getter]
    fn direction<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.direction)
    }

    fn __repr__(&self) -> String {
        format!(
            "TruncatedDirection(singular_value={}, filter_factor={}, direction={})",
            table::number(self.singular_value),
            table::number(self.filter_factor),
            table::list(&self.direction)
        )
    }
}

/// Of the i-th of a stack.
fn stacked_dropped(
    method: &Method,
    jacobians: &[f64],
    (m, n): (usize, usize),
    (i, rank): (usize, &Rank),
) -> Result<Vec<PyTruncatedDirection>> {
    if rank.rank == m.min(n) {
        return Ok(Vec::new());
    }
    let j = arrays::matrix_of(&jacobians[i * m * n..][..m * n], m, n);
    Ok(dropped(&method.inverse(&j)?))
}

fn dropped(inverse: &Inverse) -> Vec<PyTruncatedDirection> {
    let one = |d: &inverse::TruncatedDirection| PyTruncatedDirection {
        singular_value: d.singular_value,
        direction: d.direction.clone(),
        filter_factor: d.filter_factor,
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
        arrays::written(py, self.count(), &[n, m], |out| match &self.inner {
            Inner::Reports(all) => {
                for (inverse, out) in
                    all.as_slice().iter().zip(out.chunks_exact_mut((n * m).max(1)))
                {
                    arrays::put_rows(&inverse.matrix, out);
                }
            }
            Inner::Stack { inverses, .. } => out.copy_from_slice(&inverses.matrices),
        })
    }

    #[getter]
    fn rank<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.each(py, |i| i.rank as i64, |r| r.rank as i64)
    }

    #[getter]
    fn singular_values<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        let k = self.shape.0.min(self.shape.1);
        match &self.inner {
            Inner::Reports(all) => {
                let k = all.as_slice().first().map_or(k, |first| first.singular_values.len());
                let values = all.as_slice().iter().map(|i| &i.singular_values);
                arrays::rows(py, all.count(), k, values)
            }
            Inner::Stack { inverses, .. } => arrays::written(py, self.count(), &[k], |out| {
                out.copy_from_slice(&inverses.singular_values);
            }),
        }
    }

    #[getter]
    fn threshold<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.each(py, |i| i.threshold, |r| r.threshold)
    }

    #[getter]
    fn gap<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.each(py, |i| i.gap, |r| r.gap)
    }

    #[getter]
    fn dropped<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyAny>> {
        Ok(match &self.inner {
            Inner::Reports(Many::One(inverse)) => dropped(inverse).into_pyobject(py)?,
            Inner::Reports(Many::All(all)) => {
                all.iter().map(dropped).collect::<Vec<_>>().into_pyobject(py)?
            }
            Inner::Stack { method, jacobians, inverses } => {
                let each = inverses.ranks.iter().enumerate();
                let all = each.map(|rank| stacked_dropped(method, jacobians, self.shape, rank));
                all.collect::<Result<Vec<_>>>()?.into_pyobject(py)?
            }
        })
    }

    #[getter]
    fn exists<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.each(py, |i| i.exists, |_| true)
    }

    #[getter]
    fn reason<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        match &self.inner {
            Inner::Reports(Many::One(inverse)) => Ok(reason(inverse).into_pyobject(py)?),
            Inner::Reports(Many::All(all)) => {
                all.iter().map(reason).collect::<Vec<_>>().into_pyobject(py)
            }
            Inner::Stack { inverses, .. } => {
                vec![None::<String>; inverses.ranks.len()].into_pyobject(py)
            }
        }
    }
}

table::shown!(PyInverse);

impl PyInverse {
    pub(super) fn new(j: &Many<Matrix>, inner: Many<Inverse>, stacked: (usize, usize)) -> Self {
        let shape = j.as_slice().first().map_or(stacked, |m| (m.rows(), m.cols()));
        Self { inner: Inner::Reports(inner), shape }
    }

    pub(super) fn of_stack(
        method: Method,
        jacobians: Vec<f64>,
        shape: (usize, usize),
        inverses: Inverses,
    ) -> Self {
        Self { inner: Inner::Stack { method, jacobians, inverses }, shape }
    }

    /// Of a stack.
    fn count(&self) -> Option<usize> {
        match &self.inner {
            Inner::Reports(all) => all.count(),
            Inner::Stack { inverses, .. } => Some(inverses.ranks.len()),
        }
    }

    fn each<'py, X: Element + IntoPyObject<'py>>(
        &self,
        py: Python<'py>,
        report: impl Fn(&Inverse) -> X,
        rank: impl Fn(&Rank) -> X,
    ) -> PyResult<Bound<'py, PyAny>> {
        match &self.inner {
            Inner::Reports(all) => arrays::each(py, all, report),
            Inner::Stack { inverses, .. } => {
                let all = inverses.ranks.iter().map(rank).collect::<Vec<X>>();
                Ok(all.into_pyarray(py).into_any())
            }
        }
    }

    fn table(&self) -> Table {
        let (m, n) = self.shape;
        let Inner::Reports(Many::One(inverse)) = &self.inner else {
            let count = self.count().unwrap_or(0);
            let mut table = Table::new(&format!("Inverses of {count} Jacobians of {m} x {n}"));
            let none = match &self.inner {
                Inner::Reports(all) => all.as_slice().iter().filter(|i| !i.exists).count(),
                Inner::Stack { .. } => 0,
            };
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

fn d_text(d: &inverse::TruncatedDirection) -> String {
    format!("{} (filter factor {})", table::list(&d.direction), table::number(d.filter_factor))
}
