//! The class `CollisionAvoidance`: distances that a servo or inverse kinematics keeps.

use cylindroid::control::CollisionAvoidance;
use pyo3::prelude::*;

use crate::collision::PyCollisionModel;
use crate::error::{Result, argument};

/// Distances that a `TaskServo` or `Mechanism.ik` keeps between bodies and to obstacles.
///
/// Parameters
/// ----------
/// model : CollisionModel
///     The watched pairs. The servo reads the model in every step: obstacles may be added, moved and
///     removed while it runs.
/// gap : float
///     Least distance [m].
/// margin : float
///     Only pairs closer than this count [m], and of these the 64 closest. It must leave room to
///     brake; inverse kinematics does not use it.
///
/// Attributes
/// ----------
/// model : CollisionModel
/// gap : float
/// margin : float
///
/// Raises
/// ------
/// InvalidOptionError
///     For a negative gap, or a margin that is not above it.
#[pyclass(frozen, name = "CollisionAvoidance", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyCollisionAvoidance {
    #[pyo3(get)]
    pub(crate) model: Py<PyCollisionModel>,
    #[pyo3(get)]
    pub(crate) gap: f64,
    #[pyo3(get)]
    pub(super) margin: f64,
}

#[pymethods]
impl PyCollisionAvoidance {
    #[new]
    #[pyo3(signature = (model, *, gap = 0.01, margin = 0.3))]
    fn new(
        #[pyo3(from_py_with = argument)] model: Py<PyCollisionModel>,
        #[pyo3(from_py_with = argument)] gap: f64,
        #[pyo3(from_py_with = argument)] margin: f64,
    ) -> Result<Self> {
        CollisionAvoidance::check_distances(gap, margin)?;
        Ok(Self { model, gap, margin })
    }

    fn __repr__(&self) -> String {
        format!("<CollisionAvoidance: gap {} m, margin {} m>", self.gap, self.margin)
    }
}
