//! Steps of a servo from the actuated joints of a closed chain.
//!
//! Checked  tests/test_drives.py

use std::collections::BTreeMap;

use cylindroid::closure::ClosedChain;
use cylindroid::{Error, Mechanism};
use pyo3::prelude::*;

use super::{PyServo, moving_target};
use crate::arrays::{self, Array, Numbers};
use crate::closed::PyLoopClosureError;
use crate::coordinates::Coordinates;
use crate::error::{Result, argument};

/// Sensors by the index of their coordinate.
fn places(
    sensors: Option<BTreeMap<String, f64>>,
    mechanism: &Mechanism,
) -> Result<Vec<(usize, f64)>> {
    let names = || mechanism.coordinates().iter().map(|c| c.name.as_str());
    let sensors = sensors.unwrap_or_default().into_iter().map(|(name, position)| {
        let place = names().position(|n| n == name);
        Ok((place.ok_or_else(|| Error::unknown("joint", &name, names()))?, position))
    });
    sensors.collect()
}

#[pymethods]
impl PyServo {
    /// One control step from the actuated joints alone, as parallel robots measure them; the passive
    /// joints of the loops are tracked from step to step.
    ///
    /// Parameters
    /// ----------
    /// actuated : array_like
    ///     The measured positions of the actuated coordinates, in the order of `joint_names`
    ///     [rad or m].
    /// target : array_like, (4, 4)
    ///     The desired `world_from_tool` (m).
    /// feed_forward : array_like, (6,), optional
    ///     The twist of a moving target, linear first, world axes, at the tool [m/s, rad/s].
    /// sensors : dict of str to float, optional
    ///     Positions of passive joints that are measured too, by name [rad or m]; the configuration is
    ///     the closed one nearest to all measured positions.
    ///
    /// Returns
    /// -------
    /// ndarray, (n,)
    ///     Joint velocities [rad/s or m/s].
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError
    ///     The state of the servo is unchanged.
    /// InvalidOptionError
    ///     For a target that is not a pose, or loops that no passive joints close near those of the
    ///     last step.
    ///
    /// See Also
    /// --------
    /// start_from : the assembly mode in which the passive joints are tracked.
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> stewart = cy.load("stewart")
    /// >>> servo = cy.Servo(stewart)
    /// >>> legs = [stewart.home[stewart.joint_names.index(f"leg{i}")] for i in range(1, 7)]
    /// >>> target = stewart.fk(stewart.home, servo.frame)
    /// >>> bool(abs(servo.step_actuated(legs, target)).max() < 1e-9)
    /// True
    #[pyo3(signature = (actuated, target, feed_forward = None, sensors = None))]
    fn step_actuated<'py>(
        &self,
        py: Python<'py>,
        actuated: Numbers<'py>,
        target: Numbers<'py>,
        feed_forward: Option<Numbers<'py>>,
        #[pyo3(from_py_with = argument)] sensors: Option<BTreeMap<String, f64>>,
    ) -> Result<Array<'py>> {
        let target = moving_target(&target, feed_forward.as_ref())?;
        let running = &mut *self.lock()?;
        let sensors = places(sensors, running.servo.mechanism())?;
        let actuated = actuated.vector("actuated")?;
        running.last = Some(running.servo.step_measured(actuated, &sensors, target)?);
        running.twist = None;
        Ok(arrays::vector(py, running.servo.joint_velocities()))
    }

    /// One step of velocity mode from the positions of the actuated joints alone: `step_twist` for
    /// parallel robots, which measure no others.
    ///
    /// Parameters
    /// ----------
    /// actuated : array_like, (number of actuated joints,)
    ///     Measured positions, in the order of `joint_names`
    ///     [rad or m].
    /// twist : array_like, (6,), optional
    ///     The command that arrived since the last step, linear first, world axes, at the tool [m/s,
    ///     rad/s]. None: no command arrived.
    /// sensors : dict of str to float, optional
    ///     Positions of passive joints that are measured too, by name, as for `step_actuated`.
    ///
    /// Returns
    /// -------
    /// ndarray, (n,)
    ///     Joint velocities [rad/s or m/s].
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError, InvalidOptionError, UnknownNameError
    ///     As `step_actuated`. The state of the servo is unchanged: the command is not taken.
    #[pyo3(signature = (actuated, twist = None, sensors = None))]
    fn step_twist_actuated<'py>(
        &self,
        py: Python<'py>,
        actuated: Numbers<'py>,
        twist: Option<Numbers<'py>>,
        #[pyo3(from_py_with = argument)] sensors: Option<BTreeMap<String, f64>>,
    ) -> Result<Array<'py>> {
        let twist = twist.as_ref().map(|twist| twist.twist("twist")).transpose()?;
        let running = &mut *self.lock()?;
        let sensors = places(sensors, running.servo.mechanism())?;
        let actuated = actuated.vector("actuated")?;
        let step = running.servo.step_twist_measured(actuated, &sensors, twist)?;
        (running.last, running.twist) = (Some(step.step), Some(step));
        Ok(arrays::vector(py, running.servo.joint_velocities()))
    }

    /// Sets the configuration from which `step_actuated` tracks the passive joints; it selects the
    /// assembly mode.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,)
    ///     A configuration with closed loops [rad or m].
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError
    /// InvalidOptionError
    ///     For open loops.
    #[pyo3(signature = (q))]
    fn start_from(&self, q: Coordinates<'_>) -> Result<()> {
        let running = &mut *self.lock()?;
        let q = q.vector(running.servo.mechanism(), "q")?;
        running.servo.start_from(q)?;
        (running.last, running.twist) = (None, None);
        Ok(())
    }

    /// How far the loops of a closed chain are open at `configuration`: rounding, and more near a
    /// type II singularity, where no step closes them; None without loops.
    #[getter]
    fn closure_error(&self) -> Result<Option<PyLoopClosureError>> {
        let servo = &self.lock()?.servo;
        let robot = servo.mechanism();
        if !robot.is_closed() {
            return Ok(None);
        }
        let chain = ClosedChain::of(&robot.state(servo.configuration())?, None, None)?;
        Ok(Some(chain.closure_error.into()))
    }

    /// The configuration of the last step, its loops closed [rad or m], (n,).
    #[getter]
    fn configuration<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        Ok(arrays::vector(py, self.lock()?.servo.configuration()))
    }
}
