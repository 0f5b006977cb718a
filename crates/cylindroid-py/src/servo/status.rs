//! Attributes of a servo after a step.

use cylindroid::control::Status;
use pyo3::prelude::*;

use super::{PyServo, PyStall};
use crate::arrays::{self, Array};
use crate::error::Result;

fn status_name(status: Status) -> &'static str {
    match status {
        Status::Moving => "moving",
        Status::Reached => "reached",
        Status::Stalled => "stalled",
    }
}

#[pymethods]
impl PyServo {
    #[getter]
    fn status(&self) -> Option<&'static str> {
        self.last.map(|s| status_name(s.status))
    }

    #[getter]
    fn stall(&self) -> Option<PyStall> {
        let stalled = self.last.is_some_and(|s| s.status == Status::Stalled);
        stalled.then(|| PyStall::new(&self.inner.stall(), self.inner.mechanism()))
    }

    #[getter]
    fn pose<'py>(&self, py: Python<'py>) -> Result<Option<Array<'py>>> {
        self.last.map(|s| arrays::pose(py, s.pose)).transpose()
    }

    #[getter]
    fn position_error(&self) -> f64 {
        self.last.map_or(f64::NAN, |s| s.position_error)
    }

    #[getter]
    fn orientation_error(&self) -> f64 {
        self.last.map_or(f64::NAN, |s| s.orientation_error)
    }

    #[getter]
    fn singular_ratio(&self) -> f64 {
        self.last.map_or(f64::NAN, |s| s.singular_ratio)
    }

    #[getter]
    fn rank(&self) -> usize {
        self.last.map_or(0, |s| s.rank)
    }

    #[getter]
    fn scale(&self) -> f64 {
        self.last.map_or(f64::NAN, |s| s.saturation.scale)
    }

    #[getter]
    fn direction_lost(&self) -> bool {
        self.last.is_some_and(|s| s.saturation.direction_lost)
    }

    #[getter]
    fn joint_velocities<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, self.inner.joint_velocities())
    }

    #[getter]
    fn loop_closure_velocities<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, self.inner.loop_closure_velocities())
    }

    #[getter]
    fn active_limits(&self) -> Vec<(String, &'static str)> {
        let coordinates = self.inner.mechanism().coordinates();
        let named = |(i, kind): (usize, cylindroid::control::LimitKind)| {
            (coordinates[i].name.clone(), kind.name())
        };
        self.inner.active_limits().map(named).collect()
    }

    #[getter]
    fn no_inverse(&self) -> Option<String> {
        self.inner.no_inverse().map(|r| r.to_string())
    }

    #[getter]
    fn frame(&self) -> &str {
        &self.inner.mechanism().frame_of(self.inner.options().end_effector.frame).name
    }

    #[getter]
    fn dt(&self) -> f64 {
        self.inner.options().dt
    }

    fn __repr__(&self) -> String {
        let options = self.inner.options();
        let mut text = format!(
            "<Servo of '{}', frame '{}', inverse {}, dt {} s",
            self.inner.mechanism().name(),
            self.frame(),
            match options.projection {
                cylindroid::control::TaskProjection::Orthogonal => options.method.name(),
                ref projection => projection.name(),
            },
            options.dt
        );
        if let Some(status) = self.status() {
            text.push_str(&format!(", {status}"));
        }
        text.push('>');
        text
    }
}
