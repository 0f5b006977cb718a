//! Internal force control of cooperating arms, hands and over-actuated mechanisms.

use cylindroid::control::{InternalForceCommand, InternalForceController};
use pyo3::prelude::*;

use crate::arrays::{self, Array, Numbers};
use crate::closed::PyConstraint;
use crate::error::{Result, argument};
use crate::table;

/// Internal force control of a grasp or an over-actuated mechanism: velocities of the actuated
/// joints that bring the internal torques to a set-point without moving the object.
///
/// Parameters
/// ----------
/// gain : float
///     The error of the internal torques decays as exp(-gain t) [1/s]; gain * dt must be below 2.
/// stiffness : array_like, (a,)
///     Stiffness of each actuated joint, which is controlled in position or velocity and compliant
///     [N m/rad or N/m].
///
/// Raises
/// ------
/// InvalidOptionError
///     For a gain or stiffness that is not positive and finite.
///
/// Notes
/// -----
/// Bicchi and Prattichizzo 1998, eq. 13.
///
/// Examples
/// --------
/// Two actuators push on one slider from both sides, each with 1 N too little:
///
/// >>> import cylindroid as cy
/// >>> pair = cy.Constraint([[1.0, 0.0], [0.0, 1.0]], G=[[1.0, 1.0]])
/// >>> law = cy.InternalForceController(10.0, [1000.0, 1000.0])
/// >>> command = law.command(pair, desired=[5.0, -5.0], measured=[4.0, -4.0])
/// >>> command.joint_velocities.round(9)
/// array([ 0.01, -0.01])
#[pyclass(frozen, name = "InternalForceController", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyInternalForceController {
    inner: InternalForceController,
}

/// The command of internal force control: joint velocities to add to those of the motion.
///
/// Attributes
/// ----------
/// joint_velocities : ndarray, (a,)
///     Velocities of the actuated joints [rad/s or m/s].
/// internal, error : ndarray, (a,)
///     Internal component of the measured torques, and of desired minus measured ones [N m or N].
#[pyclass(frozen, name = "InternalForceCommand", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyInternalForceCommand {
    inner: InternalForceCommand,
}

#[pymethods]
impl PyInternalForceController {
    #[new]
    #[pyo3(signature = (gain, stiffness))]
    fn new(#[pyo3(from_py_with = argument)] gain: f64, stiffness: Numbers<'_>) -> Result<Self> {
        Ok(Self { inner: InternalForceController::new(gain, stiffness.vector("stiffness")?)? })
    }

    /// The joint velocities of this step that regulate the internal forces.
    ///
    /// Parameters
    /// ----------
    /// constraint : Constraint
    ///     The velocity constraint of the current configuration.
    /// desired, measured : array_like, (a,)
    ///     Desired and measured torques exerted by the joints, in the order of
    ///     `constraint.actuated` [N m or N]; only their internal component is used. For internal
    ///     contact forces t (a column of `Constraint.internal_forces`), desired is `-Ja.T @ t`.
    ///
    /// Returns
    /// -------
    /// InternalForceCommand
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError
    #[pyo3(signature = (constraint, desired, measured))]
    fn command(
        &self,
        #[pyo3(from_py_with = argument)] constraint: PyRef<'_, PyConstraint>,
        desired: Numbers<'_>,
        measured: Numbers<'_>,
    ) -> Result<PyInternalForceCommand> {
        let relation = constraint.relation(None)?;
        let (desired, measured) = (desired.vector("desired")?, measured.vector("measured")?);
        Ok(PyInternalForceCommand { inner: self.inner.command(&relation, desired, measured)? })
    }
}

#[pymethods]
impl PyInternalForceCommand {
    #[getter]
    fn joint_velocities<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.joint_velocities)
    }

    #[getter]
    fn internal<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.internal)
    }

    #[getter]
    fn error<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.error)
    }

    fn __repr__(&self) -> String {
        format!(
            "InternalForceCommand(joint_velocities={}, internal={}, error={})",
            table::list(&self.inner.joint_velocities),
            table::list(&self.inner.internal),
            table::list(&self.inner.error)
        )
    }
}
