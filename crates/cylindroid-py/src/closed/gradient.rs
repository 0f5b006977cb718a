//! The class `Gradient`: the gradient of a manipulability measure.

use cylindroid::Error;
use cylindroid::manipulability::{Goal, Gradient, Measure, gradient};
use pyo3::prelude::*;

use super::PyConstraint;
use super::metrics::Question;
use crate::arrays::{self, Array, Many, Numbers};
use crate::coordinates::Coordinates;
use crate::error::{Failure, Result, argument};
use crate::mechanism::PyMechanism;
use crate::table;

/// The gradient of a manipulability measure with respect to the configuration.
///
/// Attributes
/// ----------
/// exists : bool
///     False if efficiencies are equal and the measure has a kink, or if there are none.
/// value : float or None
///     The measure; None if no efficiency is finite.
/// gradient : ndarray, (n,), or None
///     An entry for each coordinate; of a mechanism with loops it lies along their motions.
/// error : float
///     Upper estimate of the error of a slope: zero for trees (rounding only).
/// multiplicity : int
///     Number of equal efficiencies: 1 if the gradient exists.
#[pyclass(frozen, name = "Gradient", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyGradient {
    inner: Gradient,
}

#[pymethods]
impl PyGradient {
    #[getter]
    fn exists(&self) -> bool {
        matches!(self.inner, Gradient::Exists { .. })
    }

    #[getter]
    fn value(&self) -> Option<f64> {
        match self.inner {
            Gradient::Exists { value, .. } | Gradient::Repeated { value, .. } => Some(value),
            Gradient::Nothing => None,
        }
    }

    #[getter]
    fn gradient<'py>(&self, py: Python<'py>) -> Option<Array<'py>> {
        match &self.inner {
            Gradient::Exists { gradient, .. } => Some(arrays::vector(py, gradient)),
            _ => None,
        }
    }

    #[getter]
    fn error(&self) -> f64 {
        if let Gradient::Exists { error, .. } = self.inner { error } else { f64::NAN }
    }

    #[getter]
    fn multiplicity(&self) -> usize {
        match self.inner {
            Gradient::Exists { .. } => 1,
            Gradient::Repeated { multiplicity, .. } => multiplicity,
            Gradient::Nothing => 0,
        }
    }

    fn __repr__(&self) -> String {
        match &self.inner {
            Gradient::Exists { value, gradient, .. } => format!(
                "Gradient(value={}, gradient={})",
                table::number(*value),
                table::list(gradient)
            ),
            Gradient::Repeated { value, multiplicity } => format!(
                "<Gradient: none, {multiplicity} efficiencies meet at {}>",
                table::number(*value)
            ),
            Gradient::Nothing => "<Gradient: none, no finite efficiency>".to_owned(),
        }
    }
}

impl PyGradient {
    fn of(
        py: Python<'_>,
        constraint: &PyConstraint,
        measure: &str,
        task: Option<&Bound<'_, PyAny>>,
        weights: [Option<&Numbers<'_>>; 4],
        metric: &str,
    ) -> Result<Self> {
        let Some(measure) = Measure::ALL.into_iter().find(|m| m.name() == measure) else {
            let known = Measure::ALL.iter().map(|m| m.name());
            return Err(Error::unknown("measure", measure, known).into());
        };
        let Some(origin) = &constraint.origin else {
            return Err(Failure::option("measure", measure.name(), "bare matrices do not move"));
        };
        let question = Question::about(constraint, task, weights, metric)?;
        let metrics = question.metrics(constraint)?;
        let goal = Goal { reference: Some(origin.reference), task: question.map.as_ref() };
        let inner = py.detach(|| gradient(&origin.state, goal, &metrics, measure))?;
        Ok(Self { inner })
    }
}

#[pymethods]
impl PyMechanism {
    /// The gradient of a manipulability measure with respect to the configuration.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,), optional
    ///     Default: home.
    /// measure : str
    ///     'volume' (of a serial arm Yoshikawa's), 'smallest', 'largest' or 'anisotropy'.
    /// actuated, reference
    ///     As `constraint`.
    /// task, Wu, Wq, metric
    ///     As `manipulability`; the metrics stay while q changes.
    ///
    /// Returns
    /// -------
    /// Gradient
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError, UnknownNameError, InvalidOptionError, ModelError
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> panda = cy.load("panda")
    /// >>> panda.manipulability_gradient(panda.home, "volume").gradient.shape
    /// (7,)
    #[pyo3(signature = (q = None, measure = "volume", actuated = None, reference = None,
        task = None, Wu = None, Wq = None, metric = "unit"))]
    #[expect(non_snake_case, reason = "the field's names")]
    #[expect(clippy::too_many_arguments, reason = "they have names in Python")]
    fn manipulability_gradient(
        &self,
        py: Python<'_>,
        q: Option<Coordinates<'_>>,
        #[pyo3(from_py_with = argument)] measure: &str,
        #[pyo3(from_py_with = argument)] actuated: Option<Vec<String>>,
        #[pyo3(from_py_with = argument)] reference: Option<&str>,
        task: Option<Bound<'_, PyAny>>,
        Wu: Option<Numbers<'_>>,
        Wq: Option<Numbers<'_>>,
        #[pyo3(from_py_with = argument)] metric: &str,
    ) -> Result<PyGradient> {
        let weights = [Wu.as_ref(), Wq.as_ref(), None, None];
        match self.constraints(py, q.as_ref(), actuated.as_deref(), reference, None)? {
            Many::One(c) => PyGradient::of(py, &c, measure, task.as_ref(), weights, metric),
            Many::All(_) => Err(Failure::option("q", "a batch", "give one configuration, (n,)")),
        }
    }
}
