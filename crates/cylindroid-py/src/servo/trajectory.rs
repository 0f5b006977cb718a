//! The class `Trajectory`: the recorded steps of a simulated motion.

use cylindroid::control::TrajectorySample;
use pyo3::prelude::*;

use crate::arrays::{self, Array};
use crate::error::Result;
use crate::table;

/// The recorded trajectory of a simulated motion: configuration, velocities, pose and errors of
/// each step.
///
/// Attributes
/// ----------
/// time : ndarray, (S,)
///     Time since the start (s).
/// q : ndarray, (S, n)
///     The configuration before each step [rad or m].
/// joint_velocities : ndarray, (S, n)
///     The joint velocities commanded by each step [rad/s or m/s].
/// pose : ndarray, (S, 4, 4)
///     `world_from_tool` before each step (m).
/// position_error, orientation_error : ndarray, (S,)
///     Errors before each step, in the components of the task (m, rad).
/// singular_ratio : ndarray, (S,)
///     Smallest singular value of the scaled task Jacobian over the largest.
#[pyclass(frozen, name = "Trajectory", module = "cylindroid")]
#[derive(Debug, Default)]
pub(crate) struct PyTrajectory {
    n: usize,
    time: Vec<f64>,
    q: Vec<f64>,
    joint_velocities: Vec<f64>,
    pose: Vec<f64>,
    errors: [Vec<f64>; 3],
}

impl PyTrajectory {
    /// An empty trajectory of `n` coordinates.
    pub(super) fn of(n: usize) -> Self {
        Self { n, ..Self::default() }
    }

    pub(super) fn push(&mut self, sample: &TrajectorySample<'_>) {
        self.time.push(sample.time);
        self.q.extend(sample.q);
        self.joint_velocities.extend(sample.joint_velocities);
        self.pose.extend(sample.step.pose.to_matrix().as_flattened());
        let s = sample.step;
        let values = [s.position_error, s.orientation_error, s.singular_ratio];
        self.errors.iter_mut().zip(values).for_each(|(all, x)| all.push(x));
    }

    fn table<'py>(&self, py: Python<'py>, values: &[f64], shape: &[usize]) -> Result<Array<'py>> {
        arrays::written(py, Some(self.time.len()), shape, |out| out.copy_from_slice(values))
    }
}

#[pymethods]
impl PyTrajectory {
    #[getter]
    fn time<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.time)
    }

    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        self.table(py, &self.q, &[self.n])
    }

    #[getter]
    fn joint_velocities<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        self.table(py, &self.joint_velocities, &[self.n])
    }

    #[getter]
    fn pose<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        self.table(py, &self.pose, &[4, 4])
    }

    #[getter]
    fn position_error<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.errors[0])
    }

    #[getter]
    fn orientation_error<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.errors[1])
    }

    #[getter]
    fn singular_ratio<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.errors[2])
    }

    fn __len__(&self) -> usize {
        self.time.len()
    }

    fn __repr__(&self) -> String {
        let end = self.time.last().copied().unwrap_or(0.0);
        format!("<Trajectory of {} steps, {} s>", self.time.len(), table::number(end))
    }
}
