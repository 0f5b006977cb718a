//! Shared control: the classes `SharedController` and `SharedCommand`.

use cylindroid::Twist;
use cylindroid::control::{SharedCommand, SharedController, SharedInput};
use pyo3::prelude::*;

use crate::arrays::{self, Array, Numbers};
use crate::error::{Result, argument};
use crate::screws::PyProjector;
use crate::table;

/// Shared control: the robot controls some motions of its tool, an operator the others.
///
/// Projector and twists must be expressed in one common frame, which is arbitrary. For a servo it
/// has world axes and its origin at the tool.
///
/// Parameters
/// ----------
/// gain : float
///     Gain of the twist error [1/s].
///
/// Raises
/// ------
/// InvalidOptionError
///     For a gain that is not positive and finite.
///
/// Notes
/// -----
/// Donelan and Selig, Hyperbolic pseudoinverses for kinematics in the Euclidean group, section 6.3.
/// Near joint limits, scale the operator's twist by `OperatorAuthority`.
///
/// Examples
/// --------
/// An operator slides a tool along a plane; motions into the plane are not executed:
///
/// >>> import numpy as np
/// >>> import cylindroid as cy
/// >>> slide_and_turn = np.eye(6)[:, [0, 1, 3, 4, 5]]
/// >>> projector = cy.Projector(slide_and_turn, np.inf)
/// >>> law = cy.SharedController(10.0)
/// >>> command = law.command(projector, error=[0, 0, 0.01, 0, 0, 0],
/// ...                       operator=[0.2, 0, -5, 0, 0, 0])
/// >>> command.twist.round(9) + 0.0
/// array([0.2, 0. , 0.1, 0. , 0. , 0. ])
#[pyclass(frozen, name = "SharedController", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PySharedController {
    inner: SharedController,
}

/// The command of shared control: a twist and the components of robot and operator.
///
/// Attributes
/// ----------
/// twist : ndarray, (6,)
///     The twist of the tool, the sum of both components [m/s, rad/s].
/// robot_part, operator_part : ndarray, (6,)
///     The component of the robot and that of the operator [m/s, rad/s].
#[pyclass(frozen, name = "SharedCommand", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PySharedCommand {
    inner: SharedCommand,
}

#[pymethods]
impl PySharedController {
    #[new]
    #[pyo3(signature = (gain))]
    fn new(#[pyo3(from_py_with = argument)] gain: f64) -> Result<Self> {
        Ok(Self { inner: SharedController::new(gain)? })
    }

    /// The shared control command of this step.
    ///
    /// Parameters
    /// ----------
    /// projector : Projector
    ///     The projector onto the operator's motions, along the robot's.
    /// error : array_like, (6,)
    ///     Displacement from the tool to any pose that satisfies the robot's part of the task, see
    ///     `screw_to` [m, rad].
    /// operator : array_like, (6,)
    ///     The twist commanded by the operator [m/s, rad/s].
    /// feed_forward : array_like, (6,), optional
    ///     The twist of the robot's target [m/s, rad/s]. Default: zero.
    ///
    /// Returns
    /// -------
    /// SharedCommand
    ///     For `Servo.step(q, pose, feed_forward=command.twist)`.
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError
    #[pyo3(signature = (projector, error, operator, feed_forward = None))]
    fn command(
        &self,
        #[pyo3(from_py_with = argument)] projector: PyRef<'_, PyProjector>,
        error: Numbers<'_>,
        operator: Numbers<'_>,
        feed_forward: Option<Numbers<'_>>,
    ) -> Result<PySharedCommand> {
        let input = SharedInput {
            error: error.twist("error")?,
            feed_forward: feed_forward.map_or(Ok(Twist::ZERO), |f| f.twist("feed_forward"))?,
            operator: operator.twist("operator")?,
        };
        Ok(PySharedCommand { inner: self.inner.command(&projector.inner, &input)? })
    }
}

#[pymethods]
impl PySharedCommand {
    #[getter]
    fn twist<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.twist.to_array())
    }

    #[getter]
    fn robot_part<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.robot_part.to_array())
    }

    #[getter]
    fn operator_part<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.operator_part.to_array())
    }

    fn __repr__(&self) -> String {
        format!("SharedCommand(twist={})", table::list(&self.inner.twist.to_array()))
    }
}
