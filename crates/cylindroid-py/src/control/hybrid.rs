//! Hybrid position/force control: the classes `HybridController` and `HybridCommand`.

use cylindroid::Twist;
use cylindroid::control::{HybridCommand, HybridController, HybridInput};
use pyo3::prelude::*;

use super::PyAdmittance;
use crate::arrays::{self, Array, Numbers};
use crate::error::{Result, argument};
use crate::screws::PyProjector;
use crate::table;

/// Hybrid position/force control: some motions of a tool are controlled in position, and the
/// wrenches that do no work on them in force.
///
/// Projector, admittance, twists and wrenches must be expressed in one common frame, which is
/// arbitrary. For a servo it has world axes and its origin at the tool.
///
/// Parameters
/// ----------
/// gain : float
///     Gain of the twist error [1/s].
/// admittance : Admittance
///     Gain of the wrench error; its product with the contact stiffness and dt must be below 2.
///
/// Raises
/// ------
/// InvalidOptionError
///     For a gain that is not positive and finite.
///
/// Notes
/// -----
/// Donelan and Selig, Hyperbolic pseudoinverses for kinematics in the Euclidean group, section 6.3.
/// The command is independent of the frame, whereas a selection of rows in a task frame (Raibert
/// and Craig 1981) mixes metres and radians.
///
/// Examples
/// --------
/// A tool that presses on a plane with 10 N and slides along it:
///
/// >>> import numpy as np
/// >>> import cylindroid as cy
/// >>> slide_and_turn = np.eye(6)[:, [0, 1, 3, 4, 5]]
/// >>> projector = cy.Projector(slide_and_turn, np.inf)
/// >>> law = cy.HybridController(10.0, cy.Admittance(0.01))
/// >>> command = law.command(projector, error=[0.02, 0, 0.3, 0, 0, 0],
/// ...                       desired=[0, 0, -10, 0, 0, 0], measured=[1, 0, -8, 0, 0, 0])
/// >>> command.twist.round(9) + 0.0
/// array([ 0.2 ,  0.  , -0.02,  0.  ,  0.  ,  0.  ])
#[pyclass(frozen, name = "HybridController", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyHybridController {
    inner: HybridController,
}

/// The command of a hybrid controller: a twist and its position and force components.
///
/// Attributes
/// ----------
/// twist : ndarray, (6,)
///     The twist of the tool, the sum of both components [m/s, rad/s].
/// position_part : ndarray, (6,)
///     Twist error and feed-forward, projected onto the motions controlled in position.
/// force_part : ndarray, (6,)
///     Admittance of the wrench error, in the complement of these motions.
/// wrench_error : ndarray, (6,)
///     Desired minus measured wrench, without the component that does work on the motions
///     controlled in position [N, N m].
#[pyclass(frozen, name = "HybridCommand", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyHybridCommand {
    inner: HybridCommand,
}

#[pymethods]
impl PyHybridController {
    #[new]
    #[pyo3(signature = (gain, admittance))]
    fn new(
        #[pyo3(from_py_with = argument)] gain: f64,
        #[pyo3(from_py_with = argument)] admittance: PyRef<'_, PyAdmittance>,
    ) -> Result<Self> {
        Ok(Self { inner: HybridController::new(gain, admittance.inner)? })
    }

    /// The hybrid position/force command of this step.
    ///
    /// Parameters
    /// ----------
    /// projector : Projector
    ///     The projector onto the motions controlled in position.
    /// error : array_like, (6,)
    ///     Displacement from the tool to its target, see `screw_to` [m, rad].
    /// desired, measured : array_like, (6,)
    ///     Desired and measured wrench of the tool on its environment, force first [N, N m]: the
    ///     negative of the reading of a wrist sensor.
    /// feed_forward : array_like, (6,), optional
    ///     The twist of the target [m/s, rad/s]. Default: zero.
    ///
    /// Returns
    /// -------
    /// HybridCommand
    ///     For `Servo.step(q, pose, feed_forward=command.twist)`.
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError
    #[pyo3(signature = (projector, error, desired, measured, feed_forward = None))]
    fn command(
        &self,
        #[pyo3(from_py_with = argument)] projector: PyRef<'_, PyProjector>,
        error: Numbers<'_>,
        desired: Numbers<'_>,
        measured: Numbers<'_>,
        feed_forward: Option<Numbers<'_>>,
    ) -> Result<PyHybridCommand> {
        let input = HybridInput {
            error: error.twist("error")?,
            feed_forward: feed_forward.map_or(Ok(Twist::ZERO), |f| f.twist("feed_forward"))?,
            desired: desired.wrench("desired")?,
            measured: measured.wrench("measured")?,
        };
        Ok(PyHybridCommand { inner: self.inner.command(&projector.inner, &input)? })
    }

    /// The same controller expressed in another frame.
    ///
    /// Parameters
    /// ----------
    /// a_from_b : array_like, (4, 4)
    ///     Pose of frame b, in which this controller is expressed, in frame a (m).
    ///
    /// Returns
    /// -------
    /// HybridController
    ///     In frame a.
    ///
    /// Raises
    /// ------
    /// InvalidOptionError, NotFiniteError
    #[pyo3(signature = (a_from_b))]
    fn seen_from(&self, a_from_b: Numbers<'_>) -> Result<Self> {
        Ok(Self { inner: self.inner.seen_from(a_from_b.pose("a_from_b")?) })
    }
}

#[pymethods]
impl PyHybridCommand {
    #[getter]
    fn twist<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.twist.to_array())
    }

    #[getter]
    fn position_part<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.position_part.to_array())
    }

    #[getter]
    fn force_part<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.force_part.to_array())
    }

    #[getter]
    fn wrench_error<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.wrench_error.to_array())
    }

    fn __repr__(&self) -> String {
        format!("HybridCommand(twist={})", table::list(&self.inner.twist.to_array()))
    }
}
