//! The class `Trajectory`: the recorded steps of a simulated motion.

use cylindroid::control::TrajectorySample;
use cylindroid::{Mechanism, Pose};
use pyo3::prelude::*;

use crate::arrays::{self, Array};
use crate::columns::{self, Column, PyColumns};
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
    /// Name and unit of each coordinate.
    coordinates: Vec<(String, &'static str)>,
    time: Vec<f64>,
    q: Vec<f64>,
    joint_velocities: Vec<f64>,
    pose: Vec<Pose>,
    errors: [Vec<f64>; 3],
}

impl PyTrajectory {
    /// An empty trajectory.
    pub(super) fn of(mechanism: &Mechanism) -> Self {
        let about = mechanism.coordinates().iter().map(|c| (c.name.clone(), c.kind.unit()));
        Self { coordinates: about.collect(), ..Self::default() }
    }

    pub(super) fn push(&mut self, sample: &TrajectorySample<'_>) {
        self.time.push(sample.time);
        self.q.extend(sample.q);
        self.joint_velocities.extend(sample.joint_velocities);
        self.pose.push(sample.step.pose);
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
        self.table(py, &self.q, &[self.coordinates.len()])
    }

    #[getter]
    fn joint_velocities<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        self.table(py, &self.joint_velocities, &[self.coordinates.len()])
    }

    #[getter]
    fn pose<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        let poses = self.pose.iter().map(|pose| pose.to_matrix().as_flattened().to_vec());
        self.table(py, &poses.flatten().collect::<Vec<f64>>(), &[4, 4])
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

    /// The steps as columns with names, those of numbers in the file that `cylindroid move --out`
    /// writes.
    ///
    /// Returns
    /// -------
    /// Columns
    ///     `time`, `q.NAME` and `velocity.NAME` of each coordinate, `x y z qw qx qy qz` of the tool
    ///     in the world, `position_error`, `orientation_error`, `singular_ratio`.
    fn columns(&self) -> Result<PyColumns> {
        let width = self.coordinates.len();
        let one = |name: &str, unit, values| Column { name: name.to_owned(), unit, values };
        let named = |kind: &'static str, unit: fn(&str) -> &'static str| {
            let all = self.coordinates.iter();
            all.map(move |(name, of)| (format!("{kind}.{name}"), unit(of)))
        };
        let of_q = named("q", |of| if of == "m" { "m" } else { "rad" });
        let of_rates = named("velocity", |of| if of == "m" { "m/s" } else { "rad/s" });
        let mut all = vec![one("time", "s", self.time.clone())];
        all.extend(columns::transposed(&self.q, width, of_q));
        all.extend(columns::transposed(&self.joint_velocities, width, of_rates));
        let poses = self.pose.iter().flat_map(|pose| {
            let q = pose.rotation.to_quaternion();
            let [x, y, z] = pose.translation.to_array();
            [x, y, z, q.w, q.x, q.y, q.z]
        });
        let places = ["x", "y", "z"].map(|name| (name.to_owned(), "m"));
        let turns = ["qw", "qx", "qy", "qz"].map(|name| (name.to_owned(), "1"));
        let about = places.into_iter().chain(turns);
        all.extend(columns::transposed(&poses.collect::<Vec<f64>>(), 7, about));
        let about =
            [("position_error", "m"), ("orientation_error", "rad"), ("singular_ratio", "1")];
        let errors = about.into_iter().zip(&self.errors);
        all.extend(errors.map(|((name, unit), values)| one(name, unit, values.clone())));
        PyColumns::of(all, self.time.len())
    }

    fn __len__(&self) -> usize {
        self.time.len()
    }

    fn __repr__(&self) -> String {
        let end = self.time.last().copied().unwrap_or(0.0);
        format!("<Trajectory of {} steps, {} s>", self.time.len(), table::number(end))
    }
}
