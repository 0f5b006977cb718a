//! The class `OperatorAuthority`: scale of an operator's twist near joint limits.

use cylindroid::control::{AuthorityTimes, OperatorAuthority};
use pyo3::prelude::*;

use crate::error::{Failure, Result};
use crate::servo::PyServo;
use crate::table;

/// Authority of an operator in shared control: the scale of the operator's twist at which an arm
/// near its limits still performs the robot's part of the task.
///
/// It starts at zero, falls after every step in which limits scaled the motion or changed its
/// direction, and rises after all others.
///
/// Parameters
/// ----------
/// dt : float
///     Time between steps (s).
/// fall : float
///     Time in which it falls to 1/e at limits (s): the braking time of the joints.
/// rise : float
///     Time in which it rises from 0 to 1 (s): at least the time in which the joints accelerate.
///
/// Attributes
/// ----------
/// value : float
///     The authority, in [0, 1]: `law.command(projector, error, authority.value * operator)`.
///
/// Raises
/// ------
/// InvalidOptionError
///     For times that are not positive and finite.
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> robot = cy.load("panda")
/// >>> servo, authority = cy.Servo(robot), cy.OperatorAuthority(0.001, fall=0.1, rise=0.5)
/// >>> qd = servo.step(robot.home, robot.fk(robot.home))
/// >>> authority.update(servo)
/// >>> authority.value
/// 0.002
#[pyclass(name = "OperatorAuthority", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyOperatorAuthority {
    inner: OperatorAuthority,
}

#[pymethods]
impl PyOperatorAuthority {
    #[new]
    #[pyo3(signature = (dt, fall, rise))]
    fn new(dt: f64, fall: f64, rise: f64) -> Result<Self> {
        Ok(Self { inner: OperatorAuthority::new(AuthorityTimes { dt, fall, rise })? })
    }

    #[getter]
    fn value(&self) -> f64 {
        self.inner.get()
    }

    /// Updates the authority after a step of the servo.
    ///
    /// Parameters
    /// ----------
    /// servo : Servo
    ///     The servo, after its step.
    ///
    /// Raises
    /// ------
    /// InvalidOptionError
    ///     Before the first step.
    #[pyo3(signature = (servo))]
    fn update(&mut self, servo: PyRef<'_, PyServo>) -> Result<()> {
        let Some(step) = servo.last() else {
            return Err(Failure::option("servo", "before its first step", "update after it"));
        };
        self.inner.update(step.saturation);
        Ok(())
    }

    fn __repr__(&self) -> String {
        format!("<OperatorAuthority {}>", table::number(self.inner.get()))
    }
}
