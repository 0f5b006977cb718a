//! The class `Srdf`: groups, states and end effectors of a robot.

use std::path::PathBuf;

use cylindroid::model::formats::{self, srdf::Srdf};
use numpy::{IntoPyArray, PyArray1};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;

use super::{Origin, PyLoadReport, PyMechanism};
use crate::coordinates::Coordinates;
use crate::error::{Result, argument};

/// What an SRDF says about a robot: groups of joints, named states, end effectors.
///
/// Parameters
/// ----------
/// path : str or os.PathLike
/// text : str, optional
///     The text; the path is for messages then.
///
/// Attributes
/// ----------
/// groups : list of str
/// states : list of tuple of str
///     Group and name of each state; None for the group where the file names none.
/// end_effectors : list of tuple of str
///     Name of each end effector and the link that carries it.
/// disabled_collisions : list of tuple of str
///     Pairs of links.
/// report : LoadReport
///     The elements and attributes that were not read.
///
/// Raises
/// ------
/// ModelFileError
///     With line and column.
/// UnreadableFileError
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> text = '''<robot name="panda">
/// ...     <group name="forearm"><chain base_link="link4" tip_link="link7"/></group>
/// ...     <group_state name="up" group="forearm"><joint name="panda_joint6" value="1.0"/></group_state>
/// ... </robot>'''
/// >>> srdf, panda = cy.Srdf("panda.srdf", text), cy.load("panda")
/// >>> srdf.joints("forearm", panda)
/// ['panda_joint5', 'panda_joint6', 'panda_joint7']
/// >>> forearm = srdf.group("forearm", panda, srdf.configuration("up", panda))
/// >>> forearm.n, forearm.tool, float(forearm.home[1])
/// (3, 'link7', 1.0)
#[pyclass(frozen, name = "Srdf", module = "cylindroid")]
#[derive(Debug, Clone)]
pub(crate) struct PySrdf {
    inner: Srdf,
    path: PathBuf,
    text: Option<String>,
}

#[pymethods]
impl PySrdf {
    #[new]
    #[pyo3(signature = (path, text = None))]
    fn new(
        #[pyo3(from_py_with = argument)] path: PathBuf,
        #[pyo3(from_py_with = argument)] text: Option<String>,
    ) -> Result<Self> {
        let inner = match &text {
            Some(text) => formats::srdf::parse(text, &path),
            None => formats::srdf::load(&path),
        }?;
        // A path is the same from another folder only if it is absolute.
        let path = std::path::absolute(&path).unwrap_or(path);
        Ok(Self { inner, path, text })
    }

    #[getter]
    fn groups(&self) -> Vec<&str> {
        self.inner.groups.iter().map(|g| g.name.as_str()).collect()
    }

    #[getter]
    fn states(&self) -> Vec<(Option<&str>, &str)> {
        self.inner.states.iter().map(|s| (s.group.as_deref(), s.name.as_str())).collect()
    }

    #[getter]
    fn end_effectors(&self) -> Vec<(&str, &str)> {
        let all = self.inner.end_effectors.iter();
        all.map(|e| (e.name.as_str(), e.parent_link.as_str())).collect()
    }

    #[getter]
    fn disabled_collisions(&self) -> Vec<(&str, &str)> {
        self.inner.disabled.iter().map(|[a, b]| (a.as_str(), b.as_str())).collect()
    }

    #[getter]
    fn report(&self) -> PyLoadReport {
        PyLoadReport::from(&self.inner.report)
    }

    /// The movable joints of a group that follow no others, in the order of the robot.
    ///
    /// Parameters
    /// ----------
    /// group : str
    /// robot : Mechanism
    ///
    /// Returns
    /// -------
    /// list of str
    ///
    /// Raises
    /// ------
    /// UnknownNameError, InvalidOptionError
    #[pyo3(signature = (group, robot))]
    fn joints(
        &self,
        #[pyo3(from_py_with = argument)] group: &str,
        #[pyo3(from_py_with = argument)] robot: PyRef<'_, PyMechanism>,
    ) -> Result<Vec<String>> {
        let own = self.inner.joints_of(group, &robot.inner)?;
        Ok(own.into_iter().map(str::to_owned).collect())
    }

    /// The mechanism of a group: its joints move, all others are fixed.
    ///
    /// Its tool is the link that carries its end effector, otherwise the tip of its chain.
    ///
    /// Parameters
    /// ----------
    /// name : str
    /// robot : Mechanism
    /// q : array_like, (n,), optional
    ///     Where the others are fixed, and the new home [rad or m]. Default: home of the robot.
    ///
    /// Returns
    /// -------
    /// Mechanism
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    ///     For a group, joint or link that does not exist, with the nearest names.
    /// InvalidOptionError
    ///     For groups that contain one another, and chains whose base does not carry their tip.
    /// DimensionError, NotFiniteError
    #[pyo3(signature = (name, robot, q = None))]
    fn group(
        &self,
        #[pyo3(from_py_with = argument)] name: String,
        #[pyo3(from_py_with = argument)] robot: PyRef<'_, PyMechanism>,
        q: Option<Coordinates<'_>>,
    ) -> Result<PyMechanism> {
        let q = robot.or_home("q", q.as_ref())?.to_vec();
        let inner = self.inner.group(&name, &robot.inner, &q)?;
        let (srdf, of) = ((self.path.clone(), self.text.clone()), Box::new(robot.clone()));
        Ok(PyMechanism::new(inner, Origin::Group { of, srdf, name, q }))
    }

    /// The configuration of a state: its joints at their positions, the others as in `q`.
    ///
    /// Parameters
    /// ----------
    /// state : str
    ///     Its name; 'group/name' where several groups have a state of this name and one is meant.
    /// robot : Mechanism
    /// q : array_like, (n,), optional
    ///     Default: home.
    ///
    /// Returns
    /// -------
    /// ndarray, (n,)
    ///     Configuration [rad or m].
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    ///     For a state or joint that does not exist, with the nearest names.
    /// DimensionError, NotFiniteError
    #[pyo3(signature = (state, robot, q = None))]
    fn configuration<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = argument)] state: &str,
        #[pyo3(from_py_with = argument)] robot: PyRef<'py, PyMechanism>,
        q: Option<Coordinates<'_>>,
    ) -> Result<Bound<'py, PyArray1<f64>>> {
        let q = robot.or_home("q", q.as_ref())?;
        Ok(self.inner.configuration(state, &robot.inner, q)?.into_pyarray(py))
    }

    fn __repr__(&self) -> String {
        let Srdf { groups, states, end_effectors, .. } = &self.inner;
        format!(
            "<Srdf: {} groups, {} states, {} end effectors>",
            groups.len(),
            states.len(),
            end_effectors.len()
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let arguments = (self.path.as_os_str(), &self.text).into_bound_py_any(py)?;
        Ok((py.get_type::<Self>().into_any(), arguments))
    }
}
