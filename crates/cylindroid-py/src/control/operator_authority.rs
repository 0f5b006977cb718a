//! The class `OperatorAuthority`: scale of an operator's twist near joint limits.

use std::sync::{Mutex, MutexGuard, PoisonError};

use cylindroid::control::{AuthorityTimes, OperatorAuthority};
use pyo3::prelude::*;

use crate::error::{Failure, Result, argument};
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
#[pyclass(frozen, name = "OperatorAuthority", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyOperatorAuthority {
    inner: Mutex<OperatorAuthority>,
}

impl PyOperatorAuthority {
    fn lock(&self) -> MutexGuard<'_, OperatorAuthority> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl PyOperatorAuthority {
    #[new]
    #[pyo3(signature = (dt, fall, rise))]
    fn new(
        #[pyo3(from_py_with = argument)] dt: f64,
        #[pyo3(from_py_with = argument)] fall: f64,
        #[pyo3(from_py_with = argument)] rise: f64,
    ) -> Result<Self> {
        let inner = OperatorAuthority::new(AuthorityTimes { dt, fall, rise })?;
        Ok(Self { inner: Mutex::new(inner) })
    }

    #[getter]
    fn value(&self) -> f64 {
        self.lock().get()
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
    fn update(&self, #[pyo3(from_py_with = argument)] servo: PyRef<'_, PyServo>) -> Result<()> {
        let Some(step) = servo.last()? else {
            return Err(Failure::option("servo", "before its first step", "update after it"));
        };
        self.lock().update(step.saturation);
        Ok(())
    }

    fn __repr__(&self) -> String {
        format!("<OperatorAuthority {}>", table::number(self.lock().get()))
    }
}
