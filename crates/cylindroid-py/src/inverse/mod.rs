//! Inverses of Jacobians, one or a stack of them, each with its report.

pub(crate) mod by_name;
pub(crate) mod damped;
pub(crate) mod hyperbolic;
pub(crate) mod hyperbolic_svd;
mod of_mechanism;
pub(crate) mod pinv;
pub(crate) mod point_direction;
mod report;

use cylindroid::inverse::{Inverse, InverseBatch};
use cylindroid::{Matrix, Method};
use pyo3::prelude::*;

use crate::arrays::{Many, Numbers, entries_of};
use crate::error::Result;
use crate::threads;

pub(crate) use by_name::parameters_of;
pub(crate) use point_direction::PyPointDirection;
pub(crate) use report::{PyInverse, PyTruncatedDirection};

/// The inverse of each matrix by a method.
fn by_method(py: Python<'_>, j: &Numbers<'_>, method: Method) -> Result<PyInverse> {
    let &[_, m, n] = j.shape() else { return of_each(py, j, |j| method.inverse(j)) };
    if m == 0 || n == 0 {
        return of_each(py, j, |j| method.inverse(j));
    }
    let batch = InverseBatch::new(method, m, n)?;
    let jacobians = j.values();
    let is_long = jacobians.len() > InverseBatch::CHUNK * m * n;
    let inverses = threads::run(py, is_long, || batch.inverses(jacobians))?
        .map_err(|error| entries_of("J", error))?;
    Ok(PyInverse::of_stack(method, jacobians.to_vec(), (m, n), inverses))
}

/// The inverse of each matrix by `f`.
fn of_each(
    py: Python<'_>,
    j: &Numbers<'_>,
    f: impl Fn(&Matrix) -> cylindroid::Result<Inverse> + Send,
) -> Result<PyInverse> {
    let matrices = j.matrices("J")?;
    let inner = match &matrices {
        Many::One(one) => f(one).map(Many::One),
        Many::All(_) => py.detach(|| matrices.try_map(f)),
    }
    .map_err(|error| entries_of("J", error))?;
    let stacked = match *j.shape() {
        [.., m, n] => (m, n),
        _ => (0, 0),
    };
    Ok(PyInverse::new(&matrices, inner, stacked))
}
