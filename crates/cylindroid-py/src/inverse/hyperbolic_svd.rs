//! The hyperbolic singular value decomposition and the polar decomposition in a pitch form.

use cylindroid::inverse::{self, HyperbolicSvd, PolarKind};
use pyo3::prelude::*;

use crate::arrays::{self, Array, Numbers};
use crate::error::{Result, argument};
use crate::screws::scale_of;
use crate::table::{self, Table};

/// The hyperbolic singular values of a Jacobian in the form of pitch h, with their decomposition.
///
/// Attributes
/// ----------
/// squares : ndarray, (k,)
///     The signed squares of the singular values, largest first: eigenvalues of `J.T @ Q @ J` in
///     the joint metric, independent of the frame; exactly zero by kind.
/// values : ndarray, (k,)
///     Their roots `sqrt(abs(squares))`.
/// left : ndarray, (6, k)
///     T with `T.T @ Q @ T = diag(sign(squares))`.
/// right : ndarray, (m, k)
///     X, orthonormal in the joint metric M: `J = T @ diag(values) @ X.T @ M`.
/// signature : tuple of (int, int, int)
///     Numbers of positive, negative and zero squares.
/// polar : str
///     'positive', 'negative' or 'signed' polar decomposition, or 'none'.
/// reason : str or None
///     The reason if there is none.
/// isometry : ndarray, (6, m), or None
///     W of the polar decomposition `J = W @ H`, with `W.T @ Q @ W = M @ E`.
/// stretch : ndarray, (m, m), or None
///     H: `M @ H` is symmetric and positive.
/// signs : ndarray, (m, m), or None
///     E: 1 on joint velocities of positive square, -1 on those of negative square.
#[pyclass(frozen, name = "HyperbolicSvd", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyHyperbolicSvd {
    inner: HyperbolicSvd,
}

/// The hyperbolic singular values of a Jacobian in the form of pitch h.
///
/// Parameters
/// ----------
/// J : array_like, (6, m)
///     Twists as columns, linear part first.
/// h : float
///     Pitch of the form [m/rad], finite.
/// joint_metric : array_like, (m,) or (m, m), optional
///     The metric M of joint velocities. Default: the identity.
/// length, center, noise
///     As `ScrewSystem`.
///
/// Returns
/// -------
/// HyperbolicSvd
///
/// Raises
/// ------
/// DimensionError, NotFiniteError, InvalidOptionError
///
/// Notes
/// -----
/// Onn, Steinhardt and Bojanczyk, The hyperbolic singular value decomposition and applications,
/// 1991. The decomposition exists if and only if the hyperbolic inverse does.
///
/// Examples
/// --------
/// A cylindrical joint: a rotation about z and a slide along z.
///
/// >>> import cylindroid as cy
/// >>> J = [[0, 0], [0, 0], [0, 1], [0, 0], [0, 0], [1, 0]]
/// >>> svd = cy.hyperbolic_svd(J, 0.0)
/// >>> svd.squares.round(12), svd.signature, svd.polar
/// (array([ 0.5, -0.5]), (1, 1, 0), 'signed')
#[pyfunction]
#[pyo3(signature = (J, h, joint_metric = None, length = None, center = None, noise = None))]
#[expect(non_snake_case, reason = "the field's name")]
pub(crate) fn hyperbolic_svd(
    J: Numbers<'_>,
    #[pyo3(from_py_with = argument)] h: f64,
    joint_metric: Option<Numbers<'_>>,
    #[pyo3(from_py_with = argument)] length: Option<f64>,
    center: Option<Numbers<'_>>,
    #[pyo3(from_py_with = argument)] noise: Option<f64>,
) -> Result<PyHyperbolicSvd> {
    let scale = scale_of(length, center.as_ref(), noise)?;
    let metric = joint_metric.map(|m| m.metric("joint_metric")).transpose()?;
    let inner = inverse::hyperbolic_svd(&J.twist_columns("J")?, h, &scale, metric.as_ref())?;
    Ok(PyHyperbolicSvd { inner })
}

#[pymethods]
impl PyHyperbolicSvd {
    #[getter]
    fn squares<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.squares)
    }

    #[getter]
    fn values<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.values())
    }

    #[getter]
    fn left<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::matrix(py, &self.inner.left)
    }

    #[getter]
    fn right<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::matrix(py, &self.inner.right)
    }

    #[getter]
    fn signature(&self) -> (usize, usize, usize) {
        let s = self.inner.signature;
        (s.positive, s.negative, s.zero)
    }

    #[getter]
    fn polar(&self) -> &'static str {
        self.inner.verdict.name()
    }

    #[getter]
    fn reason(&self) -> Option<String> {
        match self.inner.verdict {
            PolarKind::None { reason, .. } => Some(reason.to_string()),
            _ => None,
        }
    }

    #[getter]
    fn isometry<'py>(&self, py: Python<'py>) -> Result<Option<Array<'py>>> {
        self.inner.polar().map(|p| arrays::matrix(py, &p.isometry)).transpose()
    }

    #[getter]
    fn stretch<'py>(&self, py: Python<'py>) -> Result<Option<Array<'py>>> {
        self.inner.polar().map(|p| arrays::matrix(py, &p.stretch)).transpose()
    }

    #[getter]
    fn signs<'py>(&self, py: Python<'py>) -> Result<Option<Array<'py>>> {
        self.inner.polar().map(|p| arrays::matrix(py, &p.signs)).transpose()
    }
}

table::shown!(PyHyperbolicSvd);

impl PyHyperbolicSvd {
    fn table(&self) -> Table {
        let mut table = Table::new("HyperbolicSvd");
        table.row("squares", table::list(&self.inner.squares));
        table.row("signature", self.inner.signature.to_string());
        table.row("polar", self.inner.verdict.description());
        table
    }
}
