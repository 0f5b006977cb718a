//! The class `Stall`: the reason why a servo makes no progress.

use cylindroid::Mechanism;
use cylindroid::control::Stall;
use pyo3::prelude::*;

use crate::arrays::{self, Array};
use crate::table;

/// A stall: the reason why a servo makes no progress towards its target.
///
/// Attributes
/// ----------
/// name : str
///     'out-of-reach', 'limits', 'singular', 'too-few-joints', 'no-inverse', 'projected',
///     'type-ii' or 'slow'.
/// message : str
///     An explanation, with values.
/// joints : list of str
///     The joints at their limits.
/// direction : ndarray or None
///     The remaining error (or the uncontrolled motion) as a unit vector in the task.
/// distance, length : float or None
///     For 'out-of-reach': the distance from the first joint to the target, and the length of the
///     stretched chain from there (m).
#[pyclass(frozen, name = "Stall", module = "cylindroid")]
#[derive(Debug, Clone)]
pub(crate) struct PyStall {
    #[pyo3(get)]
    pub(super) name: &'static str,
    #[pyo3(get)]
    pub(super) message: String,
    #[pyo3(get)]
    joints: Vec<String>,
    direction: Option<Vec<f64>>,
    #[pyo3(get)]
    distance: Option<f64>,
    #[pyo3(get)]
    length: Option<f64>,
}

#[pymethods]
impl PyStall {
    #[getter]
    fn direction<'py>(&self, py: Python<'py>) -> Option<Array<'py>> {
        self.direction.as_ref().map(|d| arrays::vector(py, d))
    }

    fn __repr__(&self) -> String {
        format!("Stall('{}': {})", self.name, self.message)
    }
}

impl PyStall {
    pub(super) fn new(stall: &Stall, mechanism: &Mechanism) -> Self {
        let mut new = Self {
            name: stall.name(),
            message: String::new(),
            joints: Vec::new(),
            direction: None,
            distance: None,
            length: None,
        };
        let number = table::number;
        new.message = match stall {
            Stall::OutOfReach { distance, length } => {
                (new.distance, new.length) = (Some(*distance), Some(*length));
                format!(
                    "the target is {} m from the first joint, the stretched arm {} m long",
                    number(*distance),
                    number(*length)
                )
            }
            Stall::Limits { coordinates } => {
                let name = |i: &usize| mechanism.coordinates()[*i].name.clone();
                new.joints = coordinates.iter().map(name).collect();
                format!("at the limit of {}", new.joints.join(", "))
            }
            Stall::Singular { ratio, direction } => {
                new.direction = Some(direction.clone());
                format!(
                    "a singular configuration: smallest singular value {} of the largest",
                    number(*ratio)
                )
            }
            Stall::TooFewJoints { rank, task, direction } => {
                new.direction = Some(direction.clone());
                format!("{rank} independent motions for a task of {task} components")
            }
            Stall::NoInverse(reason) => format!("the inverse does not exist here: {reason}"),
            Stall::Projected { direction } => {
                new.direction = Some(direction.clone());
                "the remaining error is the component discarded by the inverse".into()
            }
            Stall::TypeII { share, direction } => {
                new.direction = Some(direction.clone());
                format!(
                    "a type II singularity is near: the actuated share of the object's weakest \
                     motion is {}",
                    number(*share)
                )
            }
            Stall::Slow => {
                "no progress for a second, with neither limits nor a singular configuration: \
                            use less damping, a higher gain or speed"
                    .into()
            }
        };
        new
    }
}
