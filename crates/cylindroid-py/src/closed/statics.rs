//! Statics: joint torques and contact forces in equilibrium.

use cylindroid::closure::{self, MotionSpace, StaticLoad};
use pyo3::prelude::*;

use super::PyConstraint;
use crate::arrays::{self, Array, Numbers};
use crate::error::Result;
use crate::table;

/// Joint torques that balance a wrench.
///
/// Attributes
/// ----------
/// torques : ndarray, (a,)
///     The torques of least norm [N m or N]; internal torques may be added.
/// unbalanced : ndarray, (d,)
///     The part of the wrench that nothing balances.
#[pyclass(frozen, name = "JointTorques", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyJointTorques {
    inner: closure::JointTorques,
}

#[pymethods]
impl PyJointTorques {
    #[getter]
    fn torques<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.torques)
    }

    #[getter]
    fn unbalanced<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.unbalanced)
    }

    fn __repr__(&self) -> String {
        format!(
            "JointTorques(torques={}, unbalanced={})",
            table::list(&self.inner.torques),
            table::list(&self.inner.unbalanced)
        )
    }
}

/// Forces at the contacts.
///
/// Attributes
/// ----------
/// forces : ndarray, (t,)
///     An entry for each row of the constraint: from the object on the limbs [N or N m].
/// unbalanced : float
///     Norm of the unbalanced part of the load over that of the load: rounding, unless torques and
///     wrench contradict each other.
#[pyclass(frozen, name = "ContactForces", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyContactForces {
    inner: closure::ContactForces,
}

#[pymethods]
impl PyContactForces {
    #[getter]
    fn forces<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.forces)
    }

    #[getter]
    fn unbalanced(&self) -> f64 {
        self.inner.unbalanced
    }

    fn __repr__(&self) -> String {
        format!(
            "ContactForces(forces={}, unbalanced={:.1e})",
            table::list(&self.inner.forces),
            self.inner.unbalanced
        )
    }
}

#[pymethods]
impl PyConstraint {
    /// The joint torques of least norm that balance a wrench on the object.
    ///
    /// Parameters
    /// ----------
    /// wrench : array_like, (d,)
    ///     Acts on the object, force first.
    /// metric : array_like, (a,) or (a, a), optional
    ///     Of the torques. Default: scaled by the characteristic length.
    ///
    /// Returns
    /// -------
    /// JointTorques
    #[pyo3(signature = (wrench, metric = None))]
    fn joint_torques(
        &self,
        py: Python<'_>,
        wrench: Numbers<'_>,
        metric: Option<Numbers<'_>>,
    ) -> Result<PyJointTorques> {
        let metric = metric.map(|m| m.metric("metric")).transpose()?;
        let wrench = wrench.vector("wrench")?;
        let inner = py.detach(|| {
            let relation = self.relation(None)?;
            closure::joint_torques(&relation, wrench, metric.as_ref())
        })?;
        Ok(PyJointTorques { inner })
    }

    /// The forces at the contacts under torques and a wrench: least, or elastic.
    ///
    /// Parameters
    /// ----------
    /// torques : array_like, (a,)
    /// wrench : array_like, (d,)
    /// compliance : array_like, (t,) or (t, t), optional
    ///     Of the contacts.
    ///
    /// Returns
    /// -------
    /// ContactForces
    #[pyo3(signature = (torques, wrench, compliance = None))]
    fn contact_forces(
        &self,
        py: Python<'_>,
        torques: Numbers<'_>,
        wrench: Numbers<'_>,
        compliance: Option<Numbers<'_>>,
    ) -> Result<PyContactForces> {
        let compliance = compliance.map(|c| c.metric("compliance")).transpose()?;
        let load =
            StaticLoad { torques: torques.vector("torques")?, wrench: wrench.vector("wrench")? };
        let inner = py.detach(|| {
            let motions = MotionSpace::of(&self.inner);
            closure::contact_forces(&self.inner, &motions, load, compliance.as_ref())
        })?;
        Ok(PyContactForces { inner })
    }

    /// A basis of the internal (squeeze) forces: contact forces without a wrench on the object.
    ///
    /// Returns
    /// -------
    /// ndarray, (t, k)
    fn internal_forces<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::matrix(py, &py.detach(|| closure::internal_forces(&self.inner)).basis)
    }

    /// A basis of the structural forces: contact forces without torques at any joint.
    ///
    /// Returns
    /// -------
    /// ndarray, (t, k)
    fn structural_forces<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::matrix(py, &py.detach(|| closure::structural_forces(&self.inner)).basis)
    }
}
