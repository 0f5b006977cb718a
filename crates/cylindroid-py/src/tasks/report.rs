//! The class `TaskReport`: a task after a step.

use cylindroid::control::{LimitKind, StoppedBy, TaskReport, TaskServo};
use pyo3::prelude::*;

use crate::table::number;

/// A task after a step.
///
/// Attributes
/// ----------
/// name : str
/// status : str
///     'moving', 'reached' or 'stalled'.
/// position_error : float
///     Norm of the error's lengths (m); of desired velocities, of the part that is not realised
///     (m/s).
/// orientation_error : float
///     Norm of the error's angles and of the errors of custom tasks (rad); of desired velocities, of
///     the part that is not realised (rad/s).
/// scale : float
///     Share of its velocity that is realised: 1 when nothing stops it, 0 if its direction is lost.
/// left_out : float
///     Share of the level's velocity that higher levels or singular directions leave out; of
///     postures and velocities, the share that is not realised.
/// limit : (str, str) or None
///     The joint whose limit stops the task, and the kind of the limit: 'position', 'velocity' or
///     'acceleration', 'jerk'.
/// pair : (str, str) or None
///     The links or obstacles whose distance stops the task.
/// half_space : str or None
///     The half-space that stops the task.
/// stopped_by : str or None
///     The limit, the pair, the half-space or the type II singularity, as text.
#[pyclass(frozen, name = "TaskReport", module = "cylindroid")]
#[derive(Debug, Clone)]
pub(crate) struct PyTaskReport {
    #[pyo3(get)]
    pub(super) name: String,
    inner: TaskReport,
    #[pyo3(get)]
    limit: Option<(String, &'static str)>,
    #[pyo3(get)]
    pair: Option<(String, String)>,
    #[pyo3(get)]
    half_space: Option<String>,
}

impl PyTaskReport {
    /// The report of a task of this servo; `pair` names a pair of bodies.
    pub(super) fn new(
        name: &str,
        report: &TaskReport,
        servo: &TaskServo,
        pair: impl Fn(usize) -> (String, String),
    ) -> Self {
        let mut new = Self {
            name: name.to_owned(),
            inner: *report,
            limit: None,
            pair: None,
            half_space: None,
        };
        match report.stopped_by {
            None => {}
            Some(StoppedBy::Limit { coordinate, kind }) => {
                let joint = servo.mechanism().velocity_name(coordinate).to_owned();
                new.limit = Some((joint, LimitKind::name(kind)));
            }
            Some(StoppedBy::Distance { pair: index }) => new.pair = Some(pair(index)),
            Some(StoppedBy::HalfSpace { index }) => {
                new.half_space = Some(servo.half_spaces()[index].name.clone());
            }
            Some(StoppedBy::TypeII) => {}
        }
        new
    }
}

#[pymethods]
impl PyTaskReport {
    #[getter]
    fn status(&self) -> &'static str {
        self.inner.status.name()
    }

    #[getter]
    fn position_error(&self) -> f64 {
        self.inner.position_error
    }

    #[getter]
    fn orientation_error(&self) -> f64 {
        self.inner.orientation_error
    }

    #[getter]
    fn scale(&self) -> f64 {
        self.inner.scale
    }

    #[getter]
    fn left_out(&self) -> f64 {
        self.inner.left_out
    }

    #[getter]
    fn stopped_by(&self) -> Option<String> {
        if let Some((joint, kind)) = &self.limit {
            return Some(format!("{kind} limit of '{joint}'"));
        }
        if let Some(name) = &self.half_space {
            return Some(format!("half-space '{name}'"));
        }
        if self.inner.stopped_by == Some(StoppedBy::TypeII) {
            return Some("type II singularity that is near".to_owned());
        }
        self.pair.as_ref().map(|(a, b)| format!("distance of '{a}' and '{b}'"))
    }

    fn __repr__(&self) -> String {
        let mut text = format!(
            "<TaskReport '{}': {}, {} m, {} rad",
            self.name,
            self.status(),
            number(self.inner.position_error),
            number(self.inner.orientation_error)
        );
        if let Some(cause) = self.stopped_by() {
            text.push_str(&format!(", stopped by the {cause}"));
        }
        text.push('>');
        text
    }
}
