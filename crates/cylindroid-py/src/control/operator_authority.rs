//! The class `OperatorAuthority`: how much of an operator's twist an arm near its limits can take.

use cylindroid::control::{AuthorityTimes, OperatorAuthority};
use pyo3::prelude::*;

use crate::error::{Failure, Result};
use crate::servo::PyServo;
use crate::table;

/// How much of an operator's twist an arm near its limits can take without losing what the robot
/// keeps: nothing at first, less after every step that limits slowed or bent, more after any other.
///
/// Parameters
/// ----------
/// dt : float
///     Between two steps (s).
/// fall : float
///     In which the share falls to 1/e at limits (s): what the joints need to brake.
/// rise : float
///     In which it rises from nothing to all (s): what they need to gain speed, or more.
///
/// Attributes
/// ----------
/// value : float
///     The share, in [0, 1]: `law.command(projector, error, share.value * operator)`.
///
/// Raises
/// ------
/// InvalidOptionError
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> robot = cy.load("panda")
/// >>> servo, share = cy.Servo(robot), cy.OperatorAuthority(0.001, fall=0.1, rise=0.5)
/// >>> rates = servo.step(robot.home, robot.fk(robot.home))
/// >>> share.update(servo)
/// >>> share.value
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

    /// Learns what became of the last step.
    ///
    /// Parameters
    /// ----------
    /// servo : Servo
    ///     After its step.
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
