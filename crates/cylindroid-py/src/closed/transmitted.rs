//! The wrenches that loop joints and contacts transmit.

use cylindroid::closure::{ClosedChain, TransmittedWrench, transmitted_wrenches};
use pyo3::prelude::*;

use super::PyConstraint;
use crate::arrays::{self, Array, Numbers};
use crate::error::{Failure, Result};
use crate::table;

/// The wrench transmitted by a loop joint or a contact.
///
/// Attributes
/// ----------
/// name : str
///     The joint or contact.
/// point : ndarray, (3,)
///     Its position in the world (m).
/// wrench : ndarray, (6,)
///     Exerted by the first link on the second, at the point, world axes, force first (N, N m).
/// normal : float or None
///     For contacts: the force along the normal (N), positive for pushing.
/// tangential : float or None
///     For contacts: the norm of the tangential force (N).
#[pyclass(frozen, name = "TransmittedWrench", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyTransmittedWrench {
    pub(super) inner: TransmittedWrench,
}

#[pymethods]
impl PyTransmittedWrench {
    #[getter]
    fn name(&self) -> &str {
        &self.inner.name
    }

    #[getter]
    fn point<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.point.to_array())
    }

    #[getter]
    fn wrench<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.wrench.to_array())
    }

    #[getter]
    fn normal(&self) -> Option<f64> {
        self.inner.normal
    }

    #[getter]
    fn tangential(&self) -> Option<f64> {
        self.inner.tangential()
    }

    fn __repr__(&self) -> String {
        let wrench = table::list(&self.inner.wrench.to_array());
        format!("TransmittedWrench('{}', wrench={wrench})", self.inner.name)
    }
}

#[pymethods]
impl PyConstraint {
    /// The wrenches of all loop joints, then of all contacts, from the forces of the rows.
    ///
    /// Parameters
    /// ----------
    /// forces : array_like, (t,)
    ///     An entry for each row: the `forces` of `contact_forces`, or a column of
    ///     `internal_forces` [N or N m].
    ///
    /// Returns
    /// -------
    /// list of TransmittedWrench
    ///
    /// Raises
    /// ------
    /// InvalidOptionError
    ///     For a constraint from matrices, which has no joints.
    /// DimensionError, NotFiniteError
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> four_bar = cy.load("four-bar")
    /// >>> constraint = four_bar.constraint()
    /// >>> wrench = [0.0, -10.0, 0.0]
    /// >>> torques = constraint.joint_torques(wrench).torques
    /// >>> forces = constraint.contact_forces(torques, wrench).forces
    /// >>> found = constraint.transmitted_wrenches(forces)
    /// >>> [w.name for w in found] == [j.name for j in four_bar.joints if j.closes_loop]
    /// True
    #[pyo3(signature = (forces))]
    fn transmitted_wrenches(&self, forces: Numbers<'_>) -> Result<Vec<PyTransmittedWrench>> {
        let Some(origin) = &self.origin else {
            let reason = "a constraint from matrices has no joints; use Mechanism.constraint";
            return Err(Failure::option("constraint", "matrices", reason));
        };
        let chain = ClosedChain::of(&origin.state, Some(origin.reference), None)?;
        let found = transmitted_wrenches(&origin.state, &chain, forces.vector("forces")?)?;
        Ok(found.into_iter().map(|inner| PyTransmittedWrench { inner }).collect())
    }
}
