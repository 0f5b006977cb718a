//! The invariant forms of twists and wrenches, and Gram matrices.

use cylindroid::screws::{gram as gram_of, gram_determinant as determinant_of};
use cylindroid::{Error, Matrix, Twist, Wrench};
use pyo3::prelude::*;

use super::pitch::check_pitch;
use crate::arrays::{self, Array, Numbers};
use crate::error::{Result, argument};

/// A twist whose entries are finite.
pub(crate) fn finite_twist(of: &Numbers<'_>, name: &'static str) -> Result<Twist> {
    let twist = of.twist(name)?;
    Error::check_finite(name, &twist.to_array())?;
    Ok(twist)
}

fn finite_wrench(of: &Numbers<'_>, name: &'static str) -> Result<Wrench> {
    let wrench = of.wrench(name)?;
    Error::check_finite(name, &wrench.to_array())?;
    Ok(wrench)
}

fn finite_columns(of: &Numbers<'_>) -> Result<Matrix> {
    let j = of.twist_columns("J")?;
    Ok(j)
}

/// The invariant form of pitch h of two twists, `<a, b>_h = a.T @ Q_h @ b`.
///
/// Parameters
/// ----------
/// a, b : array_like, (6,)
///     Twists of one frame, linear part first [m/s, rad/s].
/// h : float
///     Pitch [m/rad], or infinite for the form at infinity.
///
/// Returns
/// -------
/// float
///     `(v_a . w_b + w_a . v_b) / 2 - h w_a . w_b` [m rad/s^2]; for an infinite pitch
///     `-w_a . w_b` [rad^2/s^2]. The same in every frame; zero for a twist of pitch h with itself.
///
/// Raises
/// ------
/// DimensionError, NotFiniteError
///
/// Notes
/// -----
/// Donelan and Selig, Hyperbolic pseudoinverses for kinematics in the Euclidean group, section 2.1.
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> screw = [0, 0, 0.5, 0, 0, 1]
/// >>> cy.pitch_form(screw, screw, 0.5), cy.pitch_form(screw, screw, 0.25)
/// (0.0, 0.25)
#[pyfunction]
#[pyo3(signature = (a, b, h))]
pub(crate) fn pitch_form(
    a: Numbers<'_>,
    b: Numbers<'_>,
    #[pyo3(from_py_with = argument)] h: f64,
) -> Result<f64> {
    check_pitch(h)?;
    Ok(finite_twist(&a, "a")?.pitch_form(finite_twist(&b, "b")?, h))
}

/// The inverse of the form of pitch h, on two wrenches.
///
/// Parameters
/// ----------
/// a, b : array_like, (6,)
///     Wrenches of one frame, force first (N, N m).
/// h : float
///     Pitch [m/rad], or infinite for the limit.
///
/// Returns
/// -------
/// float
///     `2 (f_a . m_b + m_a . f_b) + 4 h f_a . f_b` [N^2 m]; for an infinite pitch `f_a . f_b`
///     [N^2].
///
/// Raises
/// ------
/// DimensionError, NotFiniteError
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> wrench = [0, 0, 1, 0, 0, -0.5]
/// >>> cy.wrench_pitch_form(wrench, wrench, 0.5)
/// 0.0
#[pyfunction]
#[pyo3(signature = (a, b, h))]
pub(crate) fn wrench_pitch_form(
    a: Numbers<'_>,
    b: Numbers<'_>,
    #[pyo3(from_py_with = argument)] h: f64,
) -> Result<f64> {
    check_pitch(h)?;
    Ok(finite_wrench(&a, "a")?.pitch_form(finite_wrench(&b, "b")?, h))
}

/// The Klein form of two twists: the form of pitch zero; zero for reciprocal twists.
///
/// Parameters
/// ----------
/// a, b : array_like, (6,)
///     Twists of one frame, linear part first [m/s, rad/s].
///
/// Returns
/// -------
/// float
///     `(v_a . w_b + w_a . v_b) / 2` [m rad/s^2].
///
/// Raises
/// ------
/// DimensionError, NotFiniteError
///
/// Examples
/// --------
/// Rotations about axes that intersect are reciprocal.
///
/// >>> import cylindroid as cy
/// >>> cy.klein([0, 0, 0, 0, 0, 1], [0, 0, 0, 1, 0, 0])
/// 0.0
#[pyfunction]
#[pyo3(signature = (a, b))]
pub(crate) fn klein(a: Numbers<'_>, b: Numbers<'_>) -> Result<f64> {
    Ok(finite_twist(&a, "a")?.klein(finite_twist(&b, "b")?))
}

/// The Killing form of two twists, `tr(ad(a) ad(b))`.
///
/// Parameters
/// ----------
/// a, b : array_like, (6,)
///     Twists of one frame, linear part first [m/s, rad/s].
///
/// Returns
/// -------
/// float
///     `-4 w_a . w_b` [rad^2/s^2]: four times the form of infinite pitch.
///
/// Raises
/// ------
/// DimensionError, NotFiniteError
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> cy.killing([0, 0, 0, 0, 0, 1], [0, 0, 0, 0, 0, 1])
/// -4.0
#[pyfunction]
#[pyo3(signature = (a, b))]
pub(crate) fn killing(a: Numbers<'_>, b: Numbers<'_>) -> Result<f64> {
    Ok(finite_twist(&a, "a")?.killing(finite_twist(&b, "b")?))
}

/// The wrench `Q_h @ twist`, whose power with any twist is the form of pitch h with it.
///
/// Parameters
/// ----------
/// twist : array_like, (6,)
///     Linear part first [m/s, rad/s].
/// h : float
///     Pitch [m/rad], or infinite.
///
/// Returns
/// -------
/// ndarray, (6,)
///     Force first, in the frame of the twist.
///
/// Raises
/// ------
/// DimensionError, NotFiniteError
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> a, b = [1, 0, 0, 0, 0, 1], [0, 1, 0, 0.5, 0, 0.5]
/// >>> float(cy.lowered(a, 0.25) @ b) == cy.pitch_form(a, b, 0.25)
/// True
#[pyfunction]
#[pyo3(signature = (twist, h))]
pub(crate) fn lowered<'py>(
    py: Python<'py>,
    twist: Numbers<'py>,
    #[pyo3(from_py_with = argument)] h: f64,
) -> Result<Array<'py>> {
    check_pitch(h)?;
    Ok(arrays::vector(py, &finite_twist(&twist, "twist")?.lowered(h).to_array()))
}

/// The twist `inv(Q_h) @ wrench`: undoes `lowered`.
///
/// Parameters
/// ----------
/// wrench : array_like, (6,)
///     Force first (N, N m).
/// h : float
///     Pitch [m/rad], finite: the form of infinite pitch has no inverse.
///
/// Returns
/// -------
/// ndarray, (6,)
///     Linear part first, in the frame of the wrench.
///
/// Raises
/// ------
/// DimensionError, NotFiniteError
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> cy.raised(cy.lowered([1, 0, 0, 0, 0, 1], 0.25), 0.25)
/// array([1., 0., 0., 0., 0., 1.])
#[pyfunction]
#[pyo3(signature = (wrench, h))]
pub(crate) fn raised<'py>(
    py: Python<'py>,
    wrench: Numbers<'py>,
    #[pyo3(from_py_with = argument)] h: f64,
) -> Result<Array<'py>> {
    Error::check_finite("h", &[h])?;
    Ok(arrays::vector(py, &finite_wrench(&wrench, "wrench")?.raised(h).to_array()))
}

/// The Gram matrix of the pitch form, `J.T @ Q_h @ J`.
///
/// Parameters
/// ----------
/// J : array_like, (6, m)
///     Twists as columns, linear part first.
/// h : float
///     Pitch [m/rad], or infinite for the form at infinity.
///
/// Returns
/// -------
/// ndarray, (m, m)
///     Symmetric, in general indefinite; the same in every frame.
///
/// Raises
/// ------
/// DimensionError
///     For a J that has not six rows.
/// NotFiniteError, InvalidOptionError
///
/// Notes
/// -----
/// Donelan and Selig, section 3.
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> cy.gram([[0, 0], [0, 0], [0, 0.5], [0, 0], [0, 0], [1, 1]], 0.25)
/// array([[-0.25,  0.  ],
///        [ 0.  ,  0.25]])
#[pyfunction]
#[pyo3(signature = (J, h))]
#[expect(non_snake_case, reason = "the field's name")]
pub(crate) fn gram<'py>(
    py: Python<'py>,
    J: Numbers<'py>,
    #[pyo3(from_py_with = argument)] h: f64,
) -> Result<Array<'py>> {
    check_pitch(h)?;
    arrays::matrix(py, &gram_of(&finite_columns(&J)?, h)?)
}

/// The Gram determinant of the pitch form, `det(J.T @ Q_h @ J)`.
///
/// Parameters
/// ----------
/// J : array_like, (6, m)
///     Twists as columns, linear part first.
/// h : float
///     Pitch [m/rad], or infinite for the form at infinity.
///
/// Returns
/// -------
/// float
///     A polynomial in h whose zeros are the principal pitches; zero for dependent twists. With the
///     1/2 of Q_h, which determinants of the literature may leave out (a factor of 2**m).
///
/// Raises
/// ------
/// DimensionError, NotFiniteError, InvalidOptionError
///     As `gram`.
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> cy.gram_determinant([[0], [0], [0], [0], [0], [1]], 0.5)
/// -0.5
#[pyfunction]
#[pyo3(signature = (J, h))]
#[expect(non_snake_case, reason = "the field's name")]
pub(crate) fn gram_determinant(
    J: Numbers<'_>,
    #[pyo3(from_py_with = argument)] h: f64,
) -> Result<f64> {
    check_pitch(h)?;
    Ok(determinant_of(&finite_columns(&J)?, h)?)
}
