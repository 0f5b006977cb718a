//! The class `Mechanism`: a model and its kinematics.

mod derived;
mod inertia;
mod joint;
mod kinematics;
mod limits;
pub(crate) mod load;
mod ordered;
mod parameter;
mod relative_jacobian;
mod srdf;

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use cylindroid::closure::MobilityCounts;
use cylindroid::manipulability::{BatchOptions, ManipulabilityBatch};
use cylindroid::model::{Dimension, JointLimits};
use cylindroid::{EndEffector, Error, FrameId, Mechanism, Pose};
use pyo3::prelude::*;
use pyo3::types::IntoPyDict;
use pyo3::{IntoPyObjectExt, intern};

use crate::arrays::{self, Array, Numbers};
use crate::coordinates::Coordinates;
use crate::error::{Result, argument};
use crate::ik::Prepared;
use crate::options;
use crate::table::{self, Table};

pub(crate) use joint::PyJoint;
pub(crate) use load::PyLoadReport;
pub(crate) use parameter::PyParameter;
pub(crate) use srdf::PySrdf;

/// A robot or mechanism (immutable); created by `load` or `parse`.
///
/// Attributes
/// ----------
/// name : str
/// n : int
///     Number of coordinates: entries of q and of the joint velocities.
/// joint_names : list of str
///     Names of the coordinates, in the order of q.
/// units : list of str
///     'rad' or 'm' for each coordinate.
/// frames : list of str
///     Link frames first, then named frames.
/// links : list of str
/// joints : list of Joint
/// contacts : list of str
/// contact_links : list of tuple of str
///     The first and the second link of each contact, a finger and the object.
/// actuated : list of str
///     The actuated coordinates and loop joints.
/// lower, upper, velocity_limit, acceleration_limit, jerk_limit, effort_limit : ndarray, (n,)
///     Infinite if the file has no limit [rad or m, /s, /s^2, /s^3, N m or N].
/// home : ndarray, (n,)
///     The home configuration of the file, otherwise zero, or the middle of limits that exclude
///     zero.
/// tool : str
///     The default frame.
/// tool_choice : str
///     The reason why it is the default frame: named by the model, a word in its name, or the end of
///     the longest chain.
/// reference : str
///     The reference frame of a closed chain: the frame of its task.
/// reach : float
///     Characteristic length (m): the extent at home of the joint axes and points.
/// is_closed : bool
///     True if loops or contacts constrain q.
/// dimension : int
///     2 in the plane x-y, otherwise 3.
/// parameters : list of Parameter
///     Those of its mechanism file, with the values that it was built with.
/// report : LoadReport
///     The format, the source and the ignored elements of the file.
#[pyclass(frozen, name = "Mechanism", module = "cylindroid")]
#[derive(Debug, Clone)]
pub(crate) struct PyMechanism {
    pub(crate) inner: Mechanism,
    /// For pickling.
    pub(crate) origin: Origin,
    /// Generic counts computed by `measures`.
    pub(crate) ordinary: Ordinary,
    /// Solvers of the last calls of `ik`.
    pub(crate) prepared: Prepared,
}

/// The source of a mechanism, for pickling.
#[derive(Debug, Clone)]
pub(crate) enum Origin {
    /// A name of the catalogue, or a path.
    Model { model: String, parameters: Vec<(String, f64)> },
    /// Text, its format and its path.
    Text { text: String, format: String, path: PathBuf, parameters: Vec<(String, f64)> },
    /// Another mechanism, with other actuators.
    Actuated { of: Box<PyMechanism>, names: Vec<String> },
    /// Another mechanism, with other limits.
    Limited { of: Box<PyMechanism>, limits: Vec<(String, JointLimits)> },
    /// Another mechanism, with some joints fixed.
    Fixed { of: Box<PyMechanism>, names: Vec<String>, q: Vec<f64> },
    /// Another mechanism, with another tool.
    Tool { of: Box<PyMechanism>, frame: String },
    /// A group of joints of another mechanism.
    Group { of: Box<PyMechanism>, srdf: (PathBuf, Option<String>), name: String, q: Vec<f64> },
}

/// Drives, reference, bits of the length.
type About = (Vec<usize>, FrameId, u64);

/// Cache of generic counts, whose computation takes up to tens of milliseconds.
#[derive(Debug, Clone, Default)]
pub(crate) struct Ordinary(Arc<Mutex<HashMap<About, MobilityCounts>>>);

impl Ordinary {
    /// The batch of a mechanism with these options, with cached generic counts if available; those
    /// of tasks are not cached.
    pub(crate) fn batch(
        &self,
        mechanism: &Mechanism,
        (reference, length): (FrameId, f64),
        options: BatchOptions,
    ) -> cylindroid::Result<ManipulabilityBatch> {
        let (of, about) = (Some(reference), Some(length));
        if options.task.is_some() {
            let options = BatchOptions { reference: of, length: about, ..options };
            return ManipulabilityBatch::new(mechanism, &options);
        }
        let key: About = (mechanism.actuated().collect(), reference, length.to_bits());
        let known = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let generic = known().get(&key).copied();
        let batch = ManipulabilityBatch::new(
            mechanism,
            &BatchOptions { reference: of, length: about, generic, ..options },
        )?;
        known().insert(key, batch.generic());
        Ok(batch)
    }
}

impl PyMechanism {
    pub(crate) fn new(inner: Mechanism, origin: Origin) -> Self {
        Self { inner, origin, ordinary: Ordinary::default(), prepared: Prepared::default() }
    }

    pub(crate) fn end_effector(
        &self,
        frame: Option<&str>,
        tool: Option<&Numbers<'_>>,
    ) -> Result<EndEffector> {
        let frame = match frame {
            None => self.inner.tool(),
            Some(name) => self.inner.frame(name)?,
        };
        let frame_from_tool = match tool {
            None => Pose::IDENTITY,
            Some(tool) => tool.pose("tool")?,
        };
        Ok(EndEffector { frame, frame_from_tool })
    }

    /// The same, by default the reference of a closed chain.
    pub(crate) fn reference_or_tool(
        &self,
        frame: Option<&str>,
        tool: Option<&Numbers<'_>>,
    ) -> Result<EndEffector> {
        let end_effector = self.end_effector(frame, tool)?;
        if frame.is_none() && self.inner.is_closed() {
            return Ok(EndEffector { frame: self.inner.reference(), ..end_effector });
        }
        Ok(end_effector)
    }

    /// The places of coordinates by their names.
    pub(crate) fn places(&self, names: &[String]) -> Result<Vec<usize>> {
        let known: Vec<&str> = self.inner.coordinates().iter().map(|c| c.name.as_str()).collect();
        let place = |name: &String| {
            let place = known.iter().position(|k| k == name);
            place.ok_or_else(|| Error::unknown("coordinate", name, &known).into())
        };
        names.iter().map(place).collect()
    }

    /// The given vector, otherwise home.
    pub(crate) fn or_home<'a>(
        &'a self,
        name: &'static str,
        given: Option<&'a Coordinates<'_>>,
    ) -> Result<&'a [f64]> {
        given.map_or(Ok(self.inner.home()), |given| given.vector(&self.inner, name))
    }

    fn frame_name(&self, id: cylindroid::FrameId) -> &str {
        &self.inner.frame_of(id).name
    }
}

#[pymethods]
impl PyMechanism {
    #[getter]
    fn name(&self) -> &str {
        self.inner.name()
    }

    #[getter]
    fn n(&self) -> usize {
        self.inner.n()
    }

    #[getter]
    fn joint_names(&self) -> Vec<&str> {
        self.inner.coordinates().iter().map(|c| c.name.as_str()).collect()
    }

    #[getter]
    fn units(&self) -> Vec<&'static str> {
        self.inner.coordinates().iter().map(|c| c.kind.unit()).collect()
    }

    #[getter]
    fn frames(&self) -> Vec<&str> {
        self.inner.frames().iter().map(|f| f.name.as_str()).collect()
    }

    #[getter]
    fn links(&self) -> Vec<&str> {
        self.inner.links().iter().map(|l| l.name.as_str()).collect()
    }

    #[getter]
    fn contacts(&self) -> Vec<&str> {
        self.inner.contacts().iter().map(|c| c.name.as_str()).collect()
    }

    #[getter]
    fn contact_links(&self) -> Vec<(&str, &str)> {
        let link = |i: usize| self.inner.links()[i].name.as_str();
        self.inner.contacts().iter().map(|c| (link(c.a), link(c.b))).collect()
    }

    #[getter]
    fn actuated(&self) -> Vec<&str> {
        let tree = self.inner.actuated().map(|i| self.inner.coordinates()[i].name.as_str());
        let closing = self.inner.loops().iter().filter(|l| l.actuated).map(|l| l.name.as_str());
        tree.chain(closing).collect()
    }

    #[getter]
    fn is_closed(&self) -> bool {
        self.inner.is_closed()
    }

    #[getter]
    fn dimension(&self) -> u8 {
        match self.inner.dimension() {
            Dimension::Planar => 2,
            Dimension::Spatial => 3,
        }
    }

    #[getter]
    fn home<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, self.inner.home())
    }

    #[getter]
    fn tool(&self) -> &str {
        self.frame_name(self.inner.tool())
    }

    #[getter]
    fn tool_choice(&self) -> String {
        self.inner.tool_choice().to_string()
    }

    #[getter]
    fn reference(&self) -> &str {
        self.frame_name(self.inner.reference())
    }

    #[getter]
    fn reach(&self) -> f64 {
        self.inner.reach()
    }

    /// The same mechanism actuated by these joints and no others.
    ///
    /// Parameters
    /// ----------
    /// names : sequence of str
    ///     Joints of the tree, their coordinates, or joints that close loops.
    ///
    /// Returns
    /// -------
    /// Mechanism
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    ///     With the nearest names.
    /// InvalidOptionError
    ///     For a joint that does not move or follows another.
    #[pyo3(signature = (names))]
    fn with_actuated(&self, #[pyo3(from_py_with = argument)] names: Vec<String>) -> Result<Self> {
        let inner = self.inner.with_actuated(&names)?;
        Ok(Self::new(inner, Origin::Actuated { of: Box::new(self.clone()), names }))
    }

    fn __repr__(&self) -> String {
        let m = &self.inner;
        let mut text = format!("<Mechanism '{}': {} coordinates", m.name(), m.n());
        for (count, what) in [(m.loops().len(), "loops"), (m.contacts().len(), "contacts")] {
            if count > 0 {
                text.push_str(&format!(", {count} {what}"));
            }
        }
        text.push_str(&format!(", tool '{}'>", self.tool()));
        text
    }

    fn __str__(&self) -> String {
        self.table().text()
    }

    fn _repr_html_(&self) -> String {
        self.table().html()
    }

    fn __copy__(&self) -> Self {
        self.clone()
    }

    fn __deepcopy__(&self, _memo: Bound<'_, PyAny>) -> Self {
        self.__copy__()
    }

    /// Pickles the source, which is read again: for a file, its absolute path.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let package = py.import(intern!(py, "cylindroid"))?;
        Ok(match &self.origin {
            Origin::Model { model, parameters } => (
                package.getattr(intern!(py, "load"))?,
                (model, parameters.clone().into_py_dict(py)?).into_bound_py_any(py)?,
            ),
            Origin::Text { text, format, path, parameters } => (
                package.getattr(intern!(py, "parse"))?,
                (text, format, path.as_os_str(), parameters.clone().into_py_dict(py)?)
                    .into_bound_py_any(py)?,
            ),
            Origin::Actuated { of, names } => (
                py.get_type::<Self>().getattr(intern!(py, "with_actuated"))?,
                ((**of).clone(), names).into_bound_py_any(py)?,
            ),
            Origin::Limited { of, limits } => (
                py.get_type::<Self>().getattr(intern!(py, "with_limits"))?,
                ((**of).clone(), options::limits_dict(py, limits)?).into_bound_py_any(py)?,
            ),
            Origin::Fixed { of, names, q } => (
                py.get_type::<Self>().getattr(intern!(py, "with_fixed_joints"))?,
                ((**of).clone(), names, q).into_bound_py_any(py)?,
            ),
            Origin::Tool { of, frame } => (
                py.get_type::<Self>().getattr(intern!(py, "with_tool"))?,
                ((**of).clone(), frame).into_bound_py_any(py)?,
            ),
            Origin::Group { of, srdf, name, q } => (
                package
                    .getattr(intern!(py, "Srdf"))?
                    .call1((srdf.0.as_os_str(), &srdf.1))?
                    .getattr(intern!(py, "group"))?,
                (name, (**of).clone(), q).into_bound_py_any(py)?,
            ),
        })
    }
}

impl PyMechanism {
    fn table(&self) -> Table {
        let m = &self.inner;
        let mut table = Table::new(&format!("Mechanism '{}'", m.name()));
        table.row("format", m.report().format);
        table.row("tool", self.tool());
        if m.is_closed() {
            table.row("reference", self.reference());
            table.row("loops", m.loops().len().to_string());
            table.row("contacts", m.contacts().len().to_string());
        }
        table.row("reach", format!("{} m", table::number(m.reach())));
        for c in m.coordinates() {
            let unit = c.kind.unit();
            let limits = format!(
                "{} to {} {unit}, {} {unit}/s{}",
                table::number(c.limits.lower),
                table::number(c.limits.upper),
                table::number(c.limits.velocity),
                if c.actuated { "" } else { ", passive" }
            );
            table.row(&c.name, limits);
        }
        if !m.report().ignored.is_empty() {
            table.row("ignored", format!("{} things, see report", m.report().ignored.len()));
        }
        table
    }
}
