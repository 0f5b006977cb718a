//! Eigenscrews of stiffness and inertia matrices.

use cylindroid::Twist;
use cylindroid::screws::{self, EigenscrewKind, Eigenscrews, Screw};
use pyo3::prelude::*;

use super::{PyScrew, screw_list};
use crate::arrays::{self, Array, Numbers};
use crate::error::{Result, argument};
use crate::table::{self, Table};

/// The eigenscrews of a stiffness or inertia matrix.
///
/// Attributes
/// ----------
/// eigenvalues : ndarray, (n,)
///     Of a stiffness [N/rad]: the force along each screw for 1 rad about it; positive ones first.
/// screws : list of Screw
///     Axes and pitches.
/// twists : ndarray, (6, n)
///     Twists s as columns, linear part first, with `s.T @ D @ s` the sign of the eigenvalue.
/// wrenches : ndarray, (6, n)
///     The wrenches W of parallel springs: the matrix is the sum of `abs(eigenvalue) * W @ W.T`.
/// kind : str
///     'definite': three positive and three negative; 'semidefinite': as many as the rank;
///     'defective': fewer; 'indefinite': none are computed, they may be complex.
/// spring_pitch : float or None
///     The one pitch p [m/rad] for which the matrix is a sum of springs along wrenches of pitch p.
#[pyclass(frozen, name = "Eigenscrews", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyEigenscrews {
    inner: Eigenscrews,
}

/// The eigenscrews of a symmetric matrix K that takes twists to wrenches, in the form of pitch h.
///
/// Parameters
/// ----------
/// K : array_like, (6, 6)
///     Stiffness or inertia, linear part first (N/m, N/rad and N m/rad).
/// h : float
///     Pitch of the form [m/rad], finite.
///
/// Returns
/// -------
/// Eigenscrews
///     Solutions of `K @ s = eigenvalue * D @ s` with `D = [[0, 1], [1, -2 h]]`, independent of the
///     frame.
///
/// Raises
/// ------
/// DimensionError, NotFiniteError
/// InvalidOptionError
///     For a matrix that is not symmetric.
///
/// Notes
/// -----
/// Patterson and Lipkin, Structure of robot compliance, 1993; of an inertia, Ball's principal
/// screws of inertia.
///
/// Examples
/// --------
/// A body of 2 kg with radii of gyration 0.1, 0.2 and 0.3 m.
///
/// >>> import numpy as np
/// >>> import cylindroid as cy
/// >>> found = cy.eigenscrews(np.diag([2, 2, 2, 0.02, 0.08, 0.18]))
/// >>> found.kind, [round(s.pitch, 9) for s in found.screws]
/// ('definite', [0.3, 0.2, 0.1, -0.3, -0.2, -0.1])
#[pyfunction]
#[pyo3(signature = (K, h = 0.0))]
#[expect(non_snake_case, reason = "the field's name")]
pub(crate) fn eigenscrews(
    K: Numbers<'_>,
    #[pyo3(from_py_with = argument)] h: f64,
) -> Result<PyEigenscrews> {
    Ok(PyEigenscrews { inner: screws::eigenscrews(&K.twist_columns("K")?, h)? })
}

impl PyEigenscrews {
    fn eigenvalue_list(&self) -> Vec<f64> {
        self.inner.screws.iter().map(|e| e.eigenvalue).collect()
    }
}

#[pymethods]
impl PyEigenscrews {
    #[getter]
    fn eigenvalues<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.eigenvalue_list())
    }

    #[getter]
    fn screws(&self) -> Vec<PyScrew> {
        let all: Vec<Screw> = self.inner.screws.iter().filter_map(|e| e.screw()).collect();
        screw_list(&all)
    }

    #[getter]
    fn twists<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        let all: Vec<Twist> = self.inner.screws.iter().map(|e| e.twist).collect();
        arrays::twists(py, &all)
    }

    #[getter]
    fn wrenches<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        let six = |e: &screws::Eigenscrew| Twist::from_array(e.wrench.to_array());
        let all: Vec<Twist> = self.inner.screws.iter().map(six).collect();
        arrays::twists(py, &all)
    }

    #[getter]
    fn kind(&self) -> &'static str {
        self.inner.kind.name()
    }

    #[getter]
    fn spring_pitch(&self) -> Option<f64> {
        self.inner.spring_pitch
    }
}

table::shown!(PyEigenscrews);

impl PyEigenscrews {
    fn table(&self) -> Table {
        let mut table = Table::new("Eigenscrews");
        table.row("kind", self.inner.kind.name());
        if let EigenscrewKind::Defective { missing, .. } = self.inner.kind {
            table.row("missing", missing.to_string());
        }
        table.row("eigenvalues", table::list(&self.eigenvalue_list()));
        let pitches: Vec<f64> =
            self.inner.screws.iter().filter_map(|e| Some(e.screw()?.pitch)).collect();
        table.row("pitches", table::list(&pitches));
        table
    }
}
