//! The class `MotionResult`: the result of a simulated motion.

use cylindroid::Mechanism;
use cylindroid::control::MotionResult;
use pyo3::prelude::*;

use super::{PyStall, PyTrajectory};
use crate::arrays::{self, Array};
use crate::table::{self, Table};

/// The result of a simulated motion of a servo.
///
/// Attributes
/// ----------
/// reached : bool
///     True if the target was reached within tolerance.
/// reason : str
///     'reached', the name of the stall, or 'time-limit'.
/// stall : Stall or None
///     The reason of a stall, if there was one.
/// q : ndarray, (n,)
///     The last configuration [rad or m].
/// position_error, orientation_error : float
///     At the end (m, rad).
/// steps : int
/// time : float
///     Duration (s).
/// largest_lag : float
///     The largest time that the tool was behind a moving target (s).
/// min_singular_ratio : float
///     Smallest ratio of singular values during the motion.
/// limits_hit : list of (str, str)
///     Joints whose limits bounded a velocity during the motion, and their kinds.
/// no_inverse : str or None
///     The reason why the requested inverse did not exist, at its first occurrence.
/// steps_without_inverse : int
///     Number of steps in which it did not exist.
/// trajectory : Trajectory or None
///     Every step, if recorded.
#[pyclass(frozen, name = "MotionResult", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyMotionResult {
    pub(super) outcome: MotionResult,
    pub(super) trajectory: Option<Py<PyTrajectory>>,
    pub(super) mechanism: Mechanism,
}

#[pymethods]
impl PyMotionResult {
    #[getter]
    fn reached(&self) -> bool {
        self.outcome.reached
    }

    #[getter]
    fn reason(&self) -> &'static str {
        match &self.outcome.stall {
            _ if self.outcome.reached => "reached",
            Some(stall) => stall.name(),
            None => "time-limit",
        }
    }

    #[getter]
    fn stall(&self) -> Option<PyStall> {
        self.outcome.stall.as_ref().map(|s| PyStall::new(s, &self.mechanism))
    }

    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.outcome.q)
    }

    #[getter]
    fn position_error(&self) -> f64 {
        self.outcome.last.position_error
    }

    #[getter]
    fn orientation_error(&self) -> f64 {
        self.outcome.last.orientation_error
    }

    #[getter]
    fn steps(&self) -> usize {
        self.outcome.steps
    }

    #[getter]
    fn time(&self) -> f64 {
        self.outcome.time
    }

    #[getter]
    fn largest_lag(&self) -> f64 {
        self.outcome.largest_lag
    }

    #[getter]
    fn min_singular_ratio(&self) -> f64 {
        self.outcome.min_singular_ratio
    }

    #[getter]
    fn limits_hit(&self) -> Vec<(String, &'static str)> {
        let name = |i: usize| self.mechanism.coordinates()[i].name.clone();
        self.outcome.limits_hit.iter().map(|(i, kind)| (name(*i), kind.name())).collect()
    }

    #[getter]
    fn no_inverse(&self) -> Option<String> {
        self.outcome.no_inverse.map(|r| r.to_string())
    }

    #[getter]
    fn steps_without_inverse(&self) -> usize {
        self.outcome.steps_without_inverse
    }

    #[getter]
    fn trajectory(&self, py: Python<'_>) -> Option<Py<PyTrajectory>> {
        self.trajectory.as_ref().map(|t| t.clone_ref(py))
    }
}

table::shown!(PyMotionResult);

impl PyMotionResult {
    fn table(&self) -> Table {
        let o = &self.outcome;
        let mut table = Table::new(&format!("Motion of '{}'", self.mechanism.name()));
        table.row("reached", if o.reached { "yes" } else { "no" });
        if let Some(stall) = self.stall() {
            table.row("stall", format!("{}: {}", stall.name, stall.message));
        } else if !o.reached {
            table.row("reason", "time-limit");
        }
        let number = table::number;
        table.row(
            "errors",
            format!(
                "{} m, {} rad",
                number(o.last.position_error),
                number(o.last.orientation_error)
            ),
        );
        table.row("time", format!("{} s, {} steps", number(o.time), o.steps));
        table.row("singular ratio", format!("{} at the least", number(o.min_singular_ratio)));
        let limits: Vec<String> =
            self.limits_hit().iter().map(|(joint, kind)| format!("{joint} ({kind})")).collect();
        table.row("limits", table::names(&limits));
        if let Some(reason) = self.no_inverse() {
            table.row("no inverse", format!("{} steps: {reason}", o.steps_without_inverse));
        }
        table.row("q", table::list(&o.q));
        table
    }
}
