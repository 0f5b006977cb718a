//! Twists and poses: exponential and logarithm with their derivatives, the Lie bracket, velocity
//! conversion.

use cylindroid::spatial::{self, Derivative6, Mat3};
use cylindroid::{Error, Matrix, Twist, Vec3, Wrench, kinematics};
use pyo3::prelude::*;

use crate::arrays::{self, Array, Numbers};
use crate::error::Result;
use crate::screws::finite_twist;

/// The exponential map: the displacement of a constant twist in one second.
///
/// Parameters
/// ----------
/// twist : array_like, (6,)
///     Linear part first [m, rad], in the axes and at the origin of frame a.
///
/// Returns
/// -------
/// ndarray, (4, 4)
///     The pose `a_from_b` (m).
///
/// Raises
/// ------
/// DimensionError, NotFiniteError
///
/// Examples
/// --------
/// A rotation by a quarter turn about the z axis through (1, 0, 0).
///
/// >>> import numpy as np
/// >>> import cylindroid as cy
/// >>> cy.exp(np.array([0, -1, 0, 0, 0, 1]) * np.pi / 2)[:3, 3].round(12)
/// array([ 1., -1.,  0.])
#[pyfunction]
#[pyo3(signature = (twist))]
pub(crate) fn exp<'py>(py: Python<'py>, twist: Numbers<'py>) -> Result<Array<'py>> {
    arrays::pose(py, spatial::exp(finite_twist(&twist, "twist")?))
}

/// The logarithm of a pose: the twist that produces the displacement in one second.
///
/// Parameters
/// ----------
/// pose : array_like, (4, 4)
///     `a_from_b` (m).
///
/// Returns
/// -------
/// ndarray, (6,)
///     Linear part first [m, rad], in the axes and at the origin of frame a; it rotates by at most
///     pi.
///
/// Raises
/// ------
/// InvalidOptionError
///     For a matrix that is not a pose.
/// NotFiniteError
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> import cylindroid as cy
/// >>> pose = np.eye(4)
/// >>> pose[:3, 3] = [1, 2, 3]
/// >>> cy.log(pose)
/// array([1., 2., 3., 0., 0., 0.])
#[pyfunction]
#[pyo3(signature = (pose))]
pub(crate) fn log<'py>(py: Python<'py>, pose: Numbers<'py>) -> Result<Array<'py>> {
    Ok(arrays::vector(py, &spatial::log(pose.pose("pose")?).to_array()))
}

/// The left derivative D of the exponential: `exp(x + dx) = exp(D @ dx) @ exp(x)` to first order.
///
/// Parameters
/// ----------
/// twist : array_like, (6,)
///     x, linear part first [m, rad].
///
/// Returns
/// -------
/// ndarray, (6, 6)
///     Linear part first, in the axes and at the origin of frame a of `exp(x)`.
///
/// Raises
/// ------
/// DimensionError, NotFiniteError
///
/// Notes
/// -----
/// Barfoot, State Estimation for Robotics, 2017, eqs. 7.85 and 7.86.
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> import cylindroid as cy
/// >>> bool((cy.exp_derivative(np.zeros(6)) == np.eye(6)).all())
/// True
#[pyfunction]
#[pyo3(signature = (twist))]
pub(crate) fn exp_derivative<'py>(py: Python<'py>, twist: Numbers<'py>) -> Result<Array<'py>> {
    derivative(py, &spatial::exp_derivative(finite_twist(&twist, "twist")?))
}

/// The derivative of the logarithm: the inverse of `exp_derivative`.
///
/// Parameters
/// ----------
/// twist : array_like, (6,)
///     x, linear part first [m, rad]; its rotation must be below 2 pi.
///
/// Returns
/// -------
/// ndarray, (6, 6)
///     The rate of `log` for a twist in the axes and at the origin of frame a of `exp(x)`.
///
/// Raises
/// ------
/// DimensionError, NotFiniteError
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> import cylindroid as cy
/// >>> x = [1.0, 0.5, -0.2, 0.3, -0.4, 0.5]
/// >>> np.allclose(cy.log_derivative(x) @ cy.exp_derivative(x), np.eye(6))
/// True
#[pyfunction]
#[pyo3(signature = (twist))]
pub(crate) fn log_derivative<'py>(py: Python<'py>, twist: Numbers<'py>) -> Result<Array<'py>> {
    derivative(py, &spatial::log_derivative(finite_twist(&twist, "twist")?))
}

/// The left derivative V of the rotation by a rotation vector: `d exp(w) = skew(V @ dw) @ exp(w)`.
///
/// Parameters
/// ----------
/// vector : array_like, (3,)
///     w: axis times angle (rad).
///
/// Returns
/// -------
/// ndarray, (3, 3)
///     Takes the rate of the rotation vector to the angular velocity, in the fixed axes.
///
/// Raises
/// ------
/// DimensionError, NotFiniteError
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> import cylindroid as cy
/// >>> cy.rotation_exp_derivative([0, 0, 1]) @ [0, 0, 1]
/// array([0., 0., 1.])
#[pyfunction]
#[pyo3(signature = (vector))]
pub(crate) fn rotation_exp_derivative<'py>(
    py: Python<'py>,
    vector: Numbers<'py>,
) -> Result<Array<'py>> {
    rotation(py, &vector, spatial::rotation_exp_derivative)
}

/// The inverse of `rotation_exp_derivative`: the rate of a rotation vector for an angular velocity.
///
/// Parameters
/// ----------
/// vector : array_like, (3,)
///     w: axis times angle (rad), below 2 pi.
///
/// Returns
/// -------
/// ndarray, (3, 3)
///
/// Raises
/// ------
/// DimensionError, NotFiniteError
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> import cylindroid as cy
/// >>> w = [0.3, -0.2, 0.5]
/// >>> np.allclose(cy.rotation_log_derivative(w) @ cy.rotation_exp_derivative(w), np.eye(3))
/// True
#[pyfunction]
#[pyo3(signature = (vector))]
pub(crate) fn rotation_log_derivative<'py>(
    py: Python<'py>,
    vector: Numbers<'py>,
) -> Result<Array<'py>> {
    rotation(py, &vector, spatial::rotation_log_derivative)
}

fn rotation<'py>(
    py: Python<'py>,
    vector: &Numbers<'py>,
    of: fn(Vec3) -> Mat3,
) -> Result<Array<'py>> {
    let vector = vector.entries::<3>("vector")?;
    Error::check_finite("vector", &vector)?;
    let rows = of(Vec3::from_array(vector)).to_rows();
    arrays::matrix(py, &Matrix::from_fn(3, 3, |i, j| rows[i][j]))
}

/// The error between two poses as a servo measures it: difference of positions, and rotation
/// vector.
///
/// Parameters
/// ----------
/// pose, target : array_like, (4, 4)
///     World from tool, as it is and as it should be (m).
///
/// Returns
/// -------
/// ndarray, (6,)
///     Linear part first, axes of the world [m, rad]. Unlike `screw_to`, the linear part is the
///     straight line from one origin to the other.
///
/// Raises
/// ------
/// InvalidOptionError, NotFiniteError
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> import cylindroid as cy
/// >>> target = np.eye(4)
/// >>> target[2, 3] = 0.5
/// >>> cy.error_to(np.eye(4), target)
/// array([0. , 0. , 0.5, 0. , 0. , 0. ])
#[pyfunction]
#[pyo3(signature = (pose, target))]
pub(crate) fn error_to<'py>(
    py: Python<'py>,
    pose: Numbers<'py>,
    target: Numbers<'py>,
) -> Result<Array<'py>> {
    let error = pose.pose("pose")?.error_to(target.pose("target")?);
    Ok(arrays::vector(py, &error.to_array()))
}

/// The coadjoint of a pose: transforms wrenches from frame b to frame a.
///
/// Parameters
/// ----------
/// a_from_b : array_like, (4, 4)
///     Pose of frame b in frame a (m).
///
/// Returns
/// -------
/// ndarray, (6, 6)
///     Force first; the inverse transpose of `adjoint(a_from_b)`.
///
/// Raises
/// ------
/// InvalidOptionError, NotFiniteError
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> import cylindroid as cy
/// >>> pose = cy.exp([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
/// >>> np.allclose(cy.coadjoint(pose).T @ cy.adjoint(pose), np.eye(6))
/// True
#[pyfunction]
#[pyo3(signature = (a_from_b))]
pub(crate) fn coadjoint<'py>(py: Python<'py>, a_from_b: Numbers<'py>) -> Result<Array<'py>> {
    let pose = a_from_b.pose("a_from_b")?;
    let unit = |i: usize| Wrench::from_array(std::array::from_fn(|k| f64::from(u8::from(k == i))));
    let columns: [[f64; 6]; 6] = std::array::from_fn(|j| pose.coadjoint(unit(j)).to_array());
    arrays::matrix(py, &Matrix::from_fn(6, 6, |i, j| columns[j][i]))
}

fn derivative<'py>(py: Python<'py>, d: &Derivative6) -> Result<Array<'py>> {
    let unit = |i: usize| Twist::from_array(std::array::from_fn(|k| f64::from(u8::from(k == i))));
    let columns: [[f64; 6]; 6] = std::array::from_fn(|j| d.apply(unit(j)).to_array());
    arrays::matrix(py, &Matrix::from_fn(6, 6, |i, j| columns[j][i]))
}

/// The Lie bracket `ad(a) @ b` of two twists: the rate of b, fixed in a body that moves with a.
///
/// Parameters
/// ----------
/// a, b : array_like, (6,)
///     Twists of one frame, linear part first [m/s, rad/s].
///
/// Returns
/// -------
/// ndarray, (6,)
///     `[w_a x v_b + v_a x w_b; w_a x w_b]`, in the same frame.
///
/// Raises
/// ------
/// DimensionError, NotFiniteError
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> cy.bracket([0, 0, 0, 0, 0, 1], [0, 0, 0, 1, 0, 0])
/// array([0., 0., 0., 0., 1., 0.])
#[pyfunction]
#[pyo3(signature = (a, b))]
pub(crate) fn bracket<'py>(
    py: Python<'py>,
    a: Numbers<'py>,
    b: Numbers<'py>,
) -> Result<Array<'py>> {
    let bracket = finite_twist(&a, "a")?.bracket(finite_twist(&b, "b")?);
    Ok(arrays::vector(py, &bracket.to_array()))
}

/// The velocity conversion matrix: takes the twist of a body in frame a to its twist in frame b,
/// both frames on the body.
///
/// Parameters
/// ----------
/// b_from_a : array_like, (4, 4)
///     Pose of frame a in frame b (m).
///
/// Returns
/// -------
/// ndarray, (6, 6)
///     Linear part first: `adjoint(b_from_a)`.
///
/// Raises
/// ------
/// InvalidOptionError, NotFiniteError
///
/// Examples
/// --------
/// The velocity of a point 1 m beside the axis of a rotation about z.
///
/// >>> import numpy as np
/// >>> import cylindroid as cy
/// >>> b_from_a = np.eye(4)
/// >>> b_from_a[0, 3] = -1.0
/// >>> cy.velocity_conversion(b_from_a) @ [0, 0, 0, 0, 0, 1]
/// array([0., 1., 0., 0., 0., 1.])
#[pyfunction]
#[pyo3(signature = (b_from_a))]
pub(crate) fn velocity_conversion<'py>(
    py: Python<'py>,
    b_from_a: Numbers<'py>,
) -> Result<Array<'py>> {
    arrays::matrix(py, &kinematics::velocity_conversion(b_from_a.pose("b_from_a")?))
}
