//! The class `Manipulability`: efficiencies of motion and force.

use cylindroid::Error;
use cylindroid::manipulability::{Index, Manipulability};
use pyo3::prelude::*;
use pyo3::types::PyList;

use super::metrics::Question;
use super::object::object;
use super::{PyConstraint, PySpectrum};
use crate::arrays::{self, Array, Numbers};
use crate::error::Result;
use crate::mechanism::PyMechanism;
use crate::table::{self, Table};

/// How well motion and force go from the actuated joints to the object.
///
/// Attributes
/// ----------
/// kinematic : Spectrum
///     Motions of the object for velocities of the actuated joints: zeros are redundant motions,
///     infinite ones motions that the actuators do not control.
/// active_force : Spectrum
///     Forces exerted: wrenches for torques; zeros are internal torques.
/// passive_force : Spectrum
///     Forces resisted: infinite ones are wrenches that the structure resists.
/// metric : str
/// actuated, components : list of str
///     Names of the entries of directions.
#[pyclass(frozen, name = "Manipulability", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyManipulability {
    inner: Manipulability,
    name: String,
    metric: String,
    actuated: Vec<String>,
    components: Vec<String>,
}

impl PyManipulability {
    fn of(constraint: &PyConstraint, question: &Question) -> Result<Self> {
        let relation = constraint.relation(question.map.as_ref())?;
        Ok(Self {
            inner: Manipulability::of(&relation, &question.metrics(constraint)?)?,
            name: constraint.name(),
            metric: question.preset.clone(),
            actuated: constraint.actuated.clone(),
            components: question.components.clone(),
        })
    }
}

#[pymethods]
impl PyManipulability {
    #[getter]
    fn kinematic(&self) -> PySpectrum {
        PySpectrum { inner: self.inner.kinematic.clone(), what: "kinematic" }
    }

    #[getter]
    fn active_force(&self) -> PySpectrum {
        PySpectrum { inner: self.inner.active_force(), what: "active force" }
    }

    #[getter]
    fn passive_force(&self) -> PySpectrum {
        PySpectrum { inner: self.inner.passive_force(), what: "passive force" }
    }

    #[getter]
    fn metric(&self) -> &str {
        &self.metric
    }

    #[getter]
    fn actuated(&self) -> Vec<String> {
        self.actuated.clone()
    }

    #[getter]
    fn components(&self) -> Vec<String> {
        self.components.clone()
    }

    /// The efficiencies that count for an index, largest first, infinities and zeros included.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     'kinematic', 'active-kinematic' (joint velocities given), 'passive-kinematic' (twist
    ///     given), 'force', 'active-force' (torques given) or 'passive-force' (wrench given).
    ///
    /// Returns
    /// -------
    /// ndarray, (k,)
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    #[pyo3(signature = (name))]
    fn index<'py>(&self, py: Python<'py>, name: &str) -> Result<Array<'py>> {
        let Some(index) = Index::ALL.iter().find(|i| i.name() == name) else {
            let known = Index::ALL.iter().map(Index::name);
            return Err(Error::unknown("index", name, known).into());
        };
        Ok(arrays::vector(py, &index.values(&self.inner)))
    }
}

table::shown!(PyManipulability);

impl PyManipulability {
    fn table(&self) -> Table {
        let mut table = Table::new(&format!("Manipulability of {}", self.name));
        table.row("metric", &self.metric);
        table.row("actuated", table::names(&self.actuated));
        table.row("object", table::names(&self.components));
        for spectrum in [self.kinematic(), self.active_force(), self.passive_force()] {
            table.row(spectrum.what, spectrum.words());
        }
        table
    }
}

#[pymethods]
impl PyConstraint {
    /// How well motion and force go from the actuated joints to the object.
    ///
    /// Parameters
    /// ----------
    /// task, Wu, Wq, Ww, Wtau, metric
    ///     As `Mechanism.manipulability`.
    ///
    /// Returns
    /// -------
    /// Manipulability
    #[pyo3(signature = (task = None, Wu = None, Wq = None, Ww = None, Wtau = None,
        metric = "unit"))]
    #[expect(non_snake_case, reason = "the field's names")]
    #[expect(clippy::too_many_arguments, reason = "they have names in Python")]
    fn manipulability(
        &self,
        py: Python<'_>,
        task: Option<Bound<'_, PyAny>>,
        Wu: Option<Numbers<'_>>,
        Wq: Option<Numbers<'_>>,
        Ww: Option<Numbers<'_>>,
        Wtau: Option<Numbers<'_>>,
        metric: &str,
    ) -> Result<PyManipulability> {
        let weights = [&Wu, &Wq, &Ww, &Wtau].map(Option::as_ref);
        let question = Question::about(self, task.as_ref(), weights, metric)?;
        py.detach(|| PyManipulability::of(self, &question))
    }
}

#[pymethods]
impl PyMechanism {
    /// How well motion and force go from the actuated joints to the reference frame.
    ///
    /// Efficiencies are squares of output over input along principal directions. Zero: nothing
    /// comes out; infinite: without any input.
    ///
    /// Parameters
    /// ----------
    /// q, actuated, reference
    ///     As `constraint`.
    /// task : str, list of str or array_like, (k, d), optional
    ///     Components of the twist that matter ('x,y'), or a map on it.
    /// Wu, Wq, Ww, Wtau : array_like, square or their diagonals, optional
    ///     Metrics of twists (or the task), joint velocities, wrenches and torques, positive
    ///     definite. Defaults: those of `metric`; wrenches and torques by the duals.
    /// metric : str
    ///     'unit' (m and rad, unscaled), 'length' (lengths over the characteristic length),
    ///     'limits' (as 'length', and joint velocities over their limits).
    /// length : float, optional
    ///     Characteristic length (m). Default: that of the mechanism, `reach`.
    ///
    /// Returns
    /// -------
    /// Manipulability, or list of Manipulability
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError, UnknownNameError, InvalidOptionError, ModelError
    ///
    /// Notes
    /// -----
    /// Bicchi and Prattichizzo 1998. For a serial arm the kinematic efficiencies are the squares
    /// of the singular values of its Jacobian.
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> k = cy.load("five-bar").manipulability(task="x,y").kinematic
    /// >>> len(k.finite), k.zeros, k.infinite
    /// (2, 0, 0)
    #[pyo3(signature = (q = None, actuated = None, reference = None, task = None, Wu = None,
        Wq = None, Ww = None, Wtau = None, metric = "unit", length = None))]
    #[expect(non_snake_case, reason = "the field's names")]
    #[expect(clippy::too_many_arguments, reason = "they have names in Python")]
    fn manipulability<'py>(
        &self,
        py: Python<'py>,
        q: Option<Numbers<'py>>,
        actuated: Option<Vec<String>>,
        reference: Option<&str>,
        task: Option<Bound<'py, PyAny>>,
        Wu: Option<Numbers<'py>>,
        Wq: Option<Numbers<'py>>,
        Ww: Option<Numbers<'py>>,
        Wtau: Option<Numbers<'py>>,
        metric: &str,
        length: Option<f64>,
    ) -> Result<Bound<'py, PyAny>> {
        let all = self.constraints(py, q.as_ref(), actuated.as_deref(), reference, length)?;
        let Some(like) = all.as_slice().first() else {
            return Ok(PyList::empty(py).into_any());
        };
        let weights = [&Wu, &Wq, &Ww, &Wtau].map(Option::as_ref);
        let question = Question::about(like, task.as_ref(), weights, metric)?;
        let reports = py.detach(|| all.try_map(|c| PyManipulability::of(c, &question)))?;
        Ok(object(py, reports)?)
    }
}
