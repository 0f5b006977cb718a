//! Projectors for hybrid and shared control, the twist between poses, and the adjoint.

use cylindroid::screws::{Complement, Projector};
use cylindroid::{Error, Pose, Twist};
use pyo3::prelude::*;

use super::scale_of;
use crate::arrays::{self, Array, Numbers};
use crate::error::{Failure, Result, argument};
use crate::table;

/// A projector onto a subspace of twists along a complement, independent of frame and units.
///
/// Parameters
/// ----------
/// motions : array_like, (6, k)
///     Twists that span the subspace, as columns, linear part first.
/// along : float or array_like, (6, 6 - k)
///     The complement: a pitch h [m/rad] (infinite for the limit) for the twists h-reciprocal to
///     all motions, or twists that span it, as columns.
/// length, center, noise : optional
///     As for `ScrewSystem`.
///
/// Attributes
/// ----------
/// matrix : ndarray, (6, 6)
///     P for twists.
/// constraint_matrix : ndarray, (6, 6)
///     `1 - P.T`, the matrix of `constraint` for wrenches, force first.
/// norm : float
///     The largest factor by which a twist is enlarged: 1 for an orthogonal projector, large if
///     subspace and complement nearly intersect.
///
/// Raises
/// ------
/// InvalidOptionError
///     If the projector does not exist, with the reason.
/// DimensionError, NotFiniteError
///
/// Notes
/// -----
/// Donelan and Selig, Hyperbolic pseudoinverses for kinematics in the Euclidean group, section 6.3.
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> import cylindroid as cy
/// >>> plane = cy.Projector(np.eye(6)[:, [0, 1, 3, 4, 5]], np.inf)
/// >>> plane.motion([1, 2, 3, 4, 5, 6]).round(9)
/// array([1., 2., 0., 4., 5., 6.])
/// >>> plane.constraint([1, 2, 3, 4, 5, 6]).round(9) + 0.0
/// array([0., 0., 3., 0., 0., 0.])
#[pyclass(frozen, name = "Projector", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyProjector {
    pub(crate) inner: Projector,
}

#[pymethods]
impl PyProjector {
    #[new]
    #[pyo3(signature = (motions, along, length = None, center = None, noise = None))]
    fn new(
        motions: Numbers<'_>,
        along: Numbers<'_>,
        #[pyo3(from_py_with = argument)] length: Option<f64>,
        center: Option<Numbers<'_>>,
        #[pyo3(from_py_with = argument)] noise: Option<f64>,
    ) -> Result<Self> {
        let columns = |name: &'static str, of: &Numbers<'_>| -> Result<Vec<Twist>> {
            let m = of.twist_columns(name)?;
            let twist = |j: usize| Twist::from_array(std::array::from_fn(|i| m[(i, j)]));
            Ok((0..m.cols()).map(twist).collect())
        };
        let motions = columns("motions", &motions)?;
        let twists = if along.shape().is_empty() { vec![] } else { columns("along", &along)? };
        let is_pitch = along.shape().is_empty();
        if along.values().iter().any(|x| x.is_nan() || !(is_pitch || x.is_finite())) {
            Error::check_finite("along", along.values())?;
        }
        let way = match (along.shape(), along.values()) {
            ([], [h]) => Complement::Reciprocal { h: *h },
            _ => Complement::Twists(&twists),
        };
        match Projector::of(&motions, way, &scale_of(length, center.as_ref(), noise)?)? {
            Ok(inner) => Ok(Self { inner }),
            Err(reason) => Err(Failure::option("along", "no projector", reason.to_string())),
        }
    }

    #[getter]
    fn matrix<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::matrix(py, &self.inner.matrix())
    }

    #[getter]
    fn constraint_matrix<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::matrix(py, &self.inner.constraint_matrix())
    }

    #[getter]
    fn norm(&self) -> f64 {
        self.inner.norm()
    }

    /// The part of a twist that is one of the motions.
    ///
    /// Parameters
    /// ----------
    /// twist : array_like, (6,)
    ///
    /// Returns
    /// -------
    /// ndarray, (6,)
    ///
    /// Raises
    /// ------
    /// DimensionError
    #[pyo3(signature = (twist))]
    fn motion<'py>(&self, py: Python<'py>, twist: Numbers<'py>) -> Result<Array<'py>> {
        Ok(arrays::vector(py, &self.inner.motion(twist.twist("twist")?).to_array()))
    }

    /// The discarded component of a twist, in the complement.
    ///
    /// Parameters
    /// ----------
    /// twist : array_like, (6,)
    ///
    /// Returns
    /// -------
    /// ndarray, (6,)
    ///
    /// Raises
    /// ------
    /// DimensionError
    #[pyo3(signature = (twist))]
    fn rest<'py>(&self, py: Python<'py>, twist: Numbers<'py>) -> Result<Array<'py>> {
        Ok(arrays::vector(py, &self.inner.rest(twist.twist("twist")?).to_array()))
    }

    /// The part of a wrench that does no work on the motions.
    ///
    /// Parameters
    /// ----------
    /// wrench : array_like, (6,)
    ///     Force first.
    ///
    /// Returns
    /// -------
    /// ndarray, (6,)
    ///
    /// Raises
    /// ------
    /// DimensionError
    #[pyo3(signature = (wrench))]
    fn constraint<'py>(&self, py: Python<'py>, wrench: Numbers<'py>) -> Result<Array<'py>> {
        Ok(arrays::vector(py, &self.inner.constraint(wrench.wrench("wrench")?).to_array()))
    }

    fn __repr__(&self) -> String {
        format!("<Projector of norm {}>", table::number(self.inner.norm()))
    }
}

/// The matrix of a `Projector`.
///
/// Parameters
/// ----------
/// motions, along, length, center, noise
///     As `Projector`.
///
/// Returns
/// -------
/// ndarray, (6, 6)
///
/// Raises
/// ------
/// InvalidOptionError
///     If the projector does not exist, with the reason.
/// DimensionError, NotFiniteError
#[pyfunction]
#[pyo3(signature = (motions, along, length = None, center = None, noise = None))]
pub(crate) fn projector<'py>(
    py: Python<'py>,
    motions: Numbers<'py>,
    along: Numbers<'py>,
    #[pyo3(from_py_with = argument)] length: Option<f64>,
    center: Option<Numbers<'py>>,
    #[pyo3(from_py_with = argument)] noise: Option<f64>,
) -> Result<Array<'py>> {
    PyProjector::new(motions, along, length, center, noise)?.matrix(py)
}

/// The twist that moves one pose to another in one second: the error of a tool.
///
/// Parameters
/// ----------
/// pose, target : array_like, (4, 4)
///     World from tool, as it is and as it should be (m).
///
/// Returns
/// -------
/// ndarray, (6,)
///     Linear part first, axes of the world, at the origin of `pose` [m, rad]: the motion of a
///     body, the same whichever point of it the poses are of.
///
/// Raises
/// ------
/// InvalidOptionError, NotFiniteError
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> import cylindroid as cy
/// >>> start, end = np.eye(4), np.eye(4)
/// >>> end[2, 3] = 0.5
/// >>> cy.screw_to(start, end)
/// array([0. , 0. , 0.5, 0. , 0. , 0. ])
#[pyfunction]
#[pyo3(signature = (pose, target))]
pub(crate) fn screw_to<'py>(
    py: Python<'py>,
    pose: Numbers<'py>,
    target: Numbers<'py>,
) -> Result<Array<'py>> {
    let twist = pose.pose("pose")?.screw_to(target.pose("target")?);
    Ok(arrays::vector(py, &twist.to_array()))
}

/// The adjoint of a pose: transforms twists from frame b to frame a; its inverse transpose does so
/// for wrenches.
///
/// Parameters
/// ----------
/// a_from_b : array_like, (4, 4)
///     Pose of frame b in frame a (m).
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
