//! Inverses of Jacobians, one or a stack of them, each with its report.

pub(crate) mod by_name;
pub(crate) mod damped;
pub(crate) mod hyperbolic;
pub(crate) mod pinv;
pub(crate) mod point_direction;
mod report;

use cylindroid::Matrix;
use cylindroid::inverse::Inverse;
use pyo3::prelude::*;

use crate::arrays::{Many, Numbers};
use crate::error::Result;

pub(crate) use by_name::MethodNumbers;
pub(crate) use point_direction::PyPointDirection;
pub(crate) use report::{PyDropped, PyInverse};

/// The inverse of each matrix by `f`.
fn of_each(
    py: Python<'_>,
    j: &Numbers<'_>,
    f: impl Fn(&Matrix) -> cylindroid::Result<Inverse> + Send,
) -> Result<PyInverse> {
    let matrices = j.matrices("J")?;
    let inner = match &matrices {
        Many::One(one) => Many::One(f(one)?),
        Many::All(_) => py.detach(|| matrices.try_map(f))?,
    };
    let stacked = match *j.shape() {
        [.., m, n] => (m, n),
        _ => (0, 0),
    };
    Ok(PyInverse::new(&matrices, inner, stacked))
}
