//! Attributes of a servo after a step.

use cylindroid::control::{Status, TwistStatus};
use pyo3::prelude::*;

use super::{PyServo, PyStall, Running};
use crate::arrays::{self, Array};
use crate::error::Result;

#[pymethods]
impl PyServo {
    #[getter]
    fn status(&self) -> Result<Option<&'static str>> {
        let Running { last, twist, .. } = &*self.lock()?;
        let name = || last.map(|s| s.status.name());
        Ok(twist.map(|t| t.status.name()).or_else(name))
    }

    #[getter]
    fn stall(&self) -> Result<Option<PyStall>> {
        let Running { servo, last, twist } = &*self.lock()?;
        let stalled = match twist {
            Some(twist) => twist.status == TwistStatus::Stalled,
            None => last.is_some_and(|s| s.status == Status::Stalled),
        };
        Ok(stalled.then(|| PyStall::new(&servo.stall(), servo.mechanism())))
    }

    #[getter]
    fn achieved_twist<'py>(&self, py: Python<'py>) -> Result<Option<Array<'py>>> {
        let twist = self.lock()?.twist;
        Ok(twist.map(|t| arrays::vector(py, &t.achieved.to_array())))
    }

    #[getter]
    fn timed_out(&self) -> Result<bool> {
        Ok(self.lock()?.twist.is_some_and(|t| t.timed_out))
    }

    #[getter]
    fn pose<'py>(&self, py: Python<'py>) -> Result<Option<Array<'py>>> {
        self.lock()?.last.map(|s| arrays::pose(py, s.pose)).transpose()
    }

    #[getter]
    fn position_error(&self) -> Result<f64> {
        Ok(self.lock()?.last.map_or(f64::NAN, |s| s.position_error))
    }

    #[getter]
    fn orientation_error(&self) -> Result<f64> {
        Ok(self.lock()?.last.map_or(f64::NAN, |s| s.orientation_error))
    }

    #[getter]
    fn lag(&self) -> Result<f64> {
        Ok(self.lock()?.last.map_or(f64::NAN, |s| s.lag))
    }

    #[getter]
    fn singular_ratio(&self) -> Result<f64> {
        Ok(self.lock()?.last.map_or(f64::NAN, |s| s.singular_ratio))
    }

    #[getter]
    fn rank(&self) -> Result<usize> {
        Ok(self.lock()?.last.map_or(0, |s| s.rank))
    }

    #[getter]
    fn scale(&self) -> Result<f64> {
        Ok(self.lock()?.last.map_or(f64::NAN, |s| s.saturation.scale))
    }

    #[getter]
    fn direction_lost(&self) -> Result<bool> {
        Ok(self.lock()?.last.is_some_and(|s| s.saturation.direction_lost))
    }

    #[getter]
    fn joint_velocities<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        Ok(arrays::vector(py, self.lock()?.servo.joint_velocities()))
    }

    #[getter]
    fn loop_closure_velocities<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        Ok(arrays::vector(py, self.lock()?.servo.loop_closure_velocities()))
    }

    #[getter]
    fn active_limits(&self) -> Result<Vec<(String, &'static str)>> {
        let servo = &self.lock()?.servo;
        let coordinates = servo.mechanism().coordinates();
        let named = |(i, kind): (usize, cylindroid::control::LimitKind)| {
            (coordinates[i].name.clone(), kind.name())
        };
        Ok(servo.active_limits().map(named).collect())
    }

    #[getter]
    fn no_inverse(&self) -> Result<Option<String>> {
        Ok(self.lock()?.servo.no_inverse().map(|r| r.to_string()))
    }

    #[getter]
    fn frame(&self) -> Result<String> {
        let servo = &self.lock()?.servo;
        Ok(servo.mechanism().frame_of(servo.options().end_effector.frame).name.clone())
    }

    #[getter]
    fn dt(&self) -> Result<f64> {
        Ok(self.lock()?.servo.options().dt)
    }

    fn __repr__(&self) -> Result<String> {
        let Running { servo, last, twist } = &*self.lock()?;
        let options = servo.options();
        let mut text = format!(
            "<Servo of '{}', frame '{}', inverse {}, dt {} s",
            servo.mechanism().name(),
            servo.mechanism().frame_of(options.end_effector.frame).name,
            match options.projection {
                cylindroid::control::TaskProjection::Orthogonal => options.method.name(),
                ref projection => projection.name(),
            },
            options.dt
        );
        let name = || last.map(|s| s.status.name());
        if let Some(status) = twist.map(|t| t.status.name()).or_else(name) {
            text.push_str(&format!(", {status}"));
        }
        text.push('>');
        Ok(text)
    }
}
