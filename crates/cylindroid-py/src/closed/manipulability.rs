//! The class `Manipulability`: kinematic and force efficiencies.

use cylindroid::Error;
use cylindroid::linalg::Metric;
use cylindroid::manipulability::{Index, Manipulability, Spectrum, internal_force_manipulability};
use pyo3::prelude::*;
use pyo3::types::PyList;

use super::metrics::{JointMetric, Question};
use super::object::object;
use super::{PyConstraint, PySpectrum};
use crate::arrays::{self, Array, Numbers};
use crate::coordinates::Coordinates;
use crate::error::{Result, argument};
use crate::mechanism::PyMechanism;
use crate::table::{self, Table};

/// Manipulability: kinematic and force efficiencies between the actuated joints and the object.
///
/// Attributes
/// ----------
/// kinematic : Spectrum
///     Twists of the object per velocity of the actuated joints: zero for redundant motions,
///     infinite for motions that the actuators do not control.
/// active_force : Spectrum
///     Wrenches exerted per torque of the actuated joints: zero for internal torques.
/// passive_force : Spectrum
///     Wrenches resisted per torque: infinite for those resisted by the structure alone.
/// internal_force : Spectrum
///     Forces in loops and contacts without a wrench on the object, per torque of the actuated
///     joints: what they can squeeze. `object` of a direction is a force for each row of the
///     constraint (`Constraint.matrix`); infinite are hyperstatic forces.
/// metric : str
///     The preset of metrics: 'unit', 'length' or 'limits'.
/// actuated, components : list of str
///     Names of the entries of directions.
#[pyclass(frozen, name = "Manipulability", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyManipulability {
    inner: Manipulability,
    internal_force: Spectrum,
    name: String,
    metric: String,
    actuated: Vec<String>,
    components: Vec<String>,
}

impl PyManipulability {
    fn spectrum(&self, inner: Spectrum, what: &'static str) -> PySpectrum {
        PySpectrum { inner, what, components: self.components.clone() }
    }

    fn of(constraint: &PyConstraint, question: &Question) -> Result<Self> {
        let relation = constraint.relation(question.map.as_ref())?;
        let metrics = question.metrics(constraint)?;
        let torque = metrics.torque.clone().or_else(|| metrics.joint.as_ref().map(Metric::dual));
        let force = question.contact_metric(constraint)?;
        let bare = &constraint.inner;
        Ok(Self {
            inner: Manipulability::of(&relation, &metrics)?,
            internal_force: internal_force_manipulability(bare, torque.as_ref(), force.as_ref())?,
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
        self.spectrum(self.inner.kinematic.clone(), "kinematic")
    }

    #[getter]
    fn active_force(&self) -> PySpectrum {
        self.spectrum(self.inner.active_force(), "active force")
    }

    #[getter]
    fn passive_force(&self) -> PySpectrum {
        self.spectrum(self.inner.passive_force(), "passive force")
    }

    #[getter]
    fn internal_force(&self) -> PySpectrum {
        let components = (1..=self.internal_force.infinite.rows()).map(|i| format!("t{i}"));
        PySpectrum {
            inner: self.internal_force.clone(),
            what: "internal force",
            components: components.collect(),
        }
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

    /// The efficiencies of a manipulability index, largest first, including infinities and zeros.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     'kinematic', 'active-kinematic' (given joint velocities), 'passive-kinematic' (given
    ///     twist), 'force', 'active-force' (given torques) or 'passive-force' (given wrench).
    ///
    /// Returns
    /// -------
    /// ndarray, (k,)
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    ///     For an unknown index.
    #[pyo3(signature = (name))]
    fn index<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = argument)] name: &str,
    ) -> Result<Array<'py>> {
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
        let mut all = vec![self.kinematic(), self.active_force(), self.passive_force()];
        let internal = self.internal_force();
        if internal.inner.finite.len() + internal.inner.infinite.cols() > 0 {
            all.push(internal);
        }
        for spectrum in all {
            table.row(spectrum.what, spectrum.words());
        }
        table
    }
}

#[pymethods]
impl PyConstraint {
    /// Manipulability: kinematic and force efficiencies between the actuated joints and the object.
    ///
    /// Parameters
    /// ----------
    /// task, Wu, Wq, Ww, Wtau, Wt, metric
    ///     As for `Mechanism.manipulability`.
    ///
    /// Returns
    /// -------
    /// Manipulability
    #[pyo3(signature = (task = None, Wu = None, Wq = None, Ww = None, Wtau = None,
        Wt = None, metric = "unit"))]
    #[expect(non_snake_case, reason = "the field's names")]
    #[expect(clippy::too_many_arguments, reason = "they have names in Python")]
    fn manipulability(
        &self,
        py: Python<'_>,
        task: Option<Bound<'_, PyAny>>,
        Wu: Option<Numbers<'_>>,
        #[pyo3(from_py_with = argument)] Wq: Option<JointMetric<'_>>,
        Ww: Option<Numbers<'_>>,
        Wtau: Option<Numbers<'_>>,
        Wt: Option<Numbers<'_>>,
        #[pyo3(from_py_with = argument)] metric: &str,
    ) -> Result<PyManipulability> {
        let joints = JointMetric::numbers(Wq.as_ref());
        let weights = [Wu.as_ref(), joints, Ww.as_ref(), Wtau.as_ref()];
        let question = Question::about(self, task.as_ref(), weights, metric)?;
        let question = question.with_joint_metric(Wq.as_ref())?;
        let question = question.with_contact_metric(Wt.as_ref())?;
        py.detach(|| PyManipulability::of(self, &question))
    }
}

#[pymethods]
impl PyMechanism {
    /// Manipulability (Yoshikawa; closed chains: Bicchi and Prattichizzo) of the reference frame:
    /// kinematic and force efficiencies along principal directions.
    ///
    /// An efficiency is the squared ratio of output to input: zero if there is no output, infinite
    /// if there is output without input.
    ///
    /// Parameters
    /// ----------
    /// q, actuated, reference
    ///     As for `constraint`.
    /// task : str, list of str or array_like, (k, d), optional
    ///     Components of the twist that form the task ('x,y'), or a linear map of the twist.
    ///     Default: all.
    /// Wu, Wq, Ww, Wtau : array_like, square or their diagonals, optional
    ///     Metrics of twists (or the task), joint velocities, wrenches and torques, symmetric and
    ///     positive definite. Defaults: the preset `metric`; the duals for wrenches and torques.
    ///     Wq = 'inertia': twice the kinetic energy of the mechanism (`actuated_inertia`).
    /// Wt : array_like, (t,) or (t, t), optional
    ///     Metric of the forces of the rows of the constraint, for `internal_force`; a compliance
    ///     measures them by twice their elastic energy. Default: the identity, with the preset
    ///     'unit'; otherwise moments are divided by the characteristic length.
    /// metric : str
    ///     'unit' (m and rad, unscaled), 'length' (lengths divided by the characteristic length),
    ///     'limits' (as 'length', with joint velocities divided by their limits).
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
    /// Bicchi and Prattichizzo 1998. For a serial arm, the kinematic efficiencies are the squared
    /// singular values of its Jacobian (Yoshikawa 1985).
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> k = cy.load("five-bar").manipulability(task="x,y").kinematic
    /// >>> len(k.finite), k.zeros, k.infinite
    /// (2, 0, 0)
    #[pyo3(signature = (q = None, actuated = None, reference = None, task = None, Wu = None,
        Wq = None, Ww = None, Wtau = None, Wt = None, metric = "unit", length = None))]
    #[expect(non_snake_case, reason = "the field's names")]
    #[expect(clippy::too_many_arguments, reason = "they have names in Python")]
    fn manipulability<'py>(
        &self,
        py: Python<'py>,
        q: Option<Coordinates<'py>>,
        #[pyo3(from_py_with = argument)] actuated: Option<Vec<String>>,
        #[pyo3(from_py_with = argument)] reference: Option<&str>,
        #[pyo3(from_py_with = argument)] task: Option<Bound<'py, PyAny>>,
        Wu: Option<Numbers<'py>>,
        #[pyo3(from_py_with = argument)] Wq: Option<JointMetric<'py>>,
        Ww: Option<Numbers<'py>>,
        Wtau: Option<Numbers<'py>>,
        Wt: Option<Numbers<'py>>,
        #[pyo3(from_py_with = argument)] metric: &str,
        #[pyo3(from_py_with = argument)] length: Option<f64>,
    ) -> Result<Bound<'py, PyAny>> {
        let all = self.constraints(py, q.as_ref(), actuated.as_deref(), reference, length)?;
        let Some(like) = all.as_slice().first() else {
            return Ok(PyList::empty(py).into_any());
        };
        let joints = JointMetric::numbers(Wq.as_ref());
        let weights = [Wu.as_ref(), joints, Ww.as_ref(), Wtau.as_ref()];
        let question = Question::about(like, task.as_ref(), weights, metric)?;
        let question = question.with_joint_metric(Wq.as_ref())?;
        let question = question.with_contact_metric(Wt.as_ref())?;
        let reports = py.detach(|| all.try_map(|c| PyManipulability::of(c, &question)))?;
        Ok(object(py, reports)?)
    }
}
