//! Hybrid control: some motions in position, the wrenches that do no work on them in force.

use cylindroid::Twist;
use cylindroid::control::{HybridCommand, HybridController, HybridInput};
use pyo3::prelude::*;

use super::PyAdmittance;
use crate::arrays::{self, Array, Numbers};
use crate::error::Result;
use crate::screws::PyProjector;
use crate::table;

/// Hybrid control: some motions of a tool are controlled in position, the wrenches that do no work
/// on them in force.
///
/// Everything is in one frame, whichever: that of the projector, the admittance, the twists and the
/// wrenches. For a servo it has the axes of the world and its origin at the tool.
///
/// Parameters
/// ----------
/// gain : float
///     Of the twist error [1/s].
/// admittance : Admittance
///     How the tool gives way to the wrench error; times the stiffness of the contact and dt below
///     2 [1/s].
///
/// Raises
/// ------
/// InvalidOptionError
///
/// Notes
/// -----
/// Donelan and Selig, Hyperbolic pseudoinverses for kinematics in the Euclidean group, section 6.3.
/// The command does not depend on the frame, where selecting rows of a task frame (Raibert and
/// Craig 1981) mixes metres and radians.
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

/// What hybrid control commands.
///
/// Attributes
/// ----------
/// twist : ndarray, (6,)
///     Of the tool: the sum of the two parts [m/s, rad/s].
/// position_part : ndarray, (6,)
///     Of the twist error and the feed-forward, in the motions controlled in position.
/// force_part : ndarray, (6,)
///     Of the wrench error, along what the projector drops.
/// wrench_error : ndarray, (6,)
///     What counts of desired less measured: the part that does no work on those motions.
#[pyclass(frozen, name = "HybridCommand", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyHybridCommand {
    inner: HybridCommand,
}

#[pymethods]
impl PyHybridController {
    #[new]
    #[pyo3(signature = (gain, admittance))]
    fn new(gain: f64, admittance: PyRef<'_, PyAdmittance>) -> Result<Self> {
        Ok(Self { inner: HybridController::new(gain, admittance.inner)? })
    }

    /// The twist of this step.
    ///
    /// Parameters
    /// ----------
    /// projector : Projector
    ///     On the motions controlled in position.
    /// error : array_like, (6,)
    ///     From the tool to its target, see `screw_to` [m, rad].
    /// desired, measured : array_like, (6,)
    ///     Wrenches that the tool shall exert and exerts on its surroundings, force first: the
    ///     negative of what a sensor in the wrist reads.
    /// feed_forward : array_like, (6,), optional
    ///     The twist of the target.
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
        projector: PyRef<'_, PyProjector>,
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

    /// The same law seen from another frame.
    ///
    /// Parameters
    /// ----------
    /// a_from_b : array_like, (4, 4)
    ///     This one is in frame b.
    ///
    /// Returns
    /// -------
    /// HybridController
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
