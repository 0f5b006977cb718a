//! Closed chains: constraint, mobility, manipulability, statics, assembly.
//!
//! A serial arm is a mechanism without loops: the same functions serve it.

mod capability;
mod diagnosis;
mod grasp;
mod mobility;
mod statics;
mod ways;

use cylindroid::closure::{
    Assembly, Blocks, ClosedChain, Constraint, Gap, Motions, Touch, Unit, Units, assemble,
};
use cylindroid::kinematics::State;
use cylindroid::linalg::Metric;
use cylindroid::{Error, FrameId, Matrix, Mechanism};
use pyo3::prelude::*;
use pyo3::types::PyList;
use pyo3::{PyClass, PyClassInitializer};

use crate::arrays::{self, Array, Many, Numbers, Rows};
use crate::error::{Failure, Result};
use crate::mechanism::PyMechanism;
use crate::table::{self, Table};

pub(crate) use capability::{PyDirection, PyGradient, PyManipulability, PyPolytope, PySpectrum};
pub(crate) use diagnosis::{PyBranch, PyFiniteMobility, PySingularity};
pub(crate) use grasp::{PyFingerContact, PyGraspQuality, grasp_quality};
pub(crate) use mobility::{PyJointMobility, PyMobility};
pub(crate) use statics::{PyContactForces, PyTorques};
pub(crate) use ways::{PyAssemblyModes, PyFollowed};

/// How far loops and contacts are from being closed.
///
/// Attributes
/// ----------
/// distance : float
///     Along held directions (m).
/// angle : float
///     About held directions (rad).
#[pyclass(frozen, get_all, name = "Gap", module = "cylindroid")]
#[derive(Debug, Clone, Copy)]
pub(crate) struct PyGap {
    distance: f64,
    angle: f64,
}

impl From<Gap> for PyGap {
    fn from(gap: Gap) -> Self {
        Self { distance: gap.distance, angle: gap.angle }
    }
}

#[pymethods]
impl PyGap {
    fn __repr__(&self) -> String {
        format!("Gap(distance={:.3e}, angle={:.3e})", self.distance, self.angle)
    }
}

/// The mechanism, its posture and the frame that a constraint is of.
#[derive(Debug, Clone)]
struct Origin {
    state: State,
    reference: FrameId,
    gap: Gap,
}

/// The velocity constraint of a closed chain: `Ja qa + Jp qp - G^T u = 0`.
///
/// From `Mechanism.constraint`, or from matrices.
///
/// Parameters
/// ----------
/// Ja : array_like, (t, a)
///     Velocities at the contacts by the driven joints.
/// Jp : array_like, (t, p), optional
///     By passive joints, and by objects other than the reference.
/// G : array_like, (d, t), optional
///     Wrench on the object by the forces at the contacts. Default: the identity, as of a serial
///     arm.
/// length : float, optional
///     Characteristic length of rank decisions, where units are given (m).
/// units : tuple of four str, optional
///     Units of rows, driven joints, passive columns and the object: a letter each, 'm' or 'r', as
///     in ('mmr', 'rr', 'rr', 'mmr').
///
/// Attributes
/// ----------
/// actuated, passive, components : list of str
///     Names of the driven joints, the passive columns, the components of the object's twist.
/// Ja, Jp, G : ndarray
/// matrix : ndarray, (t, a + p + d)
///     `[Ja Jp -G^T]`.
/// length : float
/// gap : Gap or None
///     How far the loops of the mechanism are open.
///
/// Raises
/// ------
/// DimensionError, NotFiniteError, InvalidOptionError
///
/// Notes
/// -----
/// Bicchi and Prattichizzo 1998, eq. 2.
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> lever = cy.Constraint([[2.0]], G=[[1.0]])
/// >>> lever.mobility().dof
/// 1
#[pyclass(frozen, name = "Constraint", module = "cylindroid")]
#[derive(Debug, Clone)]
pub(crate) struct PyConstraint {
    inner: Constraint,
    actuated: Vec<String>,
    passive: Vec<String>,
    units: Units,
    origin: Option<Origin>,
}

fn units_of(of: Option<&(String, String, String, String)>, c: &Constraint) -> Result<Units> {
    let all = |n: usize| vec![Unit::Angle; n];
    let Some((rows, actuated, passive, object)) = of else {
        return Ok(Units {
            rows: all(c.rows()),
            actuated: all(c.actuated()),
            passive: all(c.passive()),
            object: all(c.object()),
        });
    };
    let letters = |text: &String| {
        let one = |letter: char| match letter {
            'm' => Ok(Unit::Length),
            'r' => Ok(Unit::Angle),
            _ => Err(Failure::option("units", letter, "the letters are 'm' and 'r'")),
        };
        text.chars().map(one).collect::<Result<Vec<Unit>>>()
    };
    Ok(Units {
        rows: letters(rows)?,
        actuated: letters(actuated)?,
        passive: letters(passive)?,
        object: letters(object)?,
    })
}

impl PyConstraint {
    fn of(
        mechanism: &Mechanism,
        q: &[f64],
        reference: Option<&str>,
        length: Option<f64>,
    ) -> Result<Self> {
        let frame = reference.map(|name| mechanism.frame(name)).transpose()?;
        let state = mechanism.state(q)?;
        let chain = ClosedChain::of(&state, frame, length)?;
        Ok(Self {
            inner: chain.constraint,
            actuated: chain.actuated,
            passive: chain.passive,
            units: chain.units,
            origin: Some(Origin { state, reference: chain.reference, gap: chain.gap }),
        })
    }

    /// What it is of, in a title.
    fn name(&self) -> String {
        match &self.origin {
            Some(origin) => format!("'{}'", origin.state.mechanism().name()),
            None => format!(
                "a constraint of {} driven and {} passive columns",
                self.inner.actuated(),
                self.inner.passive()
            ),
        }
    }

    fn component_names(&self) -> Vec<String> {
        let names: &[&str] = match self.inner.object() {
            3 => &["x", "y", "rz"],
            6 => &["x", "y", "z", "rx", "ry", "rz"],
            _ => &[],
        };
        if names.is_empty() {
            return (1..=self.inner.object()).map(|i| format!("u{i}")).collect();
        }
        names.iter().map(ToString::to_string).collect()
    }

    /// The rows of a task map and their names, from a matrix or names of components.
    fn task(&self, task: &Bound<'_, PyAny>) -> Result<(Matrix, Vec<String>)> {
        let names: Vec<String> = if let Ok(text) = task.extract::<String>() {
            text.split(',').map(|s| s.trim().to_owned()).collect()
        } else if let Ok(names) = task.extract::<Vec<String>>() {
            names
        } else {
            let map = task.extract::<Numbers<'_>>()?.matrix("task")?;
            let names = (1..=map.rows()).map(|i| format!("task {i}")).collect();
            return Ok((map, names));
        };
        let known = self.component_names();
        let mut map = Matrix::zeros(names.len(), known.len());
        for (row, name) in names.iter().enumerate() {
            let Some(i) = known.iter().position(|k| k == name) else {
                return Err(Error::unknown("component", name, &known).into());
            };
            map[(row, i)] = 1.0;
        }
        Ok((map, names))
    }

    fn relation(&self, task: Option<&Bound<'_, PyAny>>) -> Result<cylindroid::closure::Relation> {
        let relation = Motions::of(&self.inner).relation();
        Ok(match task {
            None => relation,
            Some(task) => relation.task(&self.task(task)?.0)?,
        })
    }

    fn head(&self, table: &mut Table) {
        table.row("driven", table::names(&self.actuated));
        table.row("passive", table::names(&self.passive));
        if let Some(origin) = &self.origin {
            let frame = origin.state.mechanism().frame_of(origin.reference);
            table.row("reference", &frame.name);
            let Gap { distance, angle } = origin.gap;
            if distance > 1e-9 || angle > 1e-9 {
                table.row("loops open by", format!("{distance:.1e} m, {angle:.1e} rad"));
            }
        }
    }
}

/// A metric from a matrix, or its diagonal.
fn metric_of(name: &'static str, of: &Numbers<'_>) -> Result<Metric> {
    Ok(match of.shape() {
        [_] => Metric::diagonal(name, of.values())?,
        _ => Metric::new(name, &of.matrix(name)?)?,
    })
}

#[pymethods]
impl PyConstraint {
    #[new]
    #[pyo3(signature = (Ja, Jp = None, G = None, length = None, units = None))]
    #[expect(non_snake_case, reason = "the field's names")]
    fn new(
        Ja: Numbers<'_>,
        Jp: Option<Numbers<'_>>,
        G: Option<Numbers<'_>>,
        length: Option<f64>,
        units: Option<(String, String, String, String)>,
    ) -> Result<Self> {
        let actuated = Ja.matrix("Ja")?;
        let passive = match &Jp {
            None => Matrix::zeros(actuated.rows(), 0),
            Some(Jp) => Jp.matrix("Jp")?,
        };
        let grasp = match &G {
            None => Matrix::identity(actuated.rows()),
            Some(G) => G.matrix("G")?,
        };
        let mut inner = Constraint::new(Blocks { actuated, passive, grasp })?;
        if length.is_some() && units.is_none() {
            let reason = "a length needs units, to know which rows and columns are lengths";
            return Err(Failure::option("length", "without units", reason));
        }
        let given = units_of(units.as_ref(), &inner)?;
        if units.is_some() {
            inner = inner.with_length(&given, length.unwrap_or(1.0))?;
        }
        let named = |n: usize, letter: &str| (1..=n).map(|i| format!("{letter}{i}")).collect();
        Ok(Self {
            actuated: named(inner.actuated(), "qa"),
            passive: named(inner.passive(), "qp"),
            units: given,
            inner,
            origin: None,
        })
    }

    #[getter]
    fn actuated(&self) -> Vec<String> {
        self.actuated.clone()
    }

    #[getter]
    fn passive(&self) -> Vec<String> {
        self.passive.clone()
    }

    #[getter]
    fn components(&self) -> Vec<String> {
        self.component_names()
    }

    #[getter]
    #[pyo3(name = "Ja")]
    fn actuated_block<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::matrix(py, &self.inner.blocks().actuated)
    }

    #[getter]
    #[pyo3(name = "Jp")]
    fn passive_block<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::matrix(py, &self.inner.blocks().passive)
    }

    #[getter]
    #[pyo3(name = "G")]
    fn grasp_block<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::matrix(py, &self.inner.blocks().grasp)
    }

    #[getter]
    fn matrix<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::matrix(py, &self.inner.matrix())
    }

    #[getter]
    fn length(&self) -> f64 {
        self.inner.length()
    }

    #[getter]
    fn gap(&self) -> Option<PyGap> {
        self.origin.as_ref().map(|o| o.gap.into())
    }

    /// How it can move, and what holds it.
    ///
    /// Returns
    /// -------
    /// Mobility
    fn mobility(&self, py: Python<'_>) -> PyMobility {
        py.detach(|| PyMobility::of(self))
    }

    /// How well motion and force go from the driven joints to the object.
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
        PyManipulability::of(py, self, task.as_ref(), weights, metric)
    }

    /// All twists of the object that the rate limits of the driven joints allow.
    ///
    /// Parameters
    /// ----------
    /// limits : array_like, (a,) or (a, 2), optional
    ///     Largest rates [rad/s or m/s], or pairs around zero. Default: those of the mechanism.
    /// task : str, list of str or array_like, (k, d), optional
    ///     Components of the twist, or a map; with more than three there are many facets.
    ///
    /// Returns
    /// -------
    /// Polytope
    #[pyo3(signature = (limits = None, task = None))]
    fn velocity_polytope(
        &self,
        py: Python<'_>,
        limits: Option<Numbers<'_>>,
        task: Option<Bound<'_, PyAny>>,
    ) -> Result<PyPolytope> {
        PyPolytope::of(py, self, limits.as_ref(), task.as_ref(), false)
    }

    /// All wrenches on the object that torques of the driven joints within their limits balance.
    ///
    /// Parameters
    /// ----------
    /// limits : array_like, (a,) or (a, 2), optional
    ///     Largest torques [N m or N], or pairs around zero. Default: those of the mechanism.
    /// task : str, list of str or array_like, (k, d), optional
    ///
    /// Returns
    /// -------
    /// Polytope
    #[pyo3(signature = (limits = None, task = None))]
    fn force_polytope(
        &self,
        py: Python<'_>,
        limits: Option<Numbers<'_>>,
        task: Option<Bound<'_, PyAny>>,
    ) -> Result<PyPolytope> {
        PyPolytope::of(py, self, limits.as_ref(), task.as_ref(), true)
    }

    /// The joint torques of least norm that hold a wrench on the object.
    ///
    /// Parameters
    /// ----------
    /// wrench : array_like, (d,)
    ///     Acts on the object, force first.
    /// metric : array_like, (a,) or (a, a), optional
    ///     Of the torques. Default: scaled by the characteristic length.
    ///
    /// Returns
    /// -------
    /// Torques
    #[pyo3(signature = (wrench, metric = None))]
    fn joint_torques(&self, wrench: Numbers<'_>, metric: Option<Numbers<'_>>) -> Result<PyTorques> {
        statics::joint_torques(self, &wrench, metric.as_ref())
    }

    /// The forces at the contacts under torques and a wrench: least, or elastic.
    ///
    /// Parameters
    /// ----------
    /// torques : array_like, (a,)
    /// wrench : array_like, (d,)
    /// compliance : array_like, (t,) or (t, t), optional
    ///     Of the contacts.
    ///
    /// Returns
    /// -------
    /// ContactForces
    #[pyo3(signature = (torques, wrench, compliance = None))]
    fn contact_forces(
        &self,
        torques: Numbers<'_>,
        wrench: Numbers<'_>,
        compliance: Option<Numbers<'_>>,
    ) -> Result<PyContactForces> {
        statics::contact_forces(self, &torques, &wrench, compliance.as_ref())
    }

    /// A basis of the contact forces without a wrench on the object: what squeezes it.
    ///
    /// Returns
    /// -------
    /// ndarray, (t, k)
    fn internal_forces<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::matrix(py, &cylindroid::closure::internal_forces(&self.inner).basis)
    }

    /// A basis of the contact forces without torques at any joint: what the structure holds.
    ///
    /// Returns
    /// -------
    /// ndarray, (t, k)
    fn structural_forces<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::matrix(py, &cylindroid::closure::structural_forces(&self.inner).basis)
    }

    fn __repr__(&self) -> String {
        self.table().text()
    }

    fn _repr_html_(&self) -> String {
        self.table().html()
    }
}

impl PyConstraint {
    fn table(&self) -> Table {
        let mut table = Table::new(&format!("Constraint of {}", self.name()));
        self.head(&mut table);
        table.row("rows", self.inner.rows().to_string());
        table.row("length", format!("{} m", table::number(self.inner.length())));
        table
    }
}

/// The outcome of an attempt to close loops and contacts.
///
/// Attributes
/// ----------
/// q : ndarray, (n,)
///     The configuration.
/// closed : bool
///     True if every loop and contact is closed.
/// gap : Gap
///     How far they are open.
/// steps : int
/// at_limit : list of str
///     Coordinates that stand at a position limit.
#[pyclass(frozen, name = "Assembly", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyAssembly {
    q: Vec<f64>,
    #[pyo3(get)]
    closed: bool,
    #[pyo3(get)]
    gap: PyGap,
    #[pyo3(get)]
    steps: usize,
    #[pyo3(get)]
    at_limit: Vec<String>,
}

impl PyAssembly {
    fn new(found: &Assembly, names: &[String]) -> Self {
        Self {
            q: found.q.clone(),
            closed: found.closed,
            gap: found.gap.into(),
            steps: found.steps,
            at_limit: found.at_limit.iter().map(|&i| names[i].clone()).collect(),
        }
    }
}

#[pymethods]
impl PyAssembly {
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.q)
    }

    fn __bool__(&self) -> bool {
        self.closed
    }

    fn __repr__(&self) -> String {
        format!(
            "<Assembly: {}, open by {:.1e} m, {:.1e} rad, q = {}>",
            if self.closed { "closed" } else { "not closed" },
            self.gap.distance,
            self.gap.angle,
            table::list(&self.q)
        )
    }
}

impl PyMechanism {
    /// The constraints at one or many configurations.
    fn constraints(
        &self,
        q: Option<&Numbers<'_>>,
        actuated: Option<&[String]>,
        reference: Option<&str>,
        length: Option<f64>,
    ) -> Result<Many<PyConstraint>> {
        let driven;
        let mechanism = match actuated {
            None => &self.inner,
            Some(names) => {
                driven = self.inner.with_actuated(names)?;
                &driven
            }
        };
        let one = |q: &[f64]| PyConstraint::of(mechanism, q, reference, length);
        let Some(q) = q else { return Ok(Many::One(one(mechanism.home())?)) };
        let rows = Rows::of(mechanism, "q", q)?;
        Ok(match rows.count {
            None => Many::One(one(rows.row(0))?),
            Some(count) => Many::All((0..count).map(|i| one(rows.row(i))).collect::<Result<_>>()?),
        })
    }
}

/// One object of Python, or a list of them.
fn object<'py, T>(py: Python<'py>, many: Many<T>) -> PyResult<Bound<'py, PyAny>>
where
    T: PyClass + Into<PyClassInitializer<T>>,
{
    Ok(match many {
        Many::One(one) => Bound::new(py, one)?.into_any(),
        Many::All(all) => {
            let list = PyList::empty(py);
            for one in all {
                list.append(Bound::new(py, one)?)?;
            }
            list.into_any()
        }
    })
}

#[pymethods]
impl PyMechanism {
    /// The velocity constraint of loops, contacts and reference frame.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,) or (N, n), optional
    ///     Default: home.
    /// actuated : list of str, optional
    ///     The driven joints, in place of those of the file.
    /// reference : str, optional
    ///     The frame whose motion is the goal. Default: that of the file, else the tool.
    /// length : float, optional
    ///     Characteristic length (m). Default: the reach.
    ///
    /// Returns
    /// -------
    /// Constraint, or list of Constraint
    ///     Loops are taken as closed; `gap` says how far they are open.
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError, UnknownNameError, InvalidOptionError, ModelError
    #[pyo3(signature = (q = None, actuated = None, reference = None, length = None))]
    fn constraint<'py>(
        &self,
        py: Python<'py>,
        q: Option<Numbers<'py>>,
        actuated: Option<Vec<String>>,
        reference: Option<&str>,
        length: Option<f64>,
    ) -> Result<Bound<'py, PyAny>> {
        let all = self.constraints(q.as_ref(), actuated.as_deref(), reference, length)?;
        Ok(object(py, all)?)
    }

    /// How the mechanism can move, what is redundant, idle or held twice.
    ///
    /// Parameters
    /// ----------
    /// q, actuated, reference, length
    ///     As `constraint`.
    ///
    /// Returns
    /// -------
    /// Mobility, or list of Mobility
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError, UnknownNameError, InvalidOptionError, ModelError
    ///
    /// Notes
    /// -----
    /// Bicchi and Prattichizzo 1998. Counts come from ranks, never from Grubler's formula.
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> report = cy.load("five-bar").mobility()
    /// >>> report.dof, report.redundancy, report.hyperstatic
    /// (2, 0, 0)
    #[pyo3(signature = (q = None, actuated = None, reference = None, length = None))]
    fn mobility<'py>(
        &self,
        py: Python<'py>,
        q: Option<Numbers<'py>>,
        actuated: Option<Vec<String>>,
        reference: Option<&str>,
        length: Option<f64>,
    ) -> Result<Bound<'py, PyAny>> {
        let all = self.constraints(q.as_ref(), actuated.as_deref(), reference, length)?;
        let reports = py.detach(|| all.try_map(|c| Ok::<_, Failure>(PyMobility::of(c))))?;
        Ok(object(py, reports)?)
    }

    /// How well motion and force go from the driven joints to the reference frame.
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
    ///     Metrics of twists (or the task), joint rates, wrenches and torques, positive definite.
    ///     Defaults: those of `metric`; wrenches and torques by the duals.
    /// metric : str
    ///     'unit' (m beside rad), 'length' (lengths over the characteristic length), 'limits'
    ///     (lengths so, joint rates over their limits).
    /// length : float, optional
    ///     Characteristic length (m). Default: the reach.
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
        let all = self.constraints(q.as_ref(), actuated.as_deref(), reference, length)?;
        let weights = [&Wu, &Wq, &Ww, &Wtau].map(Option::as_ref);
        let reports =
            all.try_map(|c| PyManipulability::of(py, c, task.as_ref(), weights, metric))?;
        Ok(object(py, reports)?)
    }

    /// How a measure of manipulability changes with the configuration.
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
        q: Option<Numbers<'_>>,
        measure: &str,
        actuated: Option<Vec<String>>,
        reference: Option<&str>,
        task: Option<Bound<'_, PyAny>>,
        Wu: Option<Numbers<'_>>,
        Wq: Option<Numbers<'_>>,
        metric: &str,
    ) -> Result<PyGradient> {
        let weights = [Wu.as_ref(), Wq.as_ref(), None, None];
        match self.constraints(q.as_ref(), actuated.as_deref(), reference, None)? {
            Many::One(c) => PyGradient::of(py, &c, measure, task.as_ref(), weights, metric),
            Many::All(_) => Err(Failure::option("q", "a batch", "give one configuration, (n,)")),
        }
    }

    /// The quality of the grasp by the contacts that the mechanism file names on an object.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,), optional
    ///     Default: home.
    /// reference : str, optional
    ///     A frame of the object. Default: the reference.
    /// mu, torsion : float, optional
    ///     Coefficient of friction, and largest moment about the normal over the normal force (m),
    ///     in place of those of the file.
    /// strength : float
    ///     Largest normal force of each finger (N), for the effort 'each'.
    /// effort : str
    ///     'shared' or 'each', as of the function `grasp_quality`.
    ///
    /// Returns
    /// -------
    /// GraspQuality
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError, UnknownNameError
    /// InvalidOptionError
    ///     Also for contacts that are no points, or whose coefficients nobody gives.
    #[pyo3(signature = (q = None, reference = None, mu = None, torsion = None, strength = 1.0,
        effort = "shared"))]
    #[expect(clippy::too_many_arguments, reason = "they have names in Python")]
    fn grasp_quality(
        &self,
        py: Python<'_>,
        q: Option<Numbers<'_>>,
        reference: Option<&str>,
        mu: Option<f64>,
        torsion: Option<f64>,
        strength: f64,
        effort: &str,
    ) -> Result<PyGraspQuality> {
        let m = &self.inner;
        let state = match &q {
            None => m.state(m.home())?,
            Some(q) => m.state(q.vector("q")?)?,
        };
        let object = reference.map_or(Ok(m.reference()), |name| m.frame(name))?;
        let touch = Touch { mu, torsion, strength };
        grasp::of_mechanism(py, &state, object, touch, effort)
    }

    /// Closes loops and contacts from a guess, within position limits.
    ///
    /// It finds one assembly, mostly the nearest; there may be others, and not to find one proves
    /// nothing.
    ///
    /// Parameters
    /// ----------
    /// guess : array_like, (n,), optional
    ///     Default: home.
    /// hold : list of str, optional
    ///     Coordinates that keep the values of the guess.
    ///
    /// Returns
    /// -------
    /// Assembly
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError, UnknownNameError
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> cy.load("five-bar").assemble([-0.2, 0.1, 0.0, 0.0]).closed
    /// True
    #[pyo3(signature = (guess = None, hold = None))]
    fn assemble(
        &self,
        py: Python<'_>,
        guess: Option<Numbers<'_>>,
        hold: Option<Vec<String>>,
    ) -> Result<PyAssembly> {
        let m = &self.inner;
        let guess = match &guess {
            None => m.home(),
            Some(guess) => guess.vector("guess")?,
        };
        let held = self.places(&hold.unwrap_or_default())?;
        let found = py.detach(|| assemble(m, guess, &held))?;
        let names: Vec<String> = m.coordinates().iter().map(|c| c.name.clone()).collect();
        Ok(PyAssembly::new(&found, &names))
    }
}
