//! Projectors for hybrid and shared control, and the adjoint.

use cylindroid::screws::{Along, Projector};
use cylindroid::{Error, Pose, Twist};
use pyo3::prelude::*;

use super::scale_of;
use crate::arrays::{self, Array, Numbers};
use crate::error::{Failure, Result};

/// The projector on the motions controlled in position, for hybrid and shared control.
///
/// Parameters
/// ----------
/// motions : array_like, (6, k)
///     Twists that span them, as columns, linear part first.
/// along : float or array_like, (6, 6 - k)
///     A pitch h [m/rad]: what is left out is h-reciprocal to all of them; or the twists that are
///     left out.
/// length, center, noise
///     As `ScrewSystem`.
///
/// Returns
/// -------
/// ndarray, (6, 6)
///     P on twists; `1 - P.T` on wrenches keeps those that do no work on the motions.
///
/// Raises
/// ------
/// InvalidOptionError
///     Where there is no such projector, with the reason.
/// DimensionError, NotFiniteError
#[pyfunction]
#[pyo3(signature = (motions, along, length = None, center = None, noise = None))]
pub(crate) fn projector<'py>(
    py: Python<'py>,
    motions: Numbers<'py>,
    along: Numbers<'py>,
    length: Option<f64>,
    center: Option<Numbers<'py>>,
    noise: Option<f64>,
) -> Result<Array<'py>> {
    let columns = |name: &'static str, of: &Numbers<'_>| -> Result<Vec<Twist>> {
        let m = of.matrix(name)?;
        Error::check_len("rows of the matrix of twists", 6, m.rows())?;
        Ok((0..m.cols()).map(|j| Twist::from_array(std::array::from_fn(|i| m[(i, j)]))).collect())
    };
    let motions = columns("motions", &motions)?;
    let twists = if along.shape().is_empty() { vec![] } else { columns("along", &along)? };
    let way = match (along.shape(), along.values()) {
        ([], [h]) => Along::Reciprocal { h: *h },
        _ => Along::Twists(&twists),
    };
    match Projector::of(&motions, way, &scale_of(length, center.as_ref(), noise)?)? {
        Ok(projector) => arrays::matrix(py, &projector.matrix()),
        Err(reason) => Err(Failure::option("along", "no projector", reason.to_string())),
    }
}

/// The adjoint of a pose: twists in frame b, seen from frame a; its inverse transpose moves
/// wrenches.
///
/// Parameters
/// ----------
/// a_from_b : array_like, (4, 4)
///
/// Returns
/// -------
/// ndarray, (6, 6)
///     Linear part first.
///
/// Raises
/// ------
/// InvalidOptionError, NotFiniteError
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> import cylindroid as cy
/// >>> bool((cy.adjoint(np.eye(4)) == np.eye(6)).all())
/// True
#[pyfunction]
#[pyo3(signature = (a_from_b))]
pub(crate) fn adjoint<'py>(py: Python<'py>, a_from_b: Numbers<'py>) -> Result<Array<'py>> {
    let pose: Pose = a_from_b.pose("a_from_b")?;
    let unit = |i: usize| Twist::from_array(std::array::from_fn(|k| f64::from(u8::from(k == i))));
    arrays::twists(py, &std::array::from_fn::<Twist, 6, _>(|j| pose.adjoint(unit(j))))
}
