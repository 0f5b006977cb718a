//! The hyperbolic pseudoinverse and the oblique one.

use cylindroid::inverse::{self, HyperbolicDamping, HyperbolicOptions};
use pyo3::prelude::*;

use super::{PyInverse, of_each};
use crate::arrays::{Numbers, check_twists};
use crate::error::{Failure, Result, argument};
use crate::screws::scale_of;

/// The damping of hyperbolic inverses that two optional numbers mean.
fn damping_of(mu: Option<f64>, lam: Option<f64>) -> Result<HyperbolicDamping> {
    match (mu, lam) {
        (None, None) => Ok(HyperbolicDamping::None),
        (Some(mu), None) => Ok(HyperbolicDamping::Invariant { mu }),
        (None, Some(lambda)) => Ok(HyperbolicDamping::Gram { lambda }),
        (Some(mu), Some(_)) => {
            let reason =
                "give mu (invariant damping) or lam (damping of the Gram matrix), not both";
            Err(Failure::option("mu", mu.to_string(), reason))
        }
    }
}

/// The hyperbolic pseudoinverse of pitch h: frame- and unit-invariant joint velocities.
///
/// Parameters
/// ----------
/// J : array_like, (6, m) or (N, 6, m)
///     Twists as columns, linear part first (the literature writes angular first).
/// h : float
///     Pitch of the form [m/rad], or `inf` for the limit.
/// joint_metric : array_like, (m,) or (m, m), optional
///     Matters for dependent columns and for damping. Default: the identity.
/// length : float, optional
///     Characteristic length (m) of the verdict on existence, not of the inverse. Default: 1.
/// center : array_like, (3,), optional
///     The point at which lengths are judged. Default: the one nearest to all axes.
/// noise : float, optional
///     Error of the twists relative to their size.
/// mu : float, optional
///     Invariant damping [m/rad]: exists for every J.
/// lam : float, optional
///     Damping of the Gram matrix [m/rad].
///
/// Returns
/// -------
/// Inverse
///     If `exists` is false, `reason` is the reason and `matrix` is NaN.
///
/// Raises
/// ------
/// DimensionError
///     For a J that has not six rows.
/// NotFiniteError, InvalidOptionError
///
/// Notes
/// -----
/// Donelan and Selig, Hyperbolic pseudoinverses for kinematics in the Euclidean group.
///
/// Examples
/// --------
/// A rotation about z through (1, 0, 0); the pitch of the joint itself has no inverse.
///
/// >>> import cylindroid as cy
/// >>> J = [[0.0], [-1.0], [0.0], [0.0], [0.0], [1.0]]
/// >>> cy.hyperbolic(J, 0.1).exists
/// True
/// >>> cy.hyperbolic(J, 0.0).exists
/// False
#[pyfunction]
#[pyo3(signature = (J, h, joint_metric = None, length = None, center = None, noise = None, *,
    mu = None, lam = None))]
#[expect(non_snake_case, reason = "the field's name")]
#[expect(clippy::too_many_arguments, reason = "they have names in Python")]
pub(crate) fn hyperbolic(
    py: Python<'_>,
    J: Numbers<'_>,
    #[pyo3(from_py_with = argument)] h: f64,
    joint_metric: Option<Numbers<'_>>,
    #[pyo3(from_py_with = argument)] length: Option<f64>,
    center: Option<Numbers<'_>>,
    #[pyo3(from_py_with = argument)] noise: Option<f64>,
    #[pyo3(from_py_with = argument)] mu: Option<f64>,
    #[pyo3(from_py_with = argument)] lam: Option<f64>,
) -> Result<PyInverse> {
    let options = HyperbolicOptions {
        scale: scale_of(length, center.as_ref(), noise)?,
        joint_metric: joint_metric.map(|m| m.metric("joint_metric")).transpose()?,
        damping: damping_of(mu, lam)?,
    };
    of_each(py, &J, |j| {
        check_twists("J", j)?;
        inverse::hyperbolic_with(j, h, &options)
    })
}

/// The inverse that leaves out sums of chosen twists.
///
/// Parameters
/// ----------
/// J : array_like, (6, m) or (N, 6, m)
///     Twists as columns, linear part first.
/// complement : array_like, (6, 6 - rank)
///     Twists, in the frame of J, that the task may give up.
/// joint_metric, length, center, noise
///     As `hyperbolic`.
///
/// Returns
/// -------
/// Inverse
///
/// Raises
/// ------
/// DimensionError, NotFiniteError, InvalidOptionError
#[pyfunction]
#[pyo3(signature = (J, complement, joint_metric = None, length = None, center = None,
    noise = None))]
#[expect(non_snake_case, reason = "the field's name")]
pub(crate) fn oblique(
    py: Python<'_>,
    J: Numbers<'_>,
    complement: Numbers<'_>,
    joint_metric: Option<Numbers<'_>>,
    #[pyo3(from_py_with = argument)] length: Option<f64>,
    center: Option<Numbers<'_>>,
    #[pyo3(from_py_with = argument)] noise: Option<f64>,
) -> Result<PyInverse> {
    let options = HyperbolicOptions {
        scale: scale_of(length, center.as_ref(), noise)?,
        joint_metric: joint_metric.map(|m| m.metric("joint_metric")).transpose()?,
        damping: HyperbolicDamping::None,
    };
    let complement = complement.twist_columns("complement")?;
    of_each(py, &J, |j| {
        check_twists("J", j)?;
        inverse::oblique(j, &complement, &options)
    })
}
